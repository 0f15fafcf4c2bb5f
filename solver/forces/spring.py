"""Springs and dampers between two points, or on the angle or travel of a joint: as rows of the step or as forces.

As rows, stiff ones do not dictate the size of the step. With the scalar q, its row G, stiffness k and damping c the
force in the middle of the step is ``k (q_n + h/2 G v - rest) + c G v``: the trapezoidal rule, of second order and
stable at any step::

    ( G A^-1 G^T + 2/(h z) ) P = -k (q_n - rest)/z - G U,     z = k h/2 + c

This is what a row of compliance ``1/k`` and relaxation time ``c/k`` does, so springs need no targets of their own.
Integrators that evaluate forces at an instant take them as forces, linear or from a table. Tables as rows have
corners: `heavylift.solver.force_elements.scalar_laws`, with the same entry and the same functions of force and energy.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import field, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, AsDrawn, ByCoordinate, Quantity, Shape
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.extremes import Agreement, Extremes, compare_force, largest_of, note_value, smallest_of
from heavylift.solver.force_elements.forces import mean_force, spring_force
from heavylift.solver.force_elements.rows import put_residual, row_rate
from heavylift.solver.interface import (
    FORCES as ACTING,
)
from heavylift.solver.interface import (
    ROWS,
    Workspace,
    add_forces,
    fill_bias,
    fill_rows,
    hold_turns,
    record_joints,
    update_rows,
    watch_joints,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    DISTANCE,
    CoordinateEntry,
    add_load,
    coordinate_rate,
    coordinate_row,
    coordinate_value,
    joint_coordinate,
    joint_markers,
    spring_markers,
)
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.ringing import steady_rate
from heavylift.solver.rows.structure import RowArrays, RowSystem
from heavylift.solver.scene.connections import (
    FORCES,
    AlongJoint,
    Between,
    Joint,
    ThrustOutputs,
    TorqueOutputs,
    as_joint,
)
from heavylift.solver.scene.descriptions import check_table, named, no_rows
from heavylift.solver.scene.drawn import Element, Strut
from heavylift.solver.scene.outputs import Outputs, channel, largest, outputs, smallest
from heavylift.solver.scene.sliding_joints import SCALAR_LAWS

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = [
    "JointSpring",
    "Spring",
    "SpringEntry",
    "SpringState",
    "Springs",
    "compare_load",
    "end_rate",
    "pack",
    "put_spring",
    "spring_fields",
    "spring_load",
    "spring_side",
    "spring_table",
    "stored_energy",
]


SLOWEST_RATE = 1e-9
"""Stiffness over damping [1/s] of a row that is a damper only."""


def _check_law(
    spec: Any, key: str, places: Sequence[float], values_key: str, values: Sequence[float]
) -> None:
    """A spring has a stiffness or a table, or is a mere damper; one with explicit zeros is no error.

    The first run of a sweep has a stiffness or damping of zero, which an object cannot distinguish from a missing one.
    """
    if spec.stiffness is not None and (places or values):
        raise InputError(
            "both 'stiffness' and a table", expected=f"'stiffness', or {key!r} and {values_key!r}"
        )
    if not named(spec, "stiffness", "damping") and not (places or values):
        raise InputError(
            "neither a stiffness nor a damping",
            expected=f"'stiffness', 'damping', or {key!r} and {values_key!r}",
        )
    check_table(key, places, values_key, values, shortest=2)


@outputs
class SpringOutputs(Outputs):
    """What a spring between two points records."""

    force: float = channel("force", "tension of the spring with its damper; negative if it pushes")
    length: float = channel("length", "distance of the ends of the spring")
    force_max: float = largest("force", "force")
    force_min: float = smallest("force", "force")


@FORCES.describe("spring")
@dataclass(frozen=True, eq=False, kw_only=True)
class Spring(Between):
    """A spring and damper between two points, along their line: it pulls and pushes."""

    CHANNELS: ClassVar = SpringOutputs.CHANNELS
    """What it records, in the order of its columns."""

    length: Annotated[float, Quantity("length", minimum=0.0, closed=True), AsDrawn()]
    """Unloaded length [m]; the initial geometric length if absent."""
    stiffness: Annotated[float, Quantity("stiffness", minimum=0.0, closed=True), Absent()] = 0.0
    """[N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m]."""
    elongations: Annotated[NDArray[np.float64], Quantity("length"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """In place of the stiffness, a table: elongations [m], increasing."""
    forces: Annotated[NDArray[np.float64], Quantity("force"), Shape((None,))] = field(default_factory=no_rows)
    """Tensions of the table [N], linear in between and beyond its ends."""

    @staticmethod
    def check(spec: Any) -> None:
        """A stiffness, a damping or a table."""
        _check_law(spec, "elongations", spec.elongations, "forces", spec.forces)

    @property
    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Its table."""
        return self.elongations, self.forces

    def packed_by(self, integrator: str) -> str:
        """A table is a row with a law, where there are such."""
        return _packing_module(self, integrator)

    def drawn(self) -> Iterable[Element]:
        """As between all points, coiled."""
        return (replace(one, coiled=True) if isinstance(one, Strut) else one for one in super().drawn())


