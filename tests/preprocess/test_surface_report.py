"""Counts of edges and windings, and the warning about units."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.preprocess.surfaces.primitives import box_surface, plane_surface, sphere_surface
from heavylift.preprocess.surfaces.report import (
    check_against_body,
    check_magnitudes,
    report_surface,
    unique_edges,
)
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface, clean


def with_rows(surface, triangles):
    return TriangleSurface(surface.points, triangles, surface.radius, surface.name)


def test_cube():
    report = report_surface(box_surface(2.0))
    assert (report.points, report.triangles, report.edges) == (8, 12, 18)  # Euler: 8 - 18 + 12 = 2
    assert (report.open_edges, report.junction_edges, report.flipped_edges) == (0, 0, 0)
    assert report.reversed_triangles == 0
    assert report.watertight
    assert report.area == pytest.approx(24.0)
    np.testing.assert_array_equal(report.bounds, [[-1, -1, -1], [1, 1, 1]])


def test_turned_triangles_are_counted_by_edge_and_by_face():
    box = box_surface(1.0)
    rows = box.triangles.copy()
    rows[4] = rows[4, ::-1]
    report = report_surface(with_rows(box, rows))
    assert (report.flipped_edges, report.reversed_triangles, report.watertight) == (3, 1, True)
    rows[:] = rows[:, ::-1]  # all of them: still one against eleven
    assert report_surface(with_rows(box, rows)).reversed_triangles == 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_fewest_to_turn_by_trying_all_choices(seed):
    """Strip of eight triangles with random windings: against all 256 ways to turn them."""
    x = np.arange(10)
    points = np.column_stack([x // 2, x % 2, 0.1 * x]).astype(float)
    rows = np.array([[i, i + 1, i + 2] for i in range(8)])
    rng = np.random.default_rng(seed)
    for k in np.flatnonzero(rng.random(8) < 0.5):
        rows[k] = rows[k, ::-1]
    surface = TriangleSurface(points, rows)
    best = 8
    for choice in range(256):
        turned = (choice >> np.arange(8)) & 1 == 1
        trial = np.where(turned[:, None], rows[:, ::-1], rows)
        if report_surface(with_rows(surface, trial)).flipped_edges == 0:
            best = min(best, int(turned.sum()))
    assert report_surface(surface).reversed_triangles == best


def test_moebius_strip_has_no_side():
    """However its triangles are wound, an edge stays flipped; no number of turned faces is claimed."""
    n = 10
    angle = 2.0 * np.pi * np.arange(n) / n
    r = np.stack([1 + 0.3 * np.cos(angle / 2), 1 - 0.3 * np.cos(angle / 2)], axis=1)
    z = np.stack([0.3 * np.sin(angle / 2), -0.3 * np.sin(angle / 2)], axis=1)
    points = np.stack([r * np.cos(angle)[:, None], r * np.sin(angle)[:, None], z], axis=2).reshape(-1, 3)
    rows = []
    for i in range(n):
        a, b = 2 * i, 2 * i + 1
        c, d = (a + 2, b + 2) if i < n - 1 else (1, 0)  # sides change places after one turn
        rows += [[a, b, c], [b, d, c]]
    report = report_surface(TriangleSurface(points, rows))
    assert report.open_edges == 2 * n
    assert report.flipped_edges >= 1
    assert report.reversed_triangles == 0


def test_open_box_and_an_edge_of_three_plates():
    box = box_surface(1.0)
    lid_off = with_rows(box, box.triangles[[k for k in range(12) if k not in {2, 3}]])
    report = report_surface(lid_off)
    assert (report.open_edges, report.watertight) == (4, False)
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
    report = report_surface(TriangleSurface(points, [[0, 1, 2], [0, 1, 3], [0, 1, 4]]))
    assert (report.edges, report.open_edges, report.junction_edges, report.flipped_edges) == (7, 6, 1, 0)


def test_every_edge_is_there_once():
    edges = unique_edges(box_surface(1.0))
    assert len({tuple(pair) for pair in edges.ends.tolist()}) == len(edges.ends) == 18
    rows = box_surface(1.0).triangles
    for face, sides in zip(rows, edges.of_side, strict=True):
        for k in range(3):
            assert set(edges.ends[sides[k]]) == {face[k], face[(k + 1) % 3]}


def test_round_shapes_have_no_edges():
    report = report_surface(sphere_surface(0.5))
    assert (report.points, report.triangles, report.edges, report.watertight) == (1, 1, 0, False)
    np.testing.assert_array_equal(report.bounds, [[-0.5] * 3, [0.5] * 3])
    assert any("rounded with 0.5 m" in line for line in report.lines())


def test_text_names_what_matters():
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    surface, counts = clean(square[[0, 1, 2, 0, 2, 3, 0, 1, 1]], np.arange(9).reshape(3, 3), name="lid")
    text = str(report_surface(surface, counts))
    assert text.startswith("lid: 2 triangles, 4 points, 5 edges, 1 m2")
    assert "not watertight: 4 open edges" in text
    assert "from 3 triangles on 9 points: 5 points welded, 0 unused, 1 degenerate and 0 duplicate" in text


def scaled(factor, name="mesh"):
    box = box_surface((24.0 * factor, 28.0 * factor, 16.0 * factor), name=name)
    return with_rows(box, box.triangles)


def test_a_mesh_in_millimetres_is_noticed():
    text = check_magnitudes("tank", scaled(1000.0), "hull", scaled(1.2))
    assert text is not None
    assert "tank is 833 times as large as hull: is it in mm (then it would measure 28 m)?" in text
    assert "tank in (-12000, -14000, -8000) to (12000, 14000, 8000) m" in text
    assert "hull in (-14.4, -16.8, -9.6) to (14.4, 16.8, 9.6) m" in text
    # the other way round, and two in millimetres
    assert check_magnitudes("hull", scaled(1.2), "tank", scaled(1000.0)).startswith("tank is")
    assert "measures" in check_magnitudes("a", scaled(1000.0), "b", scaled(1100.0))
    assert "measures" in check_magnitudes("ground", plane_surface(1e5), "a", scaled(1000.0))


def test_ground_and_small_parts_are_no_cause():
    assert check_magnitudes("ground", plane_surface(4e4), "bunny", scaled(0.01)) is None
    assert check_magnitudes("ship", scaled(10.0), "bolt", scaled(0.05)) is None
    assert check_magnitudes("a", plane_surface(1e5), "b", plane_surface(1.0)) is None


def test_a_surface_in_millimetres_does_not_fit_the_inertia_of_its_body():
    """A box of 2 x 3 x 6 m has a radius of gyration of sqrt((9 + 36) / 12) = 1.94 m about x."""
    box = box_surface((2.0, 3.0, 6.0))
    gyration = float(np.sqrt((3.0**2 + 6.0**2) / 12.0))
    assert check_against_body("skin", box, "block", gyration) is None
    large = TriangleSurface(1e3 * box.points, box.triangles)
    text = check_against_body("skin", large, "block", gyration)
    assert "skin measures 6000 m" in text
    assert "block is 1.936 m" in text
    assert "then it would measure 6 m" in text


def test_a_point_mass_and_a_compact_load_under_a_wide_deck_are_no_cause():
    wide = box_surface((60.0, 40.0, 0.1))
    assert check_against_body("deck", wide, "ballast", 0.0) is None
    assert check_against_body("deck", wide, "ballast", 0.5) is None
