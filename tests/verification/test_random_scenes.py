"""Scenes made at random against an independent program: mechanisms, slings, floating boxes, balls on a floor.

The oracle (`acceleration_oracle.py`) solves for accelerations and shares nothing with the solver. The midpoint scheme
of the solver is of second order, so that two runs with steps h and h/2 give by extrapolation what a far smaller step
would, and their own difference says how far the steps are from it. Free scenes keep momentum, all without dampers keep
energy.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

sys.path.append(str(Path(__file__).resolve().parent))
import acceleration_oracle as oracle

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.numerics.outcome import Outcome
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.planar import Planar
from heavylift.solver.joints.slider import Slider
from heavylift.solver.joints.slider_hinge import Cylindrical
from heavylift.solver.joints.universal import Universal
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint
from heavylift.solver.scene.contacts import Contact, Contour, LinearLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.scene.sea import Hull, Sea, Water
from heavylift.solver.simulation import Simulation

pytestmark = pytest.mark.slow

G = np.array([0.0, 0.0, -9.81])
JOINTS: dict[str, Any] = {
    "ball": Ball,
    "cylindrical": Cylindrical,
    "fixed": FixedJoint,
    "hinge": Hinge,
    "planar": Planar,
    "slider": Slider,
    "universal": Universal,
}
TIMES = np.array([0.0, 0.2, 0.4, 0.6])


def any_rotation(rng: np.random.Generator) -> NDArray[np.float64]:
    return Rotation.from_rotvec(rng.uniform(-2.0, 2.0, 3)).as_matrix()


def any_body(
    rng: np.random.Generator, place: NDArray[np.float64], speed: float = 0.3, least: float = 10.0
) -> oracle.Body:
    """A body of 10 to 1000 kg that is as good as a solid of half a metre."""
    mass, turn = 10.0 ** rng.uniform(np.log10(least), 3.0), any_rotation(rng)
    inertia = mass * 0.05 * turn @ np.diag(rng.uniform(0.6, 1.4, 3)) @ turn.T
    velocity, spin = rng.uniform(-speed, speed, (2, 3))
    return oracle.Body(mass, inertia, place, any_rotation(rng), velocity, spin)


def solver_body(
    name: str, body: oracle.Body, velocity: Any = None, spin: Any = None, **keys: Any
) -> RigidBody:
    """The same body for the solver; its spin in its own axes."""
    spin = body.spin if spin is None else spin
    return RigidBody(
        name, body.mass, body.inertia, position=body.position,
        orientation=Rotation.from_matrix(body.rotation).as_quat(scalar_first=True),
        velocity=body.velocity if velocity is None else velocity, angular_velocity=body.rotation.T @ spin, **keys,
    )  # fmt: skip


def solver_bodies(model: oracle.Model) -> tuple[RigidBody, ...]:
    """Bodies with the velocities that the constraints let them have."""
    start = model.consistent().reshape(len(model.bodies), 13)
    return tuple(
        solver_body(f"body_{i}", body, start[i, 7:10], start[i, 10:]) for i, body in enumerate(model.bodies)
    )


def histories(
    scene: Scene, step: float, names: list[str], **keys: Any
) -> tuple[NDArray[np.float64], Simulation, Any]:
    """Positions of the origins and rotation vectors at `TIMES`, shape (times, bodies, 3 + 9); simulation; energy."""
    every = round(TIMES[1] / step)
    simulation = Simulation(scene, TIMES[1] / every, record_every=every, **keys)
    first = simulation.record()
    _, rows = simulation.advance(every * (len(TIMES) - 1))
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    records = np.vstack([first, rows])
    columns = {channel.name: channel for channel in simulation.channels}

    def read(name: str) -> NDArray[np.float64]:
        channel = columns[name]
        return records[:, channel.column : channel.column + len(channel.components)]

    out = []
    for name in names:
        turned = Rotation.from_quat(read(f"{name}.orientation"), scalar_first=True).as_matrix()
        out.append(np.hstack([read(f"{name}.position"), turned.reshape(len(records), 9)]))
    return np.stack(out, axis=1), simulation, read


def oracle_histories(model: oracle.Model) -> NDArray[np.float64]:
    states = model.run(TIMES)
    turned = Rotation.from_quat(states[..., 3:7].reshape(-1, 4), scalar_first=True).as_matrix()
    return np.concatenate([states[..., :3], turned.reshape(*states.shape[:2], 9)], axis=2)


def compare(model: oracle.Model, scene: Scene, step: float, tolerance: float) -> Any:
    """Extrapolate from two steps, and hold against the oracle: within the tolerance and their own second order."""
    names = [f"body_{i}" for i in range(len(model.bodies))]
    coarse, _, _ = histories(scene, step, names)
    fine, simulation, read = histories(scene, 0.5 * step, names)
    expected = oracle_histories(model)
    extrapolated = fine + (fine - coarse) / 3.0
    moved = float(np.abs(expected - expected[0]).max())
    error = float(np.abs(extrapolated - expected).max())
    assert moved > 0.01, "nothing has moved"
    assert error <= tolerance * max(1.0, moved), f"{error:.2g} m"
    # and the fine run is not farther from it than its own steps explain
    assert np.abs(fine - expected).max() <= 2.0 * np.abs(fine - coarse).max() + tolerance
    return simulation, read


def mechanism(seed: int) -> tuple[oracle.Model, list[Any]]:
    """Three to six bodies, each hung from one before it or from the ground by any joint; a rope closes a loop."""
    rng = np.random.default_rng(seed)
    bodies: list[oracle.Body] = []
    rows: list[oracle.Row] = []
    joints: list[Any] = []
    for i in range(int(rng.integers(3, 7))):
        parent = int(rng.integers(-1, i)) if i else -1
        base = np.zeros(3) if parent < 0 else bodies[parent].position
        bodies.append(any_body(rng, base + rng.uniform(0.4, 1.0, 3) * rng.choice([-1.0, 1.0], 3)))
        kind = str(
            rng.choice(
                [*JOINTS] if parent >= 0 else ["ball", "hinge", "fixed", "universal", "cylindrical", "slider"]
            )
        )
        # drawn closed: frames that agree in the world, or of a universal joint with crossed axes
        A = any_rotation(rng)
        B = A @ Rotation.from_euler("x", 90.0, degrees=True).as_matrix() if kind == "universal" else A
        at = 0.5 * (base + bodies[i].position)
        sides, frames = (parent, i), []
        for side, axes in zip(sides, (A, B), strict=True):
            R = np.eye(3) if side < 0 else bodies[side].rotation
            origin = np.zeros(3) if side < 0 else bodies[side].position
            frames.append(JointFrame(R.T @ (at - origin), R.T @ axes))
        points, both = (frames[0].point, frames[1].point), (frames[0].axes, frames[1].axes)
        rows += oracle.joint_rows(kind, sides, points, both)
        joints.append(
            JOINTS[kind](
                name=f"joint_{i}", body_a=GROUND if parent < 0 else f"body_{parent}", body_b=f"body_{i}",
                frame_a=frames[0], frame_b=frames[1],
            )
        )  # fmt: skip
    last = len(bodies) - 1
    anchor, eye = rng.uniform([-2.0, -2.0, 2.0], [2.0, 2.0, 6.0]), rng.uniform(-0.2, 0.2, 3)
    distance = float(np.linalg.norm(anchor - bodies[last].position - bodies[last].rotation @ eye))
    pull = oracle.Pull((oracle.GROUND, last), (anchor, eye), 0.995 * distance, 2e5 * distance)
    return oracle.Model(bodies, rows, [pull], G), joints


@pytest.mark.parametrize("seed", [500, 502, 503, 507])
def test_trees_in_joint_coordinates(seed):
    """The same mechanisms by the accurate integrator, directly: joints of trees are coordinates there."""
    model, joints = mechanism(seed)
    scene = Scene(solver_bodies(model), (Gravity(G),), (), tuple(joints), solver_ropes(model))
    names = [f"body_{i}" for i in range(len(model.bodies))]
    found, simulation, _ = histories(scene, TIMES[1], names, integrator="accurate", tolerance=1e-9)
    assert any(type(kind).__name__ == "Forest" for kind in simulation._layout.systems)
    expected = oracle_histories(model)
    assert np.abs(found - expected).max() < 2e-7 * max(1.0, float(np.abs(expected - expected[0]).max()))


def solver_ropes(model: oracle.Model) -> tuple[Rope, ...]:
    def end(side: int, point: NDArray[np.float64]) -> RopePoint:
        return RopePoint(GROUND if side < 0 else f"body_{side}", point)

    return tuple(
        Rope(
            name=f"rope_{k}", path=tuple(end(side, point) for side, point in zip(one.sides, one.points, strict=True)),
            length=one.length, axial_stiffness=one.axial_stiffness, damping=one.damping,
        )
        for k, one in enumerate(model.pulls)
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(12))
def test_mechanisms(seed):
    model, joints = mechanism(seed)
    scene = Scene(solver_bodies(model), (Gravity(G),), (), tuple(joints), solver_ropes(model))
    _, read = compare(model, scene, 1e-3, 2e-6)
    balance, kinetic = read("energy.balance")[:, 0], read("energy.kinetic")[:, 0]
    assert np.ptp(balance) <= 1e-6 * max(kinetic.max(), 1.0)


@pytest.mark.parametrize("seed", range(100, 106))
def test_slings(seed):
    """A load on three to six slings of one hook, and the hook on a rope; all elastic, some slack at first."""
    rng = np.random.default_rng(seed)
    hook, load = any_body(rng, np.array([0.0, 0.0, 6.0]), 0.0, 200.0), any_body(rng, np.zeros(3), 0.2, 200.0)
    pulls = [oracle.Pull((oracle.GROUND, 0), (np.array([0.3, 0.0, 12.0]), np.zeros(3)), 6.0, 6e6, 2e3)]
    for _ in range(int(rng.integers(3, 7))):
        lug = rng.uniform(-0.6, 0.6, 3)
        distance = float(np.linalg.norm(hook.position - load.rotation @ lug))
        slack = rng.uniform(0.0, 0.003) * rng.choice([-1.0, 1.0])
        pulls.append(oracle.Pull((0, 1), (np.zeros(3), lug), distance * (1.0 + slack), 2e6, 0.0))
    model = oracle.Model((hook, load), (), pulls, G)
    scene = Scene(solver_bodies(model), (Gravity(G),), (), (), solver_ropes(model))
    compare(model, scene, 2.5e-4, 2e-4)


def clipped(corners: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """Volume and its centre of the part of a convex body below z = 0, by a convex hull of corners and cut edges."""
    below = corners[corners[:, 2] <= 0.0]
    cuts = []
    for i in range(8):
        for k in (1, 2, 4):
            a, b = corners[i], corners[i ^ k]
            if a[2] < 0.0 < b[2]:
                cuts.append(a + (b - a) * a[2] / (a[2] - b[2]))
    points = np.vstack([below, *cuts]) if cuts else below
    if len(points) < 4:
        return 0.0, np.zeros(3)
    hull, middle, volume, moment = ConvexHull(points), points.mean(axis=0), 0.0, np.zeros(3)
    for triangle in hull.simplices:
        corner = points[triangle] - middle
        part = abs(np.linalg.det(corner)) / 6.0
        volume += part
        moment += part * corner.sum(axis=0) / 4.0
    return volume, middle + moment / volume


@pytest.mark.parametrize("seed", range(200, 206))
def test_floating_boxes(seed):
    """Boxes that roll and heave at large angles, without water that goes along; buoyancy of a clipped convex hull."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(2.0, 4.0, 3) * [3.0, 1.5, 1.0]
    mass = 1025.0 * float(size.prod()) * rng.uniform(0.3, 0.7)
    inertia = mass / 12.0 * np.diag((size**2).sum() - size**2)
    turn = Rotation.from_rotvec(rng.uniform(-0.4, 0.4, 3)).as_matrix()
    body = oracle.Body(
        mass, inertia, np.array([3.0, -2.0, rng.uniform(-0.3, 0.3)]), turn, rng.uniform(-0.3, 0.3, 3)
    )
    signs = np.array([[(i >> k & 1) - 0.5 for k in (2, 1, 0)] for i in range(8)])

    def buoyancy(state: oracle.State) -> NDArray[np.float64]:
        volume, centre = clipped(state.x[0] + (signs * size) @ state.R[0].T)
        force = np.array([0.0, 0.0, 1025.0 * 9.81 * volume])
        return np.concatenate([force, np.cross(centre - state.x[0], force)])[None]

    model = oracle.Model((body,), (), (), G, (buoyancy,))
    sea = Sea(
        water=Water(density=1025.0, gravity=9.81),
        hulls=(Hull(body="body_0", restoring=box_surface(tuple(size))),),
    )
    scene = Scene((solver_body("body_0", body),), (Gravity(G),), sea=sea)
    _, read = compare(model, scene, 5e-3, 2e-5)
    balance = read("energy.balance")[:, 0]
    assert np.ptp(balance) <= 1e-4 * max(read("energy.kinetic").max(), 1.0)


