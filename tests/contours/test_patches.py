"""Patches of contacts: independent of order where they are apart, within their limits, spanned by their corners."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from heavylift.contours.triangles.patches import (
    PATCH_ANGLE,
    extreme_points,
    group_patches,
    patch_scratch_size,
)

COSINE = np.cos(PATCH_ANGLE)


def group(points, normals, size, cosine=COSINE):
    n = len(points)
    patch_of = np.full(n, -1, dtype=np.int64)
    count = group_patches(
        n, points, normals, cosine, size, np.zeros(patch_scratch_size(n), dtype=np.int64), patch_of
    )
    return count, patch_of


def extremes(points, normals, patch_of, count, active=None):
    n = len(points)
    chosen = np.zeros((count, 4), dtype=np.int64)
    active = np.zeros(n, dtype=np.int64) if active is None else active
    scratch = np.zeros(patch_scratch_size(n), dtype=np.int64)
    extreme_points(n, points, normals, patch_of, count, active, scratch, chosen)
    return chosen


def up(n):
    return np.tile([0.0, 0.0, 1.0], (n, 1))


def test_separate_heaps_are_patches_in_any_order():
    rng = np.random.default_rng(0)
    centres = np.array(list(itertools.product((-9.0, -3.0, 3.0, 9.0), repeat=3)))
    truth = rng.integers(len(centres), size=2000)
    points = centres[truth] + rng.uniform(-0.5, 0.5, (2000, 3))
    count, patch_of = group(points, up(2000), 2.0)
    assert count == len(np.unique(truth))
    assert len(set(zip(truth, patch_of, strict=True))) == count


def test_members_lie_near_their_first_contact_and_patches_apart():
    rng = np.random.default_rng(1)
    points = rng.uniform(-5.0, 5.0, (800, 3)) * [1.0, 1.0, 0.1]
    normals = up(800) + 0.4 * rng.normal(size=(800, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    size = 1.3
    count, patch_of = group(points, normals, size)
    assert set(patch_of) == set(range(count))
    first = np.array([np.flatnonzero(patch_of == k)[0] for k in range(count)])
    assert (np.diff(first) > 0).all()
    assert np.linalg.norm(points - points[first[patch_of]], axis=1).max() <= size
    assert (normals * normals[first[patch_of]]).sum(axis=1).min() >= COSINE
    for i, j in itertools.combinations(first, 2):
        assert np.linalg.norm(points[i] - points[j]) > size or normals[i] @ normals[j] < COSINE


def test_normals_part_patches_at_the_angle():
    for degrees, expected in ((17.9, 1), (18.1, 2), (90.0, 2), (180.0, 2)):
        a = np.radians(degrees)
        normals = np.array([[0.0, 0.0, 1.0], [np.sin(a), 0.0, np.cos(a)]])
        assert group(np.zeros((2, 3)), normals, 1.0)[0] == expected


def test_corners_of_a_full_rectangle_are_kept():
    rng = np.random.default_rng(2)
    points = np.zeros((300, 3))
    points[:, :2] = rng.uniform(-1.0, 1.0, (300, 2)) * [3.0, 1.0]
    corners = rng.choice(300, 4, replace=False)
    points[corners, :2] = [[3, 1], [-3, 1], [-3, -1], [3, -1]]
    chosen = extremes(points, up(300), np.zeros(300, dtype=np.int64), 1)
    assert set(chosen[0]) == set(corners)


def hull_area(points):
    """Area of the convex hull of four points in the plane: of the largest of their orders."""
    best = 0.0
    for a, b, c, d in itertools.permutations(points[:, :2]):
        x, y = c - a, d - b
        best = max(best, 0.5 * abs(x[0] * y[1] - x[1] * y[0]))
    return best


def test_kept_contacts_span_most_of_what_any_four_can():
    rng = np.random.default_rng(3)
    for _ in range(20):
        points = np.zeros((12, 3))
        points[:, :2] = rng.normal(size=(12, 2)) * [2.0, 1.0]
        chosen = extremes(points, up(12), np.zeros(12, dtype=np.int64), 1)[0]
        best = max(hull_area(points[list(four)]) for four in itertools.combinations(range(12), 4))
        kept = points[chosen[chosen >= 0]]
        assert len(kept) >= 3
        area = hull_area(kept) if len(kept) == 4 else hull_area(np.concatenate([kept, kept[:1]]))
        assert area >= 0.6 * best


def test_a_line_keeps_its_ends_and_a_place_one_contact():
    x = np.random.default_rng(4).uniform(-1.0, 1.0, 50)
    line = 1e3 + np.outer(x, [1.0, 2.0, 0.0])
    chosen = extremes(line, up(50), np.zeros(50, dtype=np.int64), 1)[0]
    assert set(chosen[:2]) == {int(np.argmin(x)), int(np.argmax(x))}
    assert chosen[2:].tolist() == [-1, -1]
    place = np.full((5, 3), 7.0)
    assert extremes(place, up(5), np.zeros(5, dtype=np.int64), 1)[0].tolist()[1:] == [-1, -1, -1]


def test_contacts_that_were_kept_stay_unless_others_are_clearly_further_out():
    square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    for factor, stay in ((1.02, True), (1.2, False)):
        points = np.zeros((8, 3))
        points[:, :2] = np.concatenate([square, factor * square])
        active = np.array([1, 1, 1, 1, 0, 0, 0, 0])
        chosen = extremes(points, up(8), np.zeros(8, dtype=np.int64), 1, active)
        assert set(chosen[0]) == (set(range(4)) if stay else set(range(4, 8)))


@pytest.mark.parametrize("size", [0.3, 3.0])
def test_every_patch_is_spanned_by_its_own_members(size):
    rng = np.random.default_rng(5)
    points = rng.uniform(-5.0, 5.0, (400, 3)) * [1.0, 1.0, 0.0]
    count, patch_of = group(points, up(400), size)
    chosen = extremes(points, up(400), patch_of, count)
    for k in range(count):
        members = chosen[k][chosen[k] >= 0]
        assert len(set(members)) == len(members) >= min(2, np.count_nonzero(patch_of == k))
        assert (patch_of[members] == k).all()
