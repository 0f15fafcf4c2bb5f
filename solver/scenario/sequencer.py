"""Phases of an operation, evaluated at the end of each step: conditions, limits, and what moves.

A *signal* is a combination of columns of a record, which is written into a row of scratch after each step, so
whatever can be recorded can be waited for. A condition ``g(t) = x(t) - value >= 0`` that becomes true in a step from t0
to t1 does so at ``t0 + (t1 - t0) g0/(g0 - g1)``, off by a part of the square of the step. It holds for its time from
there on; the phase ends when all of its conditions have held, or any. What the next phase begins with jumps, so the
step is taken back and repeated up to that time, as where something hits, and the actions take place at its end: results
stay of second order. A copy of the state is kept for that, where contacts do not keep one. Phases stand in *tracks*,
rows of their own that go on beside each other.

What can be commanded to move is an *actuator*: the winch of a rope, a drive of a joint or of a frame, the pump of a
tank, a transporter on its path. A move is planned once, as cubics in time (`plan_speed`, `plan_move`), and written into
the table that the actuator reads anyway: rows of a winch, a profile, levels of a tank, pieces of a path.

Between its legs a transporter stands, since its wheels turn there. So with a commanded speed it moves to the end of
its leg and stops there; and it brakes harder than commanded if it would not stop before.

A rope lets go by losing its stiffness: what the scene stores less then counts as dissipated. One that is connected gets
the length of its path and its slack; what less than no slack stores is work of its winch. A joint lets go by becoming
so soft that its rows are none; what its compliance has stored is lost.
"""

from __future__ import annotations

import math
from typing import ClassVar

from heavylift.numerics.arrays import Arrays, Floats1, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.records import LaneRecords, Record, Records
from heavylift.solver.drive import profile_value
from heavylift.solver.force_elements.winch_control import (
    CONSTANT,
    LEVEL,
    PLANNED,
    ControlledRopes,
    ControlState,
    WinchControl,
)
from heavylift.solver.force_elements.wire_rope import RopeEntry, Ropes, WinchRow, rope_outputs, winch_state
from heavylift.solver.integrate.loop import TOTAL_WIDTH, total_outputs, write_record
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
from heavylift.solver.recording import outputs_at, part
from heavylift.solver.rows.structure import ABSENT, Row
from heavylift.solver.scenario.interface import direct, keep_state, take_back
from heavylift.solver.scenario.moves import (
    ARRIVED_PART,
    ActionEntry,
    MoveRow,
    plan_command,
    plan_leg,
    plan_speed,
)
from heavylift.solver.scene.channels import PhaseOutputs, TrackOutputs
from heavylift.solver.scene.operations import (
    BRAKE,
    CONNECT,
    FAIL,
    FOLLOW,
    GO_BY,
    GO_TO,
    KEEP,
    KEEP_LEVEL,
    MOVES,
    NOTHING,
    RELEASE,
    RELEASE_JOINT,
    SPEED,
)
from heavylift.solver.scene.speed_profiles import FOREVER
from heavylift.solver.transport.path_distances import way_on_pieces
from heavylift.solver.transport.transporters import GroupData, GroupState, VehicleData, VehicleState
from heavylift.solver.water.hulls.kind import PumpData, PumpRow, TankData, TankLevel
from heavylift.solver.water.hulls.tanks import pumped_behind

__all__ = [
    "ACTION",
    "BEGUN",
    "DONE",
    "DRIVE",
    "DRIVE_BREAKS",
    "ENDED",
    "FAILS_ACTUATOR",
    "FAILS_LEVELLING",
    "FAILS_PUMP",
    "FUNCTIONS",
    "HELD_ROPE",
    "LIMIT_STOP",
    "LIMIT_WARNING",
    "NOT_CONNECTED",
    "PATH",
    "PLAIN_ROPE",
    "ROPE_USED_UP",
    "RUBBING_ROPE",
    "TANK",
    "TIMED_OUT",
    "TOLD",
    "WORDS",
    "Actuator",
    "ActuatorState",
    "ConditionEntry",
    "LimitEntry",
    "LogEntry",
    "PathPieces",
    "PhaseEntry",
    "Sequencer",
    "SequencerState",
    "SignalEntry",
    "TermEntry",
    "Timer",
    "TrackEntry",
    "TrackState",
    "Worst",
    "begin_scenario",
    "write_levels",
    "write_profile",
    "write_winch",
]

FUNCTIONS = ("sum", "norm", "largest", "smallest", "arrived", "told")
"""Of signals, by their numbers. `arrived`: time since the last of some actuators came to rest at its commanded
position; `told`: whether the operator has sent "continue" since the phase began that waits for it."""
SUM, NORM, LARGEST, SMALLEST, ARRIVED, CONTINUED = range(6)
BEGUN, ACTION, DONE, LIMIT_WARNING, LIMIT_STOP, TIMED_OUT, ROPE_USED_UP, NOT_CONNECTED, TOLD = range(9)
"""Events of the log."""
WORDS = ("continue", "hold", "stop")
"""Operator commands, by number."""
PLAIN_ROPE, RUBBING_ROPE, HELD_ROPE, TANK, DRIVE, PATH = range(6)
"""Sorts of actuators."""
FAILS_ACTUATOR, FAILS_PUMP, FAILS_LEVELLING = range(3)
"""What fails, or works again: an actuator, a pump that a controller tells, the levelling of a transporter."""

