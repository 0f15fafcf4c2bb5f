"""The trust-region step alone, on functions with known minima."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
from heavylift.contours.splines.search_step import (
    ABOVE_U,
    BELOW_U,
    BELOW_V,
    BORDER,
    CONVERGED,
    DEGENERATE,
    EVALUATE,
    NOT_FINITE,
    ContourSearch,
    least_quadratic,
    start_search,
    step_search,
)
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import filled


def _surface(closed: bool) -> PackedContour:
    u, v = (filled(PackedDirection, degree=3, count=11, closed=c, first_knot=0) for c in (closed, False))
    return filled(PackedContour, u=u, v=v, first_control=0, first_weight=-1)


OPEN, CLOSED = _surface(False), _surface(True)


@kernel
def quadratic(g, h, box, out):
    out[0], out[1], out[2] = least_quadratic(g[0], g[1], h[0], h[1], h[2], box[0], box[1], box[2], box[3])


@kernel
def begin(contour, u, v, result):
    start_search(contour, u, v, result)


@kernel
def step(contour, values, result):
    return step_search(
        contour, values[0], values[1], values[2], values[3], values[4], values[5], 1e-16, result
    )


def search(function, contour, u, v):
    """Run the step on a function of (u, v) that gives f and derivatives; returns status, result, trials."""
    result = ContourSearch.one()
    result.tangent_u[0] = result.tangent_v[1] = 1.0
    begin(contour, u, v, result)
    trials = []
    status = EVALUATE
    while status == EVALUATE:
        trials.append((result.trial_u, result.trial_v))
        status = step(contour, np.array(function(*trials[-1]), dtype=float), result)
    return status, result, np.array(trials)


def valley(u, v):
    """Squares of two curved residuals, zero at (0.4, 0.55)."""
    a, b = u - 0.4 + 2.0 * (v - 0.55) ** 2, v - 0.55
    f = 0.5 * (a * a + b * b)
    av = 4.0 * b
    return f, a, a * av + b, 1.0, av, av * av + 4.0 * a + 1.0


def test_a_quadratic_on_a_rectangle_is_minimised_globally():
    generator = np.random.default_rng(3)
    grid = np.stack(np.meshgrid(np.linspace(0, 1, 201), np.linspace(0, 1, 201)), -1).reshape(-1, 2)
    out = np.zeros(3)
    for _ in range(200):
        g, h = generator.standard_normal(2), generator.standard_normal(3)
        box = generator.random(4) * np.array([-1.0, 1.0, -1.0, 1.0])
        if generator.random() < 0.3:
            box[0] = 0.0  # at a border
        quadratic(g, h, box, out)
        d = box[[0, 2]] + grid * (box[[1, 3]] - box[[0, 2]])
        values = d @ g + 0.5 * (h[0] * d[:, 0] ** 2 + h[2] * d[:, 1] ** 2) + h[1] * d[:, 0] * d[:, 1]
        at = out[:2] @ g + 0.5 * (h[0] * out[0] ** 2 + h[2] * out[1] ** 2) + h[1] * out[0] * out[1]
        assert at == pytest.approx(-out[2], abs=1e-12)
        assert at <= values.min() + 1e-12
        assert box[0] <= out[0] <= box[1]
        assert box[2] <= out[1] <= box[3]


def test_convergence_is_quadratic():
    status, result, trials = search(valley, OPEN, 0.45, 0.62)
    errors = np.hypot(trials[:, 0] - 0.4, trials[:, 1] - 0.55)
    assert status == CONVERGED
    assert result.flags == 0
    assert errors[-1] < 1e-12
    seen = errors[errors > 1e-13]
    orders = np.log(seen[2:] / seen[1:-1]) / np.log(seen[1:-1] / seen[:-2])
    assert np.all(seen[1:] < 30.0 * seen[:-1] ** 2)
    assert orders[-1] > 1.7
    assert result.iterations == len(trials)


def test_a_saddle_and_a_maximum_are_left():
    def waves(u, v):
        # a saddle at (0.5, 0.5), minima at (0.5 -+ 0.25, 0.5)
        c = 4.0 * math.pi
        x = c * (u - 0.5)
        return (
            0.1 * math.cos(x) + 0.5 * (v - 0.5) ** 2 + 0.2,
            -0.1 * c * math.sin(x),
            v - 0.5,
            -0.1 * c * c * math.cos(x),
            0.0,
            1.0,
        )

    status, result, _ = search(waves, OPEN, 0.5, 0.5)
    assert status == CONVERGED
    assert abs(abs(result.u - 0.5) - 0.25) < 1e-11


@pytest.mark.parametrize(
    ("centre", "flags"),
    [
        ((-0.3, 0.4), BELOW_U),
        ((1.2, 0.4), ABOVE_U),
        ((-0.2, -0.3), BELOW_U | BELOW_V),
        ((0.0, 0.5), 0),  # on the border, but not held by it
    ],
)
def test_borders_hold_where_the_gradient_points_outwards(centre, flags):
    def bowl(u, v):
        a, b = u - centre[0], v - centre[1]
        return 0.5 * (a * a + b * b + 0.6 * a * b), a + 0.3 * b, b + 0.3 * a, 1.0, 0.3, 1.0

    status, result, _ = search(bowl, OPEN, 0.6, 0.6)
    reference = minimize(
        lambda p: bowl(*p)[0],
        [0.6, 0.6],
        jac=lambda p: np.array(bowl(*p)[1:3]),
        bounds=[(0, 1)] * 2,
        tol=1e-14,
    )
    assert status == CONVERGED
    assert [result.u, result.v] == pytest.approx(reference.x, abs=1e-7)
    assert result.flags & BORDER == flags


def test_a_closed_direction_is_crossed_at_its_seam():
    def wave(u, v):
        x = 2.0 * math.pi * (u - 0.98)
        return 1.0 - math.cos(x), 2 * math.pi * math.sin(x), v - 0.5, 4 * math.pi**2 * math.cos(x), 0.0, 1.0

    status, result, trials = search(wave, CLOSED, 0.05, 0.5)
    assert status == CONVERGED
    assert result.u == pytest.approx(0.98, abs=1e-12)
    assert np.all((trials >= 0.0) & (trials < 1.0))
    assert len(trials) <= 7


def test_a_constant_is_called_degenerate_and_ends():
    status, result, trials = search(lambda *_: (0.5, 0.0, 0.0, 0.0, 0.0, 0.0), OPEN, 0.3, 0.3)
    assert status == CONVERGED
    assert result.flags & DEGENERATE
    assert len(trials) == 1


def test_what_is_not_finite_is_reported():
    status, _, _ = search(lambda *_: (math.nan, 0.0, 0.0, 1.0, 0.0, 1.0), OPEN, 0.3, 0.3)
    assert status == NOT_FINITE
