"""Clipping at the water plane: published numbers, exact arithmetic, closed forms, conservation."""

from fractions import Fraction

import numpy as np
import pytest
from hull_shapes import icosphere, outward_hull
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from heavylift.numerics.records import records
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.solver.water.hulls.clipping import (
    Clip,
    buoyancy_stiffness,
    clip_surface_now,
)

EYE = np.eye(3)

# box of 97.5 x 36 x 6 m about its centre: height of the centre [m], roll, pitch [deg], rotation Ry Rx; volume [m^3],
# its centre from the point of the water plane above that of the box [m], area of the water plane [m^2]; integrated
# from the intersection of half spaces, independently of any surface
BOX = np.array([
    [-1.5, 0, 0, 15795.0, 0.0, 0.0, -2.25, 3510.0],
    [-1.5, 5, 0, 15811.498246, 0.0, -2.028332, -2.336205, 3433.324573],
    [-1.5, 0, 1, 15795.802007, 3.059575, 0.0, -2.276584, 3510.534671],
    [-1.5, 5, 1, 15727.063776, 2.883004, -1.957841, -2.374343, 3237.704357],
    [-1.5, 10, 0, 15080.001956, 0.0, -3.496183, -2.700241, 2611.301283],
    [-2.5, 10, 2, 17133.951863, 3.265298, -2.229829, -3.384331, 2041.534256],
    [0.0, 15, 3, 10530.0, 8.719539, -6.5625, -2.859133, 2215.194973],
])  # fmt: skip


def clip(points, triangles, rotation=EYE, height=0.0):
    points = np.ascontiguousarray(points, dtype=np.float64)
    out = records(Clip, 1)
    out.view(float)[:] = np.nan
    flat = np.ascontiguousarray(rotation).ravel()
    clip_surface_now(points, triangles, flat, float(height), np.empty_like(points), out)
    return out[0]


def lopsided(seed):
    """Points and triangles of a polyhedron without any symmetry."""
    points = np.random.default_rng(seed).normal(size=(14, 3)) * [3.0, 2.0, 1.0]
    points = points[np.unique(ConvexHull(points).simplices)]
    return points, outward_hull(points)


@pytest.mark.parametrize("row", BOX)
def test_box_table(row):
    box = box_surface((97.5, 36.0, 6.0))
    rotation = Rotation.from_euler("xy", row[1:3], degrees=True).as_matrix()  # about the axes of the world
    out = clip(box.points, box.triangles, rotation, row[0])
    found = [out.volume, *(out.moment / out.volume), out.plane_area]
    assert np.allclose(found, row[3:], rtol=0.0, atol=1e-6)


def test_upright_box_moments():
    box = box_surface((97.5, 36.0, 6.0))
    out = clip(box.points, box.triangles, EYE, -1.5)
    found = [out.plane_xx, out.plane_yy, out.plane_xy]
    assert np.allclose(found, [97.5**3 * 36 / 12, 97.5 * 36**3 / 12, 0.0], rtol=1e-14)
    assert out.wetted_area == pytest.approx(97.5 * 36 + 4.5 * 2 * (97.5 + 36), rel=1e-14)
    assert out.crossing == 8


def exact_tetrahedron(corners):
    """Volume, first moments and area of the water plane of a tetrahedron, and its wet part, in rational numbers."""
    wet = [p for p in corners if p[2] < 0]
    dry = [p for p in corners if p[2] >= 0]

    def cut(p, q):
        t = p[2] / (p[2] - q[2])
        return tuple(a + t * (b - a) for a, b in zip(p, q, strict=True))

    def determinant(a, b, c, d):
        (u, v, w) = ([x - y for x, y in zip(p, a, strict=True)] for p in (b, c, d))
        return (
            u[0] * (v[1] * w[2] - v[2] * w[1])
            - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0])
        )

    plane = [cut(p, q) for p in wet for q in dry]
    if not wet:
        parts = []
    elif not dry:
        parts = [tuple(wet)]
    elif len(wet) == 1:
        parts = [(wet[0], *plane)]
    elif len(wet) == 3:  # a prism between the wet face and the cut
        a, b = wet, plane
        parts = [(a[0], a[1], a[2], b[0]), (a[1], a[2], b[0], b[1]), (a[2], b[0], b[1], b[2])]
    else:
        a, b = [wet[0], plane[0], plane[1]], [wet[1], plane[2], plane[3]]
        parts = [(a[0], a[1], a[2], b[0]), (a[1], a[2], b[0], b[1]), (a[2], b[0], b[1], b[2])]
    volumes = [abs(determinant(*part)) / 6 for part in parts]
    moments = [
        sum(v * sum(p[k] for p in part) / 4 for v, part in zip(volumes, parts, strict=True)) for k in range(3)
    ]
    if len(plane) == 4:
        plane = [plane[0], plane[1], plane[3], plane[2]]
    area = abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(plane, plane[1:] + plane[:1], strict=True))) / 2
    return [float(x) for x in (sum(volumes), *moments, area)]


