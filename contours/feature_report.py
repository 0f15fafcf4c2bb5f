"""The list of contacts of an interval, in which a vertex on the seam of two coplanar faces stands once.

Contacts that may repeat each other are found through a hash table (linear probing) in the last rows of the list
itself; nothing is allocated, and the cost for each contact does not depend on their number.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.contours.feature_gap import EDGE_EDGE, FACE_VERTEX, VERTEX_FACE, fixed_point, turned
from heavylift.contours.feature_judge import HIT, dot, minus
from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cross

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from heavylift.contours.surface_layout import Edge, RelativeMotion
    from heavylift.numerics.records import Records

__all__ = ["UNIQUE", "report", "room_for", "shared_end"]

UNIQUE = -1
"""In place of a vertex: the pair of features cannot repeat another one."""

SAME = 1e-6
"""One minus the cosine of the angle between normals that count as the same."""

AT_END = 1e-7
"""Part of an edge within which a place counts as the end."""

Vector = tuple[float, float, float]


@kernel(internal=True)
def room_for(features: NDArray[np.int64]) -> int:
    """Number of contacts that fit in the list: the last rows hold the table, one slot for each row or fewer."""
    capacity = features.shape[0]
    slots = 4
    while 2 * slots <= capacity:
        slots *= 2
    return min(capacity - slots // 4, 3 * slots // 4)  # a full table would be searched for ever


@kernel(inline=True, internal=True)
def shared_end(edges: Records[Edge], edge_a: int, edge_b: int, along_a: float, along_b: float) -> int:
    """The vertex at which two edges touch, that of B first; `UNIQUE` between their ends."""
    if abs(along_b) <= AT_END:
        return edges[edge_b].ends[0]
    if abs(along_b - 1.0) <= AT_END:
        return edges[edge_b].ends[1]
    if abs(along_a) <= AT_END:
        return edges[edge_a].ends[0]
    if abs(along_a - 1.0) <= AT_END:
        return edges[edge_a].ends[1]
    return UNIQUE


@kernel(inline=True, internal=True)
def meets(edges: Records[Edge], edge: int, other: int, vertex: int) -> bool:
    """Whether two edges are the same, or both end in a vertex."""
    if edge == other:
        return True
    return (edges[edge].ends[0] == vertex or edges[edge].ends[1] == vertex) and (
        edges[other].ends[0] == vertex or edges[other].ends[1] == vertex
    )


@kernel(internal=True)
def normal_of(
    points: NDArray[np.float64],
    edges: Records[Edge],
    normals: NDArray[np.float64],
    motion: RelativeMotion,
    kind: int,
    feature_a: int,
    feature_b: int,
    side: float,
) -> Vector:
    """Unit normal at the end, in axes that are the same for all contacts of a kind."""
    if kind == EDGE_EDGE:
        u = minus(
            fixed_point(points, edges[feature_a].ends[1]), fixed_point(points, edges[feature_a].ends[0])
        )
        w = minus(
            fixed_point(points, edges[feature_b].ends[1]), fixed_point(points, edges[feature_b].ends[0])
        )
        v = turned(w[0], w[1], w[2], motion.end)
        n = cross(u[0], u[1], u[2], v[0], v[1], v[2])
        side /= math.sqrt(dot(n, n))
    else:
        n = fixed_point(normals, feature_a if kind == VERTEX_FACE else feature_b)
    return side * n[0], side * n[1], side * n[2]


@kernel(internal=True)
def report(
    # model
    points: NDArray[np.float64],
    edges: Records[Edge],
    normals: NDArray[np.float64],
    motion: RelativeMotion,
    # contact
    kind: int,
    feature_a: int,
    feature_b: int,
    vertex: int,
    verdict: int,
    time: float,
    side: float,
    gap: float,
    rounding: float,
    # list
    found: int,
    room: int,
    features: NDArray[np.int64],
    numbers: NDArray[np.float64],
) -> int:
    """Add a contact to the list, unless it repeats one.

    Parameters
    ----------
    points, edges, normals
        Of the packed surfaces.
    motion
        Relative motion, see `find_contacts`.
    kind, feature_a, feature_b, verdict, time, side, gap
        Of the contact.
    vertex
        Row of points where the contact is, or `UNIQUE`.
    rounding
        Gaps [m] that differ by less are the same.
    found, room, features, numbers
        Number of contacts so far, largest number, and the list.

    Returns
    -------
    found
        The new number; -2 if there is no room.
    """
    slot = 0
    if vertex != UNIQUE:
        slots = 4 * (features.shape[0] - room)
        if found == 0:
            clear(features, room)
        n = normal_of(points, edges, normals, motion, kind, feature_a, feature_b, side)
        slot = ((vertex * 0x9E3779B1) >> 7) & (slots - 1)
        while True:
            k = features[room + (slot >> 2), slot & 3]
            if k < 0:
                break
            other_a, other_b = features[k, 1], features[k, 2]
            same = kind == features[k, 0] and abs(gap - numbers[k, 2]) <= rounding
            if same:
                if kind == VERTEX_FACE:
                    same = feature_b == other_b
                elif kind == FACE_VERTEX:
                    same = feature_a == other_a
                else:
                    same = meets(edges, feature_a, other_a, vertex) and meets(
                        edges, feature_b, other_b, vertex
                    )
            if same:
                m = normal_of(points, edges, normals, motion, kind, other_a, other_b, numbers[k, 1])
                same = dot(n, m) >= 1.0 - SAME
            if same:
                if verdict == HIT:
                    numbers[k, 0] = min(time, numbers[k, 0])
                    features[k, 3] = 1
                return found
            slot = (slot + 1) & (slots - 1)
    elif found == 0:
        clear(features, room)
    if found >= room:
        return -2
    if vertex != UNIQUE:
        features[room + (slot >> 2), slot & 3] = found
    features[found, 0] = kind
    features[found, 1] = feature_a
    features[found, 2] = feature_b
    features[found, 3] = 1 if verdict == HIT else 0
    numbers[found, 0] = time if verdict == HIT else 1.0
    numbers[found, 1] = side
    numbers[found, 2] = gap
    return found + 1


@kernel(inline=True, internal=True)
def clear(features: NDArray[np.int64], room: int) -> None:
    """Empty the table."""
    for row in range(room, features.shape[0]):
        for column in range(4):
            features[row, column] = -1
