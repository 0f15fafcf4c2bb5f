"""Whether two edges are a contact: hit during the interval or near at its end, with the side; see `feature_judge`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_fans import fan_is_crossed, fan_rises
from heavylift.contours.triangles.feature_gap import PARALLEL, fixed_point
from heavylift.contours.triangles.feature_judge import (
    LEVEL,
    NEITHER,
    ON_BORDER,
    between,
    dot,
    minus,
    touch_of_rounding,
    turn,
    turn_at,
)
from heavylift.contours.triangles.feature_regions import SLACK, edge_inward_sum, edge_is_nearest
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, cross

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import Edge, RelativeMotion
    from heavylift.numerics.records import Records

__all__ = ["judge_edges"]


@kernel(internal=True)
def edge_is_behind(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    edges: Records[Edge],
    edge_first: NDArray[np.int64],
    edge_opposite: NDArray[np.int64],
    edge: int,
    other: int,
    d: Vector,
    # motion
    motion: RelativeMotion,
    other_moves: bool,
    x: Vector,
    s: float,
    t: float,
    rounding: float,
) -> bool:
    """Whether an edge whose point x touches another has come through a triangle at an end of that.

    Parameters
    ----------
    edge, other
        Rows of `edges`.
    d
        Unit direction from the other edge to the first, in the axes of the other, as `x` [m].
    other_moves
        The other edge belongs to B.
    s
        Place of x along the first edge, 0 to 1.
    """
    own = fixed_point(points, edges[edge].ends[0])
    along = minus(fixed_point(points, edges[edge].ends[1]), own)
    for end in range(2):
        corner = edges[other].ends[end]
        if not fan_rises(points, vertex_first, vertex_neighbours, corner, d):
            continue
        reference = fixed_point(points, edges[other].ends[1 - end])
        for row in range(edge_first[other], edge_first[other + 1]):
            reference = between(reference, fixed_point(points, edge_opposite[row]), 0.5)
        # both parts of the edge lead away from x, and its triangles
        for row in range(edge_first[edge] - 2, edge_first[edge + 1]):
            if row < edge_first[edge]:
                share = -s if row < edge_first[edge] - 1 else 1.0 - s
                e = (share * along[0], share * along[1], share * along[2])
            else:
                w = minus(fixed_point(points, edge_opposite[row]), own)
                share = dot(w, along) / dot(along, along)
                e = (w[0] - share * along[0], w[1] - share * along[1], w[2] - share * along[2])
            e = turn_at(e, motion, t, other_moves)
            if fan_is_crossed(points, vertex_first, vertex_neighbours, corner, d, x, e, reference, rounding):
                return True
    return False


@kernel(internal=True)
def judge_edges(
    # model
    points: NDArray[np.float64],
    vertex_first: NDArray[np.int64],
    vertex_neighbours: NDArray[np.int64],
    edges: Records[Edge],
    edge_first: NDArray[np.int64],
    edge_inward: NDArray[np.float64],
    edge_opposite: NDArray[np.int64],
    edge_a: int,
    edge_b: int,
    middle_a: Vector,
    middle_b: Vector,
    # motion
    motion: RelativeMotion,
    a0: Vector,
    a1: Vector,
    p0: Vector,
    p1: Vector,
    q0: Vector,
    q1: Vector,
    hit: bool,
    time: float,
    # limits
    radius: float,
    far: float,
    rounding: float,
) -> tuple[int, float, float, float, float, float]:
    """Verdict on two edges.

    Parameters
    ----------
    points, vertex_first, vertex_neighbours, edges, edge_first, edge_inward, edge_opposite
        Of the packed surfaces.
    edge_a, edge_b
        Rows of `edges`.
    middle_a, middle_b
        Middles [m] of both surfaces at the start, in the axes of A as all that follows.
    motion
        Relative motion, see `find_contacts`.
    a0, a1
        Ends [m] of the edge of A.
    p0, p1, q0, q1
        Ends [m] of the edge of B at the start (p) and at the end (q).
    hit, time, radius, far, rounding
        As for `judge_vertex`.

    Returns
    -------
    verdict
        `NEITHER`, `NEAR` or `HIT`; its time; side, 1 or -1; gap [m] at the end; places along both edges at the end, 0
        to 1 between their ends.
    """
    u = minus(a1, a0)
    # at the end
    v1 = minus(q1, q0)
    c1 = cross(u, v1)
    square1 = dot(c1, c1)
    if square1 <= PARALLEL * PARALLEL * dot(u, u) * dot(v1, v1):
        return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
    r1 = minus(q0, a0)
    length1 = math.sqrt(square1)
    gap = dot(c1, r1) / length1
    w = cross(r1, v1)
    along_a = dot(w, c1) / square1
    w = cross(r1, u)
    along_b = dot(w, c1) / square1
    c, length, at_a, at_b, t = c1, length1, along_a, along_b, 1.0
    if hit:
        t = time
        p, q = between(p0, q0, t), between(p1, q1, t)
        v = minus(q, p)
        c = cross(u, v)
        square = dot(c, c)
        if square <= PARALLEL * PARALLEL * dot(u, u) * dot(v, v):
            return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
        length = math.sqrt(square)
        r = minus(p, a0)
        w = cross(r, v)
        at_a = dot(w, c) / square
        w = cross(r, u)
        at_b = dot(w, c) / square
    elif abs(gap) > far or min(along_a, along_b) < -ON_BORDER or max(along_a, along_b) > 1.0 + ON_BORDER:
        return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
    n = (c[0] / length, c[1] / length, c[2] / length)
    # the two places that touch, seen at the start along the common normal of the touch
    x = between(p0, p1, at_b)
    y = between(a0, a1, at_a)
    s0 = dot(n, minus(x, y))
    start_gap = abs(s0) - radius
    if abs(s0) > rounding:
        side = 1.0 if s0 > 0.0 else -1.0
        if not hit and s0 * gap < 0.0 and abs(gap) > rounding:
            return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0  # as for a vertex
    else:
        wa = edge_inward_sum(edge_first, edge_inward, edge_a)
        wb = turn(edge_inward_sum(edge_first, edge_inward, edge_b), motion.start, False)
        s0 = dot(n, minus(wb, wa))
        if abs(s0) <= LEVEL:
            s0 = dot(n, minus(middle_b, middle_a))
        side = -1.0 if s0 < 0.0 else 1.0
    d = (side * n[0], side * n[1], side * n[2])
    if not edge_is_nearest(edge_first, edge_inward, edge_a, d, SLACK):
        return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
    back = turn_at((-d[0], -d[1], -d[2]), motion, t, True)
    if not edge_is_nearest(edge_first, edge_inward, edge_b, back, SLACK):
        return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
    if edge_is_behind(
        points, vertex_first, vertex_neighbours, edges, edge_first, edge_opposite,
        edge_b, edge_a, d, motion, False, between(between(p0, q0, t), between(p1, q1, t), at_b), at_b, t, rounding,
    ):  # fmt: skip
        return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
    start, end = motion.start.origin, motion.end.origin
    shift = between((start[0], start[1], start[2]), (end[0], end[1], end[2]), t)
    y = turn_at(minus(y, shift), motion, t, True)
    if edge_is_behind(
        points, vertex_first, vertex_neighbours, edges, edge_first, edge_opposite,
        edge_a, edge_b, back, motion, True, y, at_a, t, rounding,
    ):  # fmt: skip
        return NEITHER, 1.0, 0.0, 0.0, 0.0, 0.0
    if dot(c, c1) < 0.0:  # turned over between the hit and the end
        side = -side
    gap *= side
    verdict, time = touch_of_rounding(hit, time, start_gap, gap - radius, radius)
    return verdict, time, side, gap - radius, along_a, along_b
