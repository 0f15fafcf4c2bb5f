"""Thin rings: signed gaps to surfaces against closed forms and dense sampling, distances to curves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

from heavylift.contours.splines.convex import RING, shape_row
from heavylift.contours.splines.evaluate import SCRATCH
from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
from heavylift.contours.splines.sample_packing import pack_samples
from heavylift.contours.splines.search_circle import ring_cold, ring_on_surface, start_ring
from heavylift.contours.splines.search_shape import closest_shape_cold, shape_gap
from heavylift.contours.splines.search_step import (
    BORDER,
    CONVERGED,
    DEGENERATE,
    NEED_SPAN,
    TWIN,
    ContourSearch,
)
from heavylift.contours.splines.spaces import clamped_space, closed_space
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import filled, records

pytestmark = pytest.mark.slow

COLD, WARM, GO_ON = 0.0, 1.0, 2.0


@kernel
def search(contour, knots, weights, net, shape, start, samples, separation, scratch, result, out):
    # one kernel for all searches compiles once: start holds the task, (u, v, phi) and the window
    grid = samples.grids[0]
    if contour.v.degree == 0:
        status = closest_shape_cold(contour, knots, weights, net, RING, shape, samples, grid, scratch, result)
        out[0] = shape_gap(RING, shape, result)[0]
        return status
    if start[0] == COLD:
        result.separation = separation
        return ring_cold(contour, knots, weights, net, shape, samples, grid, scratch, result)
    if start[0] == WARM:
        start_ring(contour, start[1], start[2], start[3], result)
    result.span_u, result.span_v = int(start[4]), int(start[5])
    return ring_on_surface(contour, knots, weights, net, shape, scratch, result)


class Surface:
    """Contour with its arrays, evaluated by scipy."""

    def __init__(self, spaces, control):
        self.spaces, self.control = spaces, control
        self.knots = np.concatenate([space.knots for space in spaces])
        self.net = control.reshape(-1, 3).copy()
        u = spaces[0]
        along = filled(PackedDirection, degree=u.degree, count=u.count, closed=u.closed, first_knot=0)
        across = filled(PackedDirection, degree=0, count=1, closed=False, first_knot=0)
        if len(spaces) == 2:
            v = spaces[1]
            across = filled(
                PackedDirection, degree=v.degree, count=v.count, closed=v.closed, first_knot=u.knots.size
            )
        table = records(
            PackedContour, [filled(PackedContour, u=along, v=across, first_control=0, first_weight=-1)]
        )
        self.contour = table[0]
        self.arrays = (self.contour, self.knots, np.zeros(0), self.net)
        self.scratch, self.result, self.out = np.zeros(SCRATCH), ContourSearch.one(), np.zeros(1)
        self.samples = pack_samples([spaces], table, np.zeros(0), self.net, [False])

    def __call__(self, u, v=None, derivative=(0, 0)):
        """Points, or derivatives, of all pairs."""
        control = self.control
        for axis, (at, space) in enumerate(zip((u, v), self.spaces, strict=False)):
            wide = np.take(control, np.arange(space.functions) % space.count, axis=axis)
            spline = BSpline(space.knots, wide, space.degree, axis=axis)
            control = spline(at, nu=derivative[axis])
        return control

    def place(self):
        """Parameters and angle of the last search, and the gap."""
        result = self.result
        return result.u, result.v, result.ring.angle, result.ring.gap

    def cold(self, row, separation=0.0, start=(COLD, 0.0, 0.0, 0.0, 0.0, 0.0), net=None):
        points = self.net if net is None else net
        args = points, row, np.array(start), self.samples, separation, self.scratch, self.result, self.out
        return search(*self.arrays[:3], *args)

    def least_gap(self, row):
        """Least height of points of the ring over the nearest samples of the surface."""
        u, v = np.linspace(0, 1, 121), np.linspace(0, 1, 91)
        points, normals = self(u, v), np.cross(self(u, v, (1, 0)), self(u, v, (0, 1)))
        normals /= np.linalg.norm(normals, axis=2)[..., None]
        points, normals = points.reshape(-1, 3), normals.reshape(-1, 3)
        best = math.inf
        for phi in np.linspace(0, 2 * math.pi, 361):
            x = on_ring(row, phi)
            k = np.argmin(np.sum((points - x) ** 2, axis=1))
            best = min(best, normals[k] @ (x - points[k]))
        return best


def on_ring(row, phi):
    axes = row.axes
    return row.centre + row.sizes[0] * (math.cos(phi) * axes[:, 0] + math.sin(phi) * axes[:, 1])


def ring(radius, centre, rotation, thickness=0.0):
    row = shape_row(RING, (radius,), thickness)
    row.centre[:] = centre
    row.axes[:] = rotation
    return row


def field(seed, height):
    su, sv = clamped_space(3, np.arange(1, 8) / 8), clamped_space(3, np.arange(1, 6) / 6)
    x, y = np.meshgrid(np.linspace(-1, 1, su.count), np.linspace(-1, 1, sv.count), indexing="ij")
    z = height * np.random.default_rng(seed).standard_normal(x.shape)
    return Surface((su, sv), np.stack([x, y, z], -1))


def tube(radius, count=32):
    """Closed in u; the control points that make a circle of this radius to 1e-6."""
    su, sv = closed_space(3, np.arange(count) / count), clamped_space(3, np.arange(1, 5) / 5)
    angle, z = np.meshgrid(2 * np.pi * np.arange(count) / count, np.linspace(-1, 1, sv.count), indexing="ij")
    r = radius * 3.0 / (2.0 + math.cos(2 * np.pi / count))
    return Surface((su, sv), np.stack([r * np.cos(angle), r * np.sin(angle), z], -1))


@pytest.mark.parametrize("height", [0.3, 0.02])
def test_a_tilted_ring_over_a_plane(height):
    surface = field(0, 0.0)
    tilt, turn = 0.4, 0.7
    rotation = Rotation.from_euler("zyx", [turn, tilt, 0.0]).as_matrix()
    row = ring(0.25, np.array([0.1, -0.2, height]), rotation, thickness=0.01)
    assert surface.cold(row) == CONVERGED
    # the lowest point, below the plane if the centre is low: gap c_z - R sin(tilt) - thickness
    assert surface.result.ring.gap == pytest.approx(height - 0.25 * math.sin(tilt) - 0.01, abs=1e-13)
    assert on_ring(row, surface.result.ring.angle)[2] == pytest.approx(
        height - 0.25 * math.sin(tilt), abs=1e-13
    )
    assert surface.result.flags == 0


def test_a_ring_flat_over_a_plane_is_degenerate():
    surface = field(0, 0.0)
    assert surface.cold(ring(0.25, np.array([0.0, 0.0, 0.1]), np.eye(3))) == CONVERGED
    assert surface.result.ring.gap == pytest.approx(0.1, abs=1e-13)
    assert surface.result.flags & DEGENERATE


@pytest.mark.parametrize("shift", [0.05, 0.25])
def test_an_eyelet_about_a_tube(shift):
    # ring of radius 0.5 about a tube of 0.3, out of centre by 0.05 (free) and 0.25 (cut)
    surface = tube(0.3)
    direction = np.array([math.cos(0.3), math.sin(0.3), 0.0])
    assert surface.cold(ring(0.5, shift * direction, np.eye(3))) == CONVERGED
    assert surface.result.ring.gap == pytest.approx(0.5 - shift - 0.3, abs=5e-6)
    assert on_ring(ring(0.5, shift * direction, np.eye(3)), surface.result.ring.angle) == pytest.approx(
        (shift - 0.5) * direction, abs=1e-4
    )


def test_random_rings_over_a_wavy_field():
    generator = np.random.default_rng(5)
    surface = field(3, 0.06)
    penetrating = 0
    for _ in range(12):
        centre = np.array([*generator.uniform(-0.5, 0.5, 2), generator.uniform(0.05, 0.5)])
        row = ring(0.35, centre, Rotation.random(random_state=generator.integers(1 << 30)).as_matrix())
        assert surface.cold(row) == CONVERGED
        expected = surface.least_gap(row)
        penetrating += expected < 0.0
        # heights of samples 2 cm apart: off by their distance squared
        assert surface.result.ring.gap == pytest.approx(expected, abs=6e-4)
        if surface.result.flags & BORDER == 0:
            # stationary: x - S along the normal, and the normal across the ring
            phi = surface.result.ring.angle
            w = on_ring(row, phi) - surface.result.position
            assert np.abs(np.stack([surface.result.tangent_u, surface.result.tangent_v]) @ w).max() < 1e-10
            n = np.cross(surface.result.tangent_u, surface.result.tangent_v)
            n /= np.linalg.norm(n)
            along = on_ring(row, phi + 1e-4) - on_ring(row, phi - 1e-4)
            assert abs(n @ along) < 1e-9 * 2e-4
    assert 2 <= penetrating <= 10


def test_a_warm_ring_is_short_and_keeps_to_its_window():
    surface = field(3, 0.06)
    row = ring(0.35, np.array([0.1, 0.1, 0.3]), Rotation.from_euler("xy", [1.3, 0.2]).as_matrix())
    assert surface.cold(row) == CONVERGED
    u, v, phi = surface.place()[:3]
    row.centre[:2] += 1e-3
    assert surface.cold(row, start=(WARM, u, v, phi, -1, -1)) == CONVERGED
    assert surface.result.ring.evaluations <= 14
    whole = surface.place()
    net = np.full_like(surface.net, np.nan)
    task, span = WARM, (0, 0)
    while surface.cold(row, start=(task, u, v, phi, *span), net=net) == NEED_SPAN:
        task, span = GO_ON, (surface.result.span_u, surface.result.span_v)
        rows = [np.arange(s - 3, s + 1) for s in span]
        wanted = (rows[0][:, None] * surface.spaces[1].count + rows[1]).ravel()
        net[:] = np.nan
        net[wanted] = surface.net[wanted]
    assert task == GO_ON
    assert surface.place() == whole


def test_two_contacts_of_a_ring_are_reported():
    # an upright wheel across a channel z = 2 x^2 touches both sides
    su, sv = clamped_space(3, np.arange(1, 10) / 10), clamped_space(3, np.array([0.5]))
    knots = [np.array([np.mean(s.knots[i + 1 : i + 4]) for i in range(s.count)]) for s in (su, sv)]
    x, y = np.meshgrid(2 * knots[0] - 1, 2 * knots[1] - 1, indexing="ij")
    surface = Surface((su, sv), np.stack([x, y, 2.0 * x**2], -1))
    row = ring(0.4, np.array([0.0, 0.0, 0.45]), Rotation.from_euler("x", math.pi / 2).as_matrix())
    assert surface.cold(row, separation=1e-6) == CONVERGED
    assert surface.result.flags & TWIN
    assert surface.result.other_distance == pytest.approx(surface.result.ring.gap, abs=1e-9)
    assert abs(surface.result.position[0]) > 0.1


def test_distance_of_a_ring_to_a_curve():
    generator = np.random.default_rng(6)
    space = clamped_space(3, np.arange(1, 8) / 8)
    t = np.linspace(0, 1, space.count)
    control = np.stack([2 * t - 1, 0.3 * np.sin(5 * t), 0.2 * np.cos(4 * t)], -1)
    surface = Surface((space,), control)
    line = surface(np.linspace(0, 1, 20001))
    for _ in range(20):
        rotation = Rotation.random(random_state=generator.integers(1 << 30)).as_matrix()
        row = ring(0.3, generator.uniform(-0.6, 0.6, 3), rotation)
        assert surface.cold(row) == CONVERGED
        local = (line - row.centre) @ row.axes
        expected = np.min(np.hypot(np.hypot(local[:, 0], local[:, 1]) - 0.3, local[:, 2]))
        assert surface.out[0] <= expected + 1e-12
        assert surface.out[0] == pytest.approx(expected, abs=1e-4)
