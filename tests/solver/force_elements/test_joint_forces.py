"""Torsion spring, damper and motor on a hinge, against the equation of one angle."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from law_scenes import G, run, scene
from scipy.integrate import solve_ivp

from heavylift.solver.forces.motor import JointMotor
from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation

MASS, ARM, INERTIA = 2.0, 0.5, 0.4
REST, STIFFNESS, DAMPING = 0.3, 30.0, 0.2
TIMES, LOADS = np.array([0.0, 0.5, 1.0]), np.array([0.0, 4.0, -2.0])


def pendulum() -> Scene:
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    hinge = Hinge(
        name="hinge",
        body_a=GROUND,
        body_b="arm",
        frame_a=JointFrame(np.zeros(3), axes),
        frame_b=JointFrame(np.array([0.0, 0.0, ARM]), axes),
    )
    arm = RigidBody("arm", MASS, np.diag([0.3, INERTIA, 0.3]), position=np.array([0.0, 0.0, -ARM]))
    spring = JointSpring(name="spring", joint="hinge", rest=REST, stiffness=STIFFNESS, damping=DAMPING)
    motor = JointMotor(name="motor", joint="hinge", times=TIMES, loads=LOADS)
    return scene([arm], [spring, motor], [hinge])


def rates(t: float, y: np.ndarray) -> list[float]:
    """Angle, its rate and the work of the motor."""
    motor = np.interp(t, TIMES, LOADS)
    load = STIFFNESS * (y[0] - REST) + DAMPING * y[1]
    return [y[1], (motor - load - MASS * G * ARM * np.sin(y[0])) / (INERTIA + MASS * ARM**2), motor * y[1]]


def reference(times: np.ndarray) -> np.ndarray:
    return solve_ivp(
        rates, (0, times[-1]), [0, 0, 0], method="DOP853", t_eval=times, rtol=1e-11, atol=1e-11, max_step=0.02
    ).y


def test_spring_and_motor_on_a_hinge() -> None:
    errors = []
    for step in (1e-2, 5e-3):
        result = run(pendulum(), step, 2.0)
        angle, rate, work = reference(result.times)
        load = STIFFNESS * (angle - REST) + DAMPING * rate
        errors.append(
            [
                np.abs(result["hinge.angle"] - angle).max(),
                np.abs(result["spring.load"] - load).max(),
                np.abs(result["energy.drive_work"] - work).max(),
            ]
        )
        np.testing.assert_allclose(result["motor.load"], np.interp(result.times, TIMES, LOADS), atol=1e-12)
        assert np.abs(result["energy.external_work"]).max() < 1e-12
    assert errors[1][0] < 2e-4
    assert result.balance < 1e-4
    for coarse, fine in zip(*errors, strict=True):
        assert coarse / fine == pytest.approx(4.0, rel=0.15)


@pytest.mark.parametrize("integrator", ["dele2", "accurate", "thesis"])
def test_a_spring_of_nothing_leaves_the_motion_as_it_is(integrator: str) -> None:
    """The first run of a sweep of its stiffness or damping."""
    whole = pendulum()
    others = [force for force in whole.forces if not isinstance(force, JointSpring)]
    angles = []
    for springs in ([], [JointSpring(name="spring", joint="hinge", rest=REST)]):
        result = run(replace(whole, forces=(*others, *springs)), 5e-3, 0.5, integrator=integrator)
        angles.append(result["hinge.angle"])
    np.testing.assert_allclose(angles[1], angles[0], atol=1e-12)
    assert np.abs(angles[0]).max() > 1e-3
    assert not result["spring.load"].any()


def test_what_has_no_force_to_compare_is_passed_over() -> None:
    """A motor carries plain numbers; springs on joints are compared and agree."""
    simulation = Simulation(pendulum(), 1e-3)
    simulation.advance(500)
    assert simulation.warning == ""
