"""Trees, normals and edges of a surface whose points have moved in the axes of its body, as on a flexible one.

The tree keeps its shape and its boxes are made anew from the leaves up (van den Bergen, "Efficient collision detection
of complex deformable models using AABB trees", Journal of Graphics Tools 2, 1997).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.surface_layout import IS_FACE
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross, subtract

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import BoundingBox, Edge, TreeNode, Triangle
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records

__all__ = ["refit_features", "refit_surface"]


@kernel(internal=True)
def refit_surface(surfaces: CollisionSurfaces, surface: int) -> float:
    """Bring all that follows from the points of a surface up to date, after they have been written.

    Parameters
    ----------
    surfaces
        Of the scene; boxes, normals, `edge_inward`, `reaches`, `middles`, `fitted_points` and `travels` change.
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
    triangle = row.first_triangle
    end = triangle + row.triangle_count
    last = surface + 1 == surfaces.surfaces.shape[0]
    end_node = surfaces.nodes.shape[0] if last else surfaces.surfaces[surface + 1].root
    end_edge = surfaces.edges.shape[0] if last else surfaces.surfaces[surface + 1].first_edge
    first_point = row.first_point
    way = _advance_points(surfaces.points, surfaces.fitted_points, first_point, first_point + row.point_count)
    surfaces.travels[surface] += way
    squared_reach = _refit_triangles(
        surfaces.points, surfaces.triangles, triangle, end, surfaces.triangle_boxes, surfaces.normals
    )
    surfaces.reaches[surface] = math.sqrt(squared_reach)
    _refit_nodes(surfaces.nodes, surfaces.triangle_boxes, row.root, end_node, surfaces.boxes)
    for k in range(3):
        surfaces.middles[surface, k] = surfaces.boxes[row.root].centre[k]
    _refit_edges(
        surfaces.points,
        surfaces.edges,
        surfaces.edge_first,
        surfaces.edge_opposite,
        row.first_edge,
        end_edge,
        surfaces.edge_inward,
    )
    return way


@kernel(internal=True)
def refit_features(
    surfaces: CollisionSurfaces,
    triangles: NDArray[np.int64],
    first_triangle: int,
    triangle_count: int,
    edges: NDArray[np.int64],
    first_edge: int,
    edge_count: int,
) -> None:
    """Bring boxes and normals of some triangles, and directions from some edges into their faces, up to date.

    Parameters
    ----------
    surfaces
        Of the scene; their trees stay as they are.
    triangles, first_triangle, triangle_count
        Rows of the triangles, and which of these are meant.
    edges, first_edge, edge_count
        The same of edges.
    """
    for i in range(first_triangle, first_triangle + triangle_count):
        t = triangles[i]
        _refit_triangles(
            surfaces.points, surfaces.triangles, t, t + 1, surfaces.triangle_boxes, surfaces.normals
        )
    for i in range(first_edge, first_edge + edge_count):
        e = edges[i]
        _refit_edges(
            surfaces.points,
            surfaces.edges,
            surfaces.edge_first,
            surfaces.edge_opposite,
            e,
            e + 1,
            surfaces.edge_inward,
        )


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
    triangles: Records[Triangle],
    first: int,
    end: int,
    # out
    boxes: Records[BoundingBox],
    normals: NDArray[np.float64],
) -> float:
    """Boxes and normals; returns the largest squared distance of a corner from the origin [m^2]."""
    farthest = 0.0
    for t in range(first, end):
        a = triangles[t].corners[0]
        b = triangles[t].corners[1]
        c = triangles[t].corners[2]
        aa = 0.0
        bb = 0.0
        cc = 0.0
        for k in range(3):
            low = min(points[a, k], points[b, k], points[c, k])
            high = max(points[a, k], points[b, k], points[c, k])
            aa += points[a, k] * points[a, k]
            bb += points[b, k] * points[b, k]
            cc += points[c, k] * points[c, k]
            boxes[t].centre[k] = 0.5 * (low + high)
            boxes[t].half[k] = 0.5 * (high - low)
        farthest = max(farthest, aa, bb, cc)
        if triangles[t].flags & IS_FACE:
            x, y, z = cross(
                subtract(points[b], points[a]),
                subtract(points[c], points[a]),
            )
            length = math.sqrt(x * x + y * y + z * z)
            if length > 0.0:
                normals[t, 0] = x / length
                normals[t, 1] = y / length
                normals[t, 2] = z / length
    return farthest


@kernel(internal=True)
def _refit_nodes(
    nodes: Records[TreeNode],
    triangle_boxes: Records[BoundingBox],
    root: int,
    end: int,
    # out
    boxes: Records[BoundingBox],
) -> None:
    """Boxes of leaves from triangles, others from their children, which come after them."""
    for node in range(end - 1, root - 1, -1):
        left = nodes[node].left
        first = nodes[node].first
        for k in range(3):
            low = math.inf
            high = -math.inf
            if left >= 0:
                for child in range(left, left + 2):
                    low = min(low, boxes[child].centre[k] - boxes[child].half[k])
                    high = max(high, boxes[child].centre[k] + boxes[child].half[k])
            else:
                for t in range(first, first + nodes[node].count):
                    low = min(low, triangle_boxes[t].centre[k] - triangle_boxes[t].half[k])
                    high = max(high, triangle_boxes[t].centre[k] + triangle_boxes[t].half[k])
            boxes[node].centre[k] = 0.5 * (low + high)
            boxes[node].half[k] = 0.5 * (high - low)


@kernel(internal=True)
def _refit_edges(
    points: NDArray[np.float64],
    edges: Records[Edge],
    edge_first: NDArray[np.int64],
    edge_opposite: NDArray[np.int64],
    first: int,
    end: int,
    # out
    edge_inward: NDArray[np.float64],
) -> None:
    """Directions from edges into their faces."""
    for e in range(first, end):
        a = edges[e].ends[0]
        b = edges[e].ends[1]
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
