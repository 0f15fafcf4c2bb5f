"""Contacts in the middle of the step: who takes part, what the laws are, impulses on top of the factored joints.

Only contacts that are closed, or have a force law and are near, take part: a row for every near contact would turn each
touch into a rebound, because the end velocity of a step is twice that of the middle minus that of the start.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.contact import layout
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.interface import pose_contours, settle_points
from heavylift.solver.contact.kind import (
    BILATERAL,
    COMPLIANT,
    CURVE,
    DENSE,
    NO_END,
    NO_IMPULSES,
    RIGID,
    TRIANGLES,
    ContactRows,
)
from heavylift.solver.contact.laws.normal_force import hunt_crossley_damping
from heavylift.solver.contact.search.contact_kinematics import locate
from heavylift.solver.contact.search.search_end import judge_searches, mark_failure
from heavylift.solver.contact.solve.asleep import note_loads, rests, stop_asleep, wake_touched
from heavylift.solver.contact.solve.delassus import assemble_delassus, contact_rates, own_response, push
from heavylift.solver.contact.solve.newton import solve_contacts
from heavylift.solver.contact.solve.reduced import assemble_reduced, solve_reduced, sort_by_islands
from heavylift.solver.contact.system_interface import follow
from heavylift.solver.contact.triangles.interface import pose_surfaces
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Systems,
    Workspace,
    apply_inverse,
    refactor_rows,
    solve_again,
    solve_midpoint,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.impulses import add_impulses

__all__ = [
    "NEAR",
    "assemble_response",
    "friction_rows",
    "looks_ahead",
    "present_at",
    "slip_energy",
    "slip_stiffness",
    "solve_present",
    "sort_contacts",
]

CONTACT_ROUNDS = 50
"""Rounds of contacts against laws of ropes and stops."""

NEAR = 3.0
"""Motions of a step within which a contact with a force law takes part in the middle of the next one."""

SOFTNESS_OF_ROWS = 1e-9
"""Of rows without compliance, relative to what a row sees of its own bodies: lets redundant contacts share."""

SLOW = 1e-3
"""Way in a whole step relative to the size of a contact, whose rate measures residuals at least: the smallest that is
accepted, 1e-10 of it, moves a gap by a thousandth of what gaps are found to. Where all is at rest the rates are
rounding, which no impulses make consistent."""

ENOUGH = 1e-3
"""Relative residual of impulses that serve if none better are found; the run says so, with the largest and its time."""

DEEP = 1e-5
"""Penetration relative to the size of a contact from which on it is pushed out gently, in `SOFTLY` of a step."""

SOFTLY = 0.2

PASSING = 1e-5
"""Of the size: what is beside its face by less meets it."""

SLIP_DAMPING = 0.2
"""Damping ratio of the elastic slip: without it, what begins to stick swings to twice its load and slips again."""


@kernel(inline=True, internal=True)
def present_at(contacts: ContactRows, j: int) -> int:
    """Number of the j-th contact that takes part."""
    return contacts.present[j]


@kernel(inline=True, internal=True)
def looks_ahead(contacts: ContactRows, c: int) -> bool:
    """Whether a contact without compliance takes part before it closes, in place of splitting the step."""
    if contacts.table[c].shape_kind != TRIANGLES or contacts.table[c].law != RIGID:
        return False
    return contacts.control.exhausted or not contacts.table[c].events


@kernel(internal=True)
def _passes_by(contacts: ContactRows, c: int) -> bool:
    """Whether features that are apart will be beside each other when their gap closes, or never close it.

    Gap and distance beside them continue through the step as they have changed up to its predicted middle. Where steps
    are not split, what has met without a row when the step was tried before does not pass by.
    """
    state = contacts.state[c]
    gap, beside = state.gap, state.start_beside
    if contacts.table[c].shape_kind != TRIANGLES or state.closed or not gap > 0.0:
        return False
    if state.hit > 0 and contacts.table[c].law == RIGID and not contacts.table[c].events:
        return False
    end = 2.0 * state.end_gap - gap
    share = min(gap / (gap - end), 1.0) if end < gap else 1.0
    beside += 2.0 * share * (state.beside - beside)
    return bool(beside > PASSING * contacts.values[c].length_scale)


@kernel(internal=True)
def _find_near(contacts: ContactRows) -> int:
    """Contacts that may take part; how many."""
    count = 0
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        impulse = contacts.rows[c].impulse
        for r in range(3):
            impulse[r] = 0.0
        state.present = state.near = False
        if rests(contacts, c):
            continue
        early = contacts.table[c].law == COMPLIANT or looks_ahead(contacts, c)
        state.near = state.closed or (early and state.sleep <= NEAR * state.shift)
        if state.near:
            contacts.present[count] = c
            state.present = True
            count += 1
    return count


@implement(solve_midpoint, ContactRows)
@kernel(internal=True)
def solve_contact_midpoint(
    contacts: ContactRows,
    rows: Systems,
    bodies: Bodies,
    joints: Joints,
    work: Workspace,
    time: float,
    step: float,
    nominal: float,
) -> None:
    """Rows at the predicted midpoint, then half impulses."""
    contacts.control.nominal_step, contacts.control.part = nominal, step / nominal
    contacts.control.free_rate = 0.0
    contacts.control.residual, contacts.control.rounds = 0.0, 0
    contacts.control.rough, contacts.control.roughest = 0, 0.0
    note_loads(contacts, work, step)
    count = _find_near(contacts)
    if wake_touched(contacts, count):
        count = _find_near(contacts)
    stop_asleep(contacts, work.velocity)
    contacts.counts.present = count
    if count == 0:
        return
    pose_contours(bodies, True, contacts)
    pose_surfaces(contacts.meshes, contacts)
    kept = 0
    for j in range(count):
        c = present_at(contacts, j)
        locate(contacts, bodies, c, False, work)
        if _passes_by(contacts, c):
            contacts.state[c].present = False
        else:
            contacts.present[kept] = c
            kept += 1
    count = kept
    contacts.counts.present = count
    if count == 0:
        return
    sort_contacts(contacts, count)
    judge_searches(contacts, False, work)
    settle_points(bodies, rows, True, work)
    apply_inverse(bodies, True, contacts)
    for j in range(count):
        _tell(contacts, j, step, work)
    _settle(contacts, rows, joints, count, work, time, step)


@implement(solve_again, ContactRows)
@kernel(internal=True)
def solve_contacts_again(
    contacts: ContactRows, rows: Systems, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """From the impulses that are there."""
    count = contacts.counts.present
    if count > 0:
        _settle(contacts, rows, joints, count, work, time, step)


@kernel(internal=True)
def _settle(
    contacts: ContactRows,
    rows: Systems,
    joints: Joints,
    count: int,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """Contacts, and laws of ropes and stops, until both stand."""
    for _ in range(CONTACT_ROUNDS):
        assemble_response(contacts, rows, count)
        if not solve_present(contacts, count, work):
            return
        work.control.changed = 0
        follow(rows, joints, True, work, time, step)
        if work.control.changed == 0:
            return
    mark_failure(contacts, present_at(contacts, 0), NO_END, work)


@kernel(inline=True, internal=True)
def _on_velocities(contacts: ContactRows, count: int) -> bool:
    """Whether the contacts that take part are solved on the velocities of their bodies."""
    return contacts.counts.all_rigid and count > DENSE


@kernel(internal=True)
def sort_contacts(contacts: ContactRows, count: int) -> None:
    """Those that act on each other stand together, where each group of them is solved by itself."""
    if _on_velocities(contacts, count):
        sort_by_islands(contacts, count)


@kernel(internal=True)
def assemble_response(contacts: ContactRows, systems: Systems, count: int) -> None:
    """What the contacts that take part feel of each other."""
    if _on_velocities(contacts, count):
        assemble_reduced(contacts, systems, count)
    else:
        assemble_delassus(contacts, systems, contacts.present, count, contacts.column)


@kernel(internal=True)
def solve_present(contacts: ContactRows, count: int, work: Workspace) -> bool:
    """Impulses of the contacts that take part, and what they do to the velocities of bodies; false if not found."""
    free, p, w = contacts.rates[0], contacts.rates[1], contacts.rates[2]
    size, largest = math.inf, 0.0
    for j in range(count):
        c = present_at(contacts, j)
        size = min(size, contacts.values[c].length_scale)
        a, b, d = contact_rates(contacts, c, work.velocity)
        free[3 * j], free[3 * j + 1], free[3 * j + 2] = a, b, d
        largest = max(largest, abs(a), abs(b), abs(d))
        impulse = contacts.rows[c].impulse
        for r in range(3):
            p[3 * j + r] = impulse[r]
    contacts.dense.counts.least_rate = contacts.reduced.problem.counts.least_rate = (
        SLOW * size / contacts.control.nominal_step
    )
    # at the end of the step what the middle has seen counts on: blows may be nothing beside it
    contacts.control.free_rate = max(contacts.control.free_rate, largest / contacts.control.part)
    contacts.dense.counts.free_rate = contacts.reduced.problem.counts.free_rate = contacts.control.free_rate
    reduced = _on_velocities(contacts, count)
    if reduced:
        for i in range(3 * count):
            w[i] = p[i]
    else:
        for i in range(3 * count):
            total = 0.0
            for k in range(3 * count):
                total += contacts.delassus[i, k] * p[k]
            free[i] -= total
    for j in range(count):
        c = present_at(contacts, j)
        started = False
        for r in range(3):
            started = started or p[3 * j + r] != 0.0
        if not started:
            for r in range(3):
                p[3 * j + r] = contacts.state[c].warm_start[r]
    if reduced:
        solve_reduced(contacts, count, work.velocity)
    else:
        contacts.dense.counts.number, contacts.dense.counts.size = count, 3 * count
        solve_contacts(contacts.solvers, contacts.dense)
    solution = contacts.solution
    contacts.control.residual = max(contacts.control.residual, solution.residual)
    contacts.control.rounds += solution.iterations
    contacts.control.effort += float(count * solution.iterations)
    if solution.status < 0:
        if not solution.residual < ENOUGH:
            mark_failure(contacts, present_at(contacts, 0), NO_IMPULSES, work)
            return False
        contacts.control.rough += 1
        contacts.control.roughest = max(contacts.control.roughest, solution.residual)
    for j in range(count):
        c = present_at(contacts, j)
        impulse = contacts.rows[c].impulse
        for r in range(3):
            change = p[3 * j + r] - impulse[r]
            if change != 0.0:
                push(contacts, c, r, change, work.velocity)
                impulse[r] = p[3 * j + r]
    return True


@kernel(internal=True)
def friction_rows(contacts: ContactRows, j: int, softness: float, rate: float) -> None:
    """What holds a contact that sticks where it is; for the solver."""
    c = present_at(contacts, j)
    law = contacts.laws[j]
    law.friction = contacts.values[c].friction
    for r in range(3):
        law.softness[r] = softness
        law.offset[r] = 0.0
    law.target[0] = 0.0
    law.target[1] = -rate * contacts.state[c].slip[0]
    law.target[2] = -rate * contacts.state[c].slip[1]


@kernel(inline=True, internal=True)
def slip_stiffness(contacts: ContactRows, c: int) -> float:
    """Of the elastic slip [N/m] of a compliant contact between surfaces; 0 where what sticks does not yield.

    Notes
    -----
    A tangential compliance of 1.5 times the normal one, a little more than that of smooth elastic bodies (K. L.
    Johnson, *Contact Mechanics*, 1985, section 7.2: (2 - nu)/(2 - 2 nu), which is 1.2 for nu = 0.3).
    """
    if contacts.table[c].shape_kind != TRIANGLES or contacts.table[c].law != COMPLIANT:
        return 0.0
    n, depth = contacts.values[c].exponent, -contacts.state[c].gap
    if not depth > 0.0:
        return 0.0
    return contacts.values[c].stiffness * n * depth ** (n - 1.0) / 1.5


@kernel(inline=True, internal=True)
def slip_energy(contacts: ContactRows, c: int) -> float:
    """Stored in the elastic slip [J], with the stiffness of now."""
    slip = contacts.state[c].slip
    return 0.5 * slip_stiffness(contacts, c) * (slip[0] * slip[0] + slip[1] * slip[1])


@kernel(internal=True)
def _tell_slip(contacts: ContactRows, j: int, step: float) -> None:
    """Tangential spring and damper: ``F = -(k (s + h/2 w) + c w)`` as rows of half impulses at the midpoint."""
    c = present_at(contacts, j)
    k = slip_stiffness(contacts, c)
    if k > 0.0 and contacts.values[c].friction > 0.0:
        law, state = contacts.laws[j], contacts.state[c]
        damping = 2.0 * SLIP_DAMPING * math.sqrt(k / contacts.values[c].inverse_mass)
        yielding = 0.5 * step * k + damping
        law.softness[1] = law.softness[2] = 2.0 / (step * yielding)
        law.target[1] = -k * state.slip[0] / yielding
        law.target[2] = -k * state.slip[1] / yielding


@kernel(internal=True)
def softness_of(contacts: ContactRows, contact: int) -> float:
    """Regularisation of the rows of a contact, from what its normal row sees of its own bodies."""
    for r in range(3):
        found = own_response(contacts, contact, r)
        if found > 0.0:
            return SOFTNESS_OF_ROWS * found
    return SOFTNESS_OF_ROWS


@kernel(internal=True)
def _tell(contacts: ContactRows, j: int, step: float, work: Workspace) -> None:
    """Law of a contact for the middle of the step."""
    c = present_at(contacts, j)
    state, values, law = contacts.state[c], contacts.values[c], contacts.laws[j]
    rate = 1.0 / contacts.control.nominal_step
    friction_rows(contacts, j, softness_of(contacts, c), rate)
    kind = contacts.table[c].law
    gap = state.gap
    if kind == COMPLIANT:
        _tell_slip(contacts, j, step)
        contacts.kinds[j].kind, contacts.kinds[j].law = layout.COMPLIANT, contacts.table[c].force_law
        law.stiffness, law.exponent = values.stiffness, values.exponent
        law.damping, law.depth, law.step = values.damping, -gap, step
        if contacts.table[c].force_law == layout.HUNT_CROSSLEY:
            approach = -contact_rates(contacts, c, work.velocity)[0]
            if state.touch_damping < 0.0 and approach > 0.0:
                law.damping = hunt_crossley_damping(values.restitution, approach)
                if step * approach > gap:
                    state.touch_damping = law.damping
            else:
                law.damping = max(state.touch_damping, 0.0)
        return
    if kind == CURVE:
        contacts.kinds[j].kind = layout.CURVE
        law.target[0], law.target[1] = -rate * gap, -rate * state.second_gap
        law.target[2] = -rate * state.slip[1]
        return
    if kind == BILATERAL:
        contacts.kinds[j].kind = layout.BILATERAL
        law.target[0] = -rate * gap
        return
    contacts.kinds[j].kind = layout.UNILATERAL
    if gap > 0.0 and not state.closed:  # closes within this step at most
        law.target[0] = -gap / step
        return
    law.target[0] = -rate * gap * (SOFTLY if gap < -DEEP * values.length_scale else 1.0)


@implement(refactor_rows, ContactRows)
@kernel(internal=True)
def refactor_contact_rows(contacts: ContactRows, bodies: Bodies, joints: Joints, work: Workspace) -> None:
    """The rows stay those of the predicted midpoint; the matrices of bodies have changed."""
    add_impulses(contacts, work.velocity, -1.0)
    apply_inverse(bodies, True, contacts)
    add_impulses(contacts, work.velocity, 1.0)