@FORCES.describe("joint_spring")
@dataclass(frozen=True, eq=False, kw_only=True)
class JointSpring(AlongJoint):
    """A spring and damper on the angle of a hinge or the travel of a slider."""

    CHANNEL_BY_COORDINATE: ClassVar = {
        "angle": replace(
            TorqueOutputs.CHANNELS[0],
            sentence="torque about the axis of the joint on its side a; on side b it turns back to `rest`",
        ),
        "travel": replace(
            ThrustOutputs.CHANNELS[0],
            sentence="force along the axis of the joint on its side a; on side b it pulls back to `rest`",
        ),
    }

    coordinate: Literal["angle", "travel"] | None = None
    """Of a joint that both turns and slides: what of it counts."""
    rest: Annotated[float, ByCoordinate(Quantity("angle"), Quantity("length"))] = 0.0
    """Angle [rad] or travel [m] without load."""
    stiffness: Annotated[
        float,
        ByCoordinate(
            Quantity("angular stiffness", minimum=0.0, closed=True),
            Quantity("stiffness", minimum=0.0, closed=True),
        ),
        Absent(),
    ] = 0.0
    """[N m/rad] or [N/m]."""
    damping: Annotated[
        float,
        ByCoordinate(
            Quantity("angular damping", minimum=0.0, closed=True),
            Quantity("damping", minimum=0.0, closed=True),
        ),
    ] = 0.0
    """[N m s/rad] or [N s/m]."""
    deflections: Annotated[
        NDArray[np.float64], ByCoordinate(Quantity("angle"), Quantity("length")), Shape((None,))
    ] = field(default_factory=no_rows)
    """In place of the stiffness, a table: angles [rad] or travels [m] less `rest`, increasing."""
    loads: Annotated[
        NDArray[np.float64], ByCoordinate(Quantity("moment or energy"), Quantity("force")), Shape((None,))
    ] = field(default_factory=no_rows)
    """Restoring torques [N m] or forces [N] of the table, linear in between and beyond its ends."""

    @staticmethod
    def check(spec: Any) -> None:
        """A stiffness, a damping or a table."""
        _check_law(spec, "deflections", spec.deflections, "loads", spec.loads)

    @property
    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Its table."""
        return self.deflections, self.loads

    def packed_by(self, integrator: str) -> str:
        """A table is a row with a law, where there are such."""
        return _packing_module(self, integrator)


def first_turn(spring: Spring | JointSpring) -> float:
    """Value from which the turns of an angle are counted at the start [rad].

    An angle is zero in the initial position of a case; frames of objects may show another one at the start, up to whole
    turns. It is the one nearest to a rest angle within half a turn, or, if the spring is wound up further, to zero.
    """
    if isinstance(spring, Spring):
        return spring.length
    return spring.rest if abs(spring.rest) <= math.pi else 0.0


def _packing_module(spring: Spring | JointSpring, integrator: str) -> str:
    return SCALAR_LAWS if integrator == "dele2" and len(spring.curve[0]) else __name__


class SpringEntry(CoordinateEntry):
    """A spring.

    Attributes
    ----------
    block
        Number of its block of rows, -1 if it is a force.
    rest
        Value without load [m] or [rad].
    stiffness, damping
        [N/m, N s/m] or [N m/rad, N m s/rad].
    first, count
        First row and rows of its curve; none if it is linear.
    """

    block: int
    rest: float
    stiffness: float
    damping: float
    first: int
    count: int


spring_outputs, load_outputs = outputs_at(SpringOutputs), outputs_at(TorqueOutputs)


class SpringState(Record):
    """What a spring remembers.

    Attributes
    ----------
    value, held
        Last value of an angle [rad], to count its turns; that of the last state that stands, see `hold_turns`.
    loss
        Energy lost in the damper of a row [J].
    rate, growth
        Of a row: rate in the last step [m/s] or [rad/s], and what it grows by in half a step.
    start_energy
        Of a force: energy stored at the start [J].
    started
        Whether that is known; of a row, whether a step has been made.
    paced
        Of a row: whether two have been made, so that `growth` is known.
    load, extremes
        Of a row: force at the end of the last step [N, N m], and its extremes.
    agreement
        Of a row: of the recorded force with the elongation.
    """

    value: float
    held: float
    loss: float
    rate: float
    growth: float
    start_energy: float
    started: bool
    paced: bool
    load: float
    extremes: Extremes
    agreement: Agreement


class Springs(Arrays):
    """All springs of a scene that are linear rows, or forces.

    Attributes
    ----------
    table
        The springs.
    curves
        Rows (elongation, force) of all tables, shape (m, 2).
    state
        What they remember.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[SpringEntry]
    curves: Floats2
    state: Records[SpringState]


