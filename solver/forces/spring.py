"""Springs and dampers as forces, for the integrators that evaluate forces at an instant.

Between two points, or on the angle or travel of a joint; linear or from a table. The same springs as rows of a
step are in `heavylift.solver.joints`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, AsDrawn, ByCoordinate, Quantity, Shape
from heavylift.numerics.records import Record, Records, records
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    fill_bias,
    fill_rows,
    record_joints,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    DISTANCE,
    CoordinateEntry,
    add_load,
    coordinate_rate,
    coordinate_value,
)
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.laws.forces import mean_force, spring_force
from heavylift.solver.rows.structure import RowSystem
from heavylift.solver.scene.connections import FORCES, AlongJoint, Between
from heavylift.solver.scene.descriptions import ChannelKind, check_table, no_rows

__all__ = ["JointSpring", "Spring", "Springs", "pack_springs"]


def _check_law(
    stiffness: float | None,
    damping: float,
    key: str,
    places: Sequence[float],
    values_key: str,
    values: Sequence[float],
) -> None:
    """A spring has a stiffness or a table, or is a mere damper."""
    if stiffness is not None and (places or values):
        raise InputError(
            "both 'stiffness' and a table", expected=f"'stiffness', or {key!r} and {values_key!r}"
        )
    if not stiffness and not damping and not (places or values):
        raise InputError(
            "neither a stiffness nor a damping",
            expected=f"'stiffness', 'damping', or {key!r} and {values_key!r}",
        )
    check_table(key, places, values_key, values, shortest=2)


@FORCES.describe("spring")
@dataclass(frozen=True, eq=False, kw_only=True)
class Spring(Between):
    """A spring and damper between two points, along their line: it pulls and pushes."""

    CHANNELS: ClassVar = (
        ChannelKind("force", "force", "tension of the spring with its damper; negative if it pushes"),
        ChannelKind("length", "length", "distance of the ends of the spring"),
    )
    """What it records, in the order of its columns."""

    length: Annotated[float, Quantity("length", minimum=0.0, closed=True), AsDrawn()]
    """Unloaded length [m]; as drawn if absent."""
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
    def check(said: Any) -> None:
        """A stiffness, a damping or a table."""
        _check_law(said.stiffness, said.damping, "elongations", said.elongations, "forces", said.forces)

    @property
    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Its table."""
        return self.elongations, self.forces


@FORCES.describe("joint_spring")
@dataclass(frozen=True, eq=False, kw_only=True)
class JointSpring(AlongJoint):
    """A spring and damper on the angle of a hinge or the travel of a slider."""

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
    def check(said: Any) -> None:
        """A stiffness, a damping or a table."""
        _check_law(said.stiffness, said.damping, "deflections", said.deflections, "loads", said.loads)

    @property
    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Its table."""
        return self.deflections, self.loads


class SpringEntry(CoordinateEntry):
    """A spring.

    Attributes
    ----------
    rest
        Value without load [m] or [rad].
    stiffness, damping
        [N/m, N s/m] or [N m/rad, N m s/rad].
    first, count
        First row and rows of its curve.
    """

    rest: float
    stiffness: float
    damping: float
    first: int
    count: int


class SpringState(Record):
    """What a spring remembers.

    Attributes
    ----------
    value
        Last value of an angle [rad], to count its turns.
    start_energy, started
        Energy stored at the start [J], and whether that is known.
    """

    value: float
    start_energy: float
    started: bool


class Springs(Arrays):
    """All springs of a scene that are forces.

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


def pack_springs(
    springs: Sequence[tuple[tuple[int, ...], tuple[float, ...], NDArray[np.float64]]],
) -> Springs:
    """Make the kind from (coordinate, markers, column), (rest, stiffness, damping) and the curve of each."""
    rows, curves = [], []
    first = 0
    for place, values, curve in springs:
        rows.append((*place, *values, first, len(curve)))
        curves.append(curve)
        first += len(curve)
    table, state = records(SpringEntry, rows), records(SpringState, len(rows))
    state["value"] = table["rest"]
    return Springs(table, np.vstack([np.zeros((0, 2)), *curves]), state)


@kernel(internal=True)
def _elongation(kind: Springs, i: int, work: Workspace) -> float:
    """The scalar, whole turns included, less its rest value."""
    spring = kind.table[i]
    q = coordinate_value(work, spring.coordinate, spring.a, spring.b, spring.c)
    if spring.coordinate == ANGLE:
        q = near_angle(q, kind.state[i].value)
        kind.state[i].value = q
    return q - spring.rest


@kernel(internal=True)
def _force(kind: Springs, i: int, e: float, work: Workspace) -> float:
    """Force that resists elongation and its rate."""
    spring = kind.table[i]
    force = spring_force(kind.curves, spring.first, spring.count, spring.stiffness, e)
    rate = coordinate_rate(work, spring.coordinate, spring.a, spring.b, spring.c)
    return force + spring.damping * rate


@implement(add_forces, Springs)
@kernel(internal=True)
def add_springs(kind: Springs, time: float, work: Workspace) -> None:
    """Force on both sides."""
    for i in range(kind.table.shape[0]):
        spring = kind.table[i]
        load = _force(kind, i, _elongation(kind, i, work), work)
        add_load(work, spring.coordinate, spring.a, spring.b, spring.c, -load)


@implement(fill_rows, Springs)
@kernel(internal=True)
def fillno_rows(kind: Springs, with_residual: bool, work: Workspace, system: RowSystem) -> None:
    """A force has no rows."""


@implement(fill_bias, Springs)
@kernel(internal=True)
def fill_no_bias(kind: Springs, time: float, work: Workspace, system: RowSystem) -> None:
    """A force has no rows."""


@implement(record_joints, Springs)
@kernel(internal=True)
def record_springs(
    kind: Springs, time: float, work: Workspace, system: RowSystem, row: NDArray[np.float64]
) -> None:
    """Force, length; the stored energy moves from the work of outer forces, where the bodies count it, to its own."""
    for i in range(kind.table.shape[0]):
        spring, state = kind.table[i], kind.state[i]
        e = _elongation(kind, i, work)
        row[spring.column] = _force(kind, i, e, work)
        if spring.coordinate == DISTANCE:
            row[spring.column + 1] = e + spring.rest
        energy = e * mean_force(kind.curves, spring.first, spring.count, spring.stiffness, 0.0, e)[0]
        if not state.started:
            state.start_energy, state.started = energy, True
        work.sums.elastic += energy
        work.sums.external_work += energy - state.start_energy
