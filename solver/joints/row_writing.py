"""How joints write their rows: inner products of constant or marker vectors with marker Jacobians.

A row is the rate of a scalar built from markers. Its part on one side is a sum of terms ``c . J[m]``, so
the same few lines serve all joints and all bodies.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cross
from heavylift.solver.interface import POINT, Workspace
from heavylift.solver.rows import PANEL, REACTION, RESIDUAL, ROW_COLUMNS, WIDTH, RowSystem

__all__ = [
    "add_direction_row",
    "add_moment",
    "difference",
    "dot",
    "put_direction_row",
    "put_point_rows",
    "reactions",
    "residuals",
    "vector",
    "write_reaction",
]

Vector = tuple[float, float, float]


@kernel(inline=True, internal=True)
def vector(work: Workspace, marker: int) -> Vector:
    """The vector of a marker."""
    m = work.markers[marker]
    return m[POINT], m[POINT + 1], m[POINT + 2]


@kernel(inline=True, internal=True)
def difference(work: Workspace, a: int, b: int) -> Vector:
    """``p_b - p_a`` of two point markers."""
    x, y = work.markers[a], work.markers[b]
    return y[POINT] - x[POINT], y[POINT + 1] - x[POINT + 1], y[POINT + 2] - x[POINT + 2]


@kernel(inline=True, internal=True)
def dot(a: Vector, b: Vector) -> float:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel(inline=True, internal=True)
def residuals(system: RowSystem, block: int) -> NDArray[np.float64]:
    """Residuals of the rows of a block, a view."""
    lanes = len(system.shape[1])
    begin = (block * ROW_COLUMNS + RESIDUAL) * lanes
    return system.rows[begin : begin + lanes]


@kernel(inline=True, internal=True)
def put_point_rows(
    system: RowSystem, attachment: int, first: int, work: Workspace, marker: int, sign: float
) -> None:
    """Write ``sign J[m]`` as three rows: the components of a point along the world axes."""
    lanes = len(system.shape[1])
    width = system.attachments[attachment, WIDTH]
    begin = system.attachments[attachment, PANEL] + first
    J = work.jacobian[marker]
    if width == 6:
        for k in range(6):
            for r in range(3):
                system.panels[begin + k * lanes + r] = sign * J[r, k]
    else:
        for k in range(width):
            for r in range(3):
                system.panels[begin + k * lanes + r] = sign * J[r, k]


@kernel(inline=True, internal=True)
def put_direction_row(
    system: RowSystem, attachment: int, row: int, work: Workspace, marker: int, c: Vector
) -> None:
    """Write ``c . J[m]`` as one row."""
    lanes = len(system.shape[1])
    width = system.attachments[attachment, WIDTH]
    begin = system.attachments[attachment, PANEL] + row
    J = work.jacobian[marker]
    if width == 6:
        for k in range(6):
            system.panels[begin + k * lanes] = c[0] * J[0, k] + c[1] * J[1, k] + c[2] * J[2, k]
    else:
        for k in range(width):
            system.panels[begin + k * lanes] = c[0] * J[0, k] + c[1] * J[1, k] + c[2] * J[2, k]


@kernel(inline=True, internal=True)
def add_direction_row(
    system: RowSystem, attachment: int, row: int, work: Workspace, marker: int, c: Vector
) -> None:
    """Add ``c . J[m]`` to one row."""
    lanes = len(system.shape[1])
    begin = system.attachments[attachment, PANEL] + row
    J = work.jacobian[marker]
    for k in range(system.attachments[attachment, WIDTH]):
        system.panels[begin + k * lanes] += c[0] * J[0, k] + c[1] * J[1, k] + c[2] * J[2, k]


@kernel(inline=True, internal=True)
def reactions(system: RowSystem, block: int) -> NDArray[np.float64]:
    """Reactions of the rows of a block at the end of the last step [N] or [N m], a view."""
    lanes = len(system.shape[1])
    begin = (block * ROW_COLUMNS + REACTION) * lanes
    return system.rows[begin : begin + lanes]


@kernel(internal=True)
def write_reaction(system: RowSystem, block: int, row: NDArray[np.float64], column: int) -> None:
    """Force on b of three point rows; the moment, after it, is set to zero."""
    force = reactions(system, block)
    for k in range(3):
        row[column + k] = force[k]
        row[column + 3 + k] = 0.0


@kernel(internal=True)
def add_moment(
    system: RowSystem,
    block: int,
    index: int,
    work: Workspace,
    marker: int,
    partner: int,
    row: NDArray[np.float64],
    column: int,
) -> None:
    """Moment ``e x c`` on b of a row ``c . e``, with `marker` e on b and c on a, times its reaction."""
    e, c = vector(work, marker), vector(work, partner)
    moment = reactions(system, block)[index]
    turn = cross(e[0], e[1], e[2], c[0], c[1], c[2])
    for k in range(3):
        row[column + 3 + k] += moment * turn[k]
