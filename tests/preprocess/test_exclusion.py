"""Exclusion boxes: which triangles go, against clipping of the triangles by the faces of the box."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.exclusion import ExclusionBox, exclude
from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


def rotation(rng):
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


def clipped(corners, box):
    """Part of a triangle in a box, as a polygon (Sutherland and Hodgman, 1974)."""
    polygon = [(np.array(p) - box.centre) @ box.axes for p in corners]
    for axis in range(3):
        for sign in (-1.0, 1.0):
            level, cut = 0.5 * box.size[axis], []
            for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                u, v = sign * p[axis] - level, sign * q[axis] - level
                if u <= 0.0:
                    cut.append(p)
                if u * v < 0.0:
                    cut.append(p + (q - p) * (u / (u - v)))
            polygon = cut
    return polygon


@pytest.mark.parametrize("seed", range(3))
def test_random_triangles_against_clipping(seed):
    rng = np.random.default_rng(seed)
    n = 800
    corners = rng.normal(size=(n, 1, 3)) + rng.normal(size=(n, 3, 3)) * rng.choice([0.1, 1.0, 5.0], (n, 1, 1))
    surface = TriangleSurface(corners.reshape(-1, 3), np.arange(3 * n).reshape(-1, 3))
    size, axes = rng.uniform(2.0, 4.0, 3), rotation(rng)
    box = ExclusionBox(rng.normal(size=3) * 0.3, size, axes)
    keep = ExclusionBox(box.centre, size, axes, inside=False)
    parts = [clipped(rows, box) for rows in corners]
    outside = np.array([not part for part in parts])
    # wholly inside: nothing is clipped away
    inside = np.array(
        [
            len(part) == 3 and np.allclose(part, (rows - box.centre) @ box.axes, atol=1e-12)
            for part, rows in zip(parts, corners, strict=True)
        ]
    )
    assert min(inside.sum(), outside.sum(), n - inside.sum() - outside.sum()) > 20
    np.testing.assert_array_equal(exclude(surface, [box])[1], inside)
    np.testing.assert_array_equal(exclude(surface, [keep])[1], outside)


def test_a_plate_that_the_box_cuts_stays_either_way():
    """A box in the middle of a plate touches no corner of it, and is touched all the same."""
    plate = plane_surface(10.0)
    for inside in (True, False):
        kept, excluded = exclude(plate, [ExclusionBox((1.0, 0.5, 0.0), (1.0, 1.0, 1.0), inside=inside)])
        assert not excluded.any()
        assert kept is plate
    with pytest.raises(InputError, match="all 2 triangles are excluded"):
        exclude(plate, [ExclusionBox((0.0, 0.0, 1.0), (1.0, 1.0, 1.9), inside=False)])


def test_what_lies_in_a_face_of_the_box_is_inside():
    """The bottom of a box at z = -8 and an exclusion box that ends there, in spite of rounding."""
    box = box_surface((1.0, 1.0, 0.1))
    lowest = box.points[:, 2].min()
    cut = ExclusionBox((0.0, 0.0, lowest + 0.05), (1.0, 1.0, 0.1 * (1.0 - 1e-12)))
    with pytest.raises(InputError):
        exclude(box, [cut])
    kept, _ = exclude(box, [ExclusionBox((0.0, 0.0, lowest - 0.1), (3.0, 3.0, 0.2), inside=False)])
    assert len(kept.triangles) == 10  # all but the top


def test_several_boxes():
    """Boxes to stay add up; what lies in a box to go goes even from these."""
    cubes = [box_surface(1.0).points + np.array([3.0 * k, 0, 0]) for k in range(4)]
    rows = np.vstack([box_surface(1.0).triangles + 8 * k for k in range(4)])
    row = TriangleSurface(np.vstack(cubes), rows, name="row")
    stay = [ExclusionBox((3.0 * k, 0, 0), (2, 2, 2), inside=False) for k in (0, 1)]
    go = ExclusionBox((3.0, 0, 0), (2, 2, 2))
    kept, excluded = exclude(row, [*stay])
    np.testing.assert_array_equal(np.flatnonzero(excluded), np.arange(24, 48))
    assert (len(kept.points), kept.name) == (16, "row")
    kept, excluded = exclude(row, [*stay, go])
    np.testing.assert_array_equal(np.flatnonzero(excluded), np.arange(12, 48))
    np.testing.assert_allclose(kept.points[kept.triangles], row.points[row.triangles[:12]])
    # two boxes that hold a cube together: it lies in none of them
    halves = [ExclusionBox((x, 0, 0), (0.6, 2, 2)) for x in (-0.25, 0.25)]
    _, excluded = exclude(row, halves)
    assert excluded.sum() == 4  # faces x = -0.5 and x = 0.5


def test_turned_box_and_infinite_sides():
    plate = plane_surface(2.0)
    small = TriangleSurface(plate.points * 0.1 + [1.0, 1.0, 0.0], plate.triangles)
    both = TriangleSurface(
        np.vstack([plate.points * 0.1, small.points]), np.vstack([plate.triangles, small.triangles + 4])
    )
    c = np.sqrt(0.5)
    axes = np.array([[c, -c, 0.0], [c, c, 0.0], [0.0, 0.0, 1.0]])
    _, excluded = exclude(both, [ExclusionBox((1.0, 1.0, 0.0), (0.3, 0.3, 0.3), axes)])
    np.testing.assert_array_equal(excluded, [False, False, True, True])
    half_space = ExclusionBox((2.0, 2.0, 0.0), (3.0, np.inf, np.inf))
    np.testing.assert_array_equal(exclude(both, [half_space])[1], [False, False, True, True])
    stays = ExclusionBox((2.0, 2.0, 0.0), (3.0, np.inf, np.inf), inside=False)
    np.testing.assert_array_equal(exclude(both, [stays])[1], [True, True, False, False])


def test_lone_points_and_segments_go_as_well():
    points = [[0, 0, 0], [5, 0, 0], [5, 1, 0]]
    round_ones = TriangleSurface(points, [[0, 0, 0], [0, 1, 1], [1, 2, 2]], 0.1)
    box = ExclusionBox((5, 0, 0), (1, 3, 1))
    np.testing.assert_array_equal(exclude(round_ones, [box])[1], [False, False, True])
    keep = ExclusionBox((5, 0, 0), (1, 3, 1), inside=False)
    np.testing.assert_array_equal(exclude(round_ones, [keep])[1], [True, False, False])


def test_no_box_changes_nothing():
    box = box_surface(1.0)
    kept, excluded = exclude(box, [])
    assert kept is box
    assert not excluded.any()


def test_a_box_that_takes_everything_is_an_error():
    tank = box_surface((24.0, 28.0, 16.0), name="tank")
    with pytest.raises(InputError, match=r"tank: exclusion boxes: all 12 triangles are excluded, .*-14.0"):
        exclude(tank, [ExclusionBox((0, 0, 0), (100, 100, 100))])


@pytest.mark.parametrize(
    ("values", "spec"),
    [
        ({"size": (1, 0, 1)}, "exclusion box: size: .*three positive lengths"),
        ({"size": (1, np.nan, 1)}, "exclusion box: size"),
        ({"centre": (0, 0)}, r"exclusion box: centre: .*shape \(3,\)"),
        ({"centre": (0, 0, np.inf)}, "exclusion box: centre"),
        ({"axes": 2.0 * np.eye(3)}, "exclusion box: axes: .*orthonormal"),
    ],
)
def test_bad_boxes_are_named(values, spec):
    with pytest.raises(InputError, match=spec):
        ExclusionBox(**{"centre": (0, 0, 0), "size": (1, 1, 1), **values})
