"""Springs, motors, stops and friction on the travel and on the angle of joints that have both: each by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.pipeline import load_case
from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.slider_hinge import Cylindrical, SliderHinge
from heavylift.solver.scene.connections import Limits
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation

MASS, INERTIA = 4.0, 0.5
OF_TRAVEL, OF_ANGLE = {"coordinate": "travel"}, {"coordinate": "angle"}


def slider_hinge(**more) -> SliderHinge:
    """Slides along x, turns about z."""
    return SliderHinge(
        name="joint", body_a="ground", body_b="disc", slide_axis=np.array([1.0, 0.0, 0.0]), **more
    )


def run(joint, *forces, speed=0.0, spin=0.0, duration=4.0, step=1e-3, integrator="dele2"):
    """Times, travels and angles of a disc whose centre of mass is at its joint."""
    along = joint.travel_axis
    disc = RigidBody(
        "disc", MASS, np.eye(3) * INERTIA, velocity=speed * along, angular_velocity=np.array([0.0, 0.0, spin])
    )
    made = Simulation(Scene((disc,), forces=forces, joints=(joint,)), step=step, integrator=integrator)
    times, records = made.advance(round(duration / step))
    column = {channel.name: channel.column for channel in made.channels}
    return times, records[:, column["joint.travel"]], records[:, column["joint.angle"]]


@pytest.mark.parametrize("integrator", ["dele2", "accurate"])
@pytest.mark.parametrize(
    "joint",
    [slider_hinge(), Cylindrical(name="joint", body_a="ground", body_b="disc")],
    ids=["slider", "cylindrical"],
)
def test_springs_and_motors_act_on_what_they_are_told(joint, integrator) -> None:
    """Two oscillators with loads: ``q = F/k (1 - cos w t)``, independent of each other."""
    forces = (
        JointSpring(name="spring", joint="joint", stiffness=100.0, **OF_TRAVEL),
        JointMotor(name="push", joint="joint", load=5.0, **OF_TRAVEL),
        JointSpring(name="torsion", joint="joint", stiffness=8.0, **OF_ANGLE),
        JointMotor(name="torque", joint="joint", load=2.0, **OF_ANGLE),
    )
    times, travel, angle = run(joint, *forces, integrator=integrator)
    np.testing.assert_allclose(travel, 0.05 * (1.0 - np.cos(5.0 * times)), atol=3e-6)
    np.testing.assert_allclose(angle, 0.25 * (1.0 - np.cos(4.0 * times)), atol=1e-5)


def test_friction_and_stops_act_on_each_by_itself() -> None:
    """Sliding ends after ``m v^2 / 2 F``; the turn bounces off an elastic stop with its speed."""
    joint = slider_hinge(travel_friction=3.0, angle_limits=Limits(upper=0.2, stiffness=400.0))
    times, travel, angle = run(joint, speed=0.9, spin=0.5)
    assert travel[-1] == pytest.approx(0.5 * MASS * 0.9**2 / 3.0, rel=1e-4)
    rate = np.sqrt(400.0 / INERTIA)
    back = 0.4 + np.pi / rate  # half a period of the stop
    late = times > back
    np.testing.assert_allclose(angle[late], 0.2 - 0.5 * (times[late] - back), atol=1e-4)

    joint = slider_hinge(angle_friction=0.25, travel_limits=Limits(lower=-1.0, upper=0.3, stiffness=4e4))
    times, travel, angle = run(joint, speed=0.6, spin=0.8)
    assert angle[-1] == pytest.approx(0.5 * INERTIA * 0.8**2 / 0.25, rel=1e-4)
    back = 0.5 + np.pi / np.sqrt(4e4 / MASS)
    late = (times > back) & (times < back + 1.3 / 0.6)
    np.testing.assert_allclose(travel[late], 0.3 - 0.6 * (times[late] - back), atol=1e-4)


def test_what_is_not_said_or_not_there_is_refused() -> None:
    """A spring on a joint with both says which; one on a joint with one names no other."""
    with pytest.raises(
        InputError, match="spring: coordinate: joint 'joint' is a SliderHinge, which has both"
    ):
        run(slider_hinge(), JointSpring(name="spring", joint="joint", stiffness=1.0))
    with pytest.raises(InputError, match="travel_limits: lower 1"):
        run(slider_hinge(travel_limits=Limits(lower=1.0, upper=0.5, stiffness=1.0)))


CASE = """
title = "A disc that slides and turns"

[bodies.disc]
type = "rigid"
mass = 4
inertia = [0.5, 0.5, 0.5]
frame = { motion = "free" }

[[joints]]
type = "slider_hinge"
name = "joint"
between = ["ground", "disc"]
at = [0, 0, 0]
axis = [0, 0, 1]
slide_axis = [1, 0, 0]
travel_limits = { upper = "0.3 m", stiffness = "40 kN/m" }
angle_friction = "0.25 N m"

[[forces]]
type = "joint_spring"
name = "spring"
joint = "joint"
coordinate = "travel"
stiffness = "100 N/m"

[[forces]]
type = "motor"
name = "torque"
joint = "joint"
coordinate = "angle"
load = "2 N m"

[simulate]
integrator = "dele2"
step = "1 ms"
output_interval = "10 ms"
duration = "0.1 s"

[[check]]
id = "pull"
quantity = "channel.spring.load.end"
reference = "0 N"
tolerance = { absolute = "1 N" }
source = "a force, not a moment"
"""


def test_case_files_say_units_by_the_coordinate(tmp_path) -> None:
    """Stiffness of a travel in N/m; without the coordinate, or with another one, one line says so."""
    file = tmp_path / "case.toml"
    file.write_text(CASE)
    case = load_case(file)
    assert case.forces[0].stiffness == 100.0
    assert case.joints[0].travel_limits.stiffness == 4e4
    for old, new, words in (
        ('coordinate = "travel"\n', "", "has an angle and a travel"),
        ('stiffness = "100 N/m"', 'stiffness = "100 N m/rad"', "stiffness"),
        ('type = "slider_hinge"', 'type = "ball"', "axis"),
    ):
        file.write_text(CASE.replace(old, new))
        with pytest.raises(InputError, match=words):
            load_case(file)
    assert replace(slider_hinge(), angle_friction=1.0).angle_friction == 1.0
