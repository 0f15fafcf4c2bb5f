"""Bounds of contours that say, without a search, that something cannot be within reach.

A spline with positive weights lies in the convex hull of its control points, so their box and their sphere hold it.
Those of a flexible body are linear in its coordinates: the bound of the undeformed points, widened by the most that
each coordinate can move one of them, needs no control point formed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BOUND_WIDTH", "control_bound", "distance_bound", "modal_growth", "out_of_reach", "widened"]

BOUND_WIDTH = 10
"""Of a bound: centre of the box 0:3, its half lengths 3:6, centre of the sphere 6:9, its radius 9 [m]."""


@kernel
def control_bound(net: NDArray, first: int, count: int, bound: NDArray) -> None:
    """Box along the axes and sphere about some control points.

    Parameters
    ----------
    net, first, count
        Control points [m], shape (n, 3), the first row and the number of those that count.
    bound
        Out, shape (BOUND_WIDTH,).

    Notes
    -----
    The sphere is that of Ritter, An efficient bounding sphere, Graphics Gems, 1990: at most some 5 % too large.
    """
    for k in range(3):
        low = net[first, k]
        high = low
        for i in range(first, first + count):
            low = min(low, net[i, k])
            high = max(high, net[i, k])
        bound[k] = 0.5 * (low + high)
        bound[3 + k] = 0.5 * (high - low)
    # two points that are far apart, then wider for every point outside
    one = _farthest(net, first, count, net[first, 0], net[first, 1], net[first, 2])
    two = _farthest(net, first, count, net[one, 0], net[one, 1], net[one, 2])
    x = 0.5 * (net[one, 0] + net[two, 0])
    y = 0.5 * (net[one, 1] + net[two, 1])
    z = 0.5 * (net[one, 2] + net[two, 2])
    radius = math.sqrt((net[one, 0] - x) ** 2 + (net[one, 1] - y) ** 2 + (net[one, 2] - z) ** 2)
    for i in range(first, first + count):
        dx, dy, dz = net[i, 0] - x, net[i, 1] - y, net[i, 2] - z
        d = math.sqrt(dx * dx + dy * dy + dz * dz)
        if d > radius:
            shift = 0.5 * (d - radius) / d
            radius = 0.5 * (d + radius)
            x += shift * dx
            y += shift * dy
            z += shift * dz
    bound[6], bound[7], bound[8] = x, y, z
    bound[9] = radius * (1.0 + 1e-12)  # rounding must not lose a point


@kernel(internal=True)
def _farthest(net: NDArray, first: int, count: int, x: float, y: float, z: float) -> int:
    """Row of the control point that is farthest from a point."""
    most = -1.0
    at = first
    for i in range(first, first + count):
        d = (net[i, 0] - x) ** 2 + (net[i, 1] - y) ** 2 + (net[i, 2] - z) ** 2
        if d > most:
            most = d
            at = i
    return at


def modal_growth(modal: NDArray[np.float64]) -> NDArray[np.float64]:
    """The most that a unit of each coordinate moves any control point, shape (nf,).

    Parameters
    ----------
    modal
        Derivatives of the control points by the coordinates, shape (nf, n, 3).
    """
    if modal.shape[0] == 0 or modal.shape[1] == 0:
        return np.zeros(modal.shape[0])
    return np.ascontiguousarray(np.sqrt(np.max(np.sum(modal * modal, axis=2), axis=1)))


@kernel(internal=True, reassociate=True)
def widened(growth: NDArray, q: NDArray, first: int, count: int) -> float:
    """By how much a bound of undeformed control points grows [m]: ``sum_i |q_i| growth_i``.

    Parameters
    ----------
    growth
        From `modal_growth`, shape (count,).
    q, first
        Coordinates, and the place in them of the first one.
    count
        Of them.
    """
    total = 0.0
    for i in range(count):
        total += abs(q[first + i]) * growth[i]
    return total


@kernel(internal=True)
def distance_bound(bound: NDArray, x: float, y: float, z: float, growth: float) -> float:
    """A distance [m] that a point has at least from everything within a bound; 0 if it may be inside.

    Parameters
    ----------
    bound
        From `control_bound`, in the axes of the control points.
    x, y, z
        The point [m] in the same axes.
    growth
        By which the bound is widened [m], `widened`.
    """
    dx = max(abs(x - bound[0]) - bound[3], 0.0)
    dy = max(abs(y - bound[1]) - bound[4], 0.0)
    dz = max(abs(z - bound[2]) - bound[5], 0.0)
    box = math.sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = x - bound[6], y - bound[7], z - bound[8]
    sphere = math.sqrt(dx * dx + dy * dy + dz * dz) - bound[9]
    return max(max(box, sphere) - growth, 0.0)


@kernel(internal=True)
def out_of_reach(bound: NDArray, x: float, y: float, z: float, growth: float, reach: float) -> bool:
    """Whether nothing within a bound is nearer to a point than `reach` [m]: radius of what moves plus its margin."""
    return distance_bound(bound, x, y, z, growth) > reach
