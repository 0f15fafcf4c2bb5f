"""Smallest distance between two surfaces where they stand, and the points where they are nearest.

Both trees are descended together, nearer boxes first; whatever cannot come nearer than the best pair of triangles so
far is left out (Quinlan, "Efficient distance computation between non-convex objects", IEEE International Conference on
Robotics and Automation, 1994; Ericson, *Real-Time Collision Detection*, 2005, section 6.3).
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.contours.feature_gap import fixed_point, moved_point
from heavylift.contours.feature_judge import minus, turn
from heavylift.contours.surface_layout import (
    BOX_CENTRE,
    BOX_HALF,
    CORNER_A,
    CORNER_B,
    CORNER_C,
    NODE_COUNT,
    NODE_FIRST,
    NODE_LEFT,
    ROOT_NODE,
)
from heavylift.contours.surface_tree import tree_depth
from heavylift.contours.triangle_pair import triangle_distance
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.contours.surface_pack import CollisionSurfaces
    from heavylift.numerics.arrays import Floats1

__all__ = ["Clearance", "clearance", "clearance_stack_size", "find_clearance", "measure_clearance"]

ROUNDING = 1e-15
"""Part of the coordinates by which nothing nearer is looked for: of plates side by side, all pairs are as near."""

BOUND_SLACK = 1e-9
"""Part of a given bound that is added to it: surfaces at rest stand exactly at theirs."""

STACK_WIDTH = 3
"""A pair of nodes, numbers: node of A, node of B, squared distance of their boxes [m^2]."""

Vector = tuple[float, float, float]


class Clearance(NamedTuple):
    """Where two surfaces are nearest to each other.

    Attributes
    ----------
    distance
        Between the surfaces, rounding included [m]: zero where they cross, below zero where only roundings overlap,
        and less than zero by both roundings where rounded surfaces cross.
    point_a, point_b
        Nearest points [m], both in the axes of A, shape (3,).
    """

    distance: float
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]


def clearance_stack_size(surfaces: CollisionSurfaces) -> int:
    """Places that `clearance` needs as scratch, for any pair of the surfaces of a scene."""
    depths = [tree_depth(surfaces.nodes, int(row[ROOT_NODE])) for row in surfaces.surfaces]
    # every pair of nodes taken from the stack puts at most two back, one level deeper
    deepest = max((one + other for one, other in combinations(depths, 2)), default=0) + 2
    return STACK_WIDTH * deepest


def find_clearance(
    surfaces: CollisionSurfaces, a: int, b: int, R: ArrayLike, p: ArrayLike, upper: float = math.inf
) -> Clearance:
    """Smallest distance between two surfaces.

    Parameters
    ----------
    surfaces
        All surfaces of a scene.
    a, b
        Numbers of two different ones.
    R, p
        Rotation, shape (3, 3), and position [m], shape (3,), of B in the axes of A: ``x_A = R x_B + p``.
    upper
        What the distance hardly exceeds [m], for speed; see `clearance`.
    """
    pose = np.concatenate([np.ravel(np.asarray(R, dtype=np.float64)), np.asarray(p, dtype=np.float64)])
    out = np.zeros(6)
    distance = measure_clearance(
        surfaces, a, b, pose, 0, upper, np.zeros(clearance_stack_size(surfaces)), out
    )
    return Clearance(distance, out[:3].copy(), out[3:].copy())


@entry
def measure_clearance(
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    pose: Floats1,
    at: int,
    upper: float,
    stack: Floats1,
    out: Floats1,
) -> float:
    """`clearance` for callers in Python."""
    return clearance(surfaces, surface_a, surface_b, pose, at, upper, stack, out)


@kernel(internal=True)
def clearance(
    # model
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    # state
    pose: NDArray[np.float64],
    at: int,
    upper: float,
    # scratch
    stack: NDArray[np.float64],
    # out
    out: NDArray[np.float64],
) -> float:
    """Smallest distance between two surfaces [m], as in `Clearance`; NaN for a pose that is not finite.

    Parameters
    ----------
    surfaces, surface_a, surface_b
        All surfaces of a scene, and the numbers of two; boxes and normals must hold for their present points.
    pose, at
        Rotation (9, row by row) and position (3) [m] of B in the axes of A, from place `at` on.
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
    size += abs(pose[at + 9]) + abs(pose[at + 10]) + abs(pose[at + 11])
    rounding = ROUNDING * size
    limit = upper + radius_a + radius_b
    limit += max(BOUND_SLACK * abs(limit), 4.0 * rounding)
    distance = math.inf
    for attempt in range(2):
        if distance == math.inf:
            distance = _search(
                surfaces.nodes,
                surfaces.boxes,
                surfaces.points,
                surfaces.triangles,
                surfaces.triangle_boxes,
                surfaces.normals,
                surfaces.surfaces[surface_a, ROOT_NODE],
                surfaces.surfaces[surface_b, ROOT_NODE],
                pose,
                at,
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
    nodes: NDArray[np.int64],
    boxes: NDArray[np.float64],
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    triangle_boxes: NDArray[np.float64],
    normals: NDArray[np.float64],
    root_a: int,
    root_b: int,
    # state
    pose: NDArray[np.float64],
    at: int,
    limit: float,
    rounding: float,
    # scratch
    stack: NDArray[np.float64],
    # out
    out: NDArray[np.float64],
) -> float:
    """Smallest distance of the triangles of two surfaces [m]; infinite if it is not below the limit."""
    best = limit
    stack[0] = root_a
    stack[1] = root_b
    stack[2] = 0.0
    top = 1
    while top > 0:
        top -= 1
        if not stack[STACK_WIDTH * top + 2] < _square(best - rounding):
            continue
        node_a = int(stack[STACK_WIDTH * top])
        node_b = int(stack[STACK_WIDTH * top + 1])
        if not _squared_gap_in_b(boxes, node_a, node_b, pose, at) < _square(best - rounding):
            continue  # boxes that are turned against each other are smaller in their own axes
        left_a, left_b = nodes[node_a, NODE_LEFT], nodes[node_b, NODE_LEFT]
        if left_a < 0 and left_b < 0:
            best = _leaves(
                points,
                triangles,
                triangle_boxes,
                normals,
                nodes[node_a, NODE_FIRST],
                nodes[node_a, NODE_COUNT],
                nodes[node_b, NODE_FIRST],
                nodes[node_b, NODE_COUNT],
                pose,
                at,
                best,
                rounding,
                out,
            )
            continue
        if left_a >= 0 and (left_b < 0 or _size(boxes, node_a) >= _size(boxes, node_b)):
            near_a, near_b, far_a, far_b = left_a, node_b, left_a + 1, node_b
        else:
            near_a, near_b, far_a, far_b = node_a, left_b, node_a, left_b + 1
        near = _squared_gap(boxes, near_a, near_b, pose, at)
        far = _squared_gap(boxes, far_a, far_b, pose, at)
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
def _push(stack: NDArray[np.float64], top: int, node_a: int, node_b: int, squared_gap: float) -> int:
    """Put two nodes on the stack; returns its new height."""
    stack[STACK_WIDTH * top] = node_a
    stack[STACK_WIDTH * top + 1] = node_b
    stack[STACK_WIDTH * top + 2] = squared_gap
    return top + 1