DRIVE_BREAKS = 12
"""Of the profile of a commanded drive, at least."""

ENDED = -1
"""In place of an outcome: the last phase is done and the run ends with it."""

LIMIT = int(Outcome.LIMIT_REACHED)
TIMEOUT = int(Outcome.TIMED_OUT)

phase_outputs = outputs_at(PhaseOutputs)

SHORTEST = 1e-6
"""Of a step: an event nearer to its start happens there, one nearer to its end at the end."""

LARGEST_STRAIN = 0.02
"""By which a rope that is connected may be shorter than its path."""


class TrackEntry(Record):
    """First of its phases, and how many."""

    first: int
    phases: int


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
    """Column of a record, or number of an actuator; and weight."""

    column: int
    weight: float


class Actuator(Record):
    """What can be commanded to move.

    Attributes
    ----------
    sort, number
        Sort, and number in its kind; of a drive where its profile begins.
    axial_stiffness, damping
        Of a rope EA [N] and damping [N s/m] while it is connected.
    commanded
        Whether it is commanded.
    """

    sort: int
    number: int
    axial_stiffness: float
    damping: float
    commanded: bool


class ActuatorState(Record):
    """Number of the winch that it follows or -1, ratio to that; when it is at rest at its commanded position [s]."""

    leader: int
    ratio: float
    arrives: float


class PathPieces(Record):
    """Pieces of a path: the first of them, and how many."""

    first: int
    count: int


class Timer(Record):
    """Of a condition: when it became true [s], not a number while it is false; the same of the step that is tried."""

    since: float
    trial: float


class Worst(Record):
    """Of a limit: whether it was passed in this phase."""

    passed: bool


class LogEntry(Record):
    """Time [s], event, number of the phase from 0, number of the action, limit or actuator, value."""

    time: float
    event: int
    phase: int
    item: int
    value: float


class TrackState(Record):
    """How far a track is.

    Attributes
    ----------
    phase
        Number from 1; 0 before the scenario begins, one more than there are when all are done.
    begun
        When the phase began [s].
    rested
        How long "hold" from outside has kept it [s]: what its timeout does not count.
    ends
        When it ends, of the step that is looked at [s].
    """

    phase: int
    begun: float
    rested: float
    ends: float


class SequencerState(Record):
    """How far the operation is; carried.

    Attributes
    ----------
    due, due_track
        When the step that is repeated ends [s], or 0; and the track whose phase ends then.
    logged
        Lines of the log.
    outcome
        With which the run ends, `ENDED`, or 0.
    held
        Whether the operator has sent "hold".
    continued
        When the operator last sent "continue" that a phase may wait for [s]; minus infinity before.
    """

    due: float
    due_track: int
    logged: int
    outcome: int
    held: bool
    continued: float


class Sequencer(Arrays):
    """The scenario of a scene.

    Attributes
    ----------
    tracks, phases, conditions, limits, actions, signals, terms
        The scenario.
    actuators
        First the wire ropes of the scene, then its commanded tanks and drives.
    ropes, rubbing, held, controlled
        The kinds of ropes, empty if there is none: with one tension, over sheaves that rub, and with a winch that
        answers to the tension, twice.
    rope_table, winches, rubbing_table, rubbing_winches, held_table, held_winches, controls, control_state
        Theirs, which actions change, and which are carried for that.
    tanks, levels
        Of the hulls.
    pumps, pump_rows
        Of the hulls: those that fail are carried.
    vehicles, groups, group_state, vehicle_state
        Of the transporters, whose levelling may fail.
    profiles
        Of the drives; carried.
    paths, path_pieces, path_legs, path_plan
        Paths of transporters: theirs, and pieces as they were planned. Pieces are carried.
    state, track_state, mover_state, timers, passed, values, log
        What is carried; values of all signals at the end of the last step.
    trial
        Those of the step that is looked at.
    joint_rows, lanes
        Rows of the joints, and how many there are in a block.
    record, plan
        Record of scratch, and a plan.
    column
        Record column of the number of the phase of the first track; those of the others are behind it.
    stops_at_end
        Whether the run ends with the last phase.
    carried, saved
        What a step changes, and its copy; empty where contacts keep one.
    """

    carried_fields: ClassVar[tuple[str, ...]] = (
        "state",
        "track_state",
        "actuator_state",
        "timers",
        "passed",
        "values",
        "log",
        "rope_table",
        "winches",
        "rubbing_table",
        "rubbing_winches",
        "held_table",
        "held_winches",
        "controls",
        "levels",
        "pumps",
        "profiles",
        "path_pieces",
    )

    tracks: Records[TrackEntry]
    phases: Records[PhaseEntry]
    conditions: Records[ConditionEntry]
    limits: Records[LimitEntry]
    actions: Records[ActionEntry]
    signals: Records[SignalEntry]
    terms: Records[TermEntry]
    actuators: Records[Actuator]
    ropes: Ropes
    rubbing: Ropes
    held: Ropes
    controlled: ControlledRopes
    rope_table: Records[RopeEntry]
    winches: Records[WinchRow]
    rubbing_table: Records[RopeEntry]
    rubbing_winches: Records[WinchRow]
    held_table: Records[RopeEntry]
    held_winches: Records[WinchRow]
    controls: Records[WinchControl]
    control_state: Records[ControlState]
    tanks: Records[TankData]
    levels: Records[TankLevel]
    pumps: Records[PumpData]
    pump_rows: Records[PumpRow]
    vehicles: Records[VehicleData]
    groups: Records[GroupData]
    group_state: Records[GroupState]
    vehicle_state: Records[VehicleState]
    profiles: Floats1
    paths: Records[PathPieces]
    path_pieces: Floats2
    path_legs: Floats2
    path_plan: Floats2
    state: SequencerState
    track_state: Records[TrackState]
    actuator_state: Records[ActuatorState]
    timers: Records[Timer]
    passed: Records[Worst]
    values: Floats1
    log: Records[LogEntry]
    trial: Floats1
    joint_rows: LaneRecords[Row]
    lanes: int
    record: Floats1
    plan: Records[MoveRow]
    column: int
    beside: TrackOutputs
    stops_at_end: bool
    carried: Floats1
    saved: Floats1


