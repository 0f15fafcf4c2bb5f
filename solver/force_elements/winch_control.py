"""Wire ropes whose winch answers to their tension: one that keeps a tension, a brake that slips, a share of a load.

Between two tensions the drum does what is planned, or rests. Beyond the upper one it pays out, below the lower one it
hauls in, just so much that the elastic tension at the end of the step is that limit, but no faster than it can. With
the path s and the unstretched length l that is planned::

    dl = max(0, s/(1 + T_high/EA) - l) + min(0, s/(1 + T_low/EA) - l),        |dl| <= v h

So the tension is a law of the rate of the path, as of any rope, which is level while the drum gives way: it is fitted
as they are, and the work is that of the winch. A winch of constant tension has ``T (1 -+ band)``, T a linear table in
time. A brake has no lower limit, and slips at any speed; what it has slipped stays out.

Winches that keep a load level do so beside their plans. With the elastic tensions at the end of the last step and
shares w, which add up to 1, each pays out what its rope is stretched too much, and hauls in what is missing, so far as
it is off by more than the dead band, less the mean over all winches, which would move the load::

    dl = (T - w (1 -+ band) sum T) l/EA - mean,        |dl| <= v h

Ropes side by side on a rigid load are level after one step then; where the load gives way it takes some.
"""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records
from heavylift.solver.force_elements.rows import fit_law, put_law
from heavylift.solver.force_elements.wire_rope import (
    Ropes,
    midpoint_rate,
    midpoint_tension,
    record_ropes,
    update_ropes,
    winch_state,
)
from heavylift.solver.interface import Workspace, record_joints, relinearise, set_targets, update_rows
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import ControlOutputs

__all__ = [
    "CONSTANT",
    "LEVEL",
    "PLANNED",
    "TABLED",
    "ControlState",
    "ControlledRopes",
    "TensionRow",
    "WinchControl",
]

PLANNED, TABLED, CONSTANT, LEVEL = range(4)
"""Modes: as planned; a table of tensions; a tension; as planned, and level with a group of winches."""


class WinchControl(Record):
    """Control of the winch of a rope.

    Attributes
    ----------
    first, count
        Rows of its table of tensions; none of a brake.
    band
        Half width of its dead band, relative to the tension.
    speed
        Largest speed [m/s].
    brake
        Tension at which the brake slips [N].
    mode
        What limits the tension beside the brake.
    wanted
        Tension [N], or share of what a group holds.
    group
        Number of the group.
    column
        Of its `ControlOutputs`.
    """

    first: int
    count: int
    band: float
    speed: float
    brake: float
    mode: int
    wanted: float
    group: int
    column: int


control_outputs = outputs_at(ControlOutputs)


class TensionRow(Record):
    """Time [s] and tension [N]."""

    time: float
    tension: float


class ControlState(Record):
    """What a control carries.

    Attributes
    ----------
    paid_out
        Beyond the plan since the start [m].
    speed
        Of the last step, positive if it paid out [m/s].
    planned
        Unstretched length at the end of the step without anything more [m].
    low, high
        Limits of the step [N].
    levelled
        Paid out in the step to keep the load level [m].
    """

    paid_out: float
    speed: float
    planned: float
    low: float
    high: float
    levelled: float


