"""Ropes in motion: slack and taut, over pulleys, on a winch."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from law_scenes import G, body, eye, pulley, run, scene, wire

from heavylift.solver.force_elements.wire_rope import SpringRope
from heavylift.solver.scene.connections import GROUND, RopePoint, Winch

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import Scene


def bouncing(stiffness: float) -> Scene:
    """1e4 kg on a rope of 10 m, dropped 2 m above its reach."""
    rope = SpringRope(
        name="rope",
        path=(RopePoint(GROUND, np.zeros(3)), RopePoint("load", np.zeros(3))),
        length=10.0,
        stiffness=stiffness,
    )
    return scene([body("load", 1e4, (0, 0, -8.0))], ropes=[rope])


def bounce(times: np.ndarray, stiffness: float) -> np.ndarray:
    """Elongation in closed form: parabola, sine about the static stretch, parabola, ..."""
    fall, w = math.sqrt(2.0 * 2.0 / G), math.sqrt(stiffness / 1e4)
    v, static = G * fall, G / w**2
    amplitude = math.hypot(static, v / w)
    phase = math.asin(static / amplitude)
    taut = (math.pi + 2.0 * phase) / w
    t = np.mod(times, 2.0 * fall + taut)
    rising = t - fall - taut
    sine = static + amplitude * np.sin(w * (t - fall) - phase)
    return np.where(
        t < fall, -2.0 + 0.5 * G * t**2, np.where(rising < 0.0, sine, -v * rising + 0.5 * G * rising**2)
    )


@pytest.mark.parametrize(
    ("stiffness", "errors"),
    [(1e6, {2e-2: 4.4e-2, 1e-2: 1.1e-2, 5e-3: 2.75e-3}), (1e8, {2e-2: 0.42, 1e-2: 0.125, 5e-3: 0.034})],
)
def test_bouncing_load(stiffness: float, errors: dict[float, float]) -> None:
    """Second order through every bounce, and the energy stays whatever the step is."""
    for step, allowed in errors.items():
        result = run(bouncing(stiffness), step, 10.0)
        elongation = -10.0 - result["load.position"][:, 2]
        assert np.abs(elongation - bounce(result.times, stiffness)).max() < allowed
        assert result.balance < 1e-12 * result["energy.kinetic"].max()


@pytest.mark.parametrize(
    ("stiffness", "errors"), [(1e6, {1e-5: 1e-3, 1e-8: 1e-6}), (1e8, {1e-5: 5e-3, 1e-8: 2e-5})]
)
def test_accurate_integrator_follows_a_bouncing_load(stiffness: float, errors: dict[float, float]) -> None:
    """Slack and taut: a kink of the force costs steps, and each of the bounces carries on the error of the last."""
    for tolerance, allowed in errors.items():
        result = run(bouncing(stiffness), 0.1, 10.0, "accurate", tolerance=tolerance)
        elongation = -10.0 - result["load.position"][:, 2]
        assert np.abs(elongation - bounce(result.times, stiffness)).max() < allowed
        np.testing.assert_allclose(
            result["rope.tension"], stiffness * np.maximum(elongation, 0.0), atol=1e-12 * stiffness
        )
        np.testing.assert_array_equal(result["rope.drift"], 0.0)
        assert result.balance < allowed * 1e4 * G


def test_accurate_integrator_books_winch_and_damper() -> None:
    """A load hauled up and shaken on a damped rope over a pulley: the balance closes, and both integrators agree."""
    winch = Winch(np.array([0.0, 0.5, 1.5, 2.0]), np.array([0.0, 0.4, 0.4, 0.0]))
    rope = wire(
        eye(GROUND, (-0.3, 0.0, -6.0)),
        pulley(GROUND, (0.0, 0.0, 0.0), 0.3),
        eye("load"),
        damping=2e3,
        stiffness=1e6,
        winch=winch,
    )
    hung = scene([body("load", 500.0, (1.0, 0.0, -5.0))], ropes=[rope])
    exact = run(hung, 0.05, 3.0, "accurate", tolerance=1e-10)
    assert exact["energy.dissipated"][-1] > 10.0
    assert exact["energy.drive_work"][-1] > 500.0 * G * 0.5
    assert exact.balance < 1e-6 * exact["energy.drive_work"][-1]
    errors = []
    for step in (2e-3, 1e-3):
        found = run(hung, step, 3.0)
        every = round(0.05 / step)
        errors.append(np.abs(found["load.position"][::every] - exact["load.position"]).max())
        for name in ("energy.dissipated", "energy.drive_work"):
            assert found[name][-1] == pytest.approx(exact[name][-1], rel=1e-2)
    assert errors[1] < 1e-3
    assert errors[0] > 3.5 * errors[1]


def test_tension_and_lengths_of_a_bouncing_load() -> None:
    result = run(bouncing(1e6), 1e-3, 3.0)
    elongation = -10.0 - result["load.position"][:, 2]
    np.testing.assert_allclose(result["rope.length"], 10.0 + elongation, rtol=1e-14)
    np.testing.assert_allclose(result["rope.tension"], 1e6 * np.maximum(elongation, 0.0), atol=1e-4)
    np.testing.assert_array_equal(result["rope.segment_tension"], result["rope.tension"])
    np.testing.assert_array_equal(result["rope.rest_length"], 10.0)
    np.testing.assert_allclose(result["rope.strain"], result["rope.tension"] / 1e7, rtol=1e-12, atol=1e-15)
    assert result["rope.strain"].min() == 0.0


def test_strain_of_a_hanging_load() -> None:
    """``m g / EA`` at rest."""
    rope = wire(eye(GROUND), eye("load"), stiffness=1e7, tension=1000.0 * G)
    result = run(scene([body("load", 1000.0, (0, 0, -10.0))], ropes=[rope]), 1e-2, 0.1)
    np.testing.assert_allclose(result["rope.strain"], 1000.0 * G / 1e7, rtol=1e-9)


def test_atwood_machine() -> None:
    """(m1 - m2)/(m1 + m2) g and 2 m1 m2/(m1 + m2) g once the damper has settled the stretch."""
    m1, m2, r = 100.0, 80.0, 0.3
    rope = wire(eye("a"), pulley(GROUND, (0, 0, 0), r), eye("b"), damping=3e3)
    result = run(scene([body("a", m1, (-r, 0, -5)), body("b", m2, (r, 0, -5))], ropes=[rope]), 1e-3, 1.0)
    late = result.times > 0.5
    rate = np.polyfit(result.times[late], result["a.velocity"][late, 2], 1)[0]
    assert rate == pytest.approx(-G * (m1 - m2) / (m1 + m2), rel=1e-9)
    assert result["rope.tension"][-1] == pytest.approx(2.0 * G * m1 * m2 / (m1 + m2), rel=1e-9)
    assert result["rope.length"][0] == pytest.approx(10.0 + math.pi * r, rel=1e-14)
    assert result["energy.dissipated"][-1] > 0.0
    assert result.balance < 1e-9


def hoist(step: float) -> tuple[np.ndarray, np.ndarray, float]:
    """1000 t on a two-part fall of 50 m, hoisted at 0.05 m/s with ramps of 1 s; tension, position, balance."""
    mass, stiffness = 1e6, 1e9
    drop = 50.0 * (1.0 + 0.5 * mass * G / stiffness)
    winch = Winch(np.array([0.0, 1.0, 9.0, 10.0]), np.array([0.0, 0.05, 0.05, 0.0]))
    rope = wire(
        eye(GROUND),
        eye("load"),
        eye(GROUND, (0, 1e-3, 0)),
        stiffness=stiffness,
        length=100.0,
        winch=winch,
    )
    start = (1.0, 0.0, -math.sqrt(drop**2 - 1.0))
    every = round(0.1 / step)
    result = run(scene([body("load", mass, start)], ropes=[rope]), step, 20.0)
    assert result["rope.rest_length"][-1] == pytest.approx(100.0 - 0.45, abs=1e-12)
    return result["rope.tension"][::every], result["load.position"][::every], result.balance


def test_hoist() -> None:
    """Second order in tension and position; the work of the winch closes the energy balance."""
    tension, position, _ = hoist(1e-3)
    errors = []
    for step in (2e-2, 1e-2):
        T, x, balance = hoist(step)
        errors.append((np.abs(T / tension - 1.0).max(), np.abs(x - position).max()))
        assert balance < 1e-6 * 2.2e6  # of the work of the winch
    assert errors[1][0] < 2e-5
    assert errors[1][1] < 7e-6
    for coarse, fine in zip(*errors, strict=True):
        assert coarse / fine == pytest.approx(4.0, rel=0.1)


def test_swinging_rope_gains_no_energy_and_does_not_creep() -> None:
    """Always taut for 100 s: the carried stretch stays by the geometry, and what it gives back is never a gain."""
    load = body("load", 2.0, np.array([0.6, 0.0, -0.8]) * (1.0 + 2.0 * G / 1e4), (0.0, 1.0, 0.0))
    rope = wire(eye(GROUND), eye("load"), stiffness=1e4, length=1.0)
    result = run(scene([load], ropes=[rope]), 1e-2, 100.0)
    balance = result["energy.balance"] - result["energy.balance"][0]
    assert balance.max() < 1e-10
    assert balance.min() > -0.01
    assert np.abs(result["rope.drift"]).max() < 1e-4


def pulleys(radius: float) -> Scene:
    """Two fixed and two moving pulleys, one rope: thesis, section 2.7.3."""
    r = radius
    rope = wire(
        eye(GROUND),
        pulley("left", (0, 0, 0), r, -1.0),
        pulley(GROUND, (3 * r, 0, 0), r),
        pulley("right", (0, 0, 0), r, -1.0),
        pulley(GROUND, (7 * r, 0, 0), r),
        eye("box"),
        damping=1e4,
    )
    bodies = [
        body("left", 20.0, (r, 0, -5)),
        body("right", 20.0, (5 * r, 0, -5)),
        body("box", 11.0, (8 * r, 0, -5)),
    ]
    return scene(bodies, ropes=[rope])


def test_pulleys() -> None:
    """One rope through three bodies: 2 z_left + 2 z_right + z_box is constant, the tension the same in all parts."""
    result = run(pulleys(0.2), 1e-3, 1.0)
    tension = 5.0 * G / (8.0 / 20.0 + 1.0 / 11.0)
    late = result.times > 0.5
    for name, rate in (
        ("left", 2.0 * tension / 20.0 - G),
        ("right", 2.0 * tension / 20.0 - G),
        ("box", tension / 11.0 - G),
    ):
        slope = np.polyfit(result.times[late], result[f"{name}.velocity"][late, 2], 1)[0]
        assert slope == pytest.approx(rate, abs=1e-6)
    np.testing.assert_allclose(result["rope.segment_tension"][-1], tension, rtol=1e-7)
    assert result.balance < 1e-8
