"""Closest points against exact rational arithmetic, with slivers, parallel and zero-length segments."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import isqrt

import numpy as np
import pytest

from heavylift.contours.triangles.triangle_distance import point_triangle, segment_segment
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import vector_at


@kernel
def to_triangle(r, out):
    out[0], out[1], out[2] = point_triangle(
        vector_at(r, 0), vector_at(r, 3), vector_at(r, 6), vector_at(r, 9)
    )


@kernel
def between_segments(r, out):
    out[0], out[1], out[2] = segment_segment(
        vector_at(r, 0), vector_at(r, 3), vector_at(r, 6), vector_at(r, 9)
    )


def dot(u, v):
    return sum(a * b for a, b in zip(u, v, strict=True))


def minus(u, v):
    return [a - b for a, b in zip(u, v, strict=True)]


def least_square(origin, directions, inside):
    """Smallest |origin + sum(weights * directions)|^2 over the interior and, by recursion, nothing else.

    None if the system is singular or the solution not inside.
    """
    if not directions:
        return dot(origin, origin)
    gram = [[dot(u, v) for v in directions] for u in directions]
    right = [-dot(u, origin) for u in directions]
    if len(directions) == 1:
        if gram[0][0] == 0:
            return None
        weights = [Fraction(right[0], 1) / gram[0][0]]
    else:
        (a, b), (_, d) = gram
        determinant = a * d - b * b
        if determinant == 0:
            return None
        weights = [(right[0] * d - right[1] * b) / determinant, (right[1] * a - right[0] * b) / determinant]
    if not inside(weights):
        return None
    point = [
        o + sum(w * u[k] for w, u in zip(weights, directions, strict=True)) for k, o in enumerate(origin)
    ]
    return dot(point, point)


def exact_triangle(p, a, b, c):
    def interior(w):
        return w[0] > 0 and w[1] > 0 and sum(w) < 1

    found = [dot(minus(x, p), minus(x, p)) for x in (a, b, c)]
    for x, y in ((a, b), (b, c), (c, a)):
        found.append(least_square(minus(x, p), [minus(y, x)], lambda w: 0 < w[0] < 1))
    found.append(least_square(minus(a, p), [minus(b, a), minus(c, a)], interior))
    return min(x for x in found if x is not None)


def exact_segments(p0, p1, q0, q1):
    d, e = minus(p1, p0), minus(q1, q0)
    found = [dot(minus(x, y), minus(x, y)) for x, y in product((p0, p1), (q0, q1))]
    found += [least_square(minus(p0, x), [d], lambda w: 0 < w[0] < 1) for x in (q0, q1)]
    found += [least_square(minus(q0, x), [e], lambda w: 0 < w[0] < 1) for x in (p0, p1)]
    found.append(least_square(minus(p0, q0), [d, [-x for x in e]], lambda w: 0 < w[0] < 1 and 0 < w[1] < 1))
    return min(x for x in found if x is not None)


def root(square):
    """Square root to 60 digits, as a float."""
    scale = 10**60
    return float(Fraction(isqrt(int(square * scale * scale)), scale))


def families():
    """Rows of four points: general, on a small lattice, slivers, nearly parallel, far away, tiny."""
    random = np.random.default_rng(41)
    yield "general", random.uniform(-1, 1, (60, 4, 3))
    yield "lattice", random.integers(-2, 3, (150, 4, 3)).astype(float)
    for size in (1e-1, 1e-2, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15):
        # all points near one line: slivers, edges parallel to 1e-15
        line = random.uniform(-1, 1, (20, 1, 3))
        points = random.uniform(-1, 1, (20, 4, 1)) * line + size * random.uniform(-1, 1, (20, 4, 3))
        yield f"line {size}", points
        lifted = points.copy()
        lifted[:, 0] += random.uniform(-1, 1, (20, 3))
        yield f"lifted {size}", lifted
        parallel = points.copy()
        parallel[:, 2:] += random.uniform(-1, 1, (20, 1, 3))
        yield f"parallel {size}", parallel
        flat = random.uniform(-1, 1, (20, 4, 3))
        flat[:, :, 2] *= size
        yield f"plane {size}", flat
    yield "far", random.uniform(-1, 1, (20, 4, 3)) + 1e4
    yield "tiny", random.uniform(-1, 1, (20, 4, 3)) * 1e-9
    same = random.uniform(-1, 1, (20, 4, 3))
    same[:, 3] = same[:, 2]
    same[::2, 1] = same[::2, 0]
    yield "degenerate", same


@pytest.mark.parametrize(
    ("run", "exact"), [(to_triangle, exact_triangle), (between_segments, exact_segments)]
)
def test_distance(run, exact):
    for name, rows in families():
        out = np.zeros(3)
        for points in rows:
            run(points.ravel(), out)
            fractions = [[Fraction(x) for x in p] for p in points]
            size = np.abs(points - points[0]).max()
            assert abs(out[0] - root(exact(*fractions))) <= 2e-14 * size, name
            u, v = out[1:]
            if run is to_triangle:
                assert u >= 0, name
                assert v >= 0, name
                assert u + v <= 1 + 1e-15, name
                p, a, b, c = points - points[0]
                gap = p - a - u * (b - a) - v * (c - a)
            else:
                assert 0 <= u <= 1, name
                assert 0 <= v <= 1, name
                p, p1, q, q1 = points - points[0]
                gap = q + v * (q1 - q) - p - u * (p1 - p)
            assert abs(np.linalg.norm(gap) - out[0]) <= 2e-14 * size, name


def test_known_closest_points():
    out = np.zeros(3)
    to_triangle(np.array([0.25, 0.5, 3.0, 0, 0, 0, 1, 0, 0, 0, 1, 0]), out)
    np.testing.assert_allclose(out, [3.0, 0.25, 0.5])
    to_triangle(np.array([0.25, -2.0, 0.0, 0, 0, 0, 1, 0, 0, 0, 1, 0]), out)
    np.testing.assert_allclose(out, [2.0, 0.25, 0.0])
    between_segments(np.array([0.0, 0, 0, 4, 0, 0, 1, -1, 2, 1, 3, 2]), out)
    np.testing.assert_allclose(out, [2.0, 0.25, 0.25])