def pack(springs: Sequence[Spring | JointSpring], context: PackingContext) -> None:
    """Make the kind: linear springs are rows where the integrator takes forces over a step, and forces otherwise.

    Raises
    ------
    InputError
        If the force of a table falls, the ends of a spring coincide, or its joint has no angle or travel.
    """
    rows, curves = [], [np.zeros((0, 2))]
    for spring in springs:
        curve = spring_table(spring, context)
        moves = spring.stiffness > 0.0 or spring.damping > 0.0  # nothing at all is no row
        as_row = context.integrator != "accurate" and not len(curve) and moves
        fields = spring_fields(spring, context, sum(map(len, curves)), len(curve), as_row=as_row)
        rows.append(filled(SpringEntry, **fields))
        curves.append(curve)
    table, state = records(SpringEntry, rows), records(SpringState, len(rows))
    state["value"] = [first_turn(spring) for spring in springs]
    kind = Springs(table, np.vstack(curves), state)
    context.add_rows(kind)
    if np.any(table["block"] < 0):
        context.add_forces(kind)


def spring_table(spring: Spring | JointSpring, context: PackingContext) -> NDArray[np.float64]:
    """Rows (elongation, force), shape (n, 2); none of a linear spring. Ends of a spring that coincide are refused.

    Raises
    ------
    InputError
        If the force falls, or a spring has no direction.
    """
    x, y = (np.asarray(column, dtype=np.float64) for column in spring.curve)
    if np.any(np.diff(y) < 0.0):
        i = int(np.argmax(np.diff(y) < 0.0))
        raise InputError(
            f"the force falls from {y[i]:g} to {y[i + 1]:g} between {x[i]:g} and {x[i + 1]:g}",
            source=spring.name,
            key="forces" if isinstance(spring, Spring) else "loads",
            expected="a force that does not fall with the elongation",
        )
    if isinstance(spring, Spring):
        ends = context.start_frames(as_joint(spring))
        distance = float(np.linalg.norm(ends[1].point - ends[0].point))
        if not distance > 1e-9 * (1.0 + float(np.abs(ends[0].point).max())):
            raise InputError(
                f"its ends are {distance:.3g} m apart at the start",
                source=spring.name,
                key="points",
                expected="ends apart from each other: a spring has no direction there",
            )
    return np.column_stack([x, y])


