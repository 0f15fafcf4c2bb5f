"""Substitutions with the factor of a mesh, and where its nodes and strains are.

The mass matrix couples coordinates of the same axis only, and so does its factor. For frames, whose explicit schemes
spend much of their time here, there are substitutions that read just that third of the blocks.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.block_factor import backward_blocks, forward_blocks
from heavylift.numerics.jit import kernel
from heavylift.numerics.small import nonnegative
from heavylift.solver.bodies.ancf.assembly import set_size
from heavylift.solver.bodies.ancf.kind import MASS_SET, Meshes
from heavylift.solver.bodies.ancf.moving import add_point_forces, find_free_points

__all__ = ["copy_strains", "node_span", "scatter_back", "solve_forward"]

LANES = 8
"""Places of a node of a frame, and of a column of a block."""


@kernel(inline=True, internal=True)
def node_span(kind: Meshes, body: int) -> tuple[int, int]:
    """Places of the nodes of a body in a nodal vector."""
    lanes = len(kind.shape[1])
    first = nonnegative(kind.table[body].first_node * lanes)
    return first, nonnegative(first + kind.table[body].node_count * lanes)


@kernel(internal=True)
def _forward_axes(kind: Meshes, body: int, base: int) -> None:
    """`forward_blocks` with a factor that does not couple axes: two numbers a node and axis."""
    x, blocks, lower = kind.right_hand_side, kind.blocks, kind.lower
    for column in range(kind.table[body].first_column, kind.table[body].last_column):
        z, pivot = kind.columns[column].node * LANES, base + kind.columns[column].pivot
        first, count = kind.columns[column].first_lower, kind.columns[column].lower_count
        for k in range(3):
            at = pivot + (LANES + 1) * k
            a = x[z + k]
            b = x[z + 3 + k] - blocks[at + 3] * a
            a *= blocks[at]
            b *= blocks[at + 3 * (LANES + 1)]
            x[z + k], x[z + 3 + k] = a, b
            for l in range(first, first + count):
                later, place = lower[l].node * LANES + k, base + lower[l].place + (LANES + 1) * k
                u, v = x[later], x[later + 3]
                u -= blocks[place] * a + blocks[place + 3 * LANES] * b
                v -= blocks[place + 3] * a + blocks[place + 3 * LANES + 3] * b
                x[later], x[later + 3] = u, v


@kernel(internal=True)
def _backward_axes(kind: Meshes, body: int, base: int) -> None:
    """`backward_blocks` with a factor that does not couple axes."""
    x, blocks, lower = kind.right_hand_side, kind.blocks, kind.lower
    for column in range(kind.table[body].last_column - 1, kind.table[body].first_column - 1, -1):
        z, pivot = kind.columns[column].node * LANES, base + kind.columns[column].pivot
        first, count = kind.columns[column].first_lower, kind.columns[column].lower_count
        for k in range(3):
            at = pivot + (LANES + 1) * k
            a = b = 0.0
            for l in range(first, first + count):
                later, place = lower[l].node * LANES + k, base + lower[l].place + (LANES + 1) * k
                u, v = x[later], x[later + 3]
                a += blocks[place] * u + blocks[place + 3] * v
                b += blocks[place + 3 * LANES] * u + blocks[place + 3 * LANES + 3] * v
            b = x[z + 3 + k] - blocks[at + 3 * (LANES + 1)] * b
            x[z + k], x[z + 3 + k] = x[z + k] - blocks[at] * a - blocks[at + 3] * b, b


@kernel(internal=True)
def solve_forward(kind: Meshes, body: int, which: int) -> None:
    """Forward substitution of `right_hand_side` with the factor of a set.

    The places of bases and moving points are left with ``-J A^-1 r``.
    """
    lanes = len(kind.shape[1])
    first, last = node_span(kind, body)
    right, free = kind.right_hand_side, kind.free
    for i in range(first, last):
        right[i] *= free[i]
    for i in range(last, last + kind.table[body].base_node_count * lanes):
        right[i] = 0.0
    if which == MASS_SET and lanes == LANES:
        _forward_axes(kind, body, which * set_size(kind))
    else:
        forward_blocks(
            kind.shape,
            kind.columns,
            kind.lower,
            kind.blocks,
            which * set_size(kind),
            kind.table[body].first_column,
            kind.table[body].last_column,
            right,
            0,
        )
    find_free_points(kind.moving, kind, body, which)


@kernel(internal=True)
def scatter_back(kind: Meshes, body: int, which: int) -> None:
    """Back substitution of `right_hand_side`, with minus the impulses in the places of bases and moving points."""
    add_point_forces(kind.moving, kind, body, which)
    if which == MASS_SET and len(kind.shape[1]) == LANES:
        _backward_axes(kind, body, which * set_size(kind))
        return
    backward_blocks(
        kind.shape,
        kind.columns,
        kind.lower,
        kind.blocks,
        which * set_size(kind),
        kind.table[body].first_column,
        kind.table[body].last_column,
        kind.right_hand_side,
        0,
    )


@kernel(internal=True)
def copy_strains(kind: Meshes, body: int, of: Floats1, to: Floats1) -> None:
    """One vector of strains into another, of one body."""
    first = kind.table[body].first_strain
    for i in range(first, first + kind.table[body].strain_count):
        to[i] = of[i]
