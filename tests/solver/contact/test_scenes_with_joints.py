"""A double pendulum whose tip hits a plane, with the impulse that its joints leave; joints stay closed."""

from __future__ import annotations

import numpy as np
import pytest
from contact_scenes import DOWN, G, run, surface

from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import JointFrame, axes_about
from heavylift.solver.scene.contacts import Contact, RigidLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene

pytestmark = pytest.mark.slow

LENGTH, MASS, TIP = 1.0, 1.5, 0.05
ABOUT_Y = axes_about(np.array([0.0, 1.0, 0.0]))
INERTIA = MASS * LENGTH**2 / 12.0 * np.diag([1e-2, 1.0, 1.0])


def rod(name, centre, angle, velocity, rate):
    """A slender rod whose axis x is turned about y by an angle [rad]."""
    half = 0.5 * angle
    return RigidBody(
        name=name,
        mass=MASS,
        inertia=INERTIA,
        position=np.array([centre[0], 0.0, centre[1]]),
        orientation=np.array([np.cos(half), 0.0, np.sin(half), 0.0]),
        velocity=np.array([velocity[0], 0.0, velocity[1]]),
        angular_velocity=np.array([0.0, rate, 0.0]),
    )


def along(angle):
    """Direction of a rod in the plane of x and z; a turn about y takes x to -z."""
    return np.array([np.cos(angle), -np.sin(angle)])


def across(angle):
    """Derivative of `along` by the angle."""
    return np.array([-np.sin(angle), -np.cos(angle)])


def pendulum(angles, rates, height, law, *, gravity=DOWN, friction=0.0):
    """Two rods below the origin, the tip a ball above a plane at a height [m]."""
    a, b = angles
    elbow, elbow_speed = LENGTH * along(a), LENGTH * rates[0] * across(a)
    upper = rod("upper", 0.5 * elbow, a, 0.5 * elbow_speed, rates[0])
    lower = rod(
        "lower",
        elbow + 0.5 * LENGTH * along(b),
        b,
        elbow_speed + 0.5 * LENGTH * rates[1] * across(b),
        rates[1],
    )
    end, start = np.array([0.5 * LENGTH, 0.0, 0.0]), np.array([-0.5 * LENGTH, 0.0, 0.0])
    joints = (
        Hinge(
            name="top",
            body_a="ground",
            body_b="upper",
            frame_a=JointFrame(np.zeros(3), ABOUT_Y),
            frame_b=JointFrame(start, ABOUT_Y),
        ),
        Hinge(
            name="elbow",
            body_a="upper",
            body_b="lower",
            frame_a=JointFrame(end, ABOUT_Y),
            frame_b=JointFrame(start, ABOUT_Y),
        ),
    )
    floor = surface(lambda x, _: height + 0.0 * x, half=3.0)
    contact = Contact(
        name="touch",
        contour="floor",
        body="lower",
        point=end,
        shape=SphereShape(TIP),
        law=law,
        friction=friction,
    )
    return Scene(
        bodies=(upper, lower),
        forces=(Gravity(gravity),),
        joints=joints,
        contours=(floor,),
        contacts=(contact,),
    )


def after_impact(angles, rates, restitution):
    """Velocities (v, w) of both rods after the impact and its impulse, from N M^-1 N^T condensed by the joints.

    Coordinates (x, z, angle) of either rod; G are the rates of the hinges, N that of the gap of the tip.
    """
    a, b = angles
    M = np.diag([MASS, MASS, INERTIA[1, 1]] * 2)
    hinges = np.zeros((4, 6))
    hinges[:2, :2], hinges[:2, 2] = np.eye(2), -0.5 * LENGTH * across(a)
    hinges[2:, :2], hinges[2:, 2] = -np.eye(2), -0.5 * LENGTH * across(a)
    hinges[2:, 3:5], hinges[2:, 5] = np.eye(2), -0.5 * LENGTH * across(b)
    N = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.5 * LENGTH * across(b)[1]])
    elbow = LENGTH * rates[0] * across(a)
    U = np.array([*(0.5 * elbow), rates[0], *(elbow + 0.5 * LENGTH * rates[1] * across(b)), rates[1]])
    assert np.abs(hinges @ U).max() < 1e-12
    inverse = np.linalg.inv(M)
    joined = inverse - inverse @ hinges.T @ np.linalg.solve(hinges @ inverse @ hinges.T, hinges @ inverse)
    impulse = -(1.0 + restitution) * (N @ U) / (N @ joined @ N)
    return U + joined @ N * impulse, impulse


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_impulse_at_the_tip_is_that_of_the_jointed_masses(restitution):
    angles, rates = (0.4, 1.0), (0.8, 1.3)
    height = LENGTH * (along(0.4) + along(1.0))[1] - TIP
    expected, impulse = after_impact(angles, rates, restitution)
    found = run(pendulum(angles, rates, height, RigidLaw(restitution), gravity=np.zeros(3)), 1e-4, 1e-3)
    start = np.concatenate(
        [
            found["upper.velocity"][0, ::2],
            found["upper.angular_velocity"][0, 1:2],
            found["lower.velocity"][0, ::2],
            found["lower.angular_velocity"][0, 1:2],
        ]
    )
    assert impulse > 0.1
    assert np.abs(start - expected).max() < 2e-6 * np.abs(expected).max()


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_falling_double_pendulum_keeps_joints_and_energy_account(restitution):
    drifts = []
    for step in (2e-3, 1e-3):
        found = run(pendulum((0.1, 0.3), (0.0, 0.0), -1.2, RigidLaw(restitution)), step, 1.0)
        elbow = found["upper.position"][:, ::2] * 2.0
        rod_b = found["lower.position"][:, ::2] - elbow
        assert np.abs(np.linalg.norm(elbow, axis=1) - LENGTH).max() < 1e-6
        assert np.abs(np.linalg.norm(rod_b, axis=1) - 0.5 * LENGTH).max() < 1e-6
        assert found["touch.impacts"][-1] >= 1.0
        assert found["touch.gap"].min() > -1e-5
        energy = found["energy.kinetic"] + found["energy.potential"]
        assert np.diff(energy).max() < 1e-4 * MASS * G
        if restitution == 1.0:
            assert found["touch.dissipated"][-1] < 1e-5
        else:
            assert found["touch.dissipated"][-1] > 0.1
        drifts.append(found.drift)
    assert drifts[1] < 1e-4 * MASS * G
    assert drifts[1] < 0.5 * drifts[0] + 1e-8


def test_tip_with_friction_comes_to_rest_on_the_plane():
    found = run(pendulum((0.1, 0.3), (0.0, 0.0), -1.2, RigidLaw(0.3), friction=0.6), 1e-3, 4.0)
    assert found["touch.gap"].min() > -1e-5
    assert found["energy.kinetic"][-1] < 1e-4 * MASS * G
    # the tip carries what the hinge at the top does not
    assert found["touch.normal_force"][-1] > 0.1 * MASS * G
    assert found["touch.friction_force"][-1] <= 0.6 * found["touch.normal_force"][-1] * (1.0 + 1e-6)
    assert found.drift < 1e-3 * MASS * G
