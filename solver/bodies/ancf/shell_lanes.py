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
from numba.core import cgutils, types
from numba.extending import intrinsic

from heavylift.solver.bodies.ancf.shell_data import (
    COUNT,
    ETA,
    LANES,
    LENGTHS,
    LINE,
    METRIC,
    MODULI,
    POINTS,
    STRAINS_PER_LINE,
    WEIGHTS,
    XI,
)

__all__ = [
    "Lanes",
    "add_element_forces",
    "add_element_pressure",
    "add_element_rates",
    "contracted",
    "element_code",
    "put_element_strains",
    "slopes_of_line",
    "write_forces",
]

FLAGS = ("contract", "nsz", "arcp")
"""The rounding flags of `heavylift.numerics.jit.kernel`."""

Vectors = list[list[Any]]
"""By function along xi and component."""


class Lanes:
    """Writes vector instructions on eight lanes."""

    def __init__(self, context: Any, builder: ir.IRBuilder) -> None:
        self.context, self.builder = context, builder
        self.vector = ir.VectorType(ir.DoubleType(), LANES)

    def pointer(self, array_type: Any, array: Any, offset: Any) -> Any:
        """Address of the double at an offset of a contiguous array."""
        data = self.context.make_array(array_type)(self.context, self.builder, array).data
        return self.at(data, offset)

    def at(self, pointer: Any, index: Any) -> Any:
        if isinstance(index, int):
            index = ir.Constant(ir.IntType(64), index)
        return self.builder.gep(pointer, [index], source_etype=ir.DoubleType())

    def line(self, pointer: Any, first: int, index: Any, size: int) -> Any:
        """Address of the numbers of a line."""
        return self.at(self.at(pointer, first), self.builder.mul(index, ir.Constant(ir.IntType(64), size)))

    def load(self, pointer: Any, index: int, lanes: int = LANES) -> Any:
        kind = ir.VectorType(ir.DoubleType(), lanes)
        place = self.builder.bitcast(self.at(pointer, index), kind.as_pointer())
        return self.builder.load(place, align=8, typ=kind)

    def store(self, value: Any, pointer: Any, index: int) -> None:
        place = self.builder.bitcast(self.at(pointer, index), value.type.as_pointer())
        self.builder.store(value, place, align=8)

    def number(self, pointer: Any, index: int) -> Any:
        return self.builder.load(self.at(pointer, index), typ=ir.DoubleType())

    def spread(self, number: Any) -> Any:
        """The same number in all lanes."""
        undefined = ir.Constant(self.vector, ir.Undefined)
        one = self.builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
        mask = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
        return self.builder.shuffle_vector(one, undefined, mask)

    def choose(self, a: Any, b: Any, mask: Sequence[int]) -> Any:
        """Lanes of two vectors: numbers from their count on mean the second."""
        return self.builder.shuffle_vector(
            a, b, ir.Constant(ir.VectorType(ir.IntType(32), len(mask)), list(mask))
        )

    def zero(self) -> Any:
        return ir.Constant(self.vector, [0.0] * LANES)

    def half(self) -> Any:
        return ir.Constant(self.vector, [0.5] * LANES)

    def multiply(self, a: Any, b: Any) -> Any:
        return self.builder.fmul(a, b, flags=FLAGS)

    def add(self, a: Any, b: Any) -> Any:
        return self.builder.fadd(a, b, flags=FLAGS)

    def subtract(self, a: Any, b: Any) -> Any:
        return self.builder.fsub(a, b, flags=FLAGS)

    def sum(self, *products: tuple[Any, Any]) -> Any:
        """Sum of products."""
        total = self.multiply(*products[0])
        for a, b in products[1:]:
            total = self.add(total, self.multiply(a, b))
        return total

    def memory(self, vectors: int) -> Any:
        """Room for vectors on the stack."""
        place = cgutils.alloca_once(self.builder, self.vector, size=vectors)
        return self.builder.bitcast(place, ir.DoubleType().as_pointer())

    def sums_of_lanes(self, vectors: list[Any]) -> Any:
        """The sum over the lanes of each of eight vectors, in order."""
        pairs = []
        for x, y in zip(vectors[::2], vectors[1::2], strict=True):
            even = self.choose(x, y, [0, 8, 2, 10, 4, 12, 6, 14])
            odd = self.choose(x, y, [1, 9, 3, 11, 5, 13, 7, 15])
            pairs.append(self.add(even, odd))
        while len(pairs) > 1:
            pairs = [
                self.add(
                    self.choose(x, y, [0, 1, 4, 5, 8, 9, 12, 13]),
                    self.choose(x, y, [2, 3, 6, 7, 10, 11, 14, 15]),
                )
                for x, y in zip(pairs[::2], pairs[1::2], strict=True)
            ]
        return pairs[0]


