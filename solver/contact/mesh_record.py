"""Pairs of surfaces in a record: sums over their contacts, and the contacts with the largest forces."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.channels import XYZ
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.kind import (
    COMPLIANT,
    ContactRows,
)
from heavylift.solver.contact.laws import stored_energy
from heavylift.solver.contact.mesh_interface import record_clearance, record_pairs
from heavylift.solver.contact.mesh_kind import (
    GONE_IMPACTS,
    GONE_IMPULSE,
    GONE_LOSS,
    PAIR_COLUMN,
    PAIR_REACH,
    RECORDED,
    SurfacePairs,
)
from heavylift.solver.contact.mesh_slots import surface_count
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement

__all__ = ["COLLISION_CHANNELS", "collision_channels"]

COLLISION_CHANNELS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("gap", "m", ("gap",)),
    ("contacts", "1", ("contacts",)),
    ("patches", "1", ("patches",)),
    ("force", "N", XYZ),
    ("normal_force", "N", ("normal_force",)),
    ("largest_force", "N", ("largest_force",)),
    ("impulse", "N s", ("impulse",)),
    ("point", "m", XYZ),
    ("slip", "m/s", ("slip",)),
    ("dissipated", "J", ("dissipated",)),
    ("impacts", "1", ("impacts",)),
)
"""Name, unit and components of the channels of a collision, in the order of its columns."""

ONE_CONTACT: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("point", "m", XYZ),
    ("normal", "1", XYZ),
    ("gap", "m", ("gap",)),
    ("force", "N", ("force",)),
    ("friction", "N", ("friction",)),
    ("impulse", "N s", ("impulse",)),
    ("patch", "1", ("patch",)),
)
"""The same of each recorded contact."""

GAP_AT, NUMBER_AT, PATCHES_AT, FORCE_AT, SUM_AT, LARGEST_AT, IMPULSE_AT = 0, 1, 2, 3, 6, 7, 8
CENTRE_AT, SLIP_AT, LOSS_AT, IMPACTS_AT, CONTACTS_AT = 9, 12, 13, 14, 15
POINT_OF, NORMAL_OF, GAP_OF, FORCE_OF, FRICTION_OF, IMPULSE_OF, PATCH_OF, ONE_WIDTH = 0, 3, 6, 7, 8, 9, 10, 11


def collision_channels(recorded: int) -> list[tuple[str, str, tuple[str, ...]]]:
    """Channels of a collision that records some of its contacts."""
    found = list(COLLISION_CHANNELS)
    for i in range(recorded):
        found += [(f"contact_{i + 1}.{name}", unit, parts) for name, unit, parts in ONE_CONTACT]
    return found


@implement(record_pairs, SurfacePairs)
@kernel(internal=True)
def record_mesh_pairs(
    meshes: SurfacePairs, contacts: ContactRows, work: Workspace, row: NDArray[np.float64]
) -> None:
    """Pair by pair."""
    for pair in range(meshes.pairs.shape[0]):
        at = meshes.pairs[pair, PAIR_COLUMN]
        _record_sums(meshes, contacts, pair, work, row, at)
        _record_largest(meshes, contacts, pair, row, at + CONTACTS_AT)


@kernel(internal=True)
def _record_sums(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, work: Workspace, row: NDArray[np.float64], at: int
) -> None:
    """What all contacts of a pair do together; its gap is the reach of the search while nothing is nearer."""
    gone = contacts.placed[surface_count(contacts, meshes) + pair]
    for k in range(CONTACTS_AT):
        row[at + k] = 0.0
    row[at + GAP_AT] = meshes.pair_values[pair, PAIR_REACH]
    row[at + IMPULSE_AT], row[at + LOSS_AT], row[at + IMPACTS_AT] = (
        gone[GONE_IMPULSE],
        gone[GONE_LOSS],
        gone[GONE_IMPACTS],
    )
    highest = -1.0
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        state = contacts.state[c]
        if state.pair != pair:
            continue
        row[at + GAP_AT] = min(row[at + GAP_AT], state.gap)
        row[at + IMPULSE_AT] += state.impulse
        row[at + LOSS_AT] += state.loss
        row[at + IMPACTS_AT] += state.impacts
        if contacts.table[c].law == COMPLIANT:
            values = contacts.values[c]
            work.sums.elastic += stored_energy(
                contacts.table[c].force_law, values.stiffness, values.exponent, -state.gap
            )
        force = state.normal_force
        if not (force > 0.0 or state.closed):
            continue
        row[at + NUMBER_AT] += 1.0
        highest = max(highest, state.patch)
        row[at + SUM_AT] += force
        row[at + SLIP_AT] = max(row[at + SLIP_AT], state.slip_speed)
        for k in range(3):
            row[at + FORCE_AT + k] += state.force[k]
            row[at + CENTRE_AT + k] += force * state.touched[k]
    work.sums.dissipated += row[at + LOSS_AT]
    record_clearance(meshes.clearances, meshes, contacts, pair, row, at + GAP_AT)
    if row[at + SUM_AT] > 0.0:
        for k in range(3):
            row[at + CENTRE_AT + k] /= row[at + SUM_AT]
    for patch in range(int(highest) + 1):
        total, members = 0.0, 0
        for c in range(contacts.counts.of_contours, contact_count(contacts)):
            state = contacts.state[c]
            touches = state.normal_force > 0.0 or state.closed
            if state.pair == pair and state.patch == patch and touches:
                total += state.normal_force
                members += 1
        row[at + LARGEST_AT] = max(row[at + LARGEST_AT], total)
        row[at + PATCHES_AT] += 1.0 if members > 0 else 0.0


@kernel(internal=True)
def _record_largest(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, row: NDArray[np.float64], at: int
) -> None:
    """Contacts in the order of their normal forces, those of equal ones in that of their places."""
    before, last = math.inf, -1
    for i in range(meshes.pairs[pair, RECORDED]):
        best, largest = -1, -1.0
        for c in range(contacts.counts.of_contours, contact_count(contacts)):
            state = contacts.state[c]
            force = state.normal_force
            touches = force > 0.0 or state.closed
            later = force < before or (force == before and c > last)
            if state.pair == pair and touches and later and force > largest:
                best, largest = c, force
        place = at + i * ONE_WIDTH
        for k in range(ONE_WIDTH):
            row[place + k] = 0.0
        row[place + PATCH_OF] = -1.0
        if best < 0:
            continue
        before, last = largest, best
        state = contacts.state[best]
        for k in range(3):
            row[place + POINT_OF + k] = state.touched[k]
            row[place + NORMAL_OF + k] = state.normal[k]
        row[place + GAP_OF], row[place + FORCE_OF] = state.gap, state.normal_force
        row[place + FRICTION_OF], row[place + IMPULSE_OF] = state.friction_force, state.step_impulse
        row[place + PATCH_OF] = state.patch
