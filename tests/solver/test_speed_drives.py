"""Drives by speed: closed forms of trapezoids and S-curves, swing of a pendulum behind one, tables that overshoot."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from heavylift.numerics.jit import in_python
from heavylift.numerics.outcome import InputError
from heavylift.solver.drive import pack_profile, profile_value
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.bodies import Driven, Profile
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G, LENGTH = 9.81, 45.0


def by_speed(times: Any, speeds: Any, **more: Any) -> Profile:
    return Profile(np.array(times, dtype=float), speeds=np.array(speeds, dtype=float), **more)


def at(profile: Profile, times: Any) -> np.ndarray:
    data = pack_profile(profile)
    return np.array([in_python(profile_value)(data, 0, float(time)) for time in times])


def test_s_curve_has_its_limits() -> None:
    """0.5 m/s at 0.1 m/s^2 and 0.05 m/s^3: 2 s, 3 s, 2 s; way dv T/2; no jump of the acceleration."""
    profile = by_speed([1.0, 20.0], [0.5, 0.0], acceleration=0.1, jerk=0.05)
    value, rate, acceleration = at(profile, [0.0, 1.0, 2.0, 3.0, 6.0, 8.0, 20.0, 27.0, 1000.0]).T
    np.testing.assert_allclose(rate, [0, 0, 0.025, 0.1, 0.4, 0.5, 0.5, 0, 0], atol=1e-15)
    np.testing.assert_allclose(acceleration, [0, 0, 0.05, 0.1, 0.1, 0, 0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(value[[0, 2, 5, 6, 7, 8]], [0, 0.05 / 6, 1.75, 7.75, 9.5, 9.5], atol=1e-14)
    fine = np.linspace(0.0, 30.0, 30001)
    jumps = np.diff(at(profile, fine)[:, 2])
    assert np.abs(jumps).max() < 1.01 * 0.05 * 1e-3


def test_a_small_change_does_not_reach_the_acceleration() -> None:
    """``2 sqrt(dv/J)``, largest acceleration ``sqrt(dv J)``."""
    profile = by_speed([0.0], [0.08], acceleration=1.0, jerk=0.5)
    duration = 2.0 * math.sqrt(0.08 / 0.5)
    values = at(profile, [0.5 * duration, duration, duration + 10.0])
    np.testing.assert_allclose(values[:, 1], [0.04, 0.08, 0.08], rtol=1e-14)
    assert values[0, 2] == pytest.approx(math.sqrt(0.08 * 0.5), rel=1e-12)
    assert values[2, 0] == pytest.approx(0.5 * 0.08 * duration + 0.8, rel=1e-12)


@pytest.mark.parametrize(
    "profile",
    [
        by_speed([1.0, 10.0, 20.0], [0.5, -0.2, 0.0], acceleration=0.1, jerk=0.05),
        by_speed([-1.0, 4.0], [0.5, 0.0], acceleration=0.3),
        by_speed([2.0, 3.0, 7.0], [0.4, 0.1, 0.3]),
    ],
)
def test_rates_are_derivatives(profile: Profile) -> None:
    """Way is 0 at time 0, speed its derivative, acceleration that of the speed: central differences."""
    times, h = np.linspace(0.013, 30.0, 611), 1e-4
    low, middle, high = (at(profile, times + s) for s in (-h, 0.0, h))
    assert at(profile, [0.0])[0, 0] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose((high[:, 0] - low[:, 0]) / (2 * h), middle[:, 1], atol=5e-6)
    smooth = np.abs(high[:, 2] - low[:, 2]) < 1e-3
    np.testing.assert_allclose(((high[:, 1] - low[:, 1]) / (2 * h))[smooth], middle[smooth, 2], atol=1e-5)


def test_linear_speeds_are_held_at_both_ends() -> None:
    values = at(by_speed([2.0, 3.0], [0.4, 0.1]), [0.0, 1.0, 2.0, 3.0, 103.0])
    np.testing.assert_allclose(values[:, 1], [0.4, 0.4, 0.4, 0.1, 0.1], rtol=1e-14)
    np.testing.assert_allclose(values[:, 0], [0.0, 0.4, 0.8, 1.05, 11.05], rtol=1e-12)


def swing(ramp: float) -> float:
    """Amplitude of a load below a trolley that has been brought to 0.3 m/s in a time [m]."""
    trolley = by_speed([0.0], [0.3], acceleration=0.3 / ramp)
    bodies = (
        RigidBody("trolley", 1e4, np.eye(3), motion=Driven(x=trolley)),
        RigidBody("load", 1e3, np.eye(3) * 1e-6, position=np.array([0.0, 0.0, -LENGTH])),
    )
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    hinge = Hinge(
        name="arm",
        body_a="trolley",
        body_b="load",
        frame_a=JointFrame(np.zeros(3), axes),
        frame_b=JointFrame(np.array([0.0, 0.0, LENGTH]), axes),
    )
    simulation = Simulation(Scene(bodies, (Gravity(np.array([0.0, 0.0, -G])),), (), (hinge,)), 0.02, "dele2")
    _, records = simulation.advance(4000)
    columns = {channel.name: channel.column for channel in simulation.channels}
    apart = records[:, columns["load.position"]] - records[:, columns["trolley.position"]]
    return float(np.abs(apart[2000:]).max())


@pytest.mark.parametrize("periods", [0.3, 0.5, 1.0, 1.5])
def test_swing_behind_a_trapezoid(periods: float) -> None:
    """``2 (a/g) l |sin(w t/2)|`` is left by a ramp of a time t, and nothing by one of a whole period."""
    w = math.sqrt(G / LENGTH)
    ramp = periods * 2.0 * math.pi / w
    expected = 2.0 * (0.3 / ramp) / G * LENGTH * abs(math.sin(0.5 * w * ramp))
    assert swing(ramp) == pytest.approx(expected, rel=0.01, abs=1e-4)


def test_a_smooth_table_says_that_it_overshoots_and_a_monotone_one_does_not() -> None:
    """A rest of 50 s before a move of 25 s: the clamped spline swings back by more than a metre."""
    table = (np.array([0.0, 50.0, 75.0, 76.0]), np.array([0.0, 0.0, 5.0, 5.0]))
    fine = np.linspace(0.0, 80.0, 8001)
    smooth, monotone = Profile(*table), Profile(*table, interpolation="monotone")
    least = at(smooth, fine)[:, 0].min()
    assert least < -1.4
    values = at(monotone, fine)[:, 0]
    assert values.min() == 0.0
    assert values.max() == 5.0
    assert np.diff(values).min() >= 0.0
    frame = JointFrame(np.zeros(3), axes_about(np.array([1.0, 0.0, 0.0])))
    for profile, told in ((smooth, True), (monotone, False)):
        joint = Slider(name="rail", body_a=GROUND, body_b="cart", frame_a=frame, frame_b=frame, drive=profile)
        scene = Scene((RigidBody("cart", 1.0, np.eye(3)),), (), (), (joint,))
        warning = Simulation(scene, 0.1, "dele2").warning
        assert ("'rail' leaves the values of its table by 1.4" in warning) == told


@pytest.mark.parametrize(
    ("profile", "words"),
    [
        (by_speed([0.0, 3.0], [0.5, 0.0], acceleration=0.1), "takes 5 s, and the next one begins at 3 s"),
        (by_speed([0.0], [0.5], jerk=0.1), "'jerk' without 'acceleration'"),
        (by_speed([0.0, 1.0], [0.5]), "2 times and 1 speeds"),
        (
            Profile(np.array([0.0, 1.0]), np.array([0.0, 1.0]), acceleration=0.1),
            "'acceleration' without 'speeds'",
        ),
        (
            Profile(np.array([0.0, 1.0]), np.array([0.0, 1.0]), speeds=np.ones(2)),
            "both 'values' and 'speeds'",
        ),
        (by_speed([0.0], [0.5], interpolation="monotone"), "'monotone' without 'values'"),
    ],
)
def test_contradictions_are_refused(profile: Profile, words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_object(profile, "travel", "drive")


def test_a_ramp_may_end_where_the_next_one_begins() -> None:
    """0.1 m/s^2 for 5 s up and 5 s down without a rest between: 2.5 m, and no jump of the speed."""
    profile = by_speed([0.0, 5.0], [0.5, 0.0], acceleration=0.1)
    values = at(profile, np.linspace(0.0, 12.0, 1201))
    assert np.abs(np.diff(values[:, 1])).max() < 1.001e-3
    np.testing.assert_allclose(values[[500, 1000, -1], 0], [1.25, 2.5, 2.5], rtol=1e-12)
