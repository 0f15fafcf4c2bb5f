"""A pendulum on a platform that is driven: motion, the force on the platform and the work of its drive."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import JointFrame
from heavylift.solver.scene.scene import Driven, Gravity, Harmonic, Profile, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G, AMPLITUDE, FREQUENCY, PLATFORM, MASS, LENGTH, WIDTH = 9.81, 0.2, 0.7, 10.0, 2.0, 1.0, 0.1
OMEGA = 2.0 * np.pi * FREQUENCY
ACROSS = MASS * (LENGTH**2 + WIDTH**2) / 12.0


@pytest.fixture(scope="module")
def scene() -> Scene:
    slide = Profile(harmonics=(Harmonic(AMPLITUDE, FREQUENCY),))
    platform = RigidBody("platform", PLATFORM, np.eye(3), motion=Driven(x=slide))
    rod = RigidBody(
        "rod",
        MASS,
        np.diag([MASS * WIDTH**2 / 6.0, ACROSS, ACROSS]),
        position=np.array([0.5 * LENGTH, 0.0, 0.0]),
        velocity=np.array([AMPLITUDE * OMEGA, 0.0, 0.0]),
    )
    hinge = Hinge(
        name="hinge",
        body_a="platform",
        body_b="rod",
        frame_a=JointFrame(),
        frame_b=JointFrame(np.array([-0.5 * LENGTH, 0.0, 0.0])),
    )
    return Scene((platform, rod), (Gravity(np.array([0.0, -G, 0.0])),), (), (hinge,))


def expected(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centre of the rod, force of the drive on the platform, and its work."""
    arm, inertia = 0.5 * LENGTH, ACROSS + 0.25 * MASS * LENGTH**2

    def platform(t):
        return AMPLITUDE * OMEGA * np.cos(OMEGA * t), -AMPLITUDE * OMEGA**2 * np.sin(OMEGA * t)

    def turn(t, angle):  # from the downward vertical
        return -MASS * arm * (G * np.sin(angle) + platform(t)[1] * np.cos(angle)) / inertia

    def force(t, angle, spin):
        rate = turn(t, angle)
        a = platform(t)[1]
        x = (PLATFORM + MASS) * a + MASS * arm * (rate * np.cos(angle) - spin**2 * np.sin(angle))
        y = (PLATFORM + MASS) * G + MASS * arm * (rate * np.sin(angle) + spin**2 * np.cos(angle))
        return np.array([x, y])

    def rates(t, y):
        return [y[1], turn(t, y[0]), force(t, y[0], y[1])[0] * platform(t)[0]]

    found = solve_ivp(
        rates, (0.0, times[-1]), [0.5 * np.pi, 0.0, 0.0], "DOP853", times, rtol=1e-12, atol=1e-12
    )
    angle, spin, work = found.y
    x = AMPLITUDE * np.sin(OMEGA * times) + arm * np.sin(angle)
    return np.column_stack([x, -arm * np.cos(angle)]), force(times, angle, spin).T, work


def errors(scene: Scene, step: float) -> np.ndarray:
    simulation = Simulation(scene, step, record_every=round(0.02 / step))
    first = simulation.record()
    times, rows = simulation.advance(round(1.0 / step))
    rows = np.vstack([first, rows])
    column = {channel.name: channel.column for channel in simulation.channels}
    centre, force, work = expected(np.r_[0.0, times])

    def distance(name, reference):
        begin = column[name]
        values = rows[:, begin : begin + (reference.shape[1] if reference.ndim == 2 else 1)]
        return np.abs(values - reference.reshape(len(values), -1)).max()

    balance = rows[:, column["energy.balance"]]
    return np.array(
        [
            distance("rod.position", centre),
            distance("platform.reaction_force", force),
            distance("energy.drive_work", work),
            np.ptp(balance),
        ]
    )


@pytest.mark.slow
def test_motion_force_and_work_are_of_second_order(scene: Scene) -> None:
    coarse, middle, fine = (errors(scene, step) for step in (4e-3, 2e-3, 1e-3))
    assert np.all(fine < [2e-5, 2e-3, 1e-3, 1e-4])
    assert np.all(np.log2(middle[:3] / fine[:3]) > 1.8)
    assert np.all(np.log2(coarse[:3] / middle[:3]) > 1.7)
