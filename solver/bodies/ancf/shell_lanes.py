"""Strains and forces of one shell element in vector registers.

The 16 shape functions are products ``H_i(xi) H_j(eta)``, so sums over them are done one direction at a
time: first over eta for all Gauss points of a line at once (they are the lanes), then over xi line by
line; forces go the same way back. Slopes of the mesh are scaled by the lengths of the element where the functions
are read, so coordinates are used as they lie. As in `heavylift.numerics.lanes`, LLVM would not find these
vectors by itself. Places of numbers: `heavylift.solver.bodies.ancf.shell_data`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir

from heavylift.numerics.jit import intrinsic
from heavylift.numerics.vector_code import VectorCode, vector_code
from heavylift.solver.bodies.ancf.shell_data import (
    LANES,
    LINE,
    POINTS,
    STRAINS_PER_LINE,
    ShellData,
    ShellLine,
    ShellTables,
    place_of,
)

__all__ = [
    "add_element_forces",
    "add_element_pressure",
    "add_element_rates",
    "contracted",
    "put_element_strains",
    "slopes_of_line",
    "write_forces",
]

COUNT = place_of(ShellTables, "count")
ETA = place_of(ShellTables, "eta")
LENGTHS = place_of(ShellData, "lengths")
METRIC = place_of(ShellLine, "metric")
MODULI = place_of(ShellLine, "moduli")
WEIGHTS = place_of(ShellTables, "weights")
XI = place_of(ShellTables, "xi")

Vectors = list[list[Any]]
"""By function along xi and component."""


def node_place(i: int, j: int, k: int) -> tuple[int, int]:
    """Node of an element and place in it of component k that belongs to functions i along xi, j along eta."""
    return ((0, 3), (1, 2))[i // 2][j // 2], 3 * (i % 2 + 2 * (j % 2)) + k


def eta_functions(code: VectorCode, tables: Any, data: Any) -> list[list[Any]]:
    """Functions and derivatives along eta, in lanes, for slopes by the length of the mesh."""
    length = code.spread(code.number(data, LENGTHS + 1))
    rows = [[code.load(tables, ETA + 32 * d + 8 * j) for j in range(4)] for d in range(2)]
    return [[code.multiply(row[j], length) if j % 2 else row[j] for j in range(4)] for row in rows]


def contracted(
    code: VectorCode, tables: Any, data: Any, nodes: Sequence[Any], components: Sequence[int] = (0, 1, 2)
) -> tuple[Vectors, Vectors]:
    """Sums over eta of functions and of derivatives times coordinates, by function along xi and component."""
    along_eta = eta_functions(code, tables, data)
    length = code.spread(code.number(data, LENGTHS))
    out: tuple[Vectors, Vectors] = ([], [])
    for i in range(4):
        for d in range(2):
            out[d].append([])
        for k in components:
            places = [node_place(i, j, k) for j in range(4)]
            numbers = [code.spread(code.number(nodes[node], place)) for node, place in places]
            for d in range(2):
                total = code.sum(*zip(along_eta[d], numbers, strict=True))
                out[d][i].append(code.multiply(total, length) if i % 2 else total)
    return out


def slopes_of_line(
    code: VectorCode, functions: Any, sums: tuple[Vectors, Vectors]
) -> tuple[list[Any], list[Any]]:
    """``r_xi`` and ``r_eta`` on a line, by component."""
    H = [code.spread(code.number(functions, i)) for i in range(4)]
    dH = [code.spread(code.number(functions, 4 + i)) for i in range(4)]
    values, derivatives = sums
    count = len(values[0])
    return (
        [code.sum(*((dH[i], values[i][k]) for i in range(4))) for k in range(count)],
        [code.sum(*((H[i], derivatives[i][k]) for i in range(4))) for k in range(count)],
    )


def stress_of_line(code: VectorCode, moduli: Any, strains: Any) -> tuple[Any, Any, Any]:
    """N_11, N_22 and N_12 on a line."""
    e = [code.load(strains, 8 * c) for c in range(3)]
    D = [code.load(moduli, MODULI + 8 * c) for c in range(6)]
    return (
        code.sum((D[0], e[0]), (D[3], e[1]), (D[4], e[2])),
        code.sum((D[3], e[0]), (D[1], e[1]), (D[5], e[2])),
        code.sum((D[4], e[0]), (D[5], e[1]), (D[2], e[2])),
    )


def lines(code: VectorCode, tables: Any) -> Any:
    """Loop over the lines of Gauss points."""
    integer = ir.IntType(64)
    place = code.builder.bitcast(code.at(tables, COUNT), integer.as_pointer())
    return code.repeat(code.builder.load(place, typ=integer))


def add_to_nodes(
    code: VectorCode, nodes: Sequence[Any], products: Callable[[int, int, int], Any], factor: Any
) -> None:
    """Add the sums over lanes of a product for every function along xi and eta and component."""
    vectors: dict[tuple[int, int], Any] = {}
    for i in range(4):
        for j in range(4):
            for k in range(3):
                vectors[node_place(i, j, k)] = products(i, j, k)
    factor = code.spread(factor)
    tails = []
    for node in range(4):
        head = code.multiply(code.totals_of_eight([vectors[node, place] for place in range(8)]), factor)
        code.store(code.add(code.load(nodes[node], 0), head), nodes[node], 0)
    for node in (0, 2):
        pair = [vectors[node + n, place] for n in range(2) for place in range(8, 12)]
        tail = code.multiply(code.totals_of_eight(pair), factor)
        tails += [code.choose(tail, tail, range(4 * n, 4 * n + 4)) for n in range(2)]
    for node, tail in enumerate(tails):
        code.store(code.add(code.load(nodes[node], 8, 4), tail), nodes[node], 8)


def write_forces(
    code: VectorCode,
    tables: Any,
    data: Any,
    nodes: Sequence[Any],
    strains: Any,
    forces: Sequence[Any],
    factor: Any,
) -> None:
    """``f += factor B^T D e``, one component at a time so that all its sums stay in registers."""
    memory = code.memory(3 * LANES)
    with lines(code, tables) as loop:
        stress = stress_of_line(
            code,
            code.line(data, POINTS, loop.index, LINE),
            code.line(strains, 0, loop.index, STRAINS_PER_LINE),
        )
        for c, value in enumerate(stress):
            code.store(value, code.line(memory, 0, loop.index, STRAINS_PER_LINE), 8 * c)
    totals = {}
    for k in range(3):
        sums = contracted(code, tables, data, nodes, (k,))
        places = [code.variable(code.constant(0.0)) for _ in range(8)]
        with lines(code, tables) as loop:
            functions = code.line(tables, XI, loop.index, 8)
            (a,), (b,) = slopes_of_line(code, functions, sums)
            stresses = code.line(memory, 0, loop.index, STRAINS_PER_LINE)
            N11, N22, N12 = (code.load(stresses, 8 * c) for c in range(3))
            along_xi = code.sum((N11, a), (N12, b))
            along_eta = code.sum((N12, a), (N22, b))
            for i in range(4):
                for place, value, index in ((i, along_xi, 4 + i), (4 + i, along_eta, i)):
                    function = code.spread(code.number(functions, index))
                    total = code.builder.load(places[place], typ=code.vector)
                    code.builder.store(code.add(total, code.multiply(function, value)), places[place])
        for i, place in enumerate(places):
            totals[i, k] = code.builder.load(place, typ=code.vector)
    along = eta_functions(code, tables, data)
    length = code.spread(code.number(data, LENGTHS))
    for (i, k), value in totals.items():
        totals[i, k] = code.multiply(value, length) if i % 2 else value
    add_to_nodes(
        code,
        forces,
        lambda i, j, k: code.sum((along[0][j], totals[i, k]), (along[1][j], totals[4 + i, k])),
        factor,
    )


@intrinsic
def put_element_strains(typingctx, constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at):  # type: ignore[no-untyped-def]
    """``e = (r_a.r_b - X_a.X_b)/2`` at all Gauss points."""

    def write(code: VectorCode, tables: Any, data: Any, nodes: Any, strains: Any) -> None:
        sums = contracted(code, tables, data, nodes)
        with lines(code, tables) as loop:
            a, b = slopes_of_line(code, code.line(tables, XI, loop.index, 8), sums)
            metric = code.line(data, POINTS, loop.index, LINE)
            out = code.line(strains, 0, loop.index, STRAINS_PER_LINE)
            products = [code.sum(*zip(x, y, strict=True)) for x, y in ((a, a), (b, b), (a, b))]
            for c, product in enumerate(products):
                present = code.multiply(product, code.constant(0.5)) if c < 2 else product
                code.store(code.subtract(present, code.load(metric, METRIC + 8 * c)), out, 8 * c)

    arguments = (constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at)
    return vector_code(arguments, (1, 1, 4, 1), write, lanes=LANES)


@intrinsic
def add_element_rates(  # type: ignore[no-untyped-def]
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
    nodal_2,
    v0,
    v1,
    v2,
    v3,
    strains,
    at,
    factor,
):
    """``e += factor B v`` at all Gauss points."""

    def write(
        code: VectorCode, tables: Any, data: Any, nodes: Any, speeds: Any, strains: Any, factor: Any
    ) -> None:
        sums, rates = (contracted(code, tables, data, place) for place in (nodes, speeds))
        factor = code.spread(factor)
        with lines(code, tables) as loop:
            functions = code.line(tables, XI, loop.index, 8)
            a, b = slopes_of_line(code, functions, sums)
            da, db = slopes_of_line(code, functions, rates)
            out = code.line(strains, 0, loop.index, STRAINS_PER_LINE)
            changes = [code.sum(*zip(x, y, strict=True)) for x, y in ((a, da), (b, db), (a + b, db + da))]
            for c, change in enumerate(changes):
                code.store(code.add(code.load(out, 8 * c), code.multiply(factor, change)), out, 8 * c)

    arguments = (
        constants, tables, constants_2, data, nodal, n0, n1, n2, n3, nodal_2, v0, v1, v2, v3, strains, at, factor
    )  # fmt: skip
    return vector_code(arguments, (1, 1, 4, 4, 1), write, lanes=LANES)


@intrinsic
def add_element_forces(  # type: ignore[no-untyped-def]
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
    nodal_2,
    f0,
    f1,
    f2,
    f3,
    factor,
):
    """``f += factor B^T D e``."""
    arguments = (
        constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at, nodal_2, f0, f1, f2, f3, factor
    )  # fmt: skip
    return vector_code(arguments, (1, 1, 4, 1, 4), write_forces, lanes=LANES)


@intrinsic
def add_element_pressure(  # type: ignore[no-untyped-def]
    typingctx, constants, tables, constants_2, data, nodal, n0, n1, n2, n3, nodal_2, f0, f1, f2, f3, factor
):
    """``f += factor int S^T (r_xi x r_eta) dxi deta``: pressure times the present area."""

    def write(code: VectorCode, tables: Any, data: Any, nodes: Any, forces: Any, factor: Any) -> None:
        sums = contracted(code, tables, data, nodes)
        places = {(i, k): code.variable(code.constant(0.0)) for i in range(4) for k in range(3)}
        weights = code.load(tables, WEIGHTS)
        with lines(code, tables) as loop:
            functions = code.line(tables, XI, loop.index, 8)
            a, b = slopes_of_line(code, functions, sums)
            weight = code.multiply(
                weights, code.spread(code.number(code.line(tables, WEIGHTS + 8, loop.index, 1), 0))
            )
            for k in range(3):
                m, n = (k + 1) % 3, (k + 2) % 3
                area = code.subtract(code.multiply(a[m], b[n]), code.multiply(a[n], b[m]))
                weighted = code.multiply(area, weight)
                for i in range(4):
                    function = code.spread(code.number(functions, i))
                    total = code.builder.load(places[i, k], typ=code.vector)
                    code.builder.store(code.add(total, code.multiply(function, weighted)), places[i, k])
        along = eta_functions(code, tables, data)[0]
        length = code.spread(code.number(data, LENGTHS))
        totals = {}
        for (i, k), place in places.items():
            value = code.builder.load(place, typ=code.vector)
            totals[i, k] = code.multiply(value, length) if i % 2 else value
        add_to_nodes(code, forces, lambda i, j, k: code.multiply(along[j], totals[i, k]), factor)

    arguments = (constants, tables, constants_2, data, nodal, n0, n1, n2, n3, nodal_2, f0, f1, f2, f3, factor)
    return vector_code(arguments, (1, 1, 4, 4), write, lanes=LANES)
