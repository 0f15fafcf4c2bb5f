"""Winches with limits of acceleration and jerk, moves to lengths, and what is refused or stops a run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from law_scenes import body, eye, run, scene, wire

from heavylift.numerics.outcome import InputError, Outcome
from heavylift.solver.scene.connections import GROUND, Winch
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation


def lift(winch: Winch, **more: Any) -> Scene:
    rope = wire(eye(GROUND), eye("load"), stiffness=1e8, damping=1e6, winch=winch, **more)
    return scene([body("load", 1e3, (0, 0, -10.0))], ropes=[rope])


def table(values: list[float]) -> np.ndarray:
    return np.array(values, dtype=float)


def test_speeds_with_limits_haul_in_an_s_curve() -> None:
    """0.5 m/s at 0.1 m/s^2 and 0.05 m/s^3 from 1 s on: 0.05/6 m after 1 s, 1.75 m after 7 s, 4.5 m in all."""
    winch = Winch(table([1.0, 10.0]), table([0.5, 0.0]), acceleration=0.1, jerk=0.05)
    result = run(lift(winch), 0.01, 20.0)
    rest = result["rope.rest_length"]
    np.testing.assert_allclose(
        rest[[0, 100, 200, 800, 1000, 2000]], 10.0 - np.array([0, 0, 0.05 / 6, 1.75, 2.75, 4.5])
    )
    acceleration = np.diff(rest, 2) / 0.01**2
    assert np.abs(acceleration).max() < 0.1 * (1.0 + 1e-6)
    assert np.abs(np.diff(acceleration)).max() / 0.01 < 0.05 * (1.0 + 1e-4)
    # the load does as the winch says, for 1e8 N are stiff: energy is that of its weight and speed
    assert result["load.velocity"][900, 2] == pytest.approx(0.5, rel=1e-4)


@pytest.mark.parametrize("jerk", [None, 0.05])
def test_moves_to_lengths_keep_their_limits(jerk: float | None) -> None:
    """A long move that cruises and a short one that does not; it is at rest where it was told to be, not beyond."""
    lengths = table([10.0, 6.0, 6.1])
    winch = Winch(table([0.0, 1.0, 30.0]), lengths=lengths, speed=0.4, acceleration=0.1, jerk=jerk)
    rest = run(lift(winch), 0.01, 45.0)["rope.rest_length"]
    np.testing.assert_allclose(rest[[0, 100, 2900, -1]], [10.0, 10.0, 6.0, 6.1], atol=1e-12)
    assert rest.min() > 6.0 - 1e-12
    speed = np.diff(rest) / 0.01
    assert speed.min() == pytest.approx(-0.4, rel=1e-9)
    assert np.abs(np.diff(speed)).max() / 0.01 < 0.1 * (1.0 + 1e-6)
    short = 0.5 * np.sqrt(0.1 * 0.1) * 2.0 if jerk is None else (0.25 * 0.1**2 * 0.05) ** (1.0 / 3.0)
    assert speed.max() == pytest.approx(short, rel=1e-2)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"speeds": table([0.5, 0.0]), "acceleration": 0.1}, "takes 5 s, and the next one begins at 1 s"),
        ({"speeds": table([0.5, 0.0]), "jerk": 0.1}, "'jerk' without 'acceleration'"),
        ({"lengths": table([9.0, 8.0]), "acceleration": 0.1}, "limit of moves"),
        ({"speeds": table([0.5, 0.0]), "speed": 0.1, "acceleration": 0.1}, "limit of moves"),
    ],
)
def test_contradictions_are_refused(more: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Simulation(lift(Winch(table([0.0, 1.0]), **more)), 0.01)


def test_a_move_that_is_not_done_is_refused() -> None:
    winch = Winch(table([0.0, 0.1, 5.0]), lengths=table([10, 6, 7]), speed=0.4, acceleration=0.1)
    with pytest.raises(InputError, match="the next one begins at 5 s"):
        Simulation(lift(winch), 0.01)


def test_a_rope_that_is_hauled_in_whole_stops_the_run_by_its_name() -> None:
    simulation = Simulation(lift(Winch(table([0.0]), table([2.0]))), 0.01)
    simulation.advance(1000)
    assert simulation.outcome in {Outcome.NOT_FINITE, Outcome.NOT_CLOSED}
    assert "rope 'rope' is hauled in whole by its winch" in simulation.message
