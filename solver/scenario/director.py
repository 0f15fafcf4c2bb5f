"""Phases of an operation, evaluated at the end of each step: conditions, limits, winches, ropes that go and come.

A *signal* is a combination of columns of a record, which is written into a row of scratch after each step, so
whatever can be recorded can be waited for. A condition ``g(t) = x(t) - value >= 0`` that becomes true in a step from t0
to t1 does so at ``t0 + (t1 - t0) g0/(g0 - g1)``, off by a part of the square of the step. It holds for its time from
there on; the phase ends when all of its conditions have held, or any. What the next phase begins with jumps, so the
step is taken back and repeated up to that time, as where something hits, and the actions take place at its end: results
stay of second order. A copy of the state is kept for that, where contacts do not keep one.

A winch is told by rewriting its rows, between which its speed is linear: from speed v0 with acceleration a to a
length with the distance D to be hauled in, in the direction s at most with speed V::

    peak |v| = min(V, sqrt(s a D + v0^2 / 2)),     rest of the way at V

(the sum of the distances of speeding up and slowing down, ``s (2 v^2 - v0^2) / (2 a)``, is D). The last row has the
length that was asked for.

A rope lets go by losing its stiffness: what the scene stores less then counts as dissipated. One that is connected gets
the length of its path and its slack; what less than no slack stores is work of its winch.
"""

from __future__ import annotations