@implement(add_forces, Sequencer)
@kernel(internal=True)
def add_nothing(kind: Sequencer, time: float, work: Workspace) -> None:
    """It acts through what it commands."""


@implement(record_forces, Sequencer)
@kernel(internal=True)
def record_phase(kind: Sequencer, time: float, work: Workspace, row: Floats1) -> None:
    """Numbers of the phases of all tracks."""
    phase_outputs(row, kind.column).phase = kind.track_state[0].phase
    beside = part(row, kind.beside.track_phase)
    for track in range(1, kind.tracks.shape[0]):
        beside[track - 1] = kind.track_state[track].phase


@implement(keep_state, Sequencer)
@kernel(internal=True)
def keep_copy(kind: Sequencer) -> None:
    """Of all that a step changes."""
    for i in range(kind.carried.shape[0]):
        kind.saved[i] = kind.carried[i]


@implement(take_back, Sequencer)
@kernel(internal=True)
def restore_copy(kind: Sequencer) -> None:
    """As it was before the step."""
    for i in range(kind.carried.shape[0]):
        kind.carried[i] = kind.saved[i]


@kernel(internal=True)
def _note(kind: Sequencer, time: float, event: int, phase: int, item: int, value: float) -> None:
    """A line in the log, which has room for all that can happen."""
    state = kind.state
    if state.logged < kind.log.shape[0]:
        line = kind.log[state.logged]
        line.time, line.event, line.phase = time, event, phase
        line.item, line.value = item, value
        state.logged += 1


@kernel(inline=True, internal=True)
def _margin(below: bool, value: float, x: float) -> float:
    """How far inside of what is wanted; negative outside."""
    return value - x if below else x - value


@kernel(internal=True)
def _arrived(kind: Sequencer, first: int, count: int, time: float) -> float:
    """Time since the last of some actuators came to rest [s]; minus infinity if one has no place to go to."""
    last = -math.inf
    for i in range(first, first + count):
        last = max(last, kind.actuator_state[kind.terms[i].column].arrives)
    return time - last


@kernel(inline=True, internal=True)
def _recorded(kind: Sequencer, term: int) -> float:
    """What a term of a signal is of, in the record of scratch: a column of any channel."""
    return kind.record[kind.terms[term].column]


@kernel(internal=True)
def _measure(
    kind: Sequencer,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
) -> None:
    """All signals, from a record of the carried state."""
    write_record(bodies, forces, joints, systems, work, time, kind.record)
    for s in range(kind.signals.shape[0]):
        first, count = kind.signals[s].first, kind.signals[s].terms
        function = kind.signals[s].function
        found = 0.0
        if function == ARRIVED:
            kind.trial[s] = _arrived(kind, first, count, time)
            continue
        if function == CONTINUED:
            kind.trial[s] = 0.0  # its conditions use the time of the command
            continue
        for i in range(first, first + count):
            x = kind.terms[i].weight * _recorded(kind, i)
            if function == SUM:
                found += x
            elif function == NORM:
                found += x * x
            elif i == first or (x > found if function == LARGEST else x < found):
                found = x
        kind.trial[s] = math.sqrt(found) if function == NORM else found


@kernel(inline=True, internal=True)
def _is_time(kind: Sequencer, signal: int) -> bool:
    """Whether a signal is a time, which goes on as long as the step is."""
    return signal < 0 or kind.signals[signal].function == ARRIVED


