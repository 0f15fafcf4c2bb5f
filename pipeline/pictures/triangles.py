"""Triangles as pictures of surfaces need them: cut off at the sides of a box, the edges worth drawing, round shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["clip_triangles", "drawn_triangles", "welded"]


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


def drawn_triangles(
    surface: TriangleSurface,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """What a surface looks like: lone points and segments as the balls and capsules that they are.

    Returns
    -------
    tuple
        Points, shape (n, 3), triangles, shape (m, 3), and the row of the surface that each is drawn for, shape (m,).
    """
    from heavylift.pipeline.pictures.parts import shape_parts
    from heavylift.solver.scene.contacts import CapsuleShape, SphereShape

    faces = surface.faces
    found, triangles, source = [surface.points], [surface.triangles[faces]], [np.flatnonzero(faces)]
    count = len(surface.points)
    for row in np.flatnonzero(~faces):
        a, c = surface.points[surface.triangles[row, 0]], surface.points[surface.triangles[row, 2]]
        length = float(np.linalg.norm(c - a))
        radius = surface.radius
        shape = SphereShape(radius) if length == 0.0 else CapsuleShape(radius, 0.5 * length, (c - a) / length)
        (patch,) = shape_parts(shape).patches
        found.append(0.5 * (a + c) + patch.points)
        triangles.append(patch.triangles + count)
        source.append(np.full(len(patch.triangles), row))
        count += len(patch.points)
    return np.concatenate(found), np.concatenate(triangles), np.concatenate(source)
