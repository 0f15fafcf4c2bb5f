"""Joints with compliance are springs, and their relaxation dampers: motion and energies against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from law_scenes import DOWN, G, body, run

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.guide import Guide
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.scene import Scene

MASS, STIFFNESS = 1000.0, 1e5


def falls(joint, step: float, duration: float, position=(0, 0, 0)):
    return run(Scene((body("load", MASS, position),), (DOWN,), (), (joint,)), step, duration)


def energies(found) -> np.ndarray:
    return np.column_stack(
        [found[f"energy.{name}"] for name in ("kinetic", "elastic", "potential", "dissipated")]
    )


@pytest.mark.parametrize("relaxation", [0.0, 5e-3])
def test_a_load_let_go_on_a_compliant_joint_is_an_oscillator(relaxation: float) -> None:
    """Damping over stiffness is the relaxation: what is stored and lost is that of the closed form, to second order."""
    joint = Ball(name="j", body_a=GROUND, body_b="load", compliance=1.0 / STIFFNESS, relaxation=relaxation)
    frequency, damping = np.sqrt(STIFFNESS / MASS), 0.5 * relaxation * STIFFNESS / MASS
    damped = np.sqrt(frequency**2 - damping**2)
    errors = []
    for step in (4e-3, 2e-3):
        found = falls(joint, step, 2.0)
        t, rest = found.times, -MASS * G / STIFFNESS
        swing = np.exp(-damping * t) * (np.cos(damped * t) + damping / damped * np.sin(damped * t))
        z, total = rest * (1.0 - swing), energies(found)
        stored = 0.5 * STIFFNESS * z**2
        size = stored.max()
        errors.append(
            (
                np.abs(found["load.position"][:, 2] - z).max() / abs(rest),
                np.abs(total[:, 1] - stored).max() / size,
            )
        )
        np.testing.assert_allclose(total.sum(axis=1), total[0].sum(), rtol=0.0, atol=1e-9 * size)
        assert (total[-1, 3] > 0.1 * size) == (relaxation > 0.0)
    assert max(errors[-1]) < 2e-3
    np.testing.assert_allclose(np.divide(*errors), 4.0, rtol=0.05)


def test_energy_of_a_pendulum_on_a_soft_hinge_is_kept_to_second_order() -> None:
    """Stretches and turns of all rows count, also with a wide swing."""
    axis = JointFrame(np.array([-1.0, 0.0, 0.0]), np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]).T)
    joint = Hinge(
        name="j", body_a=GROUND, body_b="load", frame_a=JointFrame(np.zeros(3), axis.axes), frame_b=axis,
        compliance=1e-5, relaxation=2e-2,
    )  # fmt: skip
    drift = []
    for step in (4e-3, 2e-3):
        total = energies(falls(joint, step, 5.0, (1, 0, 0)))
        drift.append(np.abs(total.sum(axis=1) - total[0].sum()).max() / np.ptp(total[:, 2]))
        assert total[-1, 3] > 0.1 * np.ptp(total[:, 2])
    assert drift[1] < 2e-5
    assert drift[0] / drift[1] > 3.5


def test_relaxation_of_what_is_driven_takes_from_its_stretch_alone() -> None:
    """Not from the speed that a drive prescribes; the drive works against spring and damper."""
    turned = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]).T  # x of joints along y
    joint = Guide(
        name="j", body_a=GROUND, body_b="load", frame_a=JointFrame(np.zeros(3), turned),
        frame_b=JointFrame(np.zeros(3), turned), speed=0.5, compliance=1.0 / STIFFNESS, relaxation=5e-3,
    )  # fmt: skip
    found = falls(joint, 2e-3, 2.0)
    total, work = energies(found), found["energy.drive_work"]
    y, t = found["load.position"][:, 1], found.times
    frequency, damping = np.sqrt(STIFFNESS / MASS), 0.25
    damped = np.sqrt(frequency**2 - damping**2)
    stretch = -0.5 * np.exp(-damping * t) * np.sin(damped * t) / damped
    np.testing.assert_allclose(y, 0.5 * t + stretch, rtol=0.0, atol=5e-4)
    assert total[-1, 3] > 0.1 * total[:, 0].max()
    across = total[:, [0, 1, 2, 3]].sum(axis=1) - work
    assert np.abs(across - across[0]).max() < 1e-7 * np.abs(work).max()
