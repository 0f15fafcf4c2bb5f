"""Search from nothing: from the samples of a grid to the nearest of several local minima.

Every sample of a grid that is nearer than its neighbours begins a search, unless its distance less its reach is above
the least distance found so far: the nearest sample always, the others rarely. All control points must be formed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.convex import core_distance
from heavylift.contours.splines.search import closest_on_curve, closest_on_surface
from heavylift.contours.splines.search_shape import (
    closest_shape_on_curve,
    closest_shape_on_surface,
    into_shape,
)
from heavylift.contours.splines.search_step import CONVERGED, NOT_FINITE, TWIN, start_search
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.convex import Primitive
    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.search_step import ContourSearch

__all__ = ["closest_point_cold", "closest_shape_cold", "nearest_sample"]

_LARGEST_STARTS = 16
_SAME = 1e-6
"""Of parameters: minima nearer than this are one."""


@kernel(internal=True, reassociate=True)
def _distances_to_point(
    points: NDArray, count: int, x: float, y: float, z: float, distances: NDArray
) -> None:
    """Squared distances of all samples."""
    for k in range(count):
        dx = points[0, k] - x
        dy = points[1, k] - y
        dz = points[2, k] - z
        distances[k] = dx * dx + dy * dy + dz * dz


@kernel(internal=True)
def _distances_to_shape(
    kind: int, shape: Primitive, points: NDArray, count: int, margin: float, distances: NDArray
) -> None:
    """Squared distances, shifted, of samples to the core of a primitive.

    Of samples that are farther than the best by more than `margin`, only a bound of that from the ball about the core.
    """
    _distances_to_point(points, count, shape.centre[0], shape.centre[1], shape.centre[2], distances)
    nearest = nearest_sample(distances, count)
    if nearest < 0:
        return
    p, q, r = shape.sizes[0], shape.sizes[1], shape.sizes[2]
    ball = math.sqrt(p * p + q * q + r * r) - shape.shift
    x, y, z = into_shape(
        shape,
        points[0, nearest] - shape.centre[0],
        points[1, nearest] - shape.centre[1],
        points[2, nearest] - shape.centre[2],
    )
    within = core_distance(kind, shape, x, y, z)[0] + margin
    for k in range(count):
        bound = math.sqrt(distances[k]) - ball
        if bound > within:
            distances[k] = bound * bound
        else:
            x, y, z = into_shape(
                shape,
                points[0, k] - shape.centre[0],
                points[1, k] - shape.centre[1],
                points[2, k] - shape.centre[2],
            )
            value = core_distance(kind, shape, x, y, z)[0]
            distances[k] = value * value


@kernel(internal=True)
def nearest_sample(distances: NDArray, count: int) -> int:
    """Sample of the least distance; -1 if none is finite."""
    least = math.inf
    at = -1
    for k in range(count):
        if distances[k] < least:
            least = distances[k]
            at = k
    return at


@kernel(internal=True)
def _is_least(distances: NDArray, i: int, j: int, a: int, b: int, closed_u: bool, closed_v: bool) -> bool:
    """Whether a sample is nearer than its eight neighbours; of equal ones the first is."""
    own = i * b + j
    d = distances[own]
    for di in range(-1, 2):
        row = i + di
        if row < 0 or row >= a:
            if not closed_u:
                continue
            row += a if row < 0 else -a
        for dj in range(-1, 2):
            column = j + dj
            if column < 0 or column >= b:
                if not closed_v:
                    continue
                column += b if column < 0 else -b
            k = row * b + column
            if distances[k] < d or (distances[k] == d and k < own):
                return False
    return True


@kernel(inline=True, internal=True)
def _same_place(contour: PackedContour, u: float, v: float, u2: float, v2: float) -> bool:
    """Whether parameters agree, also across a seam."""
    du = abs(u - u2)
    dv = abs(v - v2)
    if contour.u.closed:
        du = min(du, 1.0 - du)
    if contour.v.closed:
        dv = min(dv, 1.0 - dv)
    return du < _SAME and dv < _SAME


@kernel(inline=True, internal=True)
def _begin_starts(result: ContourSearch) -> None:
    """Begin to go through the samples."""
    starts = result.starts
    starts.next = -1
    starts.count = 0
    starts.best = math.inf
    starts.second = math.inf


@kernel(internal=True)
def _next_start(
    contour: PackedContour,
    distances: NDArray,
    a: int,
    b: int,
    reach: float,
    separation: float,
    result: ContourSearch,
) -> int:
    """Number of the sample from which to search next, -1 if no other can lead to a nearer minimum.

    The nearest sample comes first; of the others those that are nearer than their neighbours, if the least distance
    found so far is not below what their reach allows.
    """
    starts = result.starts
    if starts.next < 0:
        nearest = nearest_sample(distances, a * b)
        starts.nearest = nearest
        starts.next = 0
        return nearest
    if starts.count >= _LARGEST_STARTS:
        return -1
    closed_u, closed_v = contour.u.closed, contour.v.closed
    nearest = starts.nearest
    within = (starts.best + separation + reach) ** 2
    for k in range(starts.next, a * b):
        if distances[k] <= within and k != nearest:
            i = k // b
            if _is_least(distances, i, k - i * b, a, b, closed_u, closed_v):
                starts.next = k + 1
                return k
    return -1


@kernel(internal=True)
def _keep_minimum(contour: PackedContour, status: int, result: ContourSearch) -> None:
    """Compare the minimum of a search that ended with the two best so far."""
    starts = result.starts
    starts.count += 1
    u, v, best = starts.best_u, starts.best_v, starts.best
    first = best == math.inf
    if status != CONVERGED and not first:
        return
    distance = math.sqrt(result.squared_distance)
    if not first and _same_place(contour, u, v, result.u, result.v):
        return
    if distance < best:
        starts.second_u, starts.second_v, starts.second = u, v, best
        starts.best_u, starts.best_v, starts.best = result.u, result.v, distance
    elif distance < starts.second:
        starts.second_u, starts.second_v, starts.second = result.u, result.v, distance


@kernel(inline=True, internal=True)
def _finish(separation: float, result: ContourSearch) -> None:
    """Write the second minimum."""
    starts = result.starts
    result.other_u = starts.second_u
    result.other_v = starts.second_v
    result.other_distance = starts.second
    if starts.second <= starts.best + separation:
        result.flags |= TWIN


@kernel(internal=True)
def closest_point_cold(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    x: float,
    y: float,
    z: float,
    sample_u: NDArray,
    sample_v: NDArray,
    points: NDArray,
    reach: float,
    separation: float,
    distances: NDArray,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Closest point of a surface or a curve to a point, without a start.

    Parameters
    ----------
    contour, knots, weights, net
        Packed contour, knots, rational weights, control points [m], all of them formed.
    x, y, z
        The point [m].
    sample_u, sample_v
        Parameters of a grid of a x b samples.
    points, reach
        Their positions [m], shape (3, a * b), and the reach of one [m], from `heavylift.contours.splines.samples`.
    separation
        A second minimum that is farther by less than this [m] is reported by TWIN.
    distances
        Scratch, shape (a * b,).
    scratch, result
        As of the warm search; no `start_search` is needed.

    Returns
    -------
    Status as of the warm search, without `NEED_SPAN`. `other_u`, `other_v`, `other_distance` (not squared) are a second
    minimum if one was met, at infinity if not.
    """
    a, b = sample_u.size, sample_v.size
    _distances_to_point(points, a * b, x, y, z, distances)
    _begin_starts(result)
    k = _next_start(contour, distances, a, b, reach, separation, result)
    if k < 0:
        return NOT_FINITE
    u, v = sample_u[k // b], sample_v[k % b]
    status = CONVERGED
    while True:
        start_search(contour, u, v, result)
        if contour.v.degree == 0:
            status = closest_on_curve(contour, knots, weights, net, x, y, z, -1, scratch, result)
        else:
            status = closest_on_surface(contour, knots, weights, net, x, y, z, -1, -1, scratch, result)
        if k < 0:
            break
        _keep_minimum(contour, status, result)
        k = _next_start(contour, distances, a, b, reach, separation, result)
        if k < 0:
            u, v = result.starts.best_u, result.starts.best_v
            if result.u == u and result.v == v:
                break
        else:
            u, v = sample_u[k // b], sample_v[k % b]
    _finish(separation, result)
    return status


@kernel(internal=True)
def closest_shape_cold(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    kind: int,
    shape: Primitive,
    sample_u: NDArray,
    sample_v: NDArray,
    points: NDArray,
    reach: float,
    separation: float,
    distances: NDArray,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Closest or deepest point of a surface or a curve to a primitive, without a start; see `closest_point_cold`.

    A ring against a surface has `ring_cold`. `other_distance` is that to the core, shifted as `squared_distance` is.
    """
    a, b = sample_u.size, sample_v.size
    _distances_to_shape(kind, shape, points, a * b, separation + reach, distances)
    _begin_starts(result)
    k = _next_start(contour, distances, a, b, reach, separation, result)
    if k < 0:
        return NOT_FINITE
    u, v = sample_u[k // b], sample_v[k % b]
    status = CONVERGED
    while True:
        start_search(contour, u, v, result)
        if contour.v.degree == 0:
            status = closest_shape_on_curve(contour, knots, weights, net, kind, shape, -1, scratch, result)
        else:
            status = closest_shape_on_surface(
                contour, knots, weights, net, kind, shape, -1, -1, scratch, result
            )
        if k < 0:
            break
        _keep_minimum(contour, status, result)
        k = _next_start(contour, distances, a, b, reach, separation, result)
        if k < 0:
            u, v = result.starts.best_u, result.starts.best_v
            if result.u == u and result.v == v:
                break
        else:
            u, v = sample_u[k // b], sample_v[k % b]
    _finish(separation, result)
    return status