import math
from typing import ClassVar

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.records import Record, Records
from heavylift.solver.integrate.loop import TOTAL_COLUMNS, write_record
from heavylift.solver.interface import (
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    add_forces,
    record_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.laws.wire_rope import RopeEntry, Ropes, WinchRow, winch_state
from heavylift.solver.scenario.interface import direct, keep_state, take_back

__all__ = [
    "ACTION",
    "BEGUN",
    "CONNECT",
    "DONE",
    "ENDED",
    "FUNCTIONS",
    "LIMIT_STOP",
    "LIMIT_WARNING",
    "NOTE",
    "NOT_CONNECTED",
    "RELEASE",
    "ROPE_USED_UP",
    "TIMED_OUT",
    "WINCH_LENGTH",
    "WINCH_ROWS",
    "WINCH_SPEED",
    "ActionEntry",
    "ConditionEntry",
    "Director",
    "DirectorState",
    "GivenRope",
    "LimitEntry",
    "LogEntry",
    "PhaseEntry",
    "SignalEntry",
    "TermEntry",
    "Timer",
    "Worst",
    "begin_scenario",
    "plan_length",
]

FUNCTIONS = ("sum", "norm", "largest", "smallest")
"""Of signals, by their numbers."""
SUM, NORM, LARGEST, SMALLEST = range(4)
WINCH_SPEED, WINCH_LENGTH, RELEASE, CONNECT, NOTE = range(5)
"""Actions."""
BEGUN, ACTION, DONE, LIMIT_WARNING, LIMIT_STOP, TIMED_OUT, ROPE_USED_UP, NOT_CONNECTED = range(8)
"""Events of the log."""

WINCH_ROWS = 4
"""Of a winch that is told what to do."""

ENDED = -1
"""In place of an outcome: the last phase is done and the run ends with it."""

LIMIT = int(Outcome.LIMIT_REACHED)
TIMEOUT = int(Outcome.TIMED_OUT)

ELASTIC = 1
"""Place of the elastic energy among the totals of a record."""

SHORTEST = 1e-6
"""Of a step: an event nearer to its start happens there, one nearer to its end at the end."""

LARGEST_STRAIN = 0.02
"""By which a rope that is connected may be shorter than its path."""


class PhaseEntry(Record):
    """First of its actions, conditions and limits, and how many; whether any condition ends it; time limit [s]."""

    first_action: int
    actions: int
    first_condition: int
    conditions: int
    first_limit: int
    limits: int
    any_of: bool
    timeout: float


class ConditionEntry(Record):
    """Signal, -1 for the time in the phase; whether it is true below the value; time that it has to hold [s]."""

    signal: int
    below: bool
    value: float
    hold: float


class LimitEntry(Record):
    """Signal; whether it is kept below the value; whether the run ends where it is not."""

    signal: int
    below: bool
    value: float
    stop: bool


class SignalEntry(Record):
    """First of its terms, how many, and their function."""

    first: int
    terms: int
    function: int


class TermEntry(Record):
    """Column of a record, and weight."""

    column: int
    weight: float


class ActionEntry(Record):
    """What, with which rope; speed [m/s], length or slack [m]; speed at most [m/s]; ramp [s]."""

    action: int
    rope: int
    value: float
    speed: float
    ramp: float


class GivenRope(Record):
    """A rope.

    Attributes
    ----------
    second, number
        Whether it is of the second kind of ropes, and its number there.
    axial_stiffness, damping
        EA [N] and damping [N s/m] while it is connected.
    commanded
        Whether its winch is told what to do.
    """

    second: bool
    number: int
    axial_stiffness: float
    damping: float
    commanded: bool


class Timer(Record):
    """Of a condition: when it became true [s], not a number while it is false; the same of the step that is tried."""

    since: float
    trial: float


class Worst(Record):
    """Of a limit: whether it was passed in this phase."""

    passed: bool


class LogEntry(Record):
    """Time [s], event, number of the phase from 0, number of the action, limit or rope, value."""

    time: float
    event: int
    phase: int
    item: int
    value: float


class DirectorState(Record):
    """How far the operation is; carried.

    Attributes
    ----------
    phase
        Number from 1; 0 before the scenario begins, one more than there are when all are done.
    begun
        When the phase began [s].
    due
        When the step that is repeated ends [s], or 0.
    logged
        Lines of the log.
    outcome
        With which the run ends, `ENDED`, or 0.
    """

    phase: int
    begun: float
    due: float
    logged: int
    outcome: int


class Director(Arrays):
    """The scenario of a scene.

    Attributes
    ----------
    phases, conditions, limits, actions, signals, terms
        What was said.
    given
        Of each wire rope of the scene.
    ropes, others
        Both kinds of ropes, empty if there is none: with one tension, and over sheaves that rub.
    rope_table, winches, other_table, other_winches
        Theirs, which actions change, and which are carried for that.
    state, timers, passed, values, log
        What is carried; values of all signals at the end of the last step.
    trial
        Those of the step that is looked at.
    row
        Record of scratch.
    column
        Record column of the number of the phase.
    stops_at_end
        Whether the run ends with the last phase.
    carried, saved
        What a step changes, and its copy; empty where contacts keep one.
    """

    carried_fields: ClassVar[tuple[str, ...]] = (
        "state",
        "timers",
        "passed",
        "values",
        "log",
        "rope_table",
        "winches",
        "other_table",
        "other_winches",
    )

    phases: Records[PhaseEntry]
    conditions: Records[ConditionEntry]
    limits: Records[LimitEntry]
    actions: Records[ActionEntry]
    signals: Records[SignalEntry]
    terms: Records[TermEntry]
    given: Records[GivenRope]
    ropes: Ropes
    others: Ropes
    rope_table: Records[RopeEntry]
    winches: Records[WinchRow]
    other_table: Records[RopeEntry]
    other_winches: Records[WinchRow]
    state: DirectorState
    timers: Records[Timer]
    passed: Records[Worst]
    values: Floats1
    log: Records[LogEntry]
    trial: Floats1
    row: Floats1
    column: int
    stops_at_end: bool
    carried: Floats1
    saved: Floats1


@implement(add_forces, Director)
@kernel(internal=True)
def add_nothing(kind: Director, time: float, work: Workspace) -> None:
    """It acts through what it commands."""


@implement(record_forces, Director)
@kernel(internal=True)
def record_phase(kind: Director, time: float, work: Workspace, row: Floats1) -> None:
    """Number of the phase."""
    row[kind.column] = kind.state.phase


@implement(keep_state, Director)
@kernel(internal=True)
def keep_copy(kind: Director) -> None:
    """Of all that a step changes."""
    for i in range(kind.carried.shape[0]):
        kind.saved[i] = kind.carried[i]


@implement(take_back, Director)
@kernel(internal=True)
def restore_copy(kind: Director) -> None:
    """As it was before the step."""
    for i in range(kind.carried.shape[0]):
        kind.carried[i] = kind.saved[i]


@kernel(internal=True)
def _note(kind: Director, time: float, event: int, item: int, value: float) -> None:
    """A line in the log, which has room for all that can happen."""
    state = kind.state
    if state.logged < kind.log.shape[0]:
        line = kind.log[state.logged]
        line.time, line.event, line.phase = time, event, state.phase - 1
        line.item, line.value = item, value
        state.logged += 1


@kernel(inline=True, internal=True)
def _margin(below: bool, value: float, x: float) -> float:
    """How far inside of what is wanted; negative outside."""
    return value - x if below else x - value


@kernel(internal=True)
def _measure(
    kind: Director,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
) -> None:
    """All signals, from a record of the carried state."""
    write_record(bodies, forces, joints, systems, work, time, kind.row)
    for s in range(kind.signals.shape[0]):
        first, count = kind.signals[s].first, kind.signals[s].terms
        function = kind.signals[s].function
        found = 0.0
        for i in range(first, first + count):
            x = kind.terms[i].weight * kind.row[kind.terms[i].column]
            if function == SUM:
                found += x
            elif function == NORM:
                found += x * x
            elif i == first or (x > found if function == LARGEST else x < found):
                found = x
        kind.trial[s] = math.sqrt(found) if function == NORM else found


@kernel(internal=True)
def _end_of_phase(kind: Director, start: float, end: float) -> float:
    """When the phase ends [s], not before the start of the step; infinite if its conditions do not hold at the end."""
    phase = kind.phases[kind.state.phase - 1]
    if phase.conditions == 0:
        return math.inf
    found = -math.inf
    if phase.any_of:
        found = math.inf
    for c in range(phase.first_condition, phase.first_condition + phase.conditions):
        condition, timer = kind.conditions[c], kind.timers[c]
        if condition.signal < 0:
            before, now = start - kind.state.begun, end - kind.state.begun
        else:
            before, now = kind.values[condition.signal], kind.trial[condition.signal]
        before = _margin(condition.below, condition.value, before)
        now = _margin(condition.below, condition.value, now)
        ready = math.inf
        if now >= 0.0:
            since = timer.since
            if math.isnan(since):
                since = start
                if before < 0.0:
                    since = start + (end - start) * before / (before - now)
            timer.trial = since
            ready = since + condition.hold
        else:
            timer.trial = math.nan
        found = min(found, ready) if phase.any_of else max(found, ready)
    return max(found, start)


@kernel
def plan_length(hauled: float, speed: float, target: float, most: float, ramp: float, rows: Floats1) -> int:
    """Trapezoid of speeds from a present one to rest at a length.

    Parameters
    ----------
    hauled, speed
        Length hauled in [m] and speed [m/s] now.
    target
        Length hauled in at the end [m].
    most, ramp
        Speed at most [m/s], and time from rest to it [s]; 0 is at once.
    rows
        Receives times from now on [s], speeds and lengths hauled in, four each, shape (12,).

    Returns
    -------
    int
        Number of rows, 4.
    """
    way = target - hauled
    t1 = t2 = t3 = d1 = 0.0
    if ramp > 0.0:
        a = most / ramp
        s = 1.0 if way - 0.5 * speed * abs(speed) / a >= 0.0 else -1.0
        peak = min(most, math.sqrt(max(0.0, s * a * way + 0.5 * speed * speed)))
        t1, t3 = abs(s * peak - speed) / a, peak / a
        d1 = 0.5 * (speed + s * peak) * t1
        rest = s * (way - d1) - 0.5 * peak * t3
    else:
        s = 1.0 if way >= 0.0 else -1.0
        peak, rest = most, abs(way)
    if peak > 0.0:
        t2 = max(0.0, rest) / peak
    rows[0], rows[4], rows[8] = 0.0, speed, hauled
    rows[1], rows[5], rows[9] = t1, s * peak, hauled + d1
    rows[2], rows[6], rows[10] = t1 + t2, s * peak, target - s * 0.5 * peak * t3
    rows[3], rows[7], rows[11] = t1 + t2 + t3, 0.0, target
    return 4


@kernel(internal=True)
def _put_row(row: WinchRow, time: float, speed: float, hauled: float) -> None:
    """A row from which on the speed is linear, whatever it was before."""
    words = row.words
    for k in range(words.shape[0]):
        words[k] = 0.0
    row.time, row.speed, row.hauled = time, speed, hauled


@kernel(internal=True)
def _hold_last(ropes: Ropes, i: int, count: int) -> None:
    """Rows of a winch behind those that say something are as the last of these."""
    first, rows = ropes.table[i].winch, ropes.winches
    last = rows[first + count - 1]
    for k in range(count, ropes.table[i].winch_rows):
        _put_row(rows[first + k], last.time, last.speed, last.hauled)


@kernel(internal=True)
def _set_speed(ropes: Ropes, i: int, time: float, target: float, ramp: float) -> None:
    """A winch comes to a speed within a ramp."""
    hauled, speed = winch_state(ropes, i, time)
    first = ropes.table[i].winch
    _put_row(ropes.winches[first], time, speed, hauled)
    _put_row(ropes.winches[first + 1], time + ramp, target, hauled + 0.5 * (speed + target) * ramp)
    _hold_last(ropes, i, 2)


@kernel(internal=True)
def _set_length(
    ropes: Ropes, i: int, time: float, length: float, most: float, ramp: float, plan: Floats1
) -> None:
    """A winch goes to a length."""
    hauled, speed = winch_state(ropes, i, time)
    first = ropes.table[i].winch
    count = plan_length(hauled, speed, ropes.table[i].start_length - length, most, ramp, plan)
    for k in range(count):
        _put_row(ropes.winches[first + k], time + plan[k], plan[4 + k], plan[8 + k])
    _hold_last(ropes, i, count)


@kernel(inline=True, internal=True)
def _stored(kind: Director) -> float:
    """Elastic energy of the last record [J]."""
    return kind.row[kind.row.shape[0] - TOTAL_COLUMNS + ELASTIC]


@kernel(internal=True)
def _let_go(ropes: Ropes, i: int) -> None:
    """A rope does nothing from now on."""
    entry, state = ropes.table[i], ropes.state[i]
    entry.axial_stiffness = entry.damping = 0.0
    state.tension = 0.0


@kernel(internal=True)
def _hold(ropes: Ropes, i: int, given: GivenRope, time: float, path: float, slack: float) -> float:
    """A rope holds from now on; its unstretched length [m], negative if it would be too short for its path."""
    entry, state = ropes.table[i], ropes.state[i]
    rest = path + slack
    if not path <= rest * (1.0 + LARGEST_STRAIN):
        return -rest
    entry.axial_stiffness, entry.damping = given.axial_stiffness, given.damping
    hauled, _ = winch_state(ropes, i, time)
    entry.start_length = rest + hauled
    state.stretched, state.rest, state.next_rest = path, rest, rest
    state.rate = state.growth = state.drift = 0.0
    state.fresh, state.paced = True, False
    return rest


@kernel(internal=True)
def _act(
    kind: Director,
    ropes: Ropes,
    action: ActionEntry,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
) -> float:
    """Do something with a rope of a kind; a value for the log, negative for a connection that is too short."""
    given = kind.given[action.rope]
    i = given.number
    if action.action == WINCH_SPEED:
        _set_speed(ropes, i, time, action.value, action.ramp)
        return action.value
    if action.action == WINCH_LENGTH:
        # the record that is in the row has been looked at
        _set_length(ropes, i, time, action.value, action.speed, action.ramp, kind.row)
        return action.value
    _measure(kind, forces, bodies, joints, systems, work, time)
    before = _stored(kind)
    value = 0.0
    if action.action == RELEASE:
        _let_go(ropes, i)
    else:
        value = _hold(ropes, i, given, time, kind.row[ropes.table[i].column + 1], action.value)
        if value <= 0.0:
            return value
    _measure(kind, forces, bodies, joints, systems, work, time)
    gained = _stored(kind) - before
    if action.action == RELEASE:
        ropes.state[i].loss -= gained
        return -gained
    ropes.state[i].winch_work += gained
    return value


@kernel(internal=True)
def _begin_phase(
    kind: Director,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
) -> None:
    """Actions of the phase that begins, and its timers; the record of this time has been written."""
    state = kind.state
    state.begun = time
    phase = kind.phases[state.phase - 1]
    _note(kind, time, BEGUN, -1, 0.0)
    for c in range(phase.first_condition, phase.first_condition + phase.conditions):
        kind.timers[c].since = kind.timers[c].trial = math.nan
    for a in range(phase.first_action, phase.first_action + phase.actions):
        action = kind.actions[a]
        value = 0.0
        if action.action != NOTE:
            ropes = kind.ropes
            if kind.given[action.rope].second:
                ropes = kind.others
            value = _act(kind, ropes, action, forces, bodies, joints, systems, work, time)
            if action.action == CONNECT and value <= 0.0:
                _note(kind, time, NOT_CONNECTED, action.rope, -value)
                state.outcome = LIMIT
                return
        _note(kind, time, ACTION, a, value)
    _measure(kind, forces, bodies, joints, systems, work, time)
    for s in range(kind.values.shape[0]):
        kind.values[s] = kind.trial[s]


@kernel(internal=True)
def _watch_ropes(kind: Director, time: float, step: float) -> None:
    """End the run before a winch has hauled in the whole rope."""
    for k in range(kind.given.shape[0]):
        if not kind.given[k].commanded:
            continue
        ropes, i = kind.ropes, kind.given[k].number
        if kind.given[k].second:
            ropes = kind.others
        _, speed = winch_state(ropes, i, time)
        rest = ropes.state[i].rest
        if rest <= 2.0 * step * speed:
            _note(kind, time, ROPE_USED_UP, k, rest)
            _set_speed(ropes, i, time, 0.0, 0.0)
            kind.state.outcome = LIMIT


@kernel(internal=True)
def _watch_limits(kind: Director, time: float) -> None:
    """Limits of the phase, each told once."""
    phase = kind.phases[kind.state.phase - 1]
    for i in range(phase.first_limit, phase.first_limit + phase.limits):
        limit = kind.limits[i]
        x = kind.trial[limit.signal]
        if kind.passed[i].passed or _margin(limit.below, limit.value, x) >= 0.0:
            continue
        kind.passed[i].passed = True
        _note(kind, time, LIMIT_STOP if limit.stop else LIMIT_WARNING, i, x)
        if limit.stop:
            kind.state.outcome = LIMIT


@implement(direct, Director)
@kernel(internal=True)
def direct_phases(
    kind: Director,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
    step: float,
    recorded: bool,
) -> None:
    """Where the operation stands at the end of a step."""
    state = kind.state
    if state.phase == 0:
        return
    end = time + step
    if state.outcome == 0:
        _watch_ropes(kind, end, step)
    if state.outcome == 0 and state.phase <= kind.phases.shape[0]:
        _measure(kind, forces, bodies, joints, systems, work, end)
        ends = _end_of_phase(kind, time, end)
        if state.due > 0.0 and abs(end - state.due) <= SHORTEST * step + 1e-14 * end:
            ends = end
        state.due = 0.0
        if ends < end - SHORTEST * step:
            work.control.split = max(ends - time, SHORTEST * step)
            state.due = time + work.control.split
            return
        for s in range(kind.values.shape[0]):
            kind.values[s] = kind.trial[s]
        for c in range(kind.timers.shape[0]):
            kind.timers[c].since = kind.timers[c].trial
        _watch_limits(kind, end)
        phase = kind.phases[state.phase - 1]
        if state.outcome == 0 and ends <= end + SHORTEST * step:
            _note(kind, end, DONE, -1, end - state.begun)
            state.phase += 1
            if state.phase <= kind.phases.shape[0]:
                _begin_phase(kind, forces, bodies, joints, systems, work, end)
            elif kind.stops_at_end:
                state.outcome = ENDED
        elif state.outcome == 0 and end - state.begun >= phase.timeout * (1.0 - 1e-12):
            _note(kind, end, TIMED_OUT, -1, end - state.begun)
            state.outcome = TIMEOUT
    if recorded and state.outcome != 0:
        work.status.outcome = state.outcome


@entry
def begin_scenario(
    kind: Director, forces: Forces, bodies: Bodies, joints: Joints, systems: Systems, work: Workspace
) -> None:
    """Signals at the start, and the actions of the first phase."""
    _measure(kind, forces, bodies, joints, systems, work, 0.0)
    kind.state.phase = 1
    _begin_phase(kind, forces, bodies, joints, systems, work, 0.0)
