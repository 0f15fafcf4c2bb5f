"""Two frames welded end to end: the points coincide, the tangents are parallel; 5 rows.

::

    p_b - p_a = 0,    n_1 . r'_b = 0,    n_2 . r'_b = 0

with two normals of ``r'_a``, which is all of ``r'_a x r'_b = 0`` that is independent. A frame has no torsion, so
which normals they are means nothing: the first is carried along with as little turn as possible.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, filled, records
from heavylift.numerics.vectors import cross
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.mesh_rows import FrameWeld
from heavylift.solver.joints.packing import JointEntry, JointPlace, entry_fields
from heavylift.solver.joints.reactions import add_pull, reaction_outputs, write_reaction
from heavylift.solver.joints.row_writing import (
    Vector,
    bias,
    difference,
    dot,
    put_direction_row,
    put_point_rows,
    rate,
    residuals,
    targets,
    vector,
    write_point_bias,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays

__all__ = ["FrameWelds", "pack"]


class FrameWeldEntry(JointEntry):
    """A weld, with markers of both tangents."""

    tangent_a: int
    tangent_b: int


class FrameWelds(Arrays):
    """All welds of frames.

    Attributes
    ----------
    table
        What each keeps.
    state
        First normal, shape (n, 3).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[FrameWeldEntry]
    state: Floats2


def pack(joints: Sequence[FrameWeld], places: Sequence[JointPlace], book: MarkerBook) -> FrameWelds:
    """Make the kind."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        rows.append(
            filled(
                FrameWeldEntry,
                tangent_a=book.slope(joint.body_a, 1, at=joint.frame_a.point),
                tangent_b=book.slope(joint.body_b, 1, at=joint.frame_b.point),
                **entry_fields(book, joint, place),
            )
        )
    normals = np.array([joint.normal for joint in joints], dtype=np.float64)
    return FrameWelds(records(FrameWeldEntry, rows), normals)


@kernel(internal=True)
def _normals(kind: FrameWelds, j: int, t: Vector) -> tuple[Vector, Vector, float]:
    """Two unit normals of a tangent and its inverse length; the first is kept."""
    size = 1.0 / math.sqrt(dot(t, t))
    u = (size * t[0], size * t[1], size * t[2])
    m = (kind.state[j, 0], kind.state[j, 1], kind.state[j, 2])
    part = dot(m, u)
    m = (m[0] - part * u[0], m[1] - part * u[1], m[2] - part * u[2])
    scale = 1.0 / math.sqrt(dot(m, m))
    m = (scale * m[0], scale * m[1], scale * m[2])
    kind.state[j, 0], kind.state[j, 1], kind.state[j, 2] = m
    return m, cross(u, m), size


@implement(fill_rows, FrameWelds)
@kernel(internal=True)
def fill_weld_rows(kind: FrameWelds, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers; the normals turn with ``r'_a``, which turns ``r'_b`` with it."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        tangent_a, tangent_b = entry.tangent_a, entry.tangent_b
        put_point_rows(system, 2 * block, 0, work, point_a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, point_b, 1.0)
        t, s = vector(work, tangent_a), vector(work, tangent_b)
        first, second, size = _normals(kind, j, t)
        part = -dot(s, t) * size * size
        p, q = first, second
        put_direction_row(system, 2 * block, 3, work, tangent_a, (part * p[0], part * p[1], part * p[2]))
        put_direction_row(system, 2 * block, 4, work, tangent_a, (part * q[0], part * q[1], part * q[2]))
        put_direction_row(system, 2 * block + 1, 3, work, tangent_b, first)
        put_direction_row(system, 2 * block + 1, 4, work, tangent_b, second)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            g[3], g[4] = dot(first, s), dot(second, s)


@implement(fill_bias, FrameWelds)
@kernel(internal=True)
def fill_weld_bias(kind: FrameWelds, time: float, work: Workspace, system: RowArrays) -> None:
    """Second rate of ``n . (r'_b - c r'_a)`` on closed joints, c the ratio of the two."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        tangent_a, tangent_b = entry.tangent_a, entry.tangent_b
        write_point_bias(system, block, work, point_a, point_b)
        t, s = vector(work, tangent_a), vector(work, tangent_b)
        first, second, size = _normals(kind, j, t)
        ratio = dot(s, t) * size * size
        turning, other = rate(work, tangent_a), rate(work, tangent_b)
        # r'_b = c r'_a: c' follows from the parts along the tangent
        ratio_rate = (dot(other, t) - ratio * dot(turning, t)) * size * size
        gamma_a, gamma_b = bias(work, tangent_a), bias(work, tangent_b)
        target = targets(system, block)
        for k in range(2):
            n = first if k == 0 else second
            target[3 + k] = -dot(n, gamma_b) + ratio * dot(n, gamma_a) + 2.0 * ratio_rate * dot(n, turning)


@implement(record_joints, FrameWelds)
@kernel(internal=True)
def record_welds(
    kind: FrameWelds, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        write_reaction(system, block, out)
        first, second, _ = _normals(kind, j, vector(work, entry.tangent_a))
        s = vector(work, entry.tangent_b)
        add_pull(system, block, 3, 1.0, s, first, out)
        add_pull(system, block, 4, 1.0, s, second, out)
