"""Vector instructions on eight lanes, which shell elements are written in; as in `heavylift.numerics.lanes`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types

from heavylift.solver.bodies.ancf.shell_data import LANES

__all__ = ["Lanes", "element_code"]

FLAGS = ("contract", "nsz", "arcp")
"""The rounding flags of `heavylift.numerics.jit.kernel`."""


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
        """Address of the double at an offset from another."""
        if isinstance(index, int):
            index = ir.Constant(ir.IntType(64), index)
        return self.builder.gep(pointer, [index], source_etype=ir.DoubleType())

    def line(self, pointer: Any, first: int, index: Any, size: int) -> Any:
        """Address of the numbers of a line."""
        return self.at(self.at(pointer, first), self.builder.mul(index, ir.Constant(ir.IntType(64), size)))

    def load(self, pointer: Any, index: int, lanes: int = LANES) -> Any:
        """Vector from memory, aligned or not."""
        kind = ir.VectorType(ir.DoubleType(), lanes)
        place = self.builder.bitcast(self.at(pointer, index), kind.as_pointer())
        return self.builder.load(place, align=8, typ=kind)

    def store(self, value: Any, pointer: Any, index: int) -> None:
        """Vector to memory, aligned or not."""
        place = self.builder.bitcast(self.at(pointer, index), value.type.as_pointer())
        self.builder.store(value, place, align=8)

    def number(self, pointer: Any, index: int) -> Any:
        """Double from memory."""
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
        """Zeros."""
        return ir.Constant(self.vector, [0.0] * LANES)

    def half(self) -> Any:
        """One half in all lanes."""
        return ir.Constant(self.vector, [0.5] * LANES)

    def multiply(self, a: Any, b: Any) -> Any:
        """Product, lane by lane."""
        return self.builder.fmul(a, b, flags=FLAGS)

    def add(self, a: Any, b: Any) -> Any:
        """Sum, lane by lane."""
        return self.builder.fadd(a, b, flags=FLAGS)

    def subtract(self, a: Any, b: Any) -> Any:
        """Difference, lane by lane."""
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