class ControlledRopes(Ropes):
    """All ropes of a scene with a winch that answers to the tension.

    Attributes
    ----------
    controls, control_state
        Of each rope.
    tensions
        Rows of all tables.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "wraps", "held", "control_state")

    controls: Records[WinchControl]
    control_state: Records[ControlState]
    tensions: Records[TensionRow]


@kernel(internal=True)
def _wanted(kind: ControlledRopes, i: int, time: float) -> float:
    """Tension of the table [N], held at its ends."""
    first, last = kind.controls[i].first, kind.controls[i].first + kind.controls[i].count - 1
    if time <= kind.tensions[first].time:
        return kind.tensions[first].tension
    for row in range(first, last):
        a, b = kind.tensions[row], kind.tensions[row + 1]
        if time < b.time:
            return a.tension + (b.tension - a.tension) * (time - a.time) / (b.time - a.time)
    return kind.tensions[last].tension


@kernel(internal=True)
def _tension_with(kind: ControlledRopes, i: int, u: float, h: float, paid: float) -> tuple[float, float]:
    """Tension and slope if some length more is paid out in the step; that becomes the length at its end."""
    length = kind.control_state[i].planned + paid
    kind.state[i].next_rest = length if length > 0.0 else math.nan
    _, tension, slope, _, _ = midpoint_tension(kind, i, u, h)
    return tension, slope


@kernel(internal=True)
def _answer(kind: ControlledRopes, i: int, u: float, h: float) -> tuple[float, float]:
    """Tension of the step and its slope by the rate u; the length at the end of the step."""
    state, elasticity = kind.control_state[i], kind.table[i].axial_stiffness
    if elasticity == 0.0:  # it was let go
        return _tension_with(kind, i, u, h, 0.0)
    path = kind.state[i].stretched + h * u
    longest = path / (1.0 + state.low / elasticity)  # with the lowest tension
    shortest = path / (1.0 + state.high / elasticity)
    paid = max(0.0, shortest - state.planned) + min(0.0, longest - state.planned)
    farthest = kind.controls[i].speed * h if kind.controls[i].mode != LEVEL else math.inf
    if abs(paid) < farthest:
        tension, slope = _tension_with(kind, i, u, h, paid)
        return tension, slope if paid == 0.0 else 0.0
    return _tension_with(kind, i, u, h, math.copysign(farthest, paid))


@kernel(internal=True)
def _elastic(kind: ControlledRopes, i: int) -> float:
    """Tension of the carried stretch [N]."""
    state = kind.state[i]
    return max(0.0, kind.table[i].axial_stiffness * (state.stretched / state.rest - 1.0))


@kernel(internal=True)
def _excess(kind: ControlledRopes, i: int, tensions: float, shares: float) -> float:
    """What a rope of a group is stretched more than its share of the tensions wants [m]; less if negative."""
    control, elasticity = kind.controls[i], kind.table[i].axial_stiffness
    if elasticity == 0.0:
        return 0.0
    tension, wanted = _elastic(kind, i), control.wanted / shares * tensions
    beyond = max(0.0, tension - wanted * (1.0 + control.band)) + min(
        0.0, tension - wanted * (1.0 - control.band)
    )
    return beyond * kind.state[i].rest / elasticity


@kernel(internal=True)
def _level(kind: ControlledRopes, i: int, step: float) -> float:
    """Length that a winch pays out in a step to keep its load level [m]."""
    group = kind.controls[i].group
    tensions = shares = mean = 0.0
    count = 0
    for k in range(kind.table.shape[0]):
        if kind.controls[k].mode == LEVEL and kind.controls[k].group == group:
            tensions += _elastic(kind, k)
            shares += kind.controls[k].wanted
            count += 1
    for k in range(kind.table.shape[0]):
        if kind.controls[k].mode == LEVEL and kind.controls[k].group == group:
            mean += _excess(kind, k, tensions, shares) / count
    farthest = kind.controls[i].speed * step
    return min(max(_excess(kind, i, tensions, shares) - mean, -farthest), farthest)


@implement(set_targets, ControlledRopes)
@kernel(internal=True)
def set_controlled_targets(
    kind: ControlledRopes, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Limits of the step; first guess: the rate of the last one."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        control, state, rope = kind.controls[i], kind.control_state[i], kind.state[i]
        hauled, rope.hauling = winch_state(kind, i, time + step)
        state.levelled = _level(kind, i, step) if control.mode == LEVEL else 0.0
        state.planned = kind.table[i].start_length - hauled + state.paid_out + state.levelled
        state.low, state.high = -0.5 * kind.table[i].axial_stiffness, control.brake
        wanted = 0.0
        if control.mode == TABLED:
            wanted = _wanted(kind, i, time + step)
        elif control.mode == CONSTANT:
            wanted = control.wanted
        if wanted > 0.0:
            state.low = wanted * (1.0 - control.band)
            state.high = min(wanted * (1.0 + control.band), control.brake)
        tension, slope = _answer(kind, i, rope.rate, step)
        put_law(system, kind.table[i].block, step, rope.rate, tension, slope)


@implement(relinearise, ControlledRopes)
@kernel(internal=True)
def relinearise_controlled_ropes(
    kind: ControlledRopes, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the tensions to the rates found."""
    for i in range(kind.table.shape[0]):
        u = midpoint_rate(kind, i, work, system)
        tension, slope = _answer(kind, i, u, step)
        fit_law(system, kind.table[i].block, step, u, tension, slope, work)


@implement(update_rows, ControlledRopes)
@kernel(internal=True)
def update_controlled_ropes(
    kind: ControlledRopes, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """As a rope, and what the control has paid out."""
    for i in range(kind.table.shape[0]):
        state, rope = kind.control_state[i], kind.state[i]
        paid = rope.next_rest - state.planned + state.levelled
        state.paid_out += paid
        state.speed = paid / step
        rope.hauling -= state.speed
    update_ropes(kind, time, step, work, system)


@implement(record_joints, ControlledRopes)
@kernel(internal=True)
def record_controlled_ropes(
    kind: ControlledRopes, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a rope, with what the control has paid out, and how fast."""
    record_ropes(kind, time, work, system, row)
    for i in range(kind.table.shape[0]):
        out = control_outputs(row, kind.controls[i].column)
        out.paid_out = kind.control_state[i].paid_out
        out.paying_speed = kind.control_state[i].speed
