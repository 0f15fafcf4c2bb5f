"""Stiffness of one shell element in vector registers.

At a Gauss point, with ``a = r_xi``, ``b = r_eta`` and the moduli D, three 3x3 blocks hold all there is::

    K_11 = D11 a a^T + D13 (a b^T + b a^T) + D33 b b^T + N11 I
    K_12 = D12 a b^T + D13 a a^T + D23 b b^T + D33 b a^T + N12 I
    K_22 = D22 b b^T + D23 (a b^T + b a^T) + D33 a a^T + N22 I

They are summed over xi for each pair ``i >= k`` of functions along xi, with all points along eta as lanes, then
over eta for all pairs of functions along eta, which are the lanes then.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir

from heavylift.numerics.jit import intrinsic
from heavylift.numerics.vector_code import VectorCode, vector_code
from heavylift.solver.bodies.ancf.kind import SHELL_PAIRS
from heavylift.solver.bodies.ancf.shell_data import (
    FUNCTIONS,
    LANES,
    LINE,
    POINTS,
    STRAINS_PER_LINE,
    XI_PAIRS,
    ShellData,
    ShellLine,
    ShellTables,
    place_of,
)
from heavylift.solver.bodies.ancf.shell_lanes import contracted, lines, slopes_of_line, stress_of_line

__all__ = ["BLOCK_ORDER", "add_element_stiffness"]

LENGTHS = place_of(ShellData, "lengths")
MODULI = place_of(ShellLine, "moduli")
PAIRS = place_of(ShellTables, "pairs")
PRODUCTS = place_of(ShellTables, "products")
XI = place_of(ShellTables, "xi")

ROWS, COLUMNS = 12, 16
LOWER = tuple((p, q) for p in range(3) for q in range(p + 1))
LINE_BLOCKS = 21 * LANES
"""Numbers of a line: lower triangles of K_11 and K_22, all of K_12."""
EXPANDED = 9 * 16
"""Numbers of a pair of functions along xi: 3x3 components, functions along eta."""


def _block_order() -> np.ndarray:
    """Where in the expanded sums the numbers of a block are: by pair of nodes, stored as it is or transposed."""
    order = np.zeros((len(SHELL_PAIRS), 2, ROWS, ROWS), dtype=np.int64)
    for pair, (m, n) in enumerate(SHELL_PAIRS):
        for row in range(ROWS):
            for column in range(ROWS):
                (i, j), p = FUNCTIONS[4 * m + row // 3], row % 3
                (k, l), q = FUNCTIONS[4 * n + column // 3], column % 3
                if i < k:
                    i, j, p, k, l, q = k, l, q, i, j, p
                place = (i * (i + 1) // 2 + k) * EXPANDED + (3 * p + q) * 16 + 4 * j + l
                order[pair, 0, column, row] = order[pair, 1, row, column] = place
    return order.ravel()


BLOCK_ORDER = _block_order()


@intrinsic
def add_element_stiffness(  # type: ignore[no-untyped-def]
    typingctx,
    constants,
    tables,
    constants_2,
    data,
    nodal,
    n0,
    n1,
    n2,
    n3,
    strains,
    at,
    of_pairs,
    of_pairs_first,
    blocks,
    first,
    order,
    order_first,
    scale,
    geometric,
):
    """``K += scale (B^T D B + geometric G)`` into the blocks of the pairs of nodes, G at the stress ``D e``."""

    def write(
        code: VectorCode,
        tables: Any,
        data: Any,
        nodes: Any,
        strains: Any,
        places: Any,
        blocks: Any,
        order: Any,
        scale: Any,
        geometric: Any,
    ) -> None:
        of_lines = code.memory(21 * LANES)
        _write_lines(code, tables, data, nodes, strains, of_lines, geometric)
        expanded = code.memory(len(XI_PAIRS) * EXPANDED // LANES)
        _write_expanded(code, tables, data, of_lines, expanded, scale)
        _write_blocks(code, expanded, places, blocks, order)

    arguments = (
        constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at,
        of_pairs, of_pairs_first, blocks, first, order, order_first, scale, geometric,
    )  # fmt: skip
    return vector_code(arguments, (1, 1, 4, 1, 1, 1, 1), write, lanes=LANES)


def _write_lines(
    code: VectorCode, tables: Any, data: Any, nodes: Any, strains: Any, of_lines: Any, geometric: Any
) -> None:
    """K_11, K_22 and K_12 of all lines."""
    sums = contracted(code, tables, data, nodes)
    geometric = code.spread(geometric)
    with lines(code, tables) as loop:
        a, b = slopes_of_line(code, code.line(tables, XI, loop.index, 8), sums)
        points = code.line(data, POINTS, loop.index, LINE)
        stress = stress_of_line(code, points, code.line(strains, 0, loop.index, STRAINS_PER_LINE))
        N11, N22, N12 = (code.multiply(value, geometric) for value in stress)
        D11, D22, D33, D12, D13, D23 = (code.load(points, MODULI + 8 * c) for c in range(6))
        out = code.line(of_lines, 0, loop.index, LINE_BLOCKS)

        def combined(c: Any, d: Any) -> list[Any]:
            return [code.sum((c, x), (d, y)) for x, y in zip(a, b, strict=True)]

        first, both, second, other = (
            combined(D11, D13),
            combined(D13, D33),
            combined(D23, D22),
            combined(D33, D23),
        )
        mixed, mixed_2 = combined(D13, D12), combined(D33, D23)
        number = 0
        for x, y, N in ((first, both, N11), (other, second, N22)):
            for p, q in LOWER:
                value = code.sum((x[p], a[q]), (y[p], b[q]))
                code.store(code.add(value, N) if p == q else value, out, 8 * number)
                number += 1
        for p in range(3):
            for q in range(3):
                value = code.sum((a[p], mixed[q]), (b[p], mixed_2[q]))
                code.store(code.add(value, N12) if p == q else value, out, 8 * number)
                number += 1


def _sources(kinds: tuple[int, ...]) -> list[tuple[int, tuple[int, int], int]]:
    """Type 11, 12, 21 or 22, components and number of its block in a line, of all sums of some types."""
    full = [(p, q) for p in range(3) for q in range(3)]
    symmetric = {0: 0, 3: len(LOWER)}
    return [
        (kind, (p, q), symmetric[kind] + LOWER.index((p, q)))
        if kind in symmetric
        else (kind, (p, q), 2 * len(LOWER) + (3 * p + q if kind == 1 else 3 * q + p))
        for kind in kinds
        for p, q in (LOWER if kind in symmetric else full)
    ]


def _write_expanded(
    code: VectorCode, tables: Any, data: Any, of_lines: Any, expanded: Any, scale: Any
) -> None:
    """Sums over xi, then eta, for each pair of functions along xi."""
    builder = code.builder
    a, b = (code.number(data, LENGTHS + c) for c in range(2))
    scales = code.memory(2)
    powers = [scale, builder.fmul(scale, a), builder.fmul(scale, builder.fmul(a, a))]
    for number, (i, k) in enumerate(XI_PAIRS):
        builder.store(powers[i % 2 + k % 2], code.at(scales, number))
    ones = ir.Constant(code.vector, [1.0] * LANES)
    lengths = code.spread(b)
    along_j = code.choose(ones, lengths, [0, 0, 0, 0, 8, 8, 8, 8])
    along_l = code.choose(ones, lengths, [0, 8] * 4)
    along_eta = code.multiply(along_j, along_l)
    over_xi = code.memory(36)

    with code.repeat(ir.Constant(ir.IntType(64), len(XI_PAIRS))) as pair:
        functions = code.line(tables, PAIRS, pair.index, 4 * LANES)
        # types 11 and 22 first, then 12 and 21: so many sums fit into the registers
        for kinds in ((0, 3), (1, 2)):
            sources = _sources(kinds)
            totals = [code.variable(code.constant(0.0)) for _ in sources]
            with lines(code, tables) as loop:
                numbers = code.line(functions, 0, loop.index, 4)
                factors = {kind: code.spread(code.number(numbers, kind)) for kind in kinds}
                of_line = code.line(of_lines, 0, loop.index, LINE_BLOCKS)
                for (kind, _, source), total in zip(sources, totals, strict=True):
                    value = code.multiply(code.load(of_line, 8 * source), factors[kind])
                    builder.store(code.add(builder.load(total, typ=code.vector), value), total)
            for (kind, (p, q), _), total in zip(sources, totals, strict=True):
                code.store(builder.load(total, typ=code.vector), over_xi, 8 * (9 * kind + 3 * p + q))

        parts = [[code.variable(code.constant(0.0)) for _ in range(2)] for _ in range(9)]
        with lines(code, tables) as lane:
            products = code.line(tables, PRODUCTS, lane.index, 64)
            numbers = code.at(over_xi, lane.index)
            for kind in range(4):
                vectors = [code.load(products, 16 * kind + 8 * half) for half in range(2)]
                for pq in range(9):
                    p, q = divmod(pq, 3)
                    if kind in (0, 3) and p < q:
                        p, q = q, p
                    number = code.spread(code.number(numbers, 8 * (9 * kind + 3 * p + q)))
                    for half in range(2):
                        total = builder.load(parts[pq][half], typ=code.vector)
                        builder.store(code.add(total, code.multiply(vectors[half], number)), parts[pq][half])
        factor = code.multiply(code.spread(code.number(code.at(scales, pair.index), 0)), along_eta)
        out = code.line(expanded, 0, pair.index, EXPANDED)
        for pq in range(9):
            for half in range(2):
                value = code.multiply(builder.load(parts[pq][half], typ=code.vector), factor)
                code.store(value, out, 16 * pq + 8 * half)


def _write_blocks(code: VectorCode, expanded: Any, places: Any, blocks: Any, order: Any) -> None:
    """Add the numbers of each pair of nodes to its block, along the rows as they are stored."""
    builder, integer = code.builder, ir.IntType(64)

    def whole(pointer: Any, index: Any) -> Any:
        return builder.load(builder.gep(pointer, [index], source_etype=integer), typ=integer)

    def constant(value: int) -> Any:
        return ir.Constant(integer, value)

    with code.repeat(constant(len(SHELL_PAIRS))) as pair:
        column = builder.mul(pair.index, constant(2))
        place = whole(places, column)
        swap = whole(places, builder.add(column, constant(1)))
        first = builder.mul(builder.add(column, swap), constant(ROWS * ROWS))
        with code.repeat(constant(ROWS)) as row:
            target = code.at(blocks, builder.add(place, builder.mul(row.index, constant(COLUMNS))))
            source = builder.add(first, builder.mul(row.index, constant(ROWS)))
            for begin, lanes in ((0, 8), (8, 4)):
                values = ir.Constant(ir.VectorType(ir.DoubleType(), lanes), ir.Undefined)
                for lane in range(lanes):
                    index = whole(order, builder.add(source, constant(begin + lane)))
                    number = builder.load(code.at(expanded, index), typ=ir.DoubleType())
                    values = builder.insert_element(values, number, ir.Constant(ir.IntType(32), lane))
                code.store(code.add(code.load(target, begin, lanes), values), target, begin)
