"""Equilibrium of frames and shells: tables of separate codes, closed forms, limit points, joints, free motions."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.solver.force_elements.wire_rope import Rope, SpringRope
from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.layout import Layout, pack_scene
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint
from heavylift.solver.scene.mesh_shapes import line, rectangle
from heavylift.solver.scene.meshes import (
    DistributedLoad,
    FollowerLoad,
    FrameBody,
    FrameSection,
    MeshBody,
    ShellBody,
    ShellSection,
    Support,
)
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.start.rows import StartRows
from heavylift.solver.statics.equilibrium import find_equilibrium
from heavylift.solver.statics.mesh_statics import relax_to_equilibrium
from heavylift.solver.statics.mesh_system import MeshSystem

if TYPE_CHECKING:
    from collections.abc import Sequence

DOWN = Gravity(np.array([0.0, 0.0, -9.81]))
COUNTS = (1, 2, 3, 5, 10)

# Frames of 10 m and 1 m diameter under their own weight, deflection in mm with 1, 2, 3, 5, 10 elements
SECTIONS = {1: (1e3, 1e9), 2: (1e3, 1e10), 3: (1e3, 1e11), 4: (7.85e3, 2.1e11)}
FRAMES = {
    ("pinned", 1, "green-lagrange"): (16.3341, 20.4034, 20.3525, 20.3962, 20.4027),
    ("pinned", 1, "exact"): (16.3345, 20.4043, 20.3534, 20.3971, 20.4036),
    ("pinned", 2, "green-lagrange"): (1.6350, 2.0437, 2.0387, 2.0431, 2.0437),
    ("pinned", 2, "exact"): (1.6350, 2.0437, 2.0387, 2.0431, 2.0437),
    ("pinned", 3, "green-lagrange"): (0.1635, 0.2044, 0.2039, 0.2043, 0.2044),
    ("pinned", 3, "exact"): (0.1635, 0.2044, 0.2039, 0.2043, 0.2044),
    ("pinned", 4, "green-lagrange"): (0.6112, 0.7640, 0.7621, 0.7637, 0.7640),
    ("pinned", 4, "exact"): (0.6112, 0.7640, 0.7621, 0.7637, 0.7640),
    ("cantilever", 1, "green-lagrange"): (195.7318, 196.1189, 196.1379, 196.1400, 196.1401),
    ("cantilever", 1, "exact"): (195.7333, 196.1185, 196.1376, 196.1398, 196.1399),
    ("cantilever", 2, "green-lagrange"): (19.6195, 19.6199, 19.6199, 19.6199, 19.6199),
    ("cantilever", 2, "exact"): (19.6195, 19.6199, 19.6199, 19.6199, 19.6199),
    ("cantilever", 3, "green-lagrange"): (1.9620, 1.9620, 1.9620, 1.9620, 1.9620),
    ("cantilever", 3, "exact"): (1.9620, 1.9620, 1.9620, 1.9620, 1.9620),
    ("cantilever", 4, "green-lagrange"): (7.3341, 7.3341, 7.3341, 7.3341, 7.3341),
    ("cantilever", 4, "exact"): (7.3341, 7.3341, 7.3341, 7.3341, 7.3341),
}

# Square plate L = 10 m, h = 0.1 m, E = 1 GPa, q = 981 N/m2: centre deflection in mm, n x n elements
PLATES = {
    ("hinged", 0.0): {2: 139.6579, 4: 136.6722, 6: 136.6352, 8: 136.6324, 10: 136.6319},
    ("hinged", 0.3): {2: 128.2378, 4: 125.4112, 6: 125.3682, 8: 125.3644, 10: 125.3638},
    ("hinged, free in plane", 0.0): {2: 238.9972, 4: 238.2486, 6: 239.2995, 8: 239.4612, 10: 239.5021},
    ("hinged, free in plane", 0.3): {2: 232.1196, 4: 231.5069, 6: 232.3964, 8: 232.5319, 10: 232.5664},
    ("clamped", 0.0): {2: 103.9029, 4: 99.7843, 6: 100.3091, 8: 100.4399, 10: 100.4792},
    ("clamped", 0.3): {2: 96.5760, 4: 92.0416, 6: 92.4789, 8: 92.5896, 10: 92.6231},
    ("clamped, free in plane", 0.0): {2: 117.6318, 4: 118.8474, 6: 119.5508, 8: 119.7003, 10: 119.7406},
    ("clamped, free in plane", 0.3): {2: 112.0928, 4: 112.2511, 6: 112.8183, 8: 112.9389, 10: 112.9715},
}

# Membrane 2 x 1 m, h = 0.01 m, 1000 kg/m3, nu = 0.3, held at its corners: centre, middle of a long edge [m]
MEMBRANES = {
    (2, 1): (0.54717, 0.51369),
    (4, 2): (0.56131, 0.54170),
    (8, 4): (0.57622, 0.55395),
    (16, 8): (0.58424, 0.56171),
    (32, 16): (0.58911, 0.56645),
}


def settled(
    bodies: Sequence[Any], forces: Sequence[Any] = (DOWN,), joints: Sequence[Any] = ()
) -> tuple[Layout, Any]:
    """A scene in equilibrium, and the report on it."""
    layout = pack_scene(Scene(bodies=tuple(bodies), forces=tuple(forces), joints=tuple(joints)))
    return layout, find_equilibrium(StartRows(layout))


def coordinates(layout: Layout, body: MeshBody) -> np.ndarray:
    """Nodal vectors of the first mesh, shape (nodes, vectors, 3)."""
    mesh = next(kind for kind in layout.bodies if hasattr(kind, "nodal_mass"))
    lanes, rows = len(mesh.shape[1]), len(mesh.shape[0])
    return mesh.position.reshape(-1, lanes)[: len(body.nodes), :rows].reshape(len(body.nodes), -1, 3)


def frame(count: int, section: FrameSection, supports: dict[str, dict[str, str]], **more: Any) -> FrameBody:
    """A straight frame of 10 m along x; supports by end."""
    mesh = line([0.0, 0.0, 0.0], more.pop("end", [10.0, 0.0, 0.0]), count)
    nodes = {"first": 0, "last": count}
    return FrameBody(
        name=more.pop("name", "beam"),
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(section,),
        supports=tuple(Support(np.array([nodes[end]]), fixed) for end, fixed in supports.items()),
        **more,
    )


PIN, CLAMP = {"position": "xyz"}, {"position": "xyz", "tangent": "xyz"}
ROD = FrameSection(7850.0, 2.1e11, 7.854e-5, 4.909e-10)
"""Steel, 10 mm in diameter."""


@pytest.mark.parametrize(("support", "case", "model"), list(FRAMES))
def test_frames_sag_as_tabulated(support: str, case: int, model: Any) -> None:
    density, modulus = SECTIONS[case]
    section = FrameSection(density, modulus, np.pi / 4.0, np.pi / 64.0)
    supports = {"first": PIN, "last": PIN} if support == "pinned" else {"first": CLAMP}
    found = []
    for count in COUNTS:
        body = frame(count, section, supports, model=model)
        layout, report = settled([body])
        assert report.residual < 1e-7  # rounding: strains of 1e-7 are differences of squares of one
        q = coordinates(layout, body)
        i, j = (count // 2, (count + 1) // 2) if support == "pinned" else (count, count)
        # cubic in the middle of an element of length l: (r + r)/2 + l (r' - r')/8
        found.append(
            -1e3 * float(0.5 * (q[i, 0, 2] + q[j, 0, 2]) + (q[i, 1, 2] - q[j, 1, 2]) * 10.0 / count / 8.0)
        )
    assert found == pytest.approx(FRAMES[support, case, model], rel=1e-5, abs=0.6e-4)


def plate(count: int, ratio: float, support: str) -> ShellBody:
    mesh = rectangle(10.0, 10.0, count, count)
    middle = count // 2 * (count + 1) + np.arange(count + 1), np.arange(count + 1) * (count + 1) + count // 2
    held: list[Support] = []
    free = "free in plane" in support
    for edges, along, across in (
        (("x_min", "x_max"), "slope_y", "slope_x"),
        (("y_min", "y_max"), "slope_x", "slope_y"),
    ):
        nodes = np.concatenate([mesh.edges[edge] for edge in edges])
        fixed = {"position": "z", along: "z"} if free else {"position": "xyz", along: "xyz"}
        if "clamped" in support:
            fixed |= {across: "z", "twist": "z"}
        held.append(Support(nodes, fixed))
    if free:  # lines of symmetry stay where they are
        held += [Support(middle[0], {"position": "x"}), Support(middle[1], {"position": "y"})]
    return ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.1, 1000.0, 1e9, ratio),),
        supports=tuple(held),
        loads=(DistributedLoad(np.array([0.0, 0.0, -981.0])),),
    )


@pytest.mark.parametrize(
    ("support", "ratio", "count"),
    [
        pytest.param(support, ratio, count, marks=[pytest.mark.slow] if count > 4 else [])
        for (support, ratio), row in PLATES.items()
        for count in row
    ],
)
def test_plates_sag_as_tabulated(support: str, ratio: float, count: int) -> None:
    body = plate(count, ratio, support)
    layout, report = settled([body], [])
    assert report.residual < 1e-9
    centre = count // 2 * (count + 1) + count // 2
    assert -1e3 * coordinates(layout, body)[centre, 0, 2] == pytest.approx(
        PLATES[support, ratio][count], rel=1e-3
    )


def membrane(nx: int, ny: int, **more: Any) -> ShellBody:
    mesh = rectangle(2.0, 1.0, nx, ny)
    corners = np.array([0, ny, nx * (ny + 1), nx * (ny + 1) + ny])
    return ShellBody(
        name="membrane",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(0.01, 1000.0, 1e5, 0.3),),
        supports=(Support(corners, {"position": "xyz"}),),
        **more,
    )


@pytest.mark.parametrize(
    "size", [pytest.param(size, marks=[pytest.mark.slow] if size[0] > 8 else []) for size in MEMBRANES]
)
def test_a_heavy_membrane_hangs_as_tabulated(size: tuple[int, int]) -> None:
    nx, ny = size
    body = membrane(nx, ny)
    layout, report = settled([body])
    assert report.residual < 1e-10
    q = coordinates(layout, body)
    edge = -q[nx // 2 * (ny + 1), 0, 2]
    if ny > 1:
        centre = -q[nx // 2 * (ny + 1) + ny // 2, 0, 2]
    else:  # in the middle of the common side of two elements, 1 m long
        a, b = q[nx // 2 * 2], q[nx // 2 * 2 + 1]
        centre = -(0.5 * (a[0, 2] + b[0, 2]) + (a[2, 2] - b[2, 2]) / 8.0)
    assert (centre, edge) == pytest.approx(MEMBRANES[size], rel=1e-3)


# ---- two straight frames that lean on each other: EA (H^2 - z^2) z / L^3, as strains are uniform ----

HEIGHT, STIFFNESS = 0.2, 1e4


def apex_load(z: float) -> float:
    return STIFFNESS * (HEIGHT**2 - z**2) * z / (1.0 + HEIGHT**2) ** 1.5


LIMIT = apex_load(HEIGHT / np.sqrt(3.0))


def leaning(load: float) -> tuple[list[FrameBody], list[Any], list[Ball]]:
    """Frames from (-1, 0, 0) and (1, 0, 0) m to a ball joint at the apex, which is loaded downwards."""
    apex = np.array([0.0, 0.0, HEIGHT])
    bodies = []
    for name, x in (("left", -1.0), ("right", 1.0)):
        mesh = line([x, 0.0, 0.0], apex, 2)
        supports = [
            Support(np.array([0]), PIN),
            *([Support(np.array([2]), {"position": "y"})] if x < 0.0 else []),
        ]
        bodies.append(
            FrameBody(
                name=name,
                nodes=mesh.nodes,
                tangents=mesh.tangents,
                elements=mesh.elements,
                sections=(FrameSection(1.0, STIFFNESS, 1.0, 0.04),),
                supports=tuple(supports),
            )
        )
    force = PointForce("load", "left", apex, np.zeros(1), np.array([[0.0, 0.0, -load]]))
    joint = Ball(
        name="apex", body_a="left", body_b="right", frame_a=JointFrame(apex), frame_b=JointFrame(apex)
    )
    return bodies, [force], [joint]


@pytest.mark.slow
@pytest.mark.parametrize("part", [0.5, 0.99, 1.5])
def test_a_toggle_stands_below_its_limit_load_and_snaps_through_above(part: float) -> None:
    layout, report = settled(*leaning(part * LIMIT))
    z = coordinates(layout, leaning(1.0)[0][0])[2, 0, 2]
    assert apex_load(z) == pytest.approx(part * LIMIT, rel=1e-8)
    assert (z > HEIGHT / np.sqrt(3.0)) if part < 1.0 else (z < -HEIGHT)
    assert ("limit point near 0.66" in report.text) == (part > 1.0)


def test_a_small_load_on_a_thin_plate_is_balanced_to_the_rounding_of_its_forces() -> None:
    """1 N at the end of a strip of 4 x 1 m of 20 mm steel: forces in its plane round to 1e-5 of that; P L^3/(3 E I)."""
    thickness, modulus = 0.02, 2.06e11
    mesh = rectangle(4.0, 1.0, 16, 4)
    edge = mesh.edges["x_min"]
    fixed = {"position": "xyz", "slope_x": "xyz", "slope_y": "xyz", "twist": "xyz"}
    strip = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(thickness, 7850.0, modulus, 0.0),),
        supports=(Support(edge, fixed),),
    )
    down = np.array([[0.0, 0.0, -0.5]])
    ends = [PointForce(f"push{y:g}", "plate", np.array([4.0, y, 0.0]), np.zeros(1), down) for y in (0.0, 1.0)]
    layout, report = settled([strip], ends)
    assert report.iterations < 20
    tip = mesh.edges["x_max"]
    deflection = 4.0**3 / (3.0 * modulus * thickness**3 / 12.0)
    np.testing.assert_allclose(coordinates(layout, strip)[tip, 0, 2], -deflection, rtol=2e-3)
    # without torsion but bent a little across, as loads are at corners
    assert -coordinates(layout, strip)[tip, 0, 2].mean() == pytest.approx(deflection, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("thickness", "load"), [(0.1, 60.0), (0.02, 1.0), (0.02, 1e-3), (5e-3, 4e-4), (1e-3, 6e-7), (1e-3, 6e-9)]
)
def test_deflections_of_plates_are_those_of_linear_theory_however_small_the_load(
    thickness: float, load: float
) -> None:
    """A plate of 20 x 10 m, clamped at one end, with a load at a corner: w D/P of Kirchhoff's theory for any P.

    The largest deflection is a tenth of the thickness, whose membrane forces change it by 2e-6.
    """
    modulus, poisson_ratio = 2.06e11, 0.3
    mesh = rectangle(20.0, 10.0, 16, 8)
    fixed = {"position": "xyz", "slope_x": "xyz", "slope_y": "xyz", "twist": "xyz"}
    plate = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(thickness, 7850.0, modulus, poisson_ratio),),
        supports=(Support(mesh.edges["x_min"], fixed),),
    )
    corner = np.array([20.0, 10.0, 0.0])
    push = PointForce("push", "plate", corner, np.zeros(1), np.array([[0.0, 0.0, -load]]))
    layout, report = settled([plate], [push])
    assert report.iterations < 40
    stiffness = modulus * thickness**3 / (12.0 * (1.0 - poisson_ratio**2))
    deflections = -coordinates(layout, plate)[mesh.edges["x_max"], 0, 2] * stiffness / load
    np.testing.assert_allclose(deflections, kirchhoff_deflections(poisson_ratio), rtol=3e-6)


def kirchhoff_deflections(poisson_ratio: float) -> np.ndarray:
    """Of the free end of that plate for a unit load at its corner and a unit stiffness, shape (9,), by scikit-fem.

    With the rectangles of Bogner, Fox and Schmit, whose functions those of the shell are.
    """
    from skfem import Basis, BilinearForm, ElementQuadBFS, MeshQuad, condense, solve
    from skfem.helpers import dd, ddot, eye, trace

    mesh = MeshQuad.init_tensor(np.linspace(0.0, 20.0, 17), np.linspace(0.0, 10.0, 9))
    basis = Basis(mesh, ElementQuadBFS(), intorder=8)

    @BilinearForm  # type: ignore[untyped-decorator]
    def bending(u, v, _):  # type: ignore[no-untyped-def]
        moment = (1.0 - poisson_ratio) * dd(u) + poisson_ratio * eye(trace(dd(u)), 2)
        return ddot(moment, dd(v))

    x, y = mesh.p
    end = np.flatnonzero(x == 20.0)
    end = end[np.argsort(y[end])]
    force = np.zeros(basis.N)
    force[basis.nodal_dofs[0, end[-1]]] = 1.0
    clamped = basis.get_dofs(nodes=np.flatnonzero(x == 0.0)).all(["u", "u_x", "u_y", "u_xy"])
    found: np.ndarray = solve(*condense(bending.assemble(basis), force, D=clamped))
    return found[basis.nodal_dofs[0, end]]


@pytest.mark.slow
def test_a_body_hung_from_the_middle_of_an_element_pulls_like_a_force() -> None:
    mass, place = 50.0, np.array([6.2, 0.0, 0.0])
    beam = frame(4, FrameSection(1000.0, 1e9, 0.01, 1e-5), {"first": CLAMP})
    ball = RigidBody("ball", mass, np.eye(3), position=place - [0.0, 0.0, 1.0])
    joint = Ball(
        name="pin",
        body_a="beam",
        body_b="ball",
        frame_a=JointFrame(place),
        frame_b=JointFrame(np.array([0.0, 0.0, 1.0])),
    )
    hung, report = settled([beam, ball], joints=[joint])
    pull = PointForce("pull", "beam", place, np.zeros(1), np.array([[0.0, 0.0, -9.81 * mass]]))
    pulled, _ = settled([beam], [DOWN, pull])
    assert coordinates(hung, beam) == pytest.approx(coordinates(pulled, beam), abs=1e-8)
    system = hung.systems[0]
    reaction = system.rows[0].reaction[:3]
    assert np.linalg.norm(reaction) == pytest.approx(9.81 * mass, rel=1e-8)
    assert "'ball' can turn" in report.text


@pytest.mark.slow
def test_a_frame_hangs_in_ropes_that_carry_its_weight() -> None:
    stiffness, length = 1e4, 4.9
    body = frame(4, FrameSection(7850.0, 2.1e11, 1e-3, 1e-7), {})
    tops = {x: np.array([x, 0.0, 5.0]) for x in (2.5, 7.5)}
    ropes = [
        SpringRope(
            name=f"rope {x}",
            path=(RopePoint(GROUND, top), RopePoint("beam", np.array([x, 0.0, 0.0]))),
            length=length,
            stiffness=stiffness,
        )
        for x, top in tops.items()
    ]
    layout = pack_scene(Scene(bodies=(body,), forces=(DOWN,), ropes=tuple(ropes)))
    find_equilibrium(StartRows(layout))
    q = coordinates(layout, body)
    pull = np.zeros(3)
    for node, top in zip((1, 3), tops.values(), strict=True):
        along = top - q[node, 0]
        distance = np.linalg.norm(along)
        pull += stiffness * (distance - length) * along / distance
    assert pull == pytest.approx([0.0, 0.0, 7850.0 * 1e-3 * 10.0 * 9.81], rel=1e-7, abs=1e-5)


def test_the_stiffness_of_a_scene_is_the_derivative_of_its_forces() -> None:
    """Joints, follower loads, body-fixed forces and rigid bodies included, away from the start."""
    section = FrameSection(1000.0, 1e7, 0.01, 1e-4)
    loads = (
        FollowerLoad(normal=30.0, tangential=10.0, axis=np.array([0.2, 1.0, 0.0])),
        FollowerLoad(normal=-5.0, tangential=20.0, axis=np.array([0.0, 1.0, 0.5]), node=3),
    )
    beam = frame(3, section, {"first": CLAMP}, loads=loads)
    place = np.array([4.0, 0.0, 0.0])
    ball = RigidBody("ball", 30.0, np.diag([1.0, 2.0, 2.5]), position=place - [0.0, 0.0, 1.0])
    joint = Ball(
        name="pin",
        body_a="beam",
        body_b="ball",
        frame_a=JointFrame(place),
        frame_b=JointFrame(np.array([0.0, 0.0, 1.0])),
    )
    layout = pack_scene(Scene(bodies=(beam, ball), forces=(DOWN,), joints=(joint,)))
    system = MeshSystem(StartRows(layout))
    random = np.random.default_rng(3)
    system.move(0.05 * random.normal(size=system.count))
    multipliers = 200.0 * random.normal(size=3)

    def force() -> np.ndarray:
        return 0.7 * system.external_force() - system.internal_force() + system.joints()[0].T @ multipliers

    K = system.tangent(0.7, multipliers).toarray()
    before, found = system.snapshot(), np.zeros_like(K)
    for i in range(system.count):
        for sign in (1.0, -1.0):
            step = np.zeros(system.count)
            step[i] = sign * 1e-5
            system.move(step)
            found[:, i] -= sign * force() / 2e-5
            system.restore(before)
    assert pytest.approx(found, abs=1e-6 * float(np.abs(K).max())) == K
    # rows are the derivative of the gaps
    G = system.joints()[0].toarray()
    for i in range(system.count):
        gaps = []
        for sign in (1.0, -1.0):
            step = np.zeros(system.count)
            step[i] = sign * 1e-6
            system.move(step)
            gaps.append(system.joints()[1])
            system.restore(before)
        assert G[:, i] == pytest.approx((gaps[0] - gaps[1]) / 2e-6, abs=1e-7)


def test_a_flexible_frame_under_pressure_takes_the_shape_of_an_arc() -> None:
    # T R = p with the pressure per length before stretching; T = EA e l and l^2 = 1 + 2 e by the strain of Green
    from scipy.optimize import brentq

    stiffness, pressure, count = 1e5, 1e3, 16
    body = frame(
        count,
        FrameSection(1.0, stiffness, 1.0, 1e-9),
        {"first": PIN, "last": PIN},
        end=[2.0, 0.0, 0.0],
        loads=(FollowerLoad(normal=pressure, axis=np.array([0.0, 1.0, 0.0])),),
    )

    def excess(radius: float) -> float:
        stretch = brentq(lambda l: stiffness * (l * l - 1.0) / 2.0 * l - pressure * radius / l, 1.0, 3.0)
        return 2.0 * stretch - 2.0 * radius * float(np.arcsin(1.0 / radius))

    radius = brentq(excess, 1.0001, 50.0)
    layout, _ = settled([body], [])
    sag = radius - np.sqrt(radius**2 - 1.0)
    assert -coordinates(layout, body)[count // 2, 0, 2] == pytest.approx(sag, rel=1e-5)


def test_a_column_stands_below_its_buckling_load_and_bends_above() -> None:
    # elastica: P / P_cr = (2 K(k) / pi)^2, deflection in the middle / length = k / K(k)
    from scipy.optimize import brentq
    from scipy.special import ellipk

    section = FrameSection(1.0, 1e9, 1e-2, 1e-6)
    critical = np.pi**2 * 1e9 * 1e-6 / 100.0
    for part in (0.98, 1.02):
        body = frame(24, section, {"first": PIN, "last": {"position": "yz"}}, model="exact")
        end = np.array([10.0, 0.0, 0.0])
        push = PointForce("push", "beam", end, np.zeros(1), np.array([[-part * critical, 0.0, 0.0]]))
        layout, _ = settled([body], [push])
        bent = float(np.linalg.norm(coordinates(layout, body)[12, 0, 1:]))
        if part < 1.0:
            assert bent < 1e-6
        else:
            k2 = brentq(lambda k2: 2.0 * ellipk(k2) / np.pi - np.sqrt(1.02), 1e-9, 0.5)
            assert bent / 10.0 == pytest.approx(np.sqrt(k2) / ellipk(k2), rel=2e-3)


def test_a_pinned_frame_comes_to_hang_with_the_stretch_of_its_weight() -> None:
    body = frame(5, ROD, {"first": PIN}, end=[0.0, 0.0, 10.0])  # upright, where it cannot stay
    layout, report = settled([body])
    q = coordinates(layout, body)
    stretch = 7850.0 * 9.81 * 10.0**2 / (2.0 * 2.1e11)
    assert q[5, 0] == pytest.approx([0.0, 0.0, -10.0 - stretch], abs=1e-6)
    assert "'beam' can turn about" in report.text


@pytest.mark.slow
def test_the_state_after_the_search_is_at_rest_and_unstrained_beyond_its_shape() -> None:
    body = frame(4, ROD, {"first": CLAMP}, velocity=np.array([1.0, 0.0, 0.0]))
    layout, report = settled([body])
    kind = layout.bodies[0]
    assert not kind.velocity.any()
    assert np.abs(kind.strain).max() > 0.0
    q = coordinates(layout, body)
    assert report.moved == pytest.approx(np.linalg.norm(q[:, 0] - body.nodes, axis=1).max())


@pytest.mark.parametrize("moved", ["frame", "shell"])
def test_relaxation_ends_where_newton_does(moved: str) -> None:
    body: MeshBody = (
        frame(4, ROD, {"first": CLAMP}, end=[2.0, 0.0, 0.0]) if moved == "frame" else membrane(2, 1)
    )
    layout, _ = settled([body])
    relaxed = pack_scene(Scene(bodies=(body,), forces=(DOWN,)))
    report = relax_to_equilibrium(StartRows(relaxed))
    assert coordinates(relaxed, body) == pytest.approx(coordinates(layout, body), abs=1e-7)
    assert "dissipated" in report.text


@pytest.mark.parametrize(
    ("supports", "words"),
    [
        ({}, ["'beam' can move in all directions and turn about"]),
        ({"first": {"position": "xy"}, "last": {"position": "xy"}}, ["'beam' can", "slide along z"]),
    ],
)
def test_an_unsupported_frame_is_refused_by_its_free_motion(
    supports: dict[str, Any], words: list[str]
) -> None:
    with pytest.raises(InputError, match="no static equilibrium") as caught:
        settled([frame(2, ROD, supports)])
    assert all(word in str(caught.value) for word in words)


def test_an_unsupported_plate_is_refused_by_its_free_motion() -> None:
    body = plate(2, 0.3, "hinged")
    with pytest.raises(InputError, match="'plate' can move in all directions and turn about all directions"):
        settled([replace(body, supports=())], [])


def test_a_mechanism_of_two_meshes_that_sinks_is_named() -> None:
    bodies, forces, joints = leaning(1.0)
    loose = [replace(body, supports=()) for body in bodies]
    with pytest.raises(InputError, match=r"'left' can .*'right' can"):
        settled(loose, forces, joints)


def test_a_beam_that_is_at_rest_already_takes_no_search() -> None:
    """Nothing is loaded, and nothing holds the rigid tip about the axis of a beam without torsion."""
    beam = frame(4, FrameSection(1000.0, 1e9, 0.01, 1e-7), {"first": CLAMP})
    tip = RigidBody("tip", 1.0, np.eye(3), position=np.array([10.0, 0.0, 0.0]))
    end = JointFrame(np.array([10.0, 0.0, 0.0]))
    joint = FixedJoint(name="end", body_a=beam.name, body_b="tip", frame_a=end)
    _, found = settled([beam, tip], forces=(), joints=[joint])
    assert found.iterations < 20
    assert found.moved < 1e-9
    assert "no loads" in found.text


def test_a_plate_on_four_slings_of_one_hook() -> None:
    """Free to turn about the vertical: steps along that lead nowhere. The slings carry the weight, each a quarter."""
    size, thick, density, reach = (16.0, 8.0), 0.05, 7850.0, 12.0
    mesh = rectangle(*size, 8, 4)
    plate = ShellBody(
        name="plate",
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(ShellSection(thick, density, 210e9, 0.3),),
    )
    hook = np.array([8.0, 4.0, reach])
    ropes = tuple(
        Rope(
            name=f"sling_{i}",
            path=(RopePoint(GROUND, hook), RopePoint("plate", np.array([x, y, 0.0]))),
            axial_stiffness=60e6,
        )
        for i, (x, y) in enumerate([(2.0, 2.0), (14.0, 2.0), (2.0, 6.0), (14.0, 6.0)])
    )
    layout = pack_scene(Scene(bodies=(plate,), forces=(DOWN,), ropes=ropes))
    rows = StartRows(layout)
    found = find_equilibrium(rows)
    assert found.iterations < 100
    assert found.residual < 1e-6
    kind = next(kind for kind in layout.joints if hasattr(kind, "tension_at_rest"))
    for i in range(4):
        path = kind.path[kind.table[i].first :][:2]
        step = path[1].centre - path[0].centre
        vertical = kind.tension_at_rest(i)[0] * step[2] / np.linalg.norm(step)
        assert vertical == pytest.approx(-density * thick * size[0] * size[1] * 9.81 / 4.0, rel=1e-4)
