"""Deepest point of a thin ring over a surface: the least signed gap along the ring.

A ring that penetrates a surface crosses it at two points of zero distance; the contact lies between them, where the
gap along the normal of the surface is least. So the gap of the closest surface point is minimised over the angle phi
of the ring, by a trust-region Newton method about the search of `heavylift.contours.search`; the closest point follows
the angle by its own derivative, so it costs one or two evaluations an angle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.search import ROUNDING, closest_on_surface, signed_gap
from heavylift.contours.search_step import (
    ABOVE_U,
    ABOVE_V,
    BELOW_U,
    BELOW_V,
    BORDER,
    CONVERGED,
    DEGENERATE,
    FLAGS,
    ITERATIONS,
    NOT_CONVERGED,
    TOLERANCE,
    U,
    V,
    start_search,
)
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.convex import Primitive

__all__ = [
    "RING_GAP",
    "RING_ITERATIONS",
    "RING_PHI",
    "ring_gap_slopes",
    "ring_on_surface",
    "ring_point",
    "start_ring",
]

RING_PHI, RING_GAP, RING_ITERATIONS = 43, 44, 45
"""Columns of a result: angle of the ring [rad], gap there [m], evaluations of the surface."""

_STAGE, _TRIAL_PHI, _SLOPE, _CURVATURE, _REGION, _STEP, _PREDICTED, _U, _V, _DU, _DV, _ANGLES = range(46, 58)

_LARGEST_ANGLES = 60
_FIRST_REGION = 0.3


@kernel(inline=True, internal=True)
def start_ring(contour: NDArray, u: float, v: float, phi: float, result: NDArray) -> None:
    """Begin a new search at parameters of the surface and an angle of the ring."""
    start_search(contour, u, v, result)
    result[_STAGE] = 0.0
    result[_TRIAL_PHI] = phi
    result[_ANGLES] = 0.0
    result[RING_ITERATIONS] = 0.0


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
    shape: Primitive, phi: float, result: NDArray
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
    a1, a2, a3 = result[3], result[4], result[5]
    b1, b2, b3 = result[6], result[7], result[8]
    w1 = x - result[0]
    w2 = y - result[1]
    w3 = z - result[2]
    E = a1 * a1 + a2 * a2 + a3 * a3
    F = a1 * b1 + a2 * b2 + a3 * b3
    G = b1 * b1 + b2 * b2 + b3 * b3
    h_uu = E - (w1 * result[9] + w2 * result[10] + w3 * result[11])
    h_uv = F - (w1 * result[12] + w2 * result[13] + w3 * result[14])
    h_vv = G - (w1 * result[15] + w2 * result[16] + w3 * result[17])
    t_u = a1 * d1 + a2 * d2 + a3 * d3
    t_v = b1 * d1 + b2 * d2 + b3 * d3
    flags = int(result[FLAGS])
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
    L = n1 * result[9] + n2 * result[10] + n3 * result[11]
    M = n1 * result[12] + n2 * result[13] + n3 * result[14]
    N = n1 * result[15] + n2 * result[16] + n3 * result[17]
    area = E * G - F * F
    alpha = (G * t_u - F * t_v) / area  # tangential part of x' = alpha S_u + beta S_v
    beta = (E * t_v - F * t_u) / area
    turn = alpha * (L * du + M * dv) + beta * (M * du + N * dv)
    return g, n1 * d1 + n2 * d2 + n3 * d3, -turn - (n1 * r1 + n2 * r2 + n3 * r3), du, dv


@kernel(internal=True)
def ring_on_surface(
    contour: NDArray,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    shape: Primitive,
    span_u: int,
    span_v: int,
    scratch: NDArray,
    result: NDArray,
) -> int:
    """Go on with the search for a local minimum of the gap of a ring to a surface.

    Parameters
    ----------
    shape
        Row of the ring, its centre and axes in those of the contour.
    contour, knots, weights, net, span_u, span_v, scratch, result
        As of `heavylift.contours.search.closest_on_surface`; begun by `start_ring`.

    Returns
    -------
    Status as there. When converged, RING_PHI and RING_GAP (less the radius about the ring) of the result are
    written, and the rest is that of the closest point of the surface to this point of the ring. DEGENERATE also means
    that the gap hardly changes along the ring.
    """
    while True:
        trial = result[_TRIAL_PHI]
        r1, r2, r3, _, _, _ = ring_point(shape, trial)
        x = shape.centre[0] + r1
        y = shape.centre[1] + r2
        z = shape.centre[2] + r3
        status = closest_on_surface(contour, knots, weights, net, x, y, z, span_u, span_v, scratch, result)
        if status != CONVERGED:
            return status
        result[RING_ITERATIONS] += result[ITERATIONS]
        result[_ANGLES] += 1.0
        g, slope, curvature, du, dv = ring_gap_slopes(shape, trial, result)
        stage = result[_STAGE]
        region = _FIRST_REGION
        last = math.inf
        accepted = True
        size = abs(x) + abs(y) + abs(z) + abs(result[0]) + abs(result[1]) + abs(result[2])
        noise = ROUNDING * (size + shape.sizes[0])
        if stage == 1.0:
            region = result[_REGION]
            last = result[_STEP]
            before = result[RING_GAP] + shape.radius
            predicted = result[_PREDICTED]
            if predicted > noise:
                ratio = (before - g) / predicted
                accepted = ratio > 1e-4
                if ratio < 0.25:
                    region = 0.25 * last
                elif ratio > 0.75 and last > 0.99 * region:
                    region = min(2.0 * region, 1.0)
            else:
                accepted = g <= before + 2.0 * noise
        if stage != 2.0:
            if accepted:
                result[RING_PHI] = trial
                result[RING_GAP] = g - shape.radius
                result[_SLOPE] = slope
                result[_CURVATURE] = curvature
                result[_U] = result[U]
                result[_V] = result[V]
                result[_DU] = du
                result[_DV] = dv
            slope = result[_SLOPE]
            curvature = result[_CURVATURE]
            step = -slope / curvature if curvature > 0.0 else math.copysign(region, -slope)
            step = min(max(step, -region), region)
            decrease = -(slope + 0.5 * curvature * step) * step
            lost = decrease <= noise and (not accepted or abs(step) > 0.5 * last or abs(step) > 1e-3)
            if not (abs(step) <= TOLERANCE or lost or region < 1e-14):
                if result[_ANGLES] >= _LARGEST_ANGLES:
                    return NOT_CONVERGED
                result[_TRIAL_PHI] = result[RING_PHI] + step
                result[_STEP] = abs(step)
                result[_PREDICTED] = decrease
                result[_REGION] = region
                result[_STAGE] = 1.0
                u = result[_U] + result[_DU] * step
                start_search(contour, u, result[_V] + result[_DV] * step, result)
                continue
            if not accepted:  # back to the closest point of the angle that was kept
                result[_TRIAL_PHI] = result[RING_PHI]
                result[_STAGE] = 2.0
                start_search(contour, result[_U], result[_V], result)
                continue
        if not result[_CURVATURE] > 1e-9 * shape.sizes[0]:
            result[FLAGS] = float(int(result[FLAGS]) | DEGENERATE)
        return CONVERGED
