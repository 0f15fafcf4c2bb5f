"""Markers and rows of joints on frames and shells against plain geometry and differences, in one compiled scene."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

sys.path.append(str(Path(__file__).resolve().parents[1] / "joints"))
from joint_scenes import RESIDUALS, Pose, make_joint

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.ancf.accurate import write_second_rates
from heavylift.solver.bodies.ancf.kind import FrameMeshes, ShellMeshes
from heavylift.solver.forces.point import PointForce
from heavylift.solver.integrate.loop import start_scene
from heavylift.solver.interface import (
    RECORD,
    fill_bias,
    fill_markers,
    fill_rows,
    set_targets,
    write_velocity,
)
from heavylift.solver.joints.edges import EdgeClamp, EdgeHinge
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.mesh_shapes import line, quadrilateral, rectangle
from heavylift.solver.scene.meshes import FrameBody, FrameSection, ShellBody, ShellSection
from heavylift.solver.scene.scene import RigidBody, Scene

ON_SHELLS = ("ball", "distance", "fixed", "hinge", "planar", "slider", "universal")
BENT = np.array([[0.0, 0.0, 0.0], [1.2, 0.1, 0.0], [1.1, 0.9, 0.0], [-0.1, 0.8, 0.0]])


@kernel
def probe(bodies: Any, joints: Any, system: Any, work: Any) -> None:
    """All rows and markers at the carried state."""
    fill_markers(bodies, False, RECORD, work)
    fill_rows(joints, True, work, system)
    set_targets(joints, 0.0, 0.1, False, work, system)
    write_velocity(bodies, work)


@kernel
def probe_second_rates(kind: Any, work: Any) -> None:
    """Second rates of the markers on a mesh without accelerations of its nodes."""
    write_second_rates(kind, RECORD, work)


@kernel
def probe_targets(joints: Any, system: Any, work: Any) -> None:
    """Targets of accelerations."""
    fill_bias(joints, 0.0, work, system)


def cubic(t: float, derivative: int = 0) -> np.ndarray:
    """Hermite polynomials: value at 0, slope at 0, value at 1, slope at 1."""
    powers = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
    for _ in range(derivative):
        powers = powers[:, 1:] * np.arange(1, powers.shape[1])
    return powers @ t ** np.arange(powers.shape[1])


def pose_of(body: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(body.position), Rotation.from_quat(body.orientation, scalar_first=True).as_matrix()


@dataclass
class Spot:
    """A material point: body, element, place on it."""

    body: Any
    element: int
    local: tuple[float, ...]

    def vector(self, q: np.ndarray, which: int) -> np.ndarray:
        """A vector of the nodes at the point, in body axes, from those of the nodes, shape (n, vectors, 3)."""
        nodes = q[self.body.elements[self.element]]
        if isinstance(self.body, FrameBody):
            places = self.body.nodes[self.body.elements[self.element]]
            length = np.linalg.norm(places[1] - places[0])
            h = cubic(self.local[0], which) * [1.0, length, 1.0, length] / length**which
            return h @ nodes.reshape(4, 3)
        lengths = self.body.lengths[self.element]
        dx, dy = ((0, 0), (1, 0), (0, 1), (1, 1))[which]
        fx = cubic(self.local[0], dx) * [1.0, lengths[0], 1.0, lengths[0]] / lengths[0] ** dx
        fy = cubic(self.local[1], dy) * [1.0, lengths[1], 1.0, lengths[1]] / lengths[1] ** dy
        total = np.zeros(3)
        for node, (i, j) in zip(nodes, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
            for slope, (k, m) in zip(node, ((0, 0), (1, 0), (0, 1), (1, 1)), strict=True):
                total += fx[2 * i + k] * fy[2 * j + m] * slope
        return total

    def triad(self, q: np.ndarray) -> np.ndarray:
        """Axes of the slopes in body axes, as columns."""
        a, b = self.vector(q, 1), self.vector(q, 2)
        first, third = a / np.linalg.norm(a), np.cross(a, b) / np.linalg.norm(np.cross(a, b))
        return np.column_stack([first, np.cross(third, first), third])

    @property
    def start(self) -> np.ndarray:
        """Vectors of all nodes of the body, unloaded."""
        if isinstance(self.body, FrameBody):
            return np.stack([self.body.nodes, self.body.tangents], axis=1)
        return np.concatenate([self.body.nodes[:, None], self.body.slopes], axis=1)

    @property
    def point(self) -> np.ndarray:
        return self.vector(self.start, 0)


@dataclass
class Model:
    """The packed scene, and what each joint keeps in plain geometry."""

    rng: np.random.Generator
    bodies: dict[str, Any]
    layout: Any = None
    joints: list[Any] = field(default_factory=list)
    spots: dict[tuple[str, str], Spot] = field(default_factory=dict)
    offsets: dict[str, int] = field(default_factory=dict)

    def pack(self, forces: tuple[Any, ...]) -> None:
        self.layout = pack_scene(Scene(tuple(self.bodies.values()), forces, joints=tuple(self.joints)))
        self.layout.joints.need("accurate")
        self.layout.bodies.need("thesis")  # where velocities of the carried state are asked for
        start_scene(self.layout.bodies, self.layout.work, 0.0)
        self.kinds = [kind for kind in self.layout.bodies if isinstance(kind, (FrameMeshes, ShellMeshes))]
        for kind, of_type in zip(self.kinds, (FrameBody, ShellBody), strict=True):
            for line_of, body in zip(
                kind.table, [b for b in self.bodies.values() if isinstance(b, of_type)], strict=True
            ):
                self.offsets[body.name] = int(line_of[3])
        self.start = [kind.position.copy() for kind in self.kinds]

    def mesh(self, name: str, vector: str = "position") -> np.ndarray:
        """Coordinates of the nodes of a mesh, shape (n, 3 vectors), a view."""
        body = self.bodies[name]
        kind = self.kinds[isinstance(body, ShellBody)]
        lanes, rows = len(kind.shape[1]), len(kind.shape[0])
        first = self.offsets[name]
        return getattr(kind, vector).reshape(-1, lanes)[first : first + len(body.nodes), :rows]

    def q(self, name: str) -> np.ndarray:
        """Vectors of the nodes of a mesh, shape (n, vectors, 3)."""
        nodes = self.mesh(name)
        return nodes.reshape(len(nodes), -1, 3)

    def meshes(self) -> list[str]:
        return [name for name, body in self.bodies.items() if not isinstance(body, RigidBody)]

    def bend(self, seed: int) -> None:
        """All meshes deformed and moving."""
        rng = np.random.default_rng(seed)
        for kind, start in zip(self.kinds, self.start, strict=True):
            kind.position[:] = start
            kind.velocity[:] = 0.0
        for name in self.meshes():
            self.mesh(name)[...] += 0.15 * rng.normal(size=self.mesh(name).shape)
            self.mesh(name, "velocity")[...] = rng.normal(size=self.mesh(name).shape)

    def rest(self, *, keep_velocity: bool = False) -> None:
        """The shape of the start."""
        for kind, start in zip(self.kinds, self.start, strict=True):
            kind.position[:] = start
            if not keep_velocity:
                kind.velocity[:] = 0.0

    def shift(self, step: float) -> None:
        for kind in self.kinds:
            kind.position[:] += step * kind.velocity

    def fill(self) -> None:
        layout = self.layout
        layout.work.jacobian[:] = 0.0
        probe(layout.bodies, layout.joints, layout.systems[0], layout.work)

    def along(self, find: Any, h: float = 1e-5) -> Any:
        """Central difference of fourth order along the velocities of the meshes."""
        values = []
        for i in (-2, -1, 1, 2):
            self.shift(i * h)
            self.fill()
            values.append(np.array(find()))
            self.shift(-i * h)
        self.fill()
        return (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * h)

    def targets(self, name: str) -> np.ndarray:
        """Of the accelerations of the rows of a joint."""
        layout = self.layout
        self.fill()
        for kind in self.kinds:
            probe_second_rates(kind, layout.work)
        probe_targets(layout.joints, layout.systems[0], layout.work)
        block = self.block(name)
        return self.table[block].target[self.table[block].scale > 0.0].copy()

    def second(self, name: str, h: float = 1e-3) -> np.ndarray:
        """Second difference of the residual of a joint along even motions of all nodes."""
        values = []
        for i in (-2, -1, 0, 1, 2):
            self.shift(i * h)
            self.fill()
            values.append(self.residual(name).copy())
            self.shift(-i * h)
        return (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (12 * h * h)

    @property
    def table(self) -> Any:
        return self.layout.systems[0].rows

    def block(self, name: str) -> int:
        return self.layout.block_names.index(name)

    def rows(self, name: str) -> np.ndarray:
        """Jacobian of a joint over all velocities of the workspace."""
        system, block = self.layout.systems[0], self.block(name)
        lanes = len(system.shape[1])
        J = np.zeros((lanes, len(self.layout.work.velocity)))
        for side in (0, 1):
            entry = system.attachments[2 * block + side]
            panel = system.panels[entry.panel : entry.panel + entry.width * lanes].reshape(-1, lanes)
            J[:, entry.dof : entry.dof + entry.width] += panel.T
        return J[self.table[block].scale > 0.0]

    def residual(self, name: str) -> np.ndarray:
        block = self.block(name)
        return self.table[block].residual[self.table[block].scale > 0.0]

    def side(self, joint: Any, side: str) -> Pose:
        """Joint frame in the world: fixed in the triad of the point on a shell."""
        name, frame = (getattr(joint, f"{what}_{side}") for what in ("body", "frame"))
        if name == GROUND:
            return Pose(frame.point, frame.axes)
        position, R = pose_of(self.bodies[name])
        if isinstance(self.bodies[name], RigidBody):
            return Pose(position + R @ frame.point, R @ frame.axes)
        spot, q = self.spots[joint.name, side], self.q(name)
        axes = frame.axes
        if isinstance(self.bodies[name], ShellBody):
            axes = spot.triad(q) @ spot.triad(spot.start).T @ axes
        return Pose(position + R @ spot.vector(q, 0), R @ axes)


SECTION = FrameSection(density=7800.0, youngs_modulus=2e8, area=0.01, second_moment=3e-4)
SHEET = ShellSection(0.01, 7850.0, 2e8, 0.3)


def frame(name: str, place: np.ndarray, turn: Rotation) -> FrameBody:
    mesh = line([0.0, 0.0, 0.0], [1.0, 2.0, -0.5], 3)
    return FrameBody(
        name=name,
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(SECTION,),
        position=place,
        orientation=turn.as_quat(scalar_first=True),
    )


def shell(name: str, mesh: Any, place: np.ndarray, turn: Rotation) -> ShellBody:
    return ShellBody(
        name=name,
        nodes=mesh.nodes,
        slopes=mesh.slopes,
        elements=mesh.elements,
        lengths=mesh.lengths,
        sections=(SHEET,),
        position=place,
        orientation=turn.as_quat(scalar_first=True),
    )


@pytest.fixture(scope="module")
def model() -> Model:
    rng = np.random.default_rng(3)
    turns = [Rotation.random(rng=rng) for _ in range(6)]
    strip = rectangle(1.0, 0.6, 2, 2)
    local = axes_about(np.array([1.0, 2.0, -0.5]))
    flip = np.diag([1.0, -1.0, -1.0])  # the second frame runs the other way
    turns[2] = turns[1] * Rotation.from_matrix(local @ (local @ flip).T)
    bodies: dict[str, Any] = {
        "rod": RigidBody(
            "rod", 2.0, np.diag([0.3, 0.4, 0.6]), orientation=turns[0].as_quat(scalar_first=True)
        ),
        "f1": frame("f1", np.array([0.3, -0.2, 0.1]), turns[1]),
        "f2": frame("f2", np.zeros(3), turns[2]),
        "s1": shell("s1", quadrilateral(BENT, 2, 2), np.array([0.5, 0.0, 0.2]), turns[3]),
        "s2": shell("s2", strip, np.array([0.1, 0.2, 0.3]), turns[4]),
        "s3": shell("s3", strip, np.zeros(3), turns[5]),
    }
    model = Model(rng, bodies)

    def frame_at(name: str, spot: Spot | None, point: np.ndarray, axes: np.ndarray) -> JointFrame:
        """World place and axes in the frame of a body."""
        if name == GROUND:
            return JointFrame(point, axes)
        _, R = pose_of(bodies[name])
        return JointFrame(spot.point if spot else R.T @ point, R.T @ axes)

    for i, kind in enumerate(ON_SHELLS):
        b = "rod" if i % 2 else "s2"
        a_spot = Spot(bodies["s1"], i % 4, (0.3 + 0.05 * i, 0.6))
        b_spot = Spot(bodies["s2"], 3, (0.2, 0.1 * i)) if b == "s2" else None
        axes = Rotation.random(rng=rng).as_matrix()
        other = axes @ Rotation.from_rotvec([np.pi / 2, 0, 0]).as_matrix() if kind == "universal" else axes
        a_frame = frame_at("s1", a_spot, np.zeros(3), axes)
        made = make_joint(kind, "s1", b, a_frame, frame_at(b, b_spot, np.zeros(3), other))
        model.joints.append(made)
        model.spots[kind, "a"] = a_spot
        if b_spot:
            model.spots[kind, "b"] = b_spot

    def on_frame(kind: Any, name: str, a: str, b: str, spots: dict[str, Spot], axes: np.ndarray) -> None:
        frames = {side: frame_at(n, spots.get(side), np.zeros(3), axes) for side, n in (("a", a), ("b", b))}
        model.joints.append(kind(name=name, body_a=a, body_b=b, frame_a=frames["a"], frame_b=frames["b"]))
        for side, spot in spots.items():
            model.spots[name, side] = spot

    f1, f2 = (Spot(bodies[name], 1, (0.4,)) for name in ("f1", "f2"))
    tangent = pose_of(bodies["f1"])[1] @ f1.vector(f1.start, 1)
    across = np.linalg.svd(tangent[None])[2][1:]
    tilted = Rotation.random(rng=rng).as_matrix()
    on_frame(FixedJoint, "clamp_rigid", "f1", "rod", {"a": f1}, tilted)
    on_frame(FixedJoint, "clamp_ground", GROUND, "f1", {"b": f1}, tilted)
    on_frame(FixedJoint, "clamp_shell", "s1", "f2", {"a": Spot(bodies["s1"], 2, (0.7, 0.2)), "b": f2}, tilted)
    on_frame(
        Hinge, "hinge_across", "f1", "s2", {"a": f1, "b": Spot(bodies["s2"], 0, (0.5, 0.5))},
        np.column_stack([np.cross(tangent, across[0]), tangent, across[0]]),
    )  # fmt: skip
    on_frame(
        Hinge, "hinge_along", "rod", "f1", {"b": f1},
        np.column_stack([across[0], np.cross(tangent, across[0]), tangent]),
    )  # fmt: skip
    weld = {
        side: JointFrame(spot.point, axes) for side, spot, axes in (("a", f1, local), ("b", f2, local @ flip))
    }
    model.joints.append(
        FixedJoint(name="weld", body_a="f1", body_b="f2", frame_a=weld["a"], frame_b=weld["b"])
    )
    model.spots["weld", "a"], model.spots["weld", "b"] = f1, f2
    edges = {name: rectangle(1.0, 0.6, 2, 2).edges for name in ("s2", "s3")}
    model.joints += [
        EdgeHinge(name="eh", body_a="s2", body_b="rod", nodes_a=edges["s2"]["y_min"]),
        EdgeClamp(name="ec", body_a="s2", body_b=GROUND, nodes_a=edges["s2"]["x_max"]),
        EdgeHinge(
            name="sh",
            body_a="s2",
            body_b="s3",
            nodes_a=edges["s2"]["x_min"],
            nodes_b=edges["s3"]["x_max"][::-1],
        ),
        EdgeClamp(
            name="sc", body_a="s3", body_b="s2", nodes_a=edges["s3"]["y_max"], nodes_b=edges["s2"]["y_min"]
        ),
    ]
    forces = (
        PointForce(
            "push", "s3", Spot(bodies["s3"], 1, (0.3, 0.8)).point, np.zeros(1), np.ones((1, 3)), "body"
        ),
    )
    model.pack(forces)
    return model


@pytest.mark.slow
def test_markers_move_as_their_jacobians_say(model: Model) -> None:
    """Points, tangents, triads and slopes of turned bodies, two and more of a kind; rates and windows of velocities."""
    seen = 0
    for seed in range(3):
        model.bend(seed)
        model.fill()
        work = model.layout.work
        numbers = np.concatenate([kind.markers["number"] for kind in model.kinds])
        slope = model.along(lambda: work.markers["point"][numbers])  # noqa: B023
        np.testing.assert_allclose(work.markers["velocity"][numbers], slope, atol=1e-8)
        for kind in model.kinds:
            for marker in kind.markers:
                number, line = marker.number, kind.table[marker.body]
                first, count = line.dof, 3 * line.base_count
                J = work.jacobian[number]
                rate = J[:, :count] @ work.velocity[first : first + count]
                np.testing.assert_allclose(rate, work.markers[number].velocity, atol=1e-11)
                assert not J[:, count:].any()
                seen += 1
    assert seen > 300


FREE = 1e-8


@pytest.mark.parametrize("seed", range(3))
def test_rows_are_the_rates_of_what_they_keep(model: Model, seed: int) -> None:
    """Jacobians times velocities against differences of the residuals, of all joints far from closed."""
    model.bend(seed)
    model.fill()
    velocity = model.layout.work.velocity.copy()
    for name in model.layout.block_names:
        if name == "weld":
            continue
        rate = model.along(lambda: model.residual(name))  # noqa: B023
        np.testing.assert_allclose(model.rows(name) @ velocity, rate, atol=FREE * max(1, np.abs(rate).max()))


@pytest.mark.parametrize("name", ON_SHELLS)
def test_joints_on_shells_keep_what_they_keep_on_rigid_bodies(model: Model, name: str) -> None:
    """The triad of the slopes carries the joint frame."""
    joint = next(joint for joint in model.joints if joint.name == name)
    for seed in range(3):
        model.bend(seed)
        model.fill()
        expected = RESIDUALS[name](model.side(joint, "a"), model.side(joint, "b"), 0.0)
        np.testing.assert_allclose(model.residual(name), expected, atol=1e-12)


def test_axes_of_a_following_force_are_the_triad_at_its_point(model: Model) -> None:
    """Markers of the point force are the first of the scene: its point, then the axes of the body there."""
    for seed in range(3):
        model.bend(seed)
        model.fill()
        spot, q = Spot(model.bodies["s3"], 1, (0.3, 0.8)), model.q("s3")
        position, R = pose_of(model.bodies["s3"])
        found = model.layout.work.markers[:4]["point"]
        np.testing.assert_allclose(found[0], position + R @ spot.vector(q, 0), atol=1e-13)
        axes = R @ spot.triad(q) @ spot.triad(spot.start).T
        np.testing.assert_allclose(found[1:], axes.T, atol=1e-13)


def test_fixed_joint_in_the_middle_of_a_shell_takes_six_motions(model: Model) -> None:
    """Rank six, of rows as unit vectors; its flat start is no exception."""
    model.rest()
    model.fill()
    rows = model.rows("fixed")
    values = np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True), compute_uv=False)
    assert len(values) == 6
    assert values[-1] > 0.1 * values[0]


@pytest.mark.parametrize("name", ["clamp_rigid", "clamp_ground", "clamp_shell", "weld", "hinge_along"])
def test_clamped_frame_keeps_its_tangent_only(model: Model, name: str) -> None:
    """Five rows: points, and a residual as long as the part of the tangent across its place."""
    joint = next(joint for joint in model.joints if joint.name == name)
    side, other = ("a", "b") if isinstance(model.bodies.get(joint.body_a), FrameBody) else ("b", "a")
    spot = model.spots[name, side]
    own = getattr(joint, f"frame_{side}").axes.T @ spot.vector(spot.start, 1)
    for seed in range(3):
        model.bend(seed)
        model.fill()
        body = getattr(joint, f"body_{side}")
        tangent = pose_of(model.bodies[body])[1] @ spot.vector(model.q(body), 1)
        if name == "weld":
            tip = model.spots[name, other]
            axis = pose_of(model.bodies["f2"])[1] @ tip.vector(model.q("f2"), 1)
            axis, tangent = tangent / np.linalg.norm(tangent), axis
        else:
            axis = model.side(joint, other).axes @ own
        residual = model.residual(name)
        assert len(residual) == 5
        assert np.linalg.norm(residual[3:]) == pytest.approx(
            np.linalg.norm(tangent - (tangent @ axis) * axis), rel=1e-12
        )


def test_weld_follows_both_tangents(model: Model) -> None:
    """Its rows are rates of the residual where it is closed."""
    model.bend(1)
    model.rest(keep_velocity=True)
    model.fill()
    np.testing.assert_allclose(model.residual("weld")[3:], 0.0, atol=1e-14)
    rate = model.along(lambda: model.residual("weld"))
    np.testing.assert_allclose(model.rows("weld") @ model.layout.work.velocity, rate, atol=FREE)


def test_hinge_across_a_frame_keeps_the_tangent_square_to_its_axis(model: Model) -> None:
    joint = next(joint for joint in model.joints if joint.name == "hinge_across")
    spot = model.spots["hinge_across", "a"]
    for seed in range(3):
        model.bend(seed)
        model.fill()
        tangent = pose_of(model.bodies["f1"])[1] @ spot.vector(model.q("f1"), 1)
        assert model.residual("hinge_across")[3:] == pytest.approx(
            [tangent @ model.side(joint, "b").axes[:, 2]]
        )


@pytest.mark.parametrize(("name", "count"), [("eh", 5), ("ec", 7), ("sh", 6), ("sc", 8)])
def test_edges_are_independent_rows_that_start_closed(model: Model, name: str, count: int) -> None:
    """Straight edges: hinge of 5 and clamp of 7 rows a node on a body, of 6 and 8 rows on another shell."""
    model.rest()
    model.fill()
    for node in range(3):
        rows = model.rows(f"{name}.{node}")
        assert len(rows) == count
        values = np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True), compute_uv=False)
        assert values[-1] > 0.1 * values[0]
        if name in ("eh", "ec"):
            np.testing.assert_allclose(model.residual(f"{name}.{node}"), 0.0, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_targets_of_accelerations_are_second_derivatives(model: Model, seed: int) -> None:
    """For integrators that work with accelerations: what the rows would do if no node accelerated."""
    model.bend(seed)
    for name in model.layout.block_names:
        if name != "weld":
            second = model.second(name)
            np.testing.assert_allclose(
                model.targets(name), -second, atol=2e-6 * max(1.0, np.abs(second).max())
            )


def test_weld_bends_as_its_stretch_changes(model: Model) -> None:
    """One linear map moves both frames, and the second stretches as well: the tangents part with the square of time."""
    model.bend(0)
    model.rest(keep_velocity=True)
    rng = np.random.default_rng(4)
    A = 0.3 * rng.normal(size=(3, 3))
    for name, stretch in (("f1", 0.0), ("f2", 0.4)):
        _, R = pose_of(model.bodies[name])
        q = model.q(name) @ R.T
        model.mesh(name, "velocity")[...] = ((q @ A.T + stretch * q) @ R).reshape(len(q), -1)
    second = model.second("weld")
    assert np.abs(second[3:]).max() > 1e-2
    np.testing.assert_allclose(model.targets("weld")[3:], -second[3:], atol=1e-6)
