"""Sums over rows of twelve numbers, four at a time, by the vector instructions of `heavylift.numerics.vector_code`."""

from __future__ import annotations

from typing import Any

from heavylift.numerics.jit import intrinsic
from heavylift.numerics.vector_code import VectorCode, vector_code

__all__ = ["COLUMNS", "add_product_of_rows", "add_rows", "multiply_rows"]

COLUMNS = 12
"""Numbers of a row."""

LANES = 4
"""Numbers of a vector: 256 bits, which all processors of the last decade have; others split it."""

STARTS = range(0, COLUMNS, LANES)
"""Where the vectors of a row begin."""


@intrinsic
def multiply_rows(typingctx, N, o, y):  # type: ignore[no-untyped-def]
    """Products of the three rows at ``N[o]`` with the row y: three numbers."""

    def write(code: VectorCode, N: Any, y: Any) -> list[Any]:
        factors = [code.load(y, j) for j in STARTS]
        rows = [[code.load(N, COLUMNS * k + j) for j in STARTS] for k in range(3)]
        return [code.total(code.sum(*zip(row, factors, strict=True))) for row in rows]

    return vector_code((N, o, y), (1, 0), write, lanes=LANES, returns=3)


@intrinsic
def add_rows(typingctx, N, o, p0, p1, p2, z):  # type: ignore[no-untyped-def]
    """Add ``p0``, ``p1`` and ``p2`` times the three rows at ``N[o]`` to the row z."""

    def write(code: VectorCode, N: Any, p0: Any, p1: Any, p2: Any, z: Any) -> None:
        factors = [code.spread(number) for number in (p0, p1, p2)]
        for j in STARTS:
            rows = [code.load(N, COLUMNS * k + j) for k in range(3)]
            added = code.sum(*zip(factors, rows, strict=True))
            code.store(code.add(code.load(z, j), added), z, j)

    return vector_code((N, o, p0, p1, p2, z), (1, None, None, None, 0), write, lanes=LANES)


@intrinsic
def add_product_of_rows(typingctx, N, o, C, Z):  # type: ignore[no-untyped-def]
    """Add ``N^T C N`` to the 12 x 12 matrix Z, with the three rows at ``N[o]``.

    C holds seven numbers: the first of a row, and two rows; what follows the first number of the first row is zero.
    """

    def write(code: VectorCode, N: Any, C: Any, Z: Any) -> None:
        c = [code.spread(code.number(C, i)) for i in range(7)]
        right = []
        for j in STARTS:
            n = [code.load(N, COLUMNS * k + j) for k in range(3)]
            parts = (c[:1], n[:1]), (c[1:4], n), (c[4:7], n)
            right.append([code.sum(*zip(*part, strict=True)) for part in parts])
        for i in range(COLUMNS):
            factors = [code.spread(code.number(N, COLUMNS * k + i)) for k in range(3)]
            for j, columns in zip(STARTS, right, strict=True):
                at = COLUMNS * i + j
                total = code.sum(*zip(factors, columns, strict=True), start=code.load(Z, at))
                code.store(total, Z, at)

    return vector_code((N, o, C, Z), (1, 0, 0), write, lanes=LANES)
