"""Tree of boxes over the triangles of a surface, built once in the axes of its body.

Every box is split where the sum of (area x number of triangles) of both halves is smallest, over all places along all
three axes (MacDonald and Booth, "Heuristics for ray tracing using space subdivision", The Visual Computer 6, 1990).
The triangles are sorted along each axis once; the halves keep the order, so that a level of the tree costs a few
passes over the triangles (Wald and Havran, "On building fast kd-trees for ray tracing", 2006).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.contours.triangles.surface_layout import BoundingBox, TreeNode
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import records

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.numerics.arrays import Floats1, Floats2, Ints1, Ints2
    from heavylift.numerics.records import Records

__all__ = ["LEAF_TRIANGLES", "SurfaceTree", "build_tree", "tree_depth"]

LEAF_TRIANGLES = 8
"""Most triangles of a leaf."""

EDGE_LENGTH_SHARE = 1e-6
"""Of the size of the surface, times the edge lengths of a box, is added to its area: lines have no area."""


class SurfaceTree(NamedTuple):
    """Boxes around ever fewer triangles of one surface.

    Attributes
    ----------
    nodes
        Their triangles are counted in leaf order; shape (nn,). The root is the first one; children come after their
        parent.
    boxes
        Of the nodes, shape (nn,).
    order
        Number of each triangle, in leaf order, shape (nt,).
    """

    nodes: Records[TreeNode]
    boxes: Records[BoundingBox]
    order: NDArray[np.int64]


def build_tree(lower: NDArray[np.float64], upper: NDArray[np.float64]) -> SurfaceTree:
    """Tree over the boxes of triangles.

    Parameters
    ----------
    lower, upper
        Corners of the box of each triangle [m], shape (nt, 3), nt > 0.
    """
    count = len(lower)
    middles = lower + upper
    sorted_by = np.ascontiguousarray(np.argsort(middles, axis=0, kind="stable").T, dtype=np.int64)
    nodes, boxes = records(TreeNode, 2 * count), records(BoundingBox, 2 * count)
    size = float(np.linalg.norm(upper.max(axis=0) - lower.min(axis=0)))
    used = _split_all(
        np.ascontiguousarray(lower),
        np.ascontiguousarray(upper),
        EDGE_LENGTH_SHARE * size,
        LEAF_TRIANGLES,
        sorted_by,
        nodes,
        boxes,
        np.zeros(count),
        np.zeros(count, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
    )
    return SurfaceTree(nodes[:used].copy(), boxes[:used].copy(), sorted_by[0].copy())


def tree_depth(nodes: Records[TreeNode], root: int = 0) -> int:
    """Levels of a tree; 1 if the root is a leaf."""
    level = np.array([root], dtype=np.int64)
    depth = 0
    while level.size:
        depth += 1
        left = nodes["left"][level]
        left = left[left >= 0]
        level = np.concatenate([left, left + 1])
    return depth


@entry
def _split_all(
    lower: Floats2,
    upper: Floats2,
    edge_weight: float,
    leaf_triangles: int,
    # in and out: triangles sorted along each axis
    sorted_by: Ints2,
    # out
    nodes: Records[TreeNode],
    boxes: Records[BoundingBox],
    # scratch
    costs: Floats1,
    left_half: Ints1,
    moved: Ints1,
) -> int:
    """Split boxes, parents first, until all leaves are small; returns the number of nodes."""
    nodes[0].left = -1
    nodes[0].first = 0
    nodes[0].count = lower.shape[0]
    used = 1
    node = 0
    while node < used:
        first = nodes[node].first
        count = nodes[node].count
        _write_box(lower, upper, sorted_by, first, count, node, boxes)
        if count > leaf_triangles:
            axis, left = _best_split(lower, upper, edge_weight, sorted_by, first, count, costs)
            _sort_halves(sorted_by, first, count, axis, left, left_half, moved)
            nodes[node].left = used
            nodes[used].first = first
            nodes[used].count = left
            nodes[used + 1].first = first + left
            nodes[used + 1].count = count - left
            nodes[used].left = -1
            nodes[used + 1].left = -1
            used += 2
        node += 1
    return used


@kernel(internal=True)
def _write_box(
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    sorted_by: NDArray[np.int64],
    first: int,
    count: int,
    node: int,
    boxes: Records[BoundingBox],
) -> None:
    """Box around some triangles."""
    for k in range(3):
        low = math.inf
        high = -math.inf
        for i in range(first, first + count):
            t = sorted_by[0, i]
            low = min(low, lower[t, k])
            high = max(high, upper[t, k])
        boxes[node].centre[k] = 0.5 * (low + high)
        boxes[node].half[k] = 0.5 * (high - low)


@kernel(internal=True)
def _best_split(
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    edge_weight: float,
    sorted_by: NDArray[np.int64],
    first: int,
    count: int,
    costs: NDArray[np.float64],
) -> tuple[int, int]:
    """Axis along which some triangles are split, and how many go to the left."""
    best = math.inf
    best_axis = 0
    best_left = count // 2
    for axis in range(3):
        # from the right: what the right half costs if it begins at i
        x0 = y0 = z0 = math.inf
        x1 = y1 = z1 = -math.inf
        for i in range(count - 1, 0, -1):
            t = sorted_by[axis, first + i]
            x0, x1 = min(x0, lower[t, 0]), max(x1, upper[t, 0])
            y0, y1 = min(y0, lower[t, 1]), max(y1, upper[t, 1])
            z0, z1 = min(z0, lower[t, 2]), max(z1, upper[t, 2])
            costs[i] = (count - i) * _size(x1 - x0, y1 - y0, z1 - z0, edge_weight)
        x0 = y0 = z0 = math.inf
        x1 = y1 = z1 = -math.inf
        for i in range(1, count):
            t = sorted_by[axis, first + i - 1]
            x0, x1 = min(x0, lower[t, 0]), max(x1, upper[t, 0])
            y0, y1 = min(y0, lower[t, 1]), max(y1, upper[t, 1])
            z0, z1 = min(z0, lower[t, 2]), max(z1, upper[t, 2])
            cost = costs[i] + i * _size(x1 - x0, y1 - y0, z1 - z0, edge_weight)
            # equal costs, as of points in one place: halves of equal numbers keep the tree flat
            if cost < best or (cost == best and abs(2 * i - count) < abs(2 * best_left - count)):
                best = cost
                best_axis = axis
                best_left = i
    return best_axis, best_left


@kernel(inline=True, internal=True)
def _size(x: float, y: float, z: float, edge_weight: float) -> float:
    """Half the area of a box, plus a little of its edge lengths."""
    return x * y + y * z + z * x + edge_weight * (x + y + z)


@kernel(internal=True)
def _sort_halves(
    sorted_by: NDArray[np.int64],
    first: int,
    count: int,
    axis: int,
    left: int,
    left_half: NDArray[np.int64],
    moved: NDArray[np.int64],
) -> None:
    """Bring the triangles of the left half to the front along all axes, and keep their order."""
    for i in range(count):
        left_half[sorted_by[axis, first + i]] = 1 if i < left else 0
    for other in range(3):
        if other != axis:
            place = first
            waiting = 0
            for i in range(first, first + count):
                t = sorted_by[other, i]
                if left_half[t] == 1:
                    sorted_by[other, place] = t
                    place += 1
                else:
                    moved[waiting] = t
                    waiting += 1
            for i in range(waiting):
                sorted_by[other, place + i] = moved[i]
