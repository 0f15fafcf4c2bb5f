"""Ball joints: the points of both sides coincide; 3 rows: "Integrated simulation ... (2018)", eqs. 163-164."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import JointEntry, JointPlace, point_markers
from heavylift.solver.joints.reactions import reaction_outputs, write_reaction
from heavylift.solver.joints.row_writing import difference, put_point_rows, residuals, write_point_bias
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import JOINTS, Joint

__all__ = ["Ball", "BallJoints", "pack"]


@JOINTS.describe("ball")
@dataclass(frozen=True, eq=False, kw_only=True)
class Ball(Joint):
    """The two points coincide."""

    ROTATIONAL: ClassVar = (False, False, False)


class BallJoints(Arrays):
    """All ball joints of a scene."""

    table: Records[JointEntry]


def pack(joints: Sequence[Ball], places: Sequence[JointPlace], book: MarkerBook) -> BallJoints:
    """Make the kind."""
    rows = [
        (place.block, *point_markers(book, joint), place.column)
        for joint, place in zip(joints, places, strict=True)
    ]
    return BallJoints(records(JointEntry, rows))


@implement(fill_rows, BallJoints)
@kernel(internal=True)
def fill_ball_rows(kind: BallJoints, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """``p_b - p_a``."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        put_point_rows(system, 2 * entry.block, 0, work, entry.point_a, -1.0)
        put_point_rows(system, 2 * entry.block + 1, 0, work, entry.point_b, 1.0)
        if with_residual:
            g = residuals(system, entry.block)
            g[0], g[1], g[2] = difference(work, entry.point_a, entry.point_b)


@implement(fill_bias, BallJoints)
@kernel(internal=True)
def fill_ball_bias(kind: BallJoints, time: float, work: Workspace, system: RowArrays) -> None:
    """Centripetal accelerations of the points."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_point_bias(system, entry.block, work, entry.point_a, entry.point_b)


@implement(record_joints, BallJoints)
@kernel(internal=True)
def record_balls(
    kind: BallJoints, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_reaction(system, entry.block, reaction_outputs(row, entry.column))
