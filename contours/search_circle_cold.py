"""Deepest point of a ring over a surface from nothing: gaps at angles around it, then a search from the lowest ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.search_circle import (
    RING_GAP,
    RING_PHI,
    ring_gap_slopes,
    ring_on_surface,
    ring_point,
    start_ring,
)
from heavylift.contours.search_cold import closest_point_cold, nearest_sample
from heavylift.contours.search_step import CONVERGED, FLAGS, OTHER_DISTANCE, OTHER_U, OTHER_V, TWIN, U, V
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.convex import Primitive

__all__ = ["RING_ANGLES", "ring_cold"]

RING_ANGLES = 24
"""Around a ring, at which the gap is looked up first."""

_LARGEST_STARTS = 4
_SAME = 1e-6
"""Of angles [rad]: minima nearer than this are one."""


@kernel(internal=True)
def ring_cold(
    contour: NDArray,
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
    result: NDArray,
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
    Status as there. OTHER_DISTANCE is the gap of a second minimum along the ring, OTHER_U, OTHER_V its place.
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
        angles[n + k] = result[U]
        angles[2 * n + k] = result[V]
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
        gap = result[RING_GAP]
        apart = abs(result[RING_PHI] - best_angle)
        apart = abs(apart - 2.0 * math.pi * round(apart / (2.0 * math.pi)))
        if gap < best:
            if apart > _SAME:
                other, other_u, other_v = best, u, v
            best, best_angle, u, v = gap, result[RING_PHI], result[U], result[V]
            final = status
        elif apart > _SAME and gap < other:
            other, other_u, other_v = gap, result[U], result[V]
    start_ring(contour, u, v, best_angle, result)
    status = ring_on_surface(contour, knots, weights, net, shape, -1, -1, scratch, result)
    result[OTHER_U] = other_u
    result[OTHER_V] = other_v
    result[OTHER_DISTANCE] = other
    if other <= best + separation:
        result[FLAGS] = float(int(result[FLAGS]) | TWIN)
    return max(final, status)
