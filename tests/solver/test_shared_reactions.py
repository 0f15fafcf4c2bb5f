"""Reactions of redundant joints at the start."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.solver.forces.spring import Spring
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

START = np.array([0.3, 0.1, 2.0])


def two_sliders() -> Scene:
    """A body on two parallel sliders, which hold it with five rows too many, and a spring."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)
    across = np.cross(axis, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    rotation = np.column_stack([across, np.cross(axis, across), axis])
    joints = tuple(
        Slider(
            name=f"j{k}",
            body_a=GROUND,
            body_b="a",
            frame_a=JointFrame(START + offset, rotation),
            frame_b=JointFrame(np.array(offset), rotation),
        )
        for k, offset in enumerate([(0.0, 0.0, 0.0), (0.8, 0.27, 0.7)])
    )
    body = RigidBody("a", 1000.0, np.diag([100.0, 200.0, 250.0]), position=START)
    ends = {"point_a": np.array([1.0, 1.0, 3.0]), "point_b": np.array([0.1, 0.2, 0.3])}
    spring = Spring(name="spring", body_a=GROUND, body_b="a", **ends, stiffness=1e4, length=2.0)
    return Scene((body,), (Gravity(np.array([0.0, 0.0, -9.81])), spring), (), joints)


@pytest.mark.parametrize("step", [1e-2, 1e-3, 1e-4])
def test_redundant_joints_share_at_the_start_whatever_the_step(step: float) -> None:
    """The accurate integrator solves for accelerations, and knows no step."""
    found, expected = (
        Simulation(two_sliders(), step, "dele2"),
        Simulation(two_sliders(), 0.1, "accurate", tolerance=1e-9),
    )
    for simulation in (found, expected):
        simulation.warm_up()
    columns = {channel.name: channel.column for channel in found.channels}
    others = {channel.name: channel.column for channel in expected.channels}
    for name in ("j0.reaction_force", "j1.reaction_force", "j0.reaction_moment", "j1.reaction_moment"):
        own, other = columns[name], others[name]
        np.testing.assert_allclose(
            found.record()[own : own + 3], expected.record()[other : other + 3], atol=0.02, err_msg=name
        )
