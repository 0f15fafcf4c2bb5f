"""Contacts between triangles that continue with other features, and what jumps of their gaps do to the energy."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import add, add_scaled, cross, rotate, scaled
from heavylift.solver.contact.kind import COMPLIANT, ContactRows
from heavylift.solver.contact.laws.normal_force import stored_energy
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.sides import ABOUT_NOTHING, ALIGNED, aligned, evaluate, holds

__all__ = ["book_jump", "goes_on", "pass_on", "turn_memory"]

WAYS = 4.0
"""Ways of the step, and of the contact beyond its border, within which it continues."""

SAME_PLACE = 1e-7
"""Of the size: places that differ by less are the same."""


@kernel(internal=True)
def book_jump(contacts: ContactRows, c: int, gap: float) -> None:
    """What a compliant contact has stored less because its gap at the end of the step is no longer the given one [m].

    Notes
    -----
    The impulse of the middle of the step is the discrete gradient of the energy along the way of the old features, so
    only a contact that took part there has stored what belongs to their gap.
    """
    state, values = contacts.state[c], contacts.values[c]
    if contacts.table[c].law == COMPLIANT and state.present:
        law, k, n = contacts.table[c].force_law, values.stiffness, values.exponent
        state.jump += stored_energy(law, k, n, -gap) - stored_energy(law, k, n, -state.end_gap)


@kernel(internal=True)
def goes_on(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, i: int, moved: float
) -> tuple[int, float]:
    """Contact that has left its face or edge where something was found, and the side it has there; -1 without.

    Parameters
    ----------
    meshes, contacts, pair, i
        What was found, and for which pair.
    moved
        How far points of both surfaces have moved in the step at most [m].

    Notes
    -----
    It must have come to that very place: a neighbour beyond the border is about as far from where the old features
    would touch as the contact is beside them. Others that have a feature in common, as all edges that lie across the
    same one, touch somewhere else.
    """
    found, size = meshes.found.contacts[i], meshes.pair_values[pair].length_scale
    kind, feature, other = found.kind, found.first, found.second
    side = meshes.found.contacts[i].side
    taken, nearest, turned = -1, math.inf, 1.0
    following = meshes.pairs[pair].first_member
    while following >= 0:
        c = following
        following = meshes.next_member[c]
        state = contacts.state[c]
        if not holds(contacts, c) or not state.beside > meshes.pairs[pair].border:
            continue
        if state.feature_kind != kind or not (state.feature == feature or state.other_feature == other):
            continue
        evaluate(meshes, pair, i, meshes.relative[pair], side)
        cosine = aligned(meshes, contacts, pair, c)
        if abs(cosine) < ALIGNED:
            continue
        distance = _distance(meshes, contacts, pair, c, 1.0 if cosine > 0.0 else -1.0)
        if distance <= WAYS * (moved + state.beside) + SAME_PLACE * size and distance < nearest:
            taken, nearest, turned = c, distance, 1.0 if cosine > 0.0 else -1.0
    return taken, turned * side


@kernel(internal=True)
def _distance(meshes: SurfacePairs, contacts: ContactRows, pair: int, c: int, turned: float) -> float:
    """From where a contact touches to the place left in `touch` [m], whose normal may be turned round."""
    touch, state = meshes.touch, contacts.state[c]
    pose, radii = contacts.poses[meshes.pairs[pair].poses[0]], meshes.surfaces.radii
    shift = 0.5 * turned * (radii[meshes.pairs[pair].surfaces[0]] - radii[meshes.pairs[pair].surfaces[1]])
    x1, x2, x3 = rotate(
        pose.rotation,
        add_scaled(scaled(0.5, add(touch.point_a, touch.point_b)), shift, touch.normal),
    )
    d1 = x1 + pose.origin[0] - state.touched[0]
    d2 = x2 + pose.origin[1] - state.touched[1]
    d3 = x3 + pose.origin[2] - state.touched[2]
    return math.sqrt(d1 * d1 + d2 * d2 + d3 * d3)


@kernel(internal=True)
def pass_on(meshes: SurfacePairs, contacts: ContactRows, c: int) -> None:
    """A contact that goes leaves what it bears to those that are there beside it, of whatever features.

    Where a corner creeps past a flush edge, the edges of both cross at that place, as near as the corner was: what
    rests would fall by that gap, which is rounding.
    """
    state, one = contacts.state[c], meshes.pairs[contacts.state[c].pair]
    size = contacts.values[c].length_scale
    moved = contacts.poses[one.poses[0]].step_shift + contacts.poses[one.poses[1]].step_shift
    farthest, k = WAYS * (moved + state.beside) + SAME_PLACE * size, one.first_member
    while k >= 0:
        other, cosine, square = contacts.state[k], 0.0, 0.0
        for i in range(3):
            cosine += state.normal[i] * other.normal[i]
            square += (state.touched[i] - other.touched[i]) ** 2
        near = square <= farthest * farthest and abs(other.end_gap - state.end_gap) <= ABOUT_NOTHING * size
        if k != c and not other.beside > one.border and near and cosine > ALIGNED and other.hit >= 0:
            other.closed = other.joined = True
        k = meshes.next_member[k]


@kernel(internal=True)
def turn_memory(contacts: ContactRows, c: int, t1: float, t2: float, t3: float) -> None:
    """What a contact remembers along its tangents, in those of its new features; `t` is the first one before."""
    state = contacts.state[c]
    n1, n2, n3 = state.normal[0], state.normal[1], state.normal[2]
    # components of the tangent before: the second ones are turned by the same angle
    cosine = t1 * state.tangent[0] + t2 * state.tangent[1] + t3 * state.tangent[2]
    s1, s2, s3 = cross((n1, n2, n3), state.tangent)
    sine = t1 * s1 + t2 * s2 + t3 * s3
    size = math.hypot(cosine, sine)
    if not size > 0.0:
        return
    cosine, sine = cosine / size, sine / size
    a, b = state.slip[0], state.slip[1]
    state.slip[0], state.slip[1] = cosine * a - sine * b, sine * a + cosine * b
    a, b = state.middle_force[1], state.middle_force[2]
    state.middle_force[1], state.middle_force[2] = cosine * a - sine * b, sine * a + cosine * b
    half_impulse = contacts.rows[c].half_impulse
    a, b = half_impulse[1], half_impulse[2]
    half_impulse[1], half_impulse[2] = cosine * a - sine * b, sine * a + cosine * b
