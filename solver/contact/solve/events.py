"""Impacts within a step: the step is taken back and repeated up to the time at which the first gap closes.

The time is found by Newton's method on the gap at the end of the step, with the rate of the gap there, inside a
bracket. A contact that touches at the start of the step and would be inside at its end, without a time between
that could be known at the start, joins the closed ones and the step is repeated. What may have gone through the other
and out again within the step is looked at in between first. After `MOST_EVENTS` impacts in a
whole step the rest of it continues without restitution and without splitting: so a bouncing ball comes to rest. So it
does for all contacts where impacts follow each other without end, as where a pile rocks or an arch comes apart; there
surfaces look ahead for the rest of the step.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.copying import put_back, save
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.interface import bound_motion, pose_contours, settle_points
from heavylift.solver.contact.kind import COMPLIANT, CURVE, RIGID, TRIANGLES, ContactRows
from heavylift.solver.contact.laws.normal_force import stored_energy
from heavylift.solver.contact.search.contact_kinematics import locate
from heavylift.solver.contact.solve.asleep import hold_places, let_sleep, note_balance, rests, wake_reached
from heavylift.solver.contact.solve.delassus import contact_rates
from heavylift.solver.contact.solve.stage import NEAR, looks_ahead, slip_energy
from heavylift.solver.contact.system_interface import after_step, before_advance, go_back
from heavylift.solver.contact.triangles.interface import keep_found, search_surfaces
from heavylift.solver.interface import Bodies, Joints, Workspace, add_row_work, end_rows, forget_accelerations
from heavylift.solver.kinds import implement

__all__ = ["CLOSE", "MOST_EVENTS", "SHORTEST", "gap_tolerance"]

MOST_EVENTS = 20
"""Impacts of a contact within a whole step."""

TRIALS, TRIALS_OF_EACH = 400, 10
"""Of times of impacts within a whole step: of all, and more for each contact."""

MOST_EFFORT = 4e5
"""Contacts times iterations of their solver, after which a whole step has no more trials: tenths of a second."""

SEARCH_EFFORT = 5
"""Iterations that cost as much as the search of a trial."""

SHORTEST = 1e-6
"""Of a whole step: an impact nearer to its start happens there."""

RESOLUTION = 1e-10
"""Of the size of a contact, that a gap is found to."""

PASSING = 0.999
"""Of a step: what has been nearest later than that is as near at its end."""

BEHIND = 1e-6
"""Relative rounding of a gap, and of the way in a step."""

AT_ONCE = 5e-10
"""Of a whole step: length of one that ends at an impact now; gaps are found to twice its way."""

CLOSE = 1e-6
"""Of the size of a contact: a gap below is searched in every step."""


@kernel(inline=True, internal=True)
def gap_tolerance(contacts: ContactRows, c: int, rate: float) -> float:
    """Gap that counts as none [m]: of the size of the contact, and of the way in a whole step."""
    return RESOLUTION * contacts.values[c].length_scale + 1e-9 * abs(rate) * contacts.control.nominal_step


@implement(before_advance, ContactRows)
@kernel(internal=True)
def before_contact_advance(contacts: ContactRows, bodies: Bodies, work: Workspace, step: float) -> None:
    """Copy of the state; then what the contacts do at the velocities of the middle."""
    save(contacts)
    add_row_work(bodies, 2.0, work, contacts)
    bound_motion(bodies, contacts, step, work)
    contacts.control.stopping_work = 0.0
    note_balance(contacts, work, step)
    for c in range(contact_count(contacts)):
        if not rests(contacts, c):
            _book_middle(contacts, c, work, step)
            contacts.state[c].shift = _shift(contacts, c, work, step)


@kernel(internal=True)
def _book_middle(contacts: ContactRows, c: int, work: Workspace, step: float) -> None:
    """Losses of friction and dampers, elastic slip; the half impulses are kept for the end."""
    state, values = contacts.state[c], contacts.values[c]
    impulse, half_impulse = contacts.rows[c].impulse, contacts.rows[c].half_impulse
    for r in range(3):
        half_impulse[r] = impulse[r]
    if not state.present:
        state.timed = state.paced = False
        return
    a, b, d = contact_rates(contacts, c, work.velocity)
    kind = contacts.table[c].law
    if kind == COMPLIANT:
        state.growth = step / (step + work.control.last_step) * (a - state.mean_rate)
        state.mean_rate, state.paced, state.timed = a, state.timed, True
    if contacts.table[c].shape_kind == TRIANGLES and kind == RIGID:
        state.step_loss -= 2.0 * impulse[0] * a  # rows that look ahead stop what still moves
        if not state.closed:
            across = impulse[1] * b + impulse[2] * d
            contacts.control.stopping_work += 2.0 * (impulse[0] * a + across)
    if kind == COMPLIANT:
        d0, d1 = -state.gap, -state.gap - step * a
        law, k, n = contacts.table[c].force_law, values.stiffness, values.exponent
        stored = stored_energy(law, k, n, d1) - stored_energy(law, k, n, d0)
        state.step_loss -= 2.0 * impulse[0] * a + stored
    if kind != CURVE:
        state.step_loss -= 2.0 * impulse[1] * b
    state.step_loss -= 2.0 * impulse[2] * d
    state.slip[0] += step * b
    state.slip[1] += step * d
    if kind == COMPLIANT:
        # the stiffness of the step: another one at its end is a jump
        kept = slip_energy(contacts, c)
        state.step_loss -= kept - state.kept
        state.kept = kept
    if impulse[0] != 0.0 or kind == CURVE:
        state.slip_path += step * (abs(d) if kind == CURVE else math.hypot(b, d))


@kernel(internal=True)
def _shift(contacts: ContactRows, c: int, work: Workspace, step: float) -> float:
    """How far contour and shape can have moved towards each other in the step [m]."""
    if contacts.table[c].shape_kind == TRIANGLES:
        other = contacts.table[c].axes
        return contacts.poses[contacts.table[c].contour].step_shift + contacts.poses[other].step_shift
    marker, axes = contacts.table[c].centre, contacts.table[c].axes
    dof, width = contacts.attachments[2 * c + 1].dof, contacts.attachments[2 * c + 1].width
    speed = turning = 0.0
    for m in range(-1, 3):
        if m >= 0 and axes < 0:
            break
        J = work.jacobian[marker if m < 0 else axes + m]
        square = 0.0
        for k in range(3):
            rate = 0.0
            for i in range(width):
                rate += J[k, i] * work.velocity[dof + i]
            square += rate * rate
        if m < 0:
            speed = math.sqrt(square)
        else:
            turning += square
    moved = step * (speed + math.sqrt(turning) * contacts.values[c].extent)
    return moved + contacts.poses[contacts.table[c].contour].step_shift


@implement(end_rows, ContactRows)
@kernel(internal=True)
def end_contact_rows(
    contacts: ContactRows, bodies: Bodies, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Search where a gap may have closed; ask for a shorter step if one without compliance has."""
    posed = False
    hold_places(contacts, bodies)
    for c in range(contacts.counts.of_contours):
        state = contacts.state[c]
        asleep, steady = state.sleep > 0.0, state.located
        state.sleep -= state.shift
        state.passed = 0.0
        nearest = min(state.gap, state.sleep + state.shift) - state.shift
        margin = (
            NEAR * state.shift
            if contacts.table[c].law == COMPLIANT
            else CLOSE * contacts.values[c].length_scale
        )
        if state.sleep > margin and not state.closed and not state.present:
            state.end_gap, state.located = state.sleep, False  # at least
            continue
        state.located = True
        if not posed:
            pose_contours(bodies, False, contacts)
            posed = True
        # far from where it was searched last another place may be nearer
        locate(contacts, bodies, c, asleep and not state.closed, work)
        if contacts.table[c].law == RIGID or contacts.table[c].law == COMPLIANT:
            _look_behind(contacts, c, nearest)
        if contacts.table[c].law == RIGID and contacts.table[c].events and not state.closed:
            rate = state.rate if steady else -state.shift / step
            state.passed = _passing_time(contacts, c, nearest + state.shift, rate, step, work)
        state.sleep = state.end_gap
    if contacts.counts.of_contours < contacts.table.shape[0]:
        if not posed:
            pose_contours(bodies, False, contacts)
            posed = True
        search_surfaces(contacts.meshes, contacts, bodies, work, step, False)
        if wake_reached(contacts):
            work.control.split = step  # again, with what has slept until now
            return
        _repeat_with_found(contacts, work, step)
    if posed:
        settle_points(bodies, (), False, work)
        _find_impact(contacts, work, step)


