"""Hulls and what is none: holes, open decks, windings, inside-out parts, edges that meet in a T."""

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
from heavylift.preprocess.surfaces.primitives import (
    box_surface,
    cylinder_surface,
    plane_surface,
    sphere_surface,
)
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

SIZE = (20.0, 6.0, 4.0)
VOLUME = 480.0


def box(points=None, triangles=None):
    whole = box_surface(SIZE, name="barge")
    return TriangleSurface(
        whole.points if points is None else points,
        whole.triangles if triangles is None else triangles,
        name="barge",
    )


def lidless(height=2.0):
    """The box without the two triangles at z = height."""
    whole = box_surface(SIZE)
    lid = (whole.points[whole.triangles][:, :, 2] == height).all(axis=1)
    assert lid.sum() == 2
    return box(triangles=whole.triangles[~lid])


def closed_volume(surface):
    a, b, c = np.moveaxis(surface.points[surface.triangles], 1, 0)
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0


def error_of(surface, **options):
    with pytest.raises(InputError) as caught:
        check_hull(surface, **options)
    return str(caught.value)


def test_closed_hull():
    hull = check_hull(box())
    assert hull.volume == pytest.approx(VOLUME)
    assert hull.is_closed
    assert hull.covered is hull.surface
    assert hull.name == "barge"
    polygon = 0.5 * 64 * np.sin(2.0 * np.pi / 64)
    assert check_hull(cylinder_surface(3.0, 10.0)).volume == pytest.approx(polygon * 9.0 * 10.0)


