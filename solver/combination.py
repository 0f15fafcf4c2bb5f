"""Weighted sums of vectors that lie one after the other in a flat array, in vector registers.

A stage of a Runge-Kutta method is the sum of a state and up to ten rates. Written as loops it is a pass
through memory for each term, because the compiler cannot prove that the vectors differ; here the partial
sums of a part of the vector stay in registers until all terms are added.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import intrinsic, kernel
from heavylift.numerics.vector_code import VectorCode, vector_code

__all__ = ["PART", "combine", "combine_part", "copy_parts", "padded"]

PART = 8
"""Numbers that are combined together; vectors are padded to a multiple of it."""


def padded(count: int) -> int:
    """Length of a vector that holds `count` numbers."""
    return -(-count // PART) * PART


@intrinsic
def combine_part(typingctx, out, out_at, source, at, size, rows, weights):  # type: ignore[no-untyped-def]
    """``out[out_at + i] = sum_k weights[k] source[rows[k] size + at + i]`` for i = 0 ... `PART` - 1."""

    def write(code: VectorCode, to: Any, source: Any, size: Any, rows: list[Any], weights: list[Any]) -> None:
        lines = [code.at(source, code.builder.mul(row, size)) for row in rows]
        terms = [
            (code.load(line, 0), code.spread(weight)) for line, weight in zip(lines, weights, strict=True)
        ]
        code.store(code.sum(*terms), to, 0)

    return vector_code((out, out_at, source, at, size, rows, weights), (1, 1), write, lanes=PART)


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
