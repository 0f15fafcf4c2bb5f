"""Pairs of surfaces in a record: sums over their contacts, and the contacts with the largest forces."""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.counts import carried_on, contact_count
from heavylift.solver.contact.kind import COMPLIANT, RIGID, ContactRows
from heavylift.solver.contact.laws.normal_force import stored_energy
from heavylift.solver.contact.solve.impacts import keep_in_cone, write_force
from heavylift.solver.contact.triangles.interface import (
    record_clearance,
    record_pairs,
    watch_clearance,
    watch_pairs,
)
from heavylift.solver.contact.triangles.kind import SurfacePairs, gone_contacts
from heavylift.solver.contact.triangles.slots import count_members, surface_count
from heavylift.solver.contact.triangles.watch import judge_contact
from heavylift.solver.extremes import largest_of, note_value, smallest_of
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.collisions import CollisionOutputs, RecordedContactOutputs

collision_outputs, recorded_outputs = outputs_at(CollisionOutputs), outputs_at(RecordedContactOutputs)


@implement(watch_pairs, SurfacePairs)
@kernel(internal=True)
def watch_mesh_pairs(meshes: SurfacePairs, contacts: ContactRows, work: Workspace) -> None:
    """Sums as in a record, jumps, faults; a gap is known where there are contacts, or where somebody asks for it."""
    interval = work.control.interval
    for pair in range(meshes.pairs.shape[0]):
        one = meshes.pairs[pair]
        one.force, one.borne, one.gap, one.changed = 0.0, 0.0, one.reach, False
        for k in range(3):
            one.middle[k] = 0.0
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        state = contacts.state[c]
        one = meshes.pairs[state.pair]
        gone_contacts(contacts.placed[surface_count(contacts, meshes) + state.pair], 0).jumps += state.jump
        state.jump = 0.0
        one.gap = min(one.gap, state.gap)
        if state.normal_force > 0.0 or state.closed:
            one.force += state.normal_force
        if one.law == RIGID:
            one.borne += state.middle_force[0]
            one.changed |= state.changed
            for k in range(3):
                one.middle[k] += _in_world(contacts, c, k)
    for pair in range(meshes.pairs.shape[0]):
        one, before = meshes.pairs[pair], 0.0
        for k in range(3):
            before += abs(gone_contacts(contacts.placed[surface_count(contacts, meshes) + pair], 0).middle[k])
        one.changed = one.changed and before > 0.0 and one.borne > 0.0
    _carry_on(meshes, contacts, work)
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        judge_contact(meshes, contacts, c)
    for pair in range(meshes.pairs.shape[0]):
        one = meshes.pairs[pair]
        gone = gone_contacts(contacts.placed[surface_count(contacts, meshes) + pair], 0)
        for k in range(3):
            gone.middle[k] = one.middle[k]
        if contacts.control.uncut or one.law == COMPLIANT:
            note_value(gone.forces, interval, one.force)
        if one.gap < one.reach:
            note_value(gone.gaps, interval, one.gap)
        watch_clearance(meshes.clearances, meshes, contacts, pair, interval)


@kernel(inline=True, internal=True)
def _in_world(contacts: ContactRows, c: int, k: int) -> float:
    """Component of the force of a contact in the middle of the step [N]; its third direction is n x t."""
    state = contacts.state[c]
    i, j = (k + 1) % 3, (k + 2) % 3
    across = state.normal[i] * state.tangent[j] - state.normal[j] * state.tangent[i]
    f = state.middle_force
    return f[0] * state.normal[k] + f[1] * state.tangent[k] + f[2] * across


@kernel(internal=True)
def _carry_on(meshes: SurfacePairs, contacts: ContactRows, work: Workspace) -> None:
    """Forces at the end of the step of pairs whose contacts have changed, so that their sum is carried on.

    One contact takes over what another one has borne. Carried on by itself, what one loses would be missing, or what
    another gains would count half as much again: so each gets its share of the change of the sum.
    """
    if not contacts.control.uncut:
        return
    ahead = carried_on(contacts.control.nominal_step, work)
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        state = contacts.state[c]
        one = meshes.pairs[state.pair]
        if not one.changed or state.middle_force[0] == 0.0:
            continue
        before = gone_contacts(contacts.placed[surface_count(contacts, meshes) + state.pair], 0).middle
        share, reaction = ahead * state.middle_force[0] / one.borne, contacts.rows[c].reaction
        one.force -= state.normal_force
        for r in range(3):
            reaction[r] = state.middle_force[r]
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            change = share * (one.middle[k] - before[k])
            reaction[0] += change * state.normal[k]
            reaction[1] += change * state.tangent[k]
            reaction[2] += change * (state.normal[i] * state.tangent[j] - state.normal[j] * state.tangent[i])
        keep_in_cone(contacts, c, reaction, RIGID)
        write_force(contacts, c, reaction, RIGID)
        one.force += state.normal_force


