"""Hinges: the points and the z axes of both sides coincide; 5 rows.

"Integrated simulation ... (2018)", section 2.4.3, with two independent rows in place of the cross product
of the axes, whose three rows have rank two::

    p_b - p_a = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.connections import Hinge
from heavylift.solver.interface import Workspace, fill_rows, record_joints
from heavylift.solver.joints.packing import JointPlace, MarkerBook
from heavylift.solver.joints.row_writing import (
    add_moment,
    difference,
    dot,
    put_direction_row,
    put_point_rows,
    residuals,
    vector,
    write_reaction,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows import RowSystem

__all__ = ["ROTATIONAL", "Hinges", "pack"]

ROTATIONAL = (False, False, False, True, True)

BLOCK, POINT_A, POINT_B, Z_A, X_B, Y_B, COLUMN = range(7)


class Hinges(NamedTuple):
    """Block, point markers of a and b, direction markers z of a, x and y of b, record column; shape (n, 7)."""

    table: NDArray[np.int64]


def pack(joints: Sequence[Hinge], places: Sequence[JointPlace], book: MarkerBook) -> Hinges:
    """Make the kind."""
    rows = [
        (
            place.block,
            book.point(joint.body_a, joint.frame_a.point),
            book.point(joint.body_b, joint.frame_b.point),
            book.direction(joint.body_a, joint.frame_a.axes[:, 2]),
            book.direction(joint.body_b, joint.frame_b.axes[:, 0]),
            book.direction(joint.body_b, joint.frame_b.axes[:, 1]),
            place.column,
        )
        for joint, place in zip(joints, places, strict=True)
    ]
    return Hinges(np.array(rows, dtype=np.int64))


@implement(fill_rows, Hinges)
@kernel(internal=True)
def fill_hinge_rows(kind: Hinges, with_residual: bool, work: Workspace, system: RowSystem) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        block, point_a, point_b, z_a, x_b, y_b, _ = kind.table[j]
        a, b = 2 * block, 2 * block + 1
        z, x, y = vector(work, z_a), vector(work, x_b), vector(work, y_b)
        put_point_rows(system, a, 0, work, point_a, -1.0)
        put_point_rows(system, b, 0, work, point_b, 1.0)
        put_direction_row(system, a, 3, work, z_a, x)
        put_direction_row(system, b, 3, work, x_b, z)
        put_direction_row(system, a, 4, work, z_a, y)
        put_direction_row(system, b, 4, work, y_b, z)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            g[3], g[4] = dot(z, x), dot(z, y)


@implement(record_joints, Hinges)
@kernel(internal=True)
def record_hinges(
    kind: Hinges, time: float, work: Workspace, system: RowSystem, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        block, _, _, z_a, x_b, y_b, column = kind.table[j]
        write_reaction(system, block, row, column)
        add_moment(system, block, 3, work, x_b, z_a, row, column)
        add_moment(system, block, 4, work, y_b, z_a, row, column)
