"""Water planes of hulls: their lids, and moonpools in them."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest
import trimesh
from scipy.integrate import quad

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.hydrodynamics.bem import BemInputs, compute_database, input_warnings
from heavylift.preprocess.hydrodynamics.hull_panels import HullPanels, box_panels, surface_panels
from heavylift.preprocess.hydrodynamics.panel_mesh import hull_panels
from heavylift.preprocess.hydrodynamics.water_planes import (
    lid_panels,
    moonpools,
    opening_height,
    piston_frequency,
)
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface


def ring(length=80.0, breadth=30.0, hole=(10.0, 8.0), draft=6.0, at=0.0):
    """Surface of a barge with a rectangular moonpool whose middle is at x = `at`."""
    sizes = ((length, breadth, 0.0), (*hole, at))
    outline = [
        [(x + sx * a / 2, sy * b / 2) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))] for a, b, x in sizes
    ]
    points = [(x, y, z) for z in (-draft, 4.0) for rectangle in outline for x, y in rectangle]
    faces = []
    for k in range(4):
        n = (k + 1) % 4
        faces += [(k, n, 8 + n), (k, 8 + n, 8 + k), (4 + k, 12 + n, 4 + n), (4 + k, 12 + k, 12 + n)]
        faces += [(k, 4 + n, n), (k, 4 + k, 4 + n), (8 + k, 8 + n, 12 + n), (8 + k, 12 + n, 12 + k)]
    return surface_panels(TriangleSurface(np.array(points), np.array(faces), 0.0, "barge"))


def area(lid: HullPanels) -> float:
    """Of horizontal panels [m^2], positive if their normals are up."""
    a, b, c = (lid.points[lid.triangles[:, i]] for i in range(3))
    return float(0.5 * np.cross(b - a, c - a)[:, 2].sum())


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("size", [2.0, 5.0])
def test_a_lid_covers_the_hull_and_leaves_the_moonpool_open(symmetric, size):
    hull = hull_panels(ring(at=7.0), 2.0, symmetric=symmetric).hull
    lid = lid_panels(hull, size, symmetric=symmetric)
    assert lid is not None
    assert area(lid) == pytest.approx(-(80.0 * 30.0 - 10.0 * 8.0), rel=1e-9)
    assert np.all(lid.points[:, 2] == 0.0)
    middles = lid.points[lid.panels].mean(axis=1)
    assert not np.any((np.abs(middles[:, 0] - 7.0) < 5.0) & (np.abs(middles[:, 1]) < 4.0))
    assert len(lid.panels) == pytest.approx(2320.0 / size**2, rel=0.35)


def test_lids_of_hulls_in_parts_and_under_water():
    pair = [trimesh.creation.box((30.0, 6.0, 4.0)).apply_translation((0.0, y, 0.0)) for y in (-9.0, 9.0)]
    both = trimesh.util.concatenate(pair)
    hull = surface_panels(TriangleSurface(np.asarray(both.vertices), np.asarray(both.faces), 0.0, "pair"))
    lid = lid_panels(hull, 2.0, symmetric=True)
    assert lid is not None
    assert area(lid) == pytest.approx(-2.0 * 30.0 * 6.0, rel=1e-9)
    assert moonpools(hull) == ()
    deep = HullPanels(hull.points - np.array([0.0, 0.0, 1.0]), hull.panels, "deep")
    assert lid_panels(deep, 2.0) is None


def test_moonpools_are_rims_around_water():
    (pool,) = moonpools(hull_panels(ring(at=7.0), 2.0, symmetric=True).hull)
    assert (pool.length, pool.breadth, pool.draft) == pytest.approx((10.0, 8.0, 6.0), rel=1e-9)
    np.testing.assert_allclose(pool.centre, [7.0, 0.0], atol=1e-9)
    assert moonpools(box_panels(30.0, 12.0, 4.0, 2.0)) == ()


@pytest.mark.parametrize(("length", "breadth"), [(1.0, 1.0), (3.0, 1.0), (12.0, 10.0), (40.0, 4.0)])
def test_water_below_an_opening_is_the_mean_of_1_over_r(length, breadth):
    """The fourfold integral of 1/r over a rectangle and itself, with differences in polar coordinates."""

    def inner(angle):
        c, s = math.cos(angle), math.sin(angle)
        r = min(length / c if c > 0.0 else math.inf, breadth / s if s > 0.0 else math.inf)
        return length * breadth * r - (length * s + breadth * c) * r**2 / 2 + c * s * r**3 / 3

    corner = math.atan2(breadth, length)
    total = 4.0 * (quad(inner, 0.0, corner)[0] + quad(inner, corner, math.pi / 2)[0])
    expected = total / (2.0 * math.pi * length * breadth)
    assert opening_height(length, breadth) == pytest.approx(expected, rel=1e-9)


def inputs(omega, **changes):
    hull = hull_panels(ring(hole=(10.0, 10.0)), 2.5, symmetric=True).hull
    lid = lid_panels(hull, 3.75, symmetric=True)
    given = {
        "hulls": (hull,),
        "omega": np.asarray(omega),
        "headings": np.zeros(1),
        "reference_points": np.zeros((1, 3)),
        "symmetric": True,
        "lids": (lid,),
    }
    return BemInputs(**{**given, **changes})


def test_frequencies_near_the_piston_mode_are_named():
    # omega^2 = g / (6 + 0.4732 * 10), the mean of 1/r of a square being 2.9732
    natural = math.sqrt(9.81 / (6.0 + 10.0 * 2.97321 / (2.0 * math.pi)))
    (sentence,) = input_warnings(inputs([0.5, 0.7, 0.95, 1.0, 1.3]))
    assert f"near {natural:.3g} rad/s" in sentence
    assert "10 x 10 m and 6 m deep" in sentence
    assert "leave_out = [0.95, 1]" in sentence
    assert input_warnings(inputs([0.5, 0.7, 1.3])) == ()


def test_open_rims_are_refused():
    hull = box_panels(30.0, 12.0, 4.0, 2.0)
    high = np.flatnonzero(hull.points[hull.panels][:, :, 2].max(axis=1) == 0.0)
    torn = HullPanels(hull.points, np.delete(hull.panels, high[0], axis=0), "torn")
    with pytest.raises(InputError, match="not closed"):
        lid_panels(torn, 2.0)


@pytest.mark.slow
def test_panels_resonate_near_the_estimate():
    """A barge three times as wide as its moonpool: the estimate for a very wide one is 7 % lower."""
    pytest.importorskip("capytaine")
    given = inputs(np.linspace(0.86, 1.24, 20))
    found = []
    with contextlib.suppress(
        InputError
    ):  # beyond the resonance panels leave negative damping, which is refused
        compute_database(given, processes=1, keep=found.append)
    (database,) = found
    peak = database.omega[np.argmax(np.abs(database.excitation[:, 0, 2]))]
    (pool,) = moonpools(given.hulls[0])
    assert 1.0 < peak / piston_frequency(pool, 9.81) < 1.12
