"""The list of contacts of an interval, in which a vertex on the seam of two coplanar faces stands once.

Contacts that may repeat each other are found through a hash table (linear probing) that belongs to the list; nothing is
allocated, and the cost for each contact does not depend on their number.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, FACE_VERTEX, VERTEX_FACE, fixed_point, turned
from heavylift.contours.triangles.feature_judge import HIT, dot, minus
from heavylift.numerics.arrays import Arrays, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, records
from heavylift.numerics.vectors import Vector, cross

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.triangles.surface_layout import Edge, RelativeMotion

__all__ = ["UNIQUE", "ContactList", "FoundContact", "make_contact_list", "report", "shared_end"]

UNIQUE = -1
"""In place of a vertex: the pair of features cannot repeat another one."""

SAME = 1e-6
"""One minus the cosine of the angle between normals that count as the same."""

AT_END = 1e-7
"""Part of an edge within which a place counts as the end."""


class FoundContact(Record):
    """Two features that are hit, or near at the end.

    Attributes
    ----------
    kind, first, second
        Kind of the features, and feature of A and of B: rows of points, edges or triangles.
    hit
        1 if hit in the interval, else 0.
    time
        Of impact, in [0, 1]; 1 if not hit.
    side
        As `contact_gap` takes it.
    gap
        At the end [m].
    """

    kind: int
    first: int
    second: int
    hit: int
    time: float
    side: float
    gap: float


class ContactList(Arrays):
    """What a search has found.

    Attributes
    ----------
    contacts
        As many as fit in.
    table
        Slots of the hash table: places in the list, or -1; their number is a power of 2.
    corners
        Of a triangle of B at the start, then at the end [m]; scratch, shape (6, 3).
    """

    contacts: Records[FoundContact]
    table: Ints1
    corners: Floats2


def make_contact_list(capacity: int) -> ContactList:
    """An empty list for three quarters of a number of contacts, or a little less."""
    slots = 4
    while 2 * slots <= capacity:
        slots *= 2
    room = min(capacity - slots // 4, 3 * slots // 4)  # a full table would be searched for ever
    return ContactList(records(FoundContact, room), np.full(slots, -1, dtype=np.int64), np.zeros((6, 3)))


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
        n = cross(u, v)
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
    out: ContactList,
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
    found, out
        Number of contacts so far, and the list.

    Returns
    -------
    found
        The new number; -2 if there is no room.
    """
    contacts, table = out.contacts, out.table
    slot = 0
    if vertex != UNIQUE:
        slots = table.shape[0]
        if found == 0:
            clear(table)
        n = normal_of(points, edges, normals, motion, kind, feature_a, feature_b, side)
        slot = ((vertex * 0x9E3779B1) >> 7) & (slots - 1)
        while True:
            if table[slot] < 0:
                break
            other = contacts[table[slot]]
            other_a, other_b = other.first, other.second
            same = kind == other.kind and abs(gap - other.gap) <= rounding
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
                m = normal_of(points, edges, normals, motion, kind, other_a, other_b, other.side)
                same = dot(n, m) >= 1.0 - SAME
            if same:
                if verdict == HIT:
                    other.time = min(time, other.time)
                    other.hit = 1
                return found
            slot = (slot + 1) & (slots - 1)
    elif found == 0:
        clear(table)
    if found >= contacts.shape[0]:
        return -2
    if vertex != UNIQUE:
        table[slot] = found
    new = contacts[found]
    new.kind, new.first, new.second = kind, feature_a, feature_b
    new.hit = 1 if verdict == HIT else 0
    new.time = time if verdict == HIT else 1.0
    new.side, new.gap = side, gap
    return found + 1


@kernel(inline=True, internal=True)
def clear(table: NDArray[np.int64]) -> None:
    """Empty the table."""
    for slot in range(table.shape[0]):
        table[slot] = -1