def spring_side(spring: Spring | JointSpring, context: PackingContext) -> tuple[int, Joint]:
    """Coordinate on which a spring acts, and its joint or what stands for it."""
    if isinstance(spring, Spring):
        return DISTANCE, as_joint(spring)
    joint = context.joint(spring.joint)
    return joint_coordinate(joint, spring), joint


def spring_fields(
    spring: Spring | JointSpring, context: PackingContext, first: int, count: int, *, as_row: bool
) -> dict[str, Any]:
    """Fields of the entry of a spring, whose curve has a first row and a number of rows."""
    coordinate, joint = spring_side(spring, context)
    level = ACTING if spring.damping > 0.0 or not as_row else ROWS
    if isinstance(spring, Spring):
        (a, b, c), rest = spring_markers(context.book, spring, level), spring.length
    else:
        (a, b, c), rest = joint_markers(context.book, joint, coordinate, level), spring.rest
    block = -1
    if as_row:
        k, d = (1.0, 0.0) if count else (spring.stiffness, spring.damping)  # a table is fitted by iteration
        k = max(k, SLOWEST_RATE * d)
        sides = (joint.body_a, joint.body_b)
        block = context.block(
            spring.name,
            sides,
            turns=coordinate == ANGLE,
            compliance=1.0 / k,
            relaxation=d / k,
            fitted=count > 0,
        )
    return {
        "coordinate": coordinate,
        "a": a,
        "b": b,
        "c": c,
        "column": context.column(spring),
        "block": block,
        "rest": float(rest),
        "stiffness": spring.stiffness,
        "damping": spring.damping,
        "first": first,
        "count": count,
    }


@kernel(inline=True, internal=True)
def spring_load(curves: NDArray[np.float64], spring: SpringEntry, e: float, rate: float) -> float:
    """Force that resists an elongation and, with a damper, its rate."""
    return spring_force(curves, spring.first, spring.count, spring.stiffness, e) + spring.damping * rate


@kernel(inline=True, internal=True)
def end_rate(spring: SpringEntry, work: Workspace) -> float:
    """Rate by the velocities at hand; zero where no damper asks for it."""
    if spring.damping > 0.0:
        return coordinate_rate(work, spring.coordinate, spring.a, spring.b, spring.c)
    return 0.0


@kernel(inline=True, internal=True)
def stored_energy(curves: NDArray[np.float64], spring: SpringEntry, e: float) -> float:
    """Energy stored at an elongation [J]."""
    return e * mean_force(curves, spring.first, spring.count, spring.stiffness, 0.0, e)[0]


@kernel(inline=True, internal=True)
def _elongation(kind: Springs, i: int, q: float) -> float:
    """The scalar, with the whole turns of an angle, less its rest value."""
    if kind.table[i].coordinate == ANGLE:
        q = near_angle(q, kind.state[i].value)
        kind.state[i].value = q
    return q - kind.table[i].rest


@implement(add_forces, Springs)
@kernel(internal=True)
def add_springs(kind: Springs, time: float, work: Workspace) -> None:
    """Forces on both sides; the power of dampers, which bodies count as that of outer forces, is lost."""
    for i in range(kind.table.shape[0]):
        spring = kind.table[i]
        if spring.block < 0:
            q = coordinate_value(work, spring.coordinate, spring.a, spring.b, spring.c)
            rate = end_rate(spring, work)
            load = spring_load(kind.curves, spring, _elongation(kind, i, q), rate)
            add_load(work, spring.coordinate, spring.a, spring.b, spring.c, -load)
            lost = spring.damping * rate * rate
            work.sums.external_work += lost
            work.sums.dissipated += lost


@implement(hold_turns, Springs)
@kernel(internal=True)
def hold_spring_turns(kind: Springs, back: bool) -> None:
    """Of angles."""
    for i in range(kind.table.shape[0]):
        if back:
            kind.state[i].value = kind.state[i].held
        else:
            kind.state[i].held = kind.state[i].value


