"""Which of two features near each other are the nearest of their surfaces, and on which side they are.

Two triangles near each other offer up to fifteen pairs of features, of which at most a few can push: the others have a
neighbour that is nearer to the other surface. A contact of one of those would push sideways at the seam of two
coplanar triangles, or from within a body. The test is that of Voronoi regions (Ericson, *Real-Time Collision
Detection*, 2005, section 9.5): the direction `d` from a feature to the other surface must lead away from everything
that is joined to the feature. It holds for open surfaces, wound either way, as only neighbours are asked.

The same neighbours tell on which side a feature begins that touches from the start, where the sign of its distance is
rounding.

Put a box exactly on another of the same size: its lower corners lie in the planes of the sides of the other too, on
their borders. Nothing in their distances tells that those sides do not face them, nor do the neighbours of the corners.
But the edges that lead up from them leave the other box through its top: whatever has an edge that goes through a
triangle near by must be held by that triangle, and not by the ones behind. So the fan of triangles around a corner of
what is touched is asked as well. A corner that stands in the corner of a room passes, as its edges lead back into the
room.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import fixed_point
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add, add_scaled, cross, dot, subtract

if TYPE_CHECKING:
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

__all__ = [
    "NEAR_PART",
    "SLACK",
    "edge_inward_sum",
    "edge_is_nearest",
    "fan_is_crossed",
    "fan_rises",
    "vertex_is_nearest",
    "vertex_neighbour_sum",
]

SLACK = 0.02
"""Sine of the angle by which a neighbour may be nearer. Flat faces that rest on each other must not lose a corner to
the tilt that their compliance gives them."""

NEAR_PART = 0.5
"""A feature belongs to the other side of a triangle if most of its edge lies there."""

INSIDE = -1e-9
"""Weight of a corner from which on a point counts as inside a triangle."""


@kernel(internal=True)
def vertex_is_nearest(surfaces: CollisionSurfaces, vertex: int, d: Vector, slack: float) -> bool:
    """Whether no neighbour of a vertex lies further along the unit direction `d`, given in the axes of the vertex."""
    points, vertex_first = surfaces.points, surfaces.vertex_first
    x = fixed_point(points, vertex)
    for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
        e = subtract(fixed_point(points, surfaces.vertex_neighbours[k]), x)
        along = dot(e, d)
        if slack >= 0.0:
            if along > 0.0 and along * along > slack * slack * dot(e, e):
                return False
        elif along > 0.0 or along * along < slack * slack * dot(e, e):
            return False
    return True


@kernel(internal=True)
def edge_is_nearest(surfaces: CollisionSurfaces, edge: int, d: Vector, slack: float) -> bool:
    """Whether no triangle at an edge leads along the unit direction `d`, given in the axes of the edge."""
    for k in range(surfaces.edge_first[edge], surfaces.edge_first[edge + 1]):
        if dot(fixed_point(surfaces.edge_inward, k), d) > slack:
            return False
    return True


@kernel(inline=True, internal=True)
def vertex_neighbour_sum(surfaces: CollisionSurfaces, vertex: int) -> Vector:
    """Sum of the edges [m] that leave a vertex: points into its surface."""
    points, vertex_first = surfaces.points, surfaces.vertex_first
    x = fixed_point(points, vertex)
    s = (0.0, 0.0, 0.0)
    for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
        s = add(s, subtract(fixed_point(points, surfaces.vertex_neighbours[k]), x))
    return s


@kernel(inline=True, internal=True)
def edge_inward_sum(surfaces: CollisionSurfaces, edge: int) -> Vector:
    """Sum of the directions from an edge into its triangles."""
    s = (0.0, 0.0, 0.0)
    for k in range(surfaces.edge_first[edge], surfaces.edge_first[edge + 1]):
        s = add(s, fixed_point(surfaces.edge_inward, k))
    return s


@kernel(internal=True)
def fan_rises(surfaces: CollisionSurfaces, corner: int, d: Vector) -> bool:
    """Whether any edge of a corner leads along the unit direction `d`; seldom so: nothing is in the way then."""
    return not vertex_is_nearest(surfaces, corner, d, SLACK)


@kernel(internal=True)
def fan_is_crossed(
    surfaces: CollisionSurfaces,
    corner: int,
    d: Vector,
    x: Vector,
    e: Vector,
    reference: Vector,
    rounding: float,
) -> bool:
    """Whether the near part of an edge from x goes through a triangle around a corner.

    Parameters
    ----------
    surfaces
        All surfaces of a scene.
    corner
        Row of its points.
    d
        Unit direction in which x is seen from its contact; triangles with no side that leads along it do not matter.
    x, e
        Where the edge begins, and its direction and length [m], in the axes of the corner.
    reference
        Point of what x touches [m]: an x that lies on a triangle counts as on this side of it.
    rounding
        Distance [m] below which x lies on a triangle.
    """
    points = surfaces.points
    vertex_first, vertex_neighbours = surfaces.vertex_first, surfaces.vertex_neighbours
    p = fixed_point(points, corner)
    r = subtract(x, p)
    for i in range(vertex_first[corner], vertex_first[corner + 1]):
        second = vertex_neighbours[i]
        a = subtract(fixed_point(points, second), p)
        along = dot(a, d)
        if along <= 0.0 or along * along <= SLACK * SLACK * dot(a, a):
            continue
        for j in range(vertex_first[second], vertex_first[second + 1]):
            third = vertex_neighbours[j]
            joined = False
            for k in range(vertex_first[corner], vertex_first[corner + 1]):
                joined = joined or vertex_neighbours[k] == third
            if not joined:
                continue
            # three points of which each two are joined: a triangle
            b = subtract(fixed_point(points, third), p)
            n = cross(a, b)
            area = math.sqrt(dot(n, n))
            if area == 0.0:
                continue
            height = dot(n, r) / area
            from_side = height
            if abs(height) <= rounding:
                from_side = dot(n, subtract(reference, p)) / area
                if abs(from_side) <= rounding:
                    continue
            fall = -dot(n, e) / area
            if from_side < 0.0:
                height, fall = -height, -fall
            if fall <= 0.0 or height > NEAR_PART * fall:
                continue
            if fall * fall <= SLACK * SLACK * dot(e, e):
                continue
            foot = add_scaled(r, max(height, 0.0) / fall, e)
            # weights of the corners
            u = dot(cross(foot, b), n) / (area * area)
            v = dot(cross(a, foot), n) / (area * area)
            if u >= INSIDE and v >= INSIDE and u + v <= 1.0 - INSIDE:
                return True
    return False
