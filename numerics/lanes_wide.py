"""Long products of blocks in vector registers: the arithmetic of factors with many blocks.

`heavylift.numerics.lanes` treats one block at a time. Here blocks that stand one after another are one
matrix with a long inner dimension: the sum stays in registers, and its target is read and written once.
A tile of the target is as many columns as there are registers for; of the lanes only those in use.
"""

# ruff: noqa: ARG001  an intrinsic must take a typing context

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from heavylift.numerics.lanes import FLAGS

__all__ = ["subtract_backward_sum", "subtract_products"]

INTEGER = ir.IntType(64)
DOUBLE = ir.DoubleType()


def _registers(context: Any) -> tuple[int, int]:
    """Number of vector registers of the machine that code is made for, and how many doubles one holds."""
    features = context.codegen().magic_tuple()[2].split(",")
    if "+avx512f" in features:
        return 32, 8
    if "+avx" in features:
        return 16, 4
    return (32 if "+neon" in features else 16), 2


def _pieces(rows: int, width: int) -> list[tuple[int, int]]:
    """First lane and length of the vectors that cover the rows: powers of two, none wider than a register."""
    pieces = []
    first = 0
    while first < rows:
        length = width
        while length > 1 and length // 2 >= rows - first:
            length //= 2
        pieces.append((first, length))
        first += length
    return pieces


def _exact_pieces(rows: int, width: int) -> list[tuple[int, int]]:
    """As `_pieces`, without reading any lane that is not in use."""
    pieces = []
    first = 0
    while first < rows:
        length = width
        while length > rows - first:
            length //= 2
        pieces.append((first, length))
        first += length
    return pieces


