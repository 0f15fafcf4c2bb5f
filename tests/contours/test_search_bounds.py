"""Bounds of contours: they hold what they bound, also deformed, and are not far too large."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.search_bounds import (
    BOUND_WIDTH,
    control_bound,
    distance_bound,
    modal_growth,
    out_of_reach,
    widened,
)
from heavylift.numerics.jit import kernel


@kernel
def bounds(bound, points, growth, q, reach, out):
    wider = widened(growth, q, 1, growth.size)
    for i in range(points.shape[0]):
        out[0, i] = distance_bound(bound, points[i, 0], points[i, 1], points[i, 2], wider)
        out[1, i] = out_of_reach(bound, points[i, 0], points[i, 1], points[i, 2], wider, reach)
    return wider


def test_a_bound_is_below_every_distance_also_of_a_deformed_net():
    generator = np.random.default_rng(1)
    net = np.concatenate(
        [np.full((3, 3), 100.0), generator.uniform(-1, 1, (40, 3)) * np.array([3.0, 1.0, 0.5])]
    )
    modal = generator.standard_normal((5, 40, 3))
    bound = np.zeros(BOUND_WIDTH)
    control_bound(net, 3, 40, bound)
    assert np.all(np.linalg.norm(net[3:] - bound[6:9], axis=1) <= bound[9])
    assert np.all(np.abs(net[3:] - bound[:3]) <= bound[3:6] + 1e-15)
    spread = np.linalg.norm(net[3:, None] - net[None, 3:], axis=2).max()
    assert 0.5 * spread <= bound[9] <= 0.6 * spread
    for scale in (0.0, 0.02):
        q = np.concatenate([[np.nan], scale * generator.standard_normal(5)])
        deformed = net[3:] + np.einsum("i,ijk->jk", q[1:], modal)
        points = generator.uniform(-8, 8, (200, 3))
        out = np.zeros((2, 200))
        wider = bounds(bound, points, modal_growth(modal), q, 2.0, out)
        assert wider >= np.linalg.norm(deformed - net[3:], axis=1).max()
        exact = np.min(np.linalg.norm(points[:, None] - deformed, axis=2), axis=1)
        assert np.all(out[0] <= exact)
        assert np.all(exact[out[1] == 1.0] > 2.0)
        assert np.sum(out[1] == 1.0) > 0.6 * np.sum(exact > 2.0)  # and it does exclude
        inside = np.zeros((2, 40))
        bounds(bound, deformed, modal_growth(modal), q, 0.0, inside)
        assert np.all(inside == 0.0)


def test_growth_of_a_rigid_body_is_nothing():
    assert modal_growth(np.zeros((0, 7, 3))).size == 0


def test_growth_is_the_largest_displacement():
    modal = np.zeros((2, 3, 3))
    modal[0, 1] = [3.0, 0.0, 4.0]
    modal[1, 2] = [0.0, -2.0, 0.0]
    assert modal_growth(modal) == pytest.approx([5.0, 2.0], abs=1e-15)
