"""Points that move over frames and shells: compliance against dense matrices, impulses against those on bases."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import filled
from heavylift.solver.bodies.ancf.assembly import set_size
from heavylift.solver.bodies.ancf.contours import aim_point, form_net
from heavylift.solver.bodies.ancf.elements import add_stiffness
from heavylift.solver.bodies.ancf.kind import STEP_SET
from heavylift.solver.bodies.ancf.mesh_contour import mesh_contour
from heavylift.solver.bodies.ancf.packing import SCHEMES, pack_meshes
from heavylift.solver.bodies.ancf.sparse_matrices import mesh_matrices
from heavylift.solver.bodies.ancf.types import type_of
from heavylift.solver.contact.interface import settle_points
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Joints,
    Systems,
    Workspace,
    advance,
    apply_inverse,
    complete,
    end_velocity,
    factor,
    fill_markers,
    iterate,
    predict,
    start,
)
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.rows.solver import assemble, factor_rows, solve_rows
from heavylift.solver.rows.structure import (
    FACTORED,
    PRESCRIBED,
    Attachment,
    classify_rows,
    pack_rows,
)
from heavylift.solver.scene.mesh_shapes import line, rectangle
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection, Support
from heavylift.solver.scene.outputs import Columns

STEP = 2e-3
SPOT, OTHER = (2, (0.3, 0.7)), (0, (0.6, 0.2))
"""Element and place on it of the point that is touched, and of another one that is held."""

slow = pytest.mark.slow  # a step of a mesh compiles for half a minute


def frame() -> FrameBody:
    mesh = line([0.0, 0.0, 0.0], [1.0, 0.5, 0.0], 4)
    return FrameBody(
        name="beam",
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(FrameSection(density=1000.0, youngs_modulus=1e7, area=1e-3, second_moment=1e-7),),
        supports=(Support(np.array([0]), {"position": "xyz", "tangent": "y"}),),
        viscous_damping=0.3,
        stiffness_damping=1e-4,
    )


def shell() -> ShellBody:
    mesh = rectangle(1.0, 0.7, 3, 2)
    return ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.01, 1000.0, 1e7, 0.3),),
        supports=(Support(mesh.edges["x_min"], {"position": "xyz", "slope_x": "z"}),),
        viscous_damping=0.3,
        stiffness_damping=1e-4,
    )


def begin(bodies: Any, work: Any, step: float) -> None:
    """Up to free velocities of the midpoint."""
    start(bodies, 0.0, work)
    predict(bodies, 0.0, step)
    fill_markers(bodies, True, FORCES, work)
    factor(bodies, step, work)


def go_on(bodies: Any, systems: Any, step: float, work: Any) -> None:
    """A step without rows, up to its end."""
    complete(bodies, systems, True, step, work)
    advance(bodies, 0.0, step, work)
    end_velocity(bodies, step, work)


@kernel
def aim(kind: Any, slot: int, controls: Any, weights: Any) -> None:
    """A moving point of the only body."""
    aim_point(kind.moving, kind, 0, slot, controls, weights, 0, controls.shape[0])


def settle(bodies: Any, systems: Any, at_midpoint: bool, work: Any) -> None:
    """Velocities of the moving points."""
    settle_points(bodies, systems, at_midpoint, work)


def invert(bodies: Any, system: Any, at_midpoint: bool) -> None:
    """X of all panels."""
    apply_inverse(bodies, at_midpoint, system)


@kernel
def solve(system: Any, work: Any) -> None:
    """Impulses of all rows."""
    assemble(system)
    factor_rows(system)
    solve_rows(system, work.velocity)


def spread(
    bodies: Any, everything: Any, systems: Any, joints: Any, at_midpoint: bool, work: Any, step: float
) -> None:
    """Velocities of all nodes; bodies that iterate do so."""
    complete(bodies, systems, at_midpoint, step, work)
    if at_midpoint:
        for _ in range(60):
            work.control.changed = 0
            iterate(bodies, everything, systems, joints, work, 0.0, step)
            if not work.control.changed > 0:
                break
        advance(bodies, 0.0, step, work)


@kernel
def form(kind: Any, nodal: Any, contour: Any, last: int, other: int, net: Any) -> None:
    """All control points."""
    form_net(kind, 0, nodal, contour, (0, last), (0, other), net)


@kernel
def plain_stiffness(kind: Any) -> None:
    """``B^T C B`` at the midpoint into the step set."""
    size = set_size(kind)
    for i in range(STEP_SET * size, STEP_SET * size + size):
        kind.blocks[i] = 0.0
    add_stiffness(kind, 0, kind.mid_position, kind.shape_strain, kind.right_hand_side, 0.0, 1.0, 0.0)


@cache
def body_of(name: str) -> Any:
    return frame() if name == "frame" else shell()


def values(body: Any, spot: tuple[int, tuple[float, float]], vector: int = 0) -> np.ndarray:
    """Shape values of a material point, and numbers of the nodal vectors that they belong to."""
    of_type = type_of(body)
    shape = of_type.shape_values(body, spot[0], spot[1], vector)
    count = len(of_type.vectors)
    return shape, (count * body.elements[spot[0]][:, None] + np.arange(count)).ravel()


def parameters(body: Any, spot: tuple[int, tuple[float, float]]) -> list[float]:
    """Where the spline has a material point: lengths of the elements are its parameter."""
    if isinstance(body, FrameBody):
        return [(spot[0] + spot[1][0]) / len(body.elements)]
    origin, sides = body.nodes[body.elements[spot[0], 0]], np.ptp(body.nodes, axis=0)
    return [
        float(x) for x in (origin + np.array([*spot[1], 0.0]) * [*body.lengths[spot[0]], 0.0])[:2] / sides[:2]
    ]


def weights_at(body: Any, spot: tuple[int, tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Control points with their weights in a material point, by the basis functions of SciPy."""
    rows = [
        BSpline.design_matrix([u], space.knots, 3).toarray()[0]
        for u, space in zip(parameters(body, spot), mesh_contour(body).spaces, strict=True)
    ]
    full = rows[0] if len(rows) == 1 else np.outer(*rows).ravel()
    controls = np.flatnonzero(full)
    return controls, full[controls]


