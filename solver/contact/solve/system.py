"""Linear algebra of many contacts on few bodies: rates from impulses, and the step of Newton's method.

With the linearised contacts ``dp = r - D dw`` and ``dw = N B N^T dp`` the unknowns ``dz = N^T dp`` are as many as
the touched velocities, whatever the number of contacts::

    (I + K B) dz = N^T r,        K = N^T D N

or the same with the masses taken into N, so that B is the identity. K is kept from one iteration to the next and
changed by those contacts only whose D has changed. Without blocks
(``ends`` of length 0) N is the identity, and the unknowns are the impulses of those rows that react to rates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.laws.rows import RECORD, linearised_contact
from heavylift.solver.contact.layout import ProblemSize
from heavylift.solver.contact.solve.end_blocks import CONTACT, same_ends
from heavylift.solver.contact.solve.twelve_rows import COLUMNS, add_product_of_rows

__all__ = [
    "COUPLING",
    "END",
    "SCRATCH",
    "add_unit",
    "add_unit_to_product",
    "assemble_rows",
    "factor",
    "fill_gaps",
    "gather",
    "multiply",
    "multiply_blocks",
    "solve_factored",
    "spread",
    "update",
]

END = 18
"""Numbers of the block of one end: 3 x 6, row by row."""

COUPLING = 7
"""Numbers of D of a contact; the two that are not stored are zero."""

SCRATCH = COUPLING + COLUMNS * COLUMNS
"""Numbers behind the held D of all contacts; zeros at the beginning."""


@kernel(internal=True)
def gather(
    count: int,
    ends: NDArray[np.int64],
    blocks: NDArray[np.float64],
    size: int,
    p: NDArray[np.float64],
    stride: int,
    z: NDArray[np.float64],
) -> None:
    """``z = N^T p`` with the three impulses of contact c at ``p[stride c]``."""
    if ends.shape[0] == 0:
        for c in range(count):
            z[3 * c], z[3 * c + 1], z[3 * c + 2] = p[stride * c], p[stride * c + 1], p[stride * c + 2]
        return
    for i in range(size):
        z[i] = 0.0
    for c in range(count):
        p0, p1, p2 = p[stride * c], p[stride * c + 1], p[stride * c + 2]
        if p0 == 0.0 and p1 == 0.0 and p2 == 0.0:
            continue
        for end in range(2):
            first, at, width = ends[c, 2 * end], END * end, ends[c, 2 * end + 1]
            if width == 6:  # unrolled
                for j in range(6):
                    z[first + j] += (
                        blocks[c, at + j] * p0 + blocks[c, at + 6 + j] * p1 + blocks[c, at + 12 + j] * p2
                    )
                continue
            for j in range(width):
                z[first + j] += (
                    blocks[c, at + j] * p0 + blocks[c, at + 6 + j] * p1 + blocks[c, at + 12 + j] * p2
                )


@kernel(internal=True, reassociate=True)
def spread(
    count: int,
    ends: NDArray[np.int64],
    blocks: NDArray[np.float64],
    size: int,
    y: NDArray[np.float64],
    w: NDArray[np.float64],
) -> None:
    """``w = N y``."""
    if ends.shape[0] == 0:
        for i in range(size):
            w[i] = y[i]
        return
    for c in range(count):
        w0, w1, w2 = 0.0, 0.0, 0.0
        for end in range(2):
            first, at, width = ends[c, 2 * end], END * end, ends[c, 2 * end + 1]
            if width == 6:  # unrolled
                for j in range(6):
                    v = y[first + j]
                    w0 += blocks[c, at + j] * v
                    w1 += blocks[c, at + 6 + j] * v
                    w2 += blocks[c, at + 12 + j] * v
            else:
                for j in range(width):
                    v = y[first + j]
                    w0 += blocks[c, at + j] * v
                    w1 += blocks[c, at + 6 + j] * v
                    w2 += blocks[c, at + 12 + j] * v
        w[3 * c], w[3 * c + 1], w[3 * c + 2] = w0, w1, w2


@kernel(internal=True, reassociate=True)
def multiply(size: int, B: NDArray[np.float64], x: NDArray[np.float64], out: NDArray[np.float64]) -> None:
    """``out = B x``."""
    for i in range(size):
        total = 0.0
        for j in range(size):
            total += B[i, j] * x[j]
        out[i] = total


@kernel(internal=True)
def multiply_blocks(
    size: int,
    B: NDArray[np.float64],
    head: NDArray[np.int64],
    past: NDArray[np.int64],
    x: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """``out = B x``, where a row of B has entries from `head` on up to `past`; of length 0: everywhere."""
    if head.shape[0] == 0:
        multiply(size, B, x, out)
        return
    for i in range(size):
        total = 0.0
        for j in range(head[i], past[i]):
            total += B[i, j] * x[j]
        out[i] = total


@kernel(internal=True)
def fill_gaps(size: int, B: NDArray[np.float64], head: NDArray[np.int64], past: NDArray[np.int64]) -> None:
    """Write the zeros outside `head` and `past` into B, for those who read all of it."""
    for i in range(min(size, head.shape[0])):
        for j in range(head[i]):
            B[i, j] = 0.0
        for j in range(past[i], size):
            B[i, j] = 0.0


@kernel(internal=True)
def _flush(
    ends: NDArray[np.int64],
    place: NDArray[np.float64],
    size: int,
    c: int,
    pair: NDArray[np.float64],
    K: NDArray[np.float64],
) -> None:
    """Move the block of a pair of ends, that of contact c, into K."""
    for end in range(2):
        for i in range(ends[c, 2 * end + 1]):
            row = (int(place[ends[c, 2 * end]]) + i) * size
            for other in range(2):
                width = ends[c, 2 * other + 1]
                if width > 0:
                    first = row + int(place[ends[c, 2 * other]])
                    at = COLUMNS * (6 * end + i) + 6 * other
                    for j in range(width):
                        K[first + j] += pair[at + j]
    for i in range(COLUMNS * COLUMNS):
        pair[i] = 0.0


@kernel(internal=True)
def update(
    counts: ProblemSize,
    ends: NDArray[np.int64],
    place: NDArray[np.float64],
    N: NDArray[np.float64],
    records: NDArray[np.float64],
    held: NDArray[np.float64],
    K: NDArray[np.float64],
) -> bool:
    """Bring K to the linearised contacts; returns whether anything has changed.

    Parameters
    ----------
    counts, ends
        The problem.
    place, N
        Where velocities stand, and the rows of contacts in twelve columns.
    records
        Linearised contacts.
    held
        D of the contacts that is in K, kept from call to call (zeros with K = 0 at the beginning), and behind it
        a scratch block.
    K
        Square matrix, row by row.
    """
    count, size = counts.number, counts.size
    change = held[COUPLING * count : COUPLING * count + COUPLING]
    pair = held[COUPLING * (count + 1) : COUPLING * (count + 1) + COLUMNS * COLUMNS]
    last = -1  # contact whose ends the pair has
    for c in range(counts.first, counts.last):
        new, o = linearised_contact(records, RECORD * c), COUPLING * c
        d0 = new.d00 - held[o]
        d1, d2, d3 = new.d10 - held[o + 1], new.d11 - held[o + 2], new.d12 - held[o + 3]
        d4, d5, d6 = new.d20 - held[o + 4], new.d21 - held[o + 5], new.d22 - held[o + 6]
        if d0 == 0.0 and d1 == 0.0 and d2 == 0.0 and d3 == 0.0 and d4 == 0.0 and d5 == 0.0 and d6 == 0.0:
            continue
        change[0], change[1], change[2], change[3] = d0, d1, d2, d3
        change[4], change[5], change[6] = d4, d5, d6
        held[o], held[o + 1], held[o + 2], held[o + 3] = new.d00, new.d10, new.d11, new.d12
        held[o + 4], held[o + 5], held[o + 6] = new.d20, new.d21, new.d22
        if last >= 0 and not same_ends(ends, c, last):
            _flush(ends, place, size, last, pair, K)
        last = c
        add_product_of_rows(N, CONTACT * c, change, pair)
    if last >= 0:
        _flush(ends, place, size, last, pair, K)
    return last >= 0


@kernel(internal=True)
def add_unit(
    size: int,
    low: int,
    high: int,
    K: NDArray[np.float64],
    reach: NDArray[np.float64],
    A: NDArray[np.float64],
) -> None:
    """Write the rows from `low` to `high` of ``A = I + K`` as far as entries reach from the diagonal."""
    for i in range(low, high):
        for j in range(i, int(reach[i]) + 1):
            A[i * size + j] = K[i * size + j]
            A[j * size + i] = K[j * size + i]
        A[i * size + i] += 1.0


@kernel(internal=True)
def add_unit_to_product(
    size: int, K: NDArray[np.float64], B: NDArray[np.float64], A: NDArray[np.float64]
) -> None:
    """Write ``A = I + K B``."""
    for i in range(size):
        f = i * size
        for j in range(size):
            A[f + j] = 0.0
        A[f + i] = 1.0
        for k in range(size):
            x = K[f + k]
            if x != 0.0:
                for j in range(size):
                    A[f + j] += x * B[k, j]


@kernel(internal=True)
def assemble_rows(
    count: int,
    size: int,
    W: NDArray[np.float64],
    records: NDArray[np.float64],
    A: NDArray[np.float64],
    active: NDArray[np.float64],
    x: NDArray[np.float64],
) -> int:
    """Write ``(I + D W) dp = r`` for the rows that react to rates; returns how many they are.

    Parameters
    ----------
    count, size, W
        The problem; N is the identity.
    records
        Linearised contacts.
    A, active, x
        Out: matrix row by row, which rows they are, right-hand side.
    """
    n = 0
    for c in range(count):
        record = linearised_contact(records, RECORD * c)
        if record.d00 != 0.0:
            active[n] = 3 * c
            n += 1
        if record.d10 != 0.0 or record.d11 != 0.0 or record.d12 != 0.0:
            active[n] = 3 * c + 1
            n += 1
        if record.d20 != 0.0 or record.d21 != 0.0 or record.d22 != 0.0:
            active[n] = 3 * c + 2
            n += 1
    for i in range(n):
        row = int(active[i])
        c = row // 3
        first, kind = 3 * c, row - 3 * c
        record = linearised_contact(records, RECORD * c)
        a0, a1, a2 = record.d00, 0.0, 0.0
        if kind == 1:
            a0, a1, a2 = record.d10, record.d11, record.d12
        elif kind == 2:
            a0, a1, a2 = record.d20, record.d21, record.d22
        x[i] = record.r[kind]
        place = 0
        for other in range(count):  # what the others do is known
            known = linearised_contact(records, RECORD * other)
            for k in range(3):
                column = 3 * other + k
                value = a0 * W[first, column] + a1 * W[first + 1, column] + a2 * W[first + 2, column]
                if place < n and int(active[place]) == column:
                    A[i * n + place] = value
                    place += 1
                else:
                    x[i] -= value * known.r[k]
        A[i * n + i] += 1.0
    return n


@kernel(internal=True)
def factor(size: int, A: NDArray[np.float64], pivots: NDArray[np.float64]) -> bool:
    """Factor a square matrix in place, ``P A = L U``; returns False if it is singular or not finite."""
    for k in range(size):
        best, row = abs(A[k * size + k]), k
        for i in range(k + 1, size):
            if abs(A[i * size + k]) > best:
                best, row = abs(A[i * size + k]), i
        if not (best > 0.0 and best < np.inf):
            return False
        pivots[k] = row
        if row != k:
            for j in range(size):
                A[k * size + j], A[row * size + j] = A[row * size + j], A[k * size + j]
        inverse = 1.0 / A[k * size + k]
        for i in range(k + 1, size):
            f = A[i * size + k]
            if f != 0.0:
                f *= inverse
                A[i * size + k] = f
                for j in range(k + 1, size):
                    A[i * size + j] -= f * A[k * size + j]
    return True


@kernel(internal=True, reassociate=True)
def solve_factored(
    size: int, A: NDArray[np.float64], pivots: NDArray[np.float64], x: NDArray[np.float64]
) -> None:
    """Solve with the factors, in place."""
    for k in range(size):
        row = int(pivots[k])
        x[k], x[row] = x[row], x[k]
    for i in range(1, size):
        total = x[i]
        for j in range(i):
            total -= A[i * size + j] * x[j]
        x[i] = total
    for i in range(size - 1, -1, -1):
        total = x[i]
        for j in range(i + 1, size):
            total -= A[i * size + j] * x[j]
        x[i] = total / A[i * size + i]
