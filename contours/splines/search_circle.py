"""Deepest point of a thin ring over a surface: the least signed gap along the ring.

A ring that penetrates a surface crosses it at two points of zero distance; the contact lies between them, where the
gap along the normal of the surface is least. So the gap of the closest surface point is minimised over the angle phi
of the ring, by a trust-region Newton method about the search of `contours.splines.search`; the closest point follows
the angle by its own derivative, so it costs one or two evaluations an angle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.samples import RING_ANGLES
from heavylift.contours.splines.search import ROUNDING, closest_on_surface, signed_gap
from heavylift.contours.splines.search_cold import (
    AGAIN,
    NO_START,
    begin_starts,
    closest_point_cold,
    next_start,
)
from heavylift.contours.splines.search_step import (
    ABOVE_U,
    ABOVE_V,
    BELOW_U,
    BELOW_V,
    BORDER,
    CONVERGED,
    DEGENERATE,
    NOT_CONVERGED,
    NOT_FINITE,
    TOLERANCE,
    start_search,
)
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.convex import Primitive
    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.samples import SampleGrid, Samples
    from heavylift.contours.splines.search_step import ContourSearch

__all__ = ["ring_cold", "ring_gap_slopes", "ring_on_surface", "ring_point", "start_ring"]

_LARGEST_ANGLES = 60
_FIRST_REGION = 0.3


@kernel(inline=True, internal=True)
def start_ring(contour: PackedContour, u: float, v: float, phi: float, result: ContourSearch) -> None:
    """Begin a new search at parameters of the surface and an angle of the ring."""
    start_search(contour, u, v, result)
    ring = result.ring
    ring.stage = 0
    ring.trial_angle = phi
    ring.angles = 0
    ring.evaluations = 0


@kernel(inline=True, internal=True)
def ring_point(shape: Primitive, phi: float) -> tuple[float, float, float, float, float, float]:
    """Point of the ring's circle at an angle from its first axis, from the centre of the ring, and derivative by it.

    Returns
    -------
    r1, r2, r3, d1, d2, d3
        ``R (cos phi e_1 + sin phi e_2)`` [m] and its derivative; the second derivative is ``-r``.
    """
    radius = shape.sizes[0]
    c = radius * math.cos(phi)
    s = radius * math.sin(phi)
    e1, e2, e3 = shape.axes[0, 0], shape.axes[1, 0], shape.axes[2, 0]
    f1, f2, f3 = shape.axes[0, 1], shape.axes[1, 1], shape.axes[2, 1]
    return (
        c * e1 + s * f1,
        c * e2 + s * f2,
        c * e3 + s * f3,
        c * f1 - s * e1,
        c * f2 - s * e2,
        c * f3 - s * e3,
    )


@kernel(internal=True)
def ring_gap_slopes(
    shape: Primitive, phi: float, result: ContourSearch
) -> tuple[float, float, float, float, float]:
    """Signed gap of a point of the ring to its closest point of the surface, and how both change with the angle.

    Parameters
    ----------
    shape
        Row of the ring.
    phi
        Angle [rad].
    result
        Converged search for that point.

    Returns
    -------
    g, slope, curvature, du, dv
        Gap of the ring's circle [m], its derivatives by phi, and those of the parameters of the surface.

    Notes
    -----
    With ``w = x - S`` the closest point obeys ``(S_a.S_b - w.S_ab) p_b' = S_a.x'``. Inside of the patch ``g = n.w``,
    ``g' = n.x'`` and ``g'' = n'.x' + n.x''``, the normal turning by Weingarten's equations. Where a border holds the
    point, the gap is the distance, ``m = w / |w|``, ``g' = m.x'``, ``g'' = x'.(I - m m^T)(x' - S') / g + m.x''``:
    what passes beyond the border does not penetrate the patch.
    """
    r1, r2, r3, d1, d2, d3 = ring_point(shape, phi)
    x = shape.centre[0] + r1
    y = shape.centre[1] + r2
    z = shape.centre[2] + r3
    a1, a2, a3 = result.tangent_u[0], result.tangent_u[1], result.tangent_u[2]
    b1, b2, b3 = result.tangent_v[0], result.tangent_v[1], result.tangent_v[2]
    uu, uv, vv = result.derivative_uu, result.derivative_uv, result.derivative_vv
    w1 = x - result.position[0]
    w2 = y - result.position[1]
    w3 = z - result.position[2]
    E = a1 * a1 + a2 * a2 + a3 * a3
    F = a1 * b1 + a2 * b2 + a3 * b3
    G = b1 * b1 + b2 * b2 + b3 * b3
    h_uu = E - (w1 * uu[0] + w2 * uu[1] + w3 * uu[2])
    h_uv = F - (w1 * uv[0] + w2 * uv[1] + w3 * uv[2])
    h_vv = G - (w1 * vv[0] + w2 * vv[1] + w3 * vv[2])
    t_u = a1 * d1 + a2 * d2 + a3 * d3
    t_v = b1 * d1 + b2 * d2 + b3 * d3
    flags = result.flags
    free_u = flags & (BELOW_U | ABOVE_U) == 0
    free_v = flags & (BELOW_V | ABOVE_V) == 0
    du = 0.0
    dv = 0.0
    if free_u and free_v:
        determinant = h_uu * h_vv - h_uv * h_uv
        if determinant != 0.0:
            du = (h_vv * t_u - h_uv * t_v) / determinant
            dv = (h_uu * t_v - h_uv * t_u) / determinant
    elif free_u and h_uu != 0.0:
        du = t_u / h_uu
    elif free_v and h_vv != 0.0:
        dv = t_v / h_vv
    if flags & BORDER != 0:
        g = math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
        m1, m2, m3 = w1 / g, w2 / g, w3 / g
        slope = m1 * d1 + m2 * d2 + m3 * d3
        p1 = d1 - slope * m1
        p2 = d2 - slope * m2
        p3 = d3 - slope * m3
        turn = p1 * (d1 - a1 * du - b1 * dv) + p2 * (d2 - a2 * du - b2 * dv) + p3 * (d3 - a3 * du - b3 * dv)
        return g, slope, turn / g - (m1 * r1 + m2 * r2 + m3 * r3), du, dv
    g, n1, n2, n3 = signed_gap(x, y, z, result)
    L = n1 * uu[0] + n2 * uu[1] + n3 * uu[2]
    M = n1 * uv[0] + n2 * uv[1] + n3 * uv[2]
    N = n1 * vv[0] + n2 * vv[1] + n3 * vv[2]
    area = E * G - F * F
    alpha = (G * t_u - F * t_v) / area  # tangential part of x' = alpha S_u + beta S_v
    beta = (E * t_v - F * t_u) / area
    turn = alpha * (L * du + M * dv) + beta * (M * du + N * dv)
    return g, n1 * d1 + n2 * d2 + n3 * d3, -turn - (n1 * r1 + n2 * r2 + n3 * r3), du, dv


@kernel(internal=True)
def ring_on_surface(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    shape: Primitive,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Continue with the search for a local minimum of the gap of a ring to a surface.

    Parameters
    ----------
    shape
        Row of the ring, its centre and axes in those of the contour.
    contour, knots, weights, net, scratch, result
        As of `heavylift.contours.splines.search.closest_on_surface`; begun by `start_ring`.

    Returns
    -------
    Status as there. When converged, `angle` and `gap` (less the radius about the ring) of the ring of the result are
    written, and the rest is that of the closest point of the surface to this point of the ring. DEGENERATE also means
    that the gap hardly changes along the ring.
    """
    ring, s = result.ring, result.position
    while True:
        trial = ring.trial_angle
        r1, r2, r3, _, _, _ = ring_point(shape, trial)
        x = shape.centre[0] + r1
        y = shape.centre[1] + r2
        z = shape.centre[2] + r3
        status = closest_on_surface(contour, knots, weights, net, (x, y, z), scratch, result)
        if status != CONVERGED:
            return status
        ring.evaluations += result.iterations
        ring.angles += 1
        g, slope, curvature, du, dv = ring_gap_slopes(shape, trial, result)
        stage = ring.stage
        region = _FIRST_REGION
        last = math.inf
        accepted = True
        size = abs(x) + abs(y) + abs(z) + abs(s[0]) + abs(s[1]) + abs(s[2])
        noise = ROUNDING * (size + shape.sizes[0])
        if stage == 1:
            region = ring.region
            last = ring.step
            before = ring.gap + shape.radius
            predicted = ring.predicted
            if predicted > noise:
                ratio = (before - g) / predicted
                accepted = ratio > 1e-4
                if ratio < 0.25:
                    region = 0.25 * last
                elif ratio > 0.75 and last > 0.99 * region:
                    region = min(2.0 * region, 1.0)
            else:
                accepted = g <= before + 2.0 * noise
        if stage != 2:
            if accepted:
                ring.angle = trial
                ring.gap = g - shape.radius
                ring.slope = slope
                ring.curvature = curvature
                ring.u = result.u
                ring.v = result.v
                ring.du = du
                ring.dv = dv
            slope = ring.slope
            curvature = ring.curvature
            step = -slope / curvature if curvature > 0.0 else math.copysign(region, -slope)
            step = min(max(step, -region), region)
            decrease = -(slope + 0.5 * curvature * step) * step
            lost = decrease <= noise and (not accepted or abs(step) > 0.5 * last or abs(step) > 1e-3)
            if not (abs(step) <= TOLERANCE or lost or region < 1e-14):
                if ring.angles >= _LARGEST_ANGLES:
                    return NOT_CONVERGED
                ring.trial_angle = ring.angle + step
                ring.step = abs(step)
                ring.predicted = decrease
                ring.region = region
                ring.stage = 1
                u = ring.u + ring.du * step
                start_search(contour, u, ring.v + ring.dv * step, result)
                continue
            if not accepted:  # back to the closest point of the angle that was kept
                ring.trial_angle = ring.angle
                ring.stage = 2
                start_search(contour, ring.u, ring.v, result)
                continue
        if not ring.curvature > 1e-9 * shape.sizes[0]:
            result.flags |= DEGENERATE
        return CONVERGED


