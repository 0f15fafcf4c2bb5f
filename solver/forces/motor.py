"""Motors: a given torque about a hinge or force along a slider, of a on b, from a table over time.

The load acts on the markers of the angle or travel, so that load times rate is exactly the power of the motor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import ByCoordinate, Quantity, Shape
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.interface import (
    FORCES as ACTING,
)
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    fill_bias,
    fill_rows,
    record_joints,
    update_rows,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    CoordinateEntry,
    add_load,
    coordinate_rate,
    joint_coordinate,
    joint_markers,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowSystem
from heavylift.solver.scene.connections import FORCES, AlongJoint, TorqueOutputs
from heavylift.solver.scene.descriptions import check_table, no_rows

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["JointMotor", "Motors", "pack"]


@FORCES.describe("motor")
@dataclass(frozen=True, eq=False, kw_only=True)
class JointMotor(AlongJoint):
    """A torque or force of side a of a joint on its side b, constant or from a table over time."""

    coordinate: Literal["angle", "travel"] | None = None
    """Of a joint that both turns and slides: what of it counts."""
    load: Annotated[float | None, ByCoordinate(Quantity("moment or energy"), Quantity("force"))] = None
    """A constant torque [N m] or force [N]."""
    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """Times of the table [s], increasing."""
    loads: Annotated[
        NDArray[np.float64], ByCoordinate(Quantity("moment or energy"), Quantity("force")), Shape((None,))
    ] = field(default_factory=no_rows)
    """Torques or forces of the table, linear in between, constant before and after."""

    def __post_init__(self) -> None:
        """A constant load is a table of one row."""
        if self.load is not None:
            object.__setattr__(self, "times", np.zeros(1))
            object.__setattr__(self, "loads", np.array([self.load]))
            object.__setattr__(self, "load", None)

    @staticmethod
    def check(spec: Any) -> None:
        """A load or a table."""
        if (spec.load is None) == (not spec.times and not spec.loads):
            raise InputError(
                "not exactly one of 'load' and a table", expected="'load', or 'times' and 'loads'"
            )
        check_table("times", spec.times, "loads", spec.loads)


class MotorEntry(CoordinateEntry):
    """A motor.

    Attributes
    ----------
    dof_a, width_a, dof_b, width_b
        First velocity and number of velocities of both bodies.
    first, count
        First row and rows of its load table.
    """

    dof_a: int
    width_a: int
    dof_b: int
    width_b: int
    first: int
    count: int


load_outputs = outputs_at(TorqueOutputs)


class LoadRow(Record):
    """Time [s] and load [N m] or [N]."""

    time: float
    load: float


class Motors(Arrays):
    """All motors of a scene.

    Attributes
    ----------
    table
        The motors.
    loads
        Rows of all tables.
    state
        Work done so far [J], shape (n,).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[MotorEntry]
    loads: Records[LoadRow]
    state: Floats1


def pack(motors: Sequence[JointMotor], context: PackingContext) -> None:
    """Make the kind: forces, whose work is counted as that of drives.

    Raises
    ------
    InputError
        If its joint has no angle or travel.
    """
    table: list[MotorEntry] = []
    first = 0
    for motor in motors:
        joint = context.joint(motor.joint)
        coordinate = joint_coordinate(joint, motor)
        a, b, c = joint_markers(context.book, joint, coordinate, ACTING)
        side_a, side_b = context.attachment(joint.body_a), context.attachment(joint.body_b)
        entry = filled(
            MotorEntry,
            coordinate=coordinate,
            a=a,
            b=b,
            c=c,
            column=context.column(motor),
            dof_a=side_a.dof,
            width_a=side_a.width,
            dof_b=side_b.dof,
            width_b=side_b.width,
            first=first,
            count=len(motor.times),
        )
        table.append(entry)
        first += len(motor.times)
    loads = records(LoadRow, first)
    loads["time"] = np.concatenate([motor.times for motor in motors])
    loads["load"] = np.concatenate([motor.loads for motor in motors])
    kind = Motors(records(MotorEntry, table), loads, np.zeros(len(table)))
    context.add_rows(kind)
    context.add_forces(kind)


@kernel(internal=True)
def motor_load(kind: Motors, i: int, time: float) -> float:
    """Load at a time, linear between the rows and held at the ends."""
    first, count = kind.table[i].first, kind.table[i].count
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if kind.loads[middle].time <= time:
            low = middle
        else:
            high = middle
    before, after = kind.loads[low], kind.loads[high]
    span = after.time - before.time
    part = min(max((time - before.time) / span, 0.0), 1.0) if span > 0.0 else 0.0
    return before.load + part * (after.load - before.load)


@implement(add_forces, Motors)
@kernel(internal=True)
def add_motors(kind: Motors, time: float, work: Workspace) -> None:
    """Loads on the markers, which no other force uses; their power, which bodies count as that of outer forces."""
    for i in range(kind.table.shape[0]):
        motor, load = kind.table[i], motor_load(kind, i, time)
        add_load(work, motor.coordinate, motor.a, motor.b, motor.c, load)
        power = load * coordinate_rate(work, motor.coordinate, motor.a, motor.b, motor.c)
        work.sums.external_work -= power
        work.sums.drive_work += power


@kernel(internal=True)
def _power(work: Workspace, marker: int, dof: int, width: int) -> float:
    """Power of the force on a marker at the velocity of the stage [W]."""
    power = 0.0
    for k in range(width):
        J = work.jacobian[marker]
        along = (
            work.markers[marker].force[0] * J[0, k]
            + work.markers[marker].force[1] * J[1, k]
            + work.markers[marker].force[2] * J[2, k]
        )
        power += along * work.velocity[dof + k]
    return power


@implement(update_rows, Motors)
@kernel(internal=True)
def update_motors(kind: Motors, time: float, step: float, work: Workspace, system: RowSystem) -> None:
    """Work of the step; the third marker is on b for an angle and on a for a travel."""
    for i in range(kind.table.shape[0]):
        motor = kind.table[i]
        power = _power(work, motor.a, motor.dof_a, motor.width_a)
        power += _power(work, motor.b, motor.dof_b, motor.width_b)
        if motor.coordinate == ANGLE:
            power += _power(work, motor.c, motor.dof_b, motor.width_b)
        else:
            power += _power(work, motor.c, motor.dof_a, motor.width_a)
        kind.state[i] += step * power


@implement(fill_rows, Motors)
@kernel(internal=True)
def fillno_rows(kind: Motors, with_residual: bool, work: Workspace, system: RowSystem) -> None:
    """A force has no rows."""


@implement(fill_bias, Motors)
@kernel(internal=True)
def fill_no_bias(kind: Motors, time: float, work: Workspace, system: RowSystem) -> None:
    """A force has no rows."""


@implement(record_joints, Motors)
@kernel(internal=True)
def record_motors(
    kind: Motors, time: float, work: Workspace, system: RowSystem, row: NDArray[np.float64]
) -> None:
    """Load; its work moves from that of outer forces, where the bodies count it, to that of drives."""
    for i in range(kind.table.shape[0]):
        load_outputs(row, kind.table[i].column).load = motor_load(kind, i, time)
        work.sums.drive_work += kind.state[i]
        work.sums.external_work -= kind.state[i]
