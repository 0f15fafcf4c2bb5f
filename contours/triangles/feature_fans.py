"""Whether a feature has come through the triangles around a corner of what it is about to touch.

Put a box exactly on another of the same size: its lower corners lie in the planes of the sides of the other too, on
their borders. Nothing in their distances tells that those sides do not face them, nor do the neighbours of the corners.
But the edges that lead up from them leave the other box through its top: whatever has an edge that goes through a
triangle near by must be held by that triangle, and not by the ones behind. A corner that stands in the corner of a room
passes, as its edges lead back into the room.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import fixed_point
from heavylift.contours.triangles.feature_regions import SLACK
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, cross

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["NEAR_PART", "fan_is_crossed", "fan_rises"]

NEAR_PART = 0.5
"""A feature belongs to the other side of a triangle if most of its edge lies there."""

INSIDE = -1e-9
"""Weight of a corner from which on a point counts as inside a triangle."""


@kernel(internal=True)
def fan_rises(
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    corner: int,
    d: Vector,
) -> bool:
    """Whether any edge of a corner leads along the unit direction `d`; seldom so: nothing is in the way then."""
    x, y, z = points[corner, 0], points[corner, 1], points[corner, 2]
    for k in range(vertex_first[corner], vertex_first[corner + 1]):
        other = vertex_neighbours[k]
        ex, ey, ez = points[other, 0] - x, points[other, 1] - y, points[other, 2] - z
        along = ex * d[0] + ey * d[1] + ez * d[2]
        if along > 0.0 and along * along > SLACK * SLACK * (ex * ex + ey * ey + ez * ez):
            return True
    return False


@kernel(internal=True)
def fan_is_crossed(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    corner: int,
    d: Vector,
    # what comes
    x: Vector,
    e: Vector,
    reference: Vector,
    rounding: float,
) -> bool:
    """Whether the near part of an edge from x goes through a triangle around a corner.

    Parameters
    ----------
    points, vertex_first, vertex_neighbours
        Of the packed surfaces.
    corner
        Row of `points`.
    d
        Unit direction in which x is seen from its contact; triangles with no side that leads along it do not matter.
    x, e
        Where the edge begins, and its direction and length [m], in the axes of the corner.
    reference
        Point of what x touches [m]: an x that lies on a triangle counts as on this side of it.
    rounding
        Distance [m] below which x lies on a triangle.
    """
    px, py, pz = fixed_point(points, corner)
    rx, ry, rz = x[0] - px, x[1] - py, x[2] - pz
    for i in range(vertex_first[corner], vertex_first[corner + 1]):
        second = vertex_neighbours[i]
        ax, ay, az = points[second, 0] - px, points[second, 1] - py, points[second, 2] - pz
        along = ax * d[0] + ay * d[1] + az * d[2]
        if along <= 0.0 or along * along <= SLACK * SLACK * (ax * ax + ay * ay + az * az):
            continue
        for j in range(vertex_first[second], vertex_first[second + 1]):
            third = vertex_neighbours[j]
            joined = False
            for k in range(vertex_first[corner], vertex_first[corner + 1]):
                joined = joined or vertex_neighbours[k] == third
            if not joined:
                continue
            # three points of which each two are joined: a triangle
            bx, by, bz = points[third, 0] - px, points[third, 1] - py, points[third, 2] - pz
            nx, ny, nz = cross((ax, ay, az), (bx, by, bz))
            area = math.sqrt(nx * nx + ny * ny + nz * nz)
            if area == 0.0:
                continue
            height = (nx * rx + ny * ry + nz * rz) / area
            from_side = height
            if abs(height) <= rounding:
                from_side = (
                    nx * (reference[0] - px) + ny * (reference[1] - py) + nz * (reference[2] - pz)
                ) / area
                if abs(from_side) <= rounding:
                    continue
            fall = -(nx * e[0] + ny * e[1] + nz * e[2]) / area
            if from_side < 0.0:
                height, fall = -height, -fall
            if fall <= 0.0 or height > NEAR_PART * fall:
                continue
            if fall * fall <= SLACK * SLACK * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]):
                continue
            share = max(height, 0.0) / fall
            fx, fy, fz = rx + share * e[0], ry + share * e[1], rz + share * e[2]
            # weights of the corners
            ux, uy, uz = cross((fx, fy, fz), (bx, by, bz))
            u = (ux * nx + uy * ny + uz * nz) / (area * area)
            vx, vy, vz = cross((ax, ay, az), (fx, fy, fz))
            v = (vx * nx + vy * ny + vz * nz) / (area * area)
            if u >= INSIDE and v >= INSIDE and u + v <= 1.0 - INSIDE:
                return True
    return False
