"""Contacts of two surfaces in an interval: all pairs of features that are hit, or near at the end.

Every pair of triangles that the pair list keeps is looked at through the features that these triangles own, so that no
vertex and no edge is tested twice. Boxes around the paths of single features come first; what remains goes through the
swept test, and is then judged (`feature_judge`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    FACE_VERTEX,
    VERTEX_FACE,
    fixed_point,
    moved,
    moved_point,
    to_axes_of_b,
)
from heavylift.contours.triangles.feature_judge import (
    GROWTH,
    HIT,
    NEITHER,
    Meeting,
    Verdict,
    centroid,
    corners_of,
    is_within_plane,
    judge_edges,
    judge_vertex,
)
from heavylift.contours.triangles.feature_report import UNIQUE, report, shared_end
from heavylift.contours.triangles.feature_rounded import rounded_contacts
from heavylift.contours.triangles.pair_search import refresh_pairs
from heavylift.contours.triangles.position_difference import (
    FACE_SWEEPS,
    SECOND_EDGE_SWEEPS,
    VERTEX_MOVES,
    difference_edges,
    difference_vertex_face,
)
from heavylift.contours.triangles.surface_layout import IS_FACE, OWNS_A, OWNS_AB
from heavylift.contours.triangles.swept import swept_edges, swept_face_vertex, swept_vertex_face
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, dot, subtract, vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.feature_report import ContactList
    from heavylift.contours.triangles.pair_list import PairLists
    from heavylift.contours.triangles.surface_layout import BoundingBox, RelativeMotion
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.records import Records

__all__ = ["POSITION_DIFFERENCE", "SWEPT", "contacts_of_pairs", "find_contacts"]

SWEPT = 0
POSITION_DIFFERENCE = 1
"""Method of the 2018 thesis, section 2.6, which misses collisions; for comparison."""

ROUNDING = 1e-6
"""Part of the smaller surface by which positions that touch may differ: a simulation leaves bodies at rest a little
inside each other, and impacts are found to a tolerance."""

Box = tuple[float, float, float, float, float, float]
"""Around the path of a feature: lowest coordinates [m], then highest."""


@kernel(internal=True)
def find_contacts(
    # model
    surfaces: CollisionSurfaces,
    lists: PairLists,
    pair: int,
    # motion
    motion: RelativeMotion,
    reach: float,
    depth: float,
    method: int,
    # out
    out: ContactList,
) -> int:
    """Contacts of one pair of surfaces A and B during an interval.

    Parameters
    ----------
    surfaces, lists, pair
        All surfaces of a scene, the lists of their pairs, and which of those.
    motion
        Poses of B in the axes of A at the start and at the end; in these axes the points of B move linearly in
        between.
    reach
        Gap [m] at the end up to which features that are not hit are contacts too.
    depth
        How deep contacts of these surfaces may be pressed in [m]. Up to so much further all features are looked at, and
        those that are inside, if they have come through, are reported as `UNKNOWN`. Less than rounding: all is clear.
    method
        `SWEPT` or `POSITION_DIFFERENCE`.
    out
        Written.

    Returns
    -------
    count
        Of contacts; -1 if the pair lists are too small, -2 if `out` is.

    Notes
    -----
    The side of a contact is that of the start of the interval. Where the features touch there within rounding, it is
    the side on which their neighbours are, then the middles of the surfaces. A vertex that came through a face before
    has the side where its edges are, and a negative gap (down to ``-reach``).
    """
    count = refresh_pairs(surfaces, lists, pair, motion, reach + depth)
    if count <= 0:
        return count
    listed = lists.table[pair]
    pairs = lists.pairs[listed.first : listed.first + count]
    return contacts_of_pairs(
        surfaces, listed.surface_a, listed.surface_b, pairs, motion, reach, depth, method, True, out
    )


@kernel(internal=True)
def contacts_of_pairs(
    # model
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    pairs: NDArray[np.int64],
    # motion
    motion: RelativeMotion,
    reach: float,
    depth: float,
    method: int,
    judged: bool,
    # out
    out: ContactList,
) -> int:
    """`find_contacts` for listed pairs of triangles; not `judged`, all that the swept tests report, and only that."""
    points, triangles, corners = surfaces.points, surfaces.triangles, out.corners
    radius = surfaces.radii[surface_a] + surfaces.radii[surface_b]
    far = reach + depth + radius
    size = min(surfaces.reaches[surface_a], surfaces.reaches[surface_b])
    middle_a, middle_b = middle_of(surfaces, surface_a), middle_of(surfaces, surface_b)
    meeting = Meeting(
        motion,
        middle_a,
        middle_b,
        to_axes_of_b(middle_a, motion.start),
        moved(middle_b, motion.start),
        radius,
        far,
        ROUNDING * size,
        method,
        judged,
        depth > ROUNDING * size,
    )
    found = 0
    last = -1
    box_b = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(pairs.shape[0]):
        ta, tb = pairs[k, 0], pairs[k, 1]
        if tb != last:
            last = tb
            for i in range(3):
                p = moved_point(points, triangles[tb].corners[i], motion.start)
                q = moved_point(points, triangles[tb].corners[i], motion.end)
                corners[i, 0], corners[i, 1], corners[i, 2] = p
                corners[3 + i, 0], corners[3 + i, 1], corners[3 + i, 2] = q
                box = box_of(p, q, far)
                box_b = box if i == 0 else box_around(box_b, box)
        box_a = stored_box(surfaces.triangle_boxes, ta)
        if apart(box_a, box_b):
            continue
        flags_a, flags_b = triangles[ta].flags, triangles[tb].flags
        if flags_a & IS_FACE and flags_b & (7 * OWNS_A):
            found = vertices_on_face(surfaces, ta, tb, box_a, meeting, found, out)
        if flags_b & IS_FACE and flags_a & (7 * OWNS_A) and found >= 0:
            found = face_on_vertices(surfaces, ta, tb, box_b, meeting, found, out)
        if flags_a & (7 * OWNS_AB) and flags_b & (7 * OWNS_AB) and found >= 0:
            found = edges_on_edges(surfaces, ta, tb, box_b, meeting, found, out)
        if radius > 0.0 and judged and found >= 0:
            found = rounded_contacts(surfaces, ta, tb, meeting, found, out)
        if found < 0:
            return found
    return found


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
    return vector(surfaces.middles[surface])


@kernel(inline=True, internal=True)
def grown(a: Vector, b: Vector, c: Vector, length: float) -> tuple[Vector, Vector, Vector]:
    """Corners of a triangle, each away from the middle by a length [m]."""
    if length == 0.0:
        return a, b, c
    middle = centroid((a, b, c))
    return away(a, middle, length), away(b, middle, length), away(c, middle, length)


@kernel(inline=True, internal=True)
def away(p: Vector, place: Vector, length: float) -> Vector:
    """Point farther from a place by a length."""
    d = subtract(p, place)
    size = math.sqrt(dot(d, d))
    return add_scaled(p, length / size if size > 0.0 else 0.0, d)


@kernel(inline=True, internal=True)
def growth(meeting: Meeting) -> float:
    """By how much faces are larger for vertices [m]."""
    return min(GROWTH * meeting.rounding, meeting.far) if meeting.judged else 0.0


@kernel(inline=True, internal=True)
def unjudged(hit: bool, time: float) -> Verdict:
    """What a swept test says by itself."""
    return Verdict(HIT if hit else NEITHER, time, 1.0, 0.0)


@kernel(inline=True, internal=True)
def vertices_on_face(
    # model
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    box_a: Box,
    # motion
    meeting: Meeting,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Report the vertices that a triangle of B owns and that touch a face of A."""
    triangles = surfaces.triangles
    for i in range(3):
        if not triangles[tb].flags & (OWNS_A << i):
            continue
        x0, x1 = fixed_point(out.corners, i), fixed_point(out.corners, 3 + i)
        if apart(box_a, box_of(x0, x1, meeting.far)):
            continue
        a, b, c = corners_of(surfaces, ta)
        if meeting.method == POSITION_DIFFERENCE:
            hit, time = difference_vertex_face(x0, x1, a, a, b, b, c, c, VERTEX_MOVES)
        else:
            p, q, r = grown(a, b, c, growth(meeting))
            hit, time = swept_vertex_face(x0, x1, p, q, r)
        vertex = triangles[tb].corners[i]
        verdict = unjudged(hit, time)
        if meeting.judged:
            verdict = judge_vertex(surfaces, vertex, ta, meeting, False, x0, x1, hit, time)
        if verdict.outcome != NEITHER:
            at = vertex if meeting.judged else UNIQUE
            found = report(surfaces, meeting, VERTEX_FACE, ta, vertex, at, verdict, found, out)
            if found < 0:
                return found
    return found


