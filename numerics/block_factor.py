"""Symmetric block-sparse factor ``K = L D L^T`` with a pattern that never changes, for meshes in time steps.

The tables come from `heavylift.numerics.block_pattern`, the arithmetic of blocks from
`heavylift.numerics.lanes`. All arrays are flat; a set of blocks starts at `base`, so that there may be several.

*Base nodes* are never eliminated: factoring leaves the Schur complement in their blocks. With constraints
J on a body of stiffness A, as base nodes without stiffness, their blocks then hold ``-J A^-1 J^T``, and after
`forward_blocks` of ``(r, 0)`` their vectors hold ``-J A^-1 r``. If ``-p`` takes their place, `backward_blocks`
leaves ``A^-1 (r + J^T p)`` in the vectors of the body.

The system of joints is factored here too; its vectors lie in the records of its rows, so `heavylift.solver.rows.solver`
has its own substitutions. Matrices that are factored once are left to `heavylift.modal.multifrontal`: a plate of 117
nodes takes 0.3 ms here and 6 ms there, but the tables of 3,840 nodes in a solid take 4.3 s, and 0.24 s all of it there.
Contacts, whose pattern changes with each step, have `heavylift.solver.contact.solve.envelope`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_pattern import FactorColumn, LowerBlock
from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import (
    backward_pivot,
    factor_pivot,
    forward_pivot,
    scale_block,
    solve_off_diagonal,
    subtract_backward_sum,
    subtract_forward,
    subtract_products,
)
from heavylift.numerics.records import Records

__all__ = ["backward_blocks", "factor_blocks", "factor_some_blocks", "forward_blocks"]


@kernel(internal=True)
def factor_blocks(  # type: ignore[no-untyped-def]
    shape,
    columns: Records[FactorColumn],
    updates: NDArray[np.int64],
    blocks: NDArray[np.float64],
    base: int,
    first: int,
    last: int,
    scratch: int,
) -> None:
    """Eliminate columns ``first ... last - 1``, whole groups, of the set of blocks that starts at `base`.

    Notes
    -----
    Within a panel each column first gathers what the columns before it subtract; then the whole panel subtracts
    its share from all later blocks. A zero pivot leaves numbers that are not finite.
    """
    size = len(shape[0]) * len(shape[1])
    work = base + scratch
    column = first
    while column < last:
        width = 1
        while columns[column + width - 1].first_update < 0:
            width += 1
        start = base + columns[column].pivot
        below = start + width * (width + 1) // 2 * size
        count = columns[column + width - 1].lower_count
        for m in range(width):
            row = start + m * (m + 1) // 2 * size
            pivot = row + m * size
            if m > 0:
                for t in range(m):
                    at = base + columns[column + t].pivot
                    scale_block(shape, blocks, work + t * size, blocks, row + t * size, blocks, at)
                subtract_products(shape, blocks, pivot, blocks, work, blocks, row, m)
            factor_pivot(shape, blocks, pivot)
            for i in range(m + 1, width + count):
                other = below + (i - width) * width * size if i >= width else start + i * (i + 1) // 2 * size
                if m > 0:
                    subtract_products(shape, blocks, other + m * size, blocks, work, blocks, other, m)
                solve_off_diagonal(shape, blocks, other + m * size, blocks, pivot)
        update = columns[column + width - 1].first_update
        for l in range(count):
            row = below + l * width * size
            for t in range(width):
                at = base + columns[column + t].pivot
                scale_block(shape, blocks, work + t * size, blocks, row + t * size, blocks, at)
            for k in range(l, count):
                target = base + updates[update]
                update += 1
                subtract_products(
                    shape, blocks, target, blocks, work, blocks, below + k * width * size, width
                )
        column += width


@kernel(internal=True)
def factor_some_blocks(  # type: ignore[no-untyped-def]
    shape,
    columns: Records[FactorColumn],
    lower: Records[LowerBlock],
    updates: NDArray[np.int64],
    blocks: NDArray[np.float64],
    scratch: int,
    present: NDArray[np.int64],
) -> None:
    """`factor_blocks` of all columns of a set whose nodes are present; blocks of others hold anything.

    Notes
    -----
    Others within a panel couple with nothing: their blocks are set to zero, since products run over whole panels.
    """
    size = len(shape[0]) * len(shape[1])
    column = 0
    while column < columns.shape[0]:
        width, there = 1, present[columns[column].node]
        while columns[column + width - 1].first_update < 0:
            there += present[columns[column + width].node]
            width += 1
        if there == 0:
            column += width
            continue
        if there < width:
            for m in range(column, column + width):
                below = columns[m].first_lower
                for l in range(below, below + columns[m].lower_count):
                    if present[columns[m].node] == 0 or present[lower[l].node] == 0:
                        for k in range(size):
                            blocks[lower[l].place + k] = 0.0
        start = columns[column].pivot
        below = start + width * (width + 1) // 2 * size
        count, first = columns[column + width - 1].lower_count, columns[column + width - 1].first_lower
        for m in range(width):
            row = start + m * (m + 1) // 2 * size
            pivot = row + m * size
            if present[columns[column + m].node] == 0:
                for k in range(size):
                    blocks[pivot + k] = 0.0
                continue
            if m > 0:
                for t in range(m):
                    at = columns[column + t].pivot
                    scale_block(shape, blocks, scratch + t * size, blocks, row + t * size, blocks, at)
                subtract_products(shape, blocks, pivot, blocks, scratch, blocks, row, m)
            factor_pivot(shape, blocks, pivot)
            for i in range(m + 1, width + count):
                node = lower[first + i - width].node if i >= width else columns[column + i].node
                if present[node] == 0:
                    continue
                other = below + (i - width) * width * size if i >= width else start + i * (i + 1) // 2 * size
                if m > 0:
                    subtract_products(shape, blocks, other + m * size, blocks, scratch, blocks, other, m)
                solve_off_diagonal(shape, blocks, other + m * size, blocks, pivot)
        update = columns[column + width - 1].first_update
        for l in range(count):
            if present[lower[first + l].node] == 0:
                update += count - l
                continue
            row = below + l * width * size
            for t in range(width):
                at = columns[column + t].pivot
                scale_block(shape, blocks, scratch + t * size, blocks, row + t * size, blocks, at)
            for k in range(l, count):
                target = updates[update]
                update += 1
                if present[lower[first + k].node] == 1:
                    subtract_products(
                        shape, blocks, target, blocks, scratch, blocks, below + k * width * size, width
                    )
        column += width


@kernel(internal=True)
def forward_blocks(  # type: ignore[no-untyped-def]
    shape,
    columns: Records[FactorColumn],
    lower: Records[LowerBlock],
    blocks: NDArray[np.float64],
    base: int,
    first: int,
    last: int,
    x: NDArray[np.float64],
    x_at: int,
) -> None:
    """``z = D^-1 L^-1 x`` of columns ``first ... last - 1``; base nodes are left with ``x - Y z``.

    The vector of a node stands at ``x_at + node * lanes``.
    """
    lanes = len(shape[1])
    for column in range(first, last):
        z = x_at + columns[column].node * lanes
        at, count = columns[column].first_lower, columns[column].lower_count
        forward_pivot(shape, x, z, blocks, base + columns[column].pivot)
        for l in range(at, at + count):
            subtract_forward(shape, x, x_at + lower[l].node * lanes, blocks, base + lower[l].place, x, z)


@kernel(internal=True)
def backward_blocks(  # type: ignore[no-untyped-def]
    shape,
    columns: Records[FactorColumn],
    lower: Records[LowerBlock],
    blocks: NDArray[np.float64],
    base: int,
    first: int,
    last: int,
    x: NDArray[np.float64],
    x_at: int,
) -> None:
    """``x = L^-T z`` of columns ``first ... last - 1``, with whatever stands in the vectors of base nodes."""
    lanes = len(shape[1])
    for column in range(last - 1, first - 1, -1):
        node, pivot = columns[column].node, columns[column].pivot
        at, count = columns[column].first_lower, columns[column].lower_count
        subtract_backward_sum(shape, x, x_at, node, blocks, base, pivot, lower, at, count)
        backward_pivot(shape, x, x_at + node * lanes, blocks, base + pivot)
