"""Sums over rows of twelve numbers, by vector instructions.

The compiler makes vector instructions of long loops only. A loop over twelve numbers it writes out number by number,
and stores in between keep it from joining them again. Here the instructions are given: four numbers at a time.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

__all__ = ["COLUMNS", "add_product_of_rows", "add_rows", "multiply_rows"]

COLUMNS = 12
"""Numbers of a row."""

LANES = 4
"""Numbers of a vector: 256 bits, which all processors of the last decade have; others split it."""

DOUBLE = ir.DoubleType()
VECTOR = ir.VectorType(DOUBLE, LANES)
CONTRACT = ("contract",)


class _Rows:
    """Writes instructions on a one-dimensional array."""

    def __init__(self, context: Any, builder: Any, kind: Any, array: Any, at: Any) -> None:
        data = context.make_array(kind)(context, builder, array).data
        self._builder = builder
        self._first = builder.gep(data, [at])

    def _pointer(self, i: int, kind: Any) -> Any:
        place = self._builder.gep(self._first, [ir.Constant(ir.IntType(64), i)])
        return self._builder.bitcast(place, kind.as_pointer())

    def vector(self, i: int) -> Any:
        """Four numbers from the i-th on."""
        return self._builder.load(self._pointer(i, VECTOR), align=8)

    def everywhere(self, i: int) -> Any:
        """The i-th number in all lanes."""
        return _everywhere(self._builder, self._builder.load(self._pointer(i, DOUBLE), align=8))

    def store(self, i: int, value: Any) -> None:
        """Write four numbers from the i-th on."""
        self._builder.store(value, self._pointer(i, VECTOR), align=8)


def _everywhere(builder: Any, number: Any) -> Any:
    one = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    lanes = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, ir.Constant(VECTOR, ir.Undefined), lanes)


def _combine(builder: Any, factors: list[Any], vectors: list[Any], start: Any = None) -> Any:
    total = start
    for factor, vector in zip(factors, vectors, strict=True):
        product = builder.fmul(factor, vector, flags=CONTRACT)
        total = product if total is None else builder.fadd(total, product, flags=CONTRACT)
    return total


def _are_arrays(*kinds: Any) -> bool:
    return all(
        isinstance(kind, types.Array)
        and kind.ndim == 1
        and kind.layout == "C"
        and kind.dtype == types.float64
        for kind in kinds
    )


@intrinsic
def multiply_rows(typing: Any, N: Any, o: Any, y: Any) -> Any:
    """Products of the three rows at ``N[o]`` with the row y: three numbers."""
    del typing, o
    if not _are_arrays(N, y):
        return None

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        rows = _Rows(context, builder, N, arguments[0], arguments[1])
        factors = _Rows(context, builder, y, arguments[2], ir.Constant(ir.IntType(64), 0))
        vectors = [factors.vector(j) for j in range(0, COLUMNS, LANES)]
        found = []
        for k in range(3):
            total = _combine(
                builder, [rows.vector(COLUMNS * k + j) for j in range(0, COLUMNS, LANES)], vectors
            )
            lanes = [builder.extract_element(total, ir.Constant(ir.IntType(32), i)) for i in range(LANES)]
            halves = builder.fadd(lanes[0], lanes[2]), builder.fadd(lanes[1], lanes[3])
            found.append(builder.fadd(*halves))
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(types.float64, 3)(N, types.int64, y), write


@intrinsic
def add_rows(typing: Any, N: Any, o: Any, p0: Any, p1: Any, p2: Any, z: Any) -> Any:
    """Add ``p0``, ``p1`` and ``p2`` times the three rows at ``N[o]`` to the row z."""
    del typing, o, p0, p1, p2
    if not _are_arrays(N, z):
        return None

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        del signature
        rows = _Rows(context, builder, N, arguments[0], arguments[1])
        sums = _Rows(context, builder, z, arguments[5], ir.Constant(ir.IntType(64), 0))
        factors = [_everywhere(builder, number) for number in arguments[2:5]]
        for j in range(0, COLUMNS, LANES):
            added = _combine(builder, factors, [rows.vector(COLUMNS * k + j) for k in range(3)])
            sums.store(j, builder.fadd(sums.vector(j), added))
        return context.get_dummy_value()

    return types.void(N, types.int64, types.float64, types.float64, types.float64, z), write


@intrinsic
def add_product_of_rows(typing: Any, N: Any, o: Any, C: Any, Z: Any) -> Any:
    """Add ``N^T C N`` to the 12 x 12 matrix Z, with the three rows at ``N[o]``.

    C holds seven numbers: the first of a row, and two rows; what follows the first number of the first row is zero.
    """
    del typing, o
    if not _are_arrays(N, C, Z):
        return None

    def write(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        del signature
        zero = ir.Constant(ir.IntType(64), 0)
        rows = _Rows(context, builder, N, arguments[0], arguments[1])
        numbers = _Rows(context, builder, C, arguments[2], zero)
        sums = _Rows(context, builder, Z, arguments[3], zero)
        c = [numbers.everywhere(i) for i in range(7)]
        right = []
        for j in range(0, COLUMNS, LANES):
            n = [rows.vector(COLUMNS * k + j) for k in range(3)]
            right.append(
                [
                    _combine(builder, c[:1], n[:1]),
                    _combine(builder, c[1:4], n),
                    _combine(builder, c[4:7], n),
                ]
            )
        for i in range(COLUMNS):
            factors = [rows.everywhere(COLUMNS * k + i) for k in range(3)]
            for j in range(0, COLUMNS, LANES):
                at = COLUMNS * i + j
                sums.store(at, _combine(builder, factors, right[j // LANES], sums.vector(at)))
        return context.get_dummy_value()

    return types.void(N, types.int64, C, Z), write
