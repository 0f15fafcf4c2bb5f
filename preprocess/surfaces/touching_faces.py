"""Whether faces of a closed surface lie on each other: where parts touch, both faces are inside of the whole.

Faces that lie on each other are in one plane and look opposite ways. So faces are sorted by their plane, and of each
plane with both sides each face of one side is cut by each of the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["touching_area"]

ALIKE = 1e-6
"""Of normals, and of distances from the origin over the size of the surface: what is one plane."""


def touching_area(surface: TriangleSurface) -> float:
    """Area on which faces lie that look opposite ways [m^2], once for both.

    Parameters
    ----------
    surface
        Its faces wound outwards.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from heavylift.preprocess.surfaces.primitives import box_surface
    >>> from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
    >>> one = box_surface((2.0, 2.0, 2.0))
    >>> points = np.vstack([one.points, one.points + [2.0, 1.0, 0.0]])
    >>> two = TriangleSurface(points, np.vstack([one.triangles, one.triangles + len(one.points)]))
    >>> round(touching_area(one), 9), round(touching_area(two), 9)
    (0.0, 2.0)
    """
    corners = surface.points[surface.triangles[surface.faces]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    corners, normals = corners[lengths > 0.0], normals[lengths > 0.0] / lengths[lengths > 0.0, None]
    size = float(np.ptp(surface.bounds, axis=0).max())
    distances = (normals * corners[:, 0]).sum(axis=1) / size
    first = np.argmax(np.abs(normals) > 0.5, axis=1)
    side = np.sign(normals[np.arange(len(normals)), first])
    planes = side[:, None] * np.column_stack([normals, distances])
    total = 0.0
    for members in _together(planes):
        up, down = members[side[members] > 0.0], members[side[members] < 0.0]
        if len(up) and len(down):
            total += _common(corners[up], corners[down], normals[up[0]])
    return total


def _together(planes: NDArray[np.float64]) -> Iterator[NDArray[np.int64]]:
    """Faces by planes: chains of planes whose distances from the origin, and then all else, are alike."""
    order = np.argsort(planes[:, 3], kind="stable")
    for near in np.split(order, np.flatnonzero(np.diff(planes[order, 3]) > ALIKE) + 1):
        left = near
        while len(left) > 1:
            alike = np.abs(planes[left] - planes[left[0]]).max(axis=1) <= 10.0 * ALIKE
            yield left[alike]
            left = left[~alike]


def _common(a: NDArray[np.float64], b: NDArray[np.float64], normal: NDArray[np.float64]) -> float:
    """Area that triangles of two sides of a plane have in common, shapes (n, 3, 3) and (m, 3, 3)."""
    x = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    axes = np.column_stack([x, np.cross(normal, x)]) / np.linalg.norm(x)
    flat_a, flat_b = a @ axes, b @ axes
    total = 0.0
    low, high = flat_b.min(axis=1), flat_b.max(axis=1)
    for triangle in flat_a:
        near = np.all((low < triangle.max(axis=0)) & (high > triangle.min(axis=0)), axis=1)
        for other in flat_b[near]:
            total += _cut(triangle, other[::-1])
    return total


def _cut(polygon: NDArray[np.float64], by: NDArray[np.float64]) -> float:
    """Area of a convex polygon within a triangle, both anticlockwise (Sutherland and Hodgman)."""
    for i in range(3):
        p, q = by[i], by[(i + 1) % 3]
        inward = np.array([p[1] - q[1], q[0] - p[0]])
        heights = (polygon - p) @ inward
        kept = []
        for k in range(len(polygon)):
            here, there = heights[k - 1], heights[k]
            if here * there < 0.0:
                kept.append(polygon[k - 1] + (polygon[k] - polygon[k - 1]) * here / (here - there))
            if there >= 0.0:
                kept.append(polygon[k])
        if len(kept) < 3:
            return 0.0
        polygon = np.array(kept)
    x, y = polygon.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
