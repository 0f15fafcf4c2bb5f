"""Tuggers: winches that keep their tension, whatever the distance of the two ends.

With the unit vector e from a to b the tension T acts as ``T e`` on a and ``-T e`` on b. Its power is that of the
winch, ``-T d/dt |b - a|``, and counts as work of outer forces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.quantity import Quantity
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.interface import FORCES, Workspace, add_forces, record_forces
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene import connections
from heavylift.solver.scene.connections import Between, PackedForce
from heavylift.solver.scene.outputs import Outputs, channel, outputs

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackingContext

__all__ = ["Tugger", "Tuggers", "pack"]


@outputs
class TuggerOutputs(Outputs):
    """What a tugger records."""

    pull: float = channel("force", "tension of a tugger; 0 where its ends coincide")
    distance: float = channel("length", "distance of the ends of a tugger")


@connections.FORCES.describe("tugger")
@dataclass(frozen=True, eq=False, kw_only=True)
class Tugger(Between, PackedForce):
    """A winch pulls the two points together with a constant tension."""

    CHANNELS: ClassVar = TuggerOutputs.CHANNELS

    tension: Annotated[float, Quantity("force", minimum=0.0, closed=True)]
    """Tension of the line [N]."""


class TuggerEntry(Record):
    """Markers of both ends, first record column, tension [N]."""

    a: int
    b: int
    column: int
    tension: float


tugger_outputs = outputs_at(TuggerOutputs)


class Tuggers(Arrays):
    """All tuggers of a scene."""

    table: Records[TuggerEntry]


def pack(tuggers: Sequence[Tugger], context: PackingContext) -> None:
    """Make the kind."""
    rows = [
        filled(
            TuggerEntry,
            a=context.point(tugger.body_a, tugger.point_a, FORCES),
            b=context.point(tugger.body_b, tugger.point_b, FORCES),
            column=context.column(tugger),
            tension=tugger.tension,
        )
        for tugger in tuggers
    ]
    context.add_forces(Tuggers(records(TuggerEntry, rows)))


@kernel(internal=True)
def _line(work: Workspace, entry: TuggerEntry) -> tuple[float, float, float, float]:
    """Distance of the ends [m], and the vector of the tension on a [N]; none where they coincide."""
    a, b = work.markers[entry.a].point, work.markers[entry.b].point
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    size = math.sqrt(x * x + y * y + z * z)
    factor = entry.tension / size if size > 0.0 else 0.0
    return size, factor * x, factor * y, factor * z


@implement(add_forces, Tuggers)
@kernel(internal=True)
def add_tuggers(kind: Tuggers, time: float, work: Workspace) -> None:
    """Tension on both ends."""
    for i in range(kind.table.shape[0]):
        entry = kind.table[i]
        _, x, y, z = _line(work, entry)
        on_a, on_b = work.markers[entry.a].force, work.markers[entry.b].force
        on_a[0] += x
        on_a[1] += y
        on_a[2] += z
        on_b[0] -= x
        on_b[1] -= y
        on_b[2] -= z


@implement(record_forces, Tuggers)
@kernel(internal=True)
def record_tuggers(kind: Tuggers, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Tension and distance."""
    for i in range(kind.table.shape[0]):
        entry = kind.table[i]
        size, _, _, _ = _line(work, entry)
        out = tugger_outputs(row, entry.column)
        out.pull = entry.tension if size > 0.0 else 0.0
        out.distance = size
