"""The system of all rows, numerically: assemble, factor, solve. Its structure comes from `heavylift.solver.rows`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import (
    add_dot,
    add_outer_product,
    add_rigid_dots,
    add_rigid_product,
    backward_pivot,
    factor_pivot,
    forward_pivot,
    put_rigid_product,
    scale_block,
    solve_off_diagonal,
    subtract_backward,
    subtract_forward,
    subtract_product,
    subtract_rigid_rows,
)
from heavylift.solver.rows import (
    DIAGONAL,
    DOF,
    FACTORED,
    HOLDER,
    IMPULSE,
    LOWER,
    LOWER_COUNT,
    NODE,
    OWNER,
    PANEL,
    PIVOT,
    ROW_COLUMNS,
    SCALE,
    SOFTNESS,
    SOLUTION,
    TARGET,
    UPDATE,
    WIDTH,
    RowSystem,
)

__all__ = [
    "assemble",
    "factor_rows",
    "respond_rows",
    "smallest_pivot",
    "solve_rows",
    "subtract_rates",
]


@kernel(inline=True, internal=True)
def assemble(system: RowSystem) -> None:
    """``S = G A^-1 G^T + Z``; of rigid bodies from G and the inverse masses, of others from their X."""
    shape = system.shape
    rows, lanes = len(shape[0]), len(shape[1])
    for i in range(system.fill.shape[0]):
        for r in range(rows * lanes):
            system.blocks[system.fill[i] + r] = 0.0
    for i in range(system.pairs.shape[0]):
        place, left, right, width = (
            system.pairs[i, 0],
            system.pairs[i, 1],
            system.pairs[i, 2],
            system.pairs[i, 3],
        )
        dof = system.pairs[i, 4]
        if dof < 0:
            for k in range(width):
                add_outer_product(
                    shape,
                    system.blocks,
                    place,
                    system.panels,
                    left + k * lanes,
                    system.panels,
                    right + k * lanes,
                )
        elif system.pairs[i, 5] == 1:
            put_rigid_product(
                shape,
                system.blocks,
                place,
                system.panels,
                left,
                system.panels,
                right,
                system.inverse_mass,
                dof,
            )
        else:
            add_rigid_product(
                shape,
                system.blocks,
                place,
                system.panels,
                left,
                system.panels,
                right,
                system.inverse_mass,
                dof,
            )
    for j in range(system.columns.shape[0]):
        softness = (system.columns[j, NODE] * ROW_COLUMNS + SOFTNESS) * lanes
        pivot = system.columns[j, PIVOT]
        for r in range(rows):
            system.blocks[pivot + r * (lanes + 1)] += system.rows[softness + r]
    if system.hubs.shape[0] > 0:
        _assemble_hubs(system)


@kernel(internal=True)
def _assemble_hubs(system: RowSystem) -> None:
    """Pivots ``-A`` and couplings ``G`` of the bodies that stay in the system."""
    lanes = len(system.shape[1])
    for i in range(system.hubs.shape[0]):
        _, place, first, later = system.hubs[i]
        for k in range(6):
            if later < 0:
                system.blocks[place + k * (lanes + 1)] = -1.0 / system.inverse_mass[first + k]
                continue
            for r in range(6):
                value = system.panels[first + k * lanes + r]
                if later == 1:
                    system.blocks[place + r * lanes + k] += value
                else:
                    system.blocks[place + k * lanes + r] += value


@kernel(inline=True, internal=True)
def factor_rows(system: RowSystem) -> None:
    """Right-looking block factorisation ``S = L D L^T``."""
    shape = system.shape
    blocks = system.blocks
    scratch = blocks.shape[0] - len(shape[0]) * len(shape[1])
    for j in range(system.columns.shape[0]):
        pivot, first, count = (
            system.columns[j, PIVOT],
            system.columns[j, LOWER],
            system.columns[j, LOWER_COUNT],
        )
        update = system.columns[j, UPDATE]
        factor_pivot(shape, blocks, pivot)
        for l in range(first, first + count):
            solve_off_diagonal(shape, blocks, system.lower[l, 1], blocks, pivot)
        for l in range(first, first + count):
            scale_block(shape, blocks, scratch, blocks, system.lower[l, 1], blocks, pivot)
            for k in range(l, first + count):
                subtract_product(
                    shape, blocks, system.updates[update], blocks, scratch, blocks, system.lower[k, 1]
                )
                update += 1


@kernel(inline=True, internal=True)
def subtract_rates(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """``SOLUTION -= G U`` of all rows."""
    lanes = len(system.shape[1])
    for i in range(system.attachments.shape[0]):
        out = (system.attachments[i, OWNER] * ROW_COLUMNS + SOLUTION) * lanes
        dof, count, panel = (
            system.attachments[i, DOF],
            system.attachments[i, WIDTH],
            system.attachments[i, PANEL],
        )
        if count == 6:
            subtract_rigid_rows(system.shape, system.rows, out, system.panels, panel, velocity, dof)
        elif count > 0:
            _subtract_wide_rows(system, out, panel, velocity, dof, count)


@kernel(inline=True, internal=True)
def _substitute(system: RowSystem) -> None:
    """``SOLUTION := S^-1 SOLUTION``, forwards and backwards."""
    shape, rows = system.shape, system.rows
    lanes = len(shape[1])
    width = ROW_COLUMNS * lanes
    for j in range(system.columns.shape[0]):
        z = system.columns[j, NODE] * width + SOLUTION * lanes
        first, count = system.columns[j, LOWER], system.columns[j, LOWER_COUNT]
        forward_pivot(shape, rows, z, system.blocks, system.columns[j, PIVOT])
        for l in range(first, first + count):
            other = system.lower[l, 0] * width + SOLUTION * lanes
            subtract_forward(shape, rows, other, system.blocks, system.lower[l, 1], rows, z)
    for j in range(system.columns.shape[0] - 1, -1, -1):
        z = system.columns[j, NODE] * width + SOLUTION * lanes
        pivot, first, count = (
            system.columns[j, PIVOT],
            system.columns[j, LOWER],
            system.columns[j, LOWER_COUNT],
        )
        for l in range(first, first + count):
            other = system.lower[l, 0] * width + SOLUTION * lanes
            subtract_backward(
                shape, rows, z, system.blocks, system.lower[l, 1], system.blocks, pivot, rows, other
            )
        backward_pivot(shape, rows, z, system.blocks, pivot)


@kernel(inline=True, internal=True)
def _spread(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """``U += A^-1 G^T SOLUTION``; of hubs the solution has the velocities themselves."""
    shape, rows = system.shape, system.rows
    lanes = len(shape[1])
    width = ROW_COLUMNS * lanes
    half = system.panels.shape[0] // 2
    for i in range(system.attachments.shape[0]):
        holder = system.attachments[i, HOLDER]
        if holder != DIAGONAL and holder != FACTORED:  # noqa: PLR1714  a set costs time here
            continue
        dof, count, panel = (
            system.attachments[i, DOF],
            system.attachments[i, WIDTH],
            system.attachments[i, PANEL],
        )
        z = system.attachments[i, OWNER] * width + SOLUTION * lanes
        if holder == DIAGONAL:
            add_rigid_dots(shape, velocity, dof, system.panels, panel, rows, z, system.inverse_mass, dof)
        else:
            for k in range(count):
                add_dot(shape, velocity, dof + k, system.panels, half + panel + k * lanes, rows, z)
    for i in range(system.hubs.shape[0]):
        node, _, first, later = system.hubs[i]
        if later < 0:
            z = node * width + SOLUTION * lanes
            for k in range(6):
                velocity[first + k] += rows[z + k]


@kernel(inline=True, internal=True)
def solve_rows(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """Impulses that bring the rows to their targets: added to those there are, and to the velocities.

    ``S dP = target - Z P - G U``: the same call starts, corrects by another factor, and refines.
    """
    lanes = len(system.shape[1])
    width = ROW_COLUMNS * lanes
    rows = system.rows
    for node in range(system.columns.shape[0]):
        out = node * width + SOLUTION * lanes
        target = node * width + TARGET * lanes
        softness, impulse = node * width + SOFTNESS * lanes, node * width + IMPULSE * lanes
        for r in range(lanes):
            rows[out + r] = rows[target + r] - rows[softness + r] * rows[impulse + r]
    subtract_rates(system, velocity)
    _substitute(system)
    for node in range(system.attachments.shape[0] // 2):
        z, impulse = node * width + SOLUTION * lanes, node * width + IMPULSE * lanes
        for r in range(lanes):
            rows[impulse + r] += rows[z + r]
    _spread(system, velocity)


@kernel(internal=True)
def respond_rows(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """``U -= X S^-1 G U``: what the rows leave of a velocity that something else has caused; impulses stay."""
    width = ROW_COLUMNS * len(system.shape[1])
    for node in range(system.columns.shape[0]):
        for r in range(len(system.shape[1])):
            system.rows[node * width + SOLUTION * len(system.shape[1]) + r] = 0.0
    subtract_rates(system, velocity)
    _substitute(system)
    _spread(system, velocity)


@kernel(internal=True)
def _subtract_wide_rows(
    system: RowSystem, out: int, panel: int, velocity: NDArray[np.float64], dof: int, count: int
) -> None:
    """``out -= G^T u`` over any number of velocities."""
    lanes = len(system.shape[1])
    for k in range(count):
        for r in range(lanes):
            system.rows[out + r] -= system.panels[panel + k * lanes + r] * velocity[dof + k]


@kernel(internal=True)
def smallest_pivot(system: RowSystem) -> float:
    """Smallest pivot of the last factor relative to the scale of its row: small near a singular position."""
    rows, lanes = len(system.shape[0]), len(system.shape[1])
    smallest = 1e300
    for j in range(system.columns.shape[0]):
        node = system.columns[j, NODE]
        if 2 * node >= system.attachments.shape[0]:
            continue
        for r in range(rows):
            inverse = system.blocks[system.columns[j, PIVOT] + r * (lanes + 1)]
            scale = system.rows[(node * ROW_COLUMNS + SCALE) * lanes + r]
            if scale > 0.0:  # not padding
                smallest = min(smallest, 1.0 / (inverse * scale))
    return smallest
