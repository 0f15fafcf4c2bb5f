"""Welding and cleaning of triangle soups."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.report import unique_edges
from heavylift.preprocess.surfaces.triangle_surface import CleanCounts, TriangleSurface, clean, placed

CASES = Path(__file__).resolve().parents[2] / "cases"
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def models(case):
    spec = importlib.util.spec_from_file_location(f"make_models_{case}", CASES / case / "make_models.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def welded(corners):
    return clean(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


@pytest.mark.parametrize(
    ("name", "triangles", "points", "edges"), [("tank", 19232, 17860, 36863), ("hull", 20764, 16468, 37063)]
)
def test_soup_of_a_ship_becomes_one_surface(name, triangles, points, edges):
    """Numbers found by rounding to micrometres and counting in sets, and those of the published tank."""
    corners = getattr(models("tank_in_hull"), f"make_{name}")()
    assert corners.shape == (triangles, 3, 3)
    places = [[tuple(p) for p in row] for row in np.round(corners, 6).tolist()]
    sides = {frozenset((row[k], row[k - 1])) for row in places for k in range(3)}
    assert (len({p for row in places for p in row}), len(sides)) == (points, edges)

    surface, counts = welded(corners)
    assert surface.points.shape == (points, 3)
    assert len(unique_edges(surface).ends) == edges
    assert counts == CleanCounts(3 * triangles, triangles, 3 * triangles - points, 0, 0, 0)
    np.testing.assert_allclose(surface.points[surface.triangles], corners, rtol=0, atol=1e-12)


def test_stored_models_are_those_of_the_generators():
    """Files of the cases, in single precision."""
    import trimesh
    from scipy.spatial import cKDTree

    tank, bunny = models("tank_in_hull"), models("bunnies")
    points, triangles = bunny.make_bunny()
    for case, name, corners in (
        ("tank_in_hull", "tank", tank.make_tank()),
        ("tank_in_hull", "hull", tank.make_hull()),
        ("bunnies", "bunny", points[triangles]),
    ):
        stored = trimesh.load_mesh(CASES / case / f"{name}.stl", process=False)
        # another version of NumPy may shuffle in another order
        a, b = (cKDTree(np.asarray(c).mean(axis=1)) for c in (stored.triangles, corners))
        assert a.n == b.n
        assert max(a.query(b.data)[0].max(), b.query(a.data)[0].max()) < 2e-6


@pytest.mark.parametrize("shift", [0.0, 0.5, -777.123456789])
def test_points_within_the_tolerance_weld_and_others_do_not(shift):
    """Wherever they lie: no grid decides. Copies within 0.8e-7 of the extent are one, at 3e-7 they are two."""
    rng = np.random.default_rng(5)
    n = 300
    places = shift + rng.integers(0, 1000, (n, 3)) / 1000.0  # on what might be borders of cells
    places[:2] = [[shift], [shift + 1.0]]  # extent 1
    places = np.unique(places, axis=0)
    n = len(places)
    offsets = rng.normal(size=(4, n, 3))
    offsets *= 0.4e-7 / np.linalg.norm(offsets, axis=2, keepdims=True)
    triangles = np.arange(4 * n)
    triangles = np.column_stack([triangles, np.roll(triangles, -1), np.roll(triangles, -7)])
    near, _ = clean((places + offsets).reshape(-1, 3), triangles)
    assert len(near.points) == n
    far, counts = clean(np.vstack([places, places + np.array([3e-7, 0, 0])]), triangles[: 2 * n] % (2 * n))
    assert len(far.points) == 2 * n
    assert counts.welded == 0


def test_what_is_welded_keeps_the_place_of_the_first():
    points = np.vstack([SQUARE, SQUARE[2] + 1e-8, SQUARE[0] - 1e-8])
    surface, counts = clean(points, [[0, 1, 2], [5, 4, 3]])
    np.testing.assert_array_equal(surface.points, SQUARE)
    np.testing.assert_array_equal(surface.triangles, [[0, 1, 2], [0, 2, 3]])
    assert (counts.welded, counts.unused) == (2, 0)


def test_triangles_without_area_and_twice_the_same_go():
    points = np.vstack([SQUARE, [[0.5, 0.0, 0.0], [0.25, 1e-8, 0.0], [9.0, 9.0, 9.0]]])
    triangles = [
        [0, 1, 2],
        [0, 0, 1],  # a repeated point
        [0, 4, 1],  # on a line
        [0, 1, 5],  # a sliver
        [2, 1, 0],  # the first, wound the other way
        [1, 2, 0],  # the first, begun elsewhere
        [0, 2, 3],
    ]
    surface, counts = clean(points, triangles)
    np.testing.assert_array_equal(surface.triangles, [[0, 1, 2], [0, 2, 3]])
    assert counts == CleanCounts(7, 7, 0, 3, 3, 2)


def test_thin_triangle_of_a_stiffener_stays():
    """2 mm by 10 m is thin but has a direction."""
    surface, _ = clean([[0, 0, 0], [10, 0, 0], [0, 2e-3, 0]], [[0, 1, 2]])
    assert len(surface.triangles) == 1


def test_many_triangles_in_one_corner_are_welded_in_no_time():
    """A fan of 50,000 triangles has as many copies of its centre, which must not be compared in pairs."""
    angle = np.linspace(0.0, 2.0 * np.pi, 50_001)
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    corners = np.stack([np.zeros((50_000, 3)), rim[:-1], rim[1:]], axis=1)
    surface, _ = welded(corners)
    assert len(surface.points) == 50_001


def test_turned_and_moved():
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    surface = placed(TriangleSurface(SQUARE, [[0, 1, 2]], 0.1, "plate"), turn, (1.0, 2.0, 3.0))
    np.testing.assert_allclose(surface.points[1], [1.0, 3.0, 3.0])
    assert (surface.radius, surface.name) == (0.1, "plate")


@pytest.mark.parametrize(
    ("points", "triangles", "spec"),
    [
        (SQUARE, np.empty((0, 3), dtype=int), "lid: contains no triangle"),
        (SQUARE, [[0, 1, 4]], "lid: triangle 1: point 4; expected numbers from 0 to 3"),
        (SQUARE, [[0, 1, 2], [0, -1, 2]], "lid: triangle 2: point -1"),
        (np.vstack([SQUARE, [[0, np.nan, 0]]]), [[0, 1, 4]], "lid: point 5: position .*nan"),
        (np.vstack([SQUARE, [[0, np.inf, 0]]]), [[0, 1, 4]], "lid: point 5: position .*inf"),
        (SQUARE[:, :2], [[0, 1, 2]], r"lid: points: array of shape \(4, 2\)"),
        (SQUARE, [[0.0, 1.0, 2.0]], "lid: triangles: array .* of float64"),
        (SQUARE, [[0, 1, 2, 3]], r"lid: triangles: array of shape \(1, 4\)"),
    ],
)
def test_bad_arrays_are_named(points, triangles, spec):
    with pytest.raises(InputError, match=spec):
        TriangleSurface(points, triangles, name="lid")
    with pytest.raises(InputError, match=spec):
        clean(points, triangles, name="lid")


def test_lone_points_need_a_radius():
    with pytest.raises(InputError, match=r"triangle 1: repeats a point: \[0, 1, 1\]"):
        TriangleSurface(SQUARE, [[0, 1, 1]])
    ball = TriangleSurface(SQUARE, [[2, 2, 2]], 0.5)
    np.testing.assert_array_equal(ball.bounds, [[0.5, 0.5, -0.5], [1.5, 1.5, 0.5]])
    assert not ball.faces.any()
    with pytest.raises(InputError, match="radius"):
        TriangleSurface(SQUARE, [[0, 1, 2]], -1.0)


def test_nothing_but_lines_is_an_error():
    with pytest.raises(InputError, match="wire: all 2 triangles are points or lines"):
        clean([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2], [1, 1, 1]], name="wire")
    with pytest.raises(InputError, match="all 1 triangles are points or lines"):
        clean([[1, 1, 1]] * 3, [[0, 1, 2]])
