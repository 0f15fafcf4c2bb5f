"""A writer of vector instructions: loads, stores, products and sums on a given number of lanes.

LLVM does not find vector instructions in short loops (it cannot prove that arrays differ, and a loop over five
or twelve numbers is written out number by number). Functions that need them say them: `vector_code` makes an
intrinsic of a function that gets a `VectorCode`, addresses and numbers, and writes one formula with them. Vectors
lie in memory as they are, aligned or not; a machine whose registers are shorter splits them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from llvmlite import ir

from heavylift.numerics.jit import ROUNDING_FLAGS

__all__ = ["INTEGER", "VectorCode", "vector_code"]

FLAGS = tuple(sorted(ROUNDING_FLAGS))

DOUBLE = ir.DoubleType()
INTEGER = ir.IntType(64)
INDEX = ir.IntType(32)


class VectorCode:
    """Writes instructions on vectors of doubles. Offsets are numbers or integers of the code, and count doubles.

    Attributes
    ----------
    context, builder
        Of the function that is written.
    lanes
        Of a vector, by default.
    used
        Lanes that hold something; the others are padding.
    vector
        Type of such a vector.
    """

    def __init__(self, context: Any, builder: ir.IRBuilder, lanes: int, used: int | None = None) -> None:
        self.context, self.builder = context, builder
        self.lanes, self.used = lanes, lanes if used is None else used
        self.vector = ir.VectorType(DOUBLE, lanes)

    # ------------------------------------------------------------------------------------------ memory

    def pointer(self, array_type: Any, array: Any, offset: Any = 0) -> Any:
        """Address of the number at an offset of a contiguous array, or of an array of records."""
        from numba.core import cgutils

        return self.at(
            cgutils.create_struct_proxy(array_type)(self.context, self.builder, array).data, offset
        )

    def at(self, pointer: Any, offset: Any, element: Any = DOUBLE) -> Any:
        """Address at an offset from another."""
        place = ir.Constant(INTEGER, offset) if isinstance(offset, int) else offset
        return self.builder.gep(pointer, [place], source_etype=element)

    def line(self, pointer: Any, first: int, index: Any, size: int) -> Any:
        """Address of the numbers of a line, of `size` each, the first of which begins at `first`."""
        return self.at(self.at(pointer, first), self.builder.mul(index, ir.Constant(INTEGER, size)))

    def load(self, pointer: Any, offset: Any, lanes: int | None = None) -> Any:
        """Vector from memory."""
        kind = self.vector if lanes is None else ir.VectorType(DOUBLE, lanes)
        place = self.builder.bitcast(self.at(pointer, offset), kind.as_pointer())
        return self.builder.load(place, align=8, typ=kind)

    def row(self, pointer: Any, number: int) -> Any:
        """One of the vectors that lie one after another in memory."""
        return self.load(pointer, number * self.lanes)

    def put_row(self, value: Any, pointer: Any, number: int) -> None:
        """One of the vectors that lie one after another to memory."""
        self.store(value, pointer, number * self.lanes)

    def number(self, pointer: Any, offset: Any, element: Any = DOUBLE) -> Any:
        """One number from memory."""
        return self.builder.load(self.at(pointer, offset, element), typ=element)

    def store(self, value: Any, pointer: Any, offset: Any) -> None:
        """Vector or number to memory."""
        place = self.builder.bitcast(self.at(pointer, offset), value.type.as_pointer())
        self.builder.store(value, place, align=8)

    def memory(self, vectors: int) -> Any:
        """Address of room for vectors on the stack."""
        from numba.core import cgutils

        place = cgutils.alloca_once(self.builder, self.vector, size=vectors)
        return self.builder.bitcast(place, DOUBLE.as_pointer())

    def variable(self, value: Any) -> Any:
        """Address of a value on the stack, which is there whenever this place is reached."""
        from numba.core import cgutils

        return cgutils.alloca_once_value(self.builder, value)

    def repeat(self, count: Any) -> Any:
        """Context of a loop over ``0 ... count - 1``; gives its `index`."""
        from numba.core import cgutils

        return cgutils.for_range(self.builder, count)

    # ------------------------------------------------------------------------------------------- lanes

    def constant(self, value: float, lanes: int | None = None) -> Any:
        """A number known now, in all lanes."""
        lanes = self.lanes if lanes is None else lanes
        return ir.Constant(ir.VectorType(DOUBLE, lanes), [value] * lanes)

    def spread(self, number: Any, lanes: int | None = None) -> Any:
        """The same number in all lanes."""
        lanes = self.lanes if lanes is None else lanes
        undefined = ir.Constant(ir.VectorType(DOUBLE, lanes), ir.Undefined)
        one = self.builder.insert_element(undefined, number, ir.Constant(INDEX, 0))
        return self.choose(one, undefined, [0] * lanes)

    def lane(self, vector: Any, index: int) -> Any:
        """One number of a vector."""
        return self.builder.extract_element(vector, ir.Constant(INDEX, index))

    def choose(self, a: Any, b: Any, mask: Sequence[int]) -> Any:
        """Lanes of two vectors: numbers from their length on mean the second."""
        return self.builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(INDEX, len(mask)), list(mask)))

    # ------------------------------------------------------------------------------------- arithmetic

    def multiply(self, a: Any, b: Any) -> Any:
        """Product of vectors or numbers."""
        return self.builder.fmul(a, b, flags=FLAGS)

    def add(self, a: Any, b: Any) -> Any:
        """Sum."""
        return self.builder.fadd(a, b, flags=FLAGS)

    def subtract(self, a: Any, b: Any) -> Any:
        """Difference."""
        return self.builder.fsub(a, b, flags=FLAGS)

    def reciprocal(self, number: Any) -> Any:
        """One over a number."""
        return self.builder.fdiv(ir.Constant(DOUBLE, 1.0), number, flags=FLAGS)

    def multiply_add(self, total: Any, a: Any, b: Any) -> Any:
        """``total + a b``, rounded once where the machine can."""
        return self.add(total, self.multiply(a, b))

    def multiply_subtract(self, total: Any, a: Any, b: Any) -> Any:
        """``total - a b``, rounded once where the machine can."""
        return self.subtract(total, self.multiply(a, b))

    def sum(self, *products: tuple[Any, Any], start: Any = None) -> Any:
        """Sum of products, from the first to the last, and of what it starts with."""
        total = start
        for a, b in products:
            total = self.multiply(a, b) if total is None else self.multiply_add(total, a, b)
        return total

    def subtract_sum(self, start: Any, *products: tuple[Any, Any]) -> Any:
        """What is left of a value after products, from the first to the last."""
        for a, b in products:
            start = self.multiply_subtract(start, a, b)
        return start

    # ------------------------------------------------------------------------------- sums over lanes

    def dot(self, a: Any, b: Any) -> Any:
        """Inner product over the lanes that are in use, neighbours first."""
        product = self.multiply(a, b)
        terms = [self.lane(product, i) for i in range(self.used)]
        while len(terms) > 1:
            pairs = zip(terms[::2], terms[1::2], strict=False)
            terms = [self.add(x, y) for x, y in pairs] + terms[len(terms) // 2 * 2 :]
        return terms[0]

    def total(self, vector: Any) -> Any:
        """Sum of all lanes, by halves."""
        length = vector.type.count
        while length > 1:
            length //= 2
            nothing = ir.Constant(vector.type, ir.Undefined)
            vector = self.add(*(self.choose(vector, nothing, range(i, i + length)) for i in (0, length)))
        return self.lane(vector, 0)

    def totals_of_eight(self, vectors: Sequence[Any]) -> Any:
        """Vector of the sums over the lanes of each of eight vectors of eight lanes, in order."""
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

    @contextmanager
    def loop(self, count: Any, sums: dict[Any, Any]) -> Iterator[tuple[Any, dict[Any, Any]]]:
        """Body of a loop over ``0 ... count - 1`` that changes `sums`, which live in registers."""
        from numba.core import cgutils

        slots = {key: cgutils.alloca_once(self.builder, value.type) for key, value in sums.items()}
        for key, value in sums.items():
            self.builder.store(value, slots[key])
        with self.repeat(count) as inner:
            present = {key: self.builder.load(slot, typ=sums[key].type) for key, slot in slots.items()}
            yield inner.index, present
            for key, value in present.items():
                self.builder.store(value, slots[key])
        for key, slot in slots.items():
            sums[key] = self.builder.load(slot, typ=sums[key].type)


def vector_code(
    arguments: Sequence[Any],
    places: Sequence[int | None],
    write: Callable[..., Any],
    *,
    lanes: int,
    used: int | None = None,
    returns: int = 0,
) -> tuple[Any, Callable[..., Any]]:
    """Signature and generator of an intrinsic.

    Parameters
    ----------
    arguments
        Types of all arguments: arrays with their offsets behind them, numbers, tuples of numbers.
    places
        Of each array how many offsets follow it, None for anything else; the last need not be given.
    write
        Writes the instructions. Gets a `VectorCode`; for each array one address (at its start without an offset) or a
        list of as many as it has offsets; for each number a double or an integer; for a tuple a list. Returns
        the numbers of a tuple if the intrinsic does.
    lanes, used
        Of the `VectorCode`.
    returns
        How many numbers it returns, as a tuple.
    """
    from numba.core import types
    from numba.core.types.containers import BaseTuple, UniTuple

    result = UniTuple(types.float64, returns) if returns else types.void
    signature = result(*arguments)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        code = VectorCode(context, builder, lanes, used)

        def plain(kind: Any, value: Any) -> Any:
            if isinstance(kind, BaseTuple):
                return [plain(of, builder.extract_value(value, i)) for i, of in enumerate(kind)]
            return context.cast(
                builder, value, kind, types.int64 if isinstance(kind, types.Integer) else types.float64
            )

        given: list[Any] = []
        at = 0
        for offsets in [*places, *([None] * len(values))]:
            if at == len(values):
                break
            kind, value = signature.args[at], values[at]
            at += 1
            if offsets is None:
                given.append(plain(kind, value))
                continue
            if isinstance(kind, types.Array) and kind.layout != "C":
                raise TypeError(f"vector code on an array that is not contiguous: {kind}")
            addresses = [code.pointer(kind, value, values[at + i]) for i in range(offsets)]
            given.append(addresses if offsets > 1 else addresses[0] if offsets else code.pointer(kind, value))
            at += offsets
        results = write(code, *given)
        if not returns:
            return context.get_dummy_value()
        return context.make_tuple(builder, signature.return_type, results)

    return signature, generate
