"""Linear springs and dampers as rows of the step: stiff ones do not dictate its size.

With the scalar q of two points or of a joint, its row G, stiffness k and damping c the force in the middle of the
step is ``k (q_n + h/2 G v - rest) + c G v``: the trapezoidal rule, of second order and stable at any step::

    ( G A^-1 G^T + 2/(h z) ) P = -k (q_n - rest)/z - G U,     z = k h/2 + c

This is what a row of compliance ``1/k`` and relaxation time ``c/k`` does, so springs need no targets of their own.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    update_rows,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    DISTANCE,
    CoordinateEntry,
    coordinate_rate,
    coordinate_row,
    coordinate_value,
)
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.laws.rows import put_residual, row_rate
from heavylift.solver.rows.structure import RowArrays

__all__ = ["SpringRow", "SpringRowState", "SpringRows"]


class SpringRow(CoordinateEntry):
    """A linear spring.

    Attributes
    ----------
    block
        Number of its block of rows.
    rest
        Value without load [m] or [rad].
    stiffness, damping
        [N/m, N s/m] or [N m/rad, N m s/rad].
    """

    block: int
    rest: float
    stiffness: float
    damping: float


class SpringRowState(Record):
    """Last value of an angle [rad], to count its turns, and energy lost in the damper [J]."""

    value: float
    loss: float


class SpringRows(Arrays):
    """All linear springs and joint springs of a scene."""

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[SpringRow]
    state: Records[SpringRowState]


@kernel(inline=True, internal=True)
def _whole(kind: SpringRows, i: int, q: float) -> float:
    """The scalar with the whole turns of an angle."""
    if kind.table[i].coordinate == ANGLE:
        q = near_angle(q, kind.state[i].value)
        kind.state[i].value = q
    return q


@implement(fill_rows, SpringRows)
@kernel(internal=True)
def fill_spring_rows(kind: SpringRows, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows; elongations as residuals."""
    for i in range(kind.table.shape[0]):
        spring = kind.table[i]
        q = coordinate_row(system, spring.block, work, spring.coordinate, spring.a, spring.b, spring.c)
        if with_residual:
            put_residual(system, spring.block, _whole(kind, i, q) - spring.rest)


@implement(update_rows, SpringRows)
@kernel(internal=True)
def update_spring_rows(
    kind: SpringRows, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """What the dampers take."""
    for i in range(kind.table.shape[0]):
        block = kind.table[i].block
        u = row_rate(system, 2 * block, 2 * block + 2, work.velocity)
        kind.state[i].loss += step * kind.table[i].damping * u * u


@implement(record_joints, SpringRows)
@kernel(internal=True)
def record_spring_rows(
    kind: SpringRows, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Force that resists the elongation, and the length of springs between points."""
    for i in range(kind.table.shape[0]):
        spring = kind.table[i]
        coordinate, a, b, c, column = spring.coordinate, spring.a, spring.b, spring.c, spring.column
        k, d = spring.stiffness, spring.damping
        q = _whole(kind, i, coordinate_value(work, coordinate, a, b, c))
        e = q - spring.rest
        row[column] = k * e
        if d > 0.0:
            row[column] += d * coordinate_rate(work, coordinate, a, b, c)
        if coordinate == DISTANCE:
            row[column + 1] = q
        work.sums.elastic += 0.5 * k * e * e
        work.sums.dissipated += kind.state[i].loss
