"""Primitives against surfaces and curves: distances from support functions, pairs from dense sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

from heavylift.contours.splines.convex import (
    BALL,
    BOX,
    CAPSULE,
    CYLINDER,
    ELLIPSOID,
    RING,
    core_distance,
    shape_row,
)
from heavylift.contours.splines.evaluate import SCRATCH
from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
from heavylift.contours.splines.sample_packing import pack_samples
from heavylift.contours.splines.search_shape import closest_shape_cold, closest_shape_on_surface, shape_gap
from heavylift.contours.splines.search_step import (
    BEHIND,
    BORDER,
    CONVERGED,
    DEEP,
    DEGENERATE,
    NEED_SPAN,
    ContourSearch,
    start_search,
)
from heavylift.contours.splines.spaces import clamped_space
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import filled, records


@kernel
def distance(kind, shape, points, out):
    for i in range(points.shape[0]):
        value = core_distance(kind, shape, points[i, 0], points[i, 1], points[i, 2])
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = (
            value[0],
            value[1],
            value[2],
            value[3],
            value[4],
        )
        out[i, 5], out[i, 6], out[i, 7], out[i, 8], out[i, 9] = (
            value[5],
            value[6],
            value[7],
            value[8],
            value[9],
        )


@kernel
def search(contour, knots, weights, net, kind, shape, start, samples, scratch, result, out):
    # one kernel for all searches compiles once: start holds the task, (u, v) and the window
    status = 0
    if start[0] == COLD:
        status = closest_shape_cold(
            contour, knots, weights, net, kind, shape, samples, samples.grids[0], scratch, result
        )
    else:
        if start[0] == WARM:
            start_search(contour, start[1], start[2], result)
        result.span_u = result.span_v = int(start[3])
        status = closest_shape_on_surface(contour, knots, weights, net, kind, shape, scratch, result)
    out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7] = shape_gap(kind, shape, result)
    return status


COLD, WARM, GO_ON = 0.0, 1.0, 2.0

SHAPES = {
    "ball": (BALL, (), 0.3),
    "capsule": (CAPSULE, (0.4,), 0.15),
    "box": (BOX, (0.3, 0.2, 0.25), 0.1),
    "cylinder": (CYLINDER, (0.25, 0.3), 0.08),
    "ellipsoid": (ELLIPSOID, (0.5, 0.3, 0.2), 0.0),
}


def support(name, d):
    """Support function of a primitive, ``max x.d`` over its points; unit directions, shape (n, 3), in its axes."""
    kind, sizes, radius = SHAPES[name]
    a = np.abs(d)
    if kind == BALL:
        core = 0.0
    elif kind == CAPSULE:
        core = sizes[0] * a[:, 2]
    elif kind == BOX:
        core = a @ np.array(sizes)
    elif kind == CYLINDER:
        core = sizes[0] * np.hypot(a[:, 0], a[:, 1]) + sizes[1] * a[:, 2]
    else:
        core = np.sqrt((a**2) @ np.array(sizes) ** 2)
    return core + radius


def signed_distance(name, points):
    """``max over d of d.x - h(d)``: signed distance to a convex body, inside too; directions ever finer."""
    result = np.empty(len(points))
    generator = np.random.default_rng(0)
    around = generator.standard_normal((4000, 3))
    around /= np.linalg.norm(around, axis=1)[:, None]
    for i, x in enumerate(points):
        d = np.concatenate([around, np.eye(3), -np.eye(3)])
        half = 0.2
        for _ in range(60):
            best = d[np.argmax(d @ x - support(name, d))]
            d = best + half * around[:100]
            # support functions have their edges in the planes of symmetry
            d = np.concatenate([d, *(d * (1.0 - np.eye(3)[k]) for k in range(3))])
            d = np.concatenate([d / np.linalg.norm(d, axis=1)[:, None], best[None]])
            half *= 0.75
        result[i] = np.max(d @ x - support(name, d))
    return result


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SHAPES))
def test_the_distance_to_a_core_is_that_of_its_support_function(name):
    kind, sizes, radius = SHAPES[name]
    row = shape_row(kind, sizes, radius)
    points = np.random.default_rng(4).uniform(-0.8, 0.8, (40, 3))
    if kind == ELLIPSOID:  # inside, the foot is defined up to the centres of curvature
        points = np.concatenate([points, 0.97 * np.array([[0.5, 0, 0], [0, 0.3, 0], [0, 0, 0.2]])])
    out = np.zeros((len(points), 10))
    distance(kind, row, points, out)
    expected = signed_distance(name, points)
    if kind in (BALL, CAPSULE):  # the distance to a thin core ends at zero
        expected = np.maximum(expected, -radius)
    assert out[:, 0] - row.shift - radius == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("name", [*SHAPES, "ring"])
def test_derivatives_of_the_distance(name):
    kind, sizes, _ = SHAPES.get(name, (RING, (0.4,), 0.0))
    row = shape_row(kind, sizes)
    points = np.random.default_rng(5).uniform(-0.8, 0.8, (60, 3))
    out = np.zeros((len(points), 10))
    distance(kind, row, points, out)
    step = 1e-5
    gradient, hessian = np.zeros((len(points), 3)), np.zeros((len(points), 3, 3))
    for k in range(3):
        plus, minus = np.zeros_like(out), np.zeros_like(out)
        distance(kind, row, points + step * np.eye(3)[k], plus)
        distance(kind, row, points - step * np.eye(3)[k], minus)
        gradient[:, k] = (plus[:, 0] ** 2 - minus[:, 0] ** 2) / (4.0 * step)
        hessian[:, :, k] = (plus[:, 1:4] - minus[:, 1:4]) / (2.0 * step)
    whole = out[:, [4, 7, 8, 7, 5, 9, 8, 9, 6]].reshape(-1, 3, 3)
    assert out[:, 1:4] == pytest.approx(gradient, abs=1e-7)
    # at a change from face to edge the differences are not those of one side
    error = np.abs(whole - hessian).max(axis=(1, 2))
    size = 1.0 + np.abs(whole).max(axis=(1, 2))
    assert np.sum(error > 1e-5 * size) <= 1


class Surface:
    """Wavy open surface over [0, 2] x [0, 1.5], normal upwards, or its middle line as a curve."""

    def __init__(self, seed=0, height=0.08, line=False):
        self.spaces = (clamped_space(3, np.arange(1, 8) / 8), clamped_space(3, np.arange(1, 6) / 6))
        su, sv = self.spaces
        x, y = np.meshgrid(np.linspace(0, 2, su.count), np.linspace(0, 1.5, sv.count), indexing="ij")
        z = height * np.random.default_rng(seed).standard_normal(x.shape)
        control = np.stack([x, y, z], -1)
        along = filled(PackedDirection, degree=3, count=su.count, closed=False, first_knot=0)
        across = filled(PackedDirection, degree=3, count=sv.count, closed=False, first_knot=su.knots.size)
        self.knots = np.concatenate([su.knots, sv.knots])
        if line:
            self.spaces = (su,)
            control = control[:, 4:5]
            across = filled(PackedDirection, degree=0, count=1, closed=False, first_knot=0)
        self.control = control
        self.net = control.reshape(-1, 3).copy()
        table = records(
            PackedContour, [filled(PackedContour, u=along, v=across, first_control=0, first_weight=-1)]
        )
        self.contour = table[0]
        self.arrays = (self.contour, self.knots, np.zeros(0), self.net)
        self.scratch, self.result, self.out = np.zeros(SCRATCH), ContourSearch.one(), np.zeros(8)
        self.samples = pack_samples([self.spaces], table, np.zeros(0), self.net, [False], 5)

    def __call__(self, u, v):
        """Points of all pairs, by scipy."""
        parts = [
            BSpline.design_matrix(at, space.knots, space.degree).toarray()
            for at, space in zip((u, v), self.spaces, strict=False)
        ]
        if len(parts) == 1:
            parts.append(np.ones((1, 1)))
        return np.einsum("ai,bj,ijk->abk", *parts, self.control)

    def cold(self, kind, row, start=(COLD, 0.0, 0.0, 0.0)):
        args = kind, row, np.array(start), self.samples, self.scratch, self.result, self.out
        return search(*self.arrays, *args)

    def least(self, gap):
        """Least of a function of points over the surface, by ever finer samples."""
        u, v = np.linspace(0, 1, 121), np.linspace(0, 1, 81 if len(self.spaces) == 2 else 1)
        for level in range(9):
            values = gap(self(u, v).reshape(-1, 3)).reshape(u.size, v.size)
            i, j = np.unravel_index(np.argmin(values), values.shape)
            half = 0.025 / 3.0**level
            u = np.clip(u[i] + half * np.linspace(-1, 1, 15), 0.0, 1.0)
            if v.size > 1:
                v = np.clip(v[j] + half * np.linspace(-1, 1, 15), 0.0, 1.0)
        return values.min()


def posed(name, centre, rotation):
    kind, sizes, radius = SHAPES[name]
    row = shape_row(kind, sizes, radius)
    row.centre[:] = centre
    row.axes[:] = rotation
    return kind, row


def local_distance(name, row):
    """Signed distance to a primitive by closed forms of its own, vectorised."""
    kind, sizes, radius = SHAPES[name]
    rotation = row.axes

    def gap(points):
        x = (points - row.centre) @ rotation
        if kind == BALL:
            return np.linalg.norm(x, axis=1) - radius
        if kind == CAPSULE:
            x[:, 2] -= np.clip(x[:, 2], -sizes[0], sizes[0])
            return np.linalg.norm(x, axis=1) - radius
        if kind == BOX:
            p = np.abs(x) - np.array(sizes)
        else:
            p = np.stack([np.hypot(x[:, 0], x[:, 1]) - sizes[0], np.abs(x[:, 2]) - sizes[1]], -1)
        return np.linalg.norm(np.maximum(p, 0.0), axis=1) + np.minimum(p.max(axis=1), 0.0) - radius

    return gap


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ball", "capsule", "box", "cylinder"])
def test_least_gap_to_a_surface_open_and_penetrating(name):
    generator = np.random.default_rng(11)
    penetrating = deep = 0
    for seed in range(3):
        surface = Surface(seed)
        for height in (1.0, 0.6, 0.5, 0.4, 0.3):
            centre = np.array([*generator.uniform([0.6, 0.5], [1.4, 1.0]), height])
            rotation = Rotation.random(random_state=generator.integers(1 << 30)).as_matrix()
            kind, row = posed(name, centre, rotation)
            assert surface.cold(kind, row) == CONVERGED
            expected = surface.least(local_distance(name, row))
            assert (expected < -row.radius + 1e-4) >= bool(surface.result.flags & DEEP)
            penetrating += expected < 0.0
            flags = surface.result.flags
            if flags & DEEP:
                deep += 1
                continue
            assert surface.out[0] <= expected + 1e-9
            assert surface.out[0] == pytest.approx(expected, abs=2e-6)
            if flags & (BORDER | BEHIND | DEGENERATE) == 0:
                assert surface.out[7] == pytest.approx(-1.0, abs=1e-9)  # opposite normals

    assert penetrating - deep >= 1


def test_an_ellipsoid_touches_at_its_support_point():
    generator = np.random.default_rng(12)
    half = np.array(SHAPES["ellipsoid"][1])
    touched = 0
    for seed in range(8):
        surface = Surface(seed, height=0.03)
        centre = np.array([*generator.uniform([0.7, 0.6], [1.3, 0.9]), generator.uniform(0.25, 0.7)])
        rotation = Rotation.random(random_state=seed).as_matrix()
        kind, row = posed("ellipsoid", centre, rotation)
        assert surface.cold(kind, row) == CONVERGED
        if surface.result.flags & (BORDER | BEHIND | DEGENERATE):
            continue
        touched += 1
        n = np.cross(surface.result.tangent_u, surface.result.tangent_v)
        d = -rotation.T @ n / np.linalg.norm(n)
        expected = centre + rotation @ (half**2 * d / np.linalg.norm(half * d))
        assert surface.out[4:7] == pytest.approx(expected, abs=1e-9)
        assert surface.result.position == pytest.approx(
            surface.out[4:7] + surface.out[0] * surface.out[1:4], abs=1e-12
        )
        assert surface.out[0] < 0.0 or surface.out[7] < 0.0
    assert touched >= 6


def test_the_gap_is_smooth_through_zero():
    surface = Surface(3)
    kind, row = posed(
        "capsule", np.array([1.0, 0.75, 0.4]), Rotation.from_euler("y", 80, degrees=True).as_matrix()
    )
    assert surface.cold(kind, row) == CONVERGED
    row.centre[2] -= surface.out[0]
    heights = row.centre[2] + np.linspace(-0.02, 0.02, 9)
    gaps = []
    for height in heights:
        row.centre[2] = height
        assert surface.cold(kind, row) == CONVERGED
        gaps.append(surface.out[0])
    assert gaps[0] < 0.0 < gaps[-1]
    assert np.abs(np.diff(gaps, 4)).max() < 1e-6
    assert np.all(np.diff(gaps) > 0.0)


def test_a_box_flat_on_a_plane():
    surface = Surface(height=0.0)
    kind, row = posed("box", np.array([1.0, 0.75, 0.34]), np.eye(3))
    assert surface.cold(kind, row) == CONVERGED
    assert surface.out[0] == pytest.approx(0.34 - 0.25 - 0.1, abs=1e-12)
    assert surface.result.flags & DEGENERATE  # any point under the face is a minimum
    # slightly tilted: the lower edge, its rounding
    angle = 1e-3
    kind, row = posed("box", np.array([1.0, 0.75, 0.34]), Rotation.from_euler("y", angle).as_matrix())
    assert surface.cold(kind, row) == CONVERGED
    expected = 0.34 - 0.3 * math.sin(angle) - 0.25 * math.cos(angle) - 0.1
    assert surface.out[0] == pytest.approx(expected, abs=1e-12)
    # deeper than the rounding
    row.centre[2] = 0.3
    assert surface.cold(kind, row) == CONVERGED
    assert surface.out[0] == pytest.approx(expected - 0.04, abs=5e-5)


def test_from_below_the_primitive_is_behind():
    surface = Surface(height=0.0)
    kind, row = posed("ball", np.array([1.0, 0.75, -0.2]), np.eye(3))
    assert surface.cold(kind, row) == CONVERGED
    assert surface.result.flags & BEHIND


@pytest.mark.parametrize("name", ["capsule", "box", "cylinder"])
def test_least_gap_to_a_curve(name):
    generator = np.random.default_rng(13)
    surface = Surface(2, line=True)
    for _ in range(12):
        centre = np.array([generator.uniform(0.5, 1.5), 0.7, generator.uniform(0.4, 1.0)])
        kind, row = posed(name, centre, Rotation.random(random_state=generator.integers(1 << 30)).as_matrix())
        assert surface.cold(kind, row) == CONVERGED
        expected = surface.least(local_distance(name, row))
        assert surface.out[0] == pytest.approx(expected, abs=2e-6)
        assert surface.out[0] <= expected + 1e-9


def test_a_warm_search_is_short_and_keeps_to_its_window():
    surface = Surface(5)
    kind, row = posed("ellipsoid", np.array([1.0, 0.7, 0.5]), Rotation.random(random_state=3).as_matrix())
    assert surface.cold(kind, row) == CONVERGED
    u, v = [surface.result.u, surface.result.v]
    row.centre[0] += 2e-3
    assert surface.cold(kind, row, (WARM, u, v, -1.0)) == CONVERGED
    assert surface.result.iterations <= 6
    whole = [surface.result.u, surface.result.v]
    assert surface.cold(kind, row, (WARM, u, v, 0.0)) == NEED_SPAN
    assert surface.cold(kind, row, (GO_ON, u, v, -1.0)) == CONVERGED
    assert [surface.result.u, surface.result.v] == pytest.approx(whole, abs=0.0)


@pytest.mark.parametrize(
    ("kind", "sizes", "radius"), [(BOX, (0.1,), 0.0), (CAPSULE, (-0.1,), 0.0), (ELLIPSOID, (1, 0, 1), 0.0)]
)
def test_sizes_that_make_no_primitive(kind, sizes, radius):
    with pytest.raises(InputError):
        shape_row(kind, sizes, radius)
