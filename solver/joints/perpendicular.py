"""Joints of points and of vectors that are perpendicular to each other: frames, and edges of shells on other bodies.

"Integrated simulation ... (2018)", sections 2.5.1 and 2.5.2, with independent rows in place of cross products.

::

    p_b - p_a = 0,    f_k c_k . e_k = 0    (k = 1 ... 4 at most)

with directions or slopes c on a, e on b. A frame has no torsion, so two normals t of the other side are all that
holds its tangent: ``t . r' = 0``; the cross product of tangents, as in "Integrated simulation ... (2018)", eq. 192,
has three rows of rank two. The stretch ``|r'|`` stays free.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.mesh_rows import SquareJoint
from heavylift.solver.joints.packing import JointEntry, JointPlace, point_markers
from heavylift.solver.joints.reactions import add_pull, reaction_outputs, write_reaction
from heavylift.solver.joints.row_writing import (
    difference,
    dot,
    put_direction_row,
    put_point_rows,
    residuals,
    square_bias,
    targets,
    vector,
    write_point_bias,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import JointFrame

__all__ = ["SquareJoints", "pack"]

MOST = 4


class SquareEntry(JointEntry):
    """A joint of points and pairs of vectors.

    Attributes
    ----------
    count
        How many pairs.
    vectors_a, vectors_b
        Markers of c and e of each pair.
    factors
        Of each pair.
    """

    count: int
    vectors_a: Annotated[NDArray[np.int64], (MOST,)]
    vectors_b: Annotated[NDArray[np.int64], (MOST,)]
    factors: Annotated[NDArray[np.float64], (MOST,)]


class SquareJoints(Arrays):
    """All such joints of a scene."""

    table: Records[SquareEntry]


def pack(joints: Sequence[SquareJoint], places: Sequence[JointPlace], book: MarkerBook) -> SquareJoints:
    """Make the kind."""
    table = records(SquareEntry, len(joints))
    for entry, joint, place in zip(table, joints, places, strict=True):
        entry.block, entry.column, entry.count = place.block, place.column, len(joint.squares)
        entry.point_a, entry.point_b = point_markers(book, joint)
        for k, square in enumerate(joint.squares):
            entry.vectors_a[k] = _marker(book, joint.body_a, joint.frame_a, square.a)
            entry.vectors_b[k] = _marker(book, joint.body_b, joint.frame_b, square.b)
            entry.factors[k] = square.factor
    return SquareJoints(table)


def _marker(book: MarkerBook, body: str, frame: JointFrame, vector: NDArray[np.float64] | int) -> int:
    if isinstance(vector, int):
        return book.slope(body, vector, at=frame.point)
    return book.direction(body, vector, at=frame.point)


@implement(fill_rows, SquareJoints)
@kernel(internal=True)
def fill_square_rows(kind: SquareJoints, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        put_point_rows(system, 2 * block, 0, work, point_a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, point_b, 1.0)
        g = residuals(system, block)
        if with_residual:
            g[0], g[1], g[2] = difference(work, point_a, point_b)
        for k in range(entry.count):
            a, b, f = entry.vectors_a[k], entry.vectors_b[k], entry.factors[k]
            c, e = vector(work, a), vector(work, b)
            put_direction_row(system, 2 * block, 3 + k, work, a, (f * e[0], f * e[1], f * e[2]))
            put_direction_row(system, 2 * block + 1, 3 + k, work, b, (f * c[0], f * c[1], f * c[2]))
            if with_residual:
                g[3 + k] = f * dot(c, e)


@implement(fill_bias, SquareJoints)
@kernel(internal=True)
def fill_square_bias(kind: SquareJoints, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_point_bias(system, entry.block, work, entry.point_a, entry.point_b)
        target = targets(system, entry.block)
        for k in range(entry.count):
            a, b = entry.vectors_a[k], entry.vectors_b[k]
            target[3 + k] = -entry.factors[k] * square_bias(work, a, b)


@implement(record_joints, SquareJoints)
@kernel(internal=True)
def record_square_joints(
    kind: SquareJoints, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        write_reaction(system, block, out)
        for k in range(entry.count):
            c = vector(work, entry.vectors_a[k])
            e = vector(work, entry.vectors_b[k])
            add_pull(system, block, 3 + k, entry.factors[k], e, c, out)
