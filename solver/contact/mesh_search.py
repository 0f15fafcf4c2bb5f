"""Contacts between triangles at the end of a step: found anew, followed, handed over, chosen.

The search begins at the poses of the last end and goes to those of this one. What it finds is looked up among the
contacts that are there; what is new becomes one if its patch needs it. A contact that slides over the border of its
face goes on with the face that was found beyond it.
"""

from __future__ import annotations

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
    FEATURE,
    FEATURES,
    FIRST_BLOCK,
    GAP,
    HIT,
    NORMAL,
    OF_CONTOURS,
    OTHER_FEATURE,
    PAIR,
    PATCH,
    RATE,
    RIGID,
    SIDE,
    SIZE,
    SLEEP,
    START_GAP,
    STEP_SHIFT,
    ContactRows,
)
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
    RADII,
    SECOND_POSE,
    Meshes,
)
from heavylift.solver.contact.mesh_patches import choose_contacts, share_stiffness, sort_found
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

BORDER = 1e-9
"""Of the size: beyond the border by less a contact is still on its face."""

TOO_MANY_CONTACTS = int(Outcome.TOO_MANY_CONTACTS)


@implement(search_surfaces, Meshes)
@kernel(internal=True)
def search_mesh_surfaces(
    meshes: Meshes, contacts: ContactRows, bodies: Any, work: Workspace, step: float
) -> None:
    """All pairs, from the poses that are carried to those of the stage."""
    first_row = contacts.poses.shape[0] - surface_count(contacts, meshes)
    fill_table(meshes, contacts)
    for pair in range(meshes.pairs.shape[0]):
        a, b = meshes.pairs[pair, FIRST_POSE], meshes.pairs[pair, SECOND_POSE]
        relative_pose(contacts.placed[a - first_row], contacts.placed[b - first_row], meshes.motions[pair], 0)
        relative_pose(contacts.poses[a], contacts.poses[b], meshes.motions[pair], 12)
        for k in range(12):
            meshes.relative[pair, k] = meshes.motions[pair, 12 + k]
        moved = contacts.poses[a, STEP_SHIFT] + contacts.poses[b, STEP_SHIFT]
        _search_pair(meshes, contacts, pair, moved, step, work)
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
    search_mesh_surfaces(meshes, contacts, bodies, work, step)
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        state[GAP] = state[END_GAP]
        state[RATE] = contact_rates(contacts, c, work.velocity)[0]


@kernel(internal=True)
def _search_pair(
    meshes: Meshes, contacts: ContactRows, pair: int, moved: float, step: float, work: Workspace
) -> None:
    """Search, look up, hand over, add."""
    size = meshes.pair_values[pair, SIZE]
    early = meshes.pairs[pair, PAIR_LAW] != RIGID or meshes.pairs[pair, PAIR_EVENTS] == 0
    reach = NEAR_ENOUGH * size + (AHEAD * moved if early else 0.0)
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
    lost = _follow_contacts(meshes, contacts, pair, size, work)
    sort_found(meshes, count)
    patches = choose_contacts(meshes, contacts, pair, count)
    for i in range(count):
        found = meshes.found[i]
        kind, feature, other = found[FOUND_KIND], found[FOUND_FIRST], found[FOUND_SECOND]
        c = look_up(meshes, contacts, pair, kind, feature, other)
        if c >= 0:
            contacts.state[c, HIT] = float(found[FOUND_HIT])
            contacts.state[c, PATCH] = float(meshes.patch_of[i])
            continue
        if meshes.keeps[i] == 0 or (lost > 0 and _hand_over(meshes, contacts, pair, i)):
            continue
        if not _add(meshes, contacts, pair, i, step, work):
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
def _follow_contacts(meshes: Meshes, contacts: ContactRows, pair: int, size: float, work: Workspace) -> int:
    """Gaps and rows of the contacts of a pair; how many of the closed ones have left their face or edges."""
    lost = 0
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        if state[PAIR] == pair:
            touch_mesh_contact(meshes, contacts, c)
            state[HIT] = 0.0
            if state[CLOSED] > 0.0 and state[BESIDE] > BORDER * size:
                lost += 1
    return lost


