"""Tuggers against closed forms: a force in a file of its own, in all integrators."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.tugger import Tugger
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.scene import RigidBody, Scene
from heavylift.solver.simulation import Simulation

MASS, HEIGHT, TENSION, START = 3.0, 4.0, 50.0, 3.0


def sled(tension: float = TENSION) -> Scene:
    """A sled on a rail along x, pulled towards a point above the origin."""
    rail = JointFrame(np.zeros(3), axes_about(np.array([1.0, 0.0, 0.0])))
    body = RigidBody("sled", MASS, np.eye(3), position=np.array([START, 0.0, 0.0]))
    on_body = JointFrame(np.array([-START, 0.0, 0.0]), rail.axes)
    joint = Slider(name="rail", body_a=GROUND, body_b="sled", frame_a=rail, frame_b=on_body)
    tugger = Tugger(
        name="line",
        body_a=GROUND,
        point_a=np.array([0.0, 0.0, HEIGHT]),
        body_b="sled",
        point_b=np.zeros(3),
        tension=tension,
    )
    return Scene((body,), forces=(tugger,), joints=(joint,))


@pytest.mark.parametrize(
    ("options", "tolerance"),
    [
        ({"integrator": "dele2", "step": 1e-3}, 2e-6),
        ({"integrator": "accurate", "tolerance": 1e-9, "step": 6e-2}, 1e-7),
        ({"integrator": "thesis", "step": 1e-4}, 2e-3),
    ],
)
def test_a_sled_has_the_energy_of_the_line_that_was_hauled_in(options, tolerance) -> None:
    """``m v^2 / 2 = T (L_0 - L)`` at every instant, and the tension is what is recorded."""
    run = Simulation(sled(), record_every=round(0.06 / options["step"]), **options)
    steps = round(0.6 / options["step"])
    records = run.advance(steps)[1]
    columns = {c.name: c.column for c in run.channels}
    x, speed = records[:, columns["sled.position"]], records[:, columns["sled.velocity"]]
    length = np.hypot(x, HEIGHT)
    energy = TENSION * (np.hypot(START, HEIGHT) - length)
    scale = energy.max()
    np.testing.assert_allclose(0.5 * MASS * speed**2, energy, atol=tolerance * scale)
    np.testing.assert_allclose(
        records[:, columns["line.distance"]], length, rtol=1e-10
    )  # as well as the rail holds
    np.testing.assert_array_equal(records[:, columns["line.pull"]], TENSION)
    np.testing.assert_allclose(records[:, columns["energy.external_work"]], energy, atol=tolerance * scale)


def test_the_order_of_the_default_integrator_is_two() -> None:
    errors = []
    for step in (8e-3, 4e-3):
        run = Simulation(sled(), integrator="dele2", step=step)
        last = run.advance(round(0.48 / step))[1][-1]
        columns = {c.name: c.column for c in run.channels}
        x, speed = last[columns["sled.position"]], last[columns["sled.velocity"]]
        errors.append(abs(0.5 * MASS * speed**2 - TENSION * (5.0 - np.hypot(x, HEIGHT))))
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.2


@pytest.mark.parametrize("tension", [-1.0, np.nan, np.inf])
def test_a_tension_is_finite_and_pulls(tension: float) -> None:
    with pytest.raises(InputError, match="line: tension"):
        Simulation(sled(tension), step=1e-3)