@kernel(internal=True)
def _end_of_phase(kind: Sequencer, track: int, start: float, end: float) -> float:
    """When the phase ends [s], not before the start of the step; infinite if its conditions do not hold at the end."""
    spec, state = kind.tracks[track], kind.track_state[track]
    if state.phase > spec.phases:
        return math.inf
    phase = kind.phases[spec.first + state.phase - 1]
    if phase.conditions == 0:
        return math.inf
    found = -math.inf
    if phase.any_of:
        found = math.inf
    for c in range(phase.first_condition, phase.first_condition + phase.conditions):
        condition, timer = kind.conditions[c], kind.timers[c]
        if condition.signal < 0:
            before, now = start - state.begun, end - state.begun
        elif kind.signals[condition.signal].function == CONTINUED:
            before = now = 1.0 if kind.state.continued >= state.begun else 0.0
        else:
            before, now = kind.values[condition.signal], kind.trial[condition.signal]
        before = _margin(condition.below, condition.value, before)
        now = _margin(condition.below, condition.value, now)
        ready = math.inf
        if now >= -(SHORTEST * (end - start) if _is_time(kind, condition.signal) else 0.0):
            since = timer.since
            if math.isnan(since):
                since = start
                if before < 0.0:  # a time that rounding has put behind the end of the step is at its end
                    since = start + (end - start) * before / (before - now)
            timer.trial = since
            ready = since + condition.hold
        else:
            timer.trial = math.nan
        found = min(found, ready) if phase.any_of else max(found, ready)
    return math.inf if kind.state.held else max(found, start)


@kernel(internal=True)
def _ropes_of(kind: Sequencer, sort: int) -> Ropes:
    """Kind of the ropes of a sort."""
    if sort == RUBBING_ROPE:
        return kind.rubbing
    if sort == HELD_ROPE:
        return kind.held
    return kind.ropes


@kernel(internal=True)
def _put_row(row: WinchRow, time: float, speed: float, hauled: float, jerk: float) -> None:
    """A row of a winch, whatever it was before."""
    words = row.words
    for k in range(words.shape[0]):
        words[k] = 0.0
    row.time, row.speed, row.hauled, row.jerk = time, speed, hauled, jerk


@kernel(internal=True)
def write_winch(
    ropes: Ropes, i: int, count: int, time: float, ratio: float, hauled: float, plan: Records[MoveRow]
) -> None:
    """A plan, times a ratio, from a length hauled in on, as rows of a winch; those behind it are as its last one."""
    first = ropes.table[i].winch
    for k in range(ropes.table[i].winch_rows):
        row = plan[min(k, count - 1)]
        way = hauled + ratio * (row.value - plan[0].value)
        to = ropes.winches[first + k]
        to.time, to.speed, to.hauled, to.jerk = time + row.time, ratio * row.speed, way, ratio * row.jerk


@kernel(internal=True)
def write_profile(profiles: Floats1, start: int, count: int, time: float, plan: Records[MoveRow]) -> None:
    """A plan as the cubics of a profile; what was before it goes on with its first speed."""
    breaks = int(profiles[start])
    cubics = start + 2 + breaks
    first = plan[0]
    for k in range(breaks - 1):
        row = plan[min(max(k - 1, 0), count - 1)]
        c = cubics + 4 * k
        profiles[start + 2 + k] = time + row.time
        profiles[c], profiles[c + 1] = row.jerk / 6.0, 0.5 * row.acceleration
        profiles[c + 2], profiles[c + 3] = row.speed, row.value
    profiles[start + 2] = time - 1.0
    profiles[cubics], profiles[cubics + 1] = 0.0, 0.0
    profiles[cubics + 2], profiles[cubics + 3] = first.speed, first.value - first.speed
    profiles[start + 1 + breaks] = time + plan[count - 1].time + FOREVER


@kernel(internal=True)
def write_levels(
    tanks: Records[TankData],
    levels: Records[TankLevel],
    tank: int,
    count: int,
    time: float,
    plan: Records[MoveRow],
) -> None:
    """A plan of constant rates as levels of a tank, which are held behind the last one."""
    data, last = tanks[tank], plan[count - 1]
    for k in range(data.count):
        level = levels[data.first + k]
        if k < count:
            level.time, level.mass = time + plan[k].time, plan[k].value
        else:
            level.time, level.mass = time + last.time + FOREVER, last.value + last.speed * FOREVER


@kernel(internal=True)
def _acceleration(ropes: Ropes, i: int, time: float) -> float:
    """Of a winch by its rows [m/s2]."""
    first, count = ropes.table[i].winch, ropes.table[i].winch_rows
    for k in range(first, first + count - 1):
        a, b = ropes.winches[k], ropes.winches[k + 1]
        if a.time <= time < b.time:
            h = b.time - a.time
            return (b.speed - a.speed) / h + a.jerk * (time - a.time - 0.5 * h)
    return 0.0


