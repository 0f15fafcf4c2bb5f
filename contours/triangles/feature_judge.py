"""Whether a vertex and a face, or two edges, are a contact: hit during the interval or near at its end; on which side.

Two triangles near each other offer up to fifteen pairs of features, of which at most a few can push: the others have a
neighbour that is nearer to the other surface. A contact of one of those would push sideways at the seam of two
coplanar triangles, or from within a body. What is near is tested by Voronoi regions (Ericson, *Real-Time Collision
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

A hit may be left out too, without anything passing through: let a vertex hit the inside of a face while a neighbour of
the vertex lies further along the direction `d` to the face. Shortly before, at distance s, the edge to that neighbour
cuts the plane of the face at a distance of the order of s from the foot of the vertex, so inside the face: the surfaces
were not clear of each other, and the crossing of that edge (by its other end, or over an edge of the face) is itself a
hit, and an earlier one. For two edges with the separation `d` along their common normal, and a triangle at one of them
that leads along `d`, the other edge cuts that triangle at a distance of the order of s from the first in the same way.
Going back from hit to hit, the first one between surfaces that were clear of each other satisfies the condition, and it
is reported.

Surfaces that are pressed into each other are not clear. A vertex behind a face that an edge of it goes through has come
through: it is a contact from the side where its edges are, from the first interval that it spends wholly behind one
face. So contacts are found again after they slid from one face to the next.

Of surfaces that give way whole plates lie inside, and no edge of theirs goes through. There a corner is the nearest one
on the way back, and nothing about it tells whether it has come through or begins on that side: what touches already
must know (`PRESSED`). A hit is judged at the end of the interval too: what was deeper when it came in may have left.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from heavylift.contours.triangles.feature_gap import PARALLEL, beyond_face, fixed_point
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import (
    Vector,
    add,
    add_scaled,
    between,
    cross,
    dot,
    rotate,
    rotate_back,
    scaled,
    subtract,
)

if TYPE_CHECKING:
    from heavylift.contours.triangles.surface_layout import RelativeMotion, RelativePose
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

__all__ = [
    "GROWTH",
    "HIT",
    "NEAR",
    "NEITHER",
    "PRESSED",
    "SLACK",
    "Meeting",
    "Verdict",
    "centroid",
    "corners_of",
    "edge_is_nearest",
    "inside_face",
    "is_within_plane",
    "judge_edges",
    "judge_vertex",
    "no_contact",
    "turn_at",
    "vertex_is_nearest",
]

NEITHER = 0
NEAR = 1
"""At the end of the interval."""
HIT = 2
PRESSED = 3
"""Inside at the end, if it has come through from the other side: asked for only where contacts are pressed in."""

ON_BORDER = 1e-9
"""Part of a face or edge by which a point may lie outside of it and still count as inside."""

GROWTH = 10.0
"""Of the rounding, and no more than the reach: by which faces are larger for vertices. One that rests on a floor, a
little too low, must not slip through under a wall that stands on it; nor may one that has hopped a little from a box
touch the side below."""

LEVEL = 1e-6
"""Cosine below which a neighbourhood tells no side."""

SLACK = 0.02
"""Sine of the angle by which a neighbour may be nearer. Flat faces that rest on each other must not lose a corner to
the tilt that their compliance gives them."""

NEAR_PART = 0.5
"""A feature belongs to the other side of a triangle if most of its edge lies there."""

INSIDE = -1e-9
"""Weight of a corner from which on a point counts as inside a triangle, but for rounding."""


class Meeting(NamedTuple):
    """Two surfaces in an interval: what is the same for all of their features.

    Attributes
    ----------
    motion
        Of B in the axes of A, see `find_contacts`.
    middle_a, middle_b
        Middles [m] of both surfaces, in their own axes.
    a_in_b, b_in_a
        The same in the axes of the other at the start.
    radius
        Rounding of both surfaces [m].
    far
        Distance [m] up to which a pair counts as near at the end.
    rounding
        Distance [m] at the start below which the sign of the distance gives no information; gaps that differ by less
        are the same.
    method
        `SWEPT` or `POSITION_DIFFERENCE`.
    judged
        Whether hits are judged; else all that the swept tests report is a contact.
    pressed
        Whether contacts of both surfaces are pressed in: what may have come through is reported too.
    """

    motion: RelativeMotion
    middle_a: Vector
    middle_b: Vector
    a_in_b: Vector
    b_in_a: Vector
    radius: float
    far: float
    rounding: float
    method: int
    judged: bool
    pressed: bool


class Verdict(NamedTuple):
    """Whether two features are a contact.

    Attributes
    ----------
    outcome
        `NEITHER`, `NEAR`, `HIT` or `PRESSED`.
    time
        Of the hit, in [0, 1]; 1 if there is none.
    side
        1 or -1: of a vertex along the normal of the face; of the edge of B along the vector product of both.
    gap
        At the end [m].
    """

    outcome: int
    time: float
    side: float
    gap: float


@kernel(inline=True, internal=True)
def no_contact() -> Verdict:
    """`NEITHER`."""
    return Verdict(NEITHER, 1.0, 0.0, 0.0)


@kernel(inline=True, internal=True)
def turn(d: Vector, pose: RelativePose, back: bool) -> Vector:
    """``R d`` or ``R^T d``."""
    return rotate_back(pose.rotation, d) if back else rotate(pose.rotation, d)


@kernel(inline=True, internal=True)
def turn_at(d: Vector, motion: RelativeMotion, t: float, back: bool) -> Vector:
    """`turn` at a time in [0, 1]: points move linearly, so the matrix is between those of the ends."""
    return between(turn(d, motion.start, back), turn(d, motion.end, back), t)


@kernel(inline=True, internal=True)
def inside_face(p: Vector, a: Vector, b: Vector, c: Vector, n: Vector) -> bool:
    """Whether the foot of a point on the plane of a face lies in the face or on its border."""
    ab, bc, ca = subtract(b, a), subtract(c, b), subtract(a, c)
    u = cross(n, ab)
    v = cross(n, bc)
    w = cross(n, ca)
    twice_area = -dot(u, ca)
    if twice_area < 0.0:  # corners turn the other way round n
        return False
    least = -ON_BORDER * twice_area
    return (
        dot(subtract(p, a), u) >= least
        and dot(subtract(p, b), v) >= least
        and dot(subtract(p, c), w) >= least
    )


@kernel(inline=True, internal=True)
def corners_of(surfaces: CollisionSurfaces, face: int) -> tuple[Vector, Vector, Vector]:
    """Corners of a face [m], in its own axes."""
    points, corners = surfaces.points, surfaces.triangles[face].corners
    return fixed_point(points, corners[0]), fixed_point(points, corners[1]), fixed_point(points, corners[2])


@kernel(inline=True, internal=True)
def centroid(corners: tuple[Vector, Vector, Vector]) -> Vector:
    """Middle of a triangle [m]."""
    a, b, c = corners
    return (a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0


@kernel(inline=True, internal=True)
def judge_vertex(
    # model
    surfaces: CollisionSurfaces,
    vertex: int,
    face: int,
    # motion
    meeting: Meeting,
    face_moves: bool,
    x0: Vector,
    x1: Vector,
    hit: bool,
    time: float,
) -> Verdict:
    """Verdict on a vertex and a face.

    Parameters
    ----------
    surfaces
        All surfaces of a scene.
    vertex, face
        Rows of its points and triangles.
    meeting
        Of both surfaces.
    face_moves
        The face belongs to B and the vertex to A.
    x0, x1
        The vertex [m] at start and end, in the axes of the face.
    hit, time
        What the swept test says.
    """
    a, b, c = corners_of(surfaces, face)
    n = fixed_point(surfaces.normals, face)
    s0 = dot(n, subtract(x0, a))
    s1 = dot(n, subtract(x1, a))
    if not hit and meeting.radius > 0.0:
        t, touched = rounding_time(s0, s1, meeting.radius)
        if touched and inside_face(between(x0, x1, t), a, b, c, n):
            hit, time = True, t
    # most end here, which is worth no call
    if not hit and (min(abs(s0), abs(s1)) > meeting.far or not inside_face(x1, a, b, c, n)):
        return no_contact()
    return _judge_near_vertex(surfaces, vertex, face, meeting, face_moves, x0, x1, s0, s1, hit, time)


@kernel(internal=True)
def _judge_near_vertex(
    # model
    surfaces: CollisionSurfaces,
    vertex: int,
    face: int,
    # motion
    meeting: Meeting,
    face_moves: bool,
    x0: Vector,
    x1: Vector,
    s0: float,
    s1: float,
    hit: bool,
    time: float,
) -> Verdict:
    """`judge_vertex` of one that is hit, or near the face at distances s0 and s1 [m] from its plane."""
    motion, radius, rounding = meeting.motion, meeting.radius, meeting.rounding
    n = fixed_point(surfaces.normals, face)
    left = not hit and abs(s1) > meeting.far  # what was near is no longer, unless it is inside
    if abs(s0) > rounding:
        side = 1.0 if s0 > 0.0 else -1.0
        # one that changed sides without a hit went through a neighbour of this face, or around its border; if
        # around, the next interval sees it from the right side
        if not hit and s0 * s1 < 0.0 and abs(s1) > rounding:
            return no_contact()
    else:
        side = side_of_vertex(surfaces, vertex, face, meeting, face_moves)
    # towards the face, in the axes of the vertex
    t = time if hit else 1.0
    d = turn_at(scaled(-side, n), motion, t, not face_moves)
    if hit and meeting.pressed and not vertex_is_nearest(surfaces, vertex, d, SLACK):
        # what lay deeper when it came in may have left since
        t = 1.0
        d = turn_at(scaled(-side, n), motion, t, not face_moves)
    if not vertex_is_nearest(surfaces, vertex, d, SLACK):
        # not in front of the face, but perhaps the point that has come furthest through it
        if (
            hit
            or not vertex_is_nearest(surfaces, vertex, scaled(-1.0, d), SLACK)
            or (left and side * s1 < 0.0)
        ):
            return no_contact()
        if not vertex_is_through(
            surfaces, vertex, face, motion.end, face_moves, x1, s1
        ) or not vertex_is_through(surfaces, vertex, face, motion.start, face_moves, x0, s0):
            if not meeting.pressed:
                return no_contact()
            return Verdict(PRESSED, 1.0, -side, -side * s1 - radius)
        return Verdict(NEAR, 1.0, -side, -side * s1 - radius)
    if left and side * s1 > 0.0:
        return no_contact()
    if vertex_is_behind(surfaces, vertex, face, scaled(side, n), meeting, face_moves, between(x0, x1, t), t):
        return no_contact()
    # what lay in the plane and has left it on the other side is asked where it was, as if it had hit there
    crept = not hit and abs(s0) <= rounding and side * s1 < -rounding
    if crept and vertex_is_behind(surfaces, vertex, face, scaled(side, n), meeting, face_moves, x0, 0.0):
        return no_contact()
    verdict, time = touch_of_rounding(hit, time, side * s0 - radius, side * s1 - radius, radius)
    return Verdict(verdict, time, side, side * s1 - radius)


@kernel(inline=True, internal=True)
def rounding_time(s0: float, s1: float, radius: float) -> tuple[float, bool]:
    """When a distance [m] that changes linearly from s0 to s1 has come down to a radius, and whether it does.

    What is round may touch a face and have gone past its border at the end, without its middle ever coming through.
    """
    if s0 < 0.0:
        s0, s1 = -s0, -s1
    if s0 <= radius or s1 >= radius:
        return 1.0, False
    return (s0 - radius) / (s0 - s1), True


@kernel(inline=True, internal=True)
def touch_of_rounding(hit: bool, time: float, gap0: float, gap1: float, radius: float) -> tuple[int, float]:
    """Verdict and time of features that are clear or hit without their rounding: with it they touch earlier."""
    if radius > 0.0 and gap1 < 0.0:
        return HIT, gap0 / (gap0 - gap1) if gap0 > 0.0 else 0.0
    return (HIT, time) if hit else (NEAR, 1.0)


@kernel(internal=True)
def vertex_is_behind(
    # model
    surfaces: CollisionSurfaces,
    vertex: int,
    face: int,
    d: Vector,
    # motion
    meeting: Meeting,
    face_moves: bool,
    x: Vector,
    t: float,
) -> bool:
    """Whether a vertex at x, in the direction d from the face, has come through a triangle next to it."""
    points, vertex_first = surfaces.points, surfaces.vertex_first
    middle = centroid(corners_of(surfaces, face))
    for i in range(3):
        corner = surfaces.triangles[face].corners[i]
        if not fan_rises(surfaces, corner, d):
            continue
        for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
            e = subtract(fixed_point(points, surfaces.vertex_neighbours[k]), fixed_point(points, vertex))
            e = turn_at(e, meeting.motion, t, face_moves)
            if fan_is_crossed(surfaces, corner, d, x, e, middle, GROWTH * meeting.rounding):
                return True
    return False


@kernel(internal=True)
def vertex_is_through(
    surfaces: CollisionSurfaces,
    vertex: int,
    face: int,
    pose: RelativePose,
    face_moves: bool,
    x: Vector,
    s: float,
) -> bool:
    """Whether an edge of a vertex, at x and at a distance s from the plane of a face, goes through the face.

    And most of it lies on the other side, so that the vertex has come through from there.
    """
    points, vertex_first = surfaces.points, surfaces.vertex_first
    a, b, c = corners_of(surfaces, face)
    n = fixed_point(surfaces.normals, face)
    for k in range(vertex_first[vertex], vertex_first[vertex + 1]):
        e = subtract(fixed_point(points, surfaces.vertex_neighbours[k]), fixed_point(points, vertex))
        e = turn(e, pose, face_moves)
        along = dot(n, e)
        if s * along < 0.0 and abs(s) <= NEAR_PART * abs(along):
            foot = add_scaled(x, -s / along, e)
            # nearer to the border than deep, it may as well have come over the border
            if beyond_face(foot, a, b, c, n) <= -abs(s):
                return True
    return False


@kernel(internal=True)
def side_of_vertex(
    surfaces: CollisionSurfaces, vertex: int, face: int, meeting: Meeting, face_moves: bool
) -> float:
    """Side of a vertex that lies in the plane of a face: where its neighbours are.

    If they lie in the plane too, where the middle of its surface is, or opposite to the middle of the other one.
    """
    a = fixed_point(surfaces.points, surfaces.triangles[face].corners[0])
    n = fixed_point(surfaces.normals, face)
    s = vertex_neighbour_sum(surfaces, vertex)
    along = dot(n, turn(s, meeting.motion.start, face_moves))
    if abs(along) <= LEVEL * math.sqrt(dot(s, s)):
        r = subtract(meeting.a_in_b if face_moves else meeting.b_in_a, a)
        along = dot(n, r)
        if abs(along) <= LEVEL * math.sqrt(dot(r, r)):
            along = -dot(n, subtract(meeting.middle_b if face_moves else meeting.middle_a, a))
    return -1.0 if along < 0.0 else 1.0


@kernel(internal=True)
def edge_is_behind(
    # model
    surfaces: CollisionSurfaces,
    edge: int,
    other: int,
    d: Vector,
    # motion
    meeting: Meeting,
    other_moves: bool,
    x: Vector,
    s: float,
    t: float,
) -> bool:
    """Whether an edge whose point x touches another has come through a triangle at an end of that.

    Parameters
    ----------
    surfaces, meeting
        As for `judge_vertex`.
    edge, other
        Rows of the edges.
    d
        Unit direction from the other edge to the first, in the axes of the other, as `x` [m].
    other_moves
        The other edge belongs to B.
    s
        Place of x along the first edge, 0 to 1.
    t
        When it touches, in [0, 1].
    """
    points, edges = surfaces.points, surfaces.edges
    edge_first, edge_opposite = surfaces.edge_first, surfaces.edge_opposite
    own = fixed_point(points, edges[edge].ends[0])
    along = subtract(fixed_point(points, edges[edge].ends[1]), own)
    for end in range(2):
        corner = edges[other].ends[end]
        if not fan_rises(surfaces, corner, d):
            continue
        reference = fixed_point(points, edges[other].ends[1 - end])
        for row in range(edge_first[other], edge_first[other + 1]):
            reference = between(reference, fixed_point(points, edge_opposite[row]), 0.5)
        # both parts of the edge lead away from x, and its triangles
        for row in range(edge_first[edge] - 2, edge_first[edge + 1]):
            if row < edge_first[edge]:
                e = scaled(-s if row < edge_first[edge] - 1 else 1.0 - s, along)
            else:
                w = subtract(fixed_point(points, edge_opposite[row]), own)
                e = add_scaled(w, -(dot(w, along) / dot(along, along)), along)
            e = turn_at(e, meeting.motion, t, other_moves)
            if fan_is_crossed(surfaces, corner, d, x, e, reference, meeting.rounding):
                return True
    return False


@kernel(internal=True)
def edges_are_behind(
    # model
    surfaces: CollisionSurfaces,
    edges: tuple[int, int],
    ways: tuple[Vector, Vector],
    # motion
    meeting: Meeting,
    p: tuple[Vector, Vector],
    q: tuple[Vector, Vector],
    y: Vector,
    places: tuple[float, float],
    t: float,
) -> bool:
    """`edge_is_behind` for each of two edges that touch.

    Parameters
    ----------
    surfaces, meeting
        As for `judge_vertex`.
    edges, places
        Rows of the edges of A and B, and where they touch along them, 0 to 1.
    ways
        Unit directions from the one of A to that of B, and back, each in the axes of where it begins.
    p, q
        Ends [m] of that of B at the start and at the end, in the axes of A.
    y
        Where that of A touches [m], in its axes.
    t
        When, in [0, 1].
    """
    motion, (at_a, at_b) = meeting.motion, places
    x = between(between(p[0], q[0], t), between(p[1], q[1], t), at_b)
    if edge_is_behind(surfaces, edges[1], edges[0], ways[0], meeting, False, x, at_b, t):
        return True
    y = turn_at(subtract(y, between(motion.start.origin, motion.end.origin, t)), motion, t, True)
    return edge_is_behind(surfaces, edges[0], edges[1], ways[1], meeting, True, y, at_a, t)


@kernel(inline=True, internal=True)
def edges_cross(a: Vector, u: Vector, p: Vector, q: Vector) -> bool:
    """Whether the edge from a along u and that from p to q cross, seen along their common normal."""
    v = subtract(q, p)
    c, r = cross(u, v), subtract(p, a)
    square = dot(c, c)
    if square <= PARALLEL * PARALLEL * dot(u, u) * dot(v, v):
        return False
    at_a, at_b = dot(cross(r, v), c) / square, dot(cross(r, u), c) / square
    return min(at_a, at_b) >= -ON_BORDER and max(at_a, at_b) <= 1.0 + ON_BORDER


@kernel(inline=True, internal=True)
def is_within_plane(surfaces: CollisionSurfaces, edge: int) -> bool:
    """Whether an edge lies between two triangles of one plane: whatever crosses it there touches the plane elsewhere.

    Its contacts would be those of the plane with a normal that leans as the other edge does, and a side that nothing
    near it tells.
    """
    first = surfaces.edge_first[edge]
    if surfaces.edge_first[edge + 1] != first + 2:
        return False
    s = add(fixed_point(surfaces.edge_inward, first), fixed_point(surfaces.edge_inward, first + 1))
    return dot(s, s) <= LEVEL * LEVEL


@kernel(internal=True)
def judge_edges(
    # model
    surfaces: CollisionSurfaces,
    edge_a: int,
    edge_b: int,
    # motion
    meeting: Meeting,
    p0: Vector,
    p1: Vector,
    q0: Vector,
    q1: Vector,
    hit: bool,
    time: float,
) -> tuple[Verdict, float, float]:
    """Verdict on two edges, and the places along both at the end, 0 to 1 between their ends.

    Parameters
    ----------
    surfaces, meeting
        As for `judge_vertex`.
    edge_a, edge_b
        Rows of the edges.
    p0, p1, q0, q1
        Ends [m] of the edge of B at the start (p) and at the end (q), in the axes of A.
    hit, time
        As for `judge_vertex`.

    Notes
    -----
    For edges that are not `is_within_plane`: those are no contacts.
    """
    motion, radius, rounding = meeting.motion, meeting.radius, meeting.rounding
    a0 = fixed_point(surfaces.points, surfaces.edges[edge_a].ends[0])
    a1 = fixed_point(surfaces.points, surfaces.edges[edge_a].ends[1])
    u = subtract(a1, a0)
    # at the end
    v1 = subtract(q1, q0)
    c1 = cross(u, v1)
    square1 = dot(c1, c1)
    if square1 <= PARALLEL * PARALLEL * dot(u, u) * dot(v1, v1):
        return no_contact(), 0.0, 0.0
    r1 = subtract(q0, a0)
    length1 = math.sqrt(square1)
    gap = dot(c1, r1) / length1
    along_a = dot(cross(r1, v1), c1) / square1
    along_b = dot(cross(r1, u), c1) / square1
    c, length, at_a, at_b, t = c1, length1, along_a, along_b, 1.0
    if not hit and radius > 0.0:
        t, touched = rounding_time(dot(c1, subtract(p0, a0)) / length1, gap, radius)
        if touched and edges_cross(a0, u, between(p0, q0, t), between(p1, q1, t)):
            hit, time = True, t
        t = 1.0
    if hit:
        t = time
        p, q = between(p0, q0, t), between(p1, q1, t)
        v = subtract(q, p)
        c = cross(u, v)
        square = dot(c, c)
        if square <= PARALLEL * PARALLEL * dot(u, u) * dot(v, v):
            return no_contact(), 0.0, 0.0
        length = math.sqrt(square)
        r = subtract(p, a0)
        at_a = dot(cross(r, v), c) / square
        at_b = dot(cross(r, u), c) / square
    elif (
        abs(gap) > meeting.far
        or min(along_a, along_b) < -ON_BORDER
        or max(along_a, along_b) > 1.0 + ON_BORDER
    ):
        return no_contact(), 0.0, 0.0
    n = (c[0] / length, c[1] / length, c[2] / length)
    # the two places that touch, seen at the start along the common normal of the touch
    x = between(p0, p1, at_b)
    y = between(a0, a1, at_a)
    s0 = dot(n, subtract(x, y))
    start_gap, level = abs(s0) - radius, abs(s0) <= rounding
    if not level:
        side = 1.0 if s0 > 0.0 else -1.0
        if not hit and s0 * gap < 0.0 and abs(gap) > rounding:
            return no_contact(), 0.0, 0.0  # as for a vertex
    else:
        wa = edge_inward_sum(surfaces, edge_a)
        wb = rotate(motion.start.rotation, edge_inward_sum(surfaces, edge_b))
        s0 = dot(n, subtract(wb, wa))
        if abs(s0) <= LEVEL:
            s0 = dot(n, subtract(meeting.b_in_a, meeting.middle_a))
        side = -1.0 if s0 < 0.0 else 1.0
    d = scaled(side, n)
    back = turn_at(scaled(-1.0, d), motion, t, True)
    if not edge_is_nearest(surfaces, edge_a, d, SLACK) or not edge_is_nearest(surfaces, edge_b, back, SLACK):
        if not meeting.pressed or min(along_a, along_b) < 0.0 or max(along_a, along_b) > 1.0:
            return no_contact(), 0.0, 0.0
        # as for a vertex
        if hit:
            side = -side if dot(c, c1) < 0.0 else side
            d = scaled(side / length1, c1)
            back = turn_at(scaled(-1.0, d), motion, 1.0, True)
            if not edge_is_nearest(surfaces, edge_a, d, SLACK) or not edge_is_nearest(
                surfaces, edge_b, back, SLACK
            ):
                return no_contact(), 0.0, 0.0
            return Verdict(HIT, time, side, side * gap - radius), along_a, along_b
        d, back = scaled(-1.0, d), scaled(-1.0, back)
        if not edge_is_nearest(surfaces, edge_a, d, SLACK) or not edge_is_nearest(
            surfaces, edge_b, back, SLACK
        ):
            return no_contact(), 0.0, 0.0
        return Verdict(PRESSED, 1.0, -side, -side * gap - radius), along_a, along_b
    if edges_are_behind(
        surfaces, (edge_a, edge_b), (d, back), meeting, (p0, p1), (q0, q1), y, (at_a, at_b), t
    ):
        return no_contact(), 0.0, 0.0
    # as for a vertex
    crept = not hit and level and side * gap < -rounding
    if crept and edges_are_behind(
        surfaces, (edge_a, edge_b), (d, back), meeting, (p0, p1), (q0, q1), y, (at_a, at_b), 0.0
    ):
        return no_contact(), 0.0, 0.0
    if dot(c, c1) < 0.0:  # turned over between the hit and the end
        side = -side
    gap *= side
    verdict, time = touch_of_rounding(hit, time, start_gap, gap - radius, radius)
    return Verdict(verdict, time, side, gap - radius), along_a, along_b


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
        Distance [m] below which x lies on a triangle, and by which an edge may miss one and still go through it: of
        two boxes of one size on each other the sides are flush but for what they have crept.
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
            c = subtract(b, a)
            near_u = INSIDE - rounding * math.sqrt(dot(b, b)) / area
            near_v = INSIDE - rounding * math.sqrt(dot(a, a)) / area
            near_w = INSIDE - rounding * math.sqrt(dot(c, c)) / area
            if u >= near_u and v >= near_v and 1.0 - u - v >= near_w:
                return True
    return False