def _tiles(rows: int, pieces: int, registers: int) -> Iterator[range]:
    """Columns in groups whose sums fit into the registers, beside one operand and one factor."""
    most = max(1, (registers - 2) // pieces - 1)
    count = -(-rows // most)
    for i in range(count):
        yield range(rows * i // count, rows * (i + 1) // count)


class _Writer:
    """Writes instructions for vectors of several lengths."""

    def __init__(self, context: Any, builder: ir.IRBuilder, shape: Any) -> None:
        self.context, self.builder = context, builder
        self.rows, self.lanes = shape.types[0].count, shape.types[1].count

    def data(self, array_type: Any, array: Any) -> Any:
        """Address of the first number; an array of records has it under the same name."""
        return cgutils.create_struct_proxy(array_type)(self.context, self.builder, array).data

    def at(self, pointer: Any, offset: Any, element: Any = DOUBLE) -> Any:
        place = ir.Constant(INTEGER, offset) if isinstance(offset, int) else offset
        return self.builder.gep(pointer, [place], source_etype=element)

    def _vector_place(self, pointer: Any, offset: Any, vector: Any) -> Any:
        return self.builder.bitcast(self.at(pointer, offset), vector.as_pointer())

    def load(self, pointer: Any, offset: Any, length: int) -> Any:
        vector = ir.VectorType(DOUBLE, length)
        return self.builder.load(self._vector_place(pointer, offset, vector), align=8, typ=vector)

    def store(self, value: Any, pointer: Any, offset: Any) -> None:
        self.builder.store(value, self._vector_place(pointer, offset, value.type), align=8)

    def number(self, pointer: Any, offset: Any, element: Any = DOUBLE) -> Any:
        return self.builder.load(self.at(pointer, offset, element), typ=element)

    def spread(self, number: Any, length: int) -> Any:
        """The same number in all lanes."""
        vector = ir.VectorType(DOUBLE, length)
        one = self.builder.insert_element(
            ir.Constant(vector, ir.Undefined), number, ir.Constant(ir.IntType(32), 0)
        )
        mask = ir.Constant(ir.VectorType(ir.IntType(32), length), [0] * length)
        return self.builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), mask)

    def multiply_add(self, total: Any, a: Any, b: Any, *, negative: bool = False) -> Any:
        product = self.builder.fmul(a, b, flags=FLAGS)
        return (self.builder.fsub if negative else self.builder.fadd)(total, product, flags=FLAGS)

    def total(self, vector: Any) -> Any:
        """Sum of the lanes, by halves."""
        length = vector.type.count
        while length > 1:
            length //= 2
            halves = [
                self.builder.shuffle_vector(
                    vector,
                    ir.Constant(vector.type, ir.Undefined),
                    ir.Constant(ir.VectorType(ir.IntType(32), length), list(range(first, first + length))),
                )
                for first in (0, length)
            ]
            vector = self.builder.fadd(*halves, flags=FLAGS)
        return self.builder.extract_element(vector, ir.Constant(ir.IntType(32), 0))

    @contextmanager
    def loop(self, count: Any, sums: dict[Any, Any]) -> Iterator[tuple[Any, dict[Any, Any]]]:
        """Body of a loop over ``0 ... count - 1`` that changes `sums`, which live in registers."""
        slots = {key: cgutils.alloca_once(self.builder, value.type) for key, value in sums.items()}
        for key, value in sums.items():
            self.builder.store(value, slots[key])
        with cgutils.for_range(self.builder, count) as inner:
            present = {key: self.builder.load(slot, typ=sums[key].type) for key, slot in slots.items()}
            yield inner.index, present
            for key, value in present.items():
                self.builder.store(value, slots[key])
        for key, slot in slots.items():
            sums[key] = self.builder.load(slot, typ=sums[key].type)


@intrinsic
def subtract_products(  # type: ignore[no-untyped-def]
    typingctx, shape, target, target_at, left, left_at, right, right_at, count
):
    """``T -= Y_1 W_1^T + Y_2 W_2^T + ...`` with `count` blocks W of `left` and Y of `right`, each side by side.

    The lanes of T that are not in use may or may not change.
    """
    signature = types.void(shape, target, target_at, left, left_at, right, right_at, count)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        code = _Writer(context, builder, signature.args[0])
        T, W, Y = (code.at(code.data(signature.args[i], values[i]), values[i + 1]) for i in (1, 3, 5))
        registers, width = _registers(context)
        pieces = _pieces(code.rows, width)
        steps = builder.mul(values[7], ir.Constant(INTEGER, code.rows))
        for columns in _tiles(code.rows, len(pieces), registers):
            places = {(c, p): c * code.lanes + pieces[p][0] for c in columns for p in range(len(pieces))}
            sums = {key: code.load(T, place, pieces[key[1]][1]) for key, place in places.items()}
            with code.loop(steps, sums) as (d, present):
                row = builder.mul(d, ir.Constant(INTEGER, code.lanes))
                w, y = code.at(W, row), code.at(Y, row)
                operands = [code.load(y, first, length) for first, length in pieces]
                for c in columns:
                    factor = code.number(w, c)
                    for p, operand in enumerate(operands):
                        value = code.spread(factor, operand.type.count)
                        present[c, p] = code.multiply_add(present[c, p], operand, value, negative=True)
            for key, place in places.items():
                code.store(sums[key], T, place)
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def subtract_backward_sum(  # type: ignore[no-untyped-def]
    typingctx, shape, vectors, vectors_at, node, blocks, base, pivot, lower, first, count
):
    """``z_j -= D^-1 sum_i Y_i^T x_i`` over rows `first` to `first + count` of `lower`: their nodes and places.

    `node` is that of z, and `pivot` the place of its block; places count from `base` of `blocks`, vectors
    of nodes from `vectors_at`.
    """
    signature = types.void(shape, vectors, vectors_at, node, blocks, base, pivot, lower, first, count)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        code = _Writer(context, builder, signature.args[0])
        _, x, x_at, node, blocks, base, pivot, lower, first, count = values
        X = code.at(code.data(signature.args[1], x), x_at)
        B = code.at(code.data(signature.args[4], blocks), base)
        table = code.at(
            code.data(signature.args[7], lower), builder.mul(first, ir.Constant(INTEGER, 2)), INTEGER
        )
        lanes = ir.Constant(INTEGER, code.lanes)
        z = code.at(X, builder.mul(node, lanes))
        D = code.at(B, pivot)
        registers, width = _registers(context)
        pieces = _exact_pieces(code.rows, width)
        for columns in _tiles(code.rows, len(pieces), registers):
            sums = {
                (c, p): ir.Constant(ir.VectorType(DOUBLE, length), [0.0] * length)
                for c in columns
                for p, (_, length) in enumerate(pieces)
            }
            with code.loop(count, sums) as (i, present):
                entry = builder.mul(i, ir.Constant(INTEGER, 2))
                later = code.at(X, builder.mul(code.number(table, entry, INTEGER), lanes))
                one = ir.Constant(INTEGER, 1)
                Y = code.at(B, code.number(table, builder.add(entry, one), INTEGER))
                operands = [code.load(later, start, length) for start, length in pieces]
                for c in columns:
                    for p, (start, length) in enumerate(pieces):
                        column = code.load(Y, c * code.lanes + start, length)
                        present[c, p] = code.multiply_add(present[c, p], column, operands[p])
            for c in columns:
                change = code.total(sums[c, 0])
                for p in range(1, len(pieces)):
                    change = builder.fadd(change, code.total(sums[c, p]), flags=FLAGS)
                inverse = code.number(D, c * (code.lanes + 1))
                value = code.multiply_add(code.number(z, c), change, inverse, negative=True)
                builder.store(value, code.at(z, c))
        return context.get_dummy_value()

    return signature, generate
