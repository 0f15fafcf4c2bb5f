"""Gaps of feature pairs: distances known by other means, and rates of change from the normal."""

from __future__ import annotations

import numpy as np
import pytest
from collision_kernels import gap_kernel, packed, poses, surface
from collision_scenes import rotation

from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    EDGE_VERTEX,
    FACE_VERTEX,
    VERTEX_EDGE,
    VERTEX_FACE,
    VERTEX_VERTEX,
    FeatureTouch,
)

KINDS = (VERTEX_FACE, FACE_VERTEX, EDGE_EDGE, VERTEX_EDGE, EDGE_VERTEX, VERTEX_VERTEX)
OVER_EDGE = (np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]), np.array([[0, 1, 2]]))


def one_triangle_each(rng):
    """Two triangles and a pose; rows of the features are then known: vertices 0-2 and 3-5, edges 0-2 and 3-5."""
    a, b = (surface((rng.normal(size=(3, 3)), np.array([[0, 1, 2]]))) for _ in range(2))
    return packed(a, b), rotation(rng.normal(size=3), rng.uniform(0.0, 3.0)), rng.normal(size=3)


def rows(kind):
    """Features of A and B: the first of each."""
    return {
        VERTEX_FACE: (0, 3),
        FACE_VERTEX: (0, 1),
        EDGE_EDGE: (0, 3),
        VERTEX_EDGE: (0, 3),
        EDGE_VERTEX: (0, 3),
        VERTEX_VERTEX: (0, 3),
    }[kind]


def gap_of(surfaces, kind, R, p, side=1.0, radius=0.0):
    out = FeatureTouch.one()
    gap = gap_kernel(surfaces, kind, *rows(kind), radius, side, poses(R, p), 0, out)
    return gap, out


def distance_of_flats(x, U, y, V):
    """Distance of the points, lines or planes ``x + U s`` and ``y + V t``, by least squares."""
    M = np.concatenate([U, -V], axis=1)
    r = y - x
    if M.shape[1]:
        r = r - M @ np.linalg.lstsq(M, r, rcond=None)[0]
    return np.linalg.norm(r)


@pytest.mark.parametrize("kind", KINDS)
def test_gap_is_the_distance_of_the_flats_through_the_features(kind):
    rng = np.random.default_rng(kind)
    for _ in range(50):
        surfaces, R, p = one_triangle_each(rng)
        a, b = rows(kind)
        points = surfaces.points.copy()
        points[3:] = points[3:] @ R.T + p
        corners = {
            VERTEX_FACE: (surfaces.triangles[0].corners, [b]),
            FACE_VERTEX: ([a], surfaces.triangles[1].corners),
            EDGE_EDGE: (surfaces.edges[a].ends, surfaces.edges[b].ends),
            VERTEX_EDGE: (surfaces.edges[a].ends, [b]),
            EDGE_VERTEX: ([a], surfaces.edges[b].ends),
            VERTEX_VERTEX: ([a], [b]),
        }[kind]
        x, y = (points[list(c)] for c in corners)
        expected = distance_of_flats(x[0], (x[1:] - x[0]).T, y[0], (y[1:] - y[0]).T)
        gap, out = gap_of(surfaces, kind, R, p)
        assert abs(gap) == pytest.approx(expected, abs=1e-9)
        assert np.linalg.norm(out.normal) == pytest.approx(1.0, abs=1e-12)
        # the nearest points are that far apart along the normal
        np.testing.assert_allclose(out.point_b - out.point_a, gap * out.normal, atol=1e-9)
        # rounding takes its radius away, the other side turns normal and sign of the separation
        assert gap_of(surfaces, kind, R, p, radius=0.3)[0] == pytest.approx(gap - 0.3, abs=1e-12)
        if kind <= EDGE_EDGE:
            other, turned = gap_of(surfaces, kind, R, p, side=-1.0)
            assert other == -gap
            np.testing.assert_array_equal(turned.normal, -out.normal)


@pytest.mark.parametrize("kind", KINDS)
def test_rate_of_the_gap_is_the_velocity_along_the_normal(kind):
    rng = np.random.default_rng(10 + kind)
    h = 1e-6
    for _ in range(20):
        surfaces, R, p = one_triangle_each(rng)
        w, v = rng.normal(size=3), rng.normal(size=3)
        _, out = gap_of(surfaces, kind, R, p)
        gaps = [
            gap_of(surfaces, kind, rotation(w, s * h * np.linalg.norm(w)) @ R, p + s * h * v)[0]
            for s in (-1, 1)
        ]
        velocity = v + np.cross(w, out.point_b - p)
        assert (gaps[1] - gaps[0]) / (2.0 * h) == pytest.approx(out.normal @ velocity, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((0.5, 0.5, 0.3), -0.5),
        ((0.5, -0.25, 0.3), 0.25),
        ((-0.4, 0.5, -1.0), 0.4),
        ((1.5, 1.5, 0.1), 0.5**0.5),
    ],
)
def test_overshoot_of_a_vertex_beyond_the_borders_of_a_face(place, expected):
    point = surface((np.zeros((1, 3)), np.array([[0, 0, 0]])), radius=0.1)
    surfaces = packed(surface(OVER_EDGE), point)
    out = FeatureTouch.one()
    gap_kernel(surfaces, VERTEX_FACE, 0, 3, 0.0, 1.0, poses(np.eye(3), place), 0, out)
    assert out.beyond == pytest.approx(expected, abs=1e-14)
    # seen from the face it is the same
    gap_kernel(
        packed(point, surface(OVER_EDGE)),
        FACE_VERTEX,
        0,
        1,
        0.0,
        1.0,
        poses(np.eye(3), -np.array(place)),
        0,
        out,
    )
    assert out.beyond == pytest.approx(expected, abs=1e-14)


def test_overshoot_of_edges_is_the_largest_beyond_an_end():
    a = surface((np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.array([[0, 1, 1]])), radius=0.1)
    b = surface((np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 1]])), radius=0.1)
    surfaces = packed(a, b)
    for x, y, expected in ((0.5, 0.0, -0.5), (2.3, 0.0, 0.3), (-0.2, 0.0, 0.2), (1.0, 1.7, 0.7)):
        out = FeatureTouch.one()
        gap = gap_kernel(surfaces, EDGE_EDGE, 0, 1, 0.2, 1.0, poses(np.eye(3), [x, y, 0.5]), 0, out)
        assert gap == pytest.approx(0.3)
        assert out.beyond == pytest.approx(expected, abs=1e-14)


def test_parallel_edges_and_points_in_one_place_stay_finite():
    line = (np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), np.array([[0, 1, 1]]))
    surfaces = packed(surface(line, radius=0.1), surface(line, radius=0.1))
    for p, expected in (([0.1, 0.0, 0.5], 0.5), ([0.0, 0.0, 0.0], 0.0)):
        out = FeatureTouch.one()
        assert gap_kernel(surfaces, EDGE_EDGE, 0, 1, 0.0, 1.0, poses(np.eye(3), p), 0, out) == pytest.approx(
            expected
        )
        assert np.isfinite(out.words).all()
    out = FeatureTouch.one()
    assert gap_kernel(surfaces, VERTEX_VERTEX, 0, 2, 0.2, 1.0, poses(np.eye(3), np.zeros(3)), 0, out) == -0.2
    assert np.linalg.norm(out.normal) == 1.0
