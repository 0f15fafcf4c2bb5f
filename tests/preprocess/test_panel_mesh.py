"""Panels made anew on wetted surfaces: how many, how true, what stays, and what happens where they cannot be made."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.hull_panels import hydrostatics, surface_panels
from heavylift.preprocess.hydrodynamics.panel_mesh import hull_panels
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface, clean


def wetted(mesh):
    """Triangles of a trimesh below z = 0."""
    return surface_panels(clean(np.asarray(mesh.vertices), np.asarray(mesh.faces), name="hull")[0])


def convex(sections):
    return trimesh.convex.convex_hull(np.array(sections, dtype=float))


def raked():
    """80 m of flat bottom 5 m deep, ends raked by 26.6 degrees, 30 m wide."""
    section = ((-40, -5), (40, -5), (50, 0), (50, 4), (-50, 4), (-50, 0))
    return convex([(x, y, z) for y in (-15, 15) for x, z in section])


def bevelled():
    """100 m long, bilges cut off over 2 m at 45 degrees."""
    section = ((-13, -5), (13, -5), (15, -3), (15, 4), (-15, 4), (-15, -3))
    return convex([(x, y, z) for x in (-50, 50) for y, z in section])


def grid(*sides):
    """Panels of rectangles of so many by so many sizes."""
    return sum(int(np.ceil(a - 1e-9) * np.ceil(b - 1e-9)) for a, b in sides)


# name: (mesh, size, wetted volume, panels of a structured grid with sides up to that size)
HULLS = {
    "transport barge": (
        lambda: trimesh.creation.box((97.5, 36.0, 9.0)),
        2.0,
        97.5 * 36.0 * 4.5,
        grid((48.75, 18.0), *2 * [(48.75, 2.25)], *2 * [(18.0, 2.25)]),
    ),
    "small barge": (
        lambda: trimesh.creation.box((40.0, 12.0, 6.0)),
        1.5,
        40.0 * 12.0 * 3.0,
        grid((40 / 1.5, 8.0), *2 * [(40 / 1.5, 2.0)], *2 * [(8.0, 2.0)]),
    ),
    "raked barge": (
        raked,
        2.0,
        90.0 * 5.0 * 30.0,
        grid((40, 15), *2 * [(np.hypot(10, 5) / 2, 15)], *2 * [(50, 2.5)]),
    ),
    "bevelled barge": (
        bevelled,
        2.0,
        100.0 * (150.0 - 4.0),
        grid((50, 13), *2 * [(50, np.sqrt(2.0))], *2 * [(50, 1.5)], *2 * [(15, 2.5)]),
    ),
    # a disc has squares in its middle and rings around them: its area
    "vertical cylinder": (
        lambda: trimesh.creation.cylinder(10.0, 30.0, sections=128),
        2.0,
        np.pi * 100.0 * 15.0,
        grid((10 * np.pi, 7.5)) + int(np.pi * 25.0),
    ),
    # 10 rings of 40 sectors lose 1.02 % of the volume
    "hemisphere": (lambda: trimesh.creation.icosphere(5, 10.0), 2.0, 2.0 / 3.0 * np.pi * 1000.0, 10 * 40),
}


@pytest.mark.slow
@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("name", HULLS)
def test_as_many_panels_as_a_structured_grid(name, symmetric):
    mesh, size, volume, structured = HULLS[name]
    made = hull_panels(wetted(mesh()), size, symmetric=symmetric)
    assert made.problem == ""
    assert len(made.hull.panels) <= 1.2 * structured
    round_hull = name in ("vertical cylinder", "hemisphere")
    still = hydrostatics(made.hull, 1.0, 1.0, np.zeros(3))
    assert still.volume == pytest.approx(volume, rel=0.015 if round_hull else 1e-9)
    assert (made.curved > 0.5) == round_hull
    assert made.hull.characteristic_size < 1.4 * size
    np.testing.assert_allclose(
        still.centre_of_buoyancy[:2], 0.0, atol=2e-3 * np.ptp(made.hull.points, axis=0).max()
    )
    _check_closed(made.hull)
    if symmetric:
        corners = {tuple(p) for p in made.hull.points.tolist()}
        assert {(x, -y + 0.0, z) for x, y, z in corners} == corners  # to the last bit


def _check_closed(hull):
    """Every side of a panel is that of one other, run the other way; but for the rim in the water."""
    sides = np.stack([hull.panels, np.roll(hull.panels, -1, axis=1)], axis=2).reshape(-1, 2)
    sides = [(a, b) for a, b in sides.tolist() if a != b]
    assert len(set(sides)) == len(sides)
    loose = [pair for pair in sides if pair[::-1] not in set(sides)]
    assert np.all(hull.points[np.array(loose)][:, :, 2] == 0.0)


def test_boxes_get_rectangles():
    made = hull_panels(wetted(trimesh.creation.box((97.5, 36.0, 9.0))), 2.0, symmetric=True)
    assert len(made.hull.panels) == HULLS["transport barge"][3]
    corners = made.hull.points[made.hull.panels]
    sides = np.roll(corners, -1, axis=1) - corners
    right = np.einsum("ijk,ijk->ij", sides, np.roll(sides, 1, axis=1))
    np.testing.assert_allclose(right, 0.0, atol=1e-9)
    assert made.hull.longest_side <= 2.0 * (1.0 + 1e-9)


@pytest.mark.slow
def test_round_hulls_get_smaller_panels_until_volume_and_water_plane_are_right():
    sphere = wetted(trimesh.creation.icosphere(5, 5.0))
    coarse, fine = hull_panels(sphere, 1.5, symmetric=True), hull_panels(sphere, 0.4, symmetric=True)
    for made in (coarse, fine):
        assert 0.99 <= made.volume < 1.0
        assert 0.99 <= made.waterplane < 1.0
    assert coarse.size < 0.7
    assert fine.size == 1.0


@pytest.mark.slow
def test_separate_parts_are_meshed_by_themselves():
    column = trimesh.creation.cylinder(4.0, 20.0, sections=48)
    places = [(x, y, 0.0) for x in (-20.0, 20.0) for y in (-15.0, 15.0)]
    four = trimesh.util.concatenate([column.copy().apply_translation(place) for place in places])
    one, all_four = hull_panels(wetted(column), 1.5), hull_panels(wetted(four), 1.5)
    assert all_four.problem == ""
    assert all_four.volume == pytest.approx(one.volume, abs=5e-3)
    assert len(all_four.hull.panels) == pytest.approx(4 * len(one.hull.panels), rel=0.05)


def test_what_cannot_be_taken_apart_keeps_its_triangles():
    """A corner in the middle of a neighbour's side below the water."""
    box = trimesh.creation.box((20.0, 8.0, 6.0))
    points, faces = np.asarray(box.vertices), np.asarray(box.faces)
    number = next(i for i, f in enumerate(faces) if np.all(points[f][:, 2] == -3.0))
    a, b, c = faces[number]
    middle = len(points)
    points = np.vstack([points, 0.5 * (points[a] + points[b])])
    faces = np.vstack([np.delete(faces, number, axis=0), [[a, middle, c], [middle, b, c]]])
    made = hull_panels(surface_panels(TriangleSurface(points, faces, 0.0, "hull")), 2.0)
    assert "neighbours do not share" in made.problem
    assert made.volume == pytest.approx(1.0, rel=1e-12)
    assert made.hull.longest_side <= 2.0 * (1.0 + 1e-9)


@pytest.mark.parametrize(("size", "message"), [(0.0, "a length > 0"), (0.01, "more than 200000")])
def test_sizes_that_are_slips(size, message):
    with pytest.raises(InputError, match=message):
        hull_panels(wetted(trimesh.creation.box((97.5, 36.0, 9.0))), size)