@dataclass
class Model:
    """One body with two bases, the touched point first, and two moving points."""

    body: Any
    kind: Any
    work: Workspace
    matrices: Any

    @property
    def width(self) -> int:
        return 12

    def jacobian(self, spot: tuple[int, tuple[float, float]]) -> np.ndarray:
        """Velocity of a material point by the free coordinates."""
        shape, vectors = values(self.body, spot)
        count, lanes = len(type_of(self.body).vectors), len(self.kind.shape[1])
        J = np.zeros((3, len(self.matrices.places)))
        for value, vector in zip(shape, vectors, strict=True):
            for k in range(3):
                number = self.matrices.number(vector // count * lanes + 3 * (vector % count) + np.array([k]))[
                    0
                ]
                if number >= 0:
                    J[k, number] += value
        return J

    def free(self, nodal: np.ndarray) -> np.ndarray:
        """Free coordinates of a nodal vector."""
        return nodal[self.matrices.places]

    def aim(self, slot: int, spot: tuple[int, tuple[float, float]]) -> None:
        aim(self.kind, slot, *weights_at(self.body, spot))

    def system(self, *columns: int) -> Any:
        """Blocks of three rows on the three velocities from each column on, in directions that are askew."""
        sides = [(Attachment(0, 0, self.width, FACTORED), Attachment(-1, -1, 0, PRESCRIBED))] * len(columns)
        ones = [np.ones(3)] * len(columns)
        system = pack_rows([3] * len(columns), sides, ones, np.zeros(self.width), 0)
        classify_rows(system)
        lanes = len(system.shape[1])
        axes = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
        for block, column in enumerate(columns):
            at = system.attachments[2 * block].panel + column * lanes
            system.panels[at : at + 3 * lanes].reshape(3, lanes)[:, :3] = axes
        return system


