"""Boxes along the axes of one surface, around what stands still there and around what moves straight: scalars only."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import BoundingBox, RelativeMotion, Triangle
    from heavylift.numerics.records import Records

__all__ = [
    "Box",
    "box_at",
    "extent",
    "is_larger",
    "near",
    "squared_gap",
    "swept_box",
    "swept_triangle",
    "write_box",
]

Box = tuple[float, float, float, float, float, float]
"""Centre and half lengths [m]."""


@kernel(inline=True, internal=True)
def box_at(boxes: Records[BoundingBox], row: int) -> Box:
    """Centre and half lengths."""
    centre, half = boxes[row].centre, boxes[row].half
    return centre[0], centre[1], centre[2], half[0], half[1], half[2]


@kernel(inline=True, internal=True)
def write_box(boxes: Records[BoundingBox], row: int, box: Box) -> None:
    """Centre and half lengths."""
    centre, half = boxes[row].centre, boxes[row].half
    centre[0], centre[1], centre[2], half[0], half[1], half[2] = box


@kernel(inline=True, internal=True)
def near(p: Box, q: Box, distance: float) -> bool:
    """Whether two boxes come within a distance along every axis."""
    return (
        abs(p[0] - q[0]) <= p[3] + q[3] + distance
        and abs(p[1] - q[1]) <= p[4] + q[4] + distance
        and abs(p[2] - q[2]) <= p[5] + q[5] + distance
    )


@kernel(inline=True, internal=True)
def squared_gap(p: Box, q: Box) -> float:
    """Squared distance between two boxes [m^2]."""
    x = max(0.0, abs(p[0] - q[0]) - p[3] - q[3])
    y = max(0.0, abs(p[1] - q[1]) - p[4] - q[4])
    z = max(0.0, abs(p[2] - q[2]) - p[5] - q[5])
    return x * x + y * y + z * z


@kernel(inline=True, internal=True)
def is_larger(p: Box, q: Box) -> bool:
    """Whether a box has the longer edges."""
    return p[3] + p[4] + p[5] >= q[3] + q[4] + q[5]


@kernel(inline=True, internal=True)
def extent(box: Box) -> float:
    """Bound on the coordinates of a box [m]."""
    return max(abs(box[0]) + box[3], abs(box[1]) + box[4], abs(box[2]) + box[5])


@kernel(inline=True, internal=True)
def swept_box(path: RelativeMotion, box: Box) -> Box:
    """Box in the axes of A around a box of B that moves straight from the start to the end of a path."""
    x, half_x = _swept_axis(path, 0, box)
    y, half_y = _swept_axis(path, 1, box)
    z, half_z = _swept_axis(path, 2, box)
    return x, y, z, half_x, half_y, half_z


@kernel(inline=True, internal=True)
def _swept_axis(path: RelativeMotion, i: int, box: Box) -> tuple[float, float]:
    """Middle and half length of a swept box along one axis of A."""
    R, Q = path.start.rotation, path.end.rotation
    r0, r1, r2 = R[3 * i], R[3 * i + 1], R[3 * i + 2]
    q0, q1, q2 = Q[3 * i], Q[3 * i + 1], Q[3 * i + 2]
    start = path.start.origin[i] + r0 * box[0] + r1 * box[1] + r2 * box[2]
    end = path.end.origin[i] + q0 * box[0] + q1 * box[1] + q2 * box[2]
    half_start = abs(r0) * box[3] + abs(r1) * box[4] + abs(r2) * box[5]
    half_end = abs(q0) * box[3] + abs(q1) * box[4] + abs(q2) * box[5]
    low = min(start - half_start, end - half_end)
    high = max(start + half_start, end + half_end)
    return 0.5 * (low + high), 0.5 * (high - low)


@kernel(inline=True, internal=True)
def swept_triangle(
    path: RelativeMotion, points: NDArray[np.float64], triangles: Records[Triangle], triangle: int
) -> Box:
    """Box in the axes of A around the corners of a triangle of B on the way: tighter than its box in B, swept."""
    a = triangles[triangle].corners[0]
    b = triangles[triangle].corners[1]
    c = triangles[triangle].corners[2]
    x, half_x = _swept_corners(path, 0, points, a, b, c)
    y, half_y = _swept_corners(path, 1, points, a, b, c)
    z, half_z = _swept_corners(path, 2, points, a, b, c)
    return x, y, z, half_x, half_y, half_z


@kernel(inline=True, internal=True)
def _swept_corners(
    path: RelativeMotion, i: int, points: NDArray[np.float64], a: int, b: int, c: int
) -> tuple[float, float]:
    """Middle and half length of what three points pass along one axis of A."""
    low = math.inf
    high = -math.inf
    for end in range(2):
        pose = path.start if end == 0 else path.end
        R = pose.rotation
        r0, r1, r2 = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        at_a = r0 * points[a, 0] + r1 * points[a, 1] + r2 * points[a, 2]
        at_b = r0 * points[b, 0] + r1 * points[b, 1] + r2 * points[b, 2]
        at_c = r0 * points[c, 0] + r1 * points[c, 1] + r2 * points[c, 2]
        origin = pose.origin[i]
        low = min(low, origin + min(at_a, at_b, at_c))
        high = max(high, origin + max(at_a, at_b, at_c))
    return 0.5 * (low + high), 0.5 * (high - low)
