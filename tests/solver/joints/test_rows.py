"""Rows of all joints against differences of what they keep, far from closed poses, in one compiled scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from joint_scenes import CLOSED, RESIDUALS, SLIDE_AXIS, SPEED, Pose, angle, make_joint, profile, travel, turn
from scipy.spatial.transform import Rotation

from heavylift.solver.integrate.loop import start_scene
from heavylift.solver.interface import (
    ACCELERATIONS,
    fill_bias,
    fill_markers,
    fill_rows,
    record_joints,
    set_targets,
)
from heavylift.solver.joints.registry import block_order
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import RigidBody, Scene

NAMES = sorted(RESIDUALS)
TIME = 0.6
COUNTS = {
    "ball": 3,
    "cylindrical": 4,
    "distance": 1,
    "driven_hinge": 6,
    "driven_slider": 6,
    "fixed": 6,
    "guide": 3,
    "hinge": 5,
    "planar": 3,
    "screw": 5,
    "slider": 5,
    "slider_hinge": 4,
    "universal": 4,
}
"""Rows: six less the motions that a joint leaves."""


def probe(bodies: Any, joints: Any, system: Any, work: Any, time: float, at_midpoint: bool) -> None:
    """All rows at the carried state, aimed at a time."""
    fill_markers(bodies, False, ACCELERATIONS, work)
    fill_rows(joints, True, work, system)
    set_targets(joints, time, 0.1, at_midpoint, work, system)


def probe_bias(joints: Any, system: Any, work: Any, time: float) -> None:
    """Targets of accelerations."""
    fill_bias(joints, time, work, system)


def probe_record(joints: Any, system: Any, work: Any, time: float, row: np.ndarray) -> None:
    """Channels of the joints."""
    record_joints(joints, time, work, system, row)


@dataclass
class Model:
    """The packed scene with handles on what the kernels read and write."""

    layout: Any
    joints: dict[str, Any]
    blocks: dict[str, int]

    @property
    def state(self) -> np.ndarray:
        return self.layout.bodies[0].frame

    @property
    def system(self) -> Any:
        return self.layout.systems[0]

    def close(self, name: str, rng: np.random.Generator) -> None:
        """Body b so that a joint is closed at `TIME`, wherever a is."""
        self.place(rng)
        joint, (point, rotation) = self.joints[name], CLOSED[name]
        if name == "driven_hinge":
            rotation = np.array([0.0, 0.0, profile(TIME)])
        if name == "driven_slider":
            point = np.array([0.0, 0.0, profile(TIME)])
        if name == "guide":
            point = np.array([profile(TIME) + SPEED * TIME, *point[1:]])
        a, _ = self.frames(name, np.zeros(12), 0.0)
        R = a.axes @ turn(rotation) @ joint.frame_b.axes.T
        self.state[1].position[:] = a.point + a.axes @ point - R @ joint.frame_b.point
        self.state[1].orientation[:] = Rotation.from_matrix(R).as_quat(scalar_first=True)

    def place(self, rng: np.random.Generator) -> None:
        """Both bodies anywhere, moving anyhow."""
        self.state["position"] = rng.normal(size=(2, 3))
        self.state["orientation"] = Rotation.random(2, rng=rng).as_quat(scalar_first=True)
        self.state["velocity"] = rng.normal(size=(2, 3))
        self.state["spin"] = rng.normal(size=(2, 3))

    def frames(self, name: str, motion: np.ndarray, time: float) -> tuple[Pose, Pose]:
        """Joint frames after the bodies moved for a while with constant velocities, shape (12,)."""
        sides = []
        joint = self.joints[name]
        for body, frame in enumerate((joint.frame_a, joint.frame_b)):
            R0 = Rotation.from_quat(self.state[body].orientation, scalar_first=True).as_matrix()
            R = R0 @ turn(time * motion[6 * body + 3 : 6 * body + 6])
            x = self.state[body].position + time * motion[6 * body : 6 * body + 3]
            # the bodies of this scene have their centre of mass in the origin and principal axes along their own
            sides.append(Pose(x + R @ frame.point, R @ frame.axes))
        return sides[0], sides[1]

    def residual(self, name: str, motion: np.ndarray, time: float) -> np.ndarray:
        """Independent residual a while after `TIME`."""
        return np.array(RESIDUALS[name](*self.frames(name, motion, time), TIME + time))

    def column(self, name: str, field: str) -> np.ndarray:
        """One vector of the rows of a joint, a view."""
        return self.system.rows[field][self.blocks[name], : COUNTS[name]]

    def rows(self, name: str) -> np.ndarray:
        """Jacobian over the velocities of both bodies, shape (rows, 12)."""
        lanes = len(self.system.shape[1])
        sides = []
        for side in (0, 1):
            begin = self.system.attachments[2 * self.blocks[name] + side].panel
            sides.append(self.system.panels[begin : begin + 6 * lanes].reshape(6, lanes))
        return np.vstack(sides).T[: COUNTS[name]]

    def evaluate(self, at_midpoint: bool = False) -> None:
        """Fill all rows."""
        layout = self.layout
        probe(layout.bodies, layout.joints, self.system, layout.work, TIME, at_midpoint)

    def record(self) -> np.ndarray:
        """Channels of the joints at `TIME`."""
        row, layout = np.zeros(self.layout.column_count), self.layout
        probe_record(layout.joints, self.system, layout.work, TIME, row)
        return row

    @property
    def velocity(self) -> np.ndarray:
        """Velocities of both bodies, shape (12,)."""
        return np.concatenate([[*s.velocity, *s.spin] for s in self.state])


@pytest.fixture(scope="module")
def model() -> Model:
    rng = np.random.default_rng(5)
    bodies = tuple(RigidBody(name, 2.0, np.diag([0.3, 0.4, 0.6])) for name in ("a", "b"))
    joints = {}
    for name in NAMES:
        point, rotation = CLOSED[name]
        at, axes = rng.normal(size=3), Rotation.random(rng=rng).as_matrix()
        b = JointFrame(at + axes @ point, axes @ turn(rotation))
        joints[name] = make_joint(name, "a", "b", JointFrame(at, axes), b)
    layout = pack_scene(Scene(bodies, joints=tuple(joints.values())))
    layout.joints.need("accurate")
    start_scene(layout.bodies, layout.work, 0.0)
    order = sorted(NAMES, key=lambda name: block_order(joints[name]))
    return Model(layout, joints, {name: block for block, name in enumerate(order)})


SEEDS = pytest.mark.parametrize("seed", range(5))


@SEEDS
@pytest.mark.parametrize("name", NAMES)
def test_residual_and_rows_are_those_of_the_geometry(model: Model, name: str, seed: int) -> None:
    """Central differences of fourth order of the residual in plain matrices, over the motions of both bodies."""
    model.place(np.random.default_rng(seed))
    model.evaluate()
    here = model.residual(name, np.zeros(12), 0.0)
    np.testing.assert_allclose(model.column(name, "residual"), here, atol=1e-13)
    assert len(here) == COUNTS[name]
    h, expected = 2e-4, np.empty((len(here), 12))
    for k, direction in enumerate(np.eye(12)):
        at = [np.array(RESIDUALS[name](*model.frames(name, direction, i * h), TIME)) for i in (-2, -1, 1, 2)]
        expected[:, k] = (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)
    np.testing.assert_allclose(model.rows(name), expected, atol=1e-8)


@SEEDS
@pytest.mark.parametrize("name", NAMES)
def test_targets_of_accelerations_are_second_derivatives(model: Model, name: str, seed: int) -> None:
    """Along a motion without accelerations the residual bends by the quadratic velocity term and the drive."""
    model.place(np.random.default_rng(seed))
    model.evaluate()
    probe_bias(model.layout.joints, model.system, model.layout.work, TIME)
    h, velocity = 5e-4, model.velocity
    at = [model.residual(name, velocity, i * h) for i in (-2, -1, 0, 1, 2)]
    second = (-at[0] + 16 * at[1] - 30 * at[2] + 16 * at[3] - at[4]) / (12 * h * h)
    np.testing.assert_allclose(
        model.column(name, "target"), -second, atol=2e-6 * max(1.0, np.abs(second).max())
    )


@SEEDS
@pytest.mark.parametrize("name", NAMES)
def test_rows_of_a_closed_joint_are_independent(model: Model, name: str, seed: int) -> None:
    """As many as motions are taken away, and none nearly parallel to the others."""
    model.close(name, np.random.default_rng(seed))
    model.evaluate()
    np.testing.assert_allclose(model.residual(name, np.zeros(12), 0.0), 0.0, atol=1e-12)
    np.testing.assert_allclose(model.column(name, "residual"), 0.0, atol=1e-12)
    values = np.linalg.svd(model.rows(name), compute_uv=False)
    assert len(values) == COUNTS[name]
    assert values[-1] > 1e-3 * values[0]


@SEEDS
@pytest.mark.parametrize("name", NAMES)
def test_reaction_is_the_wrench_of_the_rows(model: Model, name: str, seed: int) -> None:
    """Force and moment on b at its anchor do the work of the rows in every motion of both bodies."""
    rng = np.random.default_rng(seed)
    model.close(name, rng)
    model.evaluate()
    rows = model.rows(name)
    model.column(name, "reaction")[:] = rng.normal(size=len(rows))
    generalised = model.column(name, "reaction") @ rows
    record = model.record()
    column = next(c.column for c in model.layout.channels if c.name == f"{name}.reaction_force")
    force, moment = record[column : column + 3], record[column + 3 : column + 6]
    anchor = model.frames(name, np.zeros(12), 0.0)[1].point
    for body, sign in ((0, -1.0), (1, 1.0)):
        R = Rotation.from_quat(model.state[body].orientation, scalar_first=True).as_matrix()
        arm = anchor - model.state[body].position
        turned = R.T @ (moment + np.cross(arm, force))
        np.testing.assert_allclose(
            sign * np.concatenate([force, turned]), generalised[6 * body : 6 * body + 6], atol=1e-12
        )


@SEEDS
def test_angles_and_travels_with_their_rates(model: Model, seed: int) -> None:
    """Against plain matrices and central differences, also where the joint is open."""
    model.place(np.random.default_rng(seed))
    model.evaluate()
    record, h = model.record(), 1e-4
    seen = 0
    for channel in model.layout.channels:
        name, _, quantity = channel.name.partition(".")
        if quantity not in ("angle", "travel"):
            continue
        direction = {"slider_hinge": SLIDE_AXIS / np.linalg.norm(SLIDE_AXIS), "guide": np.eye(3)[0]}.get(
            name, np.eye(3)[2]
        )

        def value(
            time: float, name: str = name, quantity: str = quantity, e: np.ndarray = direction
        ) -> float:
            frames = model.frames(name, model.velocity, time)
            return angle(*frames) if quantity == "angle" else travel(*frames, e)

        off = record[channel.column] - value(0.0)
        turns = np.round(off / (2 * np.pi)) if quantity == "angle" else 0.0
        assert off == pytest.approx(2 * np.pi * turns, abs=1e-12)
        rate = (value(-2 * h) - 8 * value(-h) + 8 * value(h) - value(2 * h)) / (12 * h)
        assert record[channel.column + 1] == pytest.approx(rate, abs=1e-8)
        seen += 1
    assert seen == 11


def test_driven_angle_counts_the_turns_of_its_profile(model: Model) -> None:
    """Two of them."""
    model.close("driven_hinge", np.random.default_rng(1))
    model.evaluate()
    column = next(c.column for c in model.layout.channels if c.name == "driven_hinge.angle")
    assert model.record()[column] == pytest.approx(profile(TIME), abs=1e-12)


@pytest.mark.parametrize("name", ["driven_hinge", "driven_slider"])
def test_driven_rows_aim_at_the_end_of_the_step(model: Model, name: str) -> None:
    """In the middle of a step at the mean rate of the profile, at its end at its rate there."""
    model.close(name, np.random.default_rng(0))
    model.evaluate()
    h = 1e-3
    rate = (profile(TIME - 2 * h) - 8 * profile(TIME - h) + 8 * profile(TIME + h) - profile(TIME + 2 * h)) / (
        12 * h
    )
    np.testing.assert_allclose(model.column(name, "target")[5], rate, atol=1e-9)
    model.column(name, "target")[:] = 0.0
    model.evaluate(at_midpoint=True)
    assert model.column(name, "target")[5] == pytest.approx(
        (profile(TIME + 0.1) - profile(TIME)) / 0.1, abs=1e-12
    )
