"""Planar joints: the point of b stays in the plane of x and y of a, and the z axes are parallel; 3 rows.

::

    z_a . (p_b - p_a) = 0,    z_a . x_b = 0,    z_a . y_b = 0
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
from heavylift.solver.joints.reactions import add_force, add_moment, clear_reaction, reaction_outputs
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
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import JOINTS, Joint, Place

__all__ = ["Planar", "PlanarJoints", "pack"]


@JOINTS.describe("planar")
@dataclass(frozen=True, eq=False, kw_only=True)
class Planar(Joint):
    """The point of b stays in the plane across the axis of a, and the axes are parallel."""

    PLACE: ClassVar = Place.AXIS
    ROTATIONAL: ClassVar = (False, True, True)


class PlanarEntry(JointEntry):
    """A planar joint, with direction markers z of a, x and y of b."""

    z_a: int
    x_b: int
    y_b: int


class PlanarJoints(Arrays):
    """All planar joints of a scene."""

    table: Records[PlanarEntry]


def pack(joints: Sequence[Planar], places: Sequence[JointPlace], book: MarkerBook) -> PlanarJoints:
    """Make the kind."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (2,))
        axes = (
            book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 0], at=joint.frame_b.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 1], at=joint.frame_b.point),
        )
        rows.append((place.block, *point_markers(book, joint), place.column, *axes))
    return PlanarJoints(records(PlanarEntry, rows))


@implement(fill_rows, PlanarJoints)
@kernel(internal=True)
def fill_planar_rows(kind: PlanarJoints, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        height = travel_row(system, block, 0, work, point_a, point_b, entry.z_a)
        zx = square_row(system, block, 1, work, entry.z_a, entry.x_b)
        zy = square_row(system, block, 2, work, entry.z_a, entry.y_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = height, zx, zy


@implement(fill_bias, PlanarJoints)
@kernel(internal=True)
def fill_planar_bias(kind: PlanarJoints, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        target = targets(system, block)
        target[0] = -travel_bias(work, point_a, point_b, entry.z_a)
        target[1] = -square_bias(work, entry.z_a, entry.x_b)
        target[2] = -square_bias(work, entry.z_a, entry.y_b)


@implement(record_joints, PlanarJoints)
@kernel(internal=True)
def record_planar_joints(
    kind: PlanarJoints, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        clear_reaction(out)
        add_force(system, block, 0, work, entry.z_a, out)
        add_moment(system, block, 1, work, entry.x_b, entry.z_a, out)
        add_moment(system, block, 2, work, entry.y_b, entry.z_a, out)