@implement(fill_rows, Springs)
@kernel(internal=True)
def fill_spring_rows(kind: Springs, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows; elongations as residuals."""
    for i in range(kind.table.shape[0]):
        spring = kind.table[i]
        if spring.block >= 0:
            q = coordinate_row(system, spring.block, work, spring.coordinate, spring.a, spring.b, spring.c)
            if with_residual:
                put_residual(system, spring.block, _elongation(kind, i, q))


@implement(fill_bias, Springs)
@kernel(internal=True)
def fill_no_bias(kind: Springs, time: float, work: Workspace, system: RowSystem) -> None:
    """The accurate integrator takes springs as forces, which have no rows."""


@implement(update_rows, Springs)
@kernel(internal=True)
def update_springs(kind: Springs, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """What the dampers of rows take."""
    for i in range(kind.table.shape[0]):
        block = kind.table[i].block
        if block >= 0:
            state, u = kind.state[i], row_rate(system, 2 * block, 2 * block + 2, work.velocity)
            state.loss += step * kind.table[i].damping * u * u
            state.growth = step / (step + work.control.last_step) * (u - state.rate)
            state.rate, state.paced, state.started = u, state.started, True


@kernel(inline=True, internal=True)
def compare_load(
    agreement: Agreement,
    curves: NDArray[np.float64],
    spring: SpringEntry,
    time: float,
    e: float,
    rate: float,
    growth: float,
    load: float,
) -> None:
    """A recorded force is that of the elongation and, of the damper, of the mean rates of the last two steps."""
    elastic = spring_force(curves, spring.first, spring.count, spring.stiffness, e)
    low = elastic + spring.damping * (rate - abs(growth))
    high = elastic + spring.damping * (rate + abs(growth))
    compare_force(agreement, time, load, low, high)


@implement(watch_joints, Springs)
@kernel(internal=True)
def watch_springs(kind: Springs, work: Workspace, system: RowArrays) -> None:
    """Forces of rows at the end of the step, whose residuals are the elongations."""
    for i in range(kind.table.shape[0]):
        spring, state = kind.table[i], kind.state[i]
        block = spring.block
        if block < 0:
            continue
        rate = 0.0
        if spring.damping > 0.0:
            rate = row_rate(system, 2 * block, 2 * block + 2, work.velocity)
            if state.paced:
                rate = steady_rate(state.rate, state.growth, rate)
        state.load = spring_load(kind.curves, spring, system.rows[block].residual[0], rate)
        note_value(state.extremes, work.control.interval, state.load)


@kernel(internal=True)
def put_spring(
    row: NDArray[np.float64],
    spring: SpringEntry,
    extremes: Extremes,
    interval: int,
    load: float,
    length: float,
) -> None:
    """What it records: between two points with its length, along a joint the load alone."""
    if spring.coordinate == DISTANCE:
        out = spring_outputs(row, spring.column)
        out.force = load
        out.length = length
        out.force_max = largest_of(extremes, interval, load)
        out.force_min = smallest_of(extremes, interval, load)
    else:
        load_outputs(row, spring.column).load = load


@implement(record_joints, Springs)
@kernel(internal=True)
def record_springs(
    kind: Springs, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Force that resists the elongation, and the length of springs between points.

    The energy of forces moves from the work of outer forces, where the bodies count it, to that of springs.
    """
    for i in range(kind.table.shape[0]):
        spring, state = kind.table[i], kind.state[i]
        q = coordinate_value(work, spring.coordinate, spring.a, spring.b, spring.c)
        e = _elongation(kind, i, q)
        load = state.load
        if spring.block < 0 or not state.started:
            load = spring_load(kind.curves, spring, e, end_rate(spring, work))
        elif state.paced:
            compare_load(state.agreement, kind.curves, spring, time, e, state.rate, state.growth, load)
        put_spring(row, spring, state.extremes, work.control.interval, load, q)
        energy = stored_energy(kind.curves, spring, e)
        work.sums.elastic += energy
        if spring.block >= 0:
            work.sums.dissipated += state.loss
            continue
        if not state.started:
            state.start_energy, state.started = energy, True
        work.sums.external_work += energy - state.start_energy
