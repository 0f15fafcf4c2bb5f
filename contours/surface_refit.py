"""Trees, normals and edges of a surface whose points have moved in the axes of its body, as on a flexible one.

The tree keeps its shape and its boxes are made anew from the leaves up (van den Bergen, "Efficient collision detection
of complex deformable models using AABB trees", Journal of Graphics Tools 2, 1997).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.surface_layout import (
    BOX_CENTRE,
    BOX_HALF,
    CORNER_A,
    CORNER_B,
    CORNER_C,
    EDGE_END,
    EDGE_START,
    FIRST_EDGE,
    FIRST_POINT,
    FIRST_TRIANGLE,
    FLAGS,
    IS_FACE,
    NODE_COUNT,
    NODE_FIRST,
    NODE_LEFT,
    POINT_COUNT,
    ROOT_NODE,
    TRIANGLE_COUNT,
)
from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cross

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.surface_pack import CollisionSurfaces

__all__ = ["refit_surface"]


@kernel(internal=True)
def refit_surface(surfaces: CollisionSurfaces, surface: int) -> float:
    """Bring all that follows from the points of a surface up to date, after they have been written.

    Parameters
    ----------
    surfaces
        Of the scene; boxes, normals, `edge_inward`, `reaches`, `fitted_points` and `travels` change.
    surface
        Number of the surface.

    Returns
    -------
    float
        Longest way of a point since the last refit [m]. Lists of pairs allow for it by themselves.

    Notes
    -----
    A face or edge that has shrunk to nothing keeps its direction.
    """
    row = surfaces.surfaces[surface]
    triangle = row[FIRST_TRIANGLE]
    end = triangle + row[TRIANGLE_COUNT]
    last = surface + 1 == surfaces.surfaces.shape[0]
    end_node = surfaces.nodes.shape[0] if last else surfaces.surfaces[surface + 1, ROOT_NODE]
    end_edge = surfaces.edges.shape[0] if last else surfaces.surfaces[surface + 1, FIRST_EDGE]
    first_point = row[FIRST_POINT]
    way = _advance_points(
        surfaces.points, surfaces.fitted_points, first_point, first_point + row[POINT_COUNT]
    )
    surfaces.travels[surface] += way
    squared_reach = _refit_triangles(
        surfaces.points, surfaces.triangles, triangle, end, surfaces.triangle_boxes, surfaces.normals
    )
    surfaces.reaches[surface] = math.sqrt(squared_reach)
    _refit_nodes(surfaces.nodes, surfaces.triangle_boxes, row[ROOT_NODE], end_node, surfaces.boxes)
    _refit_edges(
        surfaces.points,
        surfaces.edges,
        surfaces.edge_first,
        surfaces.edge_opposite,
        row[FIRST_EDGE],
        end_edge,
        surfaces.edge_inward,
    )
    return way


@kernel(internal=True)
def _advance_points(points: NDArray[np.float64], fitted: NDArray[np.float64], first: int, end: int) -> float:
    """Longest way of some points since the last refit [m]; they become the fitted ones."""
    longest = 0.0
    for i in range(first, end):
        squared = 0.0
        for k in range(3):
            change = points[i, k] - fitted[i, k]
            squared += change * change
            fitted[i, k] = points[i, k]
        longest = max(longest, squared)
    return math.sqrt(longest)


@kernel(internal=True)
def _refit_triangles(
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    first: int,
    end: int,
    # out
    boxes: NDArray[np.float64],
    normals: NDArray[np.float64],
) -> float:
    """Boxes and normals; returns the largest squared distance of a corner from the origin [m^2]."""
    farthest = 0.0
    for t in range(first, end):
        a = triangles[t, CORNER_A]
        b = triangles[t, CORNER_B]
        c = triangles[t, CORNER_C]
        aa = 0.0
        bb = 0.0
        cc = 0.0
        for k in range(3):
            low = min(points[a, k], points[b, k], points[c, k])
            high = max(points[a, k], points[b, k], points[c, k])
            aa += points[a, k] * points[a, k]
            bb += points[b, k] * points[b, k]
            cc += points[c, k] * points[c, k]
            boxes[t, BOX_CENTRE + k] = 0.5 * (low + high)
            boxes[t, BOX_HALF + k] = 0.5 * (high - low)
        farthest = max(farthest, aa, bb, cc)
        if triangles[t, FLAGS] & IS_FACE:
            x, y, z = cross(
                points[b, 0] - points[a, 0],
                points[b, 1] - points[a, 1],
                points[b, 2] - points[a, 2],
                points[c, 0] - points[a, 0],
                points[c, 1] - points[a, 1],
                points[c, 2] - points[a, 2],
            )
            length = math.sqrt(x * x + y * y + z * z)
            if length > 0.0:
                normals[t, 0] = x / length
                normals[t, 1] = y / length
                normals[t, 2] = z / length
    return farthest


@kernel(internal=True)
def _refit_nodes(
    nodes: NDArray[np.int64],
    triangle_boxes: NDArray[np.float64],
    root: int,
    end: int,
    # out
    boxes: NDArray[np.float64],
) -> None:
    """Boxes of leaves from triangles, others from their children, which come after them."""
    for node in range(end - 1, root - 1, -1):
        left = nodes[node, NODE_LEFT]
        first = nodes[node, NODE_FIRST]
        for k in range(3):
            low = math.inf
            high = -math.inf
            if left >= 0:
                for child in range(left, left + 2):
                    low = min(low, boxes[child, BOX_CENTRE + k] - boxes[child, BOX_HALF + k])
                    high = max(high, boxes[child, BOX_CENTRE + k] + boxes[child, BOX_HALF + k])
            else:
                for t in range(first, first + nodes[node, NODE_COUNT]):
                    low = min(low, triangle_boxes[t, BOX_CENTRE + k] - triangle_boxes[t, BOX_HALF + k])
                    high = max(high, triangle_boxes[t, BOX_CENTRE + k] + triangle_boxes[t, BOX_HALF + k])
            boxes[node, BOX_CENTRE + k] = 0.5 * (low + high)
            boxes[node, BOX_HALF + k] = 0.5 * (high - low)


@kernel(internal=True)
def _refit_edges(
    points: NDArray[np.float64],
    edges: NDArray[np.int64],
    edge_first: NDArray[np.int64],
    edge_opposite: NDArray[np.int64],
    first: int,
    end: int,
    # out
    edge_inward: NDArray[np.float64],
) -> None:
    """Directions from edges into their faces."""
    for e in range(first, end):
        a = edges[e, EDGE_START]
        b = edges[e, EDGE_END]
        dx = points[b, 0] - points[a, 0]
        dy = points[b, 1] - points[a, 1]
        dz = points[b, 2] - points[a, 2]
        dd = dx * dx + dy * dy + dz * dz
        if dd > 0.0:
            for j in range(edge_first[e], edge_first[e + 1]):
                c = edge_opposite[j]
                x = points[c, 0] - points[a, 0]
                y = points[c, 1] - points[a, 1]
                z = points[c, 2] - points[a, 2]
                length = 1.0
                for _ in range(2):  # once more: of a sliver little is left by the first
                    along = (x * dx + y * dy + z * dz) / dd
                    x -= along * dx
                    y -= along * dy
                    z -= along * dz
                    length = math.sqrt(x * x + y * y + z * z)
                if length > 0.0:
                    edge_inward[j, 0] = x / length
                    edge_inward[j, 1] = y / length
                    edge_inward[j, 2] = z / length
