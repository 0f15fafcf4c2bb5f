"""Contacts in a record: their columns, energies, forces on bodies that are held."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.interface import pose_contours
from heavylift.solver.contact.kind import (
    COMPLIANT,
    ContactRows,
)
from heavylift.solver.contact.laws.normal_force import stored_energy
from heavylift.solver.contact.search.contact_kinematics import locate
from heavylift.solver.contact.triangles.interface import record_pairs
from heavylift.solver.extremes import largest_of, smallest_of
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Workspace,
    record_rows,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.impulses import add_reactions
from heavylift.solver.scene.contacts import ContactOutputs

contact_outputs = outputs_at(ContactOutputs)


@kernel(internal=True)
def _gather(contacts: ContactRows, bodies: Bodies, work: Workspace) -> None:
    """The rows are still those of the end of the step; of what is far from touching only the gap is wanted."""
    add_reactions(contacts, work.row_force)
    posed = False
    for c in range(contacts.counts.of_contours):
        state = contacts.state[c]
        if state.sleep > 0.0 and not state.closed and not state.present:
            if not posed:
                pose_contours(bodies, False, contacts)
                posed = True
            u, v, end_gap, angle = state.u, state.v, state.end_gap, state.second_end_gap
            locate(contacts, bodies, c, True, work)
            state.gap = abs(state.end_gap)  # what sleeps and seems inside is behind
            # a record must not change what follows
            state.u, state.v, state.end_gap, state.second_end_gap = u, v, end_gap, angle


@implement(record_rows, ContactRows)
@kernel(internal=True)
def record_contacts(
    contacts: ContactRows,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    row: NDArray[np.float64],
) -> None:
    """What the last step has left."""
    _gather(contacts, bodies, work)
    record_pairs(contacts.meshes, contacts, work, row)
    for c in range(contacts.counts.of_contours):
        state, out = contacts.state[c], contact_outputs(row, contacts.table[c].column)
        out.gap, out.normal_force, out.friction_force = state.gap, state.normal_force, state.friction_force
        for k in range(3):
            out.force[k], out.point[k] = state.force[k], state.touched[k]
        out.impulse, out.slip, out.slip_path = state.impulse, state.slip_speed, state.slip_path
        out.coordinate[0], out.coordinate[1] = state.u, state.v
        out.dissipated, out.impacts = state.loss, state.impacts
        out.normal_force_max = largest_of(state.forces, work.control.interval, state.normal_force)
        out.normal_force_min = smallest_of(state.forces, work.control.interval, state.normal_force)
        out.gap_min = smallest_of(state.gaps, work.control.interval, state.gap)
        work.sums.dissipated += state.loss
        if contacts.table[c].law == COMPLIANT:
            values = contacts.values[c]
            work.sums.elastic += stored_energy(
                contacts.table[c].force_law, values.stiffness, values.exponent, -state.gap
            )
