"""What a contact between triangles may not do, judged by what no search has read; faults are kept for each pair.

A contact pushes, it does not pull. A face or edge of a closed surface pushes outwards what began outside. Both ends of
an edge are not pushed from two sides of one plane: else the edge has gone through it, and one contact has a wrong side.
"""

from __future__ import annotations

from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    EDGE_VERTEX,
    FACE_VERTEX,
    VERTEX_EDGE,
    VERTEX_FACE,
    fixed_point,
)
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import dot, rotate
from heavylift.solver.contact.kind import COMPLIANT, ContactRows
from heavylift.solver.contact.solve.asleep import rests
from heavylift.solver.contact.triangles.kind import Fault, SurfacePairs, gone_contacts
from heavylift.solver.contact.triangles.slots import surface_count

__all__ = ["judge_contact"]

ROUNDING = 1e-6
"""Of the largest force so far: what is less is nothing, as impulses are found no better where that is hard."""

TURNED = -0.5
"""Cosine between a normal and the way out; of what has slid deep beside an edge it may be a little below zero."""


@kernel(internal=True)
def judge_contact(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """Judge force and mean force of a contact at the end of a step that stands."""
    state = contacts.state[c]
    if rests(contacts, c):  # it has been judged while it was awake
        return
    force, pair = state.normal_force, meshes.pairs[state.pair]
    mean = state.step_impulse / contacts.control.nominal_step
    if force == 0.0 and mean == 0.0:
        return
    gone = gone_contacts(contacts.placed[surface_count(contacts, meshes) + state.pair], 0)
    gone.strongest = max(gone.strongest, abs(force), abs(mean))
    least = min(force, mean)
    if least < -ROUNDING * gone.strongest:
        _note(contacts, c, gone.pulls, -least)
        return
    if force <= ROUNDING * gone.strongest or pair.deforms:
        return
    if _way_out(meshes, contacts, c) < TURNED:
        _note(contacts, c, gone.turned, force)
    elif state.feature_kind in (VERTEX_FACE, FACE_VERTEX):
        for k in range(contacts.counts.of_contours, c):
            if _opposed(meshes, contacts, k, c):
                _note(contacts, c, gone.opposed, min(force, contacts.state[k].normal_force))


@kernel(internal=True)
def _note(contacts: ContactRows, c: int, fault: Fault, force: float) -> None:
    """One more; over a part of a cut step an impulse is no force."""
    if fault.count == 0:
        fault.first = contacts.control.time
    fault.count += 1
    if contacts.control.uncut or contacts.table[c].law == COMPLIANT:
        fault.force = max(fault.force, force)


@kernel(internal=True)
def _way_out(meshes: SurfacePairs, contacts: ContactRows, c: int) -> float:
    """Smaller cosine between the normal and the way out of both surfaces, 1 where nobody knows it."""
    state = contacts.state[c]
    pair, kind, least = meshes.pairs[state.pair], state.feature_kind, 1.0
    n = (state.normal[0], state.normal[1], state.normal[2])
    if pair.outside[0] != 0.0 and kind in (VERTEX_FACE, EDGE_EDGE, VERTEX_EDGE):
        out = rotate(
            contacts.poses[pair.poses[0]].rotation, _outward(meshes, kind == VERTEX_FACE, state.feature)
        )
        square = dot(out, out)
        if square > 0.0:
            least = min(least, pair.outside[0] * dot(out, n))
    if pair.outside[1] != 0.0 and kind in (FACE_VERTEX, EDGE_EDGE, EDGE_VERTEX):
        out = rotate(
            contacts.poses[pair.poses[1]].rotation, _outward(meshes, kind == FACE_VERTEX, state.other_feature)
        )
        square = dot(out, out)
        if square > 0.0:
            least = min(least, -pair.outside[1] * dot(out, n))
    return least


@kernel(internal=True)
def _outward(meshes: SurfacePairs, is_face: bool, feature: int) -> tuple[float, float, float]:
    """Way out at a face or edge, in the axes of its surface; zeros where there is none."""
    if is_face:
        n, sign = fixed_point(meshes.surfaces.normals, feature), meshes.outward[feature]
        return sign * n[0], sign * n[1], sign * n[2]
    return fixed_point(meshes.edge_outward, feature)


@kernel(internal=True)
def _opposed(meshes: SurfacePairs, contacts: ContactRows, k: int, c: int) -> bool:
    """Whether two contacts push the ends of one edge from two sides of one face, or of faces in one plane."""
    first, second = contacts.state[k], contacts.state[c]
    kind = second.feature_kind
    if first.pair != second.pair or first.feature_kind != kind or not first.normal_force > 0.0:
        return False
    n = (second.normal[0], second.normal[1], second.normal[2])
    if not first.normal[0] * n[0] + first.normal[1] * n[1] + first.normal[2] * n[2] < TURNED:
        return False
    on_first = kind == VERTEX_FACE
    if (first.feature if on_first else first.other_feature) != (
        second.feature if on_first else second.other_feature
    ):
        apart = 0.0
        for i in range(3):
            apart += (second.touched[i] - first.touched[i]) * n[i]
        if abs(apart) > abs(first.gap) + abs(second.gap):
            return False
    a = first.other_feature if on_first else first.feature
    b = second.other_feature if on_first else second.feature
    surfaces = meshes.surfaces
    for i in range(surfaces.vertex_first[a], surfaces.vertex_first[a + 1]):
        if surfaces.vertex_neighbours[i] == b:
            return True
    return False