@pytest.mark.parametrize("seed", range(300, 306))
def test_balls_on_a_floor(seed):
    """Bodies with a ball at each of three places fall on a floor that gives way."""
    rng = np.random.default_rng(seed)
    body = any_body(rng, np.array([0.0, 0.0, 1.2]), 0.5)
    balls = rng.uniform(-0.5, 0.5, (3, 3))
    radii, stiffness = rng.uniform(0.1, 0.3, 3), 2e3 * body.mass
    body = oracle.Body(
        body.mass, body.inertia,
        np.array([0.0, 0.0, float((radii - (balls @ body.rotation.T)[:, 2]).max()) + 0.02]),
        body.rotation, body.velocity, body.spin,
    )  # fmt: skip

    def floor(state: oracle.State) -> NDArray[np.float64]:
        out = np.zeros((1, 6))
        for ball, radius in zip(balls, radii, strict=True):
            arm = state.R[0] @ ball
            depth = radius - (state.x[0] + arm)[2]
            if depth > 0.0:
                force = np.array([0.0, 0.0, stiffness * depth])
                out[0] += np.concatenate([force, np.cross(arm - [0.0, 0.0, radius], force)])
        return out

    model = oracle.Model((body,), (), (), G, (floor,))
    x, y = np.meshgrid(np.linspace(-20.0, 20.0, 6), np.linspace(-20.0, 20.0, 6), indexing="ij")
    flat = neutral_surface(np.stack([x, y, np.zeros_like(x)], -1))
    contacts = tuple(
        Contact(
            name=f"ball_{k}", contour="floor", body="body_0", point=ball, shape=SphereShape(float(radius)),
            law=LinearLaw(stiffness),
        )
        for k, (ball, radius) in enumerate(zip(balls, radii, strict=True))
    )  # fmt: skip
    scene = Scene(
        (solver_body("body_0", body),), (Gravity(G),),
        contours=(Contour(name="floor", body=GROUND, neutral=flat),), contacts=contacts,
    )  # fmt: skip
    compare(model, scene, 2.5e-4, 2e-5)