@kernel(inline=True, internal=True)
def face_on_vertices(
    # model
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    box_b: Box,
    # motion
    meeting: Meeting,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Report the vertices that a triangle of A owns and that a face of B touches."""
    points, triangles = surfaces.points, surfaces.triangles
    for i in range(3):
        vertex = triangles[ta].corners[i]
        x = fixed_point(points, vertex)
        if not triangles[ta].flags & (OWNS_A << i) or apart(box_b, box_of(x, x, 0.0)):
            continue
        a0, a1 = fixed_point(out.corners, 0), fixed_point(out.corners, 3)
        b0, b1 = fixed_point(out.corners, 1), fixed_point(out.corners, 4)
        c0, c1 = fixed_point(out.corners, 2), fixed_point(out.corners, 5)
        if meeting.method == POSITION_DIFFERENCE:
            hit, time = difference_vertex_face(x, x, a0, a1, b0, b1, c0, c1, FACE_SWEEPS)
        else:
            a0, b0, c0 = grown(a0, b0, c0, growth(meeting))
            a1, b1, c1 = grown(a1, b1, c1, growth(meeting))
            hit, time = swept_face_vertex(x, a0, a1, b0, b1, c0, c1)
        verdict = unjudged(hit, time)
        if meeting.judged:
            x0, x1 = to_axes_of_b(x, meeting.motion.start), to_axes_of_b(x, meeting.motion.end)
            verdict = judge_vertex(surfaces, vertex, tb, meeting, True, x0, x1, hit, time)
        if verdict.outcome != NEITHER:
            at = vertex if meeting.judged else UNIQUE
            # the vertex is on a side of the face; the face is on the other of the vertex
            verdict = Verdict(verdict.outcome, verdict.time, -verdict.side, verdict.gap)
            found = report(surfaces, meeting, FACE_VERTEX, vertex, tb, at, verdict, found, out)
            if found < 0:
                return found
    return found


@kernel(inline=True, internal=True)
def edges_on_edges(
    # model
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    box_b: Box,
    # motion
    meeting: Meeting,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Report the edges that two triangles own and that touch each other."""
    points, triangles, edges = surfaces.points, surfaces.triangles, surfaces.edges
    for i in range(3):
        if not triangles[ta].flags & (OWNS_AB << i):
            continue
        # from its first to its second point as `edges` has them: on their order depends what a side means
        edge_a = triangles[ta].edges[i]
        if meeting.judged and is_within_plane(surfaces, edge_a):
            continue
        a0 = fixed_point(points, edges[edge_a].ends[0])
        a1 = fixed_point(points, edges[edge_a].ends[1])
        box = box_of(a0, a1, 0.0)
        if apart(box, box_b):
            continue
        for j in range(3):
            if not triangles[tb].flags & (OWNS_AB << j):
                continue
            edge_b = triangles[tb].edges[j]
            start = j if edges[edge_b].ends[0] == triangles[tb].corners[j] else (j + 1) % 3
            end = 2 * j + 1 - start if j < 2 else 2 - start
            p0, p1 = fixed_point(out.corners, start), fixed_point(out.corners, 3 + start)
            q0, q1 = fixed_point(out.corners, end), fixed_point(out.corners, 3 + end)
            if apart(box, box_around(box_of(p0, p1, meeting.far), box_of(q0, q1, meeting.far))):
                continue
            if meeting.judged and is_within_plane(surfaces, edge_b):
                continue
            if meeting.method == POSITION_DIFFERENCE:
                hit, time = difference_edges(a0, a0, a1, a1, p0, p1, q0, q1, SECOND_EDGE_SWEEPS)
            else:
                hit, time = swept_edges(a0, a1, p0, p1, q0, q1)
            verdict, at = unjudged(hit, time), UNIQUE
            if meeting.judged:
                verdict, along_a, along_b = judge_edges(
                    surfaces, edge_a, edge_b, meeting, p0, q0, p1, q1, hit, time
                )
                at = shared_end(edges, edge_a, edge_b, along_a, along_b)
            if verdict.outcome != NEITHER:
                found = report(surfaces, meeting, EDGE_EDGE, edge_a, edge_b, at, verdict, found, out)
                if found < 0:
                    return found
    return found
