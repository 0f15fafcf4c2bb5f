"""The side of each other on which found features are: from their start, or from existing contacts."""

from __future__ import annotations

import math

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, feature_gap, moved, to_axes_of_b
from heavylift.contours.triangles.feature_report import UNKNOWN
from heavylift.contours.triangles.surface_layout import RelativePose
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import dot, rotate, subtract
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.slots import look_up

__all__ = [
    "ABOUT_NOTHING",
    "ALIGNED",
    "aligned",
    "deepest_of",
    "evaluate",
    "gap_at_start",
    "holds",
    "settle_sides",
]

ALIGNED = 0.9
"""Cosine between normals of contacts that lie on the same side of the same part."""

ABOUT_NOTHING = 1e-6
"""Of the size: a gap that does not tell the side."""


@kernel(inline=True, internal=True)
def holds(contacts: ContactRows, c: int) -> bool:
    """Whether a contact rests, or has been inside at the end of the last step: it knows its side."""
    return bool(contacts.state[c].closed or contacts.state[c].gap < 0.0)


@kernel(internal=True)
def evaluate(meshes: SurfacePairs, pair: int, i: int, pose: RelativePose, side: float) -> float:
    """Gap of what was found, at a pose; normal and points are left in `touch`."""
    found = meshes.found.contacts[i]
    return feature_gap(
        meshes.surfaces,
        found.kind,
        found.first,
        found.second,
        meshes.pairs[pair].radii,
        side,
        pose,
        meshes.touch,
    )


@kernel(internal=True)
def gap_at_start(meshes: SurfacePairs, pair: int, i: int) -> float:
    """Gap of what was found at the start of the step, where the product of two edges may point the other way."""
    side, touch = meshes.found.contacts[i].side, meshes.touch
    if meshes.found.contacts[i].kind == EDGE_EDGE:
        evaluate(meshes, pair, i, meshes.relative[pair], side)
        n1, n2, n3 = touch.normal[0], touch.normal[1], touch.normal[2]
        evaluate(meshes, pair, i, meshes.motions[pair].start, side)
        if n1 * touch.normal[0] + n2 * touch.normal[1] + n3 * touch.normal[2] < 0.0:
            side = -side
    return evaluate(meshes, pair, i, meshes.motions[pair].start, side)


@kernel(internal=True)
def _touching_at_start(meshes: SurfacePairs, pair: int, i: int) -> float:
    """How far at the start what touches at the end was from each other [m], along its normal there.

    Of two edges not the distance of the lines through them, which may cross beyond their ends.
    """
    if meshes.found.contacts[i].kind != EDGE_EDGE:
        return gap_at_start(meshes, pair, i)
    touch, start = meshes.touch, meshes.motions[pair].start
    evaluate(meshes, pair, i, meshes.relative[pair], meshes.found.contacts[i].side)
    d = subtract(moved(to_axes_of_b(touch.point_b, meshes.relative[pair]), start), touch.point_a)
    return dot(d, touch.normal) - meshes.pairs[pair].radii


@kernel(internal=True)
def aligned(meshes: SurfacePairs, contacts: ContactRows, pair: int, c: int) -> float:
    """Cosine between the normal left in `touch` and that of a contact."""
    touch, state = meshes.touch, contacts.state[c]
    pose = contacts.poses[meshes.pairs[pair].poses[0]]
    n1, n2, n3 = rotate(pose.rotation, touch.normal)
    return n1 * state.normal[0] + n2 * state.normal[1] + n3 * state.normal[2]


@kernel(internal=True)
def deepest_of(meshes: SurfacePairs, contacts: ContactRows, pair: int) -> float:
    """How deep contacts of a pair that push or rest have been inside at the start of the step [m]; 0 without.

    What rests has no depth but that of rounding, by which others beside it may be inside too.
    """
    deepest, rounding = 0.0, ABOUT_NOTHING * meshes.pair_values[pair].length_scale
    c = meshes.pairs[pair].first_member
    while c >= 0:
        if holds(contacts, c):
            deepest = max(deepest, rounding, -contacts.state[c].gap)
        c = meshes.next_member[c]
    return deepest


@kernel(internal=True)
def _known_side(meshes: SurfacePairs, contacts: ContactRows, pair: int, near: float) -> int:
    """Whether the nearest contact that touches along the line of the normal left in `touch` does so along it: 1 or -1.

    0 if none does.
    """
    touch, pose = meshes.touch, contacts.poses[meshes.pairs[pair].poses[0]]
    x1, x2, x3 = rotate(pose.rotation, touch.point_a)
    x1, x2, x3 = x1 + pose.origin[0], x2 + pose.origin[1], x3 + pose.origin[2]
    sense, nearest = 0, math.inf
    following = meshes.pairs[pair].first_member
    while following >= 0:
        k = following
        following = meshes.next_member[k]
        state = contacts.state[k]
        if not (holds(contacts, k) or abs(state.gap) <= near):
            continue
        cosine = aligned(meshes, contacts, pair, k)
        d1, d2, d3 = x1 - state.touched[0], x2 - state.touched[1], x3 - state.touched[2]
        square = d1 * d1 + d2 * d2 + d3 * d3
        if abs(cosine) > ALIGNED and square < nearest:
            sense, nearest = 1 if cosine > 0.0 else -1, square
    return sense


@kernel(internal=True)
def settle_sides(meshes: SurfacePairs, contacts: ContactRows, pair: int, count: int, first: bool) -> None:
    """Sides of what was found and is no contact yet; what was inside before, and has none to continue from, is unknown.

    Its side follows from existing contacts, and it may be as deep inside as these.
    """
    size = meshes.pair_values[pair].length_scale
    nothing = ABOUT_NOTHING * size + 2.0 * deepest_of(meshes, contacts, pair)
    deforms, inside = meshes.pairs[pair].deforms, nothing
    if deforms:  # where only the rounding is inside, the side is known
        inside = meshes.pairs[pair].radii
    for i in range(count):
        found = meshes.found.contacts[i]
        if look_up(meshes, contacts, pair, found.kind, found.first, found.second) >= 0:
            continue
        start = _touching_at_start(meshes, pair, i)
        sense = 0
        if abs(start) <= nothing and not deforms:
            sense = _known_side(meshes, contacts, pair, nothing)
        if found.hit == UNKNOWN:  # it has come through where something holds that has, too
            found.hit = 0 if sense > 0 else UNKNOWN
        elif sense < 0:
            meshes.found.contacts[i].side = -meshes.found.contacts[i].side
        elif start < -inside and not first:
            found.hit = UNKNOWN
