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
* says nothing of the time, sees no face that moves in its own plane (a prism without volume), and decides what lies
  on an edge by rounding.

`swept` has the tests that are used instead.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.triangles.position_difference_shapes import (
    edge_through_rectangle,
    inside_prism,
    path_through_triangle,
)
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError

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

Points = NDArray[np.float64]


@kernel(internal=True)
def difference_vertex_face(
    x0x: float,
    x0y: float,
    x0z: float,
    x1x: float,
    x1y: float,
    x1z: float,
    a0x: float,
    a0y: float,
    a0z: float,
    a1x: float,
    a1y: float,
    a1z: float,
    b0x: float,
    b0y: float,
    b0z: float,
    b1x: float,
    b1y: float,
    b1z: float,
    c0x: float,
    c0y: float,
    c0z: float,
    c1x: float,
    c1y: float,
    c1z: float,
    cases: int,
) -> tuple[bool, float]:
    """Test a vertex and a face by the position difference method.

    Parameters
    ----------
    x0x, x0y, x0z, x1x, x1y, x1z
        Vertex at the start and at the end [m].
    a0x, a0y, a0z, a1x, a1y, a1z
        First corner of the face at the start and at the end [m].
    b0x, b0y, b0z, b1x, b1y, b1z
        Second corner.
    c0x, c0y, c0z, c1x, c1y, c1z
        Third corner.
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
        hit, time, _, _ = path_through_triangle(
            x0x, x0y, x0z, x1x, x1y, x1z, a1x, a1y, a1z, b1x, b1y, b1z, c1x, c1y, c1z
        )
        if hit:
            return True, time
    if cases & VERTEX_MOVES_START:
        hit, time, _, _ = path_through_triangle(
            x0x, x0y, x0z, x1x, x1y, x1z, a0x, a0y, a0z, b0x, b0y, b0z, c0x, c0y, c0z
        )
        if hit:
            return True, time
    if cases & FACE_SWEEPS and inside_prism(
        x1x, x1y, x1z,
        a0x, a0y, a0z, b0x, b0y, b0z, c0x, c0y, c0z, a1x, a1y, a1z, b1x, b1y, b1z, c1x, c1y, c1z,
    ):  # fmt: skip
        return True, 1.0
    if cases & FACE_SWEEPS_START and inside_prism(
        x0x, x0y, x0z,
        a0x, a0y, a0z, b0x, b0y, b0z, c0x, c0y, c0z, a1x, a1y, a1z, b1x, b1y, b1z, c1x, c1y, c1z,
    ):  # fmt: skip
        return True, 1.0
    return False, 1.0


@kernel(internal=True)
def difference_edges(
    a0x: float,
    a0y: float,
    a0z: float,
    a1x: float,
    a1y: float,
    a1z: float,
    b0x: float,
    b0y: float,
    b0z: float,
    b1x: float,
    b1y: float,
    b1z: float,
    p0x: float,
    p0y: float,
    p0z: float,
    p1x: float,
    p1y: float,
    p1z: float,
    q0x: float,
    q0y: float,
    q0z: float,
    q1x: float,
    q1y: float,
    q1z: float,
    cases: int,
) -> tuple[bool, float]:
    """Test an edge of body 1 and an edge of body 2 by the position difference method.

    Parameters
    ----------
    a0x, a0y, a0z, a1x, a1y, a1z
        First end of the edge of body 1 at the start and at the end [m].
    b0x, b0y, b0z, b1x, b1y, b1z
        Its second end.
    p0x, p0y, p0z, p1x, p1y, p1z
        First end of the edge of body 2 at the start and at the end [m].
    q0x, q0y, q0z, q1x, q1y, q1z
        Its second end.
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
        hit, time = edge_through_rectangle(
            a1x, a1y, a1z, b1x, b1y, b1z,
            p0x, p0y, p0z, q0x, q0y, q0z, p1x, p1y, p1z, q1x, q1y, q1z,
        )  # fmt: skip
        if hit:
            return True, time
    if cases & SECOND_EDGE_SWEEPS_START:
        hit, time = edge_through_rectangle(
            a0x, a0y, a0z, b0x, b0y, b0z,
            p0x, p0y, p0z, q0x, q0y, q0z, p1x, p1y, p1z, q1x, q1y, q1z,
        )  # fmt: skip
        if hit:
            return True, time
    if cases & FIRST_EDGE_SWEEPS:
        hit, time = edge_through_rectangle(
            p0x, p0y, p0z, q0x, q0y, q0z,
            a0x, a0y, a0z, b0x, b0y, b0z, a1x, a1y, a1z, b1x, b1y, b1z,
        )  # fmt: skip
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
        p = points[i]
        if edges:
            hits[i], _ = difference_edges(
                p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11],
                p[12], p[13], p[14], p[15], p[16], p[17], p[18], p[19], p[20], p[21], p[22], p[23], cases,
            )  # fmt: skip
        else:
            hits[i], _ = difference_vertex_face(
                p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11],
                p[12], p[13], p[14], p[15], p[16], p[17], p[18], p[19], p[20], p[21], p[22], p[23], cases,
            )  # fmt: skip


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
