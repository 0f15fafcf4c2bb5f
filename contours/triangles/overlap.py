"""Whether two surfaces overlap where they stand: which triangles, how deep, and where.

Swept tests ask for surfaces that are clear of each other at the start. Those that are not have an edge of one that goes
through a face of the other. How deep two triangles are in each other is the least of their overlaps along the normals
and across pairs of edges (separating axes: Ericson, *Real-Time Collision Detection*, 2005, section 5.2.1).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.contours.triangles.feature_gap import fixed_point, moved, moved_point
from heavylift.contours.triangles.feature_judge import inside_face
from heavylift.contours.triangles.surface_layout import IS_FACE, pose_of
from heavylift.contours.triangles.surface_tree import tree_depth
from heavylift.contours.triangles.triangle_distance import point_of, point_triangle, segment_segment
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.vectors import Vector, between, cross, dot, rotate, subtract

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.contours.triangles.surface_layout import BoundingBox, RelativePose
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.arrays import Floats1, Ints1, Ints2
    from heavylift.numerics.records import Records

__all__ = ["Overlap", "find_overlap"]

TOUCHING = 1e-9
"""Part of the smaller surface up to which an overlap is rounding."""

ALONG = 1e-6
"""Sine of the angle between edges below which their product is no axis."""


class Overlap(NamedTuple):
    """Where two surfaces overlap most.

    Attributes
    ----------
    triangle_a, triangle_b
        Rows of the packed triangles; -1 if the surfaces are clear of each other.
    depth
        Shortest way by which one of the triangles comes clear of the other [m]; of rounded surfaces that do not meet
        without their rounding, how far their roundings overlap.
    place
        Where an edge of one goes through the other [m], in the axes of A, shape (3,).
    """

    triangle_a: int
    triangle_b: int
    depth: float
    place: NDArray[np.float64]


def find_overlap(surfaces: CollisionSurfaces, a: int, b: int, R: ArrayLike, p: ArrayLike) -> Overlap:
    """Deepest place at which an edge of one surface goes through a face of another.

    Parameters
    ----------
    surfaces
        All surfaces of a scene.
    a, b
        Numbers of two of them.
    R, p
        Rotation, shape (3, 3), and position [m], shape (3,), of B in the axes of A: ``x_A = R x_B + p``.
    """
    depths = [tree_depth(surfaces.nodes, int(surfaces.surfaces[s].root)) for s in (a, b)]
    stack = np.zeros((4 + 3 * sum(depths), 2), dtype=np.int64)
    triangles = np.full(2, -1, dtype=np.int64)
    found = np.zeros(4)
    deepest_overlap(surfaces, a, b, pose_of(R, p), stack, triangles, found)
    return Overlap(int(triangles[0]), int(triangles[1]), float(found[0]), found[1:].copy())


@kernel(inline=True, internal=True)
def _far_apart(
    boxes: Records[BoundingBox], node_a: int, node_b: int, pose: RelativePose, margin: float
) -> bool:
    """Whether a box of A and a turned box of B are clear of each other along the axes of A."""
    R, place, reach = pose.rotation, boxes[node_b].centre, boxes[node_b].half
    centre = moved((place[0], place[1], place[2]), pose)
    for k in range(3):
        half = abs(R[3 * k]) * reach[0] + abs(R[3 * k + 1]) * reach[1] + abs(R[3 * k + 2]) * reach[2]
        distance = abs(centre[k] - boxes[node_a].centre[k])
        if distance > half + boxes[node_a].half[k] + margin:
            return True
    return False


@kernel(inline=True, internal=True)
def _through(p: Vector, q: Vector, a: Vector, b: Vector, c: Vector, n: Vector) -> tuple[bool, Vector]:
    """Whether the edge from p to q goes through a face, and where."""
    sp, sq = dot(n, subtract(p, a)), dot(n, subtract(q, a))
    if sp * sq >= 0.0:
        return False, p
    place = between(p, q, sp / (sp - sq))
    return inside_face(place, a, b, c, n), place


@kernel(internal=True)
def _shared_along(axis: Vector, a: Vector, b: Vector, c: Vector, p: Vector, q: Vector, r: Vector) -> float:
    """How far [m] one triangle must move along an axis to be clear of the other; infinite for no axis."""
    length = math.sqrt(dot(axis, axis))
    if length == 0.0:
        return math.inf
    s, t, u = dot(axis, a), dot(axis, b), dot(axis, c)
    x, y, z = dot(axis, p), dot(axis, q), dot(axis, r)
    return max(0.0, min(max(s, t, u) - min(x, y, z), max(x, y, z) - min(s, t, u)) / length)


@kernel(internal=True)
def _shared(a: Vector, b: Vector, c: Vector, n: Vector, p: Vector, q: Vector, r: Vector, m: Vector) -> float:
    """Shortest way [m] by which one triangle comes clear of another: along a normal, or across two edges."""
    least = min(_shared_along(n, a, b, c, p, q, r), _shared_along(m, a, b, c, p, q, r))
    for i in range(3):
        e = subtract(b, a) if i == 0 else (subtract(c, b) if i == 1 else subtract(a, c))
        for j in range(3):
            f = subtract(q, p) if j == 0 else (subtract(r, q) if j == 1 else subtract(p, r))
            axis = cross(e, f)
            if dot(axis, axis) > ALONG * ALONG * dot(e, e) * dot(f, f):
                least = min(least, _shared_along(axis, a, b, c, p, q, r))
    return least


@kernel(internal=True)
def _rounded_distance(
    a: Vector, b: Vector, c: Vector, p: Vector, q: Vector, r: Vector
) -> tuple[float, Vector]:
    """Distance [m] of two triangles that do not meet, and a point between the nearest ones."""
    best, place = math.inf, a
    for i in range(3):
        x = p if i == 0 else (q if i == 1 else r)
        d, u, v = point_triangle(x, a, b, c)
        if d < best:
            best = d
            place = between(x, point_of(a, b, c, u, v), 0.5)
        x = a if i == 0 else (b if i == 1 else c)
        d, u, v = point_triangle(x, p, q, r)
        if d < best:
            best = d
            place = between(x, point_of(p, q, r, u, v), 0.5)
        e0, e1 = (a, b) if i == 0 else ((b, c) if i == 1 else (c, a))
        for j in range(3):
            f0, f1 = (p, q) if j == 0 else ((q, r) if j == 1 else (r, p))
            d, s, t = segment_segment(e0, e1, f0, f1)
            if d < best:
                best = d
                place = between(between(e0, e1, s), between(f0, f1, t), 0.5)
    return best, place


@entry
def deepest_overlap(
    # model
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    # state
    pose: RelativePose,
    # scratch
    stack: Ints2,
    # out
    triangles: Ints1,
    found: Floats1,
) -> None:
    """`find_overlap`: triangles, shape (2,), stay as they are if there is none; depth and place, shape (4,)."""
    nodes, boxes = surfaces.nodes, surfaces.boxes
    radius = surfaces.radii[surface_a] + surfaces.radii[surface_b]
    found[0] = TOUCHING * max(min(surfaces.reaches[surface_a], surfaces.reaches[surface_b]), radius)
    stack[0, 0] = surfaces.surfaces[surface_a].root
    stack[0, 1] = surfaces.surfaces[surface_b].root
    waiting = 1
    while waiting > 0:
        waiting -= 1
        node_a, node_b = stack[waiting, 0], stack[waiting, 1]
        if _far_apart(boxes, node_a, node_b, pose, radius):
            continue
        left_a, left_b = nodes[node_a].left, nodes[node_b].left
        if left_a >= 0 and (left_b < 0 or _size(boxes, node_a) >= _size(boxes, node_b)):
            for child in range(2):
                stack[waiting, 0], stack[waiting, 1] = left_a + child, node_b
                waiting += 1
        elif left_b >= 0:
            for child in range(2):
                stack[waiting, 0], stack[waiting, 1] = node_a, left_b + child
                waiting += 1
        else:
            first_a, first_b = nodes[node_a].first, nodes[node_b].first
            for ta in range(first_a, first_a + nodes[node_a].count):
                for tb in range(first_b, first_b + nodes[node_b].count):
                    _compare(surfaces, ta, tb, radius, pose, triangles, found)
    if triangles[0] < 0:
        found[0] = 0.0


@kernel(inline=True, internal=True)
def _size(boxes: Records[BoundingBox], node: int) -> float:
    """Sum of the half lengths of a box [m]."""
    half = boxes[node].half
    return half[0] + half[1] + half[2]


@kernel(inline=True, internal=True)
def _compare(
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    radius: float,
    pose: RelativePose,
    triangles: NDArray[np.int64],
    found: NDArray[np.float64],
) -> None:
    """Keep the overlap of two triangles if it is deeper than the one found so far."""
    points, rows, normals = surfaces.points, surfaces.triangles, surfaces.normals
    a = fixed_point(points, rows[ta].corners[0])
    b = fixed_point(points, rows[ta].corners[1])
    c = fixed_point(points, rows[ta].corners[2])
    p = moved_point(points, rows[tb].corners[0], pose)
    q = moved_point(points, rows[tb].corners[1], pose)
    r = moved_point(points, rows[tb].corners[2], pose)
    n = fixed_point(normals, ta)
    m = rotate(pose.rotation, fixed_point(normals, tb))
    through, place = False, a
    if rows[tb].flags & IS_FACE and rows[ta].flags & IS_FACE:
        for k in range(3):
            if not through:
                e, f = (p, q) if k == 0 else ((q, r) if k == 1 else (r, p))
                through, place = _through(e, f, a, b, c, n)
            if not through:
                e, f = (a, b) if k == 0 else ((b, c) if k == 1 else (c, a))
                through, place = _through(e, f, p, q, r, m)
    depth = _shared(a, b, c, n, p, q, r, m) if through else 0.0
    if radius > 0.0 and not through:
        distance, place = _rounded_distance(a, b, c, p, q, r)
        depth = radius - distance
    if depth > found[0]:
        triangles[0], triangles[1] = ta, tb
        found[0] = depth
        found[1], found[2], found[3] = place