@pytest.mark.parametrize("seed", range(400, 404))
def test_free_mechanisms_keep_momentum(seed):
    """Without ground and weight: linear and angular momentum to rounding, and paths of the oracle."""
    rng = np.random.default_rng(seed)
    bodies = [any_body(rng, np.array([1.2 * i, 0.0, 0.0])) for i in range(4)]
    rows, joints = [], []
    for i, kind in enumerate(rng.permutation(["ball", "hinge", "cylindrical"])):
        axes, at = any_rotation(rng), 0.5 * (bodies[i].position + bodies[i + 1].position)
        frames = [
            JointFrame(bodies[k].rotation.T @ (at - bodies[k].position), bodies[k].rotation.T @ axes)
            for k in (i, i + 1)
        ]
        points, both = (frames[0].point, frames[1].point), (frames[0].axes, frames[1].axes)
        rows += oracle.joint_rows(str(kind), (i, i + 1), points, both)
        joints.append(
            JOINTS[str(kind)](
                name=f"joint_{i}",
                body_a=f"body_{i}",
                body_b=f"body_{i + 1}",
                frame_a=frames[0],
                frame_b=frames[1],
            )
        )
    model = oracle.Model(bodies, rows, (), np.zeros(3))
    scene = Scene(solver_bodies(model), (), (), tuple(joints))
    _, read = compare(model, scene, 1e-3, 2e-6)
    for name in ("momentum.linear", "momentum.angular"):
        momentum = read(name)
        assert np.abs(momentum - momentum[0]).max() <= 1e-9 * max(np.abs(momentum).max(), 1.0)