@kernel(internal=True)
def _present(kind: Sequencer, actuator: int, time: float) -> tuple[float, float, float]:
    """Value of an actuator, speed and acceleration: length hauled in [m], mass [kg], place [m] or [rad]."""
    spec = kind.actuators[actuator]
    if spec.sort == TANK:
        return kind.tanks[spec.number].mass, 0.0, 0.0  # of the record that was just written
    if spec.sort == DRIVE:
        return profile_value(kind.profiles, spec.number, time)
    if spec.sort == PATH:
        path = kind.paths[spec.number]
        return way_on_pieces(kind.path_pieces, path.first, path.count, time)
    ropes = _ropes_of(kind, spec.sort)
    hauled, speed = winch_state(ropes, spec.number, time)
    return hauled, speed, _acceleration(ropes, spec.number, time)


@kernel(internal=True)
def _hauled_at(kind: Sequencer, actuator: int, length: float) -> float:
    """Length hauled in of a winch whose rope has an unstretched length [m]."""
    spec = kind.actuators[actuator]
    ropes = _ropes_of(kind, spec.sort)
    hauled = ropes.table[spec.number].start_length - length
    if spec.sort == HELD_ROPE:
        hauled += kind.control_state[spec.number].paid_out
    return hauled


@kernel(internal=True)
def _write(kind: Sequencer, actuator: int, count: int, time: float) -> None:
    """Give the plan to an actuator, and to the winches that follow it."""
    spec, plan = kind.actuators[actuator], kind.plan
    if spec.sort == TANK:
        write_levels(kind.tanks, kind.levels, spec.number, count, time, plan)
    elif spec.sort == DRIVE:
        write_profile(kind.profiles, spec.number, count, time, plan)
    else:
        write_winch(_ropes_of(kind, spec.sort), spec.number, count, time, 1.0, plan[0].value, plan)
        for m in range(kind.actuators.shape[0]):
            other = kind.actuator_state[m]
            if other.leader == actuator and kind.actuators[m].commanded:
                hauled, _, _ = _present(kind, m, time)
                ropes = _ropes_of(kind, kind.actuators[m].sort)
                write_winch(ropes, kind.actuators[m].number, count, time, other.ratio, hauled, plan)
                other.arrives = kind.actuator_state[actuator].arrives


@kernel(internal=True)
def _give_plan(kind: Sequencer, actuator: int, count: int, time: float) -> None:
    """Let an actuator do the plan; it arrives if it rests behind it."""
    last = kind.plan[count - 1]
    kind.actuator_state[actuator].arrives = time + last.time if last.speed == 0.0 else math.inf
    _write(kind, actuator, count, time)


@kernel(internal=True)
def _stop(kind: Sequencer, actuator: int, time: float) -> None:
    """An actuator stops at once."""
    value, speed, present = _present(kind, actuator, time)
    count = plan_speed(value, speed, present, 0.0, 0.0, 0.0, kind.plan)
    _give_plan(kind, actuator, count, time)


@kernel(internal=True)
def _follow(kind: Sequencer, actuator: int, leader: int, ratio: float, time: float) -> None:
    """A winch does as another one from now on, times a ratio."""
    follower, spec = kind.actuators[actuator], kind.actuators[leader]
    ropes, others = _ropes_of(kind, follower.sort), _ropes_of(kind, spec.sort)
    own, _, _ = _present(kind, actuator, time)
    hauled, _, _ = _present(kind, leader, time)
    i, j = follower.number, spec.number
    count, first, other = others.table[j].winch_rows, ropes.table[i].winch, others.table[j].winch
    for k in range(ropes.table[i].winch_rows):
        row = others.winches[other + min(k, count - 1)]
        way = own + ratio * (row.hauled - hauled)
        _put_row(ropes.winches[first + k], row.time, ratio * row.speed, way, ratio * row.jerk)
    state = kind.actuator_state[actuator]
    state.leader, state.ratio, state.arrives = leader, ratio, kind.actuator_state[leader].arrives


@kernel(internal=True)
def _leg_at(kind: Sequencer, path: int, way: float) -> int:
    """Leg of a path on which a way is: at the end of one the next one, at the end of all the last one."""
    found = -1
    for leg in range(kind.path_legs.shape[0]):
        if int(kind.path_legs[leg, 0]) == path:
            found = leg
            if way < kind.path_legs[leg, 1] * (1.0 - ARRIVED_PART):
                return leg
    return found


@kernel(internal=True)
def _write_path(kind: Sequencer, number: int, count: int, time: float, leg: int) -> None:
    """A plan as pieces of a path, and behind it what is planned for the legs after one; none if that is negative."""
    path, plan = kind.paths[number], kind.plan
    first, legs = path.first, kind.path_legs.shape[0]
    for k in range(count):
        piece = kind.path_pieces[first + k]
        piece[0], piece[1] = time + plan[k].time, plan[k].value
        piece[2], piece[3] = plan[k].speed, plan[k].acceleration
    k = count
    if leg >= 0 and leg + 1 < legs and int(kind.path_legs[leg + 1, 0]) == number:
        begin = first + int(kind.path_legs[leg + 1, 4])
        late = kind.path_pieces[first + k - 1, 0] - kind.path_plan[begin - 1, 0]
        while begin < first + path.count and k < path.count:
            for column in range(4):
                kind.path_pieces[first + k, column] = kind.path_plan[begin, column]
            kind.path_pieces[first + k, 0] += late
            begin += 1
            k += 1
    while k < path.count:
        for column in range(4):
            kind.path_pieces[first + k, column] = kind.path_pieces[first + k - 1, column]
        k += 1


