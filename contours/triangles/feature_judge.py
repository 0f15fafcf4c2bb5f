"""Whether a vertex and a face are a contact: hit during the interval or near at its end, with the side.

What is near but cannot push is left out by the regions of `feature_regions`. A hit may be left out too, without
anything passing through: let a vertex hit the inside of a face while a neighbour of the vertex lies further along the
direction `d` to the face. Shortly before, at distance s, the edge to that neighbour cuts the plane of the face at a
distance of the order of s from the foot of the vertex, so inside the face: the surfaces were not clear of each other,
and the crossing of that edge (by its other end, or over an edge of the face) is itself a hit, and an earlier one. For
two edges with the separation `d` along their common normal, and a triangle at one of them that leads along `d`, the
other edge cuts that triangle at a distance of the order of s from the first in the same way. Going back from hit to
hit, the first one between surfaces that were clear of each other satisfies the condition, and it is reported.

Surfaces that are pressed into each other are not clear. A vertex behind a face that an edge of it goes through has come
through: it is a contact from the side where its edges are, from the first interval that it spends wholly behind one
face. So contacts are found again after they slid from one face to the next.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_fans import NEAR_PART, fan_is_crossed, fan_rises
from heavylift.contours.triangles.feature_gap import beyond_face, fixed_point, turned, turned_back
from heavylift.contours.triangles.feature_regions import SLACK, vertex_is_nearest, vertex_neighbour_sum
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, cross

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import RelativeMotion, RelativePose

__all__ = ["HIT", "NEAR", "NEITHER", "judge_vertex"]

NEITHER = 0
NEAR = 1
"""At the end of the interval."""
HIT = 2

ON_BORDER = 1e-9
"""Part of a face or edge by which a point may lie outside of it and still count as inside."""

LEVEL = 1e-6
"""Cosine below which a neighbourhood tells no side."""

Verdict = tuple[int, float, float, float]


@kernel(inline=True, internal=True)
def dot(a: Vector, b: Vector) -> float:
    """Product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel(inline=True, internal=True)
