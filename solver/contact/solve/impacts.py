"""Contacts at the end of the step: gaps, impacts, and the velocities of what stays closed.

An impact obeys Newton's law between the end velocity of the step, which knows the elastic forces of the step, and the
velocity after it: applied before the elastic forces, light and stiff local modes would take the whole impulse. Contacts
that stay closed are projected like joints, but their impulses over the whole step, those of the middle included,
may not pull: so what pushed a penetration out leaves no velocity behind.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact import layout
from heavylift.solver.contact.counts import carried_on, contact_count, owner_of
from heavylift.solver.contact.kind import BILATERAL, COMPLIANT, CURVE, RIGID, TRIANGLES, ContactRows
from heavylift.solver.contact.laws.normal_force import normal_force, stored_energy
from heavylift.solver.contact.laws.restitution import bound_restitution
from heavylift.solver.contact.search.search_end import judge_searches
from heavylift.solver.contact.solve.asleep import rests, stop_asleep
from heavylift.solver.contact.solve.delassus import contact_rates
from heavylift.solver.contact.solve.events import CLOSE, MOST_EVENTS, SHORTEST, gap_tolerance
from heavylift.solver.contact.solve.stage import (
    assemble_response,
    friction_rows,
    present_at,
    slip_energy,
    softness_of,
    solve_present,
    sort_contacts,
)
from heavylift.solver.contact.system_interface import follow
from heavylift.solver.contact.triangles.interface import place_surfaces, watch_pairs
from heavylift.solver.extremes import note_stored, note_value
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Systems,
    Workspace,
    add_row_work,
    apply_inverse,
    close_step,
    solve_end,
)
from heavylift.solver.kinds import implement
from heavylift.solver.ringing import steady_rate

__all__ = ["REST", "count_rough", "keep_in_cone", "pressed_force", "write_force"]

REST = 1e-6
"""Rate after an impact relative to that before it, below which the contact is closed."""

UNCUT = 1.0 - 1e-9
"""Of a whole step: what is shorter has been cut by an impact."""

OFF = 1e-4
"""Gap relative to the size of a contact, with which it does not stay closed: it has slid over a border."""

SHORTEST_PART = 1e-3
"""Of a whole step, down to which it is halved while the impulses at its end are not found."""

TAKEN = 1e-3
"""Of a force: what is taken away by less when it is carried on to the end of a step is not missed."""

STICKING = 1e-9
"""Share of the bound below which a friction impulse counts as one that holds."""


@kernel(internal=True)
def _is_new(contacts: ContactRows, c: int, step: float, velocity: NDArray[np.float64]) -> bool:
    """Whether an open contact without compliance closes at the end of this step."""
    state = contacts.state[c]
    if state.closed or contacts.table[c].law == COMPLIANT:
        return False
    if state.present and contacts.rows[c].half_impulse[0] > 0.0:
        return True  # stopped by its row in the middle of the step
    rate = contact_rates(contacts, c, velocity)[0]
    # what would touch at once belongs to the same impact
    soon = -SHORTEST * rate * contacts.control.nominal_step
    return rate < 0.0 and state.end_gap <= gap_tolerance(contacts, c, rate) + soon


@kernel(inline=True, internal=True)
def _is_blow(contacts: ContactRows, c: int, rate: float) -> bool:
    """Whether what closes at a rate hits; more slowly than that it has come to rest on what bears."""
    return -rate * contacts.control.nominal_step > CLOSE * contacts.values[c].length_scale


@implement(solve_end, ContactRows)
@kernel(internal=True)
def solve_contact_end(
    contacts: ContactRows,
    rows: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """With the factor of the joints at the end of the step, which have been solved without contacts.

    Where something hits, what has been closed all along is projected first: an impact may lift it, but cannot take back
    the impulses that have borne it until then. Not so what a row has stopped in the middle of the step: what is closed
    has borne that too, and both are solved for together.
    """
    contacts.control.time = time + step
    stop_asleep(contacts, work.velocity)
    closed, hits, stopped = 0, 0, 0
    contacts.control.struck = False
    for c in range(contact_count(contacts)):
        if rests(contacts, c):
            continue
        state = contacts.state[c]
        impulse = contacts.rows[c].impulse
        for r in range(3):
            impulse[r] = state.warm_start[r] = 0.0
        state.new = _is_new(contacts, c, step, work.velocity)
        if state.new and not state.present:
            hits += 1
            if _is_blow(contacts, c, contact_rates(contacts, c, work.velocity)[0]):
                contacts.control.struck = True
        elif state.new:
            stopped += 1
        elif state.closed:
            closed += 1
    apart = closed > 0 and hits > 0 and stopped == 0
    if apart:
        if not _project(contacts, rows, bodies, joints, work, time, step, True, False):
            return
        add_row_work(bodies, 1.0, work, contacts)
        for c in range(contact_count(contacts)):
            impulse, half_impulse = contacts.rows[c].impulse, contacts.rows[c].half_impulse
            for r in range(3):
                half_impulse[r] += 0.5 * impulse[r]
                impulse[r] = 0.0
    _project(contacts, rows, bodies, joints, work, time, step, not apart, True)


@kernel(internal=True)
def _project(
    contacts: ContactRows,
    rows: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
    smooth: bool,
    hits: bool,
) -> bool:
    """Impulses at the end of what is closed, and of what hits; false if they are not found.

    Parameters
    ----------
    contacts, rows, bodies, joints, work, time, step
        As of `solve_end`.
    smooth
        Whether these impulses belong to those of the step: both together push and stay in their cones.
    hits
        Whether what is new takes part.
    """
    count = 0
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        rubs = (
            smooth
            and contacts.table[c].law == COMPLIANT
            and state.present
            and contacts.values[c].friction > 0.0
            and contacts.table[c].shape_kind != TRIANGLES  # there friction yields
        )
        if (state.closed or (hits and state.new) or rubs) and not rests(contacts, c):
            contacts.present[count] = c
            count += 1
    contacts.counts.present = count
    if count == 0:
        return True
    sort_contacts(contacts, count)
    apply_inverse(bodies, False, contacts)
    for j in range(count):
        _tell_end(contacts, j, smooth, work)
    assemble_response(contacts, rows, count)
    for j in range(count):  # whether it rests afterwards follows from the rate before
        c = present_at(contacts, j)
        contacts.state[c].rate = contact_rates(contacts, c, work.velocity)[0]
    if not solve_present(contacts, count, work):
        # not found: two steps may do what one does not
        if step > SHORTEST_PART * contacts.control.nominal_step:
            work.status.outcome = work.status.block = 0
            work.control.split = 0.5 * step
        return False
    if hits and not bound_restitution(contacts, count, work):
        return False
    follow(rows, joints, False, work, time, step)
    for j in range(count):
        _book_impact(contacts, j, smooth, work)
    return True


@kernel(internal=True)
def _tell_end(contacts: ContactRows, j: int, smooth: bool, work: Workspace) -> None:
    """Law of a contact for the projection; what is not smooth has no impulses of the step beside it."""
    c = present_at(contacts, j)
    state, values, law = contacts.state[c], contacts.values[c], contacts.laws[j]
    friction_rows(contacts, j, softness_of(contacts, c), 0.0)
    half_impulse = contacts.rows[c].half_impulse
    for r in range(3):
        law.offset[r] = 2.0 * half_impulse[r] if smooth or state.new else 0.0
    kind = contacts.table[c].law
    if kind == COMPLIANT:
        contacts.kinds[j].kind = layout.NORMAL_GIVEN
    elif kind == BILATERAL:
        contacts.kinds[j].kind = layout.BILATERAL
    elif kind == CURVE:
        contacts.kinds[j].kind = layout.CURVE
    else:
        contacts.kinds[j].kind = layout.UNILATERAL
        if state.new:
            rate = state.rate if state.present else contact_rates(contacts, c, work.velocity)[0]
            # what is still inside from an impact before comes to rest, or it would hit again in every step
            outside = state.gap >= -CLOSE * values.length_scale
            bounces = state.recent_impacts < MOST_EVENTS and not contacts.control.exhausted
            if bounces and outside and -rate > values.rest_speed:
                law.target[0] = -values.restitution * rate
        law.wanted = law.target[0]


@kernel(internal=True)
def _book_impact(contacts: ContactRows, j: int, smooth: bool, work: Workspace) -> None:
    """Energy lost by an impact: its impulse on the mean of the rates before and after; by friction likewise."""
    c = present_at(contacts, j)
    state = contacts.state[c]
    impulse = contacts.rows[c].impulse
    w, free = contacts.rates[2], contacts.rates[0]
    loss = 0.0
    first = 2 if contacts.table[c].law == CURVE else 1
    # what slides over a ridge of triangles takes a small blow in its new direction
    if not smooth or state.new or contacts.table[c].shape_kind == TRIANGLES:
        first = 0
    for r in range(first, 3):
        before = free[3 * j + r]
        loss -= 0.5 * impulse[r] * (before + w[3 * j + r])
    state.step_loss += loss
    if state.new:
        contacts.control.impact = True
        state.recent_impacts += 1
        # what was closed but for rounding, and closes by no more, has come to rest on what bears, and hits nothing
        known = gap_tolerance(contacts, c, 0.0)
        if state.gap > known or -state.rate * contacts.control.nominal_step > known:
            state.impacts += 1
        # what a row has stopped in the middle of the step had the rest of its blow there
        state.impact_impulse += impulse[0] + (
            2.0 * contacts.rows[c].half_impulse[0] if state.present else 0.0
        )


@implement(close_step, ContactRows)
@kernel(internal=True)
def close_contact_step(
    contacts: ContactRows, all_systems: Systems, bodies: Bodies, joints: Joints, work: Workspace, step: float
) -> None:
    """What stays closed, sums and forces of the step; after the bodies have taken their velocities."""
    add_row_work(bodies, 1.0, work, contacts)
    judge_searches(contacts, True, work)
    # what keeps a contact without compliance closed is an impulse: over a part of a cut step it is no force
    contacts.control.uncut = step >= UNCUT * contacts.control.nominal_step
    ahead = carried_on(step, work)
    for i in range(contacts.island_loss.shape[0]):
        contacts.island_loss[i] = 0.0
    for c in range(contact_count(contacts)):
        if rests(contacts, c):
            state = contacts.state[c]
            state.step_impulse = step * state.middle_force[0]
            state.impulse += state.step_impulse
        else:
            _close_one(contacts, c, step, ahead, work)
    _stay_in_middle(contacts)
    interval = work.control.interval
    for c in range(contacts.counts.of_contours):
        state = contacts.state[c]
        if contacts.control.uncut or contacts.table[c].law == COMPLIANT:
            note_value(state.forces, interval, state.normal_force)
        if state.located:  # what is far from touching has no gap that is known
            note_value(state.gaps, interval, state.gap)
        if contacts.table[c].law == COMPLIANT:
            values, law = contacts.values[c], contacts.table[c].force_law
            note_stored(state.store, stored_energy(law, values.stiffness, values.exponent, -state.gap))
    watch_pairs(contacts.meshes, contacts, work)
    _book_losses(contacts)
    count_rough(contacts)
    place_surfaces(contacts.meshes, contacts)


@kernel(internal=True)
def _book_losses(contacts: ContactRows) -> None:
    """Energies that contacts have lost in the step: those of an island without compliance all together, or none.

    What they gain, as by pushing a penetration out, is no dissipation with another sign: it stays in the balance. One
    contact may gain what another loses, as where a body hits with several points at once, but not one that has nothing
    to do with it.
    """
    lost = contacts.island_loss
    for island in range(lost.shape[0]):
        lost[island] = 0.0
    for c in range(contact_count(contacts)):
        if contacts.table[c].law != COMPLIANT:
            lost[contacts.islands[owner_of(contacts, c)]] += contacts.state[c].step_loss
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        if contacts.table[c].law == COMPLIANT or lost[contacts.islands[owner_of(contacts, c)]] >= 0.0:
            state.loss += state.step_loss
        state.step_loss = 0.0


@kernel(internal=True)
def count_rough(contacts: ContactRows) -> None:
    """Solutions of a step that is taken back count for nothing, so they are counted when it stands."""
    control, tally = contacts.control, contacts.tally[0]
    tally.rough += control.rough
    if control.roughest > tally.roughest:
        tally.roughest, tally.roughest_time = control.roughest, control.time


@kernel(internal=True)
def _close_one(contacts: ContactRows, c: int, step: float, ahead: float, work: Workspace) -> None:
    """What stays closed, and forces: `ahead` tells how far those of the middle of the step are carried on."""
    state, values = contacts.state[c], contacts.values[c]
    impulse, half_impulse = contacts.rows[c].impulse, contacts.rows[c].half_impulse
    reaction = contacts.rows[c].reaction
    kind = contacts.table[c].law
    touched = state.present or state.new or state.closed
    window, kept = step, 0.0  # what the force is a mean over; share of the one before
    if kind != COMPLIANT and not contacts.control.uncut:
        window = min(state.window + step, contacts.control.nominal_step)
        kept = 1.0 - step / window
    state.window = window
    if not touched and state.sleep > 0.0:
        state.step_impulse = state.slip_speed = 0.0
        state.changed = state.middle_force[0] != 0.0
        state.normal_force = state.friction_force = 0.0
        for r in range(3):
            state.middle_force[r] *= kept
            reaction[r] = state.middle_force[r]
            state.force[r] = state.warm_start[r] = 0.0
        if reaction[0] != 0.0:
            write_force(contacts, c, reaction, kind)
        state.gap, state.second_gap = state.end_gap, state.second_end_gap
        # so near it has been searched, and has rows
        near = state.located or state.end_gap <= CLOSE * values.length_scale
        if near or contacts.table[c].shape_kind == TRIANGLES:
            state.rate = contact_rates(contacts, c, work.velocity)[0]
        return
    a, b, d = contact_rates(contacts, c, work.velocity)
    total = 2.0 * half_impulse[0] + impulse[0]
    if kind == CURVE:
        total = math.hypot(total, 2.0 * half_impulse[1] + impulse[1])
    state.impulse += abs(total) if kind == CURVE else total
    state.step_impulse = total
    new, struck = state.new, contacts.control.struck
    resting = state.present
    if new:
        blow = _is_blow(contacts, c, _approach(contacts, c))
        resting = not struck and not blow
        if blow:
            state.window = kept = 0.0
    apart = struck and not new and state.closed  # the end of the step is that of the blow
    for r in range(3):
        middle = 0.0
        if resting:
            middle = 2.0 * half_impulse[r] if apart else 2.0 * half_impulse[r] + impulse[r]
            middle /= window
        before = state.middle_force[r]
        if r == 0:
            state.changed = (before != 0.0) != (middle != 0.0)
        middle += kept * before
        continued = before != 0.0 and middle != 0.0 and kind != COMPLIANT and contacts.control.uncut
        reaction[r] = middle + (ahead * (middle - before) if continued else 0.0)
        state.middle_force[r] = middle
        state.warm_start[r] = half_impulse[r]
    if kind == COMPLIANT:
        rate = steady_rate(state.mean_rate, state.growth, a) if state.paced else a
        reaction[0] = pressed_force(contacts, c, rate)
        if state.end_gap >= 0.0:
            state.touch_damping = -1.0
    elif kind != BILATERAL and kind != CURVE:  # noqa: PLR1714  a set costs time here
        stays = state.closed and total > 0.0 and state.end_gap <= OFF * values.length_scale
        # of more contacts than needed some bear nothing, and rest all the same
        if contacts.table[c].shape_kind == TRIANGLES:
            stays = stays or (state.closed and state.end_gap <= gap_tolerance(contacts, c, a))
            stays = stays or state.joined
            state.joined = False
        stays = stays or (state.new and a <= REST * abs(state.rate))
        state.closed = stays
        if total > 0.0:
            contacts.tally[0].deepest = max(contacts.tally[0].deepest, -state.end_gap / values.length_scale)
    first = 2 if kind == CURVE else 1
    bound = values.friction * abs(total)
    held = 0.0
    for r in range(first, 3):
        held = math.hypot(held, 2.0 * half_impulse[r] + impulse[r])
    if (not state.closed and kind != COMPLIANT) or held >= bound * (1.0 - STICKING):
        _let_slip(contacts, c, bound / step)
    speed = abs(d) if kind == CURVE else math.hypot(b, d)
    state.slip_speed = speed if total != 0.0 else 0.0
    state.rate = a
    state.gap, state.second_gap = state.end_gap, state.second_end_gap
    if kind == COMPLIANT:  # the stiffness of the end of the step, at which nothing slips
        kept = slip_energy(contacts, c)
        state.jump += state.kept - kept
        state.kept = kept
    if keep_in_cone(contacts, c, reaction, kind) and kind == RIGID:
        contacts.island_loss[contacts.islands[owner_of(contacts, c)]] = 1.0
    write_force(contacts, c, reaction, kind)


@kernel(internal=True)
def _stay_in_middle(contacts: ContactRows) -> None:
    """Forces of islands that cannot be carried on to the end of the step stay those of its middle, all of them.

    Of more contacts than needed each bears something else in each step. What one cannot take by its law when it is
    carried on would be missing in the sum of all.
    """
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        out = contacts.island_loss[contacts.islands[owner_of(contacts, c)]] > 0.0
        if out and contacts.table[c].law == RIGID and not rests(contacts, c):
            state.changed = False
            for r in range(3):
                contacts.rows[c].reaction[r] = state.middle_force[r]
            write_force(contacts, c, contacts.rows[c].reaction, RIGID)


@kernel(inline=True, internal=True)
def _approach(contacts: ContactRows, c: int) -> float:
    """Rate with which a new contact has come; what a row has stopped in the middle of the step came before."""
    state = contacts.state[c]
    return state.start_rate if state.present else state.rate


@kernel(internal=True)
def _let_slip(contacts: ContactRows, c: int, most: float) -> None:
    """What slides keeps no memory of where it stuck, but for what the largest force of friction [N] stretches.

    With the stiffness of the step, with which what is kept was stored.
    """
    state = contacts.state[c]
    slip = math.hypot(state.slip[0], state.slip[1])
    stretched = 2.0 * state.kept / slip if slip > 0.0 else 0.0
    share = min(1.0, most / stretched) if stretched > 0.0 else 0.0
    state.slip[0], state.slip[1] = share * state.slip[0], share * state.slip[1]
    rest = share * share * state.kept
    state.step_loss += state.kept - rest
    state.kept = rest


@kernel(internal=True)
def pressed_force(contacts: ContactRows, c: int, rate: float) -> float:
    """Normal force [N] of a compliant contact at its gap, which opens at a rate [m/s]."""
    values = contacts.values[c]
    return normal_force(
        contacts.table[c].force_law,
        values.stiffness,
        values.exponent,
        _damping(contacts, c),
        -contacts.state[c].end_gap,
        -rate,
    )


@kernel(internal=True)
def keep_in_cone(contacts: ContactRows, c: int, reaction: NDArray[np.float64], kind: int) -> bool:
    """Forces that were carried on to the end of the step obey the law too: none pulls, friction has its bound.

    Whether more than `TAKEN` of the force in the middle of the step had to be taken away.
    """
    first = 2 if kind == CURVE else 1
    normal = math.hypot(reaction[0], reaction[1]) if kind == CURVE else reaction[0]
    most, taken = TAKEN * abs(contacts.state[c].middle_force[0]), False
    if kind == RIGID or kind == COMPLIANT:  # noqa: PLR1714, SIM109  a set costs time here
        taken = reaction[0] < -most
        normal = reaction[0] = max(reaction[0], 0.0)
    bound, found = contacts.values[c].friction * abs(normal), 0.0
    for r in range(first, 3):
        found = math.hypot(found, reaction[r])
    if found > bound:
        taken = taken or found - bound > most
        for r in range(first, 3):
            reaction[r] *= bound / found
    return bool(taken)


@kernel(inline=True, internal=True)
def _damping(contacts: ContactRows, c: int) -> float:
    """Of the force law at this touch."""
    if contacts.table[c].force_law == layout.HUNT_CROSSLEY:
        return max(contacts.state[c].touch_damping, 0.0)
    return contacts.values[c].damping


@kernel(internal=True)
def write_force(contacts: ContactRows, c: int, reaction: NDArray[np.float64], kind: int) -> None:
    """Force on what touches, in the world."""
    state = contacts.state[c]
    f1, f2, f3 = reaction[0], reaction[1], reaction[2]
    n1, n2, n3 = state.normal[0], state.normal[1], state.normal[2]
    t1, t2, t3 = state.tangent[0], state.tangent[1], state.tangent[2]
    # the third direction of a surface is n x t, and so is that of a curve: normals and tangent are its axes
    s1, s2, s3 = n2 * t3 - n3 * t2, n3 * t1 - n1 * t3, n1 * t2 - n2 * t1
    state.force[0] = f1 * n1 + f2 * t1 + f3 * s1
    state.force[1] = f1 * n2 + f2 * t2 + f3 * s2
    state.force[2] = f1 * n3 + f2 * t3 + f3 * s3
    state.normal_force = math.hypot(f1, f2) if kind == CURVE else f1
    state.friction_force = abs(f3) if kind == CURVE else math.hypot(f2, f3)
