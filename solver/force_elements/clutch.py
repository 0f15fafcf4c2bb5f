"""Clutches and slipping brakes: friction about the axis of a joint, with a torque that they carry at most.

A clutch is one row, the rate u of the angle of its joint. It sticks, and the row keeps the angle at which it did::

    u = -(angle - grip) h/H^2

with the longest step so far H, so that in a part of a step, as events ask for, it goes back by no more than that part.
When that takes more than its limit it slips, with a torque of the limit against u, until u would change its sign
within a step. So the torque that it carries below the limit moves nothing, however long it acts: what softness the row
has gives way once, not in every step. Of two inertias that turn about one axis, one driven by the other through a
clutch of the limit M, the speeds become equal after ``t = |w1 - w2| / (M (1/I1 + 1/I2))`` and what is lost is
``I1 I2/(I1 + I2) (w1 - w2)^2/2``, whatever M.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.force_elements.rows import law_impulse, put_law, put_residual, put_stick, row_rate
from heavylift.solver.interface import (
    FORCES as ACTING,
)
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    CoordinateEntry,
    coordinate_rate,
    coordinate_row,
    joint_markers,
)
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import FORCES, AlongJoint
from heavylift.solver.scene.descriptions import check_table, no_rows
from heavylift.solver.scene.outputs import Outputs, channel, outputs

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["Clutch", "ClutchEntry", "ClutchState", "Clutches", "TorqueRow", "pack"]

PLAIN_ROUNDS = 5
"""Rounds of the iteration after which one clutch at a time changes: those that change together can go in circles."""


@outputs
class ClutchOutputs(Outputs):
    """What a clutch records."""

    torque: float = channel("moment or energy", "torque of the clutch on side b of its joint, about its axis")
    slip_rate: float = channel("angular velocity", "rate at which side b of the clutch turns against side a")
    slipped: float = channel("angle", "accumulated slip angle of the clutch, both senses added up")
    slipping: float = channel(
        "number", "0 while the clutch sticks; 1 or -1, the sense of its slip, while it slips"
    )
    heat: float = channel("moment or energy", "energy lost in the clutch so far", unit="J")


@FORCES.describe("clutch")
@dataclass(frozen=True, eq=False, kw_only=True)
class Clutch(AlongJoint):
    """A clutch or brake about the axis of a joint: it sticks up to a torque, and slips at it."""

    CHANNELS: ClassVar = ClutchOutputs.CHANNELS
    """What it records, in the order of its columns."""
    NOT_LINEAR: ClassVar = "sticks or slips"
    SENTENCES: ClassVar = {"joint": "A hinge, or another joint with an angle, on which it acts."}

    torque: Annotated[float | None, Quantity("moment or energy", minimum=0.0, closed=True)] = None
    """Torque that it carries at most [N m]; 0 is open."""
    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """In place of `torque`, a table: times [s], increasing."""
    torques: Annotated[
        NDArray[np.float64], Quantity("moment or energy", minimum=0.0, closed=True), Shape((None,))
    ] = field(default_factory=no_rows)
    """Largest torques of the table [N m], linear in between, constant before and after."""

    def __post_init__(self) -> None:
        """A constant torque is a table of one row."""
        if self.torque is not None:
            object.__setattr__(self, "times", np.zeros(1))
            object.__setattr__(self, "torques", np.array([self.torque]))
            object.__setattr__(self, "torque", None)

    @staticmethod
    def check(spec: Any) -> None:
        """A torque or a table."""
        if (spec.torque is None) == (not spec.times and not spec.torques):
            raise InputError(
                "not exactly one of 'torque' and a table", expected="'torque', or 'times' and 'torques'"
            )
        check_table("times", spec.times, "torques", spec.torques)

    def obstacle(self, integrator: str) -> str:
        """Its torque jumps."""
        return "" if integrator == "dele2" else "sticks and slips"


class ClutchEntry(CoordinateEntry):
    """A clutch.

    Attributes
    ----------
    block
        Number of its block of rows.
    first, count
        First row and rows of its table.
    """

    block: int
    first: int
    count: int


class TorqueRow(Record):
    """Time [s] and largest torque [N m]."""

    time: float
    torque: float


class ClutchState(Record):
    """What a clutch carries.

    Attributes
    ----------
    fresh
        Whether no step has been made yet.
    angle, grip
        Of its joint, with whole turns; and that at which it last began to stick [rad].
    branch
        0 if it sticks; -1 or 1, the sense of its slip.
    limit, longest
        Largest torque in the step [N m]; longest step so far [s].
    slipped, loss
        Angle slipped [rad], energy lost [J].
    rounds
        Scratch of the iteration: how many rounds there were.
    """

    fresh: bool
    angle: float
    grip: float
    branch: int
    limit: float
    longest: float
    slipped: float
    loss: float
    rounds: int


class Clutches(Arrays):
    """All clutches of a scene.

    Attributes
    ----------
    table
        The clutches.
    torques
        Rows of all tables.
    state
        What they carry.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[ClutchEntry]
    torques: Records[TorqueRow]
    state: Records[ClutchState]


clutch_outputs = outputs_at(ClutchOutputs)


