"""Contacts beside the borders of rounded surfaces: vertex and edge, and two vertices.

Around its triangles a rounded surface has cylinders along the edges and spheres about the vertices. Their distances are
those of points from points and lines, whose first touch of a linear motion is the root of a quadratic.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import EDGE_VERTEX, VERTEX_EDGE, VERTEX_VERTEX, fixed_point
from heavylift.contours.triangles.feature_judge import HIT, NEAR, NEITHER, between, dot, minus, turn, turn_at
from heavylift.contours.triangles.feature_regions import SLACK, edge_is_nearest, vertex_is_nearest
from heavylift.contours.triangles.feature_report import UNIQUE, report
from heavylift.contours.triangles.surface_layout import OWNS_A, OWNS_AB
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.feature_report import ContactList
    from heavylift.contours.triangles.surface_layout import Edge, RelativeMotion, RelativePose
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records
    from heavylift.numerics.vectors import Vector

__all__ = ["rounded_contacts"]

STRICTLY = -1e-6
"""Slack of regions whose borders belong to a neighbour: faces to their edges, edges to their vertices."""


@kernel(internal=True)
def first_touch(d0: Vector, d1: Vector, radius: float, far: float) -> tuple[int, float]:
    """Whether a separation [m] that moves linearly comes down to a radius, or ends within `far`, and when."""
    u = minus(d1, d0)
    excess = dot(d0, d0) - radius * radius
    rate = dot(d0, u)
    square = dot(u, u)
    if excess > 0.0 and rate < 0.0:
        discriminant = rate * rate - square * excess
        if discriminant >= 0.0:
            t = excess / (math.sqrt(discriminant) - rate)
            if t <= 1.0:
                return HIT, t
    return (NEAR if dot(d1, d1) <= far * far else NEITHER), 1.0


@kernel(inline=True, internal=True)
def off_line(p: Vector, a: Vector, b: Vector) -> tuple[Vector, float]:
    """Offset [m] of a point from the line through a and b, and the place of its foot: 0 at a, 1 at b."""
    u = minus(b, a)
    r = minus(p, a)
    s = dot(r, u) / dot(u, u)
    return (r[0] - s * u[0], r[1] - s * u[1], r[2] - s * u[2]), s


@kernel(inline=True, internal=True)
def unit(d: Vector) -> tuple[Vector, float]:
    """Direction of a vector, and its length."""
    length = math.sqrt(dot(d, d))
    factor = 1.0 / length if length > 0.0 else 0.0
    return (factor * d[0], factor * d[1], factor * d[2]), length


@kernel(internal=True)
def judge_vertex_edge(
    # model
    points: NDArray[np.float64],
    edges: Records[Edge],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    edge_first: NDArray[np.int64],
    edge_inward: NDArray[np.float64],
    vertex: int,
    edge: int,
    # motion
    motion: RelativeMotion,
    edge_moves: bool,
    x0: Vector,
    x1: Vector,
    # limits
    radius: float,
    far: float,
) -> tuple[int, float, float]:
    """Verdict on a vertex (at both ends of the interval in the axes of the edge) and an edge; time; gap [m]."""
    a, b = fixed_point(points, edges[edge].ends[0]), fixed_point(points, edges[edge].ends[1])
    d0, s0 = off_line(x0, a, b)
    d1, s1 = off_line(x1, a, b)
    verdict, t = first_touch(d0, d1, radius, far)
    if verdict == NEITHER:
        return NEITHER, 1.0, 0.0
    s = s0 + t * (s1 - s0)
    d, length = unit(between(d0, d1, t))
    if length == 0.0 or s <= 0.0 or s >= 1.0:
        return NEITHER, 1.0, 0.0
    if not edge_is_nearest(edge_first, edge_inward, edge, d, STRICTLY):
        return NEITHER, 1.0, 0.0
    d = turn_at((-d[0], -d[1], -d[2]), motion, t, not edge_moves)
    if not vertex_is_nearest(points, vertex_first, vertex_neighbours, vertex, d, SLACK):
        return NEITHER, 1.0, 0.0
    return verdict, t, math.sqrt(dot(d1, d1)) - radius


@kernel(internal=True)
def judge_vertices(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex_a: int,
    vertex_b: int,
    # motion
    motion: RelativeMotion,
    x0: Vector,
    x1: Vector,
    # limits
    radius: float,
    far: float,
) -> tuple[int, float, float]:
    """Verdict on a vertex of A and one of B (at both ends of the interval in the axes of A); time; gap [m]."""
    a = fixed_point(points, vertex_a)
    d0, d1 = minus(x0, a), minus(x1, a)
    verdict, t = first_touch(d0, d1, radius, far)
    if verdict == NEITHER:
        return NEITHER, 1.0, 0.0
    d, length = unit(between(d0, d1, t))
    if length == 0.0 or not vertex_is_nearest(points, vertex_first, vertex_neighbours, vertex_a, d, STRICTLY):
        return NEITHER, 1.0, 0.0
    d = turn_at((-d[0], -d[1], -d[2]), motion, t, True)
    if not vertex_is_nearest(points, vertex_first, vertex_neighbours, vertex_b, d, STRICTLY):
        return NEITHER, 1.0, 0.0
    return verdict, t, math.sqrt(dot(d1, d1)) - radius


@kernel(inline=True, internal=True)
def in_axes_of_b(p: Vector, pose: RelativePose) -> Vector:
    """Point of A [m] in the axes of B."""
    shift = pose.origin
    return turn((p[0] - shift[0], p[1] - shift[1], p[2] - shift[2]), pose, True)


@kernel(inline=True, internal=True)
def rounded_contacts(
    # model
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    # motion
    motion: RelativeMotion,
    radius: float,
    far: float,
    rounding: float,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Report the contacts of all vertices and edges that two triangles own; see `contacts_of_pairs`."""
    points, triangles, edges = surfaces.points, surfaces.triangles, surfaces.edges
    for i in range(3):
        for j in range(3):
            row_a, row_b = triangles[ta].corners[i], triangles[tb].corners[j]
            edge_a, edge_b = triangles[ta].edges[i], triangles[tb].edges[j]
            own_a, own_b = triangles[ta].flags & (OWNS_A << i), triangles[tb].flags & (OWNS_A << j)
            own_edge_a = triangles[ta].flags & (OWNS_AB << i)
            own_edge_b = triangles[tb].flags & (OWNS_AB << j)
            a = fixed_point(points, row_a)
            x0 = fixed_point(out.corners, j)
            x1 = fixed_point(out.corners, 3 + j)
            for kind in range(VERTEX_EDGE, VERTEX_VERTEX + 1):
                verdict, time, gap = NEITHER, 1.0, 0.0
                feature_a, feature_b = row_a, row_b
                if kind == VERTEX_EDGE and own_b and own_edge_a:
                    feature_a = edge_a
                    verdict, time, gap = judge_vertex_edge(
                        points, edges, surfaces.vertex_first, surfaces.vertex_neighbours, surfaces.edge_first,
                        surfaces.edge_inward, row_b, edge_a, motion, False, x0, x1, radius, far,
                    )  # fmt: skip
                elif kind == EDGE_VERTEX and own_a and own_edge_b:
                    feature_b = edge_b
                    y0, y1 = in_axes_of_b(a, motion.start), in_axes_of_b(a, motion.end)
                    verdict, time, gap = judge_vertex_edge(
                        points, edges, surfaces.vertex_first, surfaces.vertex_neighbours, surfaces.edge_first,
                        surfaces.edge_inward, row_a, edge_b, motion, True, y0, y1, radius, far,
                    )  # fmt: skip
                elif kind == VERTEX_VERTEX and own_a and own_b:
                    verdict, time, gap = judge_vertices(
                        points, surfaces.vertex_first, surfaces.vertex_neighbours, row_a, row_b, motion, x0,
                        x1, radius, far,
                    )  # fmt: skip
                if verdict != NEITHER:
                    found = report(
                        points, edges, surfaces.normals, motion, kind, feature_a, feature_b, UNIQUE, verdict,
                        time, 1.0, gap, rounding, found, out,
                    )  # fmt: skip
                    if found < 0:
                        return found
    return found