@kernel(inline=True, internal=True)
def _square(length: float) -> float:
    """Square of a length that is not below zero; NaN stays NaN, and ends the search."""
    return 0.0 if length <= 0.0 else length * length


@kernel(inline=True, internal=True)
def _size(boxes: NDArray[np.float64], node: int) -> float:
    """Sum of the half lengths of a box [m]."""
    return boxes[node, BOX_HALF] + boxes[node, BOX_HALF + 1] + boxes[node, BOX_HALF + 2]


@kernel(inline=True, internal=True)
def _squared_gap(
    boxes: NDArray[np.float64], node_a: int, node_b: int, pose: NDArray[np.float64], at: int
) -> float:
    """Squared distance of a box of A from the box along the axes of A around one of B [m^2]."""
    hx, hy, hz = boxes[node_b, BOX_HALF], boxes[node_b, BOX_HALF + 1], boxes[node_b, BOX_HALF + 2]
    x, y, z = moved_point(boxes, node_b, pose, at)
    hx, hy, hz = (
        abs(pose[at]) * hx + abs(pose[at + 1]) * hy + abs(pose[at + 2]) * hz,
        abs(pose[at + 3]) * hx + abs(pose[at + 4]) * hy + abs(pose[at + 5]) * hz,
        abs(pose[at + 6]) * hx + abs(pose[at + 7]) * hy + abs(pose[at + 8]) * hz,
    )
    return _squared_gap_to(boxes, node_a, (x, y, z), (hx, hy, hz))