@kernel(internal=True)
def _drive_path(kind: Sequencer, action: ActionEntry, time: float) -> float:
    """Let a transporter stop, go to the end of its leg, or continue as planned; its speed [m/s]."""
    actuator, number = action.actuator, kind.actuators[action.actuator].number
    way, before, _ = _present(kind, actuator, time)
    leg = _leg_at(kind, number, way)
    end, planned, gentle = kind.path_legs[leg, 1], kind.path_legs[leg, 2], kind.path_legs[leg, 3]
    commanded = action.operation == SPEED
    count = plan_leg(action, way, before, end, planned, gentle, kind.plan)
    _write_path(kind, number, count, time, -1 if commanded else leg)
    path = kind.paths[number]
    kind.actuator_state[actuator].arrives = kind.path_pieces[path.first + path.count - 1, 0]
    return action.value if commanded else planned


@kernel(internal=True)
def _control(kind: Sequencer, action: ActionEntry, time: float) -> None:
    """A winch keeps a tension and stops, or a share of a load beside what it does."""
    control = kind.controls[kind.actuators[action.actuator].number]
    control.speed, control.band, control.wanted = action.speed, action.dead_band, action.value
    if action.operation == KEEP:
        control.mode = CONSTANT
        _stop(kind, action.actuator, time)
        return
    control.mode, control.group = LEVEL, action.group
    if action.value == 0.0:
        control.mode, control.speed = PLANNED, math.inf


@kernel(internal=True)
def _move(kind: Sequencer, action: ActionEntry, time: float) -> float:
    """Let something move; what it was commanded, for the log."""
    actuator, operation, value = action.actuator, action.operation, action.value
    spec = kind.actuators[actuator]
    if spec.sort == PATH:
        return _drive_path(kind, action, time)
    if operation not in (FOLLOW, KEEP_LEVEL):  # it levels in addition to its commands
        kind.actuator_state[actuator].leader = -1
    if spec.sort == HELD_ROPE and (operation in MOVES or operation == BRAKE):
        control = kind.controls[spec.number]
        if control.mode != LEVEL or operation == BRAKE:
            control.mode, control.speed = PLANNED, math.inf
    if operation == BRAKE:
        if value > 0.0:
            _stop(kind, actuator, time)
        return value
    if operation == FOLLOW:
        _follow(kind, actuator, action.leader, action.ratio, time)
        return action.ratio
    if operation in (KEEP, KEEP_LEVEL):
        _control(kind, action, time)
        return value
    place, speed, present = _present(kind, actuator, time)
    target = value
    if operation == GO_BY:
        if action.signal >= 0:
            value = action.parts * (value - kind.trial[action.signal])
        target = place + value
    elif operation == GO_TO and spec.sort < TANK:
        target = _hauled_at(kind, actuator, value)
    count = plan_command(action, spec.sort == TANK, place, speed, present, target, kind.plan)
    _give_plan(kind, actuator, count, time)
    return value


@kernel(inline=True, internal=True)
def _stored(kind: Sequencer) -> float:
    """Elastic energy of the last record [J]."""
    return total_outputs(kind.record, kind.record.shape[0] - TOTAL_WIDTH).energy.elastic


@kernel(internal=True)
def _let_go(kind: Sequencer, spec: Actuator) -> None:
    """A rope does nothing from now on."""
    ropes = _ropes_of(kind, spec.sort)
    entry, state = ropes.table[spec.number], ropes.state[spec.number]
    entry.axial_stiffness = entry.damping = 0.0
    state.tension = 0.0
    if spec.sort == HELD_ROPE:
        control = kind.controls[spec.number]
        control.mode, control.speed = PLANNED, math.inf


@kernel(internal=True)
def _let_joint_go(kind: Sequencer, block: int) -> float:
    """The rows of a joint do nothing from now on; what they had stored [J] is lost."""
    row, lost = kind.joint_rows[block], 0.0
    for r in range(kind.lanes):
        stored = 0.5 * row.stiffness[r] * row.residual[r] * row.residual[r]
        row.loss[r] += stored
        row.stiffness[r] = 0.0
        lost += stored
        if row.scale[r] > 0.0:
            row.compliance[r] = row.hold[r] = row.softness[r] = ABSENT * row.scale[r]
        row.relaxation[r] = row.rigid[r] = row.target[r] = 0.0
        row.impulse[r] = row.half_impulse[r] = row.reaction[r] = row.last_reaction[r] = 0.0
        row.slope[r] = row.slope_before[r] = 0.0
    return lost


