"""Bodies in the order of their contacts, and factors of matrices whose entries lie near the diagonal.

The bodies of a stack touch their neighbours only. Numbered along the contacts (E. Cuthill and J. McKee, Proc. 24th
ACM National Conf. (1969)) the matrix of all of them has its entries near the diagonal, and factors without exchange of
rows stay there: the cost grows with the number of bodies, not with its cube.

Not the block factor of joints (`heavylift.numerics.block_factor`): friction makes the matrix unsymmetric, and contacts
come and go, so the order of five bodies is found in each step, here in 0.2 us, with its tables in 340.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.solve.end_blocks import same_ends

__all__ = ["factor_near_diagonal", "find_reach", "order_bodies", "solve_near_diagonal"]

SMALLEST_PIVOT = 1e-2
"""Of a matrix that is the identity and what contacts add to it: without friction no pivot is below 1."""


@kernel(internal=True)
def order_bodies(
    count: int, ends: NDArray[np.int64], size: int, place: NDArray[np.float64], scratch: NDArray[np.float64]
) -> None:
    """Number the velocities along the contacts.

    Parameters
    ----------
    count, ends, size
        The problem. Ends that share some of their velocities, but not all, keep the order that is there.
    place
        Out: where each velocity stands.
    scratch
        (2 size,): width of the end that begins at a velocity, and the queue.
    """
    for i in range(2 * size):
        scratch[i] = 0.0
    for i in range(size):
        place[i] = i
    gap = 0  # largest distance of ends of a contact
    for c in range(count):
        if c > 0 and same_ends(ends, c, c - 1):
            continue
        for end in range(2):
            first, width = ends[c, 2 * end], ends[c, 2 * end + 1]
            if width > 0:
                if scratch[first] != 0.0 and scratch[first] != width:
                    return
                scratch[first] = width
        if ends[c, 1] > 0 and ends[c, 3] > 0:
            gap = max(gap, abs(ends[c, 0] - ends[c, 2]))
    if gap <= 6:
        return  # neighbours already
    end_before = 0
    for i in range(size):
        if scratch[i] > 0.0:
            if i < end_before:
                return
            end_before = i + int(scratch[i])
    for i in range(size):
        place[i] = -1.0
    filled, tail, head = 0, 0, 0
    for root in range(size):
        if scratch[root] == 0.0 or place[root] >= 0.0:
            continue
        # the body found last from any of them lies at an end of the group: begin there
        begin = root
        for attempt in range(2):
            head = tail = filled
            scratch[size + tail] = begin
            place[begin] = 0.0
            tail += 1
            while head < tail:
                body = int(scratch[size + head])
                head += 1
                for c in range(count):
                    if ends[c, 1] == 0 or ends[c, 3] == 0 or (c > 0 and same_ends(ends, c, c - 1)):
                        continue
                    other = -1
                    if ends[c, 0] == body:
                        other = ends[c, 2]
                    elif ends[c, 2] == body:
                        other = ends[c, 0]
                    if other >= 0 and place[other] < 0.0:
                        place[other] = 0.0
                        scratch[size + tail] = other
                        tail += 1
            if attempt == 0:
                begin = int(scratch[size + tail - 1])
                for i in range(filled, tail):
                    place[int(scratch[size + i])] = -1.0
        filled = tail
    at = 0
    for i in range(filled):
        body = int(scratch[size + i])
        width = int(scratch[body])
        for j in range(width):
            place[body + j] = at + j
        at += width
    for i in range(size):  # touched by nothing
        if place[i] < 0.0:
            place[i] = at
            at += 1


@kernel(internal=True)
def find_reach(
    count: int, ends: NDArray[np.int64], size: int, place: NDArray[np.float64], reach: NDArray[np.float64]
) -> None:
    """Write for each row the last one that its elimination changes."""
    for i in range(size):
        reach[i] = i
    for c in range(count):
        if c > 0 and same_ends(ends, c, c - 1):
            continue
        low, high = size, -1
        for end in range(2):
            width = ends[c, 2 * end + 1]
            if width > 0:
                first = int(place[ends[c, 2 * end]])
                low, high = min(low, first), max(high, first + width - 1)
        if high >= 0:
            reach[low] = max(reach[low], high)
    for i in range(1, size):
        reach[i] = max(reach[i], reach[i - 1])


@kernel(internal=True)
def factor_near_diagonal(
    size: int, low: int, high: int, A: NDArray[np.float64], reach: NDArray[np.float64]
) -> bool:
    """Factor ``A = L U`` in place, reciprocals of pivots on the diagonal; False if a pivot is small.

    Parameters
    ----------
    size, A
        Square matrix, row by row.
    low, high
        The part of it, from one row on up to another one, that is coupled to no other.
    reach
        See `find_reach`.
    """
    for k in range(low, high):
        pivot = A[k * size + k]
        if not (abs(pivot) >= SMALLEST_PIVOT and abs(pivot) < np.inf):
            return False
        inverse = 1.0 / pivot
        A[k * size + k] = inverse
        last = int(reach[k]) + 1
        for i in range(k + 1, last):
            f = A[i * size + k]
            if f != 0.0:
                f *= inverse
                A[i * size + k] = f
                for j in range(k + 1, last):
                    A[i * size + j] -= f * A[k * size + j]
    return True


@kernel(internal=True, reassociate=True)
def solve_near_diagonal(
    size: int,
    low: int,
    high: int,
    A: NDArray[np.float64],
    reach: NDArray[np.float64],
    x: NDArray[np.float64],
) -> None:
    """Solve with these factors, in place."""
    for k in range(low, high):
        value = x[k]
        for i in range(k + 1, int(reach[k]) + 1):
            x[i] -= A[i * size + k] * value
    for i in range(high - 1, low - 1, -1):
        total = x[i]
        for j in range(i + 1, int(reach[i]) + 1):
            total -= A[i * size + j] * x[j]
        x[i] = total * A[i * size + i]
