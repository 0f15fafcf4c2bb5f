"""Screws: a nut under gravity against its closed form, with coarse and fine threads, right- and left-handed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.screw import Screw
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

MASS, INERTIA, WEIGHT = 5.0, 0.02, 9.81
AXIS = np.array([1.0, 2.0, 2.0]) / 3.0


def nut(lead: float, *, turned: bool = False, torque: float = 0.0, spring: float = 0.0) -> Scene:
    """A nut on a skew screw on the ground, or its screw in a nut on the ground."""
    frame = JointFrame(np.zeros(3), axes_about(AXIS))
    body = RigidBody("nut", MASS, np.diag([0.03, 0.03, INERTIA]), orientation=_upright())
    on_body = JointFrame(np.zeros(3), np.eye(3))
    frame = JointFrame(np.zeros(3), frame.axes)
    sides = ("nut", GROUND) if turned else (GROUND, "nut")
    frames = (on_body, frame) if turned else (frame, on_body)
    joint = Screw(
        name="thread", body_a=sides[0], body_b=sides[1], frame_a=frames[0], frame_b=frames[1], lead=lead
    )
    forces: list[object] = [Gravity(np.array([0.0, 0.0, -WEIGHT]))]
    if torque:
        forces.append(JointMotor(name="drive", joint="thread", times=np.zeros(1), loads=np.array([torque])))
    if spring:
        forces.append(JointSpring(name="coil", joint="thread", stiffness=spring))
    return Scene((body,), tuple(forces), joints=(joint,))  # type: ignore[arg-type]


def _upright() -> np.ndarray:
    from heavylift.numerics.rotation import quaternion_from_matrix

    return quaternion_from_matrix(axes_about(AXIS))


def run(scene: Scene, duration: float, records: int = 5, **options: object) -> dict[str, np.ndarray]:
    step = options.pop("step", None)
    if options.get("integrator") == "accurate":
        simulation = Simulation(scene, duration / records, **options)
        times, rows = simulation.advance(records)
    else:
        every = round(duration / records / step)
        simulation = Simulation(scene, step, record_every=every, **options)
        times, rows = simulation.advance(records * every)
    assert len(rows) == records, simulation.message
    found = {c.name: rows[:, c.column : c.column + len(c.components)].squeeze() for c in simulation.channels}
    return found | {"time": times}


CHOICES = [{"integrator": "dele2"}, {"integrator": "accurate", "tolerance": 1e-10}]


@pytest.mark.parametrize("options", CHOICES, ids=["dele2", "accurate"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("lead", [0.5, -0.5, 5e-3, -5e-3])
def test_a_nut_falls_as_its_thread_lets_it(lead: float, turned: bool, options: dict[str, object]) -> None:
    """``(m + J/p^2) z'' = m g e_z``; the angle counts all turns, of which there are many between two records."""
    pitch = lead / (2.0 * math.pi)
    acceleration = -MASS * WEIGHT * AXIS[2] / (MASS + INERTIA / pitch**2)
    duration = math.sqrt(2.0 * 150.0 * abs(pitch / acceleration))  # 150 rad in five records
    found = run(nut(lead, turned=turned), duration, step=duration / 2000, **options)
    travel = 0.5 * acceleration * found["time"] ** 2 * (-1.0 if turned else 1.0)
    np.testing.assert_allclose(found["thread.travel"], travel, rtol=1e-7)
    np.testing.assert_allclose(found["thread.angle"], travel / pitch, rtol=1e-7)
    np.testing.assert_allclose(found["thread.angular_rate"] * pitch, found["thread.travel_rate"], rtol=1e-7)
    force = MASS * (WEIGHT * AXIS[2] + acceleration) * (-1.0 if turned else 1.0)
    np.testing.assert_allclose(found["thread.thread_force"], force, rtol=1e-5)
    np.testing.assert_allclose(found["energy.balance"], found["energy.balance"][0], atol=1e-8 * MASS * WEIGHT)


def test_a_motor_lifts_and_a_spring_holds() -> None:
    """Torque T on the turning side is a force T/p along the thread; a coil lets the nut swing about where it hangs."""
    pitch, duration = 0.2 / (2.0 * math.pi), 0.5
    found = run(nut(0.2, torque=4.0), duration, step=1e-3)
    acceleration = (4.0 / pitch - MASS * WEIGHT * AXIS[2]) / (MASS + INERTIA / pitch**2)
    np.testing.assert_allclose(found["thread.travel"], 0.5 * acceleration * found["time"] ** 2, rtol=1e-7)
    stiffness = 30.0
    found = run(nut(0.2, spring=stiffness), duration, step=1e-4)
    inertia = MASS * pitch**2 + INERTIA
    rate, rest = math.sqrt(stiffness / inertia), -MASS * WEIGHT * AXIS[2] * pitch / stiffness
    expected = rest * (1.0 - np.cos(rate * found["time"]))
    np.testing.assert_allclose(found["thread.angle"], expected, atol=2e-5 * abs(rest))


def test_a_nut_comes_to_rest_on_its_coil() -> None:
    """Equilibrium: the weight along the axis times the pitch is the moment of the coil."""
    pitch = 0.2 / (2.0 * math.pi)
    simulation = Simulation(nut(0.2, spring=30.0), 1e-3, start="equilibrium")
    columns = {c.name: c.column for c in simulation.channels}
    angle = simulation.record()[columns["thread.angle"]]
    assert angle == pytest.approx(-MASS * WEIGHT * AXIS[2] * pitch / 30.0, rel=1e-6)
