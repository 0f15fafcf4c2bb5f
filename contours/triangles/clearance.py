"""Smallest distance between two surfaces where they stand, and the points where they are nearest.

Both trees are descended together, nearer boxes first; whatever cannot come nearer than the best pair of triangles so
far is left out (Quinlan, "Efficient distance computation between non-convex objects", IEEE International Conference on
Robotics and Automation, 1994; Ericson, *Real-Time Collision Detection*, 2005, section 6.3).

Two triangles are nearest at a vertex and a face or at two edges, or an edge of one goes through the other and they have
a point in common. Lone points and segments are triangles without extent.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import fixed_point, moved, moved_point, to_axes_of_b
from heavylift.contours.triangles.surface_tree import tree_depth
from heavylift.contours.triangles.triangle_distance import point_of, point_triangle, segment_segment
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record
from heavylift.numerics.vectors import Vector, between, cross, dot, rotate, subtract

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import BoundingBox, RelativePose
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.arrays import Floats1
    from heavylift.numerics.records import Records

__all__ = [
    "WaitingNodes",
    "clearance",
    "clearance_stack_size",
    "measure_clearance",
]

ROUNDING = 1e-15
"""Part of the coordinates by which nothing nearer is looked for: of plates side by side, all pairs are as near."""

BOUND_SLACK = 1e-9
"""Part of a given bound that is added to it: surfaces at rest stand exactly at theirs."""


class WaitingNodes(Record):
    """Two nodes that are still to be compared.

    Attributes
    ----------
    node_a, node_b
        Of the trees of A and B.
    squared_gap
        Squared distance of their boxes [m^2].
    """

    node_a: int
    node_b: int
    squared_gap: float


def clearance_stack_size(surfaces: CollisionSurfaces) -> int:
    """Places that `clearance` needs as scratch, for any pair of the surfaces of a scene."""
    depths = [tree_depth(surfaces.nodes, int(row.root)) for row in surfaces.surfaces]
    # every pair of nodes taken from the stack puts at most two back, one level deeper
    return max((one + other for one, other in combinations(depths, 2)), default=0) + 2


@entry
def measure_clearance(
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    pose: RelativePose,
    upper: float,
    stack: Records[WaitingNodes],
    out: Floats1,
) -> float:
    """`clearance` for callers in Python."""
    return clearance(surfaces, surface_a, surface_b, pose, upper, stack, out)


@kernel(internal=True)
def clearance(
    # model
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    # state
    pose: RelativePose,
    upper: float,
    # scratch
    stack: Records[WaitingNodes],
    # out
    out: NDArray[np.float64],
) -> float:
    """Smallest distance between two surfaces [m], rounding included; NaN for a pose that is not finite.

    Zero where they cross, below zero where only roundings overlap, and less than zero by both roundings where rounded
    surfaces cross.

    Parameters
    ----------
    surfaces, surface_a, surface_b
        All surfaces of a scene, and the numbers of two; boxes and normals must hold for their present points.
    pose
        Of B in the axes of A.
    upper
        What the distance hardly exceeds [m], infinite if unknown: the last distance and what points have moved since.
        It saves most of the search; if it is too small the search is done again without it.
    stack
        Of `clearance_stack_size`.
    out
        Nearest points of A and of B on their rounded surfaces [m], both in the axes of A, shape (6,).
    """
    radius_a, radius_b = surfaces.radii[surface_a], surfaces.radii[surface_b]
    size = surfaces.reaches[surface_a] + surfaces.reaches[surface_b]
    shift = pose.origin
    size += abs(shift[0]) + abs(shift[1]) + abs(shift[2])
    rounding = ROUNDING * size
    limit = upper + radius_a + radius_b
    limit += max(BOUND_SLACK * abs(limit), 4.0 * rounding)
    distance = math.inf
    for attempt in range(2):
        if distance == math.inf:
            distance = _search(
                surfaces,
                surfaces.surfaces[surface_a].root,
                surfaces.surfaces[surface_b].root,
                pose,
                limit if attempt == 0 else math.inf,
                rounding,
                stack,
                out,
            )
    if distance == math.inf:
        for k in range(6):
            out[k] = math.nan
        return math.nan
    if distance > 0.0:  # from the triangles to the surfaces around them
        for k in range(3):
            direction = (out[3 + k] - out[k]) / distance
            out[k] += radius_a * direction
            out[3 + k] -= radius_b * direction
    return distance - radius_a - radius_b


@kernel(internal=True)
def _search(
    # model
    surfaces: CollisionSurfaces,
    root_a: int,
    root_b: int,
    # state
    pose: RelativePose,
    limit: float,
    rounding: float,
    # scratch
    stack: Records[WaitingNodes],
    # out
    out: NDArray[np.float64],
) -> float:
    """Smallest distance of the triangles of two surfaces [m]; infinite if it is not below the limit."""
    nodes, boxes = surfaces.nodes, surfaces.boxes
    best = limit
    top = _push(stack, 0, root_a, root_b, 0.0)
    while top > 0:
        top -= 1
        if not stack[top].squared_gap < _square(best - rounding):
            continue
        node_a, node_b = stack[top].node_a, stack[top].node_b
        if not _squared_gap_in_b(boxes, node_a, node_b, pose) < _square(best - rounding):
            continue  # boxes that are turned against each other are smaller in their own axes
        left_a, left_b = nodes[node_a].left, nodes[node_b].left
        if left_a < 0 and left_b < 0:
            best = _leaves(surfaces, node_a, node_b, pose, best, rounding, out)
            continue
        if left_a >= 0 and (left_b < 0 or _size(boxes, node_a) >= _size(boxes, node_b)):
            near_a, near_b, far_a, far_b = left_a, node_b, left_a + 1, node_b
        else:
            near_a, near_b, far_a, far_b = node_a, left_b, node_a, left_b + 1
        near = _squared_gap(boxes, near_a, near_b, pose)
        far = _squared_gap(boxes, far_a, far_b, pose)
        if far < near:
            near_a, near_b, far_a, far_b = far_a, far_b, near_a, near_b
            near, far = far, near
        reach = _square(best - rounding)
        if far < reach:
            top = _push(stack, top, far_a, far_b, far)
        if near < reach:
            top = _push(stack, top, near_a, near_b, near)
    return best if best < limit else math.inf


@kernel(inline=True, internal=True)
def _push(stack: Records[WaitingNodes], top: int, node_a: int, node_b: int, squared_gap: float) -> int:
    """Put two nodes on the stack; returns its new height."""
    stack[top].node_a = node_a
    stack[top].node_b = node_b
    stack[top].squared_gap = squared_gap
    return top + 1


@kernel(inline=True, internal=True)
def _square(length: float) -> float:
    """Square of a length that is not below zero; NaN stays NaN, and ends the search."""
    return 0.0 if length <= 0.0 else length * length


@kernel(inline=True, internal=True)
def _size(boxes: Records[BoundingBox], node: int) -> float:
    """Sum of the half lengths of a box [m]."""
    half = boxes[node].half
    return half[0] + half[1] + half[2]


@kernel(inline=True, internal=True)
def _squared_gap(boxes: Records[BoundingBox], node_a: int, node_b: int, pose: RelativePose) -> float:
    """Squared distance of a box of A from the box along the axes of A around one of B [m^2]."""
    half = boxes[node_b].half
    hx, hy, hz = half[0], half[1], half[2]
    R = pose.rotation
    hx, hy, hz = (
        abs(R[0]) * hx + abs(R[1]) * hy + abs(R[2]) * hz,
        abs(R[3]) * hx + abs(R[4]) * hy + abs(R[5]) * hz,
        abs(R[6]) * hx + abs(R[7]) * hy + abs(R[8]) * hz,
    )
    return _squared_gap_to(boxes, node_a, moved(boxes[node_b].centre, pose), (hx, hy, hz))


@kernel(inline=True, internal=True)
def _squared_gap_in_b(boxes: Records[BoundingBox], node_a: int, node_b: int, pose: RelativePose) -> float:
    """Squared distance of a box of B from the box along the axes of B around one of A [m^2]."""
    half = boxes[node_a].half
    hx, hy, hz = half[0], half[1], half[2]
    R = pose.rotation
    around = (
        abs(R[0]) * hx + abs(R[3]) * hy + abs(R[6]) * hz,
        abs(R[1]) * hx + abs(R[4]) * hy + abs(R[7]) * hz,
        abs(R[2]) * hx + abs(R[5]) * hy + abs(R[8]) * hz,
    )
    return _squared_gap_to(boxes, node_b, to_axes_of_b(boxes[node_a].centre, pose), around)


@kernel(inline=True, internal=True)
def _squared_gap_to(boxes: Records[BoundingBox], row: int, centre: Vector, half: Vector) -> float:
    """Squared distance of a box of A from one given in the same axes [m^2]."""
    box = boxes[row]
    x = abs(box.centre[0] - centre[0]) - box.half[0] - half[0]
    y = abs(box.centre[1] - centre[1]) - box.half[1] - half[1]
    z = abs(box.centre[2] - centre[2]) - box.half[2] - half[2]
    return _square(x) + _square(y) + _square(z)


@kernel(internal=True)
def _leaves(
    # model
    surfaces: CollisionSurfaces,
    node_a: int,
    node_b: int,
    # state
    pose: RelativePose,
    best: float,
    rounding: float,
    # out
    out: NDArray[np.float64],
) -> float:
    """Smallest distance [m] of the triangles of a leaf of A from those of one of B, or the best so far."""
    points, triangles, normals = surfaces.points, surfaces.triangles, surfaces.normals
    first_a, first_b = surfaces.nodes[node_a].first, surfaces.nodes[node_b].first
    end_a, end_b = first_a + surfaces.nodes[node_a].count, first_b + surfaces.nodes[node_b].count
    for tb in range(first_b, end_b):
        p = moved_point(points, triangles[tb].corners[0], pose)
        q = moved_point(points, triangles[tb].corners[1], pose)
        r = moved_point(points, triangles[tb].corners[2], pose)
        m = rotate(pose.rotation, fixed_point(normals, tb))
        low_x, high_x = min(p[0], q[0], r[0]), max(p[0], q[0], r[0])
        low_y, high_y = min(p[1], q[1], r[1]), max(p[1], q[1], r[1])
        low_z, high_z = min(p[2], q[2], r[2]), max(p[2], q[2], r[2])
        centre = (0.5 * (low_x + high_x), 0.5 * (low_y + high_y), 0.5 * (low_z + high_z))
        half = (0.5 * (high_x - low_x), 0.5 * (high_y - low_y), 0.5 * (high_z - low_z))
        for ta in range(first_a, end_a):
            if _squared_gap_to(surfaces.triangle_boxes, ta, centre, half) < _square(best - rounding):
                a = fixed_point(points, triangles[ta].corners[0])
                b = fixed_point(points, triangles[ta].corners[1])
                c = fixed_point(points, triangles[ta].corners[2])
                n = fixed_point(normals, ta)
                best = triangle_distance(a, b, c, n, p, q, r, m, best, rounding, out)
    return best


@kernel(internal=True)  # eleven parameters: two triangles, each with its normal
def triangle_distance(
    a: Vector,
    b: Vector,
    c: Vector,
    n: Vector,
    p: Vector,
    q: Vector,
    r: Vector,
    m: Vector,
    best: float,
    rounding: float,
    out: NDArray[np.float64],
) -> float:
    """Distance [m] of two triangles if it is less than the best so far, else that.

    Heights over the plane of the other triangle leave out most vertices and edges.

    Parameters
    ----------
    a, b, c, n
        Corners [m] and unit normal of the first; a normal of zeros is right for any, and needed without extent.
    p, q, r, m
        Of the second, in the same axes.
    best
        Distance [m] below which the triangles matter.
    rounding
        Part of it [m] that is not worth the search.
    out
        Nearest points [m] of the first and of the second if they are nearer than `best`, else as before; shape (6,).
    """
    reach = best - rounding
    sp, sq, sr = dot(n, subtract(p, a)), dot(n, subtract(q, a)), dot(n, subtract(r, a))
    if min(sp, sq, sr) >= reach or max(sp, sq, sr) <= -reach:
        return best
    sa, sb, sc = dot(m, subtract(a, p)), dot(m, subtract(b, p)), dot(m, subtract(c, p))
    if min(sa, sb, sc) >= reach or max(sa, sb, sc) <= -reach:
        return best
    # all heights over a segment are zero, and it may go through a face
    if min(sp, sq, sr) <= 0.0 <= max(sp, sq, sr) and min(sa, sb, sc) <= 0.0 <= max(sa, sb, sc):
        for i in range(3):
            e0, e1 = (a, b) if i == 0 else ((b, c) if i == 1 else (c, a))
            s0, s1 = (sa, sb) if i == 0 else ((sb, sc) if i == 1 else (sc, sa))
            f0, f1 = (p, q) if i == 0 else ((q, r) if i == 1 else (r, p))
            t0, t1 = (sp, sq) if i == 0 else ((sq, sr) if i == 1 else (sr, sp))
            through, place = False, e0
            if s0 * s1 < 0.0:
                through = _line_goes_through(e0, e1, p, q, r)
                place = between(e0, e1, s0 / (s0 - s1))
            if not through and t0 * t1 < 0.0:
                through = _line_goes_through(f0, f1, a, b, c)
                place = between(f0, f1, t0 / (t0 - t1))
            if through:
                _keep(out, place, place)
                return 0.0
    for i in range(3):
        x, height = (p, sp) if i == 0 else ((q, sq) if i == 1 else (r, sr))
        if abs(height) < best:
            d, u, v = point_triangle(x, a, b, c)
            if d < best:
                best = d
                _keep(out, point_of(a, b, c, u, v), x)
        x, height = (a, sa) if i == 0 else ((b, sb) if i == 1 else (c, sc))
        if abs(height) < best:
            d, u, v = point_triangle(x, p, q, r)
            if d < best:
                best = d
                _keep(out, x, point_of(p, q, r, u, v))
    for i in range(3):
        e0, e1 = (a, b) if i == 0 else ((b, c) if i == 1 else (c, a))
        s0, s1 = (sa, sb) if i == 0 else ((sb, sc) if i == 1 else (sc, sa))
        if min(s0, s1) >= best or max(s0, s1) <= -best:
            continue
        for j in range(3):
            f0, f1 = (p, q) if j == 0 else ((q, r) if j == 1 else (r, p))
            t0, t1 = (sp, sq) if j == 0 else ((sq, sr) if j == 1 else (sr, sp))
            if min(t0, t1) >= best or max(t0, t1) <= -best:
                continue
            d, s, t = segment_segment(e0, e1, f0, f1)
            if d < best:
                best = d
                _keep(out, between(e0, e1, s), between(f0, f1, t))
    return best


@kernel(internal=True)
def _line_goes_through(e: Vector, f: Vector, a: Vector, b: Vector, c: Vector) -> bool:
    """Whether the line through two points goes through a triangle or its border."""
    along = subtract(f, e)
    a, b, c = subtract(a, e), subtract(b, e), subtract(c, e)
    x = dot(along, cross(a, b))
    y = dot(along, cross(b, c))
    z = dot(along, cross(c, a))
    return min(x, y, z) >= 0.0 or max(x, y, z) <= 0.0


@kernel(inline=True, internal=True)
def _keep(out: NDArray[np.float64], of_a: Vector, of_b: Vector) -> None:
    """Nearest points so far."""
    out[0], out[1], out[2] = of_a
    out[3], out[4], out[5] = of_b
