"""Sliders: the point of b slides along z of a without turning; 5 rows.

"Integrated simulation ... (2018)", section 2.4.3, with independent rows in place of cross products::

    x_a . (p_b - p_a) = 0,  y_a . (p_b - p_a) = 0,  z_a . x_b = 0,  z_a . y_b = 0,  x_a . y_b = 0
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.connections import Slider
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import JointPlace, point_markers, refuse_opposite, travel_markers
from heavylift.solver.joints.reactions import (
    REACTION_WIDTH,
    TRAVEL_CHANNELS,
    add_force,
    add_moment,
    clear_reaction,
    record_travel,
)
from heavylift.solver.joints.row_writing import (
    residuals,
    square_bias,
    square_row,
    targets,
    travel_bias,
    travel_row,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows import RowArrays

__all__ = ["CHANNELS", "ROTATIONAL", "Sliders", "pack"]

ROTATIONAL = (False, False, True, True, True)
CHANNELS = TRAVEL_CHANNELS

BLOCK, POINT_A, POINT_B, X_A, Y_A, Z_A, X_B, Y_B, COLUMN, TRAVEL = range(10)


class Sliders(Arrays):
    """All sliders of a scene.

    Attributes
    ----------
    table
        Block, point markers of a and b, direction markers x, y, z of a and x, y of b, first record column,
        markers of the recorded travel (3); shape (n, 12).
    """

    table: Ints2


def pack(joints: Sequence[Slider], places: Sequence[JointPlace], book: MarkerBook) -> Sliders:
    """Make the kind."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (0, 1, 2))
        axes_a = (
            book.direction(joint.body_a, joint.frame_a.axes[:, k], at=joint.frame_a.point) for k in range(3)
        )
        axes_b = (
            book.direction(joint.body_b, joint.frame_b.axes[:, k], at=joint.frame_b.point) for k in range(2)
        )
        points, recorded = point_markers(book, joint), travel_markers(book, joint, RECORD)
        rows.append((place.block, *points, *axes_a, *axes_b, place.column, *recorded))
    return Sliders(np.array(rows, dtype=np.int64))


@implement(fill_rows, Sliders)
@kernel(internal=True)
def fill_slider_rows(kind: Sliders, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry[BLOCK], entry[POINT_A], entry[POINT_B]
        x = travel_row(system, block, 0, work, point_a, point_b, entry[X_A])
        y = travel_row(system, block, 1, work, point_a, point_b, entry[Y_A])
        zx = square_row(system, block, 2, work, entry[Z_A], entry[X_B])
        zy = square_row(system, block, 3, work, entry[Z_A], entry[Y_B])
        xy = square_row(system, block, 4, work, entry[X_A], entry[Y_B])
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2], g[3], g[4] = x, y, zx, zy, xy


@implement(fill_bias, Sliders)
@kernel(internal=True)
def fill_slider_bias(kind: Sliders, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        target = targets(system, entry[BLOCK])
        target[0] = -travel_bias(work, entry[POINT_A], entry[POINT_B], entry[X_A])
        target[1] = -travel_bias(work, entry[POINT_A], entry[POINT_B], entry[Y_A])
        target[2] = -square_bias(work, entry[Z_A], entry[X_B])
        target[3] = -square_bias(work, entry[Z_A], entry[Y_B])
        target[4] = -square_bias(work, entry[X_A], entry[Y_B])


@implement(record_joints, Sliders)
@kernel(internal=True)
def record_sliders(
    kind: Sliders, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, travel."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, column = entry[BLOCK], entry[COLUMN]
        clear_reaction(row, column)
        add_force(system, block, 0, work, entry[X_A], row, column)
        add_force(system, block, 1, work, entry[Y_A], row, column)
        add_moment(system, block, 2, work, entry[X_B], entry[Z_A], row, column)
        add_moment(system, block, 3, work, entry[Y_B], entry[Z_A], row, column)
        add_moment(system, block, 4, work, entry[Y_B], entry[X_A], row, column)
        point_a, point_b, axis = entry[TRAVEL], entry[TRAVEL + 1], entry[TRAVEL + 2]
        record_travel(work, point_a, point_b, axis, row, column + REACTION_WIDTH)
