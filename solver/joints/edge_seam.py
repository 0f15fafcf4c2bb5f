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

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.mesh_rows import EdgeSeam
from heavylift.solver.joints.packing import JointPlace, point_markers
from heavylift.solver.joints.reactions import add_pull, write_reaction
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
from heavylift.solver.rows import RowArrays

__all__ = ["EdgeSeams", "pack"]

BLOCK, POINT_A, POINT_B, ALONG_A, ALONG_B, COLUMN = range(6)
NORMAL, ACROSS_B, UPRIGHT, TWIST_A, TWIST_B = range(6, 11)
SLOPE_A, SLOPE_B, TURN_A, TURN_B = range(4)
TWIST = 3


class EdgeSeams(Arrays):
    """All pairs of nodes.

    Attributes
    ----------
    table
        Block, point markers of a and b, slopes along the edge of a and b, record column; normal of b on a, slope of b
        across the edge, normal of a, twists of a and b, or -1; shape (n, 11).
    factors
        Of the slopes along the edge of a and b, of the twists of a and b; shape (n, 4).
    """

    table: Ints2
    factors: Floats2


def pack(joints: Sequence[EdgeSeam], places: Sequence[JointPlace], book: MarkerBook) -> EdgeSeams:
    """Make the kind."""
    table = np.full((len(joints), 11), -1, dtype=np.int64)
    factors = np.zeros((len(joints), 4))
    for row, own, joint, place in zip(table, factors, joints, places, strict=True):
        a, b = (joint.body_a, joint.frame_a.point), (joint.body_b, joint.frame_b.point)
        along = book.slope(a[0], joint.along[0], at=a[1]), book.slope(b[0], joint.along[1], at=b[1])
        row[: COLUMN + 1] = (place.block, *point_markers(book, joint), *along, place.column)
        own[:2] = joint.stretch
        if joint.normal is not None:
            row[NORMAL] = book.direction(a[0], joint.normal, at=a[1])
            row[ACROSS_B] = book.slope(b[0], joint.across[1], at=b[1])
        if joint.twist is not None and joint.upright is not None:
            row[UPRIGHT] = book.direction(a[0], joint.upright, at=a[1])
            row[TWIST_A] = book.slope(a[0], TWIST, at=a[1])
            row[TWIST_B] = book.slope(b[0], TWIST, at=b[1])
            own[2:] = joint.twist
    return EdgeSeams(table, factors)


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
        entry, f = kind.table[j], kind.factors[j]
        block, point_a, point_b = entry[BLOCK], entry[POINT_A], entry[POINT_B]
        a, b = 2 * block, 2 * block + 1
        put_point_rows(system, a, 0, work, point_a, -1.0)
        put_point_rows(system, b, 0, work, point_b, 1.0)
        _put_scaled_rows(system, a, 3, work, entry[ALONG_A], -f[SLOPE_A])
        _put_scaled_rows(system, b, 3, work, entry[ALONG_B], f[SLOPE_B])
        angle = turn = 0.0
        if entry[NORMAL] >= 0:
            angle = square_row(system, block, 6, work, entry[NORMAL], entry[ACROSS_B])
        if entry[UPRIGHT] >= 0:
            n, e = vector(work, entry[NORMAL]), vector(work, entry[UPRIGHT])
            x, y = vector(work, entry[TWIST_A]), vector(work, entry[TWIST_B])
            p, q = -f[TURN_A], f[TURN_B]
            put_direction_row(system, a, 7, work, entry[NORMAL], (q * y[0], q * y[1], q * y[2]))
            add_direction_row(system, a, 7, work, entry[UPRIGHT], (p * x[0], p * x[1], p * x[2]))
            add_direction_row(system, a, 7, work, entry[TWIST_A], (p * e[0], p * e[1], p * e[2]))
            put_direction_row(system, b, 7, work, entry[TWIST_B], (q * n[0], q * n[1], q * n[2]))
            turn = q * dot(n, y) + p * dot(e, x)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            t, s = vector(work, entry[ALONG_A]), vector(work, entry[ALONG_B])
            for k in range(3):
                g[3 + k] = f[SLOPE_B] * s[k] - f[SLOPE_A] * t[k]
            if entry[NORMAL] >= 0:
                g[6] = angle
            if entry[UPRIGHT] >= 0:
                g[7] = turn


@implement(fill_bias, EdgeSeams)
@kernel(internal=True)
def fill_seam_bias(kind: EdgeSeams, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry, f = kind.table[j], kind.factors[j]
        write_point_bias(system, entry[BLOCK], work, entry[POINT_A], entry[POINT_B])
        target = targets(system, entry[BLOCK])
        t, s = bias(work, entry[ALONG_A]), bias(work, entry[ALONG_B])
        for k in range(3):
            target[3 + k] = f[SLOPE_A] * t[k] - f[SLOPE_B] * s[k]
        if entry[NORMAL] >= 0:
            target[6] = -square_bias(work, entry[NORMAL], entry[ACROSS_B])
        if entry[UPRIGHT] >= 0:
            target[7] = f[TURN_A] * square_bias(work, entry[UPRIGHT], entry[TWIST_A]) - f[
                TURN_B
            ] * square_bias(work, entry[NORMAL], entry[TWIST_B])


@implement(record_joints, EdgeSeams)
@kernel(internal=True)
def record_seams(
    kind: EdgeSeams, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b at the node: force, and the moment of what pulls at its slopes."""
    for j in range(kind.table.shape[0]):
        entry, f = kind.table[j], kind.factors[j]
        block, column = entry[BLOCK], entry[COLUMN]
        write_reaction(system, block, row, column)
        s = vector(work, entry[ALONG_B])
        for k in range(3):
            axis = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
            add_pull(system, block, 3 + k, f[SLOPE_B], s, axis, row, column)
        if entry[NORMAL] >= 0:
            n = vector(work, entry[NORMAL])
            add_pull(system, block, 6, 1.0, vector(work, entry[ACROSS_B]), n, row, column)
            if entry[UPRIGHT] >= 0:
                add_pull(system, block, 7, f[TURN_B], vector(work, entry[TWIST_B]), n, row, column)
