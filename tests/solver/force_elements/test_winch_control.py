"""Winches that answer to the tension, against closed forms; winches that follow; contradictions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from law_scenes import G, body, eye, run, scene, wire

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch
from heavylift.solver.scene.scene import Scene
from heavylift.solver.simulation import Simulation

EA, MASS = 1e7, 1000.0


def lift(winch: Winch | None, speed: float = 0.0, **more: Any) -> Scene:
    """A load 10 m below the ground on a rope without damping."""
    rope = wire(eye(GROUND), eye("load"), stiffness=EA, winch=winch, **more)
    return scene([body("load", MASS, (0, 0, -10.0), (0, 0, speed))], ropes=[rope])


def keeping(tension: float, **more: Any) -> Winch:
    return Winch(np.array([0.0]), tensions=np.array([tension]), **more)


def test_a_brake_slips_at_its_tension() -> None:
    """A load falls into it at 3 m/s: 15 kN take ``v^2/2 = (T/m - g) x``, with the stretch before; then it holds."""
    result = run(lift(Winch(brake=15e3), -3.0), 1e-3, 3.0)
    stretch = 15e3 * 10.0 / EA
    way = (0.5 * MASS * 9.0 + 0.5 * 15e3 * stretch) / (15e3 - MASS * G)
    assert result["rope.paid_out"][-1] == pytest.approx(way - stretch, rel=2e-3)
    assert result["rope.tension"].max() == pytest.approx(15e3, rel=1e-9)
    np.testing.assert_allclose(result["rope.strain"], result["rope.tension"] / EA, rtol=1e-9, atol=1e-15)
    assert result["rope.rest_length"][-1] == pytest.approx(10.0 + result["rope.paid_out"][-1], rel=1e-14)
    assert np.diff(result["rope.paid_out"]).min() >= 0.0
    assert result.balance < 1e-9 * result["energy.kinetic"].max()
    assert -result["energy.drive_work"][-1] == pytest.approx(15e3 * result["rope.paid_out"][-1], rel=2e-3)


def test_a_brake_that_holds_is_a_rope() -> None:
    """The same motion as without a winch, and nothing paid out."""
    held, plain = (run(lift(winch, length=10.0), 1e-2, 2.0) for winch in (Winch(brake=25e3), None))
    np.testing.assert_allclose(held["rope.tension"], plain["rope.tension"], rtol=1e-12)
    assert not np.any(held["rope.paid_out"])


def test_a_winch_that_hauls_against_its_brake_slips() -> None:
    """It is told 1 m/s at once and can hold 1.1 weights of the load, which rises by 0.1 g until it is as fast."""
    winch = Winch(np.array([0.0]), np.array([1.0]), brake=1.1 * MASS * G)
    result = run(lift(winch, tension=MASS * G), 1e-3, 0.9)
    assert result["load.velocity"][-1, 2] == pytest.approx(0.09 * G, rel=5e-3)
    assert result["rope.tension"].max() < 1.1 * MASS * G * (1.0 + 1e-9)


def test_a_winch_keeps_its_tension_and_its_speed() -> None:
    """``T (1 -+ band) - m g`` accelerates the load; it first hauls in what the rope stretches, at its largest speed."""
    up = run(lift(keeping(12e3, speed=0.5, dead_band=0.01), tension=MASS * G), 1e-3, 0.2)
    stretching = (0.99 * 12e3 - MASS * G) * 10.0 / EA / 0.5
    assert up["load.velocity"][-1, 2] == pytest.approx((0.2 - 0.5 * stretching) * (0.99 * 12.0 - G), rel=2e-3)
    assert up["rope.paying_speed"].min() == pytest.approx(-0.5, rel=1e-9)
    down = run(lift(keeping(8e3, speed=5.0, dead_band=0.01), tension=8e3), 1e-3, 1.0)
    assert down["load.velocity"][-1, 2] == pytest.approx(1.01 * 8.0 - G, rel=5e-3)
    assert down["rope.tension"][500:] == pytest.approx(1.01 * 8e3, rel=1e-9)
    assert down.balance < 1e-9 * MASS * G


def test_it_rests_in_its_dead_band() -> None:
    result = run(lift(keeping(MASS * G, speed=1.0, dead_band=0.05), tension=1.03 * MASS * G), 1e-3, 2.0)
    assert not np.any(result["rope.paid_out"])


def test_a_winch_follows_by_length() -> None:
    """Half the length of its leader, whichever of them is said first."""
    leader = Winch(np.array([0.0, 3.0]), np.array([0.4, 0.0]), acceleration=0.2, jerk=0.4)
    paths = [(eye(GROUND, (x, 0, 0)), RopePoint(name, np.zeros(3))) for x, name in ((0.0, "a"), (3.0, "b"))]
    ropes = [
        wire(*paths[1], name="second", winch=Winch(follow="first", ratio=0.5)),
        wire(*paths[0], name="first", winch=leader),
    ]
    result = run(scene([body("a", 1e3, (0, 0, -10)), body("b", 1e3, (3, 0, -10))], ropes=ropes), 1e-2, 6.0)
    first, second = (10.0 - result[f"{name}.rest_length"] for name in ("first", "second"))
    assert first[-1] == pytest.approx(1.2, rel=1e-12)
    np.testing.assert_allclose(second, 0.5 * first, atol=1e-14)


@pytest.mark.parametrize(
    ("winch", "words"),
    [
        (keeping(1e3), "'tensions' without 'speed'"),
        (keeping(1e3, speed=1.0, brake=2e3), "both 'tensions' and 'brake'"),
        (keeping(1e3, speed=1.0, acceleration=1.0), "both 'tensions' and 'acceleration'"),
        (
            Winch(follow="other"),
            "'other' is no rope with a winch by 'speeds' or 'lengths'; expected one of: none",
        ),
        (Winch(follow="rope"), "'rope' is no rope with a winch"),
        (Winch(np.array([0.0]), np.array([1.0]), follow="other"), "both 'follow' and 'speeds'"),
        (Winch(np.array([0.0]), np.array([1.0]), ratio=2.0), "'ratio' without 'follow'"),
        (Winch(), "neither 'speeds' nor 'lengths'"),
        (Winch(brake=-1.0), "brake"),
    ],
)
def test_contradictions_are_refused(winch: Winch, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Simulation(lift(winch), 1e-2)


def test_controls_know_no_friction_and_no_explicit_steps() -> None:
    path = [
        eye(GROUND),
        RopePoint(GROUND, np.array([1.0, 0, 5]), 0.3, np.array([0.0, 1, 0]), 0.9),
        eye("load"),
    ]
    rubbing = scene([body("load", 1.0, (2, 0, 0))], ropes=[wire(*path, winch=Winch(brake=1e3))])
    with pytest.raises(
        InputError, match="a winch controlled by the tension, on a rope over places with an efficiency"
    ):
        Simulation(rubbing, 1e-2)
    with pytest.raises(InputError, match="is controlled by its tension"):
        Simulation(lift(Winch(brake=1e3)), 1e-2, "accurate")


@pytest.mark.parametrize(
    "made", [lift(Winch(brake=15e3), -3.0), lift(keeping(12e3, speed=0.5))], ids=["brake", "keeps"]
)
def test_a_run_goes_on_where_it_was(made: Scene) -> None:
    """A checkpoint has what was paid out: the same bits."""
    first, second = (Simulation(made, 1e-3, "dele2") for _ in range(2))
    first.advance(150)
    second.restore(first.state())
    np.testing.assert_array_equal(first.advance(100)[1], second.advance(100)[1])