def minus(a: Vector, b: Vector) -> Vector:
    """Difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel(inline=True, internal=True)
def between(a: Vector, b: Vector, t: float) -> Vector:
    """``a + t (b - a)``."""
    return a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])


@kernel(inline=True, internal=True)
def turn(d: Vector, pose: RelativePose, back: bool) -> Vector:
    """``R d`` or ``R^T d``."""
    x, y, z = d
    return turned_back(x, y, z, pose) if back else turned(x, y, z, pose)


@kernel(inline=True, internal=True)
def turn_at(d: Vector, motion: RelativeMotion, t: float, back: bool) -> Vector:
    """`turn` at a time in [0, 1]: points move linearly, so the matrix is between those of the ends."""
    return between(turn(d, motion.start, back), turn(d, motion.end, back), t)


@kernel(inline=True, internal=True)
def inside_face(p: Vector, a: Vector, b: Vector, c: Vector, n: Vector) -> bool:
    """Whether the foot of a point on the plane of a face lies in the face or on its border."""
    ab, bc, ca = minus(b, a), minus(c, b), minus(a, c)
    u = cross(n, ab)
    v = cross(n, bc)
    w = cross(n, ca)
    twice_area = -dot(u, ca)
    if twice_area < 0.0:  # corners turn the other way round n
        return False
    least = -ON_BORDER * twice_area
    return dot(minus(p, a), u) >= least and dot(minus(p, b), v) >= least and dot(minus(p, c), w) >= least


@kernel(internal=True)
def judge_vertex(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex: int,
    corners: tuple[int, int, int],
    a: Vector,
    b: Vector,
    c: Vector,
    n: Vector,
    own_middle: Vector,
    face_middle: Vector,
    # motion
    motion: RelativeMotion,
    face_moves: bool,
    x0: Vector,
    x1: Vector,
    hit: bool,
    time: float,
    # limits
    radius: float,
    far: float,
    rounding: float,
) -> Verdict:
    """Verdict on a vertex and a face.

    Parameters
    ----------
    points, vertex_first, vertex_neighbours
        Of the packed surfaces.
    vertex
        Row of `points`.
    corners
        Rows of `points` of the face.
    a, b, c, n
        Corners [m] and unit normal of the face, in its own axes, as all that follows.
    own_middle, face_middle
        Middles [m] of the surfaces of vertex and face at the start.
    motion
        Relative motion, see `find_contacts`.
    face_moves
        The face belongs to B and the vertex to A.
    x0, x1
        The vertex [m] at start and end.
    hit, time
        What the swept test says.
    radius
        Rounding of both surfaces [m].
    far
        Distance [m] up to which a pair counts as near at the end.
    rounding
        Distance [m] at the start below which the sign of the distance says nothing.

    Returns
    -------
    verdict
        `NEITHER`, `NEAR` or `HIT`; its time; side of the face that the vertex is on, 1 or -1 along `n`; gap at the
        end [m].
    """
    s0 = dot(n, minus(x0, a))
    s1 = dot(n, minus(x1, a))
    if not hit and (abs(s1) > far or not inside_face(x1, a, b, c, n)):
        return NEITHER, 1.0, 0.0, 0.0
    if abs(s0) > rounding:
        side = 1.0 if s0 > 0.0 else -1.0
        # one that changed sides without a hit went through a neighbour of this face, or around its border; if
        # around, the next interval sees it from the right side
        if not hit and s0 * s1 < 0.0 and abs(s1) > rounding:
            return NEITHER, 1.0, 0.0, 0.0
    else:
        side = side_of_vertex(
            points, vertex_first, vertex_neighbours, vertex, a, n, own_middle, face_middle, motion, face_moves
        )
    # towards the face, in the axes of the vertex
    d = (-side * n[0], -side * n[1], -side * n[2])
    d = turn_at(d, motion, time if hit else 1.0, not face_moves)
    if not vertex_is_nearest(points, vertex_first, vertex_neighbours, vertex, d, SLACK):
        # not in front of the face, but perhaps the point that has come furthest through it
        if hit or not vertex_is_nearest(
            points, vertex_first, vertex_neighbours, vertex, (-d[0], -d[1], -d[2]), SLACK
        ):
            return NEITHER, 1.0, 0.0, 0.0
        if not vertex_is_through(
            points, vertex_first, vertex_neighbours, vertex, a, b, c, n, motion.end, face_moves, x1, s1
        ) or not vertex_is_through(
            points, vertex_first, vertex_neighbours, vertex, a, b, c, n, motion.start, face_moves, x0, s0
        ):
            return NEITHER, 1.0, 0.0, 0.0
        return NEAR, 1.0, -side, -side * s1 - radius
    t = time if hit else 1.0
    if vertex_is_behind(
        points, vertex_first, vertex_neighbours, vertex, corners, a, b, c, n, side,
        motion, face_moves, between(x0, x1, t), t, rounding,
    ):  # fmt: skip
        return NEITHER, 1.0, 0.0, 0.0
    verdict, time = touch_of_rounding(hit, time, side * s0 - radius, side * s1 - radius, radius)
    return verdict, time, side, side * s1 - radius


@kernel(inline=True, internal=True)
def touch_of_rounding(hit: bool, time: float, gap0: float, gap1: float, radius: float) -> tuple[int, float]:
    """Verdict and time of features that are clear or hit without their rounding: with it they touch earlier."""
    if radius > 0.0 and gap1 < 0.0:
        return HIT, gap0 / (gap0 - gap1) if gap0 > 0.0 else 0.0
    return (HIT, time) if hit else (NEAR, 1.0)


@kernel(internal=True)
def vertex_is_behind(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex: int,
    corners: tuple[int, int, int],
    a: Vector,
    b: Vector,
    c: Vector,
    n: Vector,
    side: float,
    # motion
    motion: RelativeMotion,
    face_moves: bool,
    x: Vector,
    t: float,
    rounding: float,
) -> bool:
    """Whether a vertex at x has come through a triangle next to the face (`feature_fans`)."""
    d = (side * n[0], side * n[1], side * n[2])
    middle = ((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)
    for corner in corners:
        if not fan_rises(points, vertex_first, vertex_neighbours, corner, d):
            continue
        for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
            e = minus(fixed_point(points, vertex_neighbours[k]), fixed_point(points, vertex))
            e = turn_at(e, motion, t, face_moves)
            if fan_is_crossed(points, vertex_first, vertex_neighbours, corner, d, x, e, middle, rounding):
                return True
    return False


@kernel(internal=True)
def vertex_is_through(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex: int,
    a: Vector,
    b: Vector,
    c: Vector,
    n: Vector,
    # motion
    pose: RelativePose,
    face_moves: bool,
    x: Vector,
    s: float,
) -> bool:
    """Whether an edge of a vertex, at x and at a distance s from the plane of a face, goes through the face.

    And most of it lies on the other side, so that the vertex has come through from there.
    """
    for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
        e = minus(fixed_point(points, vertex_neighbours[k]), fixed_point(points, vertex))
        e = turn(e, pose, face_moves)
        along = dot(n, e)
        if s * along < 0.0 and abs(s) <= NEAR_PART * abs(along):
            share = -s / along
            foot = (x[0] + share * e[0], x[1] + share * e[1], x[2] + share * e[2])
            # nearer to the border than deep, it may as well have come over the border
            if beyond_face(foot, a, b, c, n) <= -abs(s):
                return True
    return False


@kernel(internal=True)
def side_of_vertex(
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    vertex: int,
    a: Vector,
    n: Vector,
    own_middle: Vector,
    face_middle: Vector,
    motion: RelativeMotion,
    face_moves: bool,
) -> float:
    """Side of a vertex that lies in the plane of a face: where its neighbours are.

    If they lie in the plane too, where the middle of its surface is, or opposite to the middle of the other one.
    """
    s = vertex_neighbour_sum(points, vertex_first, vertex_neighbours, vertex)
    along = dot(n, turn(s, motion.start, face_moves))
    if abs(along) <= LEVEL * math.sqrt(dot(s, s)):
        r = minus(own_middle, a)
        along = dot(n, r)
        if abs(along) <= LEVEL * math.sqrt(dot(r, r)):
            along = -dot(n, minus(face_middle, a))
    return -1.0 if along < 0.0 else 1.0
