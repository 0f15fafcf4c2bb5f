"""Stops, dry friction and tabulated springs on a slider, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from law_scenes import NONE, G, body, run, scene, slider

from heavylift.solver.forces.spring import JointSpring
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, Limits

MASS = 2.0


def test_sliding_block_stops_and_stays() -> None:
    """It stops after v/(mu g) and v^2/(2 mu g), and friction has taken all of its energy."""
    mu, v = 0.3, 3.0
    block = body("block", MASS, (0, 0, 0), (v, 0, 0))
    for step in (2e-2, 7e-3):
        result = run(scene([block], joints=[slider(friction=mu * MASS * G)]), step, 2.0)
        at_rest = np.abs(result["block.velocity"][:, 0]) < 1e-9
        assert result.times[np.argmax(at_rest)] == pytest.approx(v / (mu * G), abs=1.5 * step)
        assert result["block.position"][-1, 0] == pytest.approx(v**2 / (2.0 * mu * G), abs=mu * G * step**2)
        assert result["energy.dissipated"][-1] == pytest.approx(
            0.5 * MASS * v**2, abs=MASS * (mu * G * step) ** 2
        )
        stopped = result["block.position"][np.argmax(at_rest) :, 0]
        assert np.ptp(stopped) < 1e-12


def test_friction_on_a_slope() -> None:
    """It holds up to its largest load, but for the regularisation, and slides with the rest beyond."""
    block, slope = body("block", MASS, (0, 0, 0)), np.array([1.0, 0.0, -0.2])
    held = run(scene([block], joints=[slider(slope, friction=10.0)]), 1e-2, 2.0)
    assert np.abs(held["block.position"][-1]).max() < 1e-8
    steep = np.array([1.0, 0.0, -1.0])
    free = run(scene([block], joints=[slider(steep, friction=10.0)]), 1e-2, 1.0)
    rate = G / math.sqrt(2.0) - 10.0 / MASS
    assert np.linalg.norm(free["block.position"][-1]) == pytest.approx(0.5 * rate, rel=1e-12)
    assert free.balance < 1e-8  # the slider is regularised


def test_stop_is_half_a_sine() -> None:
    """Second order through both corners; the energy returns exactly."""
    k, at = 2e4, 0.1
    w = math.sqrt(k / MASS)
    errors = []
    for step in (2e-3, 1e-3):
        stop = slider(limits=Limits(upper=at, stiffness=k))
        result = run(scene([body("block", MASS, (0, 0, 0), (1, 0, 0))], joints=[stop], field=NONE), step, 0.5)
        t = result.times - at
        touch = np.where(t < math.pi / w, at + np.sin(w * t) / w, at - (t - math.pi / w))
        errors.append(np.abs(result["block.position"][:, 0] - np.where(t < 0.0, result.times, touch)).max())
        assert result.balance < 1e-13
    assert errors[1] < 3e-5
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_stops_without_a_stiffness_hold() -> None:
    stop = slider(limits=Limits(lower=-0.1, upper=0.1))
    result = run(scene([body("block", MASS, (0, 0, 0), (1, 0, 0))], joints=[stop], field=NONE), 1e-3, 5.0)
    assert 0.1 < np.abs(result["block.position"][:, 0]).max() < 0.1 + 1.05 / 400.0
    assert result.balance < 1e-12


def test_damped_stop_takes_energy() -> None:
    stop = slider(limits=Limits(upper=0.1, stiffness=2e4, damping=100.0))
    result = run(scene([body("block", MASS, (0, 0, 0), (1, 0, 0))], joints=[stop], field=NONE), 1e-3, 0.5)
    assert result["block.velocity"][-1, 0] < 0.0
    assert result["energy.dissipated"][-1] == pytest.approx(1.0 - result["energy.kinetic"][-1], abs=1e-12)


def test_tabulated_spring_keeps_energy_through_its_corners() -> None:
    """Soft one way and stiff the other: half periods of two sines."""
    soft, stiff = 50.0, 5e3
    spring = JointSpring(
        name="spring",
        joint="slide",
        deflections=np.array([-1.0, 0.0, 1.0]),
        loads=np.array([-soft, 0.0, stiff]),
    )
    period = math.pi * (math.sqrt(MASS / soft) + math.sqrt(MASS / stiff))
    errors = []
    for steps in (200, 400):
        start = body("block", MASS, (0, 0, 0), (1, 0, 0))
        result = run(scene([start], [spring], [slider()], field=NONE), period / steps, 3.0 * period)
        errors.append(abs(result["block.position"][-1, 0]))
        assert result.balance < 1e-12
        x = result["block.position"][:, 0]
        np.testing.assert_allclose(result["spring.load"], np.where(x > 0.0, stiff * x, soft * x), atol=1e-9)
    assert errors[1] < 0.3 * errors[0]
    assert errors[1] < 2e-3


def wheel(rate: float = 0.0):
    """A body with unit inertia that turns about the world z axis."""
    return body("wheel", 10.0, (0, 0, 0), angular_velocity=np.array([0.0, 0.0, rate]))


@pytest.mark.parametrize(
    ("lower", "upper", "rate"),
    [(-np.inf, 7.0, 3.0), (-6.5, 0.2, -3.0), (-0.1, 20.0, 3.0), (-np.inf, 3.5, 3.0), (0.0, 18.85, 3.0)],
)
def test_stops_beyond_half_a_turn_are_where_they_are_given(lower: float, upper: float, rate: float) -> None:
    """The angle is zero at the start whatever the range: half a sine beyond the stop, and back at the same rate."""
    k = 4e4
    w = math.sqrt(k)
    hinge = Hinge(name="hinge", body_a=GROUND, body_b="wheel", limits=Limits(lower, upper, stiffness=k))
    found = run(
        scene([wheel(rate)], joints=[hinge], field=NONE),
        1e-4,
        1.1 * abs((upper if rate > 0.0 else lower) / rate),
    )
    stop = upper if rate > 0.0 else lower
    angle = found["hinge.angle"]
    reached = angle.max() if rate > 0.0 else angle.min()
    assert reached - stop == pytest.approx(rate / w, rel=1e-3)
    touched = stop / rate
    behind = found.times > touched + math.pi / w + 1e-3
    back = stop - rate * (found.times - touched - math.pi / w)
    np.testing.assert_allclose(angle[behind], back[behind], rtol=0, atol=2e-4)
    assert found.balance < 1e-9


@pytest.mark.parametrize("table", [False, True])
@pytest.mark.parametrize("rest", [7.0, -9.0, 3.3, 1.0])
def test_a_spring_may_be_wound_up_by_turns(rest: float, table: bool) -> None:
    """``angle = rest (1 - cos w t)`` from the initial position, in which the angle is zero."""
    k = 5.0
    given = (
        {"deflections": np.array([-20.0, 20.0]), "loads": k * np.array([-20.0, 20.0])}
        if table
        else {"stiffness": k}
    )
    spring = JointSpring(name="spring", joint="hinge", rest=rest, **given)
    hinge = Hinge(name="hinge", body_a=GROUND, body_b="wheel")
    found = run(scene([wheel()], [spring], [hinge], field=NONE), 1e-3, 1.0)
    exact = rest * (1.0 - np.cos(math.sqrt(k) * found.times))
    np.testing.assert_allclose(found["hinge.angle"], exact, rtol=0, atol=2e-6 * abs(rest))
    np.testing.assert_allclose(found["spring.load"], k * (exact - rest), rtol=0, atol=2e-5 * abs(rest))


def test_a_stop_that_pushes_where_nothing_else_acts_lets_go_at_rest() -> None:
    """Without weight a search for equilibrium ends where the stop begins."""
    hinge = Hinge(name="hinge", body_a=GROUND, body_b="wheel", limits=Limits(upper=-0.35, stiffness=1e4))
    found = run(scene([wheel()], joints=[hinge], field=NONE), 1e-3, 0.1, start="equilibrium")
    np.testing.assert_allclose(found["hinge.angle"], -0.35, rtol=0, atol=1e-9)
