"""Shapes of what has none: boxes of an inertia, coils of springs, pads of fenders; lines cut off at a box."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.pictures.parts import shape_parts
from heavylift.solver.scene.contacts import BoxShape, CylinderShape

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["box_corners", "clip_lines", "coil", "inertia_box", "pad"]

_THIN = 0.02  # of the longest side: least other side of a box, which would not be seen otherwise
_TURNS, _STEPS = 8, 12  # of a coil, and segments of a turn
_STRAIGHT = 0.15  # share of a spring that is straight, at each end


def inertia_box(
    mass: float, inertia: ArrayLike, centre: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Homogeneous box with a mass and principal moments of inertia: points, shape (8, 3), and triangles, (12, 3).

    Parameters
    ----------
    mass
        [kg].
    inertia
        About the centre of mass [kg m^2], shape (3, 3).
    centre
        Centre of mass [m], shape (3,).

    Notes
    -----
    From ``J_1 = m (b^2 + c^2) / 12`` and its permutations, ``a^2 = 6 (J_2 + J_3 - J_1) / m``. A rod or a plate is
    drawn with a fiftieth of its length as its least side.
    """
    J, axes = np.linalg.eigh(np.asarray(inertia, dtype=np.float64))
    sides = np.sqrt(np.maximum(6.0 * (J.sum() - 2.0 * J) / mass, 0.0))
    sides = np.maximum(sides, _THIN * sides.max())
    (patch,) = shape_parts(BoxShape(sides, 0.0)).patches
    return np.asarray(centre, dtype=np.float64) + patch.points @ axes.T, patch.triangles


def box_corners(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners of the box around points, shape (8, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([np.where([i & 4, i & 2, i & 1], high, low) for i in range(8)])


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


def pad(
    tip: NDArray[np.float64], normal: NDArray[np.float64], radius: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A disc as thick as its radius whose face with a normal lies at a point: points and triangles."""
    n = normal / np.linalg.norm(normal)
    (patch,) = shape_parts(CylinderShape(radius, radius, 0.0, n)).patches
    return tip - 0.5 * radius * n + patch.points, patch.triangles


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
