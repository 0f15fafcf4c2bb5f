"""One step of a search over contour parameters: a trust-region Newton method on a rectangle, by reverse communication.

The searches minimise a function of the parameters (u, v) of a contour, half a squared distance. They evaluate it where
`step_search` asks, with first and second derivatives, and hand the values back. All that is known between two
evaluations stands in a `ContourSearch`, so a search can be left at any evaluation, for control points that its caller
must form first, and taken up again.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.basis import wrap
from heavylift.contours.splines.net_sums import Evaluation
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record

if TYPE_CHECKING:
    from heavylift.contours.splines.packed_contour import PackedContour

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
    "EVALUATE",
    "LARGEST_ITERATIONS",
    "NEED_SPAN",
    "NOT_CONVERGED",
    "NOT_FINITE",
    "TOLERANCE",
    "TWIN",
    "ContourSearch",
    "RingSearch",
    "SampleStarts",
    "least_quadratic",
    "start_search",
    "step_search",
]

CONVERGED, NEED_SPAN, NOT_CONVERGED, NOT_FINITE = range(4)
"""How a search returns: at a local minimum; control points of the spans `span_u`, `span_v` are to be formed before the
search continues; after too many evaluations; a value is not finite."""

EVALUATE = -1
"""Of `step_search`: the next place to evaluate is (`trial_u`, `trial_v`)."""


class RingSearch(Record):
    """What the search over the angles of a ring keeps.

    Attributes
    ----------
    angle, gap
        Angle of the ring [rad], and gap there [m].
    evaluations
        Of the surface, for all angles so far.
    stage, angles
        What the angle at hand is, and how many there were.
    trial_angle
        The angle at hand [rad].
    slope, curvature
        Derivatives of the gap by the angle [m].
    region, step, predicted
        Largest step [rad], size of the last one [rad], and by how much the gap should fall [m].
    u, v, du, dv
        Parameters of the surface at `angle`, and their derivatives by it.
    """

    angle: float
    gap: float
    evaluations: int
    stage: int
    angles: int
    trial_angle: float
    slope: float
    curvature: float
    region: float
    step: float
    predicted: float
    u: float
    v: float
    du: float
    dv: float


class SampleStarts(Record):
    """What a search from the samples of a grid keeps.

    Attributes
    ----------
    rows, columns
        Of the grid.
    closed_rows, closed_columns
        Whether its first row, or column, is next to the last one.
    of_ring
        Whether the samples are angles of a ring, and its gap is what is least.
    reach
        Distance within which a minimum may be nearer than the sample that leads to it [m].
    best_u, best_v, best_angle, best
        Parameters, angle of a ring [rad] and distance [m] of the nearest minimum so far.
    second_u, second_v, second
        Parameters and distance of the next one.
    nearest
        Number of the nearest sample.
    next
        Number of the sample from which to continue; -1 before the first, above all when none is left.
    count
        Searches so far.
    """

    rows: int
    columns: int
    closed_rows: bool
    closed_columns: bool
    of_ring: bool
    reach: float
    best_u: float
    best_v: float
    best_angle: float
    best: float
    second_u: float
    second_v: float
    second: float
    nearest: int
    next: int
    count: int


class ContourSearch(Evaluation):
    """State and result of a search; it begins with the evaluation at (u, v).

    Attributes
    ----------
    u, v
        Parameters.
    squared_distance
        Squared distance there [m^2].
    flags
        Sum of those that are named below.
    iterations
        Evaluations so far.
    span_u, span_v
        Knot spans whose control points are formed, or are to be formed before the search continues; -1 if all are.
    separation
        Given by the caller: a second minimum that is farther by less than this [m] is reported by TWIN.
    other_u, other_v, other_distance
        Parameters and distance [m] of a second minimum.
    trial_u, trial_v
        Where to evaluate next.
    stage
        What the next evaluation is.
    value, gradient_u, gradient_v, hessian_uu, hessian_uv, hessian_vv
        Of half the squared distance at (u, v) [m^2].
    radius
        Of the trust region, in knot spans.
    predicted
        By how much the last step should have lowered the value [m^2].
    step
        Its size, in knot spans.
    small
        Steps so far whose effect was below rounding.
    end, kept_flags
        Status and flags that are returned after the accepted point has been evaluated again.
    ring
        Of a search over the angles of a ring.
    starts
        Of a search from samples.
    """

    u: float
    v: float
    squared_distance: float
    flags: int
    iterations: int
    span_u: int
    span_v: int
    separation: float
    other_u: float
    other_v: float
    other_distance: float
    trial_u: float
    trial_v: float
    stage: int
    value: float
    gradient_u: float
    gradient_v: float
    hessian_uu: float
    hessian_uv: float
    hessian_vv: float
    radius: float
    predicted: float
    step: float
    small: int
    end: int
    kept_flags: int
    ring: RingSearch
    starts: SampleStarts


_START, _TRIAL, _RESTORE = range(3)
"""What the next evaluation is: the first one, that of a trial step, or again that of the accepted point."""

BELOW_U, ABOVE_U, BELOW_V, ABOVE_V, DEGENERATE, TWIN, BEHIND, DEEP = 1, 2, 4, 8, 16, 32, 64, 128
"""Flags of a result. The first four: the point is held by this border of the patch, beyond which the distance would
fall further. DEGENERATE: the distance has no definite minimum here (centre of curvature, flat face on a flat surface).
TWIN: `other_*` is a second minimum within the separation asked for. BEHIND: the primitive lies on the inner side.
DEEP: the surface has reached the core of a primitive, where the gap has no normal any more."""

BORDER = BELOW_U | ABOVE_U | BELOW_V | ABOVE_V

TOLERANCE = 1e-12
"""Of both parameters, whose range is 1."""

LARGEST_ITERATIONS = 100

_ACCEPTED = 1e-4
_SMALLEST_CURVATURE = 1e-9
"""Relative to the squared tangents; below it a minimum is called degenerate."""


@kernel(inline=True, internal=True)
def start_search(contour: PackedContour, u: float, v: float, result: ContourSearch) -> None:
    """Begin a new search at some parameters, brought into the patch; ``v = 0`` of a curve. The window stays."""
    result.trial_u = wrap(u, contour.u.closed)
    result.trial_v = wrap(v, contour.v.closed)
    result.stage = _START
    result.iterations = 0
    result.flags = 0
    result.other_distance = math.inf


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
    contour: PackedContour,
    f: float,
    g_u: float,
    g_v: float,
    h_uu: float,
    h_uv: float,
    h_vv: float,
    resolution: float,
    result: ContourSearch,
) -> int:
    """Take the values at the trial point and choose what to evaluate next.

    Parameters
    ----------
    contour
        The packed contour.
    f, g_u, g_v, h_uu, h_uv, h_vv
        Half the squared distance at (`trial_u`, `trial_v`), its gradient and its second derivatives; of a curve
        ``g_v = h_uv = 0, h_vv = 1``.
    resolution
        Rounding error of a difference of positions [m].
    result
        The tangents of the evaluation, and the state of the search.

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
    open_u = not contour.u.closed
    open_v = not contour.v.closed and contour.v.degree > 0
    stage = result.stage
    result.iterations += 1
    if stage == _RESTORE:
        result.flags = result.kept_flags
        return result.end
    if not (math.isfinite(f) and math.isfinite(g_u + g_v) and math.isfinite(h_uu + h_uv + h_vv)):
        return NOT_FINITE
    radius = 1.0
    small = 0
    last = math.inf
    accepted = True
    if stage == _TRIAL:
        radius = result.radius
        small = result.small
        last = result.step
        predicted = result.predicted
        before = result.value
        noise = resolution * (math.sqrt(2.0 * before) + resolution)
        if predicted > noise:
            ratio = (before - f) / predicted
            accepted = ratio > _ACCEPTED
            if ratio < 0.25:
                radius = 0.25 * last
            elif ratio > 0.75 and last > 0.99 * radius:
                radius *= 2.0
        else:
            small += 1
            accepted = f <= before + 20.0 * noise
    u = result.u
    v = result.v
    if accepted:
        u = result.trial_u
        v = result.trial_v
        result.u = u
        result.v = v
        result.squared_distance = 2.0 * f
        result.value = f
        result.gradient_u = g_u
        result.gradient_v = g_v
        result.hessian_uu = h_uu
        result.hessian_uv = h_uv
        result.hessian_vv = h_vv
    else:
        f = result.value
        g_u = result.gradient_u
        g_v = result.gradient_v
        h_uu = result.hessian_uu
        h_uv = result.hessian_uv
        h_vv = result.hessian_vv

    width_u = 1.0 / (contour.u.count if not open_u else contour.u.count - contour.u.degree)
    width_v = 0.0
    if contour.v.degree > 0:
        width_v = 1.0 / (contour.v.count if not open_v else contour.v.count - contour.v.degree)
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

    along, across = result.tangent_u, result.tangent_v
    a = along[0] * along[0] + along[1] * along[1] + along[2] * along[2]
    b = 1.0
    if contour.v.degree > 0:
        b = across[0] * across[0] + across[1] * across[1] + across[2] * across[2]
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
        lost = lost or not accepted or small >= 4 or step > 0.5 * last or flags & DEGENERATE != 0
    end = CONVERGED
    if not (exact or lost):
        if result.iterations < LARGEST_ITERATIONS:
            trial_u = u + du
            trial_v = v + dv
            # a step to the border must reach it exactly
            result.trial_u = 1.0 if open_u and du >= 1.0 - u else wrap(trial_u, not open_u)
            result.trial_v = 1.0 if open_v and dv >= 1.0 - v else wrap(trial_v, contour.v.closed)
            result.radius = radius
            result.small = small
            result.step = step
            result.predicted = decrease
            result.stage = _TRIAL
            return EVALUATE
        end = NOT_CONVERGED
    result.flags = flags
    if accepted:
        return end
    result.end = end  # the evaluation at hand is that of a step that was refused
    result.kept_flags = flags
    result.trial_u = u
    result.trial_v = v
    result.stage = _RESTORE
    return EVALUATE
