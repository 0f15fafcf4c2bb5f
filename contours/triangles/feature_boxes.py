"""Boxes around the paths of features, as tuples: lowest coordinates [m], then highest; faces grown by rounding."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from heavylift.contours.triangles.surface_layout import BoundingBox
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records
    from heavylift.numerics.vectors import Vector

__all__ = ["apart", "box_around", "box_of", "grown", "middle_of", "stored_box"]

Box = tuple[float, float, float, float, float, float]


@kernel(inline=True, internal=True)
def box_of(p: Vector, q: Vector, margin: float) -> Box:
    """Lowest and highest coordinates [m] of two points, grown by a margin."""
    return (
        min(p[0], q[0]) - margin,
        min(p[1], q[1]) - margin,
        min(p[2], q[2]) - margin,
        max(p[0], q[0]) + margin,
        max(p[1], q[1]) + margin,
        max(p[2], q[2]) + margin,
    )


@kernel(inline=True, internal=True)
def box_around(a: Box, b: Box) -> Box:
    """Box around two boxes."""
    return (
        min(a[0], b[0]),
        min(a[1], b[1]),
        min(a[2], b[2]),
        max(a[3], b[3]),
        max(a[4], b[4]),
        max(a[5], b[5]),
    )


@kernel(inline=True, internal=True)
def apart(a: Box, b: Box) -> bool:
    """Whether two boxes have no point in common."""
    # no short cuts: six comparisons cost less than a branch that is guessed wrong
    return (a[0] > b[3]) | (a[3] < b[0]) | (a[1] > b[4]) | (a[4] < b[1]) | (a[2] > b[5]) | (a[5] < b[2])


@kernel(inline=True, internal=True)
def stored_box(boxes: Records[BoundingBox], row: int) -> Box:
    """Box from centre and half lengths."""
    centre, half = boxes[row].centre, boxes[row].half
    x, y, z = centre[0], centre[1], centre[2]
    u, v, w = half[0], half[1], half[2]
    return x - u, y - v, z - w, x + u, y + v, z + w


@kernel(inline=True, internal=True)
def middle_of(surfaces: CollisionSurfaces, surface: int) -> Vector:
    """Middle of the box around a surface [m], in its own axes."""
    root = surfaces.surfaces[surface].root
    centre = surfaces.boxes[root].centre
    return centre[0], centre[1], centre[2]


@kernel(inline=True, internal=True)
def grown(a: Vector, b: Vector, c: Vector, length: float) -> tuple[Vector, Vector, Vector]:
    """Corners of a triangle, each away from the middle by a length [m]."""
    if length == 0.0:
        return a, b, c
    x, y, z = (a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0
    return _away(a, x, y, z, length), _away(b, x, y, z, length), _away(c, x, y, z, length)


@kernel(inline=True, internal=True)
def _away(p: Vector, x: float, y: float, z: float, length: float) -> Vector:
    """Point farther from a place (x, y, z) by a length."""
    u, v, w = p[0] - x, p[1] - y, p[2] - z
    size = math.sqrt(u * u + v * v + w * w)
    share = length / size if size > 0.0 else 0.0
    return p[0] + share * u, p[1] + share * v, p[2] + share * w
