"""Coils of springs, and lines cut off at a box."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["clip_lines", "coil"]

_TURNS, _STEPS = 8, 12  # of a coil, and segments of a turn
_STRAIGHT = 0.15  # share of a spring that is straight, at each end


def coil(
    start: NDArray[np.float64], end: NDArray[np.float64], radius: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A spring between two points: points, shape (n, 3), and segments; a quarter of its length at most wide."""
    along = end - start
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return np.array([start]), np.empty((0, 2), dtype=np.int64)
    e = along / length
    u = np.cross(e, np.eye(3)[np.argmin(np.abs(e))])
    u = u / np.linalg.norm(u)
    r = min(radius, 0.125 * length)
    share = np.linspace(0.0, 1.0, _TURNS * _STEPS + 1)
    turns = 2.0 * np.pi * _TURNS * share
    at = start + np.outer(_STRAIGHT + (1.0 - 2.0 * _STRAIGHT) * share, along)
    turned = at + r * (np.outer(np.cos(turns), u) + np.outer(np.sin(turns), np.cross(e, u)))
    points = np.concatenate([[start, at[0]], turned, [at[-1], end]])
    order = np.arange(len(points))
    return points, np.column_stack([order[:-1], order[1:]])


def clip_lines(
    points: NDArray[np.float64], ends: NDArray[np.int64], box: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Parts of segments that lie in a box.

    Parameters
    ----------
    points, ends
        Shapes (n, 3) and (m, 2).
    box
        Lowest and highest corner, shape (2, 3).

    Returns
    -------
    tuple
        Points, shape (2 k, 3), and segments, shape (k, 2).

    Notes
    -----
    Each segment ``a + s (b - a)`` is between two planes of the box for an interval of s (Liang and Barsky, 1984).
    """
    a, b = points[ends[:, 0]], points[ends[:, 1]]
    d = b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (box[:, np.newaxis] - a) / d
    still = d == 0.0
    inside = (a >= box[0]) & (a <= box[1])
    low = np.where(still, np.where(inside, 0.0, np.inf), s.min(axis=0)).max(axis=1)
    high = np.where(still, np.where(inside, 1.0, -np.inf), s.max(axis=0)).min(axis=1)
    low, high = np.maximum(low, 0.0), np.minimum(high, 1.0)
    kept = low < high
    low, high = low[kept, np.newaxis], high[kept, np.newaxis]
    found = np.stack([a[kept] + low * d[kept], a[kept] + high * d[kept]], axis=1).reshape(-1, 3)
    return found, np.arange(len(found), dtype=np.int64).reshape(-1, 2)
