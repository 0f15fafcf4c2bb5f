"""Forces on material points, tabulated over time, in world axes or following the body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.numerics.records import Record, Records, Vector, filled, records
from heavylift.solver.interface import (
    FORCES as ACTING,
)
from heavylift.solver.interface import (
    Workspace,
    add_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.scene.connections import FORCES, OnBody, Stage
from heavylift.solver.scene.descriptions import check_table, no_rows

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["PointForce", "PointForces", "pack"]


@FORCES.describe("point")
@dataclass(frozen=True, eq=False)
class PointForce(OnBody):
    """A force on a material point, constant or from a table over time."""

    STAGE: ClassVar = Stage.LOADS
    CHANNELS: ClassVar = ()
    SENTENCES: ClassVar = {
        "name": "Its name.",
        "body": "Body that is loaded.",
        "point": "Loaded point in the coordinates of the geometry [m]; of a flexible body, frame or shell any "
        "point of its mesh, or the name of an interface.",
    }

    times: Annotated[NDArray[np.float64], Quantity("time"), Shape((None,))] = field(default_factory=no_rows)
    """Times of the table [s], increasing."""
    forces: Annotated[NDArray[np.float64], Quantity("force"), Shape((None, 3))] = field(
        default_factory=no_rows
    )
    """Forces of the table [N], linear in between, constant before and after."""
    frame: Literal["world", "body"] = "world"
    """Axes of the force: of the world, or of the body frame."""
    force: Annotated[NDArray[np.float64] | None, Quantity("force"), Shape((3,))] = None
    """A constant force [N]."""

    def __post_init__(self) -> None:
        """A constant force is a table of one row."""
        if self.force is not None:
            object.__setattr__(self, "times", np.zeros(1))
            object.__setattr__(self, "forces", np.array([self.force]))
            object.__setattr__(self, "force", None)

    @staticmethod
    def check(spec: Any) -> None:
        """A force or a table."""
        if (spec.force is None) == (not spec.times and not spec.forces):
            raise InputError(
                "not exactly one of 'force' and a table", expected="'force', or 'times' and 'forces'"
            )
        check_table("times", spec.times, "forces", spec.forces)


class PointForceEntry(Record):
    """Marker of the point, and of the first body axis or -1 in world axes; first row of its table, and how many."""

    marker: int
    axes: int
    first: int
    count: int


class ForceAtTime(Record):
    """Row of a table: time [s], and force [N] in the axes of its entry."""

    time: float
    force: Vector


class PointForces(Arrays):
    """All tabulated point forces of a scene.

    Attributes
    ----------
    table
        The forces.
    values
        Their tables, one after another.
    """

    table: Records[PointForceEntry]
    values: Records[ForceAtTime]


def pack(loads: Sequence[PointForce], context: PackingContext) -> None:
    """Make the kind."""
    rows: list[PointForceEntry] = []
    first = 0
    for load in loads:
        marker, axes = context.point(load.body, load.point, ACTING), -1
        if load.frame == "body":
            axes = marker + 1
            for axis in np.eye(3):
                context.direction(load.body, axis, ACTING, at=load.point)
        count = len(load.times)
        rows.append(filled(PointForceEntry, marker=marker, axes=axes, first=first, count=count))
        first += count
    tables = records(ForceAtTime, first)
    tables["time"] = np.concatenate([load.times for load in loads])
    tables["force"] = np.concatenate([load.forces for load in loads])
    context.add_forces(PointForces(records(PointForceEntry, rows), tables))


@implement(add_forces, PointForces)
@kernel(internal=True)
def add_point_forces(kind: PointForces, time: float, work: Workspace) -> None:
    """Interpolate each table linearly and add the force to its marker."""
    for entry in range(kind.table.shape[0]):
        own = kind.table[entry]
        marker, axes = own.marker, own.axes
        low, high = own.first, own.first + own.count - 1
        while high - low > 1:
            middle = (low + high) // 2
            if kind.values[middle].time <= time:
                low = middle
            else:
                high = middle
        before, after = kind.values[low], kind.values[high]
        span = after.time - before.time
        part = min(max((time - before.time) / span, 0.0), 1.0) if span > 0.0 else 0.0
        for k in range(3):
            component = before.force[k] + part * (after.force[k] - before.force[k])
            if axes < 0:
                work.markers[marker].force[k] += component
            else:
                for j in range(3):
                    work.markers[marker].force[j] += component * work.markers[axes + k].point[j]
