"""A block that swings and turns on a fall of twelve parts: energy, and a run that is taken up again."""

from __future__ import annotations

import numpy as np

from heavylift.numerics.rotation import quaternion_from_rotation_vector
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scene.connections import GROUND, RopePoint
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G, PARTS, RADIUS, DROP, STEP = 9.81, 12, 0.4, 15.0, 0.002


def fall() -> Scene:
    """Sheaves of the crown on the ground, those of the block below, turned against each other."""
    count = PARTS // 2
    aside = 0.1 * (np.arange(count) - 0.5 * (count - 1))
    path = [RopePoint(GROUND, np.array([RADIUS, aside[0], 0.0]))]
    for k in range(count):
        path.append(
            RopePoint("block", np.array([0, aside[k], 0.0]), radius=RADIUS, axis=np.array([0, 1.0, 0]))
        )
        if k < count - 1:
            middle = 0.5 * (aside[k] + aside[k + 1])
            path.append(
                RopePoint(GROUND, np.array([0, middle, 0.0]), radius=RADIUS, axis=np.array([0, 1.0, 0]))
            )
    path.append(RopePoint(GROUND, np.array([-RADIUS, aside[-1], 0.0])))
    block = RigidBody(
        "block",
        2000.0,
        np.diag([900.0, 800.0, 400.0]),
        centre_of_mass=np.array([0.0, 0.0, -1.0]),
        position=np.array([0.4, 0.2, -DROP]),
        orientation=quaternion_from_rotation_vector(np.array([0.05, 0.02, 0.1])),
        velocity=np.array([0.3, -0.2, 0.0]),
    )
    rope = Rope(name="fall", path=tuple(path), axial_stiffness=2e6)
    return Scene((block,), (Gravity(np.array([0.0, 0.0, -G])),), ropes=(rope,))


def test_a_run_that_is_taken_up_again_has_the_same_bits() -> None:
    one = Simulation(fall(), STEP, record_every=10)
    one.advance(300)
    state = one.state()
    first = one.advance(300)[1]
    other = Simulation(fall(), STEP, record_every=10)
    other.restore(state)
    np.testing.assert_array_equal(other.advance(300)[1], first)


def test_no_energy_is_lost_and_the_stretch_stays_that_of_the_path() -> None:
    """Weight and rope only; rows that were not the derivative of the length would part the two."""
    simulation = Simulation(fall(), STEP, record_every=10)
    simulation.record()
    records = simulation.advance(1000)[1]
    column = {channel.name: channel.column for channel in simulation.channels}
    balance, kinetic = records[:, column["energy.balance"]], records[:, column["energy.kinetic"]]
    assert np.ptp(balance) < 1e-6 * np.ptp(kinetic)
    assert np.ptp(records[:, column["fall.length"]]) > 1e-3
    assert np.abs(records[:, column["fall.drift"]]).max() < 1e-5
