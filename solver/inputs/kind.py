"""The kind of all inputs: what they are at a time, the loads of those that act themselves, and their channels.

Forces, moments and loads along joints act on markers. Everything else that an input drives reads a table of its own,
rows of a winch, a profile, levels of a tank, which is written when the input is set (`heavylift.solver.inputs.ports`).
Those tables are carried here, unless a scenario carries them.
"""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, Vector
from heavylift.solver.interface import Workspace, add_forces, record_forces
from heavylift.solver.joints.coordinate import CoordinateEntry, add_load
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.inputs import ForceInputOutputs

__all__ = ["ACTS", "InputEntry", "InputState", "Inputs"]

ACTS = ("", "force", "moment", "load")
"""How an input acts, by number: not itself; on a point; on three directions of a body; along a joint."""
ELSEWHERE, FORCE, MOMENT, LOAD = range(4)

input_outputs = outputs_at(ForceInputOutputs)


class InputEntry(CoordinateEntry):
    """An input.

    Attributes
    ----------
    acts
        How, by number of `ACTS`.
    axes
        Of a force, the first of three markers of the axes of the body, -1 in world axes; of a moment those markers.
    in_body
        Whether a moment is in the axes of the body.
    direction
        Unit vector of a force or a moment.
    """

    acts: int
    axes: int
    in_body: bool
    direction: Vector


class InputState(Record):
    """What an input was set to: its value and its rate from a time on [s], until another one, when it is held."""

    value: float
    rate: float
    since: float
    until: float


class Inputs(Arrays):
    """All inputs of a scene.

    Attributes
    ----------
    table, state
        The inputs; what they were set to, carried.
    winches, rubbing_winches, held_winches, levels, profiles, aims, fields, heights, turns
        Numbers of the tables that inputs write, carried here: rows of winches, of those of ropes over sheaves that rub,
        and of those with a brake, levels of tanks, profiles of drives, aims of controllers, winds and currents, their
        speeds over the height and their directions; empty where nothing writes them, or a scenario carries them.
    """

    carried_fields: ClassVar[tuple[str, ...]] = (
        "state",
        "winches",
        "rubbing_winches",
        "held_winches",
        "levels",
        "profiles",
        "aims",
        "fields",
        "heights",
        "turns",
    )

    table: Records[InputEntry]
    state: Records[InputState]
    winches: Floats1
    rubbing_winches: Floats1
    held_winches: Floats1
    levels: Floats1
    profiles: Floats1
    aims: Floats1
    fields: Floats1
    heights: Floats1
    turns: Floats1


@kernel(inline=True, internal=True)
def _value(kind: Inputs, i: int, time: float) -> float:
    """Of an input at a time."""
    state = kind.state[i]
    return state.value + state.rate * (min(max(time, state.since), state.until) - state.since)


@kernel(internal=True)
def _add_moment(work: Workspace, entry: InputEntry, value: float) -> None:
    """A moment M on three unit axes e at right angles: forces M x e / 2, since the sum of e x (M x e) is 2 M."""
    m = entry.direction
    x, y, z = value * m[0], value * m[1], value * m[2]
    if entry.in_body:
        a, b, c = (
            work.markers[entry.axes].point,
            work.markers[entry.axes + 1].point,
            work.markers[entry.axes + 2].point,
        )
        x, y, z = (
            x * a[0] + y * b[0] + z * c[0],
            x * a[1] + y * b[1] + z * c[1],
            x * a[2] + y * b[2] + z * c[2],
        )
    for k in range(3):
        marker = work.markers[entry.axes + k]
        e = marker.point
        marker.force[0] += 0.5 * (y * e[2] - z * e[1])
        marker.force[1] += 0.5 * (z * e[0] - x * e[2])
        marker.force[2] += 0.5 * (x * e[1] - y * e[0])


@implement(add_forces, Inputs)
@kernel(internal=True)
def add_inputs(kind: Inputs, time: float, work: Workspace) -> None:
    """Loads of those that act themselves."""
    for i in range(kind.table.shape[0]):
        entry = kind.table[i]
        if entry.acts == ELSEWHERE:
            continue
        value = _value(kind, i, time)
        if entry.acts == LOAD:
            add_load(work, entry.coordinate, entry.a, entry.b, entry.c, value)
        elif entry.acts == MOMENT:
            _add_moment(work, entry, value)
        else:
            marker = work.markers[entry.a]
            for k in range(3):
                component = value * entry.direction[k]
                if entry.axes < 0:
                    marker.force[k] += component
                else:
                    for j in range(3):
                        marker.force[j] += component * work.markers[entry.axes + k].point[j]


@implement(record_forces, Inputs)
@kernel(internal=True)
def record_inputs(kind: Inputs, time: float, work: Workspace, row: Floats1) -> None:
    """What they are."""
    for i in range(kind.table.shape[0]):
        input_outputs(row, kind.table[i].column).value = _value(kind, i, time)
