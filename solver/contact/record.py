"""Contacts in a record: channels, energies, forces on bodies that are held."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.channels import XYZ
from heavylift.solver.contact.counts import number_of
from heavylift.solver.contact.interface import pose_contours
from heavylift.solver.contact.kind import (
    AT_U,
    AT_V,
    CLOSED,
    COLUMN,
    COMPLIANT,
    END_GAP,
    END_GAP_2,
    EXPONENT,
    FORCE,
    FORCE_LAW,
    FRICTION_FORCE,
    GAP,
    IMPACTS,
    IMPULSES,
    LAW,
    LOSS,
    NORMAL_FORCE,
    OF_CONTOURS,
    PRESENT,
    SLEEP,
    SLIP_PATH,
    SLIP_SPEED,
    STIFFNESS,
    TOUCHED,
    ContactRows,
)
from heavylift.solver.contact.laws import stored_energy
from heavylift.solver.contact.locate import locate
from heavylift.solver.contact.mesh_interface import record_pairs, restore_contacts
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Workspace,
    gather_reactions,
    gather_rows,
    record_rows,
)
from heavylift.solver.kinds import implement

__all__ = ["CONTACT_CHANNELS"]

CONTACT_CHANNELS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("gap", "m", ("gap",)),
    ("normal_force", "N", ("normal_force",)),
    ("friction_force", "N", ("friction_force",)),
    ("force", "N", XYZ),
    ("impulse", "N s", ("impulse",)),
    ("slip", "m/s", ("slip",)),
    ("slip_path", "m", ("slip_path",)),
    ("coordinate", "1", ("u", "v")),
    ("point", "m", XYZ),
    ("dissipated", "J", ("dissipated",)),
    ("impacts", "1", ("impacts",)),
)
"""Name, unit and components of the channels of a contact, in the order of its columns."""


@implement(gather_rows, ContactRows)
@kernel(internal=True)
def gather_contact_rows(
    contacts: ContactRows, bodies: Bodies, joints: Joints, work: Workspace, time: float
) -> None:
    """The rows are still those of the end of the step; of what is far from touching only the gap is wanted."""
    restore_contacts(contacts.meshes, contacts)  # a state may have been restored since the last step
    gather_reactions(bodies, False, contacts)
    posed = False
    for c in range(number_of(contacts, OF_CONTOURS)):
        state = contacts.state[c]
        if state[SLEEP] > 0.0 and state[CLOSED] == 0.0 and state[PRESENT] == 0.0:
            if not posed:
                pose_contours(bodies, False, contacts)
                posed = True
            u, v, end_gap, angle = state[AT_U], state[AT_V], state[END_GAP], state[END_GAP_2]
            locate(contacts, bodies, c, True, work)
            state[GAP] = abs(state[END_GAP])  # what sleeps and seems inside is behind
            # a record must not change what follows
            state[AT_U], state[AT_V], state[END_GAP], state[END_GAP_2] = u, v, end_gap, angle


@implement(record_rows, ContactRows)
@kernel(internal=True)
def record_contacts(
    contacts: ContactRows, joints: Joints, work: Workspace, time: float, row: NDArray[np.float64]
) -> None:
    """What the last step has left."""
    record_pairs(contacts.meshes, contacts, work, row)
    for c in range(number_of(contacts, OF_CONTOURS)):
        state, at = contacts.state[c], contacts.table[c, COLUMN]
        row[at], row[at + 1], row[at + 2] = state[GAP], state[NORMAL_FORCE], state[FRICTION_FORCE]
        for k in range(3):
            row[at + 3 + k] = state[FORCE + k]
        row[at + 6], row[at + 7], row[at + 8] = state[IMPULSES], state[SLIP_SPEED], state[SLIP_PATH]
        row[at + 9], row[at + 10] = state[AT_U], state[AT_U + 1]
        for k in range(3):
            row[at + 11 + k] = state[TOUCHED + k]
        row[at + 14], row[at + 15] = state[LOSS], state[IMPACTS]
        work.sums.dissipated += state[LOSS]
        if contacts.table[c, LAW] == COMPLIANT:
            values = contacts.values[c]
            work.sums.elastic += stored_energy(
                contacts.table[c, FORCE_LAW], values[STIFFNESS], values[EXPONENT], -state[GAP]
            )