@kernel(internal=True)
def ring_cold(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    shape: Primitive,
    samples: Samples,
    grid: SampleGrid,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Least signed gap of a ring to a surface, without a start: from the angles where the gap is least.

    Parameters
    ----------
    shape
        Row of the ring.
    contour, knots, weights, net, samples, grid, scratch, result
        As of `closest_point_cold`.

    Returns
    -------
    Status as there. `other_distance` is the gap of a second minimum along the ring, `other_u`, `other_v` its place.
    """
    n, angles = RING_ANGLES, samples.angles
    turn = 2.0 * math.pi / n
    for k in range(n):
        r1, r2, r3, _, _, _ = ring_point(shape, turn * k)
        point = (shape.centre[0] + r1, shape.centre[1] + r2, shape.centre[2] + r3)
        status = closest_point_cold(contour, knots, weights, net, point, samples, grid, scratch, result)
        if status != CONVERGED:
            return status
        gap = ring_gap_slopes(shape, turn * k, result)[0] - shape.radius
        angles[k] = gap * abs(gap)
        angles[n + k] = result.u
        angles[2 * n + k] = result.v
    # the gap changes by no more than the way along the ring
    begin_starts(n, 1, True, False, 0.5 * turn * shape.sizes[0], result)
    starts = result.starts
    starts.of_ring = True
    status = NOT_FINITE
    k = next_start(contour, angles, status, result)
    while k != NO_START:
        if k == AGAIN:
            start_ring(contour, starts.best_u, starts.best_v, starts.best_angle, result)
        else:
            start_ring(contour, angles[n + k], angles[2 * n + k], turn * k, result)
        status = ring_on_surface(contour, knots, weights, net, shape, scratch, result)
        k = next_start(contour, angles, status, result)
    return status
