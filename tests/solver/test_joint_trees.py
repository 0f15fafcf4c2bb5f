"""Trees in joint coordinates: reactions by a dense system of Newton and Euler, and the same motion as by rows."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.solver.forces.point import PointForce
from heavylift.solver.forces.spring import Spring
from heavylift.solver.integrate.trees import forest
from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

GRAVITY = np.array([0.0, -3.0, -9.0])
TYPES = (Hinge, Slider, Ball, FixedJoint, Distance)

Pose = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Rotation matrix, origin, its velocity and the spin, all in world axes."""

HELD: Pose = (np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))


def drawn_frame(rng: np.random.Generator) -> JointFrame:
    return JointFrame(rng.normal(size=3), Rotation.random(rng=rng).as_matrix())


def hang(kind: type[Joint], above: Pose, a: JointFrame, b: JointFrame, rng: np.random.Generator) -> Pose:
    """A pose and velocities that a joint with drawn coordinates allows to b on a."""
    R, x, v, w = above
    A = R @ a.axes
    p = x + R @ a.point
    speed = v + np.cross(w, R @ a.point)
    turn, spin = np.eye(3), w
    if kind is Hinge:
        turn = Rotation.from_rotvec([0.0, 0.0, rng.uniform(-3.0, 3.0)]).as_matrix()
        spin = w + rng.normal() * A[:, 2]
    elif kind in (Ball, Distance):
        turn, spin = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
    Q = A @ turn @ b.axes.T
    if kind is Slider:
        travel, rate = rng.normal(size=2)
        speed = speed + np.cross(w, travel * A[:, 2]) + rate * A[:, 2]
        p = p + travel * A[:, 2]
    elif kind is Distance:
        arm = rng.normal(size=3)
        p, speed = p + arm, speed + np.cross(rng.normal(size=3), arm)
    return Q, p - Q @ b.point, speed - np.cross(spin, Q @ b.point), spin


def drawn_scene(seed: int, count: int, *, floating: bool, types: tuple[type[Joint], ...] = TYPES) -> Scene:
    """A tree of bodies on joints of all types, with springs and forces; every second joint is told from below."""
    rng = np.random.default_rng(seed)
    poses: list[Pose] = []
    bodies, joints = [], []
    for i in range(count):
        name = f"body_{i}"
        if i == 0 and floating:
            poses.append((Rotation.random(rng=rng).as_matrix(), *rng.normal(size=(3, 3))))
        else:
            above = int(rng.integers(i)) if i else -1
            a, b, kind = drawn_frame(rng), drawn_frame(rng), types[i % len(types)]
            pose = hang(kind, poses[above] if i else HELD, a, b, rng)
            on = f"body_{above}" if i else GROUND
            names = {"body_a": on, "body_b": name, "frame_a": a, "frame_b": b}
            # the joint frame of a slider moves along z of a: told from below it is the same line
            if i % 2 and kind is not Distance:
                names = {"body_a": name, "body_b": on, "frame_a": b, "frame_b": a}
            joints.append(kind(name=f"joint_{i}", **names))
            poses.append(pose)
        R, x, v, w = poses[-1]
        J = rng.normal(size=(3, 3))
        bodies.append(
            RigidBody(
                name,
                rng.uniform(0.5, 5.0),
                np.trace(J @ J.T) * np.eye(3) - J @ J.T,
                rng.normal(size=3),
                position=x,
                orientation=Rotation.from_matrix(R).as_quat(scalar_first=True),
                velocity=v,
                angular_velocity=R.T @ w,
            )
        )
    force = rng.normal(size=(1, 3))
    ends = {"body_a": GROUND, "point_a": np.ones(3), "body_b": "body_0", "point_b": rng.normal(size=3)}
    forces = (
        Gravity(GRAVITY),
        PointForce("push", f"body_{count - 1}", rng.normal(size=3), np.zeros(1), force),
        Spring(name="spring", **ends, stiffness=20.0, damping=0.5, length=1.0),
    )
    sensors = (Sensor("tip", f"body_{count - 1}", rng.normal(size=3)),)
    return Scene(tuple(bodies), forces, sensors, tuple(joints))


def simulate(scene: Scene, trees: bool, monkeypatch: pytest.MonkeyPatch, tolerance: float) -> Simulation:
    monkeypatch.setattr(forest, "SERVED", trees)
    made = Simulation(scene, 0.05, "accurate", tolerance=tolerance)
    assert any(isinstance(kind, forest.Forest) for kind in made._layout.systems) == trees
    return made


@pytest.mark.parametrize("floating", [False, True])
def test_trees_move_as_rows_hold_them(floating: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """All channels but the pivots of a system that is not there; each type of joint twice or more, on both sides."""
    scene = drawn_scene(5 + floating, 12, floating=floating)
    found = []
    for trees in (False, True):
        simulation = simulate(scene, trees, monkeypatch, 1e-10)
        first = simulation.record()
        found.append(np.vstack([first, simulation.advance(6)[1]]))
    by_rows, by_trees = found
    for channel in simulation.channels:
        if channel.name in ("monitor.pivot", "monitor.violation"):
            continue
        columns = slice(channel.column, channel.column + len(channel.components))
        scale = np.abs(by_rows[:, columns]).max() + 1.0
        distance = np.abs(by_rows[:, columns] - by_trees[:, columns]).max()
        assert distance < 2e-8 * scale, (channel.name, distance, scale)
