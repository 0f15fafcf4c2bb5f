"""Scenes with contacts: open ones do nothing, closed ones are refused."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from contact_scenes import MASS, RADIUS, ball, ball_on_floor

from heavylift.numerics.outcome import InputError
from heavylift.solver.forces.spring import Spring
from heavylift.solver.linearise.linearise import linearise
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

STIFFNESS, HEIGHT = 800.0, 0.15


def sprung() -> Scene:
    """A ball on a spring, which swings against a floor as it is released from above."""
    scene = ball_on_floor(ball((0.0, 0.0, HEIGHT)), gravity=np.zeros(3))
    spring = Spring(
        name="spring", body_a=GROUND, point_a=np.array([0.0, 0.0, 1.0]), body_b="ball", point_b=np.zeros(3),
        length=1.0, stiffness=STIFFNESS,
    )  # fmt: skip
    return Scene(scene.bodies, (*scene.forces, spring), contours=scene.contours, contacts=scene.contacts)


def test_an_open_contact_does_nothing() -> None:
    """And the run that bounces afterwards has the same bits as one that was not asked."""
    one, other = Simulation(sprung(), 2e-3), Simulation(sprung(), 2e-3)
    found = linearise(one)
    assert found.frequencies[-1] == pytest.approx(np.sqrt(STIFFNESS / MASS) / (2.0 * np.pi), rel=1e-7)
    for piece in (7, 60, 200):
        assert one.advance(piece)[1].tobytes() == other.advance(piece)[1].tobytes()
        with suppress(InputError):  # where it is closed
            linearise(one)
    before, after = one.state(), other.state()
    assert all(before[name].tobytes() == after[name].tobytes() for name in before if name != "cpu_seconds")


def test_a_closed_contact_is_refused() -> None:
    scene = ball_on_floor(ball((0.0, 0.0, RADIUS)))
    simulation = Simulation(scene, 1e-3)
    simulation.advance(20)
    with pytest.raises(InputError, match="'touch' touches"):
        linearise(simulation)