def make(name: str, scheme: str) -> Model:
    """Deformed and moving."""
    rng = np.random.default_rng(5)
    body = body_of(name)
    points = []
    for spot in (SPOT, OTHER):
        shape, vectors = values(body, spot)
        points.append(shape @ type_of(body).start_coordinates(body).reshape(-1, 3)[vectors])
    empty = BodyMarkers((), (), ())
    markers = BodyMarkers((0, 1), tuple(points), (False, False), (FORCES, FORCES), tuple(points), (0, 0))
    kind = pack_meshes([body], 0, [0], [Columns(0, ())], [markers], [empty], moving=[2])
    kind.table[0].scheme = SCHEMES[scheme]
    matrices = mesh_matrices(kind)
    kind.position[matrices.places] += 0.02 * rng.normal(size=len(matrices.places))
    kind.velocity[matrices.places] = 0.3 * rng.normal(size=len(matrices.places))
    work = Workspace.empty(12, 2, 12)
    work.sums.gravity[:] = 1.0, -2.0, -9.81
    return Model(body, kind, work, matrices)


@pytest.mark.parametrize(
    ("name", "at_midpoint"),
    [
        ("frame", False),
        pytest.param("shell", False, marks=slow),
        pytest.param("frame", True, marks=slow),
        pytest.param("shell", True, marks=slow),
    ],
)
def test_compliance_is_that_of_the_dense_matrix(name: str, at_midpoint: bool) -> None:
    """``J A^-1 J^T`` of two bases and two moving points, one of which stands at a node."""
    model = make(name, "carried")
    kind, body = model.kind, model.body
    spots = [SPOT, OTHER, (3, (0.9, 0.4)), (1, (1.0, 1.0))]
    M = model.matrices.mass.toarray()
    if at_midpoint:
        begin(kind, model.work, STEP)
        blocks = kind.blocks.copy()
        plain_stiffness(kind)
        K = model.matrices.stiffness(kind.blocks).toarray()
        kind.blocks[:] = blocks
        half = 0.5 * STEP
        M = (1.0 + half * body.viscous_damping) * M + half * (half + body.stiffness_damping) * K
    model.aim(0, OTHER)
    model.aim(1, spots[3])
    invert(kind, model.system(6), at_midpoint)
    model.aim(0, spots[2])  # to another element
    J = np.concatenate([model.jacobian(spot) for spot in spots])
    wanted = J @ np.linalg.solve(M, J.T)
    found = np.zeros((12, 12))
    for block in range(4):
        system = model.system(3 * block)
        lanes = len(system.shape[1])
        G = system.panels[: 12 * lanes].reshape(12, lanes)
        G[3 * block : 3 * block + 3, :3] = np.eye(3)
        invert(kind, system, at_midpoint)
        half_way = len(system.panels) // 2
        found[:, 3 * block : 3 * block + 3] = system.panels[half_way : half_way + 12 * lanes].reshape(12, -1)[
            :, :3
        ]
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-12 * np.abs(wanted).max())


@slow
@pytest.mark.parametrize("name", ["frame", "shell"])
@pytest.mark.parametrize("scheme", ["carried", "explicit"])
def test_velocities_are_those_of_the_material_point(name: str, scheme: str) -> None:
    """Free ones at the midpoint, which all nodes get without rows; those of the nodes at the end of the step."""
    model = make(name, scheme)
    kind, work = model.kind, model.work
    begin(kind, work, STEP)
    model.aim(1, SPOT)
    settle(kind, Systems(()), True, work)
    velocity = work.velocity.copy()
    go_on(kind, Systems(()), STEP, work)
    J = model.jacobian(SPOT)
    size = np.abs(J @ model.free(kind.mid_velocity)).max()
    np.testing.assert_allclose(velocity[9:], J @ model.free(kind.mid_velocity), rtol=0.0, atol=1e-12 * size)
    np.testing.assert_allclose(velocity[9:], velocity[:3], rtol=0.0, atol=1e-12 * size)  # its base
    model.aim(0, OTHER)
    settle(kind, Systems(()), False, work)
    np.testing.assert_allclose(
        work.velocity[6:9], model.jacobian(OTHER) @ model.free(kind.velocity), rtol=1e-12
    )


