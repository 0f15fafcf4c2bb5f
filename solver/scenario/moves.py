"""Moves that are planned while a scene runs: cubics in time from a present speed to another one, or to rest at a place.

A change of speed by dv with the acceleration a, whose rate of change is at most the jerk J, takes::

    T(dv) = |dv|/a,                            without a limit of the jerk
    T(dv) = |dv|/a + a/J,                      |dv| >= a^2/J
    T(dv) = 2 sqrt(|dv|/J),                    below that: the acceleration a is not reached

and its way is its mean speed times T (L. Biagiotti and C. Melchiorri, "Trajectory Planning for Automatic Machines and
Robots", 2008, chapter 3). A move over the distance D from the speed v0, in the direction s in which what stopping at
once leaves of it points, goes at most with the speed V and with the peak p for which::

    (v0 + p)/2 T(p - v0) + p/2 T(p) = D,       rest of the way at p if it is V

whose left side grows with p from s v0 or 0 on.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records
from heavylift.solver.scene.operations import GO_BY, GO_TO, SPEED

__all__ = [
    "ARRIVED_PART",
    "MOVE_ROWS",
    "ActionEntry",
    "MoveRow",
    "plan_command",
    "plan_leg",
    "plan_move",
    "plan_speed",
]

MOVE_ROWS = 10
"""Of a plan at most."""
BISECTIONS = 60
SMALLEST = 1e-12
"""Of a ramp, of a piece that is worth a row."""


ARRIVED_PART = 1e-9
"""Of the way at its end, within which a transporter has come to the end of a leg."""


class ActionEntry(Record):
    """A command of an action, `heavylift.solver.scene.commands.Command`, with numbers in place of names.

    Attributes
    ----------
    operation, actuator
        What, with which actuator; -1 is none.
    value, speed, ramp, acceleration, jerk, ratio, parts, dead_band, group
        As of the command.
    leader, signal
        Actuator that is followed, signal that a way is reckoned from; -1 is none.
    block, helper
        Block of a joint; number of a pump or transporter; -1 is none.
    fails
        What fails or works again, by number.
    """

    operation: int
    actuator: int
    value: float
    speed: float
    ramp: float
    acceleration: float
    jerk: float
    leader: int
    ratio: float
    signal: int
    parts: float
    dead_band: float
    group: int
    block: int
    helper: int
    fails: int


class MoveRow(Record):
    """Time since the plan was made [s], value, speed, acceleration, jerk where a piece begins; the last is for ever."""

    time: float
    value: float
    speed: float
    acceleration: float
    jerk: float


@kernel(internal=True)
def ramp_time(change: float, acceleration: float, jerk: float) -> float:
    """How long a change of speed takes [s]; limits that are 0 are none."""
    size = abs(change)
    if size == 0.0 or acceleration == 0.0:
        return 0.0
    if jerk == 0.0:
        return size / acceleration
    if size < acceleration * acceleration / jerk:
        return 2.0 * math.sqrt(size / jerk)
    return size / acceleration + acceleration / jerk


@kernel(internal=True)
def _add_piece(rows: Records[MoveRow], k: int, duration: float, acceleration: float, jerk: float) -> int:
    """A piece from the last row on, and a new last row at its end; its number."""
    d, row, end = duration, rows[k], rows[k + 1]
    row.acceleration, row.jerk = acceleration, jerk
    end.time = row.time + d
    end.value = row.value + d * (row.speed + d * (0.5 * acceleration + d * jerk / 6.0))
    end.speed = row.speed + d * (acceleration + 0.5 * d * jerk)
    end.acceleration = end.jerk = 0.0
    return k + 1


@kernel(internal=True)
def _add_ramp(rows: Records[MoveRow], k: int, speed: float, acceleration: float, jerk: float) -> int:
    """Pieces of a change of the speed of the last row; number of the new last row."""
    change = speed - rows[k].speed
    whole = ramp_time(change, acceleration, jerk)
    if whole > 0.0 and jerk == 0.0:
        k = _add_piece(rows, k, whole, change / whole, 0.0)
    elif whole > 0.0:
        rate = math.copysign(jerk, change)
        rise = min(acceleration / jerk, 0.5 * whole)
        level = whole - 2.0 * rise
        k = _add_piece(rows, k, rise, 0.0, rate)
        if level > SMALLEST * whole:
            k = _add_piece(rows, k, level, rise * rate, 0.0)
        k = _add_piece(rows, k, rise, rise * rate, -rate)
    elif change != 0.0 and k > 0:  # it jumps
        k = _add_piece(rows, k, 0.0, 0.0, 0.0)
    rows[k].speed = speed
    return k


@kernel(internal=True)
def _begin(rows: Records[MoveRow], value: float, speed: float, acceleration: float, jerk: float) -> int:
    """First row; where the jerk has a limit the present acceleration ends first."""
    first = rows[0]
    first.time, first.value, first.speed = 0.0, value, speed
    first.acceleration = first.jerk = 0.0
    if jerk > 0.0 and acceleration != 0.0:
        return _add_piece(rows, 0, abs(acceleration) / jerk, acceleration, -math.copysign(jerk, acceleration))
    return 0


@entry
def plan_speed(
    value: float,
    speed: float,
    present: float,
    wanted: float,
    acceleration: float,
    jerk: float,
    rows: Records[MoveRow],
) -> int:
    """Plan a change of speed, after which it stays.

    Parameters
    ----------
    value, speed, present
        Where it is, its speed and its acceleration now.
    wanted
        Speed.
    acceleration, jerk
        Limits; 0 is none.
    rows
        Receives the plan, shape (`MOVE_ROWS`,).

    Returns
    -------
    int
        Number of rows.
    """
    k = _begin(rows, value, speed, present, jerk)
    return _add_ramp(rows, k, wanted, acceleration, jerk) + 1


@entry
def plan_move(
    value: float,
    speed: float,
    present: float,
    target: float,
    most: float,
    acceleration: float,
    jerk: float,
    rows: Records[MoveRow],
) -> int:
    """Plan a move to rest at a value.

    Parameters
    ----------
    value, speed, present
        Where it is, its speed and its acceleration now.
    target
        Value at the end, which is met exactly.
    most
        Largest speed; one that is larger now goes down to it, as far as the way allows.
    acceleration, jerk
        Limits; 0 is none.
    rows
        Receives the plan, shape (`MOVE_ROWS`,).

    Returns
    -------
    int
        Number of rows.
    """
    k = _begin(rows, value, speed, present, jerk)
    begin = rows[k].speed
    way = target - rows[k].value
    s = 1.0 if way - 0.5 * begin * ramp_time(begin, acceleration, jerk) >= 0.0 else -1.0
    way, v0 = s * way, s * begin
    peak = max(0.0, v0)
    if v0 <= most:
        if acceleration == 0.0:
            peak = most
        elif jerk == 0.0:
            peak = min(most, math.sqrt(max(0.0, acceleration * way + 0.5 * v0 * v0)))
        else:
            low, high = peak, most
            if _way(v0, most, acceleration, jerk) <= way:
                low = most
            else:
                for _ in range(BISECTIONS):
                    middle = 0.5 * (low + high)
                    if _way(v0, middle, acceleration, jerk) <= way:
                        low = middle
                    else:
                        high = middle
            peak = low
    elif _way(v0, most, acceleration, jerk) <= way:
        peak = most
    k = _add_ramp(rows, k, s * peak, acceleration, jerk)
    rest = way - _way(v0, peak, acceleration, jerk)
    if peak > 0.0 and rest > 0.0:
        k = _add_piece(rows, k, rest / peak, 0.0, 0.0)
    k = _add_ramp(rows, k, 0.0, acceleration, jerk)
    rows[k].value = target
    return k + 1


@entry
def plan_command(
    action: ActionEntry,
    empties: bool,
    value: float,
    speed: float,
    present: float,
    target: float,
    rows: Records[MoveRow],
) -> int:
    """Plan what an actuator does for a command, before a run as within it.

    Parameters
    ----------
    action
        The command. What is neither a speed nor a move to rest stops it at once.
    empties
        Whether it stops at the value 0 where its speed is negative, as the pump of a tank does.
    value, speed, present
        Where it is, its speed and its acceleration now.
    target
        Value at the end of a move to rest.
    rows
        Receives the plan, shape (`MOVE_ROWS`,).

    Returns
    -------
    int
        Number of rows; it is at rest behind the last one if that has no speed.
    """
    acceleration = action.acceleration
    if action.operation in (GO_TO, GO_BY):
        if action.ramp > 0.0:
            acceleration = action.speed / action.ramp
        return plan_move(value, speed, present, target, action.speed, acceleration, action.jerk, rows)
    if action.operation != SPEED:
        return plan_speed(value, speed, present, 0.0, 0.0, 0.0, rows)
    if action.ramp > 0.0:
        acceleration = abs(action.value - speed) / action.ramp
    if empties and action.value < 0.0:
        return plan_move(value, speed, present, 0.0, -action.value, acceleration, action.jerk, rows)
    return plan_speed(value, speed, present, action.value, acceleration, action.jerk, rows)


@entry
def plan_leg(
    action: ActionEntry,
    way: float,
    before: float,
    end: float,
    planned: float,
    gentle: float,
    rows: Records[MoveRow],
) -> int:
    """Plan what a transporter does on the leg on which it is: stop, or go to the end of it.

    It brakes harder than it was commanded if it would not stop before the end.

    Parameters
    ----------
    action
        The command: a speed, or to continue as planned.
    way, before
        Distance along the path [m] and speed [m/s] now.
    end, planned, gentle
        Of the leg: where it ends [m], its speed [m/s] and acceleration [m/s2].
    rows
        Receives the plan, shape (`MOVE_ROWS`,).

    Returns
    -------
    int
        Number of rows.
    """
    speed = action.value if action.operation == SPEED else planned
    acceleration = action.acceleration if action.acceleration > 0.0 else gentle
    if action.ramp > 0.0:
        acceleration = max(speed, before) / action.ramp
    if way + 0.5 * before * before / acceleration > end:
        acceleration = 0.5 * before * before / max(end - way, ARRIVED_PART * end)
    if speed == 0.0:
        return plan_speed(way, before, 0.0, 0.0, acceleration, 0.0, rows)
    return plan_move(way, before, 0.0, end, speed, acceleration, 0.0, rows)


@kernel(internal=True)
def _way(v0: float, peak: float, acceleration: float, jerk: float) -> float:
    """From a speed over a peak to rest."""
    return 0.5 * (v0 + peak) * ramp_time(peak - v0, acceleration, jerk) + 0.5 * peak * ramp_time(
        peak, acceleration, jerk
    )
