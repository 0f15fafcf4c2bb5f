"""Edges of two shells that coincide, node by node: hinge of 6 rows, clamp of 7 or 8.

Along an element the edge is cubic in the positions and slopes at its ends, so with both the same, whatever the
sides are, it coincides everywhere::

    r_b - r_a = 0,    f_b r_s,b - f_a r_s,a = 0
    n . r_m,b = 0,    g_b n . r_sm,b - g_a e . r_sm,a = 0

s along the edge, m across it. The normal n of b, taken at the start, turns with the triad of a; the last row makes
the angle the same along the edge too. e is the normal of a, and g scale the turn of both surfaces along the edge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.mesh_rows import EdgeSeam
from heavylift.solver.joints.packing import JointEntry, JointPlace, point_markers
from heavylift.solver.joints.reactions import add_pull, reaction_outputs, write_reaction
from heavylift.solver.joints.row_writing import (
    add_direction_row,
    bias,
    difference,
    dot,
    put_direction_row,
    put_point_rows,
    residuals,
    square_bias,
    square_row,
    targets,
    vector,
    write_point_bias,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays

__all__ = ["EdgeSeams", "pack"]

TWIST = 3
"""Number of the twist among the slopes of a node."""


class SeamEntry(JointEntry):
    """A pair of nodes.

    Attributes
    ----------
    along_a, along_b
        Markers of the slopes along the edge.
    normal
        Marker of the normal of b, on a; -1 in a hinge, as the rest.
    across_b
        Marker of the slope of b across the edge.
    upright
        Marker of the normal of a; -1 without a row of the twists, as these.
    twist_a, twist_b
        Markers of the twists.
    slope_factor_a, slope_factor_b, twist_factor_a, twist_factor_b
        f and g: factors of the slopes along the edge, and of the twists.
    """

    along_a: int
    along_b: int
    normal: int
    across_b: int
    upright: int
    twist_a: int
    twist_b: int
    slope_factor_a: float
    slope_factor_b: float
    twist_factor_a: float
    twist_factor_b: float


class EdgeSeams(Arrays):
    """All pairs of nodes."""

    table: Records[SeamEntry]


def pack(joints: Sequence[EdgeSeam], places: Sequence[JointPlace], book: MarkerBook) -> EdgeSeams:
    """Make the kind."""
    table = records(SeamEntry, len(joints))
    for name in ("normal", "across_b", "upright", "twist_a", "twist_b"):
        table[name] = -1
    for entry, joint, place in zip(table, joints, places, strict=True):
        a, b = (joint.body_a, joint.frame_a.point), (joint.body_b, joint.frame_b.point)
        entry.along_a = book.slope(a[0], joint.along[0], at=a[1])
        entry.along_b = book.slope(b[0], joint.along[1], at=b[1])
        entry.block, entry.column = place.block, place.column
        entry.point_a, entry.point_b = point_markers(book, joint)
        entry.slope_factor_a, entry.slope_factor_b = joint.stretch
        if joint.normal is not None:
            entry.normal = book.direction(a[0], joint.normal, at=a[1])
            entry.across_b = book.slope(b[0], joint.across[1], at=b[1])
        if joint.twist is not None and joint.upright is not None:
            entry.upright = book.direction(a[0], joint.upright, at=a[1])
            entry.twist_a = book.slope(a[0], TWIST, at=a[1])
            entry.twist_b = book.slope(b[0], TWIST, at=b[1])
            entry.twist_factor_a, entry.twist_factor_b = joint.twist
    return EdgeSeams(table)


@kernel(internal=True)
def _put_scaled_rows(
    system: RowArrays, attachment: int, first: int, work: Workspace, marker: int, factor: float
) -> None:
    """``factor J[m]`` as three rows."""
    lanes = system.lanes
    begin = system.attachments[attachment].panel + first
    J = work.jacobian[marker]
    for k in range(system.attachments[attachment].width):
        for r in range(3):
            system.panels[begin + k * lanes + r] = factor * J[r, k]


@implement(fill_rows, EdgeSeams)
@kernel(internal=True)
def fill_seam_rows(kind: EdgeSeams, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        a, b = 2 * block, 2 * block + 1
        put_point_rows(system, a, 0, work, point_a, -1.0)
        put_point_rows(system, b, 0, work, point_b, 1.0)
        _put_scaled_rows(system, a, 3, work, entry.along_a, -entry.slope_factor_a)
        _put_scaled_rows(system, b, 3, work, entry.along_b, entry.slope_factor_b)
        angle = turn = 0.0
        if entry.normal >= 0:
            angle = square_row(system, block, 6, work, entry.normal, entry.across_b)
        if entry.upright >= 0:
            n, e = vector(work, entry.normal), vector(work, entry.upright)
            x, y = vector(work, entry.twist_a), vector(work, entry.twist_b)
            p, q = -entry.twist_factor_a, entry.twist_factor_b
            put_direction_row(system, a, 7, work, entry.normal, (q * y[0], q * y[1], q * y[2]))
            add_direction_row(system, a, 7, work, entry.upright, (p * x[0], p * x[1], p * x[2]))
            add_direction_row(system, a, 7, work, entry.twist_a, (p * e[0], p * e[1], p * e[2]))
            put_direction_row(system, b, 7, work, entry.twist_b, (q * n[0], q * n[1], q * n[2]))
            turn = q * dot(n, y) + p * dot(e, x)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            t, s = vector(work, entry.along_a), vector(work, entry.along_b)
            for k in range(3):
                g[3 + k] = entry.slope_factor_b * s[k] - entry.slope_factor_a * t[k]
            if entry.normal >= 0:
                g[6] = angle
            if entry.upright >= 0:
                g[7] = turn


@implement(fill_bias, EdgeSeams)
@kernel(internal=True)
def fill_seam_bias(kind: EdgeSeams, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_point_bias(system, entry.block, work, entry.point_a, entry.point_b)
        target = targets(system, entry.block)
        t, s = bias(work, entry.along_a), bias(work, entry.along_b)
        for k in range(3):
            target[3 + k] = entry.slope_factor_a * t[k] - entry.slope_factor_b * s[k]
        if entry.normal >= 0:
            target[6] = -square_bias(work, entry.normal, entry.across_b)
        if entry.upright >= 0:
            first = square_bias(work, entry.upright, entry.twist_a)
            second = square_bias(work, entry.normal, entry.twist_b)
            target[7] = entry.twist_factor_a * first - entry.twist_factor_b * second


@implement(record_joints, EdgeSeams)
@kernel(internal=True)
def record_seams(
    kind: EdgeSeams, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b at the node: force, and the moment of what pulls at its slopes."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, reaction_outputs(row, entry.column)
        write_reaction(system, block, out)
        s = vector(work, entry.along_b)
        for k in range(3):
            axis = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
            add_pull(system, block, 3 + k, entry.slope_factor_b, s, axis, out)
        if entry.normal >= 0:
            n = vector(work, entry.normal)
            add_pull(system, block, 6, 1.0, vector(work, entry.across_b), n, out)
            if entry.upright >= 0:
                add_pull(system, block, 7, entry.twist_factor_b, vector(work, entry.twist_b), n, out)
