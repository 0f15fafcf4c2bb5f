"""Deepest point of a ring over a surface from nothing: gaps at angles around it, then a search from the lowest ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.splines.search_circle import ring_gap_slopes, ring_on_surface, ring_point, start_ring
from heavylift.contours.splines.search_cold import closest_point_cold, nearest_sample
from heavylift.contours.splines.search_step import CONVERGED, TWIN
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.convex import Primitive
    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.search_step import ContourSearch

__all__ = ["RING_ANGLES", "ring_cold"]

RING_ANGLES = 24
"""Around a ring, at which the gap is looked up first."""

_LARGEST_STARTS = 4
_SAME = 1e-6
"""Of angles [rad]: minima nearer than this are one."""


@kernel(internal=True)
def ring_cold(
    contour: PackedContour,
    knots: NDArray,
    weights: NDArray,
    net: NDArray,
    shape: Primitive,
    sample_u: NDArray,
    sample_v: NDArray,
    points: NDArray,
    reach: float,
    separation: float,
    distances: NDArray,
    angles: NDArray,
    scratch: NDArray,
    result: ContourSearch,
) -> int:
    """Least signed gap of a ring to a surface, without a start.

    Parameters
    ----------
    shape
        Row of the ring.
    angles
        Scratch, shape (4 * RING_ANGLES,).
    contour, knots, weights, net, sample_u, sample_v, points, reach, separation, distances, scratch, result
        As of `closest_point_cold`.

    Returns
    -------
    Status as there. `other_distance` is the gap of a second minimum along the ring, `other_u`, `other_v` its place.
    """
    n = RING_ANGLES
    turn = 2.0 * math.pi / n
    for k in range(n):
        r1, r2, r3, _, _, _ = ring_point(shape, turn * k)
        x, y, z = shape.centre[0] + r1, shape.centre[1] + r2, shape.centre[2] + r3
        status = closest_point_cold(
            contour,
            knots,
            weights,
            net,
            x,
            y,
            z,
            sample_u,
            sample_v,
            points,
            reach,
            0.0,
            distances,
            scratch,
            result,
        )
        if status != CONVERGED:
            return status
        angles[k] = ring_gap_slopes(shape, turn * k, result)[0]
        angles[n + k] = result.u
        angles[2 * n + k] = result.v
    for k in range(n):
        before = angles[k - 1 if k > 0 else n - 1]
        after = angles[k + 1 if k + 1 < n else 0]
        angles[3 * n + k] = angles[k] if angles[k] < before and angles[k] <= after else math.inf
    angles[3 * n + nearest_sample(angles, n)] = angles[nearest_sample(angles, n)]  # all alike: one of them
    best, best_angle, u, v = math.inf, 0.0, 0.0, 0.0
    other, other_u, other_v = math.inf, 0.0, 0.0
    final = CONVERGED
    for _ in range(_LARGEST_STARTS):
        least = math.inf  # of the angles that are lower than both neighbours and not yet refined
        at = -1
        for k in range(n):
            if angles[3 * n + k] < least:
                least = angles[3 * n + k]
                at = k
        # the gap changes by no more than the way along the ring
        if at < 0 or angles[at] - 0.5 * turn * shape.sizes[0] - shape.radius > best + separation:
            break
        start_ring(contour, angles[n + at], angles[2 * n + at], turn * at, result)
        status = ring_on_surface(contour, knots, weights, net, shape, -1, -1, scratch, result)
        angles[3 * n + at] = math.inf
        gap = result.ring.gap
        apart = abs(result.ring.angle - best_angle)
        apart = abs(apart - 2.0 * math.pi * round(apart / (2.0 * math.pi)))
        if gap < best:
            if apart > _SAME:
                other, other_u, other_v = best, u, v
            best, best_angle, u, v = gap, result.ring.angle, result.u, result.v
            final = status
        elif apart > _SAME and gap < other:
            other, other_u, other_v = gap, result.u, result.v
    start_ring(contour, u, v, best_angle, result)
    status = ring_on_surface(contour, knots, weights, net, shape, -1, -1, scratch, result)
    result.other_u = other_u
    result.other_v = other_v
    result.other_distance = other
    if other <= best + separation:
        result.flags |= TWIN
    return max(final, status)
