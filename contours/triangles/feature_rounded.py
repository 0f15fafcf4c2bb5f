"""Contacts beside the borders of rounded surfaces: vertex and edge, and two vertices.

Around its triangles a rounded surface has cylinders along the edges and spheres about the vertices. Their distances are
those of points from points and lines, whose first touch of a linear motion is the root of a quadratic.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.triangles.feature_gap import (
    EDGE_VERTEX,
    VERTEX_EDGE,
    VERTEX_VERTEX,
    fixed_point,
    to_axes_of_b,
)
from heavylift.contours.triangles.feature_judge import (
    HIT,
    NEAR,
    NEITHER,
    SLACK,
    Verdict,
    edge_is_nearest,
    no_contact,
    turn_at,
    vertex_is_nearest,
)
from heavylift.contours.triangles.feature_report import UNIQUE, report
from heavylift.contours.triangles.surface_layout import OWNS_A, OWNS_AB
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, between, dot, scaled, subtract

if TYPE_CHECKING:
    from heavylift.contours.triangles.feature_judge import Meeting
    from heavylift.contours.triangles.feature_report import ContactList
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

__all__ = ["rounded_contacts"]

STRICTLY = -1e-6
"""Slack of regions whose borders belong to a neighbour: faces to their edges, edges to their vertices."""


@kernel(internal=True)
def first_touch(d0: Vector, d1: Vector, radius: float, far: float) -> tuple[int, float]:
    """Whether a separation [m] that moves linearly comes down to a radius, or ends within `far`, and when."""
    u = subtract(d1, d0)
    excess = dot(d0, d0) - radius * radius
    rate = dot(d0, u)
    square = dot(u, u)
    if excess > 0.0 and rate < 0.0:
        discriminant = rate * rate - square * excess
        if discriminant >= 0.0:
            t = excess / (math.sqrt(discriminant) - rate)
            if t <= 1.0:
                return HIT, t
    return (NEAR if dot(d1, d1) <= far * far else NEITHER), 1.0


@kernel(inline=True, internal=True)
def off_line(p: Vector, a: Vector, b: Vector) -> tuple[Vector, float]:
    """Offset [m] of a point from the line through a and b, and the place of its foot: 0 at a, 1 at b."""
    u = subtract(b, a)
    r = subtract(p, a)
    s = dot(r, u) / dot(u, u)
    return add_scaled(r, -s, u), s


@kernel(inline=True, internal=True)
def unit(d: Vector) -> tuple[Vector, float]:
    """Direction of a vector, and its length."""
    length = math.sqrt(dot(d, d))
    return scaled(1.0 / length if length > 0.0 else 0.0, d), length


@kernel(internal=True)
def judge_vertex_edge(
    # model
    surfaces: CollisionSurfaces,
    vertex: int,
    edge: int,
    # motion
    meeting: Meeting,
    edge_moves: bool,
    x0: Vector,
    x1: Vector,
) -> Verdict:
    """Verdict on a vertex (at both ends of the interval in the axes of the edge) and an edge."""
    points, ends, radius = surfaces.points, surfaces.edges[edge].ends, meeting.radius
    a, b = fixed_point(points, ends[0]), fixed_point(points, ends[1])
    d0, s0 = off_line(x0, a, b)
    d1, s1 = off_line(x1, a, b)
    outcome, t = first_touch(d0, d1, radius, meeting.far)
    if outcome == NEITHER:
        return no_contact()
    s = s0 + t * (s1 - s0)
    d, length = unit(between(d0, d1, t))
    if length == 0.0 or s <= 0.0 or s >= 1.0 or not edge_is_nearest(surfaces, edge, d, STRICTLY):
        return no_contact()
    d = turn_at(scaled(-1.0, d), meeting.motion, t, not edge_moves)
    if not vertex_is_nearest(surfaces, vertex, d, SLACK):
        return no_contact()
    return Verdict(outcome, t, 1.0, math.sqrt(dot(d1, d1)) - radius)


@kernel(internal=True)
def judge_vertices(
    # model
    surfaces: CollisionSurfaces,
    vertex_a: int,
    vertex_b: int,
    # motion
    meeting: Meeting,
    x0: Vector,
    x1: Vector,
) -> Verdict:
    """Verdict on a vertex of A and one of B (at both ends of the interval in the axes of A)."""
    a, radius = fixed_point(surfaces.points, vertex_a), meeting.radius
    d0, d1 = subtract(x0, a), subtract(x1, a)
    outcome, t = first_touch(d0, d1, radius, meeting.far)
    if outcome == NEITHER:
        return no_contact()
    d, length = unit(between(d0, d1, t))
    if length == 0.0 or not vertex_is_nearest(surfaces, vertex_a, d, STRICTLY):
        return no_contact()
    d = turn_at(scaled(-1.0, d), meeting.motion, t, True)
    if not vertex_is_nearest(surfaces, vertex_b, d, STRICTLY):
        return no_contact()
    return Verdict(outcome, t, 1.0, math.sqrt(dot(d1, d1)) - radius)


@kernel(inline=True, internal=True)
def rounded_contacts(
    # model
    surfaces: CollisionSurfaces,
    ta: int,
    tb: int,
    # motion
    meeting: Meeting,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Report the contacts of all vertices and edges that two triangles own; see `contacts_of_pairs`."""
    points, triangles, motion = surfaces.points, surfaces.triangles, meeting.motion
    for i in range(3):
        for j in range(3):
            row_a, row_b = triangles[ta].corners[i], triangles[tb].corners[j]
            edge_a, edge_b = triangles[ta].edges[i], triangles[tb].edges[j]
            own_a, own_b = triangles[ta].flags & (OWNS_A << i), triangles[tb].flags & (OWNS_A << j)
            own_edge_a = triangles[ta].flags & (OWNS_AB << i)
            own_edge_b = triangles[tb].flags & (OWNS_AB << j)
            a = fixed_point(points, row_a)
            x0 = fixed_point(out.corners, j)
            x1 = fixed_point(out.corners, 3 + j)
            for kind in range(VERTEX_EDGE, VERTEX_VERTEX + 1):
                verdict = no_contact()
                feature_a, feature_b = row_a, row_b
                if kind == VERTEX_EDGE and own_b and own_edge_a:
                    feature_a = edge_a
                    verdict = judge_vertex_edge(surfaces, row_b, edge_a, meeting, False, x0, x1)
                elif kind == EDGE_VERTEX and own_a and own_edge_b:
                    feature_b = edge_b
                    y0, y1 = to_axes_of_b(a, motion.start), to_axes_of_b(a, motion.end)
                    verdict = judge_vertex_edge(surfaces, row_a, edge_b, meeting, True, y0, y1)
                elif kind == VERTEX_VERTEX and own_a and own_b:
                    verdict = judge_vertices(surfaces, row_a, row_b, meeting, x0, x1)
                if verdict.outcome != NEITHER:
                    found = report(surfaces, meeting, kind, feature_a, feature_b, UNIQUE, verdict, found, out)
                    if found < 0:
                        return found
    return found
