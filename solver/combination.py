"""Weighted sums of vectors that lie one after the other in a flat array, in vector registers.

A stage of a Runge-Kutta method is the sum of a state and up to ten rates. Written as loops it is a pass
through memory for each term, because the compiler cannot prove that the vectors differ; here the partial
sums of a part of the vector stay in registers until all terms are added.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = ["PART", "combine", "combine_part", "copy_parts", "padded"]

PART = 8
"""Numbers that are combined together; vectors are padded to a multiple of it."""

FLAGS = ("contract", "nsz", "arcp")
"""The rounding flags of `heavylift.numerics.jit.kernel`."""


def padded(count: int) -> int:
    """Length of a vector that holds `count` numbers."""
    return -(-count // PART) * PART


@intrinsic
def combine_part(typingctx, out, out_at, source, at, size, rows, weights):  # type: ignore[no-untyped-def]
    """``out[out_at + i] = sum_k weights[k] source[rows[k] size + at + i]`` for i = 0 ... `PART` - 1."""
    signature = types.void(out, out_at, source, at, size, rows, weights)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        vector = ir.VectorType(ir.DoubleType(), PART)
        mask = ir.Constant(ir.VectorType(ir.IntType(32), PART), [0] * PART)

        def pointer(which: int, offset: Any) -> Any:
            array = context.make_array(signature.args[which])(context, builder, values[which])
            place = builder.gep(array.data, [offset], source_etype=ir.DoubleType())
            return builder.bitcast(place, vector.as_pointer())

        total = None
        for k in range(len(signature.args[6])):
            row = context.cast(
                builder, builder.extract_value(values[5], k), signature.args[5][k], types.int64
            )
            place = builder.add(builder.mul(row, values[4]), values[3])
            term = builder.load(pointer(2, place), align=8, typ=vector)
            one = builder.insert_element(
                ir.Constant(vector, ir.Undefined),
                builder.extract_value(values[6], k),
                ir.Constant(ir.IntType(32), 0),
            )
            weight = builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), mask)
            term = builder.fmul(term, weight, flags=FLAGS)
            total = term if total is None else builder.fadd(total, term, flags=FLAGS)
        builder.store(total, pointer(0, values[1]), align=8)
        return context.get_dummy_value()

    return signature, generate


@kernel(inline=True, internal=True)
def combine(
    values: NDArray[np.float64], size: int, to: int, rows: tuple[int, ...], weights: tuple[float, ...]
) -> None:
    """Row `to` becomes the sum of weighted rows, each of `size` numbers, in a flat array."""
    for i in range(0, size, PART):
        combine_part(values, to * size + i, values, i, size, rows, weights)


@kernel(inline=True, internal=True)
def copy_parts(source: NDArray[np.float64], at: int, to: NDArray[np.float64], to_at: int, count: int) -> None:
    """Numbers of a flat array into another one, or elsewhere in it; their count is a multiple of `PART`."""
    for i in range(0, count, PART):
        combine_part(to, to_at + i, source, at + i, 0, (0,), (1.0,))
