"""Triangles as pictures of surfaces need them: cut off at the sides of a box, welded, and fewer of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["clip_triangles", "thinned", "welded"]


def clip_triangles(
    points: NDArray[np.float64], triangles: NDArray[np.int64], box: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Parts of triangles that lie in a box.

    Parameters
    ----------
    points, triangles
        Shapes (n, 3) and (m, 3).
    box
        Lowest and highest corner, shape (2, 3).

    Returns
    -------
    tuple
        Points, shape (k, 3), triangles, shape (l, 3), and the triangle that each of them is a part of, shape (l,).

    Notes
    -----
    Triangles that stick out are cut by one side after the other (Sutherland and Hodgman, 1974).
    """
    corners = points[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = np.all((low <= box[1]) & (high >= box[0]), axis=1)
    inside = np.all((low >= box[0]) & (high <= box[1]), axis=1)
    used, compact = np.unique(triangles[inside], return_inverse=True)
    found = [points[used]]
    faces = [compact.reshape(-1, 3)]
    source = [np.flatnonzero(inside)]
    count = len(used)
    for number in np.flatnonzero(near & ~inside):
        polygon = _clipped(corners[number], box)
        if len(polygon) < 3:
            continue
        order = np.arange(1, len(polygon) - 1)
        found.append(polygon)
        faces.append(count + np.column_stack([0 * order, order, order + 1]))
        source.append(np.full(len(order), number))
        count += len(polygon)
    return np.concatenate(found), np.concatenate(faces).astype(np.int64), np.concatenate(source)


def _clipped(polygon: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.float64]:
    """A convex polygon without what lies outside of a box."""
    for axis in range(3):
        for limit, sign in ((box[0, axis], 1.0), (box[1, axis], -1.0)):
            height = sign * (polygon[:, axis] - limit)
            kept = []
            for k, (point, h) in enumerate(zip(polygon, height, strict=True)):
                before, g = polygon[k - 1], height[k - 1]
                if (h >= 0.0) != (g >= 0.0):
                    kept.append(before + g / (g - h) * (point - before))
                if h >= 0.0:
                    kept.append(point)
            if len(kept) < 3:
                return np.empty((0, 3))
            polygon = np.array(kept)
    return polygon


def welded(
    points: NDArray[np.float64], triangles: NDArray[np.int64], tolerance: float
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.bool_]]:
    """Points on a grid of this pitch [m] as one; triangles that stay triangles, and which ones these are."""
    _, first, place = np.unique(np.round(points / tolerance), axis=0, return_index=True, return_inverse=True)
    joined = place.ravel()[triangles]
    a, b, c = joined.T
    whole = (a != b) & (b != c) & (c != a)
    return points[first], joined[whole], whole


def thinned(
    points: NDArray[np.float64], triangles: NDArray[np.int64], most: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles between fewer points, and which of the points these are.

    Points in one cell of a grid become the first of them (Rossignac and Borrel, 1993); the grid is made coarser until
    there are few enough triangles.
    """
    if len(triangles) <= most:
        return triangles, np.arange(len(points))
    low = points.min(axis=0)
    span = float(np.ptp(points, axis=0).max()) or 1.0
    cells = max(4, int(np.sqrt(most)))
    while True:
        # one whole number for a cell, and for a triangle: to sort rows takes ten times as long
        i, j, k = np.floor((points - low) / span * cells).astype(np.int64).T
        _, first, cell = np.unique(
            (i * (cells + 1) + j) * (cells + 1) + k, return_index=True, return_inverse=True
        )
        joined = cell[triangles]
        a, b, c = joined.T
        joined = joined[(a != b) & (b != c) & (c != a)]
        a, b, c = np.sort(joined, axis=1).T
        _, pair = np.unique(a * len(first) + b, return_inverse=True)
        _, once = np.unique(pair * len(first) + c, return_index=True)
        joined = joined[np.sort(once)]
        if len(joined) <= most or cells <= 4:
            used, compact = np.unique(joined, return_inverse=True)
            return compact.reshape(-1, 3), first[used]
        cells = max(4, int(0.8 * cells))