def test_tetrahedra_against_rational_arithmetic():
    rng = np.random.default_rng(7)
    cases = set()
    turn = [[Fraction(3, 5), Fraction(-4, 5), 0], [Fraction(4, 5), Fraction(3, 5), 0], [0, 0, 1]]
    tilt = [[1, 0, 0], [0, Fraction(5, 13), Fraction(-12, 13)], [0, Fraction(12, 13), Fraction(5, 13)]]
    rotation = [[sum(turn[i][k] * tilt[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    for _ in range(60):
        points = rng.integers(-64, 65, size=(4, 3))
        height = int(rng.integers(-40, 41))
        if abs(np.linalg.det((points[1:] - points[0]).astype(float))) < 1.0:
            continue
        exact = [
            tuple(
                sum(rotation[i][k] * int(p[k]) for k in range(3)) + (height if i == 2 else 0)
                for i in range(3)
            )
            for p in points
        ]
        cases.add(sum(p[2] < 0 for p in exact))
        real = points.astype(float)
        out = clip(real, outward_hull(real), np.array(rotation, dtype=float), height)
        found = [out.volume, *out.moment, out.plane_area]
        assert np.allclose(found, exact_tetrahedron(exact), rtol=1e-12, atol=1e-9)
    assert cases == {0, 1, 2, 3, 4}


def test_dry_and_submerged():
    points, triangles = lopsided(1)
    dry = clip(points, triangles, EYE, 50.0)
    assert not dry.words.any()
    out = clip(points, triangles, EYE, -50.0)
    hull = ConvexHull(points)
    assert out.volume == pytest.approx(hull.volume, rel=1e-12)
    assert out.wetted_area == pytest.approx(hull.area, rel=1e-12)
    assert not any((out.plane_area, out.plane_x, out.plane_y, out.plane_xx, out.plane_yy, out.plane_xy))
    assert out.crossing == 0


def test_edges_in_the_water_plane():
    """A belt of edges exactly on the plane, and a deck exactly on it: the hull is one that is raised a little."""
    lower, upper = box_surface((4.0, 2.0, 1.0)), box_surface((4.0, 2.0, 1.0))
    lids = ([2, 3], [0, 1])  # triangles of the top, of the bottom
    up = np.array([0.0, 0.0, 0.5])
    points = np.vstack([lower.points - up, upper.points + up])
    triangles = np.vstack([
        np.delete(lower.triangles, lids[0], axis=0), np.delete(upper.triangles, lids[1], axis=0) + 8
    ])  # fmt: skip
    belt, raised = clip(points, triangles), clip(points, triangles, EYE, 1e-12)
    assert np.allclose(belt.words[:-1], raised.words[:-1], atol=1e-10)
    assert belt.plane_area == pytest.approx(8.0)
    deck = clip(lower.points, lower.triangles, EYE, -0.5)
    assert deck.plane_area == pytest.approx(8.0)
    assert deck.volume == pytest.approx(8.0)


def test_what_is_not_a_number_stays_visible():
    points, triangles = lopsided(2)
    for bad in (
        clip(points, triangles, EYE, np.nan),
        clip(points, triangles, EYE * np.nan, 50.0),
        clip(np.where(np.arange(len(points))[:, None] == 3, np.nan, points), triangles, EYE, 50.0),
    ):
        assert np.isnan(bad.volume)


def test_open_deck_does_no_harm_while_dry():
    box = box_surface((4.0, 2.0, 1.0))
    rotation = Rotation.from_rotvec([0.1, -0.05, 0.3]).as_matrix()
    whole = clip(box.points, box.triangles, rotation, 0.1)
    opened = clip(box.points, np.delete(box.triangles, [2, 3], axis=0), rotation, 0.1)
    assert opened.crossing == whole.crossing
    assert opened.words[:-1] == pytest.approx(whole.words[:-1], rel=1e-15)


def test_sphere_converges_to_the_cap():
    """Volume, first moment and water plane of a spherical cap of depth t: second order in the edge length."""
    height, t = 0.3, 0.7
    volume = np.pi * t**2 * (3.0 - t) / 3.0
    # int_{-t}^{0} z pi (1 - (z - h)^2) dz
    moment = np.pi * (-(t**2) / 2.0 - (t**4 / -4.0 - 2.0 * height * (t**3 / 3.0) - height**2 * t**2 / 2.0))
    exact = np.array([volume, moment, np.pi * (1.0 - height**2)])
    rotation = Rotation.from_rotvec([0.4, -0.3, 0.2]).as_matrix()
    clips = [clip(*icosphere(k), rotation, height) for k in (2, 3, 4, 5)]
    errors = np.abs([np.array([out.volume, out.moment[2], out.plane_area]) / exact - 1.0 for out in clips])
    assert (errors[-1] < 1e-3).all()
    assert np.allclose(np.log2(errors[0] / errors[-1]) / 3.0, 2.0, atol=0.15)


def state(points, triangles, rotation, height):
    """Potential, and force with moment about the origin, for a unit weight of water, shape (6,)."""
    out = clip(points, triangles, rotation, height)
    return -out.moment[2], np.array([0.0, 0.0, out.volume, out.moment[1], -out.moment[0], 0.0]), out


def moved(rotation, height, shift):
    return Rotation.from_rotvec(shift[3:]).as_matrix() @ rotation, height + shift[2]


@pytest.mark.parametrize("seed", range(6))
def test_force_is_the_gradient_and_stiffness_its_derivative(seed):
    points, triangles = lopsided(seed)
    rotation = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    height = 0.2
    clearance = np.abs(points @ rotation[2] + height).min()
    step = min(1e-3, 0.1 * clearance)  # no vertex passes the plane
    _, force, out = state(points, triangles, rotation, height)
    gradient, slope = np.zeros(6), np.zeros((6, 6))
    for axis, unit in enumerate(np.eye(6)):
        for weight, times in ((1.0, -2), (-8.0, -1), (8.0, 1), (-1.0, 2)):
            energy, there, _ = state(points, triangles, *moved(rotation, height, times * step * unit))
            gradient[axis] += weight * energy / (12.0 * step)
            slope[:, axis] += weight * there / (12.0 * step)
    scale = np.abs(force).max()
    assert np.allclose(force, -gradient, rtol=0.0, atol=1e-9 * scale)
    stiffness = buoyancy_stiffness(out, height, 1025.0, 9.81)
    assert np.allclose(stiffness, -1025.0 * 9.81 * slope, rtol=0.0, atol=1e-9 * np.abs(stiffness).max())


@pytest.mark.slow
def test_no_work_over_a_closed_path():
    """Heave, roll and pitch over a loop without symmetry, corners in and out of the water."""
    points, triangles = lopsided(3)
    count = 4000
    work = gross = 0.0
    nodes, weights = np.polynomial.legendre.leggauss(4)
    for start in np.arange(count) / count:
        for node, weight in zip(nodes, weights, strict=True):
            s = 2.0 * np.pi * (start + 0.5 * (1.0 + node) / count)
            roll, pitch = 0.6 * np.sin(s) + 0.2 * np.cos(2.0 * s), 0.4 * np.cos(s) + 0.1 * np.sin(3.0 * s)
            rates = np.array([
                -0.5 * np.sin(s + 0.4),
                0.6 * np.cos(s) - 0.4 * np.sin(2.0 * s),
                -0.4 * np.sin(s) + 0.3 * np.cos(3.0 * s),
            ])  # fmt: skip
            rotation = Rotation.from_euler("xy", [roll, pitch]).as_matrix()
            _, force, _ = state(points, triangles, rotation, 0.5 * np.cos(s + 0.4))
            spin = rates[1] * np.array([np.cos(pitch), 0.0, -np.sin(pitch)]) + rates[2] * np.array(
                [0.0, 1.0, 0.0]
            )
            power = force[2] * rates[0] + force[3:] @ spin
            work += weight * power
            gross += weight * abs(power)
    assert abs(work) < 1e-10 * gross
