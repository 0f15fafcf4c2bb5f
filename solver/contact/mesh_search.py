"""Contacts between triangles at the end of a step: found anew, followed, handed over, chosen.

The search begins at the poses of the last end and goes to those of this one. What it finds is looked up among the
contacts that are there; what is new becomes one if its patch needs it. A contact that slides over the border of its
face goes on with the face that was found beyond it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.feature_gap import feature_gap
from heavylift.contours.feature_pairs import find_contacts
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.small import rotate
from heavylift.solver.contact.counts import contact_count, number_of
from heavylift.solver.contact.delassus import contact_rates
from heavylift.solver.contact.kind import (
    BESIDE,
    CLOSED,
    COMPLIANT,
    END_GAP,
    EXPONENT,
    FEATURE,
    FEATURES,
    FIRST_BLOCK,
    FORCE_LAW,
    GAP,
    HIT,
    LAW,
    LEFT,
    LOSS,
    NORMAL,
    OF_CONTOURS,
    ORIGIN,
    OTHER_FEATURE,
    PAIR,
    PATCH,
    RATE,
    RIGID,
    SHIFT,
    SIDE,
    SIZE,
    SLEEP,
    START_GAP,
    STEP_SHIFT,
    STIFFNESS,
    TOUCHED,
    ContactRows,
)
from heavylift.solver.contact.laws import stored_energy
from heavylift.solver.contact.mesh_interface import find_first_contacts, search_surfaces
from heavylift.solver.contact.mesh_kind import (
    FIRST_POSE,
    FOUND_FIRST,
    FOUND_HIT,
    FOUND_KIND,
    FOUND_SECOND,
    FOUND_SIDE,
    METHOD,
    NORMAL_AT,
    PAIR_EVENTS,
    PAIR_LAW,
    PAIR_REACH,
    POINT_AT,
    RADII,
    SECOND_POSE,
    Meshes,
)
from heavylift.solver.contact.mesh_patches import BORDER, choose_contacts, share_stiffness, sort_found
from heavylift.solver.contact.mesh_slots import add_contact, surface_count
from heavylift.solver.contact.mesh_table import enter, fill_table, look_up
from heavylift.solver.contact.mesh_touch import relative_pose, touch_mesh_contact
from heavylift.solver.interface import STATUS_BLOCK, STATUS_OUTCOME, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []

AHEAD = 4.0
"""Motions of a step within which the next one needs a contact."""

NEAR_ENOUGH = 1e-7
"""Of the size of the smaller surface: what is nearer counts as near, however slow it is."""

ALIGNED = 0.9
"""Cosine between normals of contacts that lie on the same side of the same thing."""

ABOUT_NOTHING = 1e-6
"""Of the size: a gap that does not tell the side."""

FAR_AWAY = 1e3
"""Sizes and reaches from which a contact goes."""

AT_START = 1e-4
"""Of the size: what is less deep inside at the start is pushed out."""

TOO_MANY_CONTACTS = int(Outcome.TOO_MANY_CONTACTS)


@implement(search_surfaces, Meshes)
@kernel(internal=True)
def search_mesh_surfaces(
    meshes: Meshes, contacts: ContactRows, bodies: Any, work: Workspace, step: float
) -> None:
    """All pairs, from the poses that are carried to those of the stage."""
    _search_all(meshes, contacts, work, step, False)


@kernel(internal=True)
def _search_all(meshes: Meshes, contacts: ContactRows, work: Workspace, step: float, first: bool) -> None:
    """The same; at the start what is a little inside is found too."""
    first_row = contacts.poses.shape[0] - surface_count(contacts, meshes)
    fill_table(meshes, contacts)
    for pair in range(meshes.pairs.shape[0]):
        a, b = meshes.pairs[pair, FIRST_POSE], meshes.pairs[pair, SECOND_POSE]
        relative_pose(contacts.placed[a - first_row], contacts.placed[b - first_row], meshes.motions[pair], 0)
        relative_pose(contacts.poses[a], contacts.poses[b], meshes.motions[pair], 12)
        for k in range(12):
            meshes.relative[pair, k] = meshes.motions[pair, 12 + k]
        moved = contacts.poses[a, STEP_SHIFT] + contacts.poses[b, STEP_SHIFT]
        _search_pair(meshes, contacts, pair, moved, step, first, work)
    _finish_contacts(meshes, contacts)


@implement(find_first_contacts, Meshes)
@kernel(internal=True)
def find_first_mesh_contacts(
    meshes: Meshes, contacts: ContactRows, bodies: Any, work: Workspace, step: float
) -> None:
    """What is near at the start; what touches and does not move is closed."""
    first_row = contacts.poses.shape[0] - surface_count(contacts, meshes)
    for i in range(surface_count(contacts, meshes)):
        for k in range(12):
            contacts.placed[i, k] = contacts.poses[first_row + i, k]
        contacts.poses[first_row + i, STEP_SHIFT] = 0.0
    _search_all(meshes, contacts, work, step, True)
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        state[GAP] = state[END_GAP]
        state[RATE] = contact_rates(contacts, c, work.velocity)[0]


@kernel(internal=True)
def _search_pair(
    meshes: Meshes,
    contacts: ContactRows,
    pair: int,
    moved: float,
    step: float,
    first: bool,
    work: Workspace,
) -> None:
    """Search, look up, hand over, add."""
    size = meshes.pair_values[pair, SIZE]
    early = meshes.pairs[pair, PAIR_LAW] != RIGID or meshes.pairs[pair, PAIR_EVENTS] == 0
    reach = (AT_START if first else NEAR_ENOUGH) * size + (AHEAD * moved if early else 0.0)
    meshes.pair_values[pair, PAIR_REACH] = reach
    count = find_contacts(
        meshes.surfaces,
        meshes.lists,
        pair,
        meshes.motions[pair],
        reach,
        meshes.pairs[pair, METHOD],
        meshes.found,
        meshes.found_values,
    )
    if count < 0:
        _stop(contacts, pair, work)
        return
    lost = _follow_contacts(meshes, contacts, pair, size)
    sort_found(meshes, count)
    unsplit = meshes.pairs[pair, PAIR_LAW] == RIGID and meshes.pairs[pair, PAIR_EVENTS] == 0
    patches = choose_contacts(meshes, contacts, pair, count, 0.5 * reach if unsplit else -math.inf)
    for i in range(count):
        found = meshes.found[i]
        kind, feature, other = found[FOUND_KIND], found[FOUND_FIRST], found[FOUND_SECOND]
        c = look_up(meshes, contacts, pair, kind, feature, other)
        if c >= 0:
            contacts.state[c, HIT] = float(found[FOUND_HIT])
            continue
        if meshes.keeps[i] < 0 or (lost > 0 and _hand_over(meshes, contacts, pair, i)):
            continue
        if not _add(meshes, contacts, pair, i, moved, step, first, work):
            _stop(contacts, pair, work)
            return
    if meshes.pairs[pair, PAIR_LAW] == COMPLIANT:
        share_stiffness(meshes, contacts, pair, patches, reach)


@kernel(internal=True)
def _stop(contacts: ContactRows, pair: int, work: Workspace) -> None:
    """More contacts than there are places for."""
    work.status[STATUS_OUTCOME] = TOO_MANY_CONTACTS
    work.status[STATUS_BLOCK] = number_of(contacts, FIRST_BLOCK) + number_of(contacts, OF_CONTOURS) + pair


@kernel(internal=True)
def _follow_contacts(meshes: Meshes, contacts: ContactRows, pair: int, size: float) -> int:
    """Gaps and rows of the contacts of a pair; how many of the closed ones have left their face or edges."""
    lost = 0
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        if state[PAIR] == pair:
            touch_mesh_contact(meshes, contacts, c)
            state[HIT] = 0.0
            if holds(contacts, c) and state[BESIDE] > BORDER * size:
                lost += 1
    return lost


@kernel(internal=True)
def _evaluate(meshes: Meshes, pair: int, i: int, pose: NDArray[np.float64], side: float) -> float:
    """Gap of what was found, at a pose; normal and points are left in `touch`."""
    found = meshes.found[i]
    return feature_gap(
        meshes.surfaces,
        found[FOUND_KIND],
        found[FOUND_FIRST],
        found[FOUND_SECOND],
        meshes.pair_values[pair, RADII],
        side,
        pose,
        0,
        meshes.touch,
    )


@kernel(internal=True)
def _aligned(meshes: Meshes, contacts: ContactRows, pair: int, c: int) -> float:
    """Cosine between the normal left in `touch` and that of a contact."""
    touch, state = meshes.touch, contacts.state[c]
    pose = contacts.poses[meshes.pairs[pair, FIRST_POSE]]
    n1, n2, n3 = rotate(pose, touch[NORMAL_AT], touch[NORMAL_AT + 1], touch[NORMAL_AT + 2])
    return n1 * state[NORMAL] + n2 * state[NORMAL + 1] + n3 * state[NORMAL + 2]


@kernel(internal=True)
def _deepest(meshes: Meshes, contacts: ContactRows, pair: int) -> float:
    """How deep contacts of a pair that push or rest have been inside at the start of the step [m]."""
    deepest = 0.0
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        if contacts.state[c, PAIR] == pair and holds(contacts, c):
            deepest = max(deepest, -contacts.state[c, GAP])
    return deepest


@kernel(internal=True)
def _is_turned(meshes: Meshes, contacts: ContactRows, pair: int, count: int, near: float) -> bool:
    """Whether the normal left in `touch` is against that of the nearest contact that touches along the same line."""
    touch, pose = meshes.touch, contacts.poses[meshes.pairs[pair, FIRST_POSE]]
    x1, x2, x3 = rotate(pose, touch[POINT_AT], touch[POINT_AT + 1], touch[POINT_AT + 2])
    x1, x2, x3 = x1 + pose[ORIGIN], x2 + pose[ORIGIN + 1], x3 + pose[ORIGIN + 2]
    turned, nearest = False, math.inf
    for k in range(number_of(contacts, OF_CONTOURS), count):
        state = contacts.state[k]
        if state[PAIR] != pair or not (holds(contacts, k) or abs(state[GAP]) <= near):
            continue
        cosine = _aligned(meshes, contacts, pair, k)
        d1, d2, d3 = x1 - state[TOUCHED], x2 - state[TOUCHED + 1], x3 - state[TOUCHED + 2]
        square = d1 * d1 + d2 * d2 + d3 * d3
        if abs(cosine) > ALIGNED and square < nearest:
            turned, nearest = cosine < 0.0, square
    return turned


@kernel(internal=True)
def _hand_over(meshes: Meshes, contacts: ContactRows, pair: int, i: int) -> bool:
    """A closed contact that has left its face or edge goes on with what was found beside it, its memory kept."""
    found, size = meshes.found[i], meshes.pair_values[pair, SIZE]
    kind, feature, other = found[FOUND_KIND], found[FOUND_FIRST], found[FOUND_SECOND]
    side = meshes.found_values[i, FOUND_SIDE]
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        if state[PAIR] != pair or not holds(contacts, c) or not state[BESIDE] > BORDER * size:
            continue
        if state[FEATURES] != kind or not (state[FEATURE] == feature or state[OTHER_FEATURE] == other):
            continue
        _evaluate(meshes, pair, i, meshes.relative[pair], side)
        cosine = _aligned(meshes, contacts, pair, c)
        if abs(cosine) < ALIGNED:
            continue
        state[FEATURE], state[OTHER_FEATURE] = feature, other
        state[SIDE] = side if cosine > 0.0 else -side
        state[PATCH] = float(meshes.keeps[i])
        touch_mesh_contact(meshes, contacts, c)
        enter(meshes, contacts, c)
        return True
    return False


@kernel(internal=True)
def _add(
    meshes: Meshes,
    contacts: ContactRows,
    pair: int,
    i: int,
    moved: float,
    step: float,
    first: bool,
    work: Workspace,
) -> bool:
    """A new contact; false if there is no place for it.

    What was inside at the start of the step already, and has no contact to go on from, is none: its side is unknown.
    """
    found, size = meshes.found[i], meshes.pair_values[pair, SIZE]
    side = meshes.found_values[i, FOUND_SIDE]
    start = _evaluate(meshes, pair, i, meshes.motions[pair], side)
    # which side it comes from is told by what touches already, and may be as deep inside
    nothing = ABOUT_NOTHING * size + 2.0 * _deepest(meshes, contacts, pair)
    if abs(start) <= nothing and _is_turned(meshes, contacts, pair, contact_count(contacts), nothing):
        side, start = -side, -start - 2.0 * meshes.pair_values[pair, RADII]
    if start < -nothing and not first:
        return True
    c = add_contact(meshes, contacts, pair)
    if c < 0:
        return False
    state = contacts.state[c]
    state[FEATURES], state[FEATURE], state[OTHER_FEATURE] = (
        found[FOUND_KIND],
        found[FOUND_FIRST],
        found[FOUND_SECOND],
    )
    state[SIDE], state[START_GAP], state[GAP] = side, start, start
    state[SHIFT] = moved  # or it would take part one step late
    state[HIT], state[PATCH] = float(found[FOUND_HIT]), float(meshes.keeps[i])
    touch_mesh_contact(meshes, contacts, c)
    # the rate at the start of the step, of a gap that is a parabola
    rate = contact_rates(contacts, c, work.velocity)[0]
    state[RATE] = 2.0 * (state[END_GAP] - start) / step - rate
    enter(meshes, contacts, c)
    return True


@kernel(inline=True, internal=True)
def holds(contacts: ContactRows, c: int) -> bool:
    """Whether a contact has pushed in the last step, or rested: it knows its side."""
    state = contacts.state[c]
    return bool(state[CLOSED] > 0.0 or (contacts.table[c, LAW] == COMPLIANT and state[GAP] < 0.0))


@kernel(internal=True)
def _finish_contacts(meshes: Meshes, contacts: ContactRows) -> None:
    """What lies beside its face or edges and has not come through them does not touch."""
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        size = meshes.pair_values[int(state[PAIR]), SIZE]
        nothing = ABOUT_NOTHING * size
        beside = state[BESIDE] > BORDER * size
        # from one side to the other in a step without a hit: round the border
        gone_round = state[GAP] > nothing and state[END_GAP] < -nothing and not holds(contacts, c)
        if (beside or gone_round) and state[HIT] == 0.0:
            if not holds(contacts, c):  # goes; if it comes back, it is found with the side it comes from
                state[END_GAP] = FAR_AWAY * (size + meshes.pair_values[int(state[PAIR]), PAIR_REACH])
            elif state[LEFT] > 0.0:  # nothing beyond the border took it over for a whole step
                if contacts.table[c, LAW] == COMPLIANT:  # and what it has stored is lost
                    values = contacts.values[c]
                    state[LOSS] += stored_energy(
                        contacts.table[c, FORCE_LAW], values[STIFFNESS], values[EXPONENT], -state[END_GAP]
                    )
                state[END_GAP] = max(state[END_GAP], size)
        state[LEFT] = 1.0 if beside else 0.0
        state[SLEEP] = state[END_GAP]