@implement(record_pairs, SurfacePairs)
@kernel(internal=True)
def record_mesh_pairs(meshes: SurfacePairs, contacts: ContactRows, work: Workspace, row: Floats1) -> None:
    """Pair by pair."""
    count_members(meshes, contacts)
    for pair in range(meshes.pairs.shape[0]):
        _record_sums(meshes, contacts, pair, work, collision_outputs(row, meshes.pairs[pair].column))
        _record_largest(meshes, contacts, pair, row)


@kernel(inline=True, internal=True)
def _clear(words: Floats1) -> None:
    for i in range(words.shape[0]):
        words[i] = 0.0


@kernel(internal=True)
def _record_sums(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, work: Workspace, sums: CollisionOutputs
) -> None:
    """What all contacts of a pair do together; its gap is no number while nothing is within reach and nobody asks."""
    gone = gone_contacts(contacts.placed[surface_count(contacts, meshes) + pair], 0)
    _clear(sums.words)
    sums.gap = meshes.pairs[pair].reach
    sums.impulse, sums.dissipated, sums.impacts = gone.impulse, gone.loss + max(gone.jumps, 0.0), gone.impacts
    sums.impact_impulse = gone.impact_impulse
    highest = -1.0
    following = meshes.pairs[pair].first_member
    while following >= 0:
        c = following
        following = meshes.next_member[c]
        state = contacts.state[c]
        sums.gap = min(sums.gap, state.gap)
        sums.impulse += state.impulse
        sums.impact_impulse += state.impact_impulse
        sums.dissipated += state.loss
        sums.impacts += state.impacts
        if contacts.table[c].law == COMPLIANT:
            values = contacts.values[c]
            work.sums.elastic += stored_energy(
                contacts.table[c].force_law, values.stiffness, values.exponent, -state.gap
            )
            work.sums.elastic += state.kept
        force = state.normal_force
        if not (force > 0.0 or state.closed):
            continue
        sums.contacts += 1.0
        highest = max(highest, state.patch)
        sums.normal_force += force
        sums.slip = max(sums.slip, state.slip_speed)
        for k in range(3):
            sums.force[k] += state.force[k]
            sums.point[k] += force * state.touched[k]
    work.sums.dissipated += sums.dissipated
    if sums.gap >= meshes.pairs[pair].reach:
        sums.gap = math.nan
    record_clearance(meshes.clearances, meshes, contacts, pair, sums)
    interval = work.control.interval
    sums.normal_force_max = largest_of(gone.forces, interval, sums.normal_force)
    sums.normal_force_min = smallest_of(gone.forces, interval, sums.normal_force)
    least = smallest_of(gone.gaps, interval, math.inf if math.isnan(sums.gap) else sums.gap)
    sums.gap_min = least if least < math.inf else math.nan
    if sums.normal_force > 0.0:
        for k in range(3):
            sums.point[k] /= sums.normal_force
    for patch in range(int(highest) + 1):
        total, members = 0.0, 0
        c = meshes.pairs[pair].first_member
        while c >= 0:
            state = contacts.state[c]
            touches = state.normal_force > 0.0 or state.closed
            if state.patch == patch and touches:
                total += state.normal_force
                members += 1
            c = meshes.next_member[c]
        sums.largest_force = max(sums.largest_force, total)
        sums.patches += 1.0 if members > 0 else 0.0


@kernel(internal=True)
def _record_largest(meshes: SurfacePairs, contacts: ContactRows, pair: int, row: Floats1) -> None:
    """Contacts in the order of their normal forces, those of equal ones in that of their places."""
    before, last = math.inf, -1
    for i in range(meshes.pairs[pair].recorded):
        best, largest = -1, -1.0
        c = meshes.pairs[pair].first_member
        while c >= 0:
            force = contacts.state[c].normal_force
            touches = force > 0.0 or contacts.state[c].closed
            later = force < before or (force == before and c > last)
            if touches and later and force > largest:
                best, largest = c, force
            c = meshes.next_member[c]
        out = recorded_outputs(row, meshes.recorded_columns[meshes.pairs[pair].first_recorded + i])
        _clear(out.words)
        out.patch = -1.0
        if best < 0:
            continue
        before, last = largest, best
        state = contacts.state[best]
        for k in range(3):
            out.point[k] = state.touched[k]
            out.normal[k] = state.normal[k]
        out.gap, out.force = state.gap, state.normal_force
        out.friction, out.impulse = state.friction_force, state.step_impulse
        out.patch = state.patch
