"""Search from nothing: from samples to the nearest of several local minima.

Every sample that is nearer than its neighbours begins a search, unless its distance less its reach is above the least
distance found so far: the nearest sample always, the others rarely. All control points must be formed. The caller
computes the distances of the samples and makes the searches::

    begin_starts(..., result)
    status = NOT_FINITE
    k = next_start(contour, squares, status, result)
    while k != NO_START:
        ...                                     # search from sample k, or from `result.starts.best_u, ...` if AGAIN
        k = next_start(contour, squares, status, result)

What is left is the status and result of the last search, which ended in the least minimum.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.search import closest_on_curve, closest_on_surface, open_window
from heavylift.contours.splines.search_step import CONVERGED, NOT_FINITE, TWIN, start_search
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.samples import SampleGrid, Samples
    from heavylift.contours.splines.search_step import ContourSearch, SampleStarts

__all__ = [
    "AGAIN",
    "NO_START",
    "begin_at_samples",
    "begin_starts",
    "closest_point_cold",
    "distances_to_point",
    "nearest_sample",
    "next_start",
    "start_at_sample",
]

NO_START, AGAIN = -1, -2
"""Of `next_start`: the search is done; the last search begins at the best minimum."""

_LARGEST_STARTS = 16
_SAME = 1e-6
"""Of parameters, and of angles of a ring [rad]: minima nearer than this are one."""


@kernel(internal=True, reassociate=True)
def distances_to_point(samples: Samples, grid: SampleGrid, point: tuple[float, float, float]) -> None:
    """Squared distances of all samples of a grid."""
    x, y, z = point
    at = grid.points
    px, py, pz = samples.points[at], samples.points[at + 1], samples.points[at + 2]
    distances = samples.distances
    for k in range(grid.count_u * grid.count_v):
        dx = px[k] - x
        dy = py[k] - y
        dz = pz[k] - z
        distances[k] = dx * dx + dy * dy + dz * dz


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
def _is_least(distances: NDArray, own: int, starts: SampleStarts) -> bool:
    """Whether a sample is nearer than its eight neighbours; of equal ones the first is."""
    a, b = starts.rows, starts.columns
    i = own // b
    j = own - i * b
    d = distances[own]
    for di in range(-1, 2):
        row = i + di
        if row < 0 or row >= a:
            if not starts.closed_rows:
                continue
            row += a if row < 0 else -a
        for dj in range(-1, 2):
            column = j + dj
            if column < 0 or column >= b:
                if not starts.closed_columns:
                    continue
                column += b if column < 0 else -b
            k = row * b + column
            if distances[k] < d or (distances[k] == d and k < own):
                return False
    return True


@kernel(inline=True, internal=True)
def begin_starts(
    rows: int, columns: int, closed_rows: bool, closed_columns: bool, reach: float, result: ContourSearch
) -> None:
    """Begin to go through the samples of a grid; angles of a ring are a column that is closed."""
    starts = result.starts
    starts.rows, starts.columns = rows, columns
    starts.closed_rows, starts.closed_columns = closed_rows, closed_columns
    starts.of_ring = False
    starts.reach = reach
    starts.next = -1
    starts.count = 0
    starts.best = math.inf
    starts.second = math.inf


@kernel(inline=True, internal=True)
def _apart(a: float, b: float, closed: bool, turn: float) -> bool:
    """Whether parameters differ, also across a seam."""
    way = abs(a - b)
    if closed:
        way = abs(way - turn * round(way / turn))
    return way >= _SAME


@kernel(internal=True)
def _keep_minimum(contour: PackedContour, status: int, result: ContourSearch) -> None:
    """Compare the minimum of a search that ended with the two best so far."""
    starts = result.starts
    starts.count += 1
    u, v, best = starts.best_u, starts.best_v, starts.best
    angle = result.ring.angle if starts.of_ring else 0.0
    if best != math.inf and (
        status != CONVERGED
        or not (
            _apart(u, result.u, contour.u.closed, 1.0)
            or _apart(v, result.v, contour.v.closed, 1.0)
            or _apart(angle, starts.best_angle, True, 2.0 * math.pi)
        )
    ):
        return
    distance = result.ring.gap if starts.of_ring else math.sqrt(result.squared_distance)
    if distance < best:
        starts.second_u, starts.second_v, starts.second = u, v, best
        starts.best_u, starts.best_v, starts.best = result.u, result.v, distance
        starts.best_angle = angle
    elif distance < starts.second:
        starts.second_u, starts.second_v, starts.second = result.u, result.v, distance


@kernel(internal=True)
def next_start(contour: PackedContour, squares: NDArray, status: int, result: ContourSearch) -> int:
    """Take the minimum of the last search and choose the sample from which to search next.

    The nearest sample comes first; of the others those that are nearer than their neighbours, if the least distance
    found so far is not below what their reach allows.

    Parameters
    ----------
    contour
        The packed contour.
    squares
        Distances of all samples, squared, those that are negative with their sign [m^2].
    status, result
        Of the last search; begun by `begin_starts`.

    Returns
    -------
    Number of a sample, AGAIN or NO_START. At the end `other_u`, `other_v`, `other_distance` (not squared) are a second
    minimum if one was met, at infinity if not; of rings the distance is the gap.
    """
    starts = result.starts
    count = starts.rows * starts.columns
    if starts.next < 0:
        starts.nearest = nearest_sample(squares, count)
        starts.next = 0
        return starts.nearest
    if starts.next <= count:
        _keep_minimum(contour, status, result)
        within = starts.best + result.separation + starts.reach
        within *= abs(within)
        if starts.count < _LARGEST_STARTS:
            for k in range(starts.next, count):
                if squares[k] <= within and k != starts.nearest and _is_least(squares, k, starts):
                    starts.next = k + 1
                    return k
        starts.next = count + 1
        if (
            result.u != starts.best_u
            or result.v != starts.best_v
            or (starts.of_ring and result.ring.angle != starts.best_angle)
        ):
            return AGAIN
    result.other_u = starts.second_u
    result.other_v = starts.second_v
    result.other_distance = starts.second
    if starts.second <= starts.best + result.separation:
        result.flags |= TWIN
    return NO_START


@kernel(internal=True)
def begin_at_samples(contour: PackedContour, grid: SampleGrid, result: ContourSearch) -> None:
    """Begin to go through the samples of a contour whose `distances` are known."""
    open_window(result)
    begin_starts(grid.count_u, grid.count_v, contour.u.closed, contour.v.closed, grid.reach, result)


@kernel(internal=True)
def start_at_sample(
    contour: PackedContour, samples: Samples, grid: SampleGrid, status: int, result: ContourSearch
) -> bool:
    """Take the minimum of the last search and begin the next one, if there is one; see `next_start`."""
    k = next_start(contour, samples.distances, status, result)
    if k == NO_START:
        return False
    u, v = result.starts.best_u, result.starts.best_v
    if k != AGAIN:
        u = samples.parameters[grid.first_u + k // grid.count_v]
        v = samples.parameters[grid.first_v + k % grid.count_v]
    start_search(contour, u, v, result)
    return True


@kernel(internal=True)
def closest_point_cold(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    point: tuple[float, float, float],
    samples: Samples,
    grid: SampleGrid,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Closest point of a surface or a curve to a point, without a start.

    Parameters
    ----------
    contour, knots, weights, net
        Packed contour, knots, rational weights, control points [m], all of them formed.
    point
        The point [m].
    samples, grid
        All samples, and the grid of this contour, placed by `sample_points`.
    scratch, result
        As of the warm search; no `start_search` is needed, and the window is open afterwards.

    Returns
    -------
    Status as of the warm search, without `NEED_SPAN`. `other_u`, `other_v`, `other_distance` as of `next_start`.
    """
    distances_to_point(samples, grid, point)
    begin_at_samples(contour, grid, result)
    status = NOT_FINITE
    while start_at_sample(contour, samples, grid, status, result):
        if contour.v.degree == 0:
            status = closest_on_curve(contour, knots, weights, net, point, scratch, result)
        else:
            status = closest_on_surface(contour, knots, weights, net, point, scratch, result)
    return status
