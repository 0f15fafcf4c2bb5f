"""Universal joints: the points of both sides coincide, and z of a stays square to z of b; 4 rows.

"Integrated simulation ... (2018)", section 2.4.2: a ball joint and ``z_a . z_b = 0``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import JointEntry, JointPlace, point_markers
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
from heavylift.solver.scene.connections import JOINTS, Joint, Place

__all__ = ["Universal", "UniversalJoints", "pack"]


LARGEST_COSINE = 0.9
"""Of the angle between the two axes at the start: the row vanishes when they are parallel."""


@JOINTS.describe("universal")
@dataclass(frozen=True, eq=False, kw_only=True)
class Universal(Joint):
    """The points coincide, and the axis of a stays square to the axis of b."""

    PLACE: ClassVar = Place.CROSS
    ROTATIONAL: ClassVar = (False, False, False, True)


class UniversalEntry(JointEntry):
    """A universal joint, with direction markers z of a and of b."""

    z_a: int
    z_b: int


class UniversalJoints(Arrays):
    """All universal joints of a scene."""

    table: Records[UniversalEntry]


def pack(joints: Sequence[Universal], places: Sequence[JointPlace], book: MarkerBook) -> UniversalJoints:
    """Make the kind.

    Raises
    ------
    InputError
        If the two axes are nearly parallel at the start.
    """
    rows = []
    for joint, place in zip(joints, places, strict=True):
        cosine = abs(float(place.frames[0].axes[:, 2] @ place.frames[1].axes[:, 2]))
        if not cosine < LARGEST_COSINE:
            raise InputError(
                f"the axes are {np.degrees(np.arccos(min(cosine, 1.0))):.1f} deg apart at the start",
                source=joint.name,
                key="axes",
                expected="two axes square to each other",
            )
        z_a = book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point)
        z_b = book.direction(joint.body_b, joint.frame_b.axes[:, 2], at=joint.frame_b.point)
        rows.append((place.block, *point_markers(book, joint), place.column, z_a, z_b))
    return UniversalJoints(records(UniversalEntry, rows))


@implement(fill_rows, UniversalJoints)
@kernel(internal=True)
def fill_universal_rows(
    kind: UniversalJoints, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        put_point_rows(system, 2 * block, 0, work, point_a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, point_b, 1.0)
        zz = square_row(system, block, 3, work, entry.z_a, entry.z_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            g[3] = zz


@implement(fill_bias, UniversalJoints)
@kernel(internal=True)
def fill_universal_bias(kind: UniversalJoints, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        write_point_bias(system, block, work, point_a, point_b)
        targets(system, block)[3] = -square_bias(work, entry.z_a, entry.z_b)


@implement(record_joints, UniversalJoints)
@kernel(internal=True)
def record_universal_joints(
    kind: UniversalJoints, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_reaction(system, entry.block, reaction_outputs(row, entry.column))
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        add_moment(system, block, 3, work, entry.z_b, entry.z_a, out)
