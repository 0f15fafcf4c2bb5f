"""Overlap of surfaces that stand still: whether, how deep, and where, against closed forms and brute force."""

from __future__ import annotations

import numpy as np
import pytest
from collision_kernels import box, packed, plate, surface
from collision_scenes import query, rotation

from heavylift.contours.triangles.overlap import find_overlap

ONE = np.eye(3)


def test_tilted_box_in_a_plane_is_as_deep_as_its_lowest_corner():
    surfaces = packed(surface(plate(10.0, 10.0, 1, 1)), surface(box(1.0, 0.8, 0.6)))
    R = rotation((1.0, 0.5, 0.2), 0.6)
    lowest = (box(1.0, 0.8, 0.6)[0] @ R.T)[:, 2].min()
    for depth in (0.2, 1e-3, 1e-6):
        p = np.array([1.0, 2.0, -lowest - depth])
        found = find_overlap(surfaces, 0, 1, R, p)
        assert found.depth == pytest.approx(depth, rel=1e-6)
        assert abs(found.place[2]) < 1e-12
        np.testing.assert_allclose(found.place[:2], p[:2], atol=1.0)
        assert surfaces.triangles[found.triangle_a].surface == 0
        assert surfaces.triangles[found.triangle_b].surface == 1


@pytest.mark.parametrize("height", [1.0, 1.001, 5.0])
def test_bodies_that_touch_or_are_clear_do_not_overlap(height):
    surfaces = packed(surface(box(1.0, 1.0, 1.0)), surface(box(1.0, 1.0, 1.0)))
    found = find_overlap(surfaces, 0, 1, ONE, [0.2, 0.1, height])
    assert (found.triangle_a, found.triangle_b, found.depth) == (-1, -1, 0.0)


def test_crossed_plates_overlap_by_the_part_that_is_through():
    upright = rotation((1.0, 0.0, 0.0), np.pi / 2.0)
    standing = (plate(1.0, 1.0, 1, 1)[0] @ upright.T, plate(1.0, 1.0, 1, 1)[1])
    surfaces = packed(surface(plate(4.0, 4.0, 1, 1)), surface(standing))
    found = find_overlap(surfaces, 0, 1, ONE, [0.3, 0.2, 0.45])
    assert found.depth == pytest.approx(0.05)
    # both crossed and upright: the rims are 0.03 m into each other
    surfaces = packed(surface(standing), surface(standing))
    found = find_overlap(surfaces, 0, 1, rotation((0.0, 0.0, 1.0), 1.0), [0.1, 0.0, 0.97])
    assert found.depth == pytest.approx(0.03)


def test_spheres_overlap_by_their_radii():
    point = (np.zeros((1, 3)), np.array([[0, 0, 0]]))
    surfaces = packed(surface(point, radius=0.5), surface(point, radius=0.25))
    found = find_overlap(surfaces, 0, 1, ONE, [0.3, 0.0, 0.4])
    assert found.depth == pytest.approx(0.25)
    assert find_overlap(surfaces, 0, 1, ONE, [0.6, 0.0, 0.5]).triangle_a == -1
    on_plate = packed(surface(plate(2.0, 2.0, 2, 2)), surface(point, radius=0.25))
    assert find_overlap(on_plate, 0, 1, ONE, [0.3, 0.1, -0.2]).depth == pytest.approx(0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bunny_bunny", "tank_plane", "tank_hull", "far_apart"])
def test_models_are_clear_at_the_start_and_overlap_by_no_more_than_their_way(name):
    a, b, motion = query(name)
    surfaces = packed(a, b)
    start = find_overlap(surfaces, 0, 1, motion[:9].reshape(3, 3), motion[9:12])
    end = find_overlap(surfaces, 0, 1, motion[12:21].reshape(3, 3), motion[21:])
    assert start.triangle_a == -1
    if name == "far_apart":
        assert end.triangle_a == -1
    else:
        points = b.points
        ways = points @ (motion[12:21] - motion[:9]).reshape(3, 3).T + motion[21:] - motion[9:12]
        assert 0.0 < end.depth <= np.linalg.norm(ways, axis=1).max()


def test_random_triangles_overlap_where_signed_volumes_say_so():
    rng = np.random.default_rng(7)

    def volume(a, b, c, d):
        return np.cross(b - a, c - a) @ (d - a)

    def meets(tri, other):
        for k in range(3):
            p, q = other[k], other[(k + 1) % 3]
            sides = [volume(p, q, tri[i], tri[(i + 1) % 3]) > 0.0 for i in range(3)]
            if volume(*tri, p) * volume(*tri, q) < 0.0 and (all(sides) or not any(sides)):
                return True
        return False

    overlaps = 0
    for _ in range(200):
        x, y = rng.normal(size=(2, 3, 3))
        surfaces = packed(*(surface((t, np.array([[0, 1, 2]]))) for t in (x, y)))
        found = find_overlap(surfaces, 0, 1, ONE, np.zeros(3))
        expected = meets(x, y) or meets(y, x)
        assert (found.triangle_a >= 0) == expected
        overlaps += expected
    assert 20 < overlaps < 180