@kernel(internal=True)
def _repeat_with_found(contacts: ContactRows, work: Workspace, step: float) -> None:
    """What came in and had no row, because nothing had been near before, has one when the step is tried again.

    So has what was near, but not so near that its surfaces could have met as they moved before.
    """
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        if rests(contacts, c):
            continue
        early = looks_ahead(contacts, c) or contacts.table[c].law == COMPLIANT
        if c < contacts.control.known:
            early = contacts.table[c].law == RIGID and not contacts.table[c].events
            early = early and not contacts.state[c].near
        if early and contacts.state[c].hit > 0:
            rate = contact_rates(contacts, c, work.velocity)[0]
            inside = contacts.state[c].end_gap < -gap_tolerance(contacts, c, rate)
            if inside or contacts.state[c].passed > 0.0:
                work.control.split = step


@kernel(internal=True)
def _passing_time(
    contacts: ContactRows, c: int, start_gap: float, start_rate: float, step: float, work: Workspace
) -> float:
    """`passed` of a contact on a contour, whose gap began with a rate, or one that was not smaller.

    Notes
    -----
    On a straight way the distance from what is convex is a convex function of time, so it lies above its tangents at
    both ends: where these meet at a gap that is still open nothing has been touched.
    """
    end_gap = contacts.state[c].end_gap
    if start_gap <= 0.0 or end_gap <= 0.0 or start_rate >= 0.0:
        return 0.0
    end_rate = contact_rates(contacts, c, work.velocity)[0]
    if end_rate <= 0.0:
        return 0.0
    t = (start_gap - end_gap + end_rate * step) / (end_rate - start_rate)
    if start_gap + start_rate * t >= 0.0 or not SHORTEST * contacts.control.nominal_step < t < step:
        return 0.0
    return t / step