@slow
@pytest.mark.parametrize("name", ["frame", "shell"])
@pytest.mark.parametrize("scheme", ["carried", "energy-momentum", "explicit"])
def test_a_moving_point_is_as_good_as_a_base(name: str, scheme: str) -> None:
    """A point held by its base, and by a moving point at the same place; beside it another one held by a base."""
    results = []
    for columns in ((3, 0), (3, 6)):
        model = make(name, scheme)
        kind, work = model.kind, model.work
        system = model.system(*columns)
        table = system.rows
        begin(kind, work, STEP)
        for at_midpoint in (True, False):
            table["impulse"] = 0.0
            table["target"][:, :3] = [[0.1, -0.2, 0.3], [-0.1, 0.4, 0.2]]
            if not at_midpoint:
                end_velocities(kind, STEP, work)
            model.aim(0, SPOT)
            model.aim(1, OTHER)
            settle(kind, Systems(()), at_midpoint, work)
            invert(kind, system, at_midpoint)
            solve(system, work)
            spread(kind, Bodies((kind,)), Systems((system,)), Joints(()), at_midpoint, work, STEP)
        found = [model.free(nodal).copy() for nodal in (kind.position, kind.velocity)] + [
            table["impulse"][:, :3].copy()
        ]
        np.testing.assert_allclose(model.jacobian(SPOT) @ found[1], work.velocity[:3], atol=1e-10)
        results.append(found)
    for one, other in zip(*results, strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11 * np.abs(other).max())


@kernel
def end_velocities(bodies: Any, step: float, work: Any) -> None:
    """Those that `advance` has left."""
    end_velocity(bodies, step, work)


@slow
@pytest.mark.parametrize("name", ["frame", "shell"])
def test_points_follow_rows_that_have_pushed_before(name: str) -> None:
    """Aimed after a row has been solved: the velocity contains its impulse, and follows what it does later."""
    model = make(name, "carried")
    kind, work = model.kind, model.work
    system = model.system(3)
    table = system.rows
    table["target"][:, :3] = [0.1, -0.2, 0.3]
    begin(kind, work, STEP)
    invert(kind, system, True)
    solve(system, work)
    model.aim(1, SPOT)
    settle(kind, Systems((system,)), True, work)
    np.testing.assert_allclose(work.velocity[9:], work.velocity[:3], rtol=1e-11)
    table["target"][:, :3] = [0.5, 0.2, 0.1]
    solve(system, work)
    np.testing.assert_allclose(work.velocity[9:], work.velocity[:3], rtol=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["frame", pytest.param("shell", marks=slow)])
def test_control_points_make_the_shape_of_the_mesh(name: str) -> None:
    """At the midpoint and at the carried state, everywhere on the mesh."""
    rng = np.random.default_rng(2)
    model = make(name, "carried")
    made = mesh_contour(model.body)
    counts = [space.count for space in made.spaces] + [1] * (2 - len(made.spaces))
    u, v = (filled(PackedDirection, degree=3, count=c, closed=False, first_knot=0) for c in counts[:2])
    contour = filled(PackedContour, u=u, v=v, first_control=5, first_weight=-1)
    model.kind.mid_position[:] = model.kind.position + 0.1 * model.kind.velocity
    lanes, count = len(model.kind.shape[1]), len(type_of(model.body).vectors)
    for nodal in (model.kind.mid_position, model.kind.position):
        net = np.full((5 + len(made.factors), 3), np.nan)
        form(model.kind, nodal, contour, counts[0] - 1, counts[1] - 1, net)
        q = nodal.reshape(-1, lanes)[: len(model.body.nodes), : 3 * count].reshape(-1, 3)
        for _ in range(20):
            spot = (int(rng.integers(len(model.body.elements))), (float(rng.random()), float(rng.random())))
            controls, weights = weights_at(model.body, spot)
            shape, vectors = values(model.body, spot)
            np.testing.assert_allclose(weights @ net[5 + controls], shape @ q[vectors], atol=1e-13)
