"""Linear springs and dampers as rows of the step: stiff ones do not dictate its size.

With the scalar q of two points or of a joint, its row G, stiffness k and damping c the force in the middle of the
step is ``k (q_n + h/2 G v - rest) + c G v``: the trapezoidal rule, of second order and stable at any step::

    ( G A^-1 G^T + 2/(h z) ) P = -k (q_n - rest)/z - G U,     z = k h/2 + c

This is what a row of compliance ``1/k`` and relaxation time ``c/k`` does, so springs need no targets of their own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    update_rows,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    DISTANCE,
    coordinate_rate,
    coordinate_row,
    coordinate_value,
)
from heavylift.solver.joints.law_rows import put_residual, row_rate
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.rows import RowArrays

__all__ = ["SpringRows"]

COORDINATE, BLOCK, A, B, C, COLUMN = range(6)
REST, STIFFNESS, DAMPING = range(3)
VALUE, LOSS = range(2)


class SpringRows(Arrays):
    """All linear springs and joint springs of a scene.

    Attributes
    ----------
    table
        Coordinate, block, three markers, first record column; shape (n, 6).
    values
        Value without load [m] or [rad], stiffness, damping; shape (n, 3).
    state
        Last value of an angle [rad], to count its turns, and energy lost in the damper [J]; shape (n, 2).
    """

    table: Ints2
    values: Floats2
    state: Floats2


@kernel(inline=True, internal=True)
def _whole(kind: SpringRows, i: int, q: float) -> float:
    """The scalar with the whole turns of an angle."""
    if kind.table[i, COORDINATE] == ANGLE:
        q = near_angle(q, kind.state[i, VALUE])
        kind.state[i, VALUE] = q
    return q


@implement(fill_rows, SpringRows)
@kernel(internal=True)
def fill_spring_rows(kind: SpringRows, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows; elongations as residuals."""
    for i in range(kind.table.shape[0]):
        coordinate, block, a, b, c, _ = kind.table[i]
        q = coordinate_row(system, block, work, coordinate, a, b, c)
        if with_residual:
            put_residual(system, block, _whole(kind, i, q) - kind.values[i, REST])


@implement(update_rows, SpringRows)
@kernel(internal=True)
def update_spring_rows(
    kind: SpringRows, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """What the dampers take."""
    for i in range(kind.table.shape[0]):
        block = kind.table[i, BLOCK]
        u = row_rate(system, 2 * block, 2 * block + 2, work.velocity)
        kind.state[i, LOSS] += step * kind.values[i, DAMPING] * u * u


@implement(record_joints, SpringRows)
@kernel(internal=True)
def record_spring_rows(
    kind: SpringRows, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Force that resists the elongation, and the length of springs between points."""
    for i in range(kind.table.shape[0]):
        coordinate, _, a, b, c, column = kind.table[i]
        k, d = kind.values[i, STIFFNESS], kind.values[i, DAMPING]
        q = _whole(kind, i, coordinate_value(work, coordinate, a, b, c))
        e = q - kind.values[i, REST]
        row[column] = k * e
        if d > 0.0:
            row[column] += d * coordinate_rate(work, coordinate, a, b, c)
        if coordinate == DISTANCE:
            row[column + 1] = q
        work.sums.elastic += 0.5 * k * e * e
        work.sums.dissipated += kind.state[i, LOSS]
