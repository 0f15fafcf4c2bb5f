"""Matrices of a mesh: the constant part of the step matrix, the factor of the mass, products with both.

Mass and bending matrices are scalar matrices of the elements times the unit matrix of space. Fixed coordinates
have unit rows and columns. Blocks of the bases hold the values of their shape functions, so that eliminating
the nodes of the mesh leaves ``-J A^-1 J^T`` in the blocks of the bases.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.block_factor import factor_blocks
from heavylift.numerics.jit import kernel
from heavylift.numerics.small import nonnegative
from heavylift.solver.bodies.ancf.kind import CLEAR_LANE, CLEAR_ROW, CONSTANT_SET, MASS_SET, STEP_SET, Meshes

__all__ = [
    "add_matrix_products",
    "clear_fixed",
    "factor_mass",
    "factor_set",
    "set_size",
    "start_step_matrix",
]


@kernel(inline=True, internal=True)
def set_size(kind: Meshes) -> int:
    """Numbers of a set of blocks."""
    return kind.blocks.shape[0] // 3


@kernel(internal=True)
def _assemble_constant(kind: Meshes, body: int, to: int, mass: float, bending: float) -> None:
    """``mass M + bending K_b`` with the bases into a set of blocks, whose blocks of this body are zero."""
    vectors, lanes = len(kind.shape[0]) // 3, len(kind.shape[1])
    nodes = len(kind.ends)
    count = nodes * vectors
    begin = to * set_size(kind)
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        M = kind.elements[e].data
        K = M + count * count
        pair = 0
        for i in range(nodes):
            for j in range(i + 1):
                place, swap = begin + kind.elements[e].blocks[pair, 0], kind.elements[e].blocks[pair, 1]
                pair += 1
                for a in range(vectors):
                    for b in range(vectors):
                        at = (i * vectors + a) * count + j * vectors + b
                        value = mass * kind.constants[M + at] + bending * kind.constants[K + at]
                        row, column = 3 * a, 3 * b
                        if swap != 0:
                            row, column = column, row
                        for k in range(3):
                            kind.blocks[place + (column + k) * lanes + row + k] += value
    first = kind.table[body].first_base
    for base in range(first, first + kind.table[body].base_count):
        slot = kind.bases[base].place % lanes
        shape = kind.bases[base].shape_values
        for i in range(nodes):
            place = begin + kind.bases[base].blocks[i]
            for a in range(vectors):
                for k in range(3):
                    kind.blocks[place + (3 * a + k) * lanes + slot + k] = kind.constants[
                        shape + i * vectors + a
                    ]


@kernel(internal=True)
def clear_fixed(kind: Meshes, body: int, to: int) -> None:
    """Unit rows and columns for fixed coordinates."""
    lanes, rows = len(kind.shape[1]), len(kind.shape[0])
    begin = to * set_size(kind)
    first = kind.table[body].first_clear
    for i in range(first, first + kind.table[body].clear_count):
        fixed = kind.clears[i]
        place, index = begin + fixed.block, fixed.index
        if fixed.part == CLEAR_ROW:
            for r in range(lanes):
                kind.blocks[place + index * lanes + r] = 0.0
        elif fixed.part == CLEAR_LANE:
            for c in range(rows):
                kind.blocks[place + c * lanes + index] = 0.0
        else:
            kind.blocks[place + index * (lanes + 1)] = 1.0


@kernel(internal=True)
def factor_set(kind: Meshes, body: int, which: int) -> None:
    """Eliminate the nodes of the mesh from a set of blocks."""
    size = set_size(kind)
    factor_blocks(
        kind.shape,
        kind.columns,
        kind.updates,
        kind.blocks,
        which * size,
        kind.table[body].first_column,
        kind.table[body].last_column,
        kind.table[body].work_place,
    )


@kernel(internal=True)
def factor_mass(kind: Meshes) -> None:
    """Factor the mass matrix of all bodies."""
    size = set_size(kind)
    for i in range(size):
        kind.blocks[MASS_SET * size + i] = 0.0
    for body in range(kind.table.shape[0]):
        _assemble_constant(kind, body, MASS_SET, 1.0, 0.0)
        clear_fixed(kind, body, MASS_SET)
        factor_set(kind, body, MASS_SET)
        kind.constants[kind.table[body].base_step] = -1.0


@kernel(internal=True)
def start_step_matrix(kind: Meshes, body: int, mass: float, bending: float) -> None:
    """Blocks of the step matrix of this body, without what strains add to them.

    Notes
    -----
    The coefficients change with the step only, so one number tells whether the constant part is still good: that
    of the mass is a function of the other.
    """
    size = set_size(kind)
    begin, end = kind.table[body].first_block, kind.table[body].last_block
    if kind.constants[kind.table[body].base_step] != bending:
        for i in range(CONSTANT_SET * size + begin, CONSTANT_SET * size + end):
            kind.blocks[i] = 0.0
        _assemble_constant(kind, body, CONSTANT_SET, mass, bending)
        clear_fixed(kind, body, CONSTANT_SET)
        kind.constants[kind.table[body].base_step] = bending
    for i in range(begin, end):
        kind.blocks[STEP_SET * size + i] = kind.blocks[CONSTANT_SET * size + i]


@kernel(internal=True)
def add_matrix_products(
    kind: Meshes, body: int, v: Floats1, mass: float, q: Floats1, bending: float, out: Floats1
) -> None:
    """``out += mass M v + bending K_b q``."""
    vectors = len(kind.shape[0]) // 3
    nodes = len(kind.ends)
    count = nodes * vectors
    first = kind.table[body].first_element
    for e in range(first, first + kind.table[body].element_count):
        M = kind.elements[e].data
        K = M + count * count
        for i in range(nodes):
            for a in range(vectors):
                row = (i * vectors + a) * count
                x = y = z = 0.0
                for j in range(nodes):
                    place = nonnegative(kind.elements[e].nodes[j])
                    for b in range(vectors):
                        m = mass * kind.constants[M + row + j * vectors + b]
                        k = bending * kind.constants[K + row + j * vectors + b]
                        at = place + 3 * b
                        x += m * v[at] + k * q[at]
                        y += m * v[at + 1] + k * q[at + 1]
                        z += m * v[at + 2] + k * q[at + 2]
                at = nonnegative(kind.elements[e].nodes[i] + 3 * a)
                out[at] += x
                out[at + 1] += y
                out[at + 2] += z