@kernel(internal=True)
def _evaluate(meshes: Meshes, pair: int, i: int, pose: NDArray[np.float64], side: float) -> float:
    """Gap of what was found, at a pose; normal and points are left in `touch`."""
    found = meshes.found[i]
    return feature_gap(  # type: ignore[no-any-return]
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
    return n1 * state[NORMAL] + n2 * state[NORMAL + 1] + n3 * state[NORMAL + 2]  # type: ignore[no-any-return]


@kernel(internal=True)
def _hand_over(meshes: Meshes, contacts: ContactRows, pair: int, i: int) -> bool:
    """A closed contact that has left its face or edge goes on with what was found beside it, its memory kept."""
    found, size = meshes.found[i], meshes.pair_values[pair, SIZE]
    kind, feature, other = found[FOUND_KIND], found[FOUND_FIRST], found[FOUND_SECOND]
    side = meshes.found_values[i, FOUND_SIDE]
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        if state[PAIR] != pair or state[CLOSED] == 0.0 or not state[BESIDE] > BORDER * size:
            continue
        if state[FEATURES] != kind or not (state[FEATURE] == feature or state[OTHER_FEATURE] == other):
            continue
        _evaluate(meshes, pair, i, meshes.relative[pair], side)
        cosine = _aligned(meshes, contacts, pair, c)
        if abs(cosine) < ALIGNED:
            continue
        state[FEATURE], state[OTHER_FEATURE] = feature, other
        state[SIDE] = side if cosine > 0.0 else -side
        state[PATCH] = float(meshes.patch_of[i])
        touch_mesh_contact(meshes, contacts, c)
        enter(meshes, contacts, c)
        return True
    return False


@kernel(internal=True)
def _add(meshes: Meshes, contacts: ContactRows, pair: int, i: int, step: float, work: Workspace) -> bool:
    """A new contact; false if there is no place for it."""
    c = add_contact(meshes, contacts, pair)
    if c < 0:
        return False
    found, size, state = meshes.found[i], meshes.pair_values[pair, SIZE], contacts.state[c]
    side = meshes.found_values[i, FOUND_SIDE]
    start = _evaluate(meshes, pair, i, meshes.motions[pair], side)
    if abs(start) <= ABOUT_NOTHING * size:  # which side it comes from is told by what touches already
        for k in range(number_of(contacts, OF_CONTOURS), c):
            if contacts.state[k, PAIR] == pair and contacts.state[k, CLOSED] > 0.0:
                cosine = _aligned(meshes, contacts, pair, k)
                if cosine < -ALIGNED:
                    side, start = -side, -start - 2.0 * meshes.pair_values[pair, RADII]
                if abs(cosine) > ALIGNED:
                    break
    state[FEATURES], state[FEATURE], state[OTHER_FEATURE] = (
        found[FOUND_KIND],
        found[FOUND_FIRST],
        found[FOUND_SECOND],
    )
    state[SIDE], state[START_GAP], state[GAP] = side, start, start
    state[HIT], state[PATCH] = float(found[FOUND_HIT]), float(meshes.patch_of[i])
    touch_mesh_contact(meshes, contacts, c)
    # the rate at the start of the step, of a gap that is a parabola
    rate = contact_rates(contacts, c, work.velocity)[0]
    state[RATE] = 2.0 * (state[END_GAP] - start) / step - rate
    enter(meshes, contacts, c)
    return True


@kernel(internal=True)
def _finish_contacts(meshes: Meshes, contacts: ContactRows) -> None:
    """What lies beside its face or edges and has not come through them does not touch."""
    for c in range(number_of(contacts, OF_CONTOURS), contact_count(contacts)):
        state = contacts.state[c]
        size = meshes.pair_values[int(state[PAIR]), SIZE]
        if state[BESIDE] > BORDER * size and state[HIT] == 0.0:
            state[END_GAP] = max(state[END_GAP], size if state[CLOSED] > 0.0 else state[BESIDE])
        state[SLEEP] = state[END_GAP]
