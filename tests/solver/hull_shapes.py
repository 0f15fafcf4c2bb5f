"""Closed surfaces that are not boxes of twelve triangles: for tests of hydrostatics and their benchmark."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

Mesh = tuple[np.ndarray, np.ndarray]


def outward_hull(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Triangles of the convex hull of points (n, 3), anticlockwise seen from outside, shape (nt, 3)."""
    triangles = ConvexHull(points).simplices.astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ni,ni->n", np.cross(b - a, c - a), a - points.mean(axis=0)) < 0.0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return np.ascontiguousarray(triangles)


def icosphere(level: int) -> Mesh:
    """Sphere of radius 1: an icosahedron whose triangles are cut in four as often as told."""
    g = 0.5 * (1.0 + 5.0**0.5)
    points = np.array([(a, b * g, 0.0) for a in (-1, 1) for b in (-1, 1)])
    points = np.vstack([points, points[:, [2, 0, 1]], points[:, [1, 2, 0]]])
    points /= np.linalg.norm(points[0])
    triangles = outward_hull(points)
    for _ in range(level):
        sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        ends, number = np.unique(sides, axis=0, return_inverse=True)
        middle = points[ends].sum(axis=1)
        ab, bc, ca = (number.reshape(-1, 3) + len(points)).T
        points = np.vstack([points, middle / np.linalg.norm(middle, axis=1)[:, None]])
        a, b, c = triangles.T
        parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        triangles = np.concatenate([np.column_stack(part) for part in parts])
    return points, np.ascontiguousarray(triangles)


def box_grid(counts: Sequence[int], size: Sequence[float]) -> Mesh:
    """Box about the origin with so many cells along x, y and z, two triangles each."""
    n = np.asarray(counts)
    corners: list[NDArray[np.int64]] = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        i, j = (k.ravel() for k in np.meshgrid(np.arange(n[u]), np.arange(n[v]), indexing="ij"))
        for end in (0, n[axis]):
            rounds = ((0, 0), (1, 0), (1, 1), (0, 1))  # anticlockwise about the axis
            quads = np.zeros((len(i), 4, 3), dtype=np.int64)
            for corner, (a, b) in enumerate(rounds if end else rounds[::-1]):
                quads[:, corner, axis] = end
                quads[:, corner, u] = i + a
                quads[:, corner, v] = j + b
            corners.append(quads)
    quads = np.concatenate(corners)
    places, number = np.unique(quads.reshape(-1, 3), axis=0, return_inverse=True)
    number = number.reshape(-1, 4)
    triangles = np.vstack([number[:, [0, 1, 2]], number[:, [0, 2, 3]]])
    return (places / n - 0.5) * np.asarray(size), np.ascontiguousarray(triangles, dtype=np.int64)
