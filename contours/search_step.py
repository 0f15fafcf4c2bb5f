"""One step of a search over contour parameters: a trust-region Newton method on a rectangle, by reverse communication.

The searches minimise a function of the parameters (u, v) of a contour, half a squared distance. They evaluate it where
`step_search` asks, with first and second derivatives, and hand the values back. All that is known between two
evaluations stands in the array `result`, so a search can be left at any evaluation, for control points that its caller
must form first, and taken up again.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.basis import wrap
from heavylift.contours.layout import CLOSED_U, CLOSED_V, COUNT_U, COUNT_V, DEGREE_U, DEGREE_V
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "ABOVE_U",
    "ABOVE_V",
    "BEHIND",
    "BELOW_U",
    "BELOW_V",
    "BORDER",
    "CONVERGED",
    "DEEP",
    "DEGENERATE",
    "DISTANCE_SQUARED",
    "EVALUATE",
    "FLAGS",
    "ITERATIONS",
    "LARGEST_ITERATIONS",
    "NEED_SPAN",
    "NOT_CONVERGED",
    "NOT_FINITE",
    "OTHER_DISTANCE",
    "OTHER_U",
    "OTHER_V",
    "RESULT_WIDTH",
    "SPAN_U",
    "SPAN_V",
    "TOLERANCE",
    "TRIAL_U",
    "TRIAL_V",
    "TWIN",
    "U",
    "V",
    "least_quadratic",
    "start_search",
    "step_search",
]

CONVERGED, NEED_SPAN, NOT_CONVERGED, NOT_FINITE = range(4)
"""How a search returns: at a local minimum; control points of the spans in SPAN_U, SPAN_V are to be formed before the
search goes on; after too many evaluations; a value is not finite."""

EVALUATE = -1
"""Of `step_search`: the next place to evaluate is (TRIAL_U, TRIAL_V)."""

U, V, DISTANCE_SQUARED, FLAGS, ITERATIONS, SPAN_U, SPAN_V, OTHER_U, OTHER_V, OTHER_DISTANCE = range(18, 28)
"""Columns of a result after the 18 numbers of the evaluation at (u, v): parameters, squared distance, flags as a float
that holds a whole number, evaluations so far, spans that are wanted; parameters and distance of a second minimum."""

TRIAL_U, TRIAL_V = 28, 29
_STAGE, _VALUE, _G_U, _G_V, _H_UU, _H_UV, _H_VV, _RADIUS, _PREDICTED, _STEP, _SMALL, _END, _FLAGS = range(
    30, 43
)
RESULT_WIDTH = 72
"""Of the array of a search; the searches over angles of a ring and over samples keep theirs behind column 43."""

_START, _TRIAL, _RESTORE = 0.0, 1.0, 2.0
"""What the next evaluation is: the first one, that of a trial step, or again that of the accepted point."""

BELOW_U, ABOVE_U, BELOW_V, ABOVE_V, DEGENERATE, TWIN, BEHIND, DEEP = 1, 2, 4, 8, 16, 32, 64, 128
"""Flags of a result. The first four: the point is held by this border of the patch, beyond which the distance would
fall further. DEGENERATE: the distance has no definite minimum here (centre of curvature, flat face on a flat surface).
TWIN: OTHER_* is a second minimum within the separation asked for. BEHIND: the primitive lies on the inner side.
DEEP: the surface has reached the core of a primitive, where the gap has no normal any more."""

BORDER = BELOW_U | ABOVE_U | BELOW_V | ABOVE_V

TOLERANCE = 1e-12
"""Of both parameters, whose range is 1."""

LARGEST_ITERATIONS = 100

_ACCEPTED = 1e-4
_SMALLEST_CURVATURE = 1e-9
"""Relative to the squared tangents; below it a minimum is called degenerate."""


@kernel(inline=True, internal=True)
def start_search(contour: NDArray, u: float, v: float, result: NDArray) -> None:
    """Begin a new search at some parameters, brought into the patch; ``v = 0`` of a curve."""
    result[TRIAL_U] = wrap(u, contour[CLOSED_U] == 1)
    result[TRIAL_V] = wrap(v, contour[CLOSED_V] == 1)
    result[_STAGE] = _START
    result[ITERATIONS] = 0.0
    result[FLAGS] = 0.0
    result[OTHER_DISTANCE] = math.inf


@kernel(inline=True, internal=True)
def _least_on_edge(slope: float, curvature: float, low: float, high: float) -> float:
    """Where ``slope x + curvature x^2 / 2`` is least on an interval."""
    if curvature > 0.0:
        return min(max(-slope / curvature, low), high)
    if slope * low + 0.5 * curvature * low * low <= slope * high + 0.5 * curvature * high * high:
        return low
    return high


@kernel(internal=True)
def least_quadratic(
    g_u: float,
    g_v: float,
    h_uu: float,
    h_uv: float,
    h_vv: float,
    low_u: float,
    high_u: float,
    low_v: float,
    high_v: float,
) -> tuple[float, float, float]:
    """Global minimum of ``g.d + d.H d / 2`` over a rectangle about 0, of any signs of H.

    An interior minimum needs H positive definite; every other minimum lies on one of four edges, where the function is
    a parabola.

    Returns
    -------
    du, dv, decrease
        The step and by how much the function falls, not negative.
    """
    determinant = h_uu * h_vv - h_uv * h_uv
    if h_uu > 0.0 and h_vv > 0.0 and determinant > 1e-14 * h_uu * h_vv:
        du = (h_uv * g_v - h_vv * g_u) / determinant
        dv = (h_uv * g_u - h_uu * g_v) / determinant
        if low_u <= du <= high_u and low_v <= dv <= high_v:
            return du, dv, -0.5 * (g_u * du + g_v * dv)
    best_u = 0.0
    best_v = 0.0
    best = 0.0
    for edge in range(4):
        if edge < 2:
            du = low_u if edge == 0 else high_u
            dv = _least_on_edge(g_v + h_uv * du, h_vv, low_v, high_v)
        else:
            dv = low_v if edge == 2 else high_v
            du = _least_on_edge(g_u + h_uv * dv, h_uu, low_u, high_u)
        value = g_u * du + g_v * dv + 0.5 * (h_uu * du * du + h_vv * dv * dv) + h_uv * du * dv
        if value < best:
            best = value
            best_u = du
            best_v = dv
    return best_u, best_v, -best


@kernel(inline=True, internal=True)
def _held(
    u: float, v: float, g_u: float, g_v: float, open_u: bool, open_v: bool, floor_u: float, floor_v: float
) -> int:
    """Flags of the borders that hold a point: on them, to the tolerance, with the function falling outwards."""
    flags = 0
    if open_u:
        if u <= TOLERANCE and g_u > floor_u:
            flags |= BELOW_U
        elif u >= 1.0 - TOLERANCE and g_u < -floor_u:
            flags |= ABOVE_U
    if open_v:
        if v <= TOLERANCE and g_v > floor_v:
            flags |= BELOW_V
        elif v >= 1.0 - TOLERANCE and g_v < -floor_v:
            flags |= ABOVE_V
    return flags


@kernel(inline=True, internal=True)
def _indefinite(h_uu: float, h_uv: float, h_vv: float, a: float, b: float, flags: int) -> bool:
    """Whether H, scaled by the squared tangents a and b, is not clearly positive definite where no border holds."""
    free_u = flags & (BELOW_U | ABOVE_U) == 0
    free_v = flags & (BELOW_V | ABOVE_V) == 0
    if free_u and not h_uu > _SMALLEST_CURVATURE * a:
        return True
    if free_v and not h_vv > _SMALLEST_CURVATURE * b:
        return True
    return free_u and free_v and not h_uu * h_vv - h_uv * h_uv > _SMALLEST_CURVATURE * h_uu * h_vv


@kernel(internal=True)
def step_search(
    contour: NDArray,
    f: float,
    g_u: float,
    g_v: float,
    h_uu: float,
    h_uv: float,
    h_vv: float,
    resolution: float,
    result: NDArray,
) -> int:
    """Take the values at the trial point and choose what to evaluate next.

    Parameters
    ----------
    contour
        Packed row.
    f, g_u, g_v, h_uu, h_uv, h_vv
        Half the squared distance at (TRIAL_U, TRIAL_V), its gradient and its second derivatives; of a curve
        ``g_v = h_uv = 0, h_vv = 1``.
    resolution
        Rounding error of a difference of positions [m].
    result
        The tangents of the evaluation in columns 3:9, and the state of the search.

    Returns
    -------
    EVALUATE, CONVERGED, NOT_CONVERGED or NOT_FINITE; but for EVALUATE the result is complete.

    Notes
    -----
    The trust region is a rectangle of `radius` knot spans, so that its intersection with the patch is one too, and the
    quadratic model is minimised over it exactly: saddles are left, borders are found with the condition of Karush,
    Kuhn and Tucker, and Newton's method takes over at the minimum. Conn, Gould, Toint, Trust-Region Methods, 2000,
    algorithm 6.1.1. Changes of f below its rounding error are not judged: the last steps, which only gradients can
    see, are taken as long as they halve.
    """
    open_u = contour[CLOSED_U] == 0
    open_v = contour[CLOSED_V] == 0 and contour[DEGREE_V] > 0
    stage = result[_STAGE]
    result[ITERATIONS] += 1.0
    if stage == _RESTORE:
        result[FLAGS] = result[_FLAGS]
        return int(result[_END])
    if not (math.isfinite(f) and math.isfinite(g_u + g_v) and math.isfinite(h_uu + h_uv + h_vv)):
        return NOT_FINITE
    radius = 1.0
    small = 0.0
    last = math.inf
    accepted = True
    if stage == _TRIAL:
        radius = result[_RADIUS]
        small = result[_SMALL]
        last = result[_STEP]
        predicted = result[_PREDICTED]
        before = result[_VALUE]
        noise = resolution * (math.sqrt(2.0 * before) + resolution)
        if predicted > noise:
            ratio = (before - f) / predicted
            accepted = ratio > _ACCEPTED
            if ratio < 0.25:
                radius = 0.25 * last
            elif ratio > 0.75 and last > 0.99 * radius:
                radius *= 2.0
        else:
            small += 1.0
            accepted = f <= before + 20.0 * noise
    u = result[U]
    v = result[V]
    if accepted:
        u = result[TRIAL_U]
        v = result[TRIAL_V]
        result[U] = u
        result[V] = v
        result[DISTANCE_SQUARED] = 2.0 * f
        result[_VALUE] = f
        result[_G_U] = g_u
        result[_G_V] = g_v
        result[_H_UU] = h_uu
        result[_H_UV] = h_uv
        result[_H_VV] = h_vv
    else:
        f = result[_VALUE]
        g_u = result[_G_U]
        g_v = result[_G_V]
        h_uu = result[_H_UU]
        h_uv = result[_H_UV]
        h_vv = result[_H_VV]

    width_u = 1.0 / (contour[COUNT_U] if not open_u else contour[COUNT_U] - contour[DEGREE_U])
    width_v = 0.0
    if contour[DEGREE_V] > 0:
        width_v = 1.0 / (contour[COUNT_V] if not open_v else contour[COUNT_V] - contour[DEGREE_V])
    low_u = -radius * width_u
    high_u = -low_u
    low_v = -radius * width_v
    high_v = -low_v
    if open_u:
        low_u = max(low_u, -u)
        high_u = min(high_u, 1.0 - u)
    if open_v:
        low_v = max(low_v, -v)
        high_v = min(high_v, 1.0 - v)
    du, dv, decrease = least_quadratic(g_u, g_v, h_uu, h_uv, h_vv, low_u, high_u, low_v, high_v)

    a = result[3] * result[3] + result[4] * result[4] + result[5] * result[5]
    b = 1.0
    if contour[DEGREE_V] > 0:
        b = result[6] * result[6] + result[7] * result[7] + result[8] * result[8]
    step = max(abs(du) / width_u, abs(dv) / width_v if width_v > 0.0 else 0.0)
    noise = resolution * (math.sqrt(2.0 * f) + resolution)
    exact = abs(du) <= TOLERANCE and abs(dv) <= TOLERANCE
    exact = exact or (du * du * a <= resolution * resolution and dv * dv * b <= resolution * resolution)
    flags = 0
    lost = radius < 1e-14
    if exact or lost or decrease <= noise:
        floor = resolution + 1e-13 * math.sqrt(2.0 * f)
        flags = _held(u, v, g_u, g_v, open_u, open_v, floor * math.sqrt(a), floor * math.sqrt(b))
        if _indefinite(h_uu, h_uv, h_vv, a, b, flags):
            flags |= DEGENERATE
        lost = lost or not accepted or small >= 4.0 or step > 0.5 * last or flags & DEGENERATE != 0
    end = CONVERGED
    if not (exact or lost):
        if result[ITERATIONS] < LARGEST_ITERATIONS:
            trial_u = u + du
            trial_v = v + dv
            # a step to the border must reach it exactly
            result[TRIAL_U] = 1.0 if open_u and du >= 1.0 - u else wrap(trial_u, not open_u)
            result[TRIAL_V] = 1.0 if open_v and dv >= 1.0 - v else wrap(trial_v, contour[CLOSED_V] == 1)
            result[_RADIUS] = radius
            result[_SMALL] = small
            result[_STEP] = step
            result[_PREDICTED] = decrease
            result[_STAGE] = _TRIAL
            return EVALUATE
        end = NOT_CONVERGED
    result[FLAGS] = flags
    if accepted:
        return end
    result[_END] = end  # the evaluation at hand is that of a step that was refused
    result[_FLAGS] = flags
    result[TRIAL_U] = u
    result[TRIAL_V] = v
    result[_STAGE] = _RESTORE
    return EVALUATE