@kernel(internal=True)
def _look_behind(contacts: ContactRows, c: int, nearest: float) -> None:
    """An open contact that is inside, but could not have come through, has gone round a border and is behind.

    Notes
    -----
    A gap changes by no more than the way that both can have gone in the step. Contours have one side: what is behind
    them touches nothing until it has come round again, over a way of its distance and its radius at least.
    """
    state, values = contacts.state[c], contacts.values[c]
    if not state.closed and state.end_gap < nearest - BEHIND * (values.length_scale + abs(nearest)):
        state.end_gap = abs(state.end_gap)


@kernel(internal=True)
def _find_impact(contacts: ContactRows, work: Workspace, step: float) -> None:
    """Set `work.control.split` if an impact lies within the step, and keep its bracket."""
    control = contacts.control
    if control.exhausted:
        return
    most = TRIALS + TRIALS_OF_EACH * contact_count(contacts)
    if control.splits >= most or (control.splits > 0 and control.effort >= MOST_EFFORT):
        control.exhausted = True
        control.watched = -1
        work.control.split = step  # again, with what looks ahead
        return
    watched = control.watched
    if watched >= 0:
        state = contacts.state[watched]
        rate = contact_rates(contacts, watched, work.velocity)[0]
        if state.end_gap > gap_tolerance(contacts, watched, rate):
            # what lies beside its features is out of reach: no number for a secant
            in_reach = state.end_gap <= contacts.values[watched].length_scale
            control.low, control.low_gap = step, state.end_gap if in_reach else math.inf
    worst, worst_time, passing = -1, math.inf, math.inf
    for c in range(contact_count(contacts)):
        state = contacts.state[c]
        if contacts.table[c].law != RIGID or not contacts.table[c].events or state.closed:
            continue
        if rests(contacts, c):
            continue
        if state.passed > 0.0 and state.end_gap > 0.0 and state.recent_impacts < MOST_EVENTS:
            passing = min(passing, state.passed * step)
        if state.end_gap > 0.0 or state.recent_impacts >= MOST_EVENTS:
            continue
        rate = contact_rates(contacts, c, work.velocity)[0]
        if state.end_gap < -gap_tolerance(contacts, c, rate):
            guess = step - state.end_gap / rate if rate < 0.0 else 0.5 * step
            if guess < worst_time:
                worst, worst_time = c, guess
    # a time that is sought already is not given up for one that came out of another path
    early = SHORTEST * control.nominal_step < passing < PASSING * step
    if watched < 0 and passing < worst_time and early:
        control.splits += 1
        control.effort += float(SEARCH_EFFORT * contact_count(contacts))
        work.control.split = passing
        return
    if worst >= 0:
        if worst != watched:
            control.watched, control.low, control.low_gap = worst, 0.0, -1.0
            if watched < 0:
                control.longest_step = step
        control.high, control.high_gap = step, contacts.state[worst].end_gap
        control.high_rate = contact_rates(contacts, worst, work.velocity)[0]
    elif watched < 0 or control.low != step:
        control.watched = -1  # nothing is inside: the step stands
        return
    control.splits += 1
    control.effort += float(SEARCH_EFFORT * contact_count(contacts))
    _next_time(contacts, work, step)


