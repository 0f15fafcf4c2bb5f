"""Forces on material points, tabulated over time, in world axes or following the body."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.solver.interface import (
    Workspace,
    add_forces,
)
from heavylift.solver.kinds import implement

if TYPE_CHECKING:
    from heavylift.solver.scene import PointForce

__all__ = ["PointForces", "pack_point_forces"]


class PointForces(Arrays):
    """All tabulated point forces of a scene.

    Attributes
    ----------
    table
        Marker of the point, marker of the first body axis or -1, first row and row count of the table;
        shape (m, 4).
    values
        Time [s] and force [N] in the axes of the entry, shape (rows, 4).
    """

    table: Ints2
    values: Floats2


def pack_point_forces(entries: Sequence[PointForce], first_markers: Sequence[int]) -> PointForces:
    """Make the kind from the entries of a scene.

    Parameters
    ----------
    entries
        Forces.
    first_markers
        Number of the point marker of each entry; the axes follow it.

    Raises
    ------
    InputError
        If a table is empty, does not fit, or its times do not increase.
    """
    rows: list[tuple[int, int, int, int]] = []
    tables: list[NDArray[np.float64]] = []
    first_row = 0
    for entry, marker in zip(entries, first_markers, strict=True):
        times = np.atleast_1d(np.asarray(entry.times, dtype=np.float64))
        forces = np.asarray(entry.forces, dtype=np.float64).reshape(-1, 3)
        if len(times) != len(forces) or len(times) == 0 or not np.all(np.diff(times) > 0.0):
            raise InputError(
                f"{len(times)} times and {len(forces)} forces",
                source=entry.name,
                key="times",
                expected="one force a time, times increasing",
            )
        rows.append((marker, marker + 1 if entry.frame == "body" else -1, first_row, len(times)))
        tables.append(np.column_stack([times, forces]))
        first_row += len(times)
    return PointForces(np.array(rows, dtype=np.int64).reshape(-1, 4), np.vstack(tables))


@implement(add_forces, PointForces)
@kernel(internal=True)
def add_point_forces(kind: PointForces, time: float, work: Workspace) -> None:
    """Interpolate each table linearly and add the force to its marker."""
    for entry in range(kind.table.shape[0]):
        marker, axes, first, count = kind.table[entry]
        low, high = first, first + count - 1
        while high - low > 1:
            middle = (low + high) // 2
            if kind.values[middle, 0] <= time:
                low = middle
            else:
                high = middle
        span = kind.values[high, 0] - kind.values[low, 0]
        part = min(max((time - kind.values[low, 0]) / span, 0.0), 1.0) if span > 0.0 else 0.0
        for k in range(3):
            component = kind.values[low, 1 + k] + part * (kind.values[high, 1 + k] - kind.values[low, 1 + k])
            if axes < 0:
                work.markers[marker].force[k] += component
            else:
                for j in range(3):
                    work.markers[marker].force[j] += component * work.markers[axes + k].point[j]
