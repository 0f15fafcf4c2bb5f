"""The list of contacts of an interval, in which a vertex on the seam of two coplanar faces stands once.

Contacts that may repeat each other are found through a hash table (linear probing) that belongs to the list; nothing is
allocated, and the cost for each contact does not depend on their number.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, FACE_VERTEX, VERTEX_FACE, fixed_point
from heavylift.contours.triangles.feature_judge import HIT, PRESSED
from heavylift.numerics.arrays import Arrays, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, records
from heavylift.numerics.vectors import Vector, cross, dot, rotate, scaled, subtract

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.triangles.feature_judge import Meeting, Verdict
    from heavylift.contours.triangles.surface_layout import Edge, RelativeMotion
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

__all__ = ["UNIQUE", "UNKNOWN", "ContactList", "FoundContact", "make_contact_list", "report", "shared_end"]

UNIQUE = -1
"""In place of a vertex: the pair of features cannot repeat another one."""

UNKNOWN = -1
"""In place of a hit: what was found is inside, and nobody knows from which side."""

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
        1 if hit in the interval, `UNKNOWN` if it is inside and nobody knows from which side, else 0.
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
    entered
        How many slots have been taken since they were emptied, then these; shape (at least as many contacts + 1,).
    corners
        Of a triangle of B at the start, then at the end [m]; scratch, shape (6, 3).
    """

    contacts: Records[FoundContact]
    table: Ints1
    entered: Ints1
    corners: Floats2


def make_contact_list(capacity: int) -> ContactList:
    """An empty list for three quarters of a number of contacts, or a little less."""
    slots = 4
    while 2 * slots <= capacity:
        slots *= 2
    room = min(capacity - slots // 4, 3 * slots // 4)  # a full table would be searched for ever
    table, entered = np.full(slots, -1, dtype=np.int64), np.zeros(room + 1, dtype=np.int64)
    return ContactList(records(FoundContact, room), table, entered, np.zeros((6, 3)))


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
    surfaces: CollisionSurfaces,
    motion: RelativeMotion,
    kind: int,
    feature_a: int,
    feature_b: int,
    side: float,
) -> Vector:
    """Unit normal at the end, in axes that are the same for all contacts of a kind."""
    if kind != EDGE_EDGE:
        return scaled(side, fixed_point(surfaces.normals, feature_a if kind == VERTEX_FACE else feature_b))
    points, edges = surfaces.points, surfaces.edges
    u = subtract(fixed_point(points, edges[feature_a].ends[1]), fixed_point(points, edges[feature_a].ends[0]))
    v = subtract(fixed_point(points, edges[feature_b].ends[1]), fixed_point(points, edges[feature_b].ends[0]))
    n = cross(u, rotate(motion.end.rotation, v))
    return scaled(side / math.sqrt(dot(n, n)), n)


@kernel(internal=True)
def report(
    # model
    surfaces: CollisionSurfaces,
    meeting: Meeting,
    # contact
    kind: int,
    feature_a: int,
    feature_b: int,
    vertex: int,
    verdict: Verdict,
    # list
    found: int,
    out: ContactList,
) -> int:
    """Add a contact to the list, unless it repeats one.

    Parameters
    ----------
    surfaces, meeting
        All surfaces of a scene, and those that meet.
    kind, feature_a, feature_b, verdict
        Of the contact.
    vertex
        Row of points where the contact is, or `UNIQUE`.
    found, out
        Number of contacts so far, and the list.

    Returns
    -------
    found
        The new number; -2 if there is no room.
    """
    contacts, table = out.contacts, out.table
    hit = 1 if verdict.outcome == HIT else (UNKNOWN if verdict.outcome == PRESSED else 0)
    slot = 0
    if vertex != UNIQUE:
        slots = table.shape[0]
        if found == 0:
            clear(table, out.entered)
        n = normal_of(surfaces, meeting.motion, kind, feature_a, feature_b, verdict.side)
        slot = ((vertex * 0x9E3779B1) >> 7) & (slots - 1)
        while True:
            if table[slot] < 0:
                break
            other = contacts[table[slot]]
            other_a, other_b = other.first, other.second
            same = kind == other.kind and abs(verdict.gap - other.gap) <= meeting.rounding
            if same:
                if kind == VERTEX_FACE:
                    same = feature_b == other_b
                elif kind == FACE_VERTEX:
                    same = feature_a == other_a
                else:
                    same = meets(surfaces.edges, feature_a, other_a, vertex) and meets(
                        surfaces.edges, feature_b, other_b, vertex
                    )
            if same:
                m = normal_of(surfaces, meeting.motion, kind, other_a, other_b, other.side)
                same = dot(n, m) >= 1.0 - SAME
            if same:
                if verdict.outcome == HIT:
                    other.time = min(verdict.time, other.time)
                other.hit = max(other.hit, hit)
                return found
            slot = (slot + 1) & (slots - 1)
    elif found == 0:
        clear(table, out.entered)
    if found >= contacts.shape[0]:
        return -2
    if vertex != UNIQUE:
        table[slot] = found
        out.entered[0] += 1
        out.entered[out.entered[0]] = slot
    new = contacts[found]
    new.kind, new.first, new.second = kind, feature_a, feature_b
    new.hit = hit
    new.time = verdict.time if verdict.outcome == HIT else 1.0
    new.side, new.gap = verdict.side, verdict.gap
    return found + 1


@kernel(inline=True, internal=True)
def clear(table: NDArray[np.int64], entered: NDArray[np.int64]) -> None:
    """Empty the slots of the table that have been taken."""
    for i in range(entered[0]):
        table[entered[1 + i]] = -1
    entered[0] = 0