def test_soup_is_welded():
    """Triangles that share no vertex, as in an STL file."""
    whole = box_surface(SIZE)
    soup = box(whole.points[whole.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    hull = check_hull(soup)
    assert len(hull.surface.points) == 8
    assert hull.volume == pytest.approx(VOLUME)


def test_inside_out():
    message = error_of(box(triangles=box().triangles[:, ::-1]), key="surfaces.outer")
    assert message.startswith("barge: surfaces.outer: is inside-out: its volume is -480 m3")
    assert "anticlockwise seen from outside" in message


def test_one_triangle_wound_the_other_way():
    triangles = box().triangles.copy()
    triangles[3] = triangles[3, ::-1]
    assert "3 edges between triangles that are wound against each other" in error_of(box(triangles=triangles))


def test_hole():
    message = error_of(lidless())
    assert "leaks: 4 open edges" in message
    assert "all in (-10, -3, 2) to (10, 3, 2) m" in message
    assert "'open_deck'" in message
    missing = error_of(box(triangles=np.delete(box().triangles, 5, axis=0)), open_deck=1.0)
    assert "open edges below the open deck, down to z = -2 m" in missing


def test_open_deck():
    hull = check_hull(lidless(), open_deck=2.0)
    assert not hull.is_closed
    assert len(hull.rim) == 4
    assert (hull.rim[:, 2] == 2.0).all()
    assert hull.volume == pytest.approx(VOLUME)
    assert closed_volume(hull.covered) == pytest.approx(VOLUME)
    assert check_hull(hull.covered).is_closed
    assert "down to z = 2 m" in error_of(lidless(), open_deck=2.5)


def test_inside_out_with_an_open_deck():
    surface = lidless()
    assert "inside-out" in error_of(box(triangles=surface.triangles[:, ::-1]), open_deck=2.0)


def test_two_pontoons():
    whole = box_surface(SIZE)
    points = np.vstack([whole.points, whole.points + np.array([0.0, 15.0, 0.0])])
    both = box(points, np.vstack([whole.triangles, whole.triangles + 8]))
    assert check_hull(both).volume == pytest.approx(2.0 * VOLUME)
    one_turned = box(points, np.vstack([whole.triangles, whole.triangles[:, ::-1] + 8]))
    message = error_of(one_turned)
    assert "one of 2 parts, of 12 triangles about (0, 15, 0) m, is inside-out" in message


def test_void_inside_is_refused():
    """An inner skin would let water into the void."""
    whole = box_surface(SIZE)
    points = np.vstack([whole.points, 0.8 * whole.points])
    assert "inner skins" in error_of(box(points, np.vstack([whole.triangles, whole.triangles[:, ::-1] + 8])))


def cut_in_t(offset):
    """The box with one side of an edge divided in three, points off the edge by an offset."""
    whole = box_surface(SIZE)
    a, b = 4, 5  # of the top, both at the lowest y
    middle = [
        whole.points[a] + s * (whole.points[b] - whole.points[a]) + np.array([0, 0, offset])
        for s in (0.3, 0.6)
    ]
    triangles = []
    for row in whole.triangles.tolist():
        sides = [(row[k], row[(k + 1) % 3]) for k in range(3)]
        if (a, b) in sides:
            c = row[(sides.index((a, b)) + 2) % 3]
            triangles += [(a, 8, c), (8, 9, c), (9, b, c)]
        else:
            triangles.append(tuple(row))
    return box(np.vstack([whole.points, middle]), np.array(triangles))


def test_edges_that_meet_in_a_t():
    hull = check_hull(cut_in_t(0.0))
    assert hull.is_closed
    assert hull.volume == pytest.approx(VOLUME)
    assert "leaks: 4 open edges" in error_of(cut_in_t(0.01))


def test_what_is_no_hull():
    assert "rounded" in error_of(sphere_surface(1.0))
    assert "encloses no volume" in error_of(plane_surface(3.0), open_deck=0.0)
    inner = TriangleSurface(
        box().points, np.vstack([box().triangles, [[0, 1, 6]]]), name="barge"
    )  # a plate inside
    assert "leaks: 3 open edges" in error_of(inner)


# ---- parts that overlap, lie in each other, or only touch ----


def boxes(*parts):
    """Closed boxes of some sizes at some places, in one surface."""
    points, triangles = [], []
    for size, at in parts:
        one = box_surface(size)
        triangles.append(one.triangles + sum(map(len, points)))
        points.append(one.points + np.array(at, dtype=float))
    return TriangleSurface(np.vstack(points), np.vstack(triangles), name="barge")


OVERLAPPING = {
    "ends": (((20, 4, 4), (0, 0, 0)), ((20, 4, 4), (10, 0, 0)), 160.0),
    "cross_of_equal_height": (((20, 4, 4), (0, 0, 0)), ((4, 20, 4), (0, 0, 0)), 64.0),
    "corner": (((20, 4, 4), (0, 0, 0)), ((20, 4, 4), (15, 2, 1)), 5 * 2 * 3.0),
    "inside": (((20, 4, 4), (0, 0, 0)), ((10, 2, 2), (1, 0, 0.5)), 40.0),
    "inside_at_the_wall": (((20, 4, 4), (0, 0, 0)), ((10, 4, 2), (5, 0, -1)), 80.0),
    "twice_the_same": (((20, 4, 4), (0, 0, 0)), ((20, 4, 4), (1e-3, 0, 0)), 320.0),
    "layer": (((20, 4, 4), (0, 0, 0)), ((20, 4, 4), (19.9, 0, 0)), 1.6),
}


@pytest.mark.parametrize("name", OVERLAPPING)
@pytest.mark.parametrize("turned", [0.0, 0.3])
def test_space_that_parts_share_is_measured(name, turned):
    """By hand: the box that two boxes share; in boxes along the axes and turned against them."""
    from heavylift.preprocess.surfaces.twice_inside import twice_inside

    *parts, shared = OVERLAPPING[name]
    whole = boxes(*parts)
    c, s = np.cos(turned), np.sin(turned)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array(
        [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    )
    surface = TriangleSurface(whole.points @ R.T, whole.triangles, name="barge")
    assert twice_inside(surface).volume == pytest.approx(shared, rel=0.1, abs=0.3)
    assert "parts overlap or lie in each other" in error_of(surface)


TOUCHING = {
    "ends": [((20, 4, 4), (0, 0, 0)), ((20, 3, 3), (20, 0, 0.5))],
    "compartments": [((10, 4, 4), (0, 4 * j, 0)) for j in (0, 1.5)] + [((10, 10, 4), (10, 3, 0))],
    "catamaran": [((20, 2, 3), (0, 5, 0)), ((20, 2, 3), (0, -5, 0)), ((20, 12, 1), (0, 0, 2))],
    "along_an_edge": [((10, 4, 4), (0, 0, 0)), ((10, 4, 4), (0, 4, 4))],
    "apart": [((10, 4, 4), (0, 0, 0)), ((10, 4, 4), (0, 14, 0))],
    "rounded_numbers": [((20, 4, 4), (0, 0, 0)), ((20, 4, 4), (19.999, 0, 0))],
}


@pytest.mark.parametrize("name", TOUCHING)
def test_parts_that_touch_are_a_hull(name):
    hull = check_hull(boxes(*TOUCHING[name]))
    assert hull.volume == pytest.approx(sum(np.prod(size) for size, _ in TOUCHING[name]), rel=1e-9)


def test_rounds_that_touch_with_other_facets_are_a_hull():
    """A smaller round on the lid of another one, whose facets do not meet."""
    outer = cylinder_surface(10.0, 4.0)
    above = TriangleSurface(outer.points * [0.5, 0.5, 1.0] + [0.1, 0.0, 4.0], outer.triangles)
    whole = TriangleSurface(
        np.vstack([outer.points, above.points]),
        np.vstack([outer.triangles, above.triangles + len(outer.points)]),
        name="barge",
    )
    assert check_hull(whole).volume == pytest.approx(1.25 * closed_volume(outer))


def test_what_is_above_an_open_deck_is_not_counted():
    """A wet hull without its lid, with two houses on the deck that overlap each other: dry, and not in the way."""
    from heavylift.preprocess.surfaces.twice_inside import twice_inside

    houses = boxes(((4, 4, 4), (0, 0, 5)), ((4, 4, 4), (2, 0, 5)))
    assert twice_inside(houses).volume == pytest.approx(32.0, rel=0.1)
    assert twice_inside(houses, below=3.0).volume == pytest.approx(0.0, abs=1e-9)
    assert check_hull(lidless(), open_deck=2.0).volume == pytest.approx(VOLUME)
