"""Compliant laws of contact: energy to the last bit, contact times and rebounds against theory and DOP853."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import beta

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.laws.normal_force import (
    hunt_crossley_damping,
    mean_normal_force,
    normal_force,
    stored_energy,
)
from heavylift.solver.contact.layout import HERTZ, HUNT_CROSSLEY, LINEAR

LAWS = [
    (LINEAR, 1.0, 4e4, 30.0),
    (HERTZ, 1.5, 3e6, 0.0),
    (HUNT_CROSSLEY, 1.5, 3e6, 0.4),
    (HUNT_CROSSLEY, 1.2, 2e5, 0.9),
]
H = 1e-3


@kernel
def bounce(law, k, n, a, mass, depth, speed, h, steps, out):
    """Midpoint steps of ``m d'' = -F``; out: depth, speed and energy given to the damper at every step."""
    lost = 0.0
    for step in range(steps):
        new = speed
        for _ in range(100):
            _, force, slope = mean_normal_force(law, k, n, a, depth, depth + 0.5 * h * (speed + new), h)
            change = -(mass * (new - speed) + h * force) / (mass + 0.5 * h * h * slope)
            new += change
            if abs(change) < 1e-15 * (abs(new) + abs(speed)):
                break
        end = depth + 0.5 * h * (speed + new)
        elastic, force, _ = mean_normal_force(law, k, n, a, depth, end, h)
        lost += (force - elastic) * (end - depth)
        depth, speed = end, new
        out[step, 0], out[step, 1], out[step, 2] = depth, speed, lost


def restitution(law, k, n, a, mass, speed, steps_per_pulse, phase):
    """Speed of return over that of approach, first touch within a step; and the histories."""
    h = pulse(k, n, mass, speed) / steps_per_pulse
    out = np.zeros((20 * steps_per_pulse, 3))
    bounce(law, k, n, a, mass, -phase * h * speed, speed, h, len(out), out)
    return -out[-1, 1] / speed, out


def pulse(k, n, mass, speed):
    """Contact time without damping: twice the integral of ``dd / sqrt(v^2 - 2 k d^(n+1) / (m (n+1)))``."""
    depth = ((n + 1.0) * mass * speed**2 / (2.0 * k)) ** (1.0 / (n + 1.0))
    return 2.0 * depth / speed * beta(1.0 / (n + 1.0), 0.5) / (n + 1.0)


@pytest.mark.parametrize(("law", "n", "k", "a"), LAWS)
@pytest.mark.parametrize(
    ("d0", "d1"),
    [
        (1e-3, 3e-3),
        (3e-3, 1e-3),
        (-1e-3, 2e-3),
        (2e-3, -1e-3),
        (1e-3, 1e-3 * (1 + 1e-9)),
        (-2e-3, -1e-3),
        (0.0, 1e-3),
    ],
)
def test_work_of_the_elastic_part_is_the_change_of_energy(law, n, k, a, d0, d1):
    elastic, force, slope = mean_normal_force(law, k, n, a, d0, d1, H)
    fine = np.linspace(d0, d1, 200001)
    exact = np.mean(
        [
            normal_force(law, k, n, 0.0, 0.5 * (p + q), 0.0)
            for p, q in zip(fine[:-1:50], fine[50::50], strict=True)
        ]
    )
    assert elastic == pytest.approx(exact, rel=1e-4, abs=1e-12)
    change = stored_energy(law, k, n, d1) - stored_energy(law, k, n, d0)
    scale = max(stored_energy(law, k, n, d1), stored_energy(law, k, n, d0))
    assert elastic * (d1 - d0) == pytest.approx(change, rel=1e-13, abs=4e-16 * scale)
    assert force >= 0.0
    assert slope >= 0.0
    assert (force - elastic) * (d1 - d0) >= -1e-15 * scale


@pytest.mark.parametrize(("law", "n", "k", "a"), LAWS)
@pytest.mark.parametrize("d0", [2e-3, -1e-3, 0.0])
def test_slope_is_the_derivative_and_the_force_is_continuous(law, n, k, a, d0):
    # the pull of the damper is cut off somewhere in here, and contact begins and ends
    ends = np.linspace(-4e-3, 5e-3, 4001)
    values = np.array([mean_normal_force(law, k, n, a, d0, d1, H) for d1 in ends])
    middle = np.array(
        [mean_normal_force(law, k, n, a, d0, 0.5 * (p + q), H)[2] for p, q in itertools.pairwise(ends)]
    )
    slopes = np.diff(values[:, 1]) / np.diff(ends)
    assert np.all(slopes >= -1e-9 * slopes.max())
    wrong = np.abs(slopes - middle) > 1e-3 * slopes.max()
    assert np.count_nonzero(wrong) <= 3  # kinks


@pytest.mark.parametrize(("law", "n", "k", "a"), LAWS)
def test_mean_force_is_that_of_the_motion_with_constant_rate(law, n, k, a):
    d0 = 2e-3
    for d1 in (-3e-3, 1e-3, 4e-3):
        t = (np.arange(20000) + 0.5) / 20000
        rate = (d1 - d0) / H
        exact = np.mean([normal_force(law, k, n, a, d0 + x * (d1 - d0), rate) for x in t])
        assert mean_normal_force(law, k, n, a, d0, d1, H)[1] == pytest.approx(exact, rel=2e-4, abs=1e-9)


@pytest.mark.parametrize(("law", "n", "k", "a"), LAWS)
def test_motion_and_dissipation_against_dop853(law, n, k, a):
    mass, speed = 2.0, 0.7
    duration = 0.8 * pulse(k, n, mass, speed)

    def rates(t, x):
        force = normal_force(law, k, n, a, x[0], x[1])
        free = normal_force(law, k, n, 0.0, x[0], 0.0)
        return [x[1], -force / mass, (force - free) * x[1]]

    reference = solve_ivp(
        rates, (0.0, duration), [1e-5, speed, 0.0], method="DOP853", rtol=1e-12, atol=1e-14
    ).y[:, -1]
    errors = []
    for steps in (100, 200):
        out = np.zeros((steps, 3))
        bounce(law, k, n, a, mass, 1e-5, speed, duration / steps, steps, out)
        energy = 0.5 * mass * out[-1, 1] ** 2 + stored_energy(law, k, n, out[-1, 0]) + out[-1, 2]
        start = 0.5 * mass * speed**2 + stored_energy(law, k, n, 1e-5)
        assert energy == pytest.approx(start, rel=1e-13)
        errors.append(abs(out[-1, 1] - reference[1]))
    assert errors[1] < 2e-4 * speed
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)
    assert out[-1, 2] == pytest.approx(reference[2], rel=1e-2, abs=1e-12)


def test_hertz_contact_time_and_peak():
    k, mass, speed = 3e6, 2.0, 0.7
    duration = pulse(k, 1.5, mass, speed)
    # K. L. Johnson, Contact Mechanics, eq. 11.24: T = 2.94 d_max / v
    deepest = (1.25 * mass * speed**2 / k) ** 0.4
    assert duration == pytest.approx(2.9432 * deepest / speed, rel=1e-4)
    steps = 400
    out = np.zeros((2 * steps, 3))
    bounce(HERTZ, k, 1.5, 0.0, mass, 0.0, speed, duration / steps, len(out), out)
    inside = out[:, 0] > 0.0
    assert np.count_nonzero(inside) / steps == pytest.approx(1.0, abs=0.005)
    assert k * out[:, 0].max() ** 1.5 == pytest.approx(k * deepest**1.5, rel=1e-4)
    assert -out[-1, 1] == pytest.approx(speed, rel=1e-13)


@pytest.mark.parametrize("n", [1.0, 1.5])
@pytest.mark.parametrize("e", [0.8, 0.5, 0.2])
def test_restitution_at_20_steps_a_pulse(n, e):
    mass, speed, k = 2.0, 0.7, 3e6
    a = hunt_crossley_damping(e, speed)
    for phase in np.linspace(0.02, 0.98, 9):
        assert restitution(HUNT_CROSSLEY, k, n, a, mass, speed, 20, phase)[0] == pytest.approx(e, rel=3e-3)


@pytest.mark.parametrize("e", [1e-4, 0.01, 0.2, 0.5, 0.8, 0.99, 0.99999])
def test_damping_of_hunt_and_crossley(e):
    D = hunt_crossley_damping(e, 2.0) * 2.0
    if e >= 0.05:
        assert math.log1p(D) - math.log1p(-e * D) == pytest.approx(D * (1.0 + e), rel=1e-12)
    else:  # 1 - e D = (1 + D) exp(-D (1 + e)) underflows
        assert pytest.approx(1.0 / e, rel=1e-12) == D
    if e > 0.9:
        assert pytest.approx(1.5 * (1.0 - e) / (1.0 - e + e * e), rel=1e-3) == D


def test_damping_at_the_ends():
    assert hunt_crossley_damping(1.0, 2.0) == 0.0
    assert hunt_crossley_damping(0.5, 0.0) == 0.0
    assert math.isfinite(hunt_crossley_damping(0.0, 2.0))
