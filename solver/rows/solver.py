"""The system of all rows, numerically: assemble, factor, solve. Its structure is in `rows.structure`.

The factor is that of `heavylift.numerics.block_factor`. Substitutions are written here once more, because the vectors
of a block lie in the record of its rows, not side by side in an array.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_factor import factor_blocks, factor_some_blocks
from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import (
    add_dot,
    add_outer_product,
    add_rigid_dots,
    add_rigid_product,
    backward_pivot,
    forward_pivot,
    put_rigid_product,
    subtract_backward,
    subtract_forward,
    subtract_rigid_rows,
)
from heavylift.solver.rows.structure import (
    ABSENT,
    DIAGONAL,
    FACTORED,
    RowSystem,
)

__all__ = [
    "assemble",
    "assemble_without_absent",
    "factor_present",
    "factor_rows",
    "respond_rows",
    "smallest_pivot",
    "solve_rows",
    "subtract_rates",
]

NEARLY_ABSENT = 0.1 * ABSENT
"""Softness relative to the characteristic inverse mass from which on a row is absent."""


@kernel(internal=True)
def assemble(system: RowSystem) -> None:
    """``S = G A^-1 G^T + Z``; of rigid bodies from G and the inverse masses, of others from their X."""
    for node in range(system.present.shape[0]):
        system.present[node] = 1
    _assemble_present(system)


@kernel(internal=True)
def assemble_without_absent(system: RowSystem) -> None:
    """`assemble` without blocks whose rows are all absent and wanted to be at rest: their impulses are nothing.

    What a law gives is a target however soft its row is, and stays.
    """
    lanes, blocks = len(system.shape[1]), system.attachments.shape[0] // 2
    for node in range(system.present.shape[0]):
        row = system.rows[node]
        present = node >= blocks
        for r in range(lanes):
            if row.scale[r] > 0.0 and (
                row.softness[r] < NEARLY_ABSENT * row.scale[r] or row.target[r] != 0.0
            ):
                present = True
        system.present[node] = 1 if present else 0
    _assemble_present(system)


@kernel(internal=True)
def _assemble_present(system: RowSystem) -> None:
    """Blocks of the nodes that are present."""
    shape = system.shape
    rows, lanes = len(shape[0]), len(shape[1])
    for i in range(system.fill.shape[0]):
        for r in range(rows * lanes):
            system.blocks[system.fill[i] + r] = 0.0
    for i in range(system.pairs.shape[0]):
        product = system.pairs[i]
        if system.present[product.early] + system.present[product.late] < 2:
            continue
        place, left, right = product.place, product.left, product.right
        dof = product.dof
        if dof < 0:
            side = system.attachments[product.side]
            for k in range(side.first, side.first + side.count):
                add_outer_product(
                    shape,
                    system.blocks,
                    place,
                    system.panels,
                    left + k * lanes,
                    system.panels,
                    right + k * lanes,
                )
        elif product.first:
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
        if system.present[system.columns[j].node] == 0:
            continue
        softness = system.rows[system.columns[j].node].softness
        pivot = system.columns[j].pivot
        for r in range(rows):
            system.blocks[pivot + r * (lanes + 1)] += softness[r]
    if system.hubs.shape[0] > 0:
        _assemble_hubs(system)


@kernel(internal=True)
def _assemble_hubs(system: RowSystem) -> None:
    """Pivots ``-A`` and couplings ``G`` of the bodies that stay in the system."""
    rows, lanes = len(system.shape[0]), len(system.shape[1])
    for i in range(system.hubs.shape[0]):
        hub = system.hubs[i]
        place, first, later = hub.place, hub.first, hub.later
        if system.present[hub.node] == 0:
            continue
        for k in range(6):
            if later < 0:
                system.blocks[place + k * (lanes + 1)] = -1.0 / system.inverse_mass[first + k]
                continue
            for r in range(rows):
                value = system.panels[first + k * lanes + r]
                if later == 1:
                    system.blocks[place + r * lanes + k] += value
                else:
                    system.blocks[place + k * lanes + r] += value


@kernel(internal=True)
def factor_rows(system: RowSystem) -> None:
    """Block factorisation ``S = L D L^T`` of all nodes."""
    columns = system.columns.shape[0]
    factor_blocks(system.shape, system.columns, system.updates, system.blocks, 0, 0, columns, system.scratch)


@kernel(internal=True)
def factor_present(system: RowSystem) -> None:
    """`factor_rows` of the nodes that are present."""
    factor_some_blocks(
        system.shape,
        system.columns,
        system.lower,
        system.updates,
        system.blocks,
        system.scratch,
        system.present,
    )


@kernel(inline=True, internal=True)
def subtract_rates(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """``SOLUTION -= G U`` of all rows."""
    for i in range(system.attachments.shape[0]):
        if system.present[system.attachments[i].owner] == 0:
            continue
        out = system.rows[system.attachments[i].owner].solution
        dof, width, panel = (
            system.attachments[i].dof,
            system.attachments[i].width,
            system.attachments[i].panel,
        )
        if width == 6:
            subtract_rigid_rows(system.shape, out, 0, system.panels, panel, velocity, dof)
        elif width > 0:
            _subtract_wide_rows(system, out, panel, velocity, dof, i)


@kernel(inline=True, internal=True)
def _substitute(system: RowSystem) -> None:
    """``SOLUTION := S^-1 SOLUTION``, forwards and backwards."""
    shape, rows = system.shape, system.rows
    for j in range(system.columns.shape[0]):
        if system.present[system.columns[j].node] == 0:
            continue
        z = rows[system.columns[j].node].solution
        first, count = system.columns[j].first_lower, system.columns[j].lower_count
        forward_pivot(shape, z, 0, system.blocks, system.columns[j].pivot)
        for l in range(first, first + count):
            if system.present[system.lower[l].node] == 0:
                continue
            other = rows[system.lower[l].node].solution
            subtract_forward(shape, other, 0, system.blocks, system.lower[l].place, z, 0)
    for j in range(system.columns.shape[0] - 1, -1, -1):
        if system.present[system.columns[j].node] == 0:
            continue
        z = rows[system.columns[j].node].solution
        pivot, first, count = (
            system.columns[j].pivot,
            system.columns[j].first_lower,
            system.columns[j].lower_count,
        )
        for l in range(first, first + count):
            if system.present[system.lower[l].node] == 0:
                continue
            other = rows[system.lower[l].node].solution
            subtract_backward(
                shape, z, 0, system.blocks, system.lower[l].place, system.blocks, pivot, other, 0
            )
        backward_pivot(shape, z, 0, system.blocks, pivot)


@kernel(inline=True, internal=True)
def _spread(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """``U += A^-1 G^T SOLUTION``; of hubs the solution has the velocities themselves."""
    shape, rows = system.shape, system.rows
    lanes = len(shape[1])
    half = system.panels.shape[0] // 2
    for i in range(system.attachments.shape[0]):
        holder = system.attachments[i].holder
        if holder != DIAGONAL and holder != FACTORED:  # noqa: PLR1714  a set costs time here
            continue
        if system.present[system.attachments[i].owner] == 0:
            continue
        dof, count, panel = (
            system.attachments[i].dof,
            system.attachments[i].width,
            system.attachments[i].panel,
        )
        z = rows[system.attachments[i].owner].solution
        if holder == DIAGONAL:
            add_rigid_dots(shape, velocity, dof, system.panels, panel, z, 0, system.inverse_mass, dof)
        else:
            for k in range(count):
                add_dot(shape, velocity, dof + k, system.panels, half + panel + k * lanes, z, 0)
    for i in range(system.hubs.shape[0]):
        hub = system.hubs[i]
        if hub.later < 0:
            z = rows[hub.node].solution
            for k in range(6):
                velocity[hub.first + k] += z[k]


@kernel(inline=True, internal=True)
def solve_rows(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """Impulses that bring the rows to their targets: added to those there are, and to the velocities.

    ``S dP = target - Z P - G U``: the same call starts, corrects by another factor, and refines.
    """
    lanes = len(system.shape[1])
    for node in range(system.columns.shape[0]):
        row = system.rows[node]
        there = float(system.present[node])
        for r in range(lanes):
            row.solution[r] = there * (row.target[r] - row.softness[r] * row.impulse[r])
    subtract_rates(system, velocity)
    _substitute(system)
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            row.impulse[r] += row.solution[r]
    _spread(system, velocity)


@kernel(internal=True)
def respond_rows(system: RowSystem, velocity: NDArray[np.float64]) -> None:
    """``U -= X S^-1 G U``: what the rows leave of a velocity that something else has caused; impulses stay."""
    for node in range(system.columns.shape[0]):
        for r in range(len(system.shape[1])):
            system.rows[node].solution[r] = 0.0
    subtract_rates(system, velocity)
    _substitute(system)
    _spread(system, velocity)


@kernel(internal=True)
def _subtract_wide_rows(
    system: RowSystem,
    out: NDArray[np.float64],
    panel: int,
    velocity: NDArray[np.float64],
    dof: int,
    attachment: int,
) -> None:
    """``out -= G^T u`` over any number of velocities."""
    lanes, side = len(system.shape[1]), system.attachments[attachment]
    for k in range(side.first, side.first + side.count):
        for r in range(lanes):
            out[r] -= system.panels[panel + k * lanes + r] * velocity[dof + k]


@kernel(internal=True)
def smallest_pivot(system: RowSystem) -> float:
    """Smallest pivot of the last factor relative to the scale of its row: small near a singular position."""
    rows, lanes = len(system.shape[0]), len(system.shape[1])
    smallest = 1e300
    for j in range(system.columns.shape[0]):
        node = system.columns[j].node
        if 2 * node >= system.attachments.shape[0]:
            continue
        for r in range(rows):
            inverse = system.blocks[system.columns[j].pivot + r * (lanes + 1)]
            scale = system.rows[node].scale[r]
            if scale > 0.0 and system.present[node] == 0:
                smallest = min(smallest, ABSENT)
            elif scale > 0.0:  # not padding
                smallest = min(smallest, 1.0 / (inverse * scale))
    return smallest
