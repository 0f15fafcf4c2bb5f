"""Fixed joints: the frames of both sides coincide; 6 rows.

"Integrated simulation ... (2018)", section 2.4.5, by direction cosines in place of angles.

::

    p_b - p_a = 0,    z_a . x_b = 0,    z_a . y_b = 0,    x_a . y_b = 0
"""

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
from heavylift.solver.joints.packing import JointEntry, JointPlace, point_markers, refuse_opposite
from heavylift.solver.joints.reactions import add_moment, reaction_outputs, write_reaction
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
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import JOINTS, Joint

__all__ = ["FixedJoint", "FixedJoints", "pack"]


@JOINTS.describe("fixed")
@dataclass(frozen=True, eq=False, kw_only=True)
class FixedJoint(Joint):
    """The two sides move as one.

    A frame of ANCF elements keeps its tangent only, 5 rows: it has no torsion.
    """

    ROTATIONAL: ClassVar = (False, False, False, True, True, True)


class FixedEntry(JointEntry):
    """A fixed joint, with direction markers x, z of a and x, y of b."""

    x_a: int
    z_a: int
    x_b: int
    y_b: int


class FixedJoints(Arrays):
    """All fixed joints of a scene."""

    table: Records[FixedEntry]


def pack(joints: Sequence[FixedJoint], places: Sequence[JointPlace], book: MarkerBook) -> FixedJoints:
    """Make the kind."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (0, 1, 2))
        axes = (
            book.direction(joint.body_a, joint.frame_a.axes[:, 0], at=joint.frame_a.point),
            book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 0], at=joint.frame_b.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 1], at=joint.frame_b.point),
        )
        rows.append((place.block, *point_markers(book, joint), place.column, *axes))
    return FixedJoints(records(FixedEntry, rows))


@implement(fill_rows, FixedJoints)
@kernel(internal=True)
def fill_fixed_rows(kind: FixedJoints, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        put_point_rows(system, 2 * block, 0, work, point_a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, point_b, 1.0)
        zx = square_row(system, block, 3, work, entry.z_a, entry.x_b)
        zy = square_row(system, block, 4, work, entry.z_a, entry.y_b)
        xy = square_row(system, block, 5, work, entry.x_a, entry.y_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            g[3], g[4], g[5] = zx, zy, xy


@implement(fill_bias, FixedJoints)
@kernel(internal=True)
def fill_fixed_bias(kind: FixedJoints, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        write_point_bias(system, block, work, point_a, point_b)
        target = targets(system, block)
        target[3] = -square_bias(work, entry.z_a, entry.x_b)
        target[4] = -square_bias(work, entry.z_a, entry.y_b)
        target[5] = -square_bias(work, entry.x_a, entry.y_b)


@implement(record_joints, FixedJoints)
@kernel(internal=True)
def record_fixed_joints(
    kind: FixedJoints, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_reaction(system, entry.block, reaction_outputs(row, entry.column))
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        add_moment(system, block, 3, work, entry.x_b, entry.z_a, out)
        add_moment(system, block, 4, work, entry.y_b, entry.z_a, out)
        add_moment(system, block, 5, work, entry.y_b, entry.x_a, out)