@kernel(internal=True)
def _fail_actuator(kind: Sequencer, actuator: int, time: float) -> None:
    """What drives it is off: its brake holds it where it is, and what follows it, and it does not arrive anywhere."""
    spec = kind.actuators[actuator]
    kind.actuator_state[actuator].leader = -1
    if spec.sort == HELD_ROPE:
        control = kind.controls[spec.number]
        control.mode, control.speed = PLANNED, math.inf
    _stop(kind, actuator, time)
    kind.actuator_state[actuator].arrives = math.inf
    for m in range(kind.actuator_state.shape[0]):
        if kind.actuator_state[m].leader == actuator:
            kind.actuator_state[m].arrives = math.inf


@kernel(internal=True)
def _fail(kind: Sequencer, action: ActionEntry, time: float) -> float:
    """An actuator fails, or works again from now on: it stays at rest until its next command."""
    failed, number = action.value > 0.0, action.helper
    if action.fails == FAILS_ACTUATOR:
        if failed:
            _fail_actuator(kind, action.actuator, time)
        return action.value
    if action.fails == FAILS_PUMP:
        pump = kind.pumps[number]
        row = kind.pump_rows[pump.first]
        _, _, pumped = pumped_behind(row, pump.lag, time)
        row.time, row.pumped = time, pumped
        row.flow = row.command = 0.0
        pump.failed = failed
        return action.value
    kind.vehicle_state[number].failed = failed
    vehicle = kind.vehicles[number]
    for g in range(vehicle.first_group, vehicle.first_group + vehicle.groups):
        state = kind.group_state[g]
        state.levelled += state.pumping * (time - state.since)
        state.since, state.pumping = time, 0.0
    return action.value


@kernel(internal=True)
def _hold(kind: Sequencer, spec: Actuator, time: float, slack: float) -> float:
    """A rope holds from now on; its unstretched length [m], negative if it would be too short for its path."""
    ropes = _ropes_of(kind, spec.sort)
    i = spec.number
    entry, state = ropes.table[i], ropes.state[i]
    path = rope_outputs(kind.record, entry.column).length
    rest = path + slack
    if not path <= rest * (1.0 + LARGEST_STRAIN):
        return -rest
    entry.axial_stiffness, entry.damping = spec.axial_stiffness, spec.damping
    hauled, _ = winch_state(ropes, i, time)
    entry.start_length = rest + hauled
    if spec.sort == HELD_ROPE:
        kind.control_state[i].paid_out = 0.0
    state.stretched, state.rest, state.next_rest = path, rest, rest
    state.rate = state.growth = state.drift = 0.0
    state.fresh, state.paced = True, False
    return rest


@kernel(internal=True)
def _act(
    kind: Sequencer,
    action: ActionEntry,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
) -> float:
    """Do something; a value for the log, negative for a connection that is too short."""
    if action.operation == RELEASE_JOINT:
        return _let_joint_go(kind, action.block)
    if action.operation == FAIL:
        return _fail(kind, action, time)
    if action.operation not in (RELEASE, CONNECT):
        if action.operation == GO_BY and action.signal >= 0:
            _measure(kind, forces, bodies, joints, systems, work, time)
        return _move(kind, action, time)
    spec = kind.actuators[action.actuator]
    state = _ropes_of(kind, spec.sort).state[spec.number]
    _measure(kind, forces, bodies, joints, systems, work, time)
    before = _stored(kind)
    value = 0.0
    if action.operation == RELEASE:
        _let_go(kind, spec)
    else:
        value = _hold(kind, spec, time, action.value)
        if value <= 0.0:
            return value
    _measure(kind, forces, bodies, joints, systems, work, time)
    gained = _stored(kind) - before
    if action.operation == RELEASE:
        state.loss -= gained
        return -gained
    state.winch_work += gained
    return value


@kernel(internal=True)
def _begin_phase(
    kind: Sequencer,
    track: int,
    forces: Forces,
    bodies: Bodies,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
) -> None:
    """Actions of the phase that begins, and its timers; the record of this time has been written."""
    state = kind.state
    kind.track_state[track].begun, kind.track_state[track].rested = time, 0.0
    number = kind.tracks[track].first + kind.track_state[track].phase - 1
    phase = kind.phases[number]
    _note(kind, time, BEGUN, number, -1, 0.0)
    for c in range(phase.first_condition, phase.first_condition + phase.conditions):
        kind.timers[c].since = kind.timers[c].trial = math.nan
    for a in range(phase.first_action, phase.first_action + phase.actions):
        action = kind.actions[a]
        value = 0.0
        if action.operation != NOTHING:
            value = _act(kind, action, forces, bodies, joints, systems, work, time)
            if action.operation == CONNECT and value <= 0.0:
                _note(kind, time, NOT_CONNECTED, number, action.actuator, -value)
                state.outcome = LIMIT
                return
        _note(kind, time, ACTION, number, a, value)
    _measure(kind, forces, bodies, joints, systems, work, time)
    for s in range(kind.values.shape[0]):
        kind.values[s] = kind.trial[s]