@kernel(inline=True, internal=True)
def _squared_gap_in_b(
    boxes: NDArray[np.float64], node_a: int, node_b: int, pose: NDArray[np.float64], at: int
) -> float:
    """Squared distance of a box of B from the box along the axes of B around one of A [m^2]."""
    hx, hy, hz = boxes[node_a, BOX_HALF], boxes[node_a, BOX_HALF + 1], boxes[node_a, BOX_HALF + 2]
    centre = minus(fixed_point(boxes, node_a), (pose[at + 9], pose[at + 10], pose[at + 11]))
    half = (
        abs(pose[at]) * hx + abs(pose[at + 3]) * hy + abs(pose[at + 6]) * hz,
        abs(pose[at + 1]) * hx + abs(pose[at + 4]) * hy + abs(pose[at + 7]) * hz,
        abs(pose[at + 2]) * hx + abs(pose[at + 5]) * hy + abs(pose[at + 8]) * hz,
    )
    return _squared_gap_to(boxes, node_b, turn(centre, pose, at, True), half)


@kernel(inline=True, internal=True)
def _squared_gap_to(boxes: NDArray[np.float64], row: int, centre: Vector, half: Vector) -> float:
    """Squared distance of a box of A from one given in the same axes [m^2]."""
    x = abs(boxes[row, BOX_CENTRE] - centre[0]) - boxes[row, BOX_HALF] - half[0]
    y = abs(boxes[row, BOX_CENTRE + 1] - centre[1]) - boxes[row, BOX_HALF + 1] - half[1]
    z = abs(boxes[row, BOX_CENTRE + 2] - centre[2]) - boxes[row, BOX_HALF + 2] - half[2]
    return _square(x) + _square(y) + _square(z)


@kernel(internal=True)
def _leaves(
    # model
    points: NDArray[np.float64],
    triangles: NDArray[np.int64],
    triangle_boxes: NDArray[np.float64],
    normals: NDArray[np.float64],
    first_a: int,
    count_a: int,
    first_b: int,
    count_b: int,
    # state
    pose: NDArray[np.float64],
    at: int,
    best: float,
    rounding: float,
    # out
    out: NDArray[np.float64],
) -> float:
    """Smallest distance [m] of some triangles of A from some of B, or the best so far."""
    for tb in range(first_b, first_b + count_b):
        p = moved_point(points, triangles[tb, CORNER_A], pose, at)
        q = moved_point(points, triangles[tb, CORNER_B], pose, at)
        r = moved_point(points, triangles[tb, CORNER_C], pose, at)
        m = turn(fixed_point(normals, tb), pose, at, False)
        low_x, high_x = min(p[0], q[0], r[0]), max(p[0], q[0], r[0])
        low_y, high_y = min(p[1], q[1], r[1]), max(p[1], q[1], r[1])
        low_z, high_z = min(p[2], q[2], r[2]), max(p[2], q[2], r[2])
        centre = (0.5 * (low_x + high_x), 0.5 * (low_y + high_y), 0.5 * (low_z + high_z))
        half = (0.5 * (high_x - low_x), 0.5 * (high_y - low_y), 0.5 * (high_z - low_z))
        for ta in range(first_a, first_a + count_a):
            if _squared_gap_to(triangle_boxes, ta, centre, half) < _square(best - rounding):
                a = fixed_point(points, triangles[ta, CORNER_A])
                b = fixed_point(points, triangles[ta, CORNER_B])
                c = fixed_point(points, triangles[ta, CORNER_C])
                n = fixed_point(normals, ta)
                best = triangle_distance(a, b, c, n, p, q, r, m, best, rounding, out)
    return best
