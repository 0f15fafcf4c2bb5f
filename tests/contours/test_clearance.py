"""Smallest distances of surfaces against all pairs of triangles, and against closed forms of spheres and boxes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
from collision_scenes import query
from scipy.spatial.transform import Rotation

from heavylift.contours.triangles.clearance import (
    WaitingNodes,
    clearance_stack_size,
    measure_clearance,
)
from heavylift.contours.triangles.surface_layout import RelativePose, pose_of
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.numerics.records import record_at, records
from heavylift.preprocess.surfaces.primitives import (
    box_surface,
    capsule_surface,
    cylinder_surface,
    plane_surface,
    sphere_surface,
)
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

STILL = np.eye(3)
SIDES = ((0, 1), (1, 2), (2, 0))


class Clearance(NamedTuple):
    distance: float
    point_a: np.ndarray
    point_b: np.ndarray


def find_clearance(surfaces, a, b, R, p, upper=math.inf):
    """Smallest distance of two surfaces, ``x_A = R x_B + p``, and the nearest points in the axes of A."""
    out = np.zeros(6)
    stack = records(WaitingNodes, clearance_stack_size(surfaces))
    distance = measure_clearance(surfaces, a, b, pose_of(R, p), upper, stack, out)
    return Clearance(distance, out[:3].copy(), out[3:].copy())


def to_segments(x, a, b):
    """Distances of points from segments; all of shape (n, 3)."""
    d = b - a
    squared = (d * d).sum(1)
    s = np.clip(((x - a) * d).sum(1) / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
    return np.linalg.norm(x - a - s[:, None] * d, axis=1)


def solve(matrix, right):
    """Solutions of many small systems; NaN for those that have none or many."""
    size = np.linalg.norm(matrix, axis=(1, 2)) ** matrix.shape[1]
    regular = np.abs(np.linalg.det(matrix)) > 1e-12 * size
    out = np.full(right.shape, np.nan)
    out[regular] = np.linalg.solve(matrix[regular], right[regular][:, :, None])[:, :, 0]
    return out


def to_triangle_inside(x, t):
    """Distances of points from the inside of triangles; infinite if the foot lies elsewhere."""
    e = t[:, 1:] - t[:, :1]  # (n, 2, 3)
    w = solve(e @ e.transpose(0, 2, 1), ((x - t[:, 0])[:, None] * e).sum(2))
    inside = (w >= 0.0).all(1) & (w.sum(1) <= 1.0)
    foot = t[:, 0] + (np.nan_to_num(w)[:, :, None] * e).sum(1)
    return np.where(inside, np.linalg.norm(x - foot, axis=1), np.inf)


def between_edges(a, b, c, d):
    """Distances of segments where the foot lies inside of both; infinite elsewhere."""
    e = np.stack([b - a, c - d], axis=1)
    w = solve(e @ e.transpose(0, 2, 1), ((c - a)[:, None] * e).sum(2))
    inside = ((w >= 0.0) & (w <= 1.0)).all(1)
    way = a + w[:, :1] * (b - a) - c - w[:, 1:] * (d - c)
    return np.where(inside, np.linalg.norm(np.nan_to_num(way), axis=1), np.inf)


def crosses(a, b, t):
    """Whether segments go through triangles."""
    w = solve(np.stack([b - a, t[:, 0] - t[:, 1], t[:, 0] - t[:, 2]], axis=2), t[:, 0] - a)
    return (w >= 0.0).all(1) & (w[:, 0] <= 1.0) & (w[:, 1] + w[:, 2] <= 1.0)


def all_pairs(s, t):
    """Distances of triangles, shape (n, 3, 3) both."""
    best = np.full(len(s), np.inf)
    for one, other in ((s, t), (t, s)):
        for k in range(3):
            best = np.fmin(best, to_triangle_inside(one[:, k], other))
            for i, j in SIDES:
                best = np.fmin(best, to_segments(one[:, k], other[:, i], other[:, j]))
        for i, j in SIDES:
            best[crosses(one[:, i], one[:, j], other)] = 0.0
    for i, j in SIDES:
        for k, m in SIDES:
            best = np.fmin(best, between_edges(s[:, i], s[:, j], t[:, k], t[:, m]))
    return best


def smallest(a, b, R, p):
    """Smallest distance of two surfaces, by all pairs of their triangles."""
    s = a.points[a.triangles]
    t = b.points[b.triangles] @ R.T + p
    rows, columns = np.indices((len(s), len(t))).reshape(2, -1)
    least = np.inf
    for some in np.array_split(np.arange(len(rows)), 1 + len(rows) // 20_000):
        least = min(least, all_pairs(s[rows[some]], t[columns[some]]).min())
    return least - a.radius - b.radius


def soup(count, rng, radius=0.0):
    """Triangles that are joined nowhere, every fifth a sliver; if they are rounded, also segments and points."""
    corners = rng.normal(size=(count, 1, 3)) + 0.25 * rng.normal(size=(count, 3, 3))
    thin = corners[1::5]
    thin[:, 2] = 0.3 * thin[:, 0] + 0.7 * thin[:, 1] + 1e-14 * thin[:, 2]
    triangles = np.arange(3 * count).reshape(-1, 3)
    if radius > 0.0:
        triangles[::6, 2] = triangles[::6, 1]
        triangles[3::6, 1:] = triangles[3::6, :1]
    return TriangleSurface(corners.reshape(-1, 3), triangles, radius)


def check(a, b, R, p, expected, tolerance=1e-12):
    """Value and nearest points, whichever comes first and whatever is known before."""
    for turned, surfaces in ((False, pack_surfaces([a, b])), (True, pack_surfaces([b, a]))):
        pose = (R.T, -R.T @ p) if turned else (R, p)
        found = find_clearance(surfaces, 0, 1, *pose)
        assert found.distance == pytest.approx(expected, abs=tolerance)
        apart = found.point_b - found.point_a
        if expected > -a.radius - b.radius:  # points of surfaces that cross have no direction
            assert np.linalg.norm(apart) == pytest.approx(abs(expected), abs=tolerance)
        for upper in (expected, expected + 0.1, expected - 0.1, -1e3):
            again = find_clearance(surfaces, 0, 1, *pose, upper)
            assert again.distance == pytest.approx(expected, abs=tolerance)
    return found


@pytest.mark.parametrize("distance", [0.0, 2.0, 5.0, 1e3])
@pytest.mark.parametrize("radii", [(0.0, 0.0), (0.1, 0.25)])
def test_soups_are_as_near_as_their_nearest_triangles(distance, radii):
    rng = np.random.default_rng(int(distance))
    crossing = 0
    for count in (1, 4, 25, 40, 61):
        a, b = soup(count, rng, radii[0]), soup(max(1, count - 7), rng, radii[1])
        R = Rotation.random(random_state=rng).as_matrix()
        p = distance * rng.normal(size=3)
        expected = smallest(a, b, R, p)
        crossing += expected <= -sum(radii)
        check(a, b, R, p, expected, 1e-14 * (10.0 + distance))
    assert crossing > 0 if distance == 0.0 else crossing <= 1


def test_bunnies_are_as_near_as_their_nearest_triangles():
    a, b, motion = query("bunny_bunny")
    R, p = motion[:9].reshape(3, 3), motion[9:12]
    expected = smallest(a, b, R, p)
    assert expected > 0.0
    check(a, b, R, p, expected, 1e-15)


@pytest.mark.parametrize("distance", [3.0, 1.0, 1e5])
def test_spheres(distance):
    p = distance * np.array([2.0, -3.0, 6.0]) / 7.0
    found = check(sphere_surface(0.5), sphere_surface(0.75), STILL, p, distance - 1.25, 1e-15 * distance)
    if distance > 1.25:  # in the axes of the second, whose position is -p
        assert found.point_a == pytest.approx(-0.75 * p / distance, abs=1e-15)
        assert found.point_b == pytest.approx(-p + 0.5 * p / distance, abs=1e-15 * distance)


def test_capsules_side_by_side_crossed_and_end_to_end():
    a, b = capsule_surface(0.2, 4.0), capsule_surface(0.3, 2.0)
    check(a, b, STILL, np.array([0.6, 0.8, 0.5]), 0.5)
    check(a, b, Rotation.from_rotvec([math.pi / 3, 0, 0]).as_matrix(), np.array([1.5, 0.0, 0.3]), 1.0)
    check(a, b, STILL, np.array([0.3, 0.4, 4.2]), math.hypot(0.5, 1.2) - 0.5)


@pytest.mark.parametrize("radius", [0.0, 0.2])
@pytest.mark.parametrize("gap", [(1.0, 0.0, 0.0), (0.0, -0.3, 0.4), (0.2, 0.3, -0.6), (1e-6, 0.0, 0.0)])
def test_boxes_at_faces_edges_and_corners(gap, radius):
    sizes = np.array([[2.0, 3.0, 4.0], [1.0, 5.0, 0.5]])
    p = np.array(gap) + np.sign(gap) * 0.5 * sizes.sum(axis=0)
    # between the boxes that are rounded, and from there outwards
    inner = np.where(np.array(gap) != 0.0, np.abs(gap) + 2.0 * radius, 0.0)
    expected = np.linalg.norm(inner) - 2.0 * radius
    check(box_surface(sizes[0], radius), box_surface(sizes[1], radius), STILL, p, expected, 1e-14)


def test_a_box_that_stands_on_a_corner_over_a_plate():
    tip = Rotation.align_vectors([[0.0, 0.0, 1.0]], [[1.0, 1.0, 1.0]])[0].as_matrix()
    found = check(
        plane_surface(8.0), box_surface(2.0), tip, np.array([0.3, 0.2, 2.0]), 2.0 - math.sqrt(3.0), 1e-14
    )
    assert found.distance > 0.0
    check(plane_surface(8.0), box_surface(2.0), tip, np.array([0.3, 0.2, 1.0]), 0.0)


def test_a_box_within_a_box_and_one_through_its_wall():
    room, thing = box_surface([4.0, 6.0, 8.0]), box_surface(1.0)
    for p, expected in (([0.2, 0.1, 0.3], 1.3), ([0.0, -2.4, 0.0], 0.1), ([1.6, 0.0, 0.0], 0.0)):
        check(room, thing, STILL, np.array(p), expected, 1e-14)


def test_a_sphere_over_a_plate_and_beside_it_and_a_capsule_through_it():
    u = np.linspace(-2.0, 2.0, 21)
    points = np.stack([*np.meshgrid(u, u, indexing="ij"), np.zeros((21, 21))], axis=2).reshape(-1, 3)
    first = np.arange(420)
    first = first[first % 21 != 20]
    triangles = first[:, np.newaxis, np.newaxis] + [[0, 21, 22], [0, 22, 1]]
    plate, ball = TriangleSurface(points, triangles.reshape(-1, 3)), sphere_surface(0.5)
    check(plate, ball, STILL, np.array([0.123, 0.456, 0.8]), 0.3)
    check(plate, ball, STILL, np.array([2.3, -0.4, 0.4]), 0.0)
    check(plate, ball, STILL, np.array([2.2, 2.3, 0.6]), 0.2)
    check(plate, ball, STILL, np.array([0.123, 0.456, 0.0]), -0.5)
    check(plate, capsule_surface(0.1, 1.0), STILL, np.array([0.123, 0.456, 0.2]), -0.1)


def test_a_prism_within_a_prism():
    outer, inner = cylinder_surface(1.0, 6.0, sides=256), cylinder_surface(0.5, 2.0, sides=256)
    # sides face each other: the distance of their middles
    check(outer, inner, STILL, np.zeros(3), 0.5 * math.cos(math.pi / 256), 1e-14)


def test_places_in_longer_arrays_and_surfaces_of_a_scene():
    scene = pack_surfaces([box_surface(1.0), sphere_surface(0.25), box_surface(2.0), sphere_surface(0.5)])
    stack, out = records(WaitingNodes, clearance_stack_size(scene)), np.zeros(6)
    poses = np.concatenate([np.full(7, np.nan), np.eye(3).ravel(), [0.0, 0.0, 3.0], np.full(3, np.nan)])
    pose = record_at(RelativePose)(poses, 7)
    measured = {
        pair: measure_clearance(scene, *pair, pose, math.inf, stack, out)
        for pair in ((0, 1), (1, 2), (2, 0), (3, 1), (0, 3))
    }
    expected = {(0, 1): 2.25, (1, 2): 1.75, (2, 0): 1.5, (3, 1): 2.25, (0, 3): 2.0}
    assert measured == pytest.approx(expected, abs=1e-14)
    assert out == pytest.approx([0, 0, 0.5, 0, 0, 2.5])


@pytest.mark.slow
def test_a_pose_that_is_not_finite_has_no_clearance():
    a, b, motion = query("tank_hull")
    surfaces = pack_surfaces([a, b])
    for place in range(12):
        for value in (math.nan, math.inf):
            pose = motion[:12].copy()
            pose[place] = value
            found = find_clearance(surfaces, 0, 1, pose[:9].reshape(3, 3), pose[9:])
            assert math.isnan(found.distance)
            assert np.isnan(found.point_a).all()
    good = find_clearance(surfaces, 0, 1, motion[:9].reshape(3, 3), motion[9:12])
    unknown = find_clearance(surfaces, 0, 1, motion[:9].reshape(3, 3), motion[9:12], math.nan)
    assert unknown.distance == good.distance > 0.0
