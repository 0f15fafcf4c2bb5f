"""Closest points of surfaces and curves against dense sampling and scipy, and against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import BSpline

from heavylift.contours.splines.evaluate import SCRATCH
from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
from heavylift.contours.splines.sample_packing import pack_samples
from heavylift.contours.splines.samples import Samples
from heavylift.contours.splines.search import closest_on_curve, closest_on_surface, signed_gap
from heavylift.contours.splines.search_cold import closest_point_cold
from heavylift.contours.splines.search_step import (
    ABOVE_U,
    ABOVE_V,
    BELOW_U,
    BELOW_V,
    BORDER,
    CONVERGED,
    DEGENERATE,
    NEED_SPAN,
    NOT_FINITE,
    TWIN,
    ContourSearch,
    start_search,
)
from heavylift.contours.splines.spaces import clamped_space, closed_space
from heavylift.numerics.arrays import Floats1, Floats2, Ints1
from heavylift.numerics.objects import entry
from heavylift.numerics.records import filled, records


@entry
def windowed(
    contour: PackedContour,
    knots: Floats1,
    weights: Floats1,
    net: Floats2,
    point: Floats1,
    fresh: bool,
    start: Floats1,
    span: Ints1,
    scratch: Floats1,
    result: ContourSearch,
) -> int:
    if fresh:
        start_search(contour, start[0], start[1], result)
    result.span_u, result.span_v = span[0], span[1]
    at = (point[0], point[1], point[2])
    if contour.v.degree == 0:
        return closest_on_curve(contour, knots, weights, net, at, scratch, result)
    return closest_on_surface(contour, knots, weights, net, at, scratch, result)


@entry
def cold(
    contour: PackedContour,
    knots: Floats1,
    weights: Floats1,
    net: Floats2,
    point: Floats1,
    samples: Samples,
    scratch: Floats1,
    result: ContourSearch,
) -> int:
    x, y, z = point[0], point[1], point[2]
    return closest_point_cold(
        contour, knots, weights, net, (x, y, z), samples, samples.grids[0], scratch, result
    )


@entry
def gap(point: Floats1, result: ContourSearch, out: Floats1) -> None:
    out[0], out[1], out[2], out[3] = signed_gap(point[0], point[1], point[2], result)


class Patch:
    """A contour as arrays, its searches, and its evaluation by scipy."""

    def __init__(self, spaces, control, weights=None):
        self.spaces = spaces
        self.control = np.ascontiguousarray(control, dtype=float)
        self.net = self.control.reshape(-1, 3).copy()
        u = spaces[0]
        self.knots = np.concatenate([space.knots for space in spaces])
        along, across = (
            filled(PackedDirection, degree=s.degree, count=s.count, closed=s.closed, first_knot=first)
            for s, first in zip(spaces, (0, u.knots.size), strict=True)
        )
        self.weights = np.zeros(0) if weights is None else np.ascontiguousarray(weights, dtype=float).ravel()
        first_weight = -1 if weights is None else 0
        packed = filled(PackedContour, u=along, v=across, first_control=0, first_weight=first_weight)
        table = records(PackedContour, [packed])
        self.contour = table[0]
        self.scratch = np.zeros(SCRATCH)
        self.result = ContourSearch.one()
        self.samples = pack_samples([spaces], table, self.weights, self.net, [False])

    @property
    def arrays(self):
        return self.contour, self.knots, self.weights, self.net

    def warm(self, point, u, v):
        start, everything = np.array([u, v]), np.array([-1, -1])
        args = np.asarray(point, float), True, start, everything
        return windowed(*self.arrays, *args, self.scratch, self.result)

    def cold(self, point, separation=0.0):
        self.result.separation = separation
        return cold(*self.arrays, np.asarray(point, float), self.samples, self.scratch, self.result)

    def __call__(self, u, v):
        """Points of all pairs, by scipy."""
        wide = [
            BSpline.design_matrix(np.clip(at, 0.0, 1.0), space.knots, space.degree).toarray()
            for at, space in zip((np.atleast_1d(u), np.atleast_1d(v)), self.spaces, strict=True)
        ]
        control = self.control
        for axis, space in enumerate(self.spaces):
            control = np.take(control, np.arange(space.functions) % space.count, axis=axis)
        return np.einsum("ai,bj,ijk->abk", wide[0], wide[1], control)

    def nearest(self, point):
        """Distance and parameters by 160 x 100 samples, and ever finer ones about the best of them."""
        u, v = np.linspace(0, 1, 160), np.linspace(0, 1, 100)
        for level in range(8):
            d = np.linalg.norm(self(u, v) - point, axis=2)
            i, j = np.unravel_index(np.argmin(d), d.shape)
            half = 0.02 / 5.0**level
            u, v = (np.clip(at + half * np.linspace(-1, 1, 21), 0.0, 1.0) for at in (u[i], v[j]))
        return d[i, j], np.array([u[10], v[10]])


def wavy(seed):
    """An open surface with bumps, 11 x 8 control points, uneven knots."""
    generator = np.random.default_rng(seed)
    su = clamped_space(3, np.sort(np.linspace(0, 1, 9)[1:-1] + 0.02 * generator.standard_normal(7)))
    sv = clamped_space(4, np.array([0.3, 0.5, 0.8]))
    x, y = np.meshgrid(np.linspace(0, 2, su.count), np.linspace(0, 1, sv.count), indexing="ij")
    z = 0.12 * generator.standard_normal(x.shape)
    return Patch((su, sv), np.stack([x, y, z], -1))


def cylinder(seed):
    """Closed in u, outward normal, radius about 1, axis z."""
    generator = np.random.default_rng(seed)
    su = closed_space(3, np.arange(12) / 12)
    sv = clamped_space(3, np.array([0.25, 0.5, 0.75]))
    angle, z = np.meshgrid(2 * np.pi * np.arange(12) / 12, np.linspace(0, 3, sv.count), indexing="ij")
    radius = 1.0 + 0.05 * generator.standard_normal(angle.shape)
    return Patch((su, sv), np.stack([radius * np.cos(angle), radius * np.sin(angle), z], -1))


def torus():
    """Closed in both directions: radii 2 and 0.6."""
    su, sv = closed_space(3, np.arange(16) / 16), closed_space(3, np.arange(10) / 10)
    a, b = np.meshgrid(2 * np.pi * np.arange(16) / 16, 2 * np.pi * np.arange(10) / 10, indexing="ij")
    r = 2.0 + 0.6 * np.cos(b)
    return Patch((su, sv), np.stack([r * np.cos(a), r * np.sin(a), 0.6 * np.sin(b)], -1))


@pytest.mark.slow
@pytest.mark.parametrize("make", [lambda: wavy(1), lambda: wavy(2), lambda: cylinder(3), torus])
def test_cold_search_finds_the_global_minimum(make):
    patch = make()
    generator = np.random.default_rng(7)
    low, high = patch.net.min(axis=0) - 0.4, patch.net.max(axis=0) + 0.4
    for point in generator.uniform(low, high, (20, 3)):
        distance, at = patch.nearest(point)
        assert patch.cold(point) == CONVERGED
        found = math.sqrt(patch.result.squared_distance)
        # the finest samples are 1e-8 apart; ours may only be nearer
        assert found == pytest.approx(distance, abs=1e-7)
        assert found <= distance + 1e-12
        here = patch(patch.result.u, patch.result.v)[0, 0]
        assert np.linalg.norm(here - point) == pytest.approx(found, abs=1e-12)
        assert patch.result.position == pytest.approx(here, abs=1e-12)
        w, tangents = here - point, np.stack([patch.result.tangent_u, patch.result.tangent_v])
        slope = tangents @ w
        flags = patch.result.flags
        held = np.array([flags & (BELOW_U | ABOVE_U), flags & (BELOW_V | ABOVE_V)]) != 0
        assert np.all(np.abs(slope[~held]) < 1e-11 * np.sum(tangents**2, axis=1)[~held])
        inward = np.where([flags & BELOW_U, flags & BELOW_V], 1.0, -1.0)
        assert np.all((slope * inward)[held] > 0.0)
        if np.linalg.norm(patch.result.position[:2] - at) < 1e-3:
            assert [patch.result.u, patch.result.v] == pytest.approx(at, abs=1e-6)


def test_points_over_borders_and_corners_are_held_there():
    patch = wavy(4)
    for u, v, outwards, flags in [
        (0.0, 0.6, (-1, 0), BELOW_U),
        (1.0, 0.3, (1, 0), ABOVE_U),
        (0.4, 0.0, (0, -1), BELOW_V),
        (0.7, 1.0, (0, 1), ABOVE_V),
        (1.0, 1.0, (1, 1), ABOVE_U | ABOVE_V),
        (0.0, 1.0, (-1, 1), BELOW_U | ABOVE_V),
    ]:
        corner = abs(outwards[0]) + abs(outwards[1]) == 2
        edge = patch(u, v)[0, 0]
        a, b = (
            (patch(u + 1e-6, v) - patch(u - 1e-6, v))[0, 0],
            (patch(u, v + 1e-6) - patch(u, v - 1e-6))[0, 0],
        )
        if corner:
            away = np.array([*outwards, 0.0])
        else:  # perpendicular to the border, in the tangent plane
            along, over = (b, a) if outwards[0] else (a, b)
            away = over - along * (along @ over) / (along @ along)
            away *= (outwards[0] or outwards[1]) / np.linalg.norm(away)
        assert patch.cold(edge + 0.1 * away) == CONVERGED
        assert patch.result.flags & BORDER == flags
        assert [patch.result.u, patch.result.v] == pytest.approx([u, v], abs=2e-2 if not corner else 1e-15)


def test_a_warm_start_far_away_still_ends_at_a_minimum():
    patch = torus()
    generator = np.random.default_rng(5)
    for point in generator.uniform(-2.5, 2.5, (60, 3)):
        u, v = generator.random(2)
        assert patch.warm(point, u, v) == CONVERGED
        w = patch.result.position - point
        assert np.abs(np.stack([patch.result.tangent_u, patch.result.tangent_v]) @ w).max() < 1e-9
        around = patch(
            np.mod(patch.result.u + np.array([-1e-3, 0, 1e-3]), 1.0),
            np.mod(patch.result.v + np.array([-1e-3, 0, 1e-3]), 1.0),
        )
        assert np.min(np.linalg.norm(around - point, axis=2)) >= np.linalg.norm(w) - 1e-12


def test_a_window_of_control_points_gives_the_same_result():
    generator = np.random.default_rng(8)
    for patch, start in [(cylinder(3), (0.97, 0.5)), (wavy(1), (0.2, 0.2)), (curve(), (0.1, 0.0))]:
        for _ in range(10):
            point = patch.net.mean(axis=0) + generator.uniform(-1.5, 1.5, 3)
            whole = ContourSearch.one()
            free = np.array([-1, -1])
            args = (np.array(start), free, patch.scratch, whole)
            assert windowed(*patch.arrays, point, True, *args) == CONVERGED
            net = np.full_like(patch.net, np.nan)
            part = ContourSearch.one()
            spans = np.array([0, 0])
            calls = 0
            fresh = True
            while True:
                status = windowed(
                    *patch.arrays[:3], net, point, fresh, np.array(start), spans, patch.scratch, part
                )
                fresh = False
                if status != NEED_SPAN:
                    break
                calls += 1
                spans = np.array([part.span_u, part.span_v])
                net[:] = np.nan  # only the control points asked for are there
                rows = []
                for space, span in zip(patch.spaces, spans, strict=True):
                    rows.append(np.arange(span - space.degree, span + 1) % space.count)
                wanted = (rows[0][:, None] * patch.spaces[1].count + rows[1]).ravel()
                net[wanted] = patch.net[wanted]
            assert status == CONVERGED
            assert calls >= 1
            np.testing.assert_array_equal(part.position, whole.position)
            for name in ("u", "v", "squared_distance", "flags", "iterations"):
                assert part[name] == whole[name]


class Line:
    """The parameter across of a curve: one constant function."""

    degree, count, closed, functions = 0, 1, False, 1
    knots = np.array([0.0, 1.0])

    def samples(self, per_piece):
        return np.zeros(min(per_piece, 1))


def curve(closed=False):
    """A wound curve."""
    space = closed_space(3, np.arange(9) / 9) if closed else clamped_space(3, np.arange(1, 9) / 9)
    t = np.linspace(0, 2 * np.pi, space.count, endpoint=not closed)
    control = np.stack([np.cos(t), 1.5 * np.sin(t), 0.3 * np.sin(2 * t)], -1)
    return Patch((space, Line()), control[:, None, :])


@pytest.mark.parametrize("closed", [False, True])
def test_closest_point_of_a_curve(closed):
    patch = curve(closed)
    generator = np.random.default_rng(9)
    for point in generator.uniform(-2, 2, (40, 3)):
        distance, _ = patch.nearest(point)
        assert patch.cold(point) == CONVERGED
        assert math.sqrt(patch.result.squared_distance) == pytest.approx(distance, abs=3e-7)
        if patch.result.flags & BORDER == 0:
            assert abs(patch.result.tangent_u @ (patch.result.position - point)) < 1e-11 * np.sum(
                patch.result.tangent_u**2
            )


def quarter_sphere():
    """Rational: an eighth of the unit sphere turned about z, exact (The NURBS Book, section 8.5)."""
    space = clamped_space(2, np.zeros(0))
    h = math.sqrt(0.5)
    arc = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    control = np.array([[(*(a * b[0]), b[1]) for b in arc] for a in arc])
    weight = np.array([1.0, h, 1.0])
    return Patch((space, space), control, np.outer(weight, weight))


def test_a_rational_sphere_against_its_closed_form():
    patch = quarter_sphere()
    generator = np.random.default_rng(2)
    out = np.zeros(4)
    for _ in range(30):
        direction = np.abs(generator.standard_normal(3)) + 0.05
        direction /= np.linalg.norm(direction)
        radius = generator.uniform(0.5, 2.0)
        assert patch.cold(radius * direction) == CONVERGED
        assert patch.result.position == pytest.approx(direction, abs=1e-11)
        gap(radius * direction, patch.result, out)
        assert out == pytest.approx([radius - 1.0, *direction], abs=1e-11)


def test_the_centre_of_a_sphere_has_no_definite_closest_point_and_says_so():
    patch = quarter_sphere()
    assert patch.cold(np.zeros(3)) == CONVERGED
    assert patch.result.flags & DEGENERATE
    assert patch.result.squared_distance == pytest.approx(1.0, abs=1e-12)
    assert patch.warm(1e-9 * np.ones(3), 0.4, 0.4) == CONVERGED  # and close to the centre it ends


def test_two_places_at_equal_distance_are_reported():
    # a channel, symmetric about x = 0, and a point above its middle
    su, sv = clamped_space(3, np.arange(1, 8) / 8), clamped_space(3, np.array([0.5]))
    x, y = np.meshgrid(np.linspace(-1, 1, su.count), np.linspace(0, 1, sv.count), indexing="ij")
    patch = Patch((su, sv), np.stack([x, y, 2.0 * x**2], -1))
    point = np.array([0.0, 0.5, 1.2])
    assert patch.cold(point, separation=1e-3) == CONVERGED
    flags = patch.result.flags
    assert flags & TWIN
    assert patch.result.u + patch.result.other_u == pytest.approx(1.0, abs=1e-9)
    assert patch.result.other_distance == pytest.approx(math.sqrt(patch.result.squared_distance), abs=1e-12)
    assert patch.cold([0.1, 0.5, 1.2], separation=1e-3) == CONVERGED
    assert not patch.result.flags & TWIN
    assert patch.result.u > 0.5


def test_the_gap_is_positive_outside():
    patch = cylinder(3)
    out = np.zeros(4)
    for factor, sign in ((1.2, 1.0), (0.8, -1.0)):
        point = factor * np.array([0.6, 0.8, 0.0]) + np.array([0.0, 0.0, 1.5])
        assert patch.cold(point) == CONVERGED
        gap(point, patch.result, out)
        assert out[0] * sign == pytest.approx(math.sqrt(patch.result.squared_distance), rel=1e-12)
        assert out[1:] @ point > 0.0


def test_a_point_that_is_not_finite_is_reported():
    patch = torus()
    assert patch.warm([math.nan, 0.0, 0.0], 0.1, 0.1) == NOT_FINITE
    assert patch.cold([math.nan, 0.0, 0.0]) == NOT_FINITE