@kernel(internal=True)
def _watch_ropes(kind: Sequencer, time: float, step: float) -> None:
    """End the run before a winch has hauled in the whole rope."""
    for m in range(kind.actuators.shape[0]):
        spec = kind.actuators[m]
        if not spec.commanded or spec.sort >= TANK:
            continue
        ropes = _ropes_of(kind, spec.sort)
        _, speed = winch_state(ropes, spec.number, time)
        if spec.sort == HELD_ROPE and kind.controls[spec.number].mode != PLANNED:
            speed += kind.controls[spec.number].speed
        rest = ropes.state[spec.number].rest
        if rest <= 2.0 * step * speed:
            state = kind.track_state[0]
            number = min(state.phase, kind.tracks[0].phases) - 1
            _note(kind, time, ROPE_USED_UP, kind.tracks[0].first + number, m, rest)
            if spec.sort == HELD_ROPE:
                kind.controls[spec.number].mode = PLANNED
            kind.actuator_state[m].leader = -1
            _stop(kind, m, time)
            kind.state.outcome = LIMIT


@kernel(internal=True)
def _watch_limits(kind: Sequencer, number: int, time: float) -> None:
    """Limits of a phase, each reported once."""
    phase = kind.phases[number]
    for i in range(phase.first_limit, phase.first_limit + phase.limits):
        limit = kind.limits[i]
        x = kind.trial[limit.signal]
        if kind.passed[i].passed or _margin(limit.below, limit.value, x) >= 0.0:
            continue
        kind.passed[i].passed = True
        _note(kind, time, LIMIT_STOP if limit.stop else LIMIT_WARNING, number, i, x)
        if limit.stop:
            kind.state.outcome = LIMIT


@kernel(internal=True)
def _earliest(kind: Sequencer, time: float, step: float) -> int:
    """Ends of the phases of all tracks; the track whose phase ends first, -1 if none does."""
    state, end = kind.state, time + step
    first = -1
    repeated = state.due > 0.0 and abs(end - state.due) <= SHORTEST * step + 1e-14 * end
    for track in range(kind.tracks.shape[0]):
        ends = _end_of_phase(kind, track, time, end)
        if repeated and track == state.due_track:
            ends = end
        kind.track_state[track].ends = ends
        if ends < math.inf and (first < 0 or ends < kind.track_state[first].ends):
            first = track
    state.due = 0.0
    return first


@kernel(internal=True)
def _is_active(kind: Sequencer) -> bool:
    """Whether any track has a phase left."""
    left = 0
    for track in range(kind.tracks.shape[0]):
        left += kind.track_state[track].phase <= kind.tracks[track].phases
    return left > 0


@implement(direct, Sequencer)
@kernel(internal=True)
def direct_phases(
    kind: Sequencer,
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
    if kind.track_state[0].phase == 0:
        return
    end = time + step
    if state.outcome == 0:
        _watch_ropes(kind, end, step)
    if state.outcome == 0 and _is_active(kind):
        _measure(kind, forces, bodies, joints, systems, work, end)
        first = _earliest(kind, time, step)
        if first >= 0 and kind.track_state[first].ends < end - SHORTEST * step:
            work.control.split = max(kind.track_state[first].ends - time, SHORTEST * step)
            state.due, state.due_track = time + work.control.split, first
            return
        for s in range(kind.values.shape[0]):
            kind.values[s] = kind.trial[s]
        for c in range(kind.timers.shape[0]):
            kind.timers[c].since = kind.timers[c].trial
        for track in range(kind.tracks.shape[0]):
            spec, own = kind.tracks[track], kind.track_state[track]
            if state.outcome != 0 or own.phase > spec.phases:
                continue
            number = spec.first + own.phase - 1
            if state.held:
                own.rested += step
            _watch_limits(kind, number, end)
            if state.outcome == 0 and own.ends <= end + SHORTEST * step:
                _note(kind, end, DONE, number, -1, end - own.begun)
                own.phase += 1
                if own.phase <= spec.phases:
                    _begin_phase(kind, track, forces, bodies, joints, systems, work, end)
            elif (
                state.outcome == 0
                and not state.held
                and end - own.begun - own.rested >= kind.phases[number].timeout * (1.0 - 1e-12)
            ):
                _note(kind, end, TIMED_OUT, number, -1, end - own.begun)
                state.outcome = TIMEOUT
        if state.outcome == 0 and kind.stops_at_end and not _is_active(kind):
            state.outcome = ENDED
    if recorded and state.outcome != 0:
        work.status.outcome = state.outcome


@entry
def begin_scenario(
    kind: Sequencer, forces: Forces, bodies: Bodies, joints: Joints, systems: Systems, work: Workspace
) -> None:
    """Signals at the start, and the actions of the first phases."""
    for track in range(kind.tracks.shape[0]):
        kind.track_state[track].phase = 1
    _measure(kind, forces, bodies, joints, systems, work, 0.0)
    for track in range(kind.tracks.shape[0]):
        if kind.state.outcome == 0:
            _begin_phase(kind, track, forces, bodies, joints, systems, work, 0.0)
