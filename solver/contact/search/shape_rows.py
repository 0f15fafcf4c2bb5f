"""Rings and convex primitives on surfaces: placed in the axes of the contour, and the rows of their contact."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate, rotate_back
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.search.directions import put_directions
from heavylift.solver.interface import Workspace

__all__ = ["place_shape", "put_touch"]


@kernel(internal=True)
def place_shape(contacts: ContactRows, c: int, y1: float, y2: float, y3: float, work: Workspace) -> None:
    """The primitive in the axes of the contour: its axes turn with the three directions of its body."""
    pose, scratch = contacts.poses[contacts.table[c].contour], contacts.scratch
    given, placed = contacts.values[c].primitive, scratch.primitive
    placed.centre[0], placed.centre[1], placed.centre[2] = y1, y2, y3
    for k in range(3):
        placed.sizes[k] = given.sizes[k]
    placed.radius, placed.shift = given.radius, given.shift
    first = contacts.table[c].axes
    for column in range(3):
        w1 = w2 = w3 = 0.0
        for m in range(3):
            share = given.axes[m, column]
            w1 += share * work.markers[first + m].point[0]
            w2 += share * work.markers[first + m].point[1]
            w3 += share * work.markers[first + m].point[2]
        b = rotate_back(pose.rotation, (w1, w2, w3))
        for k in range(3):
            placed.axes[k, column] = b[k]


@kernel(internal=True)
def put_touch(
    contacts: ContactRows, c: int, n1: float, n2: float, n3: float, x1: float, x2: float, x3: float
) -> None:
    """Directions from the normal, lever, and arm x, all in the axes of the contour."""
    contour, scratch = contacts.table[c].contour, contacts.scratch
    result = scratch.result
    a1, a2, a3 = result.tangent_u[0], result.tangent_u[1], result.tangent_u[2]
    share = a1 * n1 + a2 * n2 + a3 * n3
    if share * share > 0.8 * (a1 * a1 + a2 * a2 + a3 * a3):  # at an edge the normal may lie along it
        a1, a2, a3 = result.tangent_v[0], result.tangent_v[1], result.tangent_v[2]
        share = a1 * n1 + a2 * n2 + a3 * n3
    t1, t2, t3 = a1 - share * n1, a2 - share * n2, a3 - share * n3
    size = 1.0 / math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    put_directions(contacts, contour, n1, n2, n3, size * t1, size * t2, size * t3)
    x = rotate(contacts.poses[contour].rotation, (x1, x2, x3))
    for k in range(3):
        scratch.arm[k] = x[k]
        scratch.lever[k] = result.position[k]