@kernel(internal=True)
def _never_leaves(contacts: ContactRows, c: int, step: float, end_rate: float) -> bool:
    """Whether a contact that touches at the start of the step is not outside between that and its end."""
    state = contacts.state[c]
    tolerance = gap_tolerance(contacts, c, end_rate)
    if state.gap > tolerance:
        return False
    slowing = state.rate - end_rate
    if state.rate <= 0.0 or slowing <= 0.0:
        return True
    # highest point of a parabola with these rates
    return bool(state.gap + 0.5 * step * state.rate * state.rate / slowing <= tolerance)


@kernel(inline=True, internal=True)
def _hits_at_once(contacts: ContactRows, c: int) -> bool:
    """Whether a contact that touches at the start approaches too fast to be at rest there."""
    return -contacts.state[c].rate * contacts.control.nominal_step > CLOSE * contacts.values[c].length_scale


@kernel(internal=True)
def _mark_joining(contacts: ContactRows, step: float, work: Workspace) -> None:
    """Between surfaces many contacts begin to rest together: all of them join, not one in each repeated step."""
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        state = contacts.state[c]
        joins = False
        moves = not state.closed and not rests(contacts, c)
        if contacts.table[c].law == RIGID and contacts.table[c].events and moves:
            rate = contact_rates(contacts, c, work.velocity)[0]
            inside = state.end_gap < -gap_tolerance(contacts, c, rate)
            joins = inside and not _hits_at_once(contacts, c) and _never_leaves(contacts, c, step, rate)
        contacts.joining[c] = joins


@kernel(internal=True)
def _next_time(contacts: ContactRows, work: Workspace, step: float) -> None:
    """Time of the impact by Newton from the side that is inside, by the secant where that leaves the bracket."""
    control = contacts.control
    c = control.watched
    low, high = control.low, control.high
    t = high - control.high_gap / control.high_rate if control.high_rate < 0.0 else 0.5 * (low + high)
    if low > 0.0 and step == low and control.low_gap < math.inf:  # the last trial was short of it
        t = low + (high - low) * control.low_gap / (control.low_gap - control.high_gap)
    if not low < t < high or control.low_gap == math.inf:
        t = 0.5 * (low + high)
    if high - low <= 1e-12 * control.nominal_step and low > 0.0:
        if step != high:
            control.watched = -1
            return
        t = low
    elif low == 0.0 and (
        t < SHORTEST * control.nominal_step or _never_leaves(contacts, c, step, control.high_rate)
    ):
        if _hits_at_once(contacts, c):
            t = AT_ONCE * control.nominal_step  # hit by what another impact has done to its body
        else:
            control.joins = c
            _mark_joining(contacts, step, work)
            t = control.longest_step
    work.control.split = t


@implement(go_back, ContactRows)
@kernel(internal=True)
def go_back_to_copy(contacts: ContactRows) -> None:
    """All that the step has changed; a contact that touches joins the closed ones."""
    keep_found(contacts.meshes, contacts, True)
    put_back(contacts)
    keep_found(contacts.meshes, contacts, False)
    joins = contacts.control.joins
    if joins >= 0:
        contacts.state[joins].closed = True
        for c in range(contacts.counts.of_contours, contact_count(contacts)):
            if contacts.joining[c] > 0:
                contacts.state[c].closed = True
        contacts.control.joins = contacts.control.watched = -1


@implement(after_step, ContactRows)
@kernel(internal=True)
def after_contact_step(
    contacts: ContactRows, bodies: Bodies, work: Workspace, step: float, whole: bool
) -> None:
    """Brackets and counts belong to one step."""
    control = contacts.control
    if control.impact:
        forget_accelerations(bodies)
    control.impact = False
    control.watched = -1
    control.low = control.high = 0.0
    if whole:
        let_sleep(contacts, bodies)
        control.splits = 0
        control.effort = 0.0
        if control.exhausted:
            contacts.tally[0].exhausted_steps += 1
        control.exhausted = False
        for c in range(contact_count(contacts)):
            contacts.state[c].recent_impacts = 0
