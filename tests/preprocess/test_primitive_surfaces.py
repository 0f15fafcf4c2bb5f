"""Planes, boxes and round shapes: volumes, areas, sizes and outward windings."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.primitives import (
    box_surface,
    capsule_surface,
    cylinder_surface,
    plane_surface,
    sphere_surface,
)
from heavylift.preprocess.surfaces.report import report_surface

AXES = [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (1.0, 2.0, -3.0)]


def volume(surface):
    """By the divergence theorem: positive only if the triangles are wound outward."""
    a, b, c = np.moveaxis(surface.points[surface.triangles], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0


def test_box():
    box = box_surface((1.0, 2.0, 3.0))
    assert volume(box) == pytest.approx(6.0)
    report = report_surface(box)
    assert (report.watertight, report.flipped_edges, report.area) == (True, 0, pytest.approx(22.0))
    assert volume(box_surface(2.0)) == pytest.approx(8.0)


def test_rounded_box_keeps_its_outer_size():
    box = box_surface((1.0, 2.0, 3.0), radius=0.2)
    np.testing.assert_allclose(box.bounds, [[-0.5, -1.0, -1.5], [0.5, 1.0, 1.5]])
    assert volume(box) == pytest.approx(0.6 * 1.6 * 2.6)


@pytest.mark.parametrize("axis", AXES)
def test_plane_looks_along_its_normal(axis):
    plane = plane_surface((4.0, 6.0), axis)
    n = np.array(axis) / np.linalg.norm(axis)
    a, b, c = np.moveaxis(plane.points[plane.triangles], 1, 0)
    np.testing.assert_allclose(np.cross(b - a, c - a) / 24.0, [n, n], atol=1e-14)
    np.testing.assert_allclose(plane.points @ n, 0.0, atol=1e-14)
    np.testing.assert_allclose(plane.points.sum(axis=0), 0.0, atol=1e-14)


def test_first_side_of_a_plane_is_along_x():
    np.testing.assert_allclose(np.ptp(plane_surface((4.0, 6.0)).points, axis=0), [4.0, 6.0, 0.0])


def test_sphere_and_capsule():
    ball = sphere_surface(0.7)
    np.testing.assert_array_equal(ball.bounds, [[-0.7] * 3, [0.7] * 3])
    capsule = capsule_surface(0.2, 3.0, (0.0, 5.0, 0.0))
    np.testing.assert_allclose(capsule.bounds, [[-0.2, -1.7, -0.2], [0.2, 1.7, 0.2]])
    assert not capsule.faces.any()


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("sides", [3, 4, 7, 64])
def test_cylinder_is_a_closed_prism_with_corners_on_the_circle(axis, sides):
    r, length = 1.5, 4.0
    prism = cylinder_surface(r, length, axis, sides=sides)
    n = np.array(axis) / np.linalg.norm(axis)
    along = prism.points @ n
    np.testing.assert_allclose(np.linalg.norm(prism.points - along[:, None] * n, axis=1), r)
    np.testing.assert_allclose(np.abs(along), 0.5 * length)
    # n triangles of two radii and the angle between them
    assert volume(prism) == pytest.approx(0.5 * sides * r**2 * np.sin(2 * np.pi / sides) * length)
    report = report_surface(prism)
    assert (report.points, report.triangles, report.flipped_edges) == (2 * sides, 4 * sides - 4, 0)
    assert report.watertight


def test_sides_of_a_cylinder_lie_inside_by_what_is_said():
    """Middle of a side: radius cos(pi / n)."""
    prism = cylinder_surface(2.0, 1.0)
    middle = 0.5 * (prism.points[0] + prism.points[1])
    assert 2.0 - np.hypot(*middle[:2]) == pytest.approx(2.0 * (1.0 - np.cos(np.pi / 64)))
    assert 1.0 - np.cos(np.pi / 64) == pytest.approx(0.0012, rel=0.01)


def test_rounded_cylinder_keeps_its_outer_size():
    prism = cylinder_surface(1.0, 4.0, rounding=0.25)
    np.testing.assert_allclose(prism.bounds, [[-1.0, -1.0, -2.0], [1.0, 1.0, 2.0]])


@pytest.mark.parametrize(
    ("make", "spec"),
    [
        (lambda: box_surface((1.0, -2.0, 3.0)), "box: size: .*a positive length in m, or 3"),
        (lambda: box_surface((1.0, 2.0)), "box: size"),
        (lambda: box_surface(1.0, 0.5), "box: radius: 0.5; .*below half of the shortest side, 0.5"),
        (lambda: sphere_surface(0.0, name="buoy"), "buoy: radius: 0.0"),
        (lambda: capsule_surface(1.0, np.nan), "capsule: length"),
        (lambda: capsule_surface(1.0, 1.0, (0, 0, 0)), "capsule: axis: .*not all zero"),
        (lambda: plane_surface(1.0, (0, np.inf, 0)), "plane: normal"),
        (lambda: cylinder_surface(1.0, 1.0, sides=2), "cylinder: sides: 2; .*at least 3"),
        (lambda: cylinder_surface(1.0, 1.0, sides=3.0), "cylinder: sides"),
        (lambda: cylinder_surface(1.0, 1.0, rounding=0.5), "cylinder: rounding: 0.5; .*below 0.5"),
    ],
)
def test_bad_sizes_are_named(make, spec):
    with pytest.raises(InputError, match=spec):
        make()
