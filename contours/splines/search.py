"""Closest point of a contour to a point: one search for surfaces and one for curves, on packed arrays.

"Deformable bodies with complex geometries ... sliding contacts" (2014), section 3.3.

The point is given in the axes of the contour's control points. A search begins with `start_search`, its window with
`set_window`, and it is called until it returns something else than `NEED_SPAN`::

    set_window(contour, knots, u, v, result)
    start_search(contour, u, v, result)
    status = NEED_SPAN
    while status == NEED_SPAN:
        ...                                     # form the control points of `result.span_u, result.span_v` in `net`
        status = closest_on_surface(contour, knots, weights, net, point, scratch, result)

After `open_window` all control points count as formed, and `NEED_SPAN` is never returned. A search may begin with the
window of an earlier one, as long as its control points still hold.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.basis import find_span
from heavylift.contours.splines.evaluate import curve_point, surface_point
from heavylift.contours.splines.search_step import (
    EVALUATE,
    NEED_SPAN,
    step_search,
)
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour, PackedDirection
    from heavylift.contours.splines.search_step import ContourSearch

__all__ = [
    "ROUNDING",
    "closest_on_curve",
    "closest_on_surface",
    "leaves_window",
    "open_window",
    "set_window",
    "signed_gap",
]

ROUNDING = 8.9e-16
"""Of a difference of two positions, relative to their size: four roundings."""


@kernel(inline=True, internal=True)
def _span(direction: PackedDirection, knots: NDArray, t: float) -> int:
    """Knot span of a parameter; 0 across a curve."""
    if direction.degree == 0:
        return 0
    functions = direction.count + (direction.degree if direction.closed else 0)
    return find_span(knots, direction.first_knot, direction.degree, functions, t)


@kernel(inline=True, internal=True)
def set_window(contour: PackedContour, knots: NDArray, u: float, v: float, result: ContourSearch) -> None:
    """Take the knot spans of parameters as those whose control points are formed, or now will be."""
    result.span_u = _span(contour.u, knots, u)
    result.span_v = _span(contour.v, knots, v)


@kernel(inline=True, internal=True)
def open_window(result: ContourSearch) -> None:
    """Take all control points as formed."""
    result.span_u = -1
    result.span_v = -1


@kernel(inline=True, internal=True)
def leaves_window(contour: PackedContour, knots: NDArray, result: ContourSearch) -> bool:
    """Whether the trial point lies outside of the knot spans that are formed; writes those that it needs."""
    span_u, span_v = result.span_u, result.span_v
    if span_u < 0:
        return False
    set_window(contour, knots, result.trial_u, result.trial_v, result)
    return result.span_u != span_u or result.span_v != span_v


@kernel(internal=True)
def closest_on_surface(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    point: tuple[float, float, float],
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Continue with the search for the closest point of a surface.

    Parameters
    ----------
    contour, knots, weights, net
        Packed contour, knots, rational weights, control points [m].
    point
        The point [m].
    scratch
        For the evaluation.
    result
        State and result, begun by `start_search`; its window is that of the control points that are formed.

    Returns
    -------
    CONVERGED, NEED_SPAN, NOT_CONVERGED or NOT_FINITE. When converged, `result` is the evaluation at the point, with
    its parameters, squared distance, flags and number of evaluations.

    Notes
    -----
    With ``r = S - x``: ``f = r.r / 2``, gradient ``r.S_u``, second derivatives ``S_u.S_v + r.S_uv``: Piegl and Tiller,
    The NURBS Book, section 6.1, there without globalisation.
    """
    x, y, z = point
    while True:
        if leaves_window(contour, knots, result):
            return NEED_SPAN
        surface_point(contour, knots, weights, net, result.trial_u, result.trial_v, scratch, result)
        s1, s2, s3 = result.position[0], result.position[1], result.position[2]
        a1, a2, a3 = result.tangent_u[0], result.tangent_u[1], result.tangent_u[2]
        b1, b2, b3 = result.tangent_v[0], result.tangent_v[1], result.tangent_v[2]
        uu, uv, vv = result.derivative_uu, result.derivative_uv, result.derivative_vv
        r1 = s1 - x
        r2 = s2 - y
        r3 = s3 - z
        status = step_search(
            contour,
            0.5 * (r1 * r1 + r2 * r2 + r3 * r3),
            r1 * a1 + r2 * a2 + r3 * a3,
            r1 * b1 + r2 * b2 + r3 * b3,
            a1 * a1 + a2 * a2 + a3 * a3 + r1 * uu[0] + r2 * uu[1] + r3 * uu[2],
            a1 * b1 + a2 * b2 + a3 * b3 + r1 * uv[0] + r2 * uv[1] + r3 * uv[2],
            b1 * b1 + b2 * b2 + b3 * b3 + r1 * vv[0] + r2 * vv[1] + r3 * vv[2],
            ROUNDING * (abs(s1) + abs(s2) + abs(s3) + abs(x) + abs(y) + abs(z)),
            result,
        )
        if status != EVALUATE:
            return status


@kernel(internal=True)
def closest_on_curve(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    point: tuple[float, float, float],
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Continue with the search for the closest point of a curve; as `closest_on_surface` with ``v = 0``."""
    x, y, z = point
    while True:
        if leaves_window(contour, knots, result):
            return NEED_SPAN
        curve_point(contour, knots, weights, net, result.trial_u, scratch, result)
        s1, s2, s3 = result.position[0], result.position[1], result.position[2]
        a1, a2, a3 = result.tangent_u[0], result.tangent_u[1], result.tangent_u[2]
        uu = result.derivative_uu
        r1 = s1 - x
        r2 = s2 - y
        r3 = s3 - z
        status = step_search(
            contour,
            0.5 * (r1 * r1 + r2 * r2 + r3 * r3),
            r1 * a1 + r2 * a2 + r3 * a3,
            0.0,
            a1 * a1 + a2 * a2 + a3 * a3 + r1 * uu[0] + r2 * uu[1] + r3 * uu[2],
            0.0,
            1.0,
            ROUNDING * (abs(s1) + abs(s2) + abs(s3) + abs(x) + abs(y) + abs(z)),
            result,
        )
        if status != EVALUATE:
            return status


@kernel(inline=True, internal=True)
def signed_gap(x: float, y: float, z: float, result: ContourSearch) -> tuple[float, float, float, float]:
    """Gap along the outward normal ``n = S_u x S_v / |S_u x S_v|`` of the evaluation in a result, and the normal.

    Returns
    -------
    g, n1, n2, n3
        ``g = n.(x - S)``, positive on the outer side; a normal of NaN where the tangents are parallel.
    """
    a, b, s = result.tangent_u, result.tangent_v, result.position
    n1 = a[1] * b[2] - a[2] * b[1]
    n2 = a[2] * b[0] - a[0] * b[2]
    n3 = a[0] * b[1] - a[1] * b[0]
    length = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
    n1 /= length
    n2 /= length
    n3 /= length
    return n1 * (x - s[0]) + n2 * (y - s[1]) + n3 * (z - s[2]), n1, n2, n3
