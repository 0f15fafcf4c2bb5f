"""Surfaces whose points have moved against surfaces that are packed anew."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.contours.triangles.surface_refit import refit_surface
from heavylift.numerics.jit import kernel
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


@kernel
def refit(surfaces, surface):
    return refit_surface(surfaces, surface)


def sheet(count, shift=0.0):
    u, v = np.meshgrid(np.arange(count + 1.0), np.arange(count + 1.0), indexing="ij")
    points = np.stack([u + shift, v, 0.2 * np.sin(u + v)], axis=2).reshape(-1, 3)
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    rows = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3), np.stack([a, c, d], 2).reshape(-1, 3)])
    return TriangleSurface(points, rows)


def rope(count):
    """Segments of a round line."""
    points = np.stack([np.arange(count + 1.0), np.zeros(count + 1), np.zeros(count + 1)], axis=1)
    k = np.arange(count)
    return TriangleSurface(points, np.stack([k, k + 1, k + 1], axis=1), 0.1)


def bent(points):
    x, y, z = points.T
    return np.stack([x + 0.1 * np.sin(y), y - 0.2 * np.cos(x), z + 0.05 * x * x - 0.1 * x * y], axis=1)


def _numbers(rows):
    return rows.view(np.float64).reshape(len(rows), -1)


@pytest.mark.parametrize("surface", [0, 1, 2])
def test_what_follows_from_points_is_what_packing_them_gives(surface):
    scene = [sheet(6), rope(20), sheet(3, shift=2.0)]
    packed = pack_surfaces(scene)
    before = pack_surfaces(scene)
    row = packed.surfaces[surface]
    rows = slice(row.first_point, row.first_point + row.point_count)
    packed.points[rows] = bent(packed.points[rows])
    way = refit(packed, surface)

    old = scene[surface]
    moved = TriangleSurface(bent(old.points), old.triangles, old.radius)
    assert way == pytest.approx(np.linalg.norm(moved.points - old.points, axis=1).max(), rel=1e-14)
    scene[surface] = moved
    expected = pack_surfaces(scene)
    np.testing.assert_allclose(packed.reaches, expected.reaches, rtol=1e-15)
    # the tree keeps the old order of triangles: compare by the numbers that they were given
    own = packed.triangles["surface"] == surface
    mine, theirs = np.argsort(packed.order[own]), np.argsort(expected.order[own])
    for name in ("normals", "triangle_boxes"):
        a, b, c = (_numbers(getattr(which, name)) for which in (packed, expected, before))
        np.testing.assert_allclose(a[own][mine], b[own][theirs], atol=1e-14)
        np.testing.assert_array_equal(a[~own], c[~own])
    inward = {}
    for which in (packed, expected):
        for e, (a, b) in enumerate(which.edges["ends"]):
            for j in range(which.edge_first[e], which.edge_first[e + 1]):
                inward.setdefault((min(a, b), max(a, b), which.edge_opposite[j]), []).append(
                    which.edge_inward[j]
                )
    for two in inward.values():
        np.testing.assert_allclose(*two, atol=1e-14)

    lower = packed.points[packed.triangles["corners"]].min(axis=1)
    upper = packed.points[packed.triangles["corners"]].max(axis=1)
    for node, box in zip(packed.nodes, packed.boxes, strict=True):
        inside = slice(node.first, node.first + node.count)
        np.testing.assert_allclose(box.centre - box.half, lower[inside].min(axis=0), atol=1e-14)
        np.testing.assert_allclose(box.centre + box.half, upper[inside].max(axis=0), atol=1e-14)
    assert packed.surfaces[surface].root == expected.surfaces[surface].root
    assert packed.surfaces[surface].first_edge == expected.surfaces[surface].first_edge


def test_ways_of_all_refits_add_up():
    packed = pack_surfaces([sheet(2), sheet(2)])
    for step in (0.1, -0.3, 0.2):
        packed.points[:9] += [0.0, 0.0, step]
        assert refit(packed, 0) == pytest.approx(abs(step), rel=1e-12)
    np.testing.assert_allclose(packed.travels, [0.6, 0.0], rtol=1e-12)
    assert refit(packed, 0) == 0.0


def test_a_face_that_has_shrunk_to_nothing_keeps_its_normal():
    packed = pack_surfaces([sheet(1)])
    before = packed.normals.copy()
    packed.points[...] = 1.0
    refit(packed, 0)
    np.testing.assert_array_equal(packed.normals, before)
    assert np.isfinite(packed.edge_inward).all()
