"""The position difference method: collisions from positions at the start and the end of a step, for comparison only.

"Integrated simulation ... ships and offshore structures (2018)", section 2.6.1 (1), gives five printed cases:

=====================================  ========================================================================
vertex and face, first case            path of the vertex of body 2 through the face of body 1 at the end
vertex and face, second case           vertex of body 1 at the end inside the prism that a face of body 2 sweeps
vertex and face, third case (1), (2)   as the first with the face, as the second with the vertex, at the start
edges, first case                      rectangle that the edge of body 2 sweeps, with the edge of body 1 at the end
edges, second case (1), (2)            the same with the edge of body 1 at the start; bodies exchanged, edge of
                                       body 2 at the start
=====================================  ========================================================================

They are evaluated as printed, in the world frame, if positions in the world are given. With positions in the axes of
body 1 (`to_axes`) its features stand still: the path of a vertex is then tested exactly; prisms and rectangles still
are exact for translations only. The method is not used for simulation, because it

* misses contacts: both features move, but each case freezes one of them. Of 1e5 random pairs of moving rigid bodies
  all cases together miss 12 to 14 % of the vertex-face contacts and 10 % of those of edges; with a common translation
  of three element sizes 41 to 43 % and 31 %: the result depends on the observer. In the axes of body 1 they miss
  none of a vertex on a face of body 1, 7 % of a face on a vertex of body 1, and 2 % of edges;
* invents contacts for the same reason: in the world 1.6 to 3.7 for each true one of vertex and face and 0.8 to 2.2 of
  edges, in the axes of body 1 up to 0.4;
* gives no information on the time, sees no face that moves in its own plane (a prism without volume), and decides
  by rounding what lies on an edge.

`swept` has the tests that are used instead.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.vectors import Vector, add, between, cross, dot, scaled, subtract, vector_at

__all__ = [
    "EDGE_CASES",
    "FACE_SWEEPS",
    "FACE_SWEEPS_START",
    "FIRST_EDGE_SWEEPS",
    "SECOND_EDGE_SWEEPS",
    "SECOND_EDGE_SWEEPS_START",
    "VERTEX_CASES",
    "VERTEX_MOVES",
    "VERTEX_MOVES_START",
    "difference_edges",
    "difference_pairs",
    "difference_vertex_face",
    "to_axes",
]

VERTEX_MOVES = 1
"""Vertex and face, first case."""

FACE_SWEEPS = 2
"""Vertex and face, second case."""

VERTEX_MOVES_START = 4
"""Vertex and face, third case (1)."""

FACE_SWEEPS_START = 8
"""Vertex and face, third case (2)."""

VERTEX_CASES = 15
"""All cases of vertex and face."""

SECOND_EDGE_SWEEPS = 1
"""Edges, first case."""

SECOND_EDGE_SWEEPS_START = 2
"""Edges, second case (1)."""

FIRST_EDGE_SWEEPS = 4
"""Edges, second case (2)."""

EDGE_CASES = 7
"""All cases of edges."""

ROUNDING = 1e-24
"""Squared sine of the angle to the plane below which a prism has no volume: a face that does not move."""

Points = NDArray[np.float64]


@kernel(internal=True)
def path_through_triangle(
    p: Vector, q: Vector, a: Vector, b: Vector, c: Vector
) -> tuple[bool, float, float, float]:
    """Intersection of the segment from p to q with a triangle: whether, where along it, and weights of b and c."""
    e, f = subtract(b, a), subtract(c, a)
    n = cross(e, f)
    s0, s1 = dot(n, subtract(p, a)), dot(n, subtract(q, a))
    if s0 * s1 > 0.0 or s0 == s1:
        return False, 0.0, 0.0, 0.0
    t = s0 / (s0 - s1)
    w = subtract(between(p, q, t), a)
    n2 = dot(n, n)
    u, v = dot(cross(w, f), n) / n2, dot(cross(e, w), n) / n2
    return u >= 0.0 and v >= 0.0 and u + v <= 1.0, t, u, v


@kernel(internal=True)
def same_side(o: Vector, u: Vector, v: Vector, x: Vector, m: Vector) -> bool:
    """Whether x and m lie on the same side of the plane through o along u and v, m not within rounding of it."""
    n, w = cross(u, v), subtract(m, o)
    of_x, of_m = dot(n, subtract(x, o)), dot(n, w)
    flat = of_m * of_m <= ROUNDING * dot(n, n) * dot(w, w)
    return of_x * of_m > 0.0 and not flat


@kernel(internal=True)
def inside_strip(a0: Vector, b0: Vector, a1: Vector, b1: Vector, x: Vector, m: Vector) -> bool:
    """Whether x and m lie on the same side of the strip that the edge a b sweeps.

    Its plane goes through the middle of the strip along its mean directions: exact for a translation.
    """
    middle = scaled(0.25, add(add(add(a0, b0), a1), b1))
    along = subtract(add(subtract(b0, a0), b1), a1)
    across = subtract(add(subtract(a1, a0), b1), b0)
    return same_side(middle, along, across, x, m)


@kernel(internal=True)
def inside_prism(x: Vector, a0: Vector, b0: Vector, c0: Vector, a1: Vector, b1: Vector, c1: Vector) -> bool:
    """Whether a point lies inside the prism between a face at the start and at the end, by five planes."""
    total = add(add(add(add(add(a0, b0), c0), a1), b1), c1)
    m = total[0] / 6.0, total[1] / 6.0, total[2] / 6.0
    return (
        same_side(a0, subtract(b0, a0), subtract(c0, a0), x, m)
        and same_side(a1, subtract(b1, a1), subtract(c1, a1), x, m)
        and inside_strip(a0, b0, a1, b1, x, m)
        and inside_strip(b0, c0, b1, c1, x, m)
        and inside_strip(c0, a0, c1, a1, x, m)
    )


@kernel(internal=True)
def edge_through_rectangle(
    a: Vector, b: Vector, p0: Vector, q0: Vector, p1: Vector, q1: Vector
) -> tuple[bool, float]:
    """Whether the edge a b meets the rectangle that the edge p q sweeps, as two triangles, and how far along."""
    hit, _, u, v = path_through_triangle(a, b, p0, q0, q1)
    if hit:
        return True, v
    hit, _, u, v = path_through_triangle(a, b, p0, p1, q1)
    return hit, u + v


@kernel(internal=True)
def difference_vertex_face(
    x0: Vector,
    x1: Vector,
    a0: Vector,
    a1: Vector,
    b0: Vector,
    b1: Vector,
    c0: Vector,
    c1: Vector,
    cases: int,
) -> tuple[bool, float]:
    """Test a vertex and a face by the position difference method.

    Parameters
    ----------
    x0, x1
        Vertex at the start and at the end [m].
    a0, a1, b0, b1, c0, c1
        Corners of the face, each at the start and at the end [m].
    cases
        Sum of the cases to try, such as `VERTEX_CASES`.

    Returns
    -------
    hit
        Whether one of the cases holds.
    time
        Of contact in [0, 1], a guess, because the method does not define it: along the path; 1 for a prism.
    """
    if cases & VERTEX_MOVES:
        hit, time, _, _ = path_through_triangle(x0, x1, a1, b1, c1)
        if hit:
            return True, time
    if cases & VERTEX_MOVES_START:
        hit, time, _, _ = path_through_triangle(x0, x1, a0, b0, c0)
        if hit:
            return True, time
    if cases & FACE_SWEEPS and inside_prism(x1, a0, b0, c0, a1, b1, c1):
        return True, 1.0
    if cases & FACE_SWEEPS_START and inside_prism(x0, a0, b0, c0, a1, b1, c1):
        return True, 1.0
    return False, 1.0


@kernel(internal=True)
def difference_edges(
    a0: Vector,
    a1: Vector,
    b0: Vector,
    b1: Vector,
    p0: Vector,
    p1: Vector,
    q0: Vector,
    q1: Vector,
    cases: int,
) -> tuple[bool, float]:
    """Test an edge of body 1 and an edge of body 2 by the position difference method.

    Parameters
    ----------
    a0, a1, b0, b1
        Ends of the edge of body 1, each at the start and at the end [m].
    p0, p1, q0, q1
        Ends of the edge of body 2.
    cases
        Sum of the cases to try, such as `EDGE_CASES`.

    Returns
    -------
    hit
        Whether one of the cases holds.
    time
        Of contact in [0, 1], a guess, because the method does not define it: how far along the rectangle.
    """
    if cases & SECOND_EDGE_SWEEPS:
        hit, time = edge_through_rectangle(a1, b1, p0, q0, p1, q1)
        if hit:
            return True, time
    if cases & SECOND_EDGE_SWEEPS_START:
        hit, time = edge_through_rectangle(a0, b0, p0, q0, p1, q1)
        if hit:
            return True, time
    if cases & FIRST_EDGE_SWEEPS:
        hit, time = edge_through_rectangle(p0, q0, a0, b0, a1, b1)
        if hit:
            return True, time
    return False, 1.0


@kernel
def difference_pairs(points: Points, edges: bool, cases: int, hits: NDArray[np.bool_]) -> None:
    """Test many pairs.

    Parameters
    ----------
    points
        Positions [m], shape (n, 24): the four points of `difference_vertex_face` or `difference_edges`, each at
        the start and at the end.
    edges
        Whether the pairs are edges.
    cases
        Sum of the cases to try.
    hits
        Filled, shape (n,).
    """
    for i in range(len(hits)):
        row = points[i]
        a0, a1, b0, b1 = vector_at(row, 0), vector_at(row, 3), vector_at(row, 6), vector_at(row, 9)
        c0, c1, d0, d1 = vector_at(row, 12), vector_at(row, 15), vector_at(row, 18), vector_at(row, 21)
        if edges:
            hits[i], _ = difference_edges(a0, a1, b0, b1, c0, c1, d0, d1, cases)
        else:
            hits[i], _ = difference_vertex_face(a0, a1, b0, b1, c0, c1, d0, d1, cases)


def to_axes(points: Points, rotations: Points, origins: Points) -> Points:
    """Positions in the axes of a moving body, in which its own features stand still.

    Parameters
    ----------
    points
        Positions in the world [m], shape (n, 24) as in `difference_pairs`.
    rotations
        From the axes of the body to the world at the start and at the end, shape (n, 2, 3, 3).
    origins
        Origin of the body at the start and at the end [m], shape (n, 2, 3).

    Returns
    -------
    Positions [m], shape (n, 24).

    Raises
    ------
    InputError
        If the shapes do not fit.
    """
    count = len(points)
    for name, array, shape in (
        ("points", points, (count, 24)),
        ("rotations", rotations, (count, 2, 3, 3)),
        ("origins", origins, (count, 2, 3)),
    ):
        if array.shape != shape:
            raise InputError(f"shape {array.shape}", source="to_axes", key=name, expected=f"shape {shape}")
    relative = points.reshape(count, 4, 2, 3) - origins[:, None]
    turned = np.einsum("ntij,nkti->nktj", rotations, relative)
    return np.ascontiguousarray(turned.reshape(count, 24))
