"""Contacts of two surfaces in an interval: all pairs of features that are hit, or near at the end.

Every pair of triangles that the pair list keeps is looked at through the features that these triangles own, so that no
vertex and no edge is tested twice. Boxes around the paths of single features come first; what remains goes through the
swept test, and is then judged (`feature_judge`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_boxes import apart, box_around, box_of, grown, middle_of, stored_box
from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    FACE_VERTEX,
    VERTEX_FACE,
    fixed_point,
    moved,
    moved_point,
)
from heavylift.contours.triangles.feature_judge import HIT, NEITHER, judge_vertex
from heavylift.contours.triangles.feature_judge_edges import judge_edges
from heavylift.contours.triangles.feature_report import report, shared_end
from heavylift.contours.triangles.feature_rounded import in_axes_of_b, rounded_contacts
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

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.feature_report import ContactList
    from heavylift.contours.triangles.pair_list import PairLists
    from heavylift.contours.triangles.surface_layout import RelativeMotion
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces
    from heavylift.numerics.vectors import Vector

__all__ = ["POSITION_DIFFERENCE", "SWEPT", "contacts_of_pairs", "find_contacts"]

SWEPT = 0
POSITION_DIFFERENCE = 1
"""Method of the 2018 thesis, section 2.6, which misses collisions; for comparison."""

ROUNDING = 1e-6
"""Part of the smaller surface by which positions that touch may differ: a simulation leaves bodies at rest a little
inside each other, and impacts are found to a tolerance."""

GROWTH = 10.0
"""Of that, and no more than the reach: by which faces are larger for vertices. One that rests on a floor, a little too
low, must not slip through under a wall that stands on it."""

Box = tuple[float, float, float, float, float, float]


@kernel(internal=True)
def find_contacts(
    # model
    surfaces: CollisionSurfaces,
    lists: PairLists,
    pair: int,
    # motion
    motion: RelativeMotion,
    reach: float,
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
        Pose of B in the axes of A: rotation (9, row by row) and position [m] (3) at the start, then at the end.
        In these axes the points of B move linearly in between. Shape (24,).
    reach
        Gap [m] at the end up to which features that are not hit are contacts too.
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
    count = refresh_pairs(surfaces, lists, pair, motion, reach)
    if count <= 0:
        return count
    return contacts_of_pairs(
        surfaces,
        lists.table[pair].surface_a,
        lists.table[pair].surface_b,
        lists.pairs,
        lists.table[pair].first,
        count,
        motion,
        reach,
        method,
        True,
        out,
    )


@kernel(internal=True)
def contacts_of_pairs(
    # model
    surfaces: CollisionSurfaces,
    surface_a: int,
    surface_b: int,
    pairs: NDArray[np.int64],
    first: int,
    count: int,
    # motion
    motion: RelativeMotion,
    reach: float,
    method: int,
    judged: bool,
    # out
    out: ContactList,
) -> int:
    """`find_contacts` for listed pairs of triangles; not `judged`, all that the swept tests report, and only that."""
    points, triangles, corners = surfaces.points, surfaces.triangles, out.corners
    radius = surfaces.radii[surface_a] + surfaces.radii[surface_b]
    far = reach + radius
    rounding = ROUNDING * min(surfaces.reaches[surface_a], surfaces.reaches[surface_b])
    # the middle of either surface in the axes of the other, at the start
    middle_a, middle_b = middle_of(surfaces, surface_a), middle_of(surfaces, surface_b)
    b_in_a = moved(middle_b, motion.start)
    a_in_b = in_axes_of_b(middle_a, motion.start)
    found = 0
    last = -1
    box_b = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(first, first + count):
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
            found = vertices_on_face(
                surfaces, ta, tb, box_a, b_in_a, middle_a, motion, radius, far, rounding, method, judged,
                found, out,
            )  # fmt: skip
        if flags_b & IS_FACE and flags_a & (7 * OWNS_A) and found >= 0:
            found = face_on_vertices(
                surfaces, ta, tb, box_b, a_in_b, middle_b, motion, radius, far, rounding, method, judged,
                found, out,
            )  # fmt: skip
        if flags_a & (7 * OWNS_AB) and flags_b & (7 * OWNS_AB) and found >= 0:
            found = edges_on_edges(
                surfaces, ta, tb, box_b, middle_a, b_in_a, motion, radius, far, rounding, method, judged,
                found, out,
            )  # fmt: skip
        if radius > 0.0 and judged and found >= 0:
            found = rounded_contacts(surfaces, ta, tb, motion, radius, far, rounding, found, out)
        if found < 0:
            return found
    return found


@kernel(inline=True, internal=True)
def vertices_on_face(
    # model
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    box_a: Box,
    b_in_a: Vector,
    middle_a: Vector,
    # motion
    motion: RelativeMotion,
    radius: float,
    far: float,
    rounding: float,
    method: int,
    judged: bool,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Report the vertices that a triangle of B owns and that touch a face of A."""
    points, triangles = surfaces.points, surfaces.triangles
    for i in range(3):
        if not triangles[tb].flags & (OWNS_A << i):
            continue
        x0, x1 = fixed_point(out.corners, i), fixed_point(out.corners, 3 + i)
        if apart(box_a, box_of(x0, x1, far)):
            continue
        a = fixed_point(points, triangles[ta].corners[0])
        b = fixed_point(points, triangles[ta].corners[1])
        c = fixed_point(points, triangles[ta].corners[2])
        if method == POSITION_DIFFERENCE:
            hit, time = difference_vertex_face(
                x0[0], x0[1], x0[2], x1[0], x1[1], x1[2], a[0], a[1], a[2], a[0], a[1], a[2], b[0], b[1],
                b[2], b[0], b[1], b[2], c[0], c[1], c[2], c[0], c[1], c[2], VERTEX_MOVES,
            )  # fmt: skip
        else:
            p, q, r = grown(a, b, c, min(GROWTH * rounding, far) if judged else 0.0)
            hit, time = swept_vertex_face(x0, x1, p, q, r)
        vertex = triangles[tb].corners[i]
        verdict, side, gap = HIT if hit else NEITHER, 1.0, 0.0
        if judged:
            verdict, time, side, gap = judge_vertex(
                points, surfaces.vertex_first, surfaces.vertex_neighbours, vertex,
                (triangles[ta].corners[0], triangles[ta].corners[1], triangles[ta].corners[2]), a, b, c,
                fixed_point(surfaces.normals, ta), b_in_a, middle_a, motion, False, x0, x1, hit, time, radius,
                far, rounding,
            )  # fmt: skip
        if verdict != NEITHER:
            found = report(
                points, surfaces.edges, surfaces.normals, motion, VERTEX_FACE, ta, vertex,
                vertex if judged else -1, verdict, time, side, gap, rounding, found, out,
            )  # fmt: skip
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
    a_in_b: Vector,
    middle_b: Vector,
    # motion
    motion: RelativeMotion,
    radius: float,
    far: float,
    rounding: float,
    method: int,
    judged: bool,
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
        if method == POSITION_DIFFERENCE:
            hit, time = difference_vertex_face(
                x[0], x[1], x[2], x[0], x[1], x[2], a0[0], a0[1], a0[2], a1[0], a1[1], a1[2], b0[0], b0[1],
                b0[2], b1[0], b1[1], b1[2], c0[0], c0[1], c0[2], c1[0], c1[1], c1[2], FACE_SWEEPS,
            )  # fmt: skip
        else:
            a0, b0, c0 = grown(a0, b0, c0, min(GROWTH * rounding, far) if judged else 0.0)
            a1, b1, c1 = grown(a1, b1, c1, min(GROWTH * rounding, far) if judged else 0.0)
            hit, time = swept_face_vertex(x, a0, a1, b0, b1, c0, c1)
        verdict, side, gap = HIT if hit else NEITHER, 1.0, 0.0
        if judged:
            verdict, time, side, gap = judge_vertex(
                points, surfaces.vertex_first, surfaces.vertex_neighbours, vertex,
                (triangles[tb].corners[0], triangles[tb].corners[1], triangles[tb].corners[2]),
                fixed_point(points, triangles[tb].corners[0]), fixed_point(points, triangles[tb].corners[1]),
                fixed_point(points, triangles[tb].corners[2]), fixed_point(surfaces.normals, tb), a_in_b,
                middle_b, motion, True, in_axes_of_b(x, motion.start), in_axes_of_b(x, motion.end), hit, time,
                radius, far, rounding,
            )  # fmt: skip
        if verdict != NEITHER:
            # the vertex is on a side of the face; the face is on the other of the vertex
            found = report(
                points, surfaces.edges, surfaces.normals, motion, FACE_VERTEX, vertex, tb,
                vertex if judged else -1, verdict, time, -side, gap, rounding, found, out,
            )  # fmt: skip
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
    middle_a: Vector,
    b_in_a: Vector,
    # motion
    motion: RelativeMotion,
    radius: float,
    far: float,
    rounding: float,
    method: int,
    judged: bool,
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
            if apart(box, box_around(box_of(p0, p1, far), box_of(q0, q1, far))):
                continue
            if method == POSITION_DIFFERENCE:
                hit, time = difference_edges(
                    a0[0], a0[1], a0[2], a0[0], a0[1], a0[2], a1[0], a1[1], a1[2], a1[0], a1[1], a1[2], p0[0],
                    p0[1], p0[2], p1[0], p1[1], p1[2], q0[0], q0[1], q0[2], q1[0], q1[1], q1[2],
                    SECOND_EDGE_SWEEPS,
                )  # fmt: skip
            else:
                hit, time = swept_edges(a0, a1, p0, p1, q0, q1)
            verdict, side, gap, at = HIT if hit else NEITHER, 1.0, 0.0, -1
            if judged:
                verdict, time, side, gap, along_a, along_b = judge_edges(
                    points, surfaces.vertex_first, surfaces.vertex_neighbours, edges, surfaces.edge_first,
                    surfaces.edge_inward, surfaces.edge_opposite, edge_a, edge_b, middle_a, b_in_a, motion,
                    a0, a1, p0, q0, p1, q1, hit, time, radius, far, rounding,
                )  # fmt: skip
                at = shared_end(edges, edge_a, edge_b, along_a, along_b)
            if verdict != NEITHER:
                found = report(
                    points, edges, surfaces.normals, motion, EDGE_EDGE, edge_a, edge_b, at, verdict, time,
                    side, gap, rounding, found, out,
                )  # fmt: skip
                if found < 0:
                    return found
    return found