def pack(clutches: Sequence[Clutch], context: PackingContext) -> None:
    """Make the kind and its rows.

    Raises
    ------
    InputError
        If a joint has no angle.
    """
    table: list[ClutchEntry] = []
    torques: list[TorqueRow] = []
    for clutch in clutches:
        joint = context.joint(clutch.joint)
        if "angle" not in {one.name for one in joint.CHANNELS}:
            raise InputError(
                f"joint {joint.name!r} is a {type(joint).__name__}, which has no single angle",
                source=clutch.name,
                key="joint",
                expected="a joint with an angle, as a hinge",
            )
        a, b, c = joint_markers(context.book, joint, ANGLE, ACTING)
        block = context.block(clutch.name, (joint.body_a, joint.body_b), turns=True)
        table.append(
            filled(
                ClutchEntry,
                coordinate=ANGLE,
                a=a,
                b=b,
                c=c,
                column=context.column(clutch),
                block=block,
                first=len(torques),
                count=len(clutch.times),
            )
        )
        torques += [
            filled(TorqueRow, time=float(time), torque=float(torque))
            for time, torque in zip(clutch.times, clutch.torques, strict=True)
        ]
    state = records(ClutchState, len(table))
    state["fresh"] = True
    context.add_rows(Clutches(records(ClutchEntry, table), records(TorqueRow, torques), state))


@kernel(internal=True)
def _limit(kind: Clutches, i: int, time: float) -> float:
    """Largest torque at a time [N m]."""
    first, last = kind.table[i].first, kind.table[i].first + kind.table[i].count - 1
    if time <= kind.torques[first].time:
        return kind.torques[first].torque
    for row in range(first, last):
        a, b = kind.torques[row], kind.torques[row + 1]
        if time < b.time:
            return a.torque + (b.torque - a.torque) * (time - a.time) / (b.time - a.time)
    return kind.torques[last].torque


@implement(fill_rows, Clutches)
@kernel(internal=True)
def fill_clutch_rows(kind: Clutches, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rate of the angle; how far it is from where the clutch grips."""
    for i in range(kind.table.shape[0]):
        own, state = kind.table[i], kind.state[i]
        angle = coordinate_row(system, own.block, work, own.coordinate, own.a, own.b, own.c)
        if with_residual:
            state.angle = near_angle(angle, state.angle)
            if state.fresh or state.branch != 0:
                state.grip = state.angle
            put_residual(system, own.block, state.angle - state.grip)


@kernel(inline=True, internal=True)
def _rate(kind: Clutches, i: int, work: Workspace, system: RowArrays) -> float:
    """Rate of the angle at the velocity of the stage [rad/s]."""
    first = 2 * kind.table[i].block
    return row_rate(system, first, first + 2, work.velocity)


@kernel(internal=True)
def _put(kind: Clutches, i: int, h: float, system: RowArrays) -> None:
    """Row of the middle of a step: back to where it grips, or a torque against the slip."""
    block, state = kind.table[i].block, kind.state[i]
    if state.branch == 0:
        put_stick(system, block)
        system.rows[block].target[0] = -system.rows[block].residual[0] * h / (state.longest * state.longest)
    else:
        put_law(system, block, h, 0.0, state.branch * state.limit, 0.0)


@implement(set_targets, Clutches)
@kernel(internal=True)
def set_clutch_targets(
    kind: Clutches, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: as in the last step. At its end it sticks as in the middle, or if it would turn round."""
    for i in range(kind.table.shape[0]):
        state = kind.state[i]
        if at_midpoint:
            state.rounds, state.limit = 0, _limit(kind, i, time + 0.5 * step)
            state.longest = max(state.longest, step)
            _put(kind, i, step, system)
        elif not state.fresh and state.branch * _rate(kind, i, work, system) <= 0.0:
            state.branch = 0
            put_stick(system, kind.table[i].block)


@implement(relinearise, Clutches)
@kernel(internal=True)
def relinearise_clutches(
    kind: Clutches, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Begin to slip where sticking takes more than the limit; stick where the slip would change its sense."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i].block, kind.state[i]
        state.rounds += 1
        if state.rounds > PLAIN_ROUNDS and work.control.changed > 0:
            continue
        impulse, limit = law_impulse(system, block), 0.5 * step * state.limit
        branch = state.branch
        if branch == 0 and abs(impulse) > limit * (1.0 + 1e-10):
            state.branch = -1 if impulse > 0.0 else 1
        elif branch * _rate(kind, i, work, system) < 0.0:
            state.branch = 0
        if state.branch != branch:
            _put(kind, i, step, system)
            work.control.changed += 1
            work.status.block = block


@implement(update_rows, Clutches)
@kernel(internal=True)
def update_clutches(kind: Clutches, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Angle slipped and energy lost in the step."""
    for i in range(kind.table.shape[0]):
        state, u = kind.state[i], _rate(kind, i, work, system)
        state.loss -= 2.0 * law_impulse(system, kind.table[i].block) * u
        if state.branch != 0:
            state.slipped += step * abs(u)
        state.fresh = False


@implement(record_joints, Clutches)
@kernel(internal=True)
def record_clutches(
    kind: Clutches, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Torque, slip, heat."""
    for i in range(kind.table.shape[0]):
        own, state = kind.table[i], kind.state[i]
        out = clutch_outputs(row, own.column)
        sticks = state.branch == 0
        out.torque = system.rows[own.block].reaction[0] if sticks else -state.branch * _limit(kind, i, time)
        out.slip_rate = coordinate_rate(work, own.coordinate, own.a, own.b, own.c)
        out.slipped = state.slipped
        out.slipping = float(state.branch)
        out.heat = state.loss
        work.sums.dissipated += state.loss
