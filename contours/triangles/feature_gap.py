"""Gap, normal and nearest points of one pair of features of two surfaces, from their present poses.

A pair of surfaces touches through *features*: a vertex and a face, two edges, or, where a surface is rounded, also a
vertex and an edge or two vertices. Each kind has one smooth gap function, whose rate is the normal's product with the
relative velocity of the nearest points (Ericson, *Real-Time Collision Detection*, 2005, chapters 5 and 9). Nothing here
depends on how triangles are wound: `side` says on which side of the face, or of the plane through both edges, the
second surface was when it was last clear of the first.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record
from heavylift.numerics.records import Vector as VectorField
from heavylift.numerics.vectors import (
    Three,
    Vector,
    add,
    add_scaled,
    cross,
    dot,
    rotate,
    rotate_back,
    scaled,
    subtract,
    vector,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import RelativePose
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

__all__ = [
    "EDGE_EDGE",
    "EDGE_VERTEX",
    "FACE_VERTEX",
    "PARALLEL",
    "VERTEX_EDGE",
    "VERTEX_FACE",
    "VERTEX_VERTEX",
    "FeatureTouch",
    "contact_gap",
    "copy_pose",
    "feature_gap",
]

VERTEX_FACE = 0
"""A vertex of B on a face of A."""

FACE_VERTEX = 1
"""A face of B on a vertex of A."""

EDGE_EDGE = 2

VERTEX_EDGE = 3
"""A vertex of B beside an edge of A; only where a surface is rounded, as the two below."""

EDGE_VERTEX = 4

VERTEX_VERTEX = 5

PARALLEL = 1e-6
"""Sine of the angle between two edges below which their common normal gives no information."""


class FeatureTouch(Record):
    """Where two features are nearest, all in the axes of A.

    Attributes
    ----------
    normal
        From A to B, of unit length.
    point_a, point_b
        Nearest points [m]: on the surfaces without rounding, and on the plane of the face or the lines of the edges.
    beyond
        How far they lie outside of the face or edges [m].
    """

    normal: VectorField
    point_a: VectorField
    point_b: VectorField
    beyond: float


@kernel(inline=True, internal=True)
def fixed_point(points: NDArray[np.float64], row: int) -> Vector:
    """Coordinates [m] of a point."""
    return points[row, 0], points[row, 1], points[row, 2]


@kernel(inline=True, internal=True)
def moved(p: Three, pose: RelativePose) -> Vector:
    """Point of B [m] in the axes of A: ``R x + p``."""
    return add(rotate(pose.rotation, p), pose.origin)


@kernel(inline=True, internal=True)
def moved_point(points: NDArray[np.float64], row: int, pose: RelativePose) -> Vector:
    """Point of B [m] in the axes of A."""
    return moved(fixed_point(points, row), pose)


@kernel(inline=True, internal=True)
def to_axes_of_b(p: Three, pose: RelativePose) -> Vector:
    """Point of A [m] in the axes of B: ``R^T (x - p)``."""
    return rotate_back(pose.rotation, subtract(p, pose.origin))


@kernel(inline=True, internal=True)
def copy_pose(pose: RelativePose, to: RelativePose) -> None:
    """Write a pose over another."""
    for k in range(9):
        to.rotation[k] = pose.rotation[k]
    for k in range(3):
        to.origin[k] = pose.origin[k]


@kernel(inline=True, internal=True)
def fill(out: FeatureTouch, n: Vector, a: Vector, b: Vector) -> None:
    """Write normal and both points."""
    out.normal[0], out.normal[1], out.normal[2] = n
    out.point_a[0], out.point_a[1], out.point_a[2] = a
    out.point_b[0], out.point_b[1], out.point_b[2] = b


@kernel(inline=True, internal=True)
def foot_on_line(p: Vector, a: Vector, b: Vector) -> Vector:
    """Point of the line through a and b [m] that is nearest to p."""
    d = subtract(b, a)
    return add_scaled(a, dot(subtract(p, a), d) / dot(d, d), d)


@kernel(inline=True, internal=True)
def gap_between(a: Vector, b: Vector, radius: float, out: FeatureTouch) -> float:
    """Gap [m] of two points, and the direction between them; where they coincide, any."""
    d = subtract(b, a)
    distance = math.sqrt(dot(d, d))
    if distance > 0.0:
        fill(out, (d[0] / distance, d[1] / distance, d[2] / distance), a, b)
    else:
        fill(out, (0.0, 0.0, 1.0), a, b)
    return distance - radius


@kernel(inline=True, internal=True)
def gap_of_edges(
    a0: Vector, a1: Vector, b0: Vector, b1: Vector, radius: float, side: float, out: FeatureTouch
) -> float:
    """Gap [m] of the lines along two edges; of parallel ones from the middle of the second."""
    a, b, r = subtract(a1, a0), subtract(b1, b0), subtract(b0, a0)
    c = cross(a, b)
    square = dot(c, c)
    if square <= PARALLEL * PARALLEL * (dot(a, a) * dot(b, b)):
        middle = scaled(0.5, add(b0, b1))
        return gap_between(foot_on_line(middle, a0, a1), middle, radius, out)
    n = scaled(side / math.sqrt(square), c)
    # r x d_B and r x d_A, both along the common normal, give the places along the edges
    u = dot(cross(r, b), c) / square
    v = dot(cross(r, a), c) / square
    fill(out, n, add_scaled(a0, u, a), add_scaled(b0, v, b))
    return dot(n, r) - radius


@kernel(inline=True, internal=True)
def contact_gap(
    # model
    surfaces: CollisionSurfaces,
    kind: int,
    feature_a: int,
    feature_b: int,
    radius: float,
    side: float,
    # state
    pose: RelativePose,
    # out
    out: FeatureTouch,
) -> float:
    """Gap [m] between two features, with its normal and points; cheap enough for every stage of every contact.

    Parameters
    ----------
    surfaces
        All surfaces of a scene.
    kind
        `VERTEX_FACE`, ..., `VERTEX_VERTEX`.
    feature_a, feature_b
        Rows of points, edges or triangles, as the kind says.
    radius
        Sum of the roundings of both surfaces [m].
    side
        1 or -1: sign of the product of the separation with the normal of the face, or with the vector product of both
        edges (that of A first), when the features were last clear of each other. Without meaning for the other kinds.
    pose
        Of B in the axes of A.
    out
        Written, but for `beyond`.

    Returns
    -------
    gap
        ``n . (x_B - x_A) - radius`` [m]; negative where the surfaces overlap.
    """
    points, triangles, edges = surfaces.points, surfaces.triangles, surfaces.edges
    if kind == VERTEX_FACE:
        n = fixed_point(surfaces.normals, feature_a)
        a = fixed_point(points, triangles[feature_a].corners[0])
        b = moved_point(points, feature_b, pose)
        s = dot(n, subtract(b, a))
        fill(out, scaled(side, n), add_scaled(b, -s, n), b)
        return side * s - radius
    if kind == FACE_VERTEX:
        n = rotate(pose.rotation, fixed_point(surfaces.normals, feature_b))
        b = moved_point(points, triangles[feature_b].corners[0], pose)
        a = fixed_point(points, feature_a)
        s = dot(n, subtract(b, a))
        fill(out, scaled(side, n), a, add_scaled(a, s, n))
        return side * s - radius
    if kind == EDGE_EDGE:
        return gap_of_edges(
            fixed_point(points, edges[feature_a].ends[0]),
            fixed_point(points, edges[feature_a].ends[1]),
            moved_point(points, edges[feature_b].ends[0], pose),
            moved_point(points, edges[feature_b].ends[1], pose),
            radius,
            side,
            out,
        )
    if kind == VERTEX_EDGE:
        b = moved_point(points, feature_b, pose)
        a0 = fixed_point(points, edges[feature_a].ends[0])
        a1 = fixed_point(points, edges[feature_a].ends[1])
        return gap_between(foot_on_line(b, a0, a1), b, radius, out)
    if kind == EDGE_VERTEX:
        a = fixed_point(points, feature_a)
        b0 = moved_point(points, edges[feature_b].ends[0], pose)
        b1 = moved_point(points, edges[feature_b].ends[1], pose)
        return gap_between(a, foot_on_line(a, b0, b1), radius, out)
    return gap_between(fixed_point(points, feature_a), moved_point(points, feature_b, pose), radius, out)


@kernel(inline=True, internal=True)
def beyond_side(p: Vector, a: Vector, b: Vector, n: Vector) -> float:
    """How far [m] a point lies on the outer side of the edge from a to b of a face that n sees turn left."""
    d = subtract(b, a)
    return dot(subtract(p, a), cross(d, n)) / math.sqrt(dot(d, d))


@kernel(inline=True, internal=True)
def beyond_face(p: Vector, a: Vector, b: Vector, c: Vector, n: Vector) -> float:
    """Largest of the distances [m] beyond the three edges of a face; negative inside."""
    return max(beyond_side(p, a, b, n), beyond_side(p, b, c, n), beyond_side(p, c, a, n))


@kernel(inline=True, internal=True)
def beyond_ends(p: Vector, a: Vector, b: Vector) -> float:
    """How far [m] a point of the line through a and b lies beyond the nearer end; negative between them."""
    d = subtract(b, a)
    length = math.sqrt(dot(d, d))
    s = dot(subtract(p, a), d) / length
    return max(-s, s - length)


@kernel(inline=True, internal=True)
def overshoot(
    # model
    surfaces: CollisionSurfaces,
    kind: int,
    feature_a: int,
    feature_b: int,
    # state
    pose: RelativePose,
    out: FeatureTouch,
) -> float:
    """How far [m] the nearest points that `contact_gap` left in `out` lie outside of their face or edges."""
    points, triangles, edges = surfaces.points, surfaces.triangles, surfaces.edges
    a = vector(out.point_a)
    # in its own axes, where its face and edges stand still
    b = to_axes_of_b(out.point_b, pose)
    if kind in (VERTEX_FACE, FACE_VERTEX):
        face = feature_a if kind == VERTEX_FACE else feature_b
        return beyond_face(
            a if kind == VERTEX_FACE else b,
            fixed_point(points, triangles[face].corners[0]),
            fixed_point(points, triangles[face].corners[1]),
            fixed_point(points, triangles[face].corners[2]),
            fixed_point(surfaces.normals, face),
        )
    beyond = -math.inf
    if kind in (EDGE_EDGE, VERTEX_EDGE):
        a0 = fixed_point(points, edges[feature_a].ends[0])
        beyond = beyond_ends(a, a0, fixed_point(points, edges[feature_a].ends[1]))
    if kind in (EDGE_EDGE, EDGE_VERTEX):
        b0 = fixed_point(points, edges[feature_b].ends[0])
        beyond = max(beyond, beyond_ends(b, b0, fixed_point(points, edges[feature_b].ends[1])))
    return beyond


@kernel(inline=True, internal=True)
def feature_gap(
    # model
    surfaces: CollisionSurfaces,
    kind: int,
    feature_a: int,
    feature_b: int,
    radius: float,
    side: float,
    # state
    pose: RelativePose,
    # out
    out: FeatureTouch,
) -> float:
    """`contact_gap`, and in ``out.beyond`` how far [m] the nearest points lie outside of the face or edges.

    Notes
    -----
    The overshoot is the largest distance beyond an edge of the face, or beyond an end of the edges, zero or negative
    inside; a pair with a positive one has slid off its features. Two vertices cannot: minus infinity.
    """
    gap = contact_gap(surfaces, kind, feature_a, feature_b, radius, side, pose, out)
    out.beyond = overshoot(surfaces, kind, feature_a, feature_b, pose, out)
    return gap