def node_place(i: int, j: int, k: int) -> tuple[int, int]:
    """Node of an element and place in it of component k that belongs to functions i along xi, j along eta."""
    return ((0, 3), (1, 2))[i // 2][j // 2], 3 * (i % 2 + 2 * (j % 2)) + k


def eta_functions(code: Lanes, tables: Any, data: Any) -> list[list[Any]]:
    """Functions and derivatives along eta, in lanes, for slopes by the length of the mesh."""
    length = code.spread(code.number(data, LENGTHS + 1))
    rows = [[code.load(tables, ETA + 32 * d + 8 * j) for j in range(4)] for d in range(2)]
    return [[code.multiply(row[j], length) if j % 2 else row[j] for j in range(4)] for row in rows]


def contracted(
    code: Lanes, tables: Any, data: Any, nodes: Sequence[Any], components: Sequence[int] = (0, 1, 2)
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
    code: Lanes, functions: Any, sums: tuple[Vectors, Vectors]
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


def stress_of_line(code: Lanes, moduli: Any, strains: Any) -> tuple[Any, Any, Any]:
    """N_11, N_22 and N_12 on a line."""
    e = [code.load(strains, 8 * c) for c in range(3)]
    D = [code.load(moduli, MODULI + 8 * c) for c in range(6)]
    return (
        code.sum((D[0], e[0]), (D[3], e[1]), (D[4], e[2])),
        code.sum((D[3], e[0]), (D[1], e[1]), (D[5], e[2])),
        code.sum((D[4], e[0]), (D[5], e[1]), (D[2], e[2])),
    )


def lines(code: Lanes, tables: Any) -> Any:
    """Loop over the lines of Gauss points."""
    count = code.builder.fptosi(code.number(tables, COUNT), ir.IntType(64))
    return cgutils.for_range(code.builder, count)


def add_to_nodes(code: Lanes, nodes: Sequence[Any], products: Callable[[int, int, int], Any], factor: Any) -> None:
    """Add the sums over lanes of a product for every function along xi and eta and component."""
    vectors: dict[tuple[int, int], Any] = {}
    for i in range(4):
        for j in range(4):
            for k in range(3):
                vectors[node_place(i, j, k)] = products(i, j, k)
    factor = code.spread(factor)
    tails = []
    for node in range(4):
        head = code.multiply(code.sums_of_lanes([vectors[node, place] for place in range(8)]), factor)
        code.store(code.add(code.load(nodes[node], 0), head), nodes[node], 0)
    for node in (0, 2):
        pair = [vectors[node + n, place] for n in range(2) for place in range(8, 12)]
        tail = code.multiply(code.sums_of_lanes(pair), factor)
        tails += [code.choose(tail, tail, range(4 * n, 4 * n + 4)) for n in range(2)]
    for node, tail in enumerate(tails):
        code.store(code.add(code.load(nodes[node], 8, 4), tail), nodes[node], 8)


def write_forces(
    code: Lanes, tables: Any, data: Any, nodes: Sequence[Any], strains: Any, forces: Sequence[Any], factor: Any
) -> None:
    """``f += factor B^T D e``, one component at a time so that all its sums stay in registers."""
    memory = code.memory(3 * LANES)
    with lines(code, tables) as loop:
        stress = stress_of_line(
            code, code.line(data, POINTS, loop.index, LINE), code.line(strains, 0, loop.index, STRAINS_PER_LINE)
        )
        for c, value in enumerate(stress):
            code.store(value, code.line(memory, 0, loop.index, STRAINS_PER_LINE), 8 * c)
    totals = {}
    for k in range(3):
        sums = contracted(code, tables, data, nodes, (k,))
        places = [cgutils.alloca_once_value(code.builder, code.zero()) for _ in range(8)]
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


def element_code(
    arguments: Sequence[Any], groups: Sequence[int], write: Callable[..., None]
) -> tuple[Any, Callable[..., Any]]:
    """Signature and generator of an intrinsic on arrays with one or more offsets each, then numbers.

    `write` gets, for each array, one pointer or as many as it has offsets, then the numbers as doubles.
    """
    signature = types.void(*arguments)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        code = Lanes(context, builder)
        given, at = [], 0
        for offsets in groups:
            kind, array = signature.args[at], values[at]
            places = [code.pointer(kind, array, values[at + 1 + o]) for o in range(offsets)]
            given.append(places if offsets > 1 else places[0])
            at += 1 + offsets
        numbers = [
            context.cast(builder, values[i], signature.args[i], types.float64) for i in range(at, len(values))
        ]
        write(code, *given, *numbers)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def put_element_strains(typingctx, constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at):  # type: ignore[no-untyped-def]
    """``e = (r_a.r_b - X_a.X_b)/2`` at all Gauss points."""

    def write(code: Lanes, tables: Any, data: Any, nodes: Any, strains: Any) -> None:
        sums = contracted(code, tables, data, nodes)
        with lines(code, tables) as loop:
            a, b = slopes_of_line(code, code.line(tables, XI, loop.index, 8), sums)
            metric = code.line(data, POINTS, loop.index, LINE)
            out = code.line(strains, 0, loop.index, STRAINS_PER_LINE)
            products = [code.sum(*zip(x, y, strict=True)) for x, y in ((a, a), (b, b), (a, b))]
            for c, product in enumerate(products):
                present = code.multiply(product, code.half()) if c < 2 else product
                code.store(code.subtract(present, code.load(metric, METRIC + 8 * c)), out, 8 * c)

    arguments = (constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at)
    return element_code(arguments, (1, 1, 4, 1), write)


@intrinsic
def add_element_rates(  # type: ignore[no-untyped-def]
    typingctx, constants, tables, constants_2, data, nodal, n0, n1, n2, n3, nodal_2, v0, v1, v2, v3, strains, at, factor
):
    """``e += factor B v`` at all Gauss points."""

    def write(code: Lanes, tables: Any, data: Any, nodes: Any, speeds: Any, strains: Any, factor: Any) -> None:
        sums, rates = (contracted(code, tables, data, place) for place in (nodes, speeds))
        factor = code.spread(factor)
        with lines(code, tables) as loop:
            functions = code.line(tables, XI, loop.index, 8)
            a, b = slopes_of_line(code, functions, sums)
            da, db = slopes_of_line(code, functions, rates)
            out = code.line(strains, 0, loop.index, STRAINS_PER_LINE)
            changes = [
                code.sum(*zip(x, y, strict=True)) for x, y in ((a, da), (b, db), (a + b, db + da))
            ]
            for c, change in enumerate(changes):
                code.store(code.add(code.load(out, 8 * c), code.multiply(factor, change)), out, 8 * c)

    arguments = (
        constants, tables, constants_2, data, nodal, n0, n1, n2, n3, nodal_2, v0, v1, v2, v3, strains, at, factor
    )  # fmt: skip
    return element_code(arguments, (1, 1, 4, 4, 1), write)


@intrinsic
def add_element_forces(  # type: ignore[no-untyped-def]
    typingctx, constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at, nodal_2, f0, f1, f2, f3, factor
):
    """``f += factor B^T D e``."""
    arguments = (
        constants, tables, constants_2, data, nodal, n0, n1, n2, n3, strains, at, nodal_2, f0, f1, f2, f3, factor
    )  # fmt: skip
    return element_code(arguments, (1, 1, 4, 1, 4), write_forces)


@intrinsic
def add_element_pressure(  # type: ignore[no-untyped-def]
    typingctx, constants, tables, constants_2, data, nodal, n0, n1, n2, n3, nodal_2, f0, f1, f2, f3, factor
):
    """``f += factor int S^T (r_xi x r_eta) dxi deta``: pressure times the present area."""

    def write(code: Lanes, tables: Any, data: Any, nodes: Any, forces: Any, factor: Any) -> None:
        sums = contracted(code, tables, data, nodes)
        places = {
            (i, k): cgutils.alloca_once_value(code.builder, code.zero()) for i in range(4) for k in range(3)
        }
        weights = code.load(tables, WEIGHTS)
        with lines(code, tables) as loop:
            functions = code.line(tables, XI, loop.index, 8)
            a, b = slopes_of_line(code, functions, sums)
            weight = code.multiply(weights, code.spread(code.number(code.line(tables, WEIGHTS + 8, loop.index, 1), 0)))
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
    return element_code(arguments, (1, 1, 4, 4), write)
