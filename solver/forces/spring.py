"""Springs and dampers as forces, for the integrators that evaluate forces at an instant.

Between two points, or on the angle or travel of a joint; linear or from a table. The same springs as rows of a
step are in `heavylift.solver.joints`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
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
    add_load,
    coordinate_rate,
    coordinate_value,
)
from heavylift.solver.joints.law_forces import mean_force, spring_force
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.rows import RowSystem

__all__ = ["Springs", "pack_springs"]

COORDINATE, A, B, C, COLUMN, FIRST, COUNT = range(7)
REST, STIFFNESS, DAMPING = range(3)
VALUE, START_ENERGY, STARTED = range(3)


class Springs(Arrays):
    """All springs of a scene that are forces.

    Attributes
    ----------
    table
        Coordinate, three markers, first record column, first row and rows of the curve; shape (n, 7).
    values
        Value without load [m] or [rad], stiffness, damping; shape (n, 3).
    curves
        Rows (elongation, force) of all tables, shape (m, 2).
    state
        Last value of an angle [rad], to count its turns; energy stored at the start [J]; 1 once that is known;
        shape (n, 3).
    """

    table: Ints2
    values: Floats2
    curves: Floats2
    state: Floats2


def pack_springs(
    springs: Sequence[tuple[tuple[int, ...], tuple[float, ...], NDArray[np.float64]]],
) -> Springs:
    """Make the kind from (coordinate, markers, column), (rest, stiffness, damping) and the curve of each."""
    table, curves = [], []
    first = 0
    for place, _, curve in springs:
        table.append((*place, first, len(curve)))
        curves.append(curve)
        first += len(curve)
    values = np.array([value for _, value, _ in springs], dtype=np.float64)
    state = np.zeros((len(springs), 3))
    state[:, VALUE] = values[:, REST]
    return Springs(np.array(table, dtype=np.int64), values, np.vstack([np.zeros((0, 2)), *curves]), state)


@kernel(internal=True)
def _elongation(kind: Springs, i: int, work: Workspace) -> float:
    """The scalar, whole turns included, less its rest value."""
    coordinate, a, b, c, _, _, _ = kind.table[i]
    q = coordinate_value(work, coordinate, a, b, c)
    if coordinate == ANGLE:
        q = near_angle(q, kind.state[i, VALUE])
        kind.state[i, VALUE] = q
    return q - kind.values[i, REST]


@kernel(internal=True)
def _force(kind: Springs, i: int, e: float, work: Workspace) -> float:
    """Force that resists elongation and its rate."""
    coordinate, a, b, c, _, first, count = kind.table[i]
    force = spring_force(kind.curves, first, count, kind.values[i, STIFFNESS], e)
    return force + kind.values[i, DAMPING] * coordinate_rate(work, coordinate, a, b, c)


@implement(add_forces, Springs)
@kernel(internal=True)
def add_springs(kind: Springs, time: float, work: Workspace) -> None:
    """Force on both sides."""
    for i in range(kind.table.shape[0]):
        coordinate, a, b, c, _, _, _ = kind.table[i]
        load = _force(kind, i, _elongation(kind, i, work), work)
        add_load(work, coordinate, a, b, c, -load)


@implement(fill_rows, Springs)
@kernel(internal=True)
def fill_no_rows(kind: Springs, with_residual: bool, work: Workspace, system: RowSystem) -> None:
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
        coordinate, _, _, _, column, first, count = kind.table[i]
        e = _elongation(kind, i, work)
        row[column] = _force(kind, i, e, work)
        if coordinate == DISTANCE:
            row[column + 1] = e + kind.values[i, REST]
        energy = e * mean_force(kind.curves, first, count, kind.values[i, STIFFNESS], 0.0, e)[0]
        if kind.state[i, STARTED] == 0.0:
            kind.state[i, START_ENERGY], kind.state[i, STARTED] = energy, 1.0
        work.sums.elastic += energy
        work.sums.external_work += energy - kind.state[i, START_ENERGY]
