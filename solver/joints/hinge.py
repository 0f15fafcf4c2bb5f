"""Hinges: the points and the z axes of both sides coincide; 5 rows.

"Integrated simulation ... (2018)", section 2.4.3, with two independent rows in place of the cross product
of the axes, whose three rows have rank two::

    p_b - p_a = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.connections import Hinge
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import JointPlace, angle_markers, point_markers, refuse_opposite
from heavylift.solver.joints.reactions import (
    ANGLE_CHANNELS,
    ANGLE_STATE,
    REACTION_WIDTH,
    add_moment,
    record_angle,
    write_reaction,
)
from heavylift.solver.joints.row_writing import (
    difference,
    put_point_rows,
    residuals,
    square_bias,
    square_row,
    targets,
    write_point_bias,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows import RowArrays

__all__ = ["CHANNELS", "ROTATIONAL", "Hinges", "pack"]

ROTATIONAL = (False, False, False, True, True)
CHANNELS = ANGLE_CHANNELS

BLOCK, POINT_A, POINT_B, Z_A, X_B, Y_B, COLUMN, ANGLE = range(8)


class Hinges(Arrays):
    """All hinges of a scene.

    Attributes
    ----------
    table
        Block, point markers of a and b, direction markers z of a, x and y of b, first record column, markers
        of the recorded angle; shape (n, 10).
    state
        Whole turns, see `record_angle`; shape (n, 3).
    """

    table: Ints2
    state: Floats2


def pack(joints: Sequence[Hinge], places: Sequence[JointPlace], book: MarkerBook) -> Hinges:
    """Make the kind."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (2,))
        axes = (
            book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 0], at=joint.frame_b.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 1], at=joint.frame_b.point),
        )
        points, angle = point_markers(book, joint), angle_markers(book, joint, RECORD)
        rows.append((place.block, *points, *axes, place.column, *angle))
    return Hinges(np.array(rows, dtype=np.int64), np.zeros((len(rows), ANGLE_STATE)))


@implement(fill_rows, Hinges)
@kernel(internal=True)
def fill_hinge_rows(kind: Hinges, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry[BLOCK], entry[POINT_A], entry[POINT_B]
        put_point_rows(system, 2 * block, 0, work, point_a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, point_b, 1.0)
        zx = square_row(system, block, 3, work, entry[Z_A], entry[X_B])
        zy = square_row(system, block, 4, work, entry[Z_A], entry[Y_B])
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            g[3], g[4] = zx, zy


@implement(fill_bias, Hinges)
@kernel(internal=True)
def fill_hinge_bias(kind: Hinges, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_point_bias(system, entry[BLOCK], work, entry[POINT_A], entry[POINT_B])
        target = targets(system, entry[BLOCK])
        target[3] = -square_bias(work, entry[Z_A], entry[X_B])
        target[4] = -square_bias(work, entry[Z_A], entry[Y_B])


@implement(record_joints, Hinges)
@kernel(internal=True)
def record_hinges(
    kind: Hinges, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, angle."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, column = entry[BLOCK], entry[COLUMN]
        write_reaction(system, block, row, column)
        add_moment(system, block, 3, work, entry[X_B], entry[Z_A], row, column)
        add_moment(system, block, 4, work, entry[Y_B], entry[Z_A], row, column)
        x_a, x_b, y_b = entry[ANGLE], entry[ANGLE + 1], entry[ANGLE + 2]
        record_angle(work, x_a, x_b, y_b, kind.state[j], time, row, column + REACTION_WIDTH)
