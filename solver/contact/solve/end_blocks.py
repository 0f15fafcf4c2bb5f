"""Rows of contacts on the velocities of their ends, in one width and in units of energy.

The rows of a contact stand one after another in twelve columns, six for each end: sums over them need no widths. Where
the inverse mass couples velocities of the same end only, as that of free bodies, ``B = L L^T`` moves into the rows:
with ``N L`` in place of N the velocities belong to a unit mass, and what Newton's method solves becomes
``I + L^T K L``. That has no other entries than those between bodies that touch, and without friction no pivot below 1.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.solve.twelve_rows import COLUMNS

__all__ = [
    "CONTACT",
    "add_pair",
    "factor_inverse_mass",
    "load_pair",
    "same_ends",
    "solve_for_start",
    "write_rows",
]

CONTACT = 3 * COLUMNS
"""Numbers of the rows of a contact."""

SINGULAR = 1e-10
"""Pivot of B relative to its diagonal below which it is not factored."""


@kernel(inline=True, internal=True)
def same_ends(ends: NDArray[np.int64], c: int, d: int) -> bool:
    """Whether two contacts touch the same velocities."""
    return (
        ends[c, 0] == ends[d, 0]
        and ends[c, 1] == ends[d, 1]
        and ends[c, 2] == ends[d, 2]
        and ends[c, 3] == ends[d, 3]
    )


@kernel(inline=True, internal=True)
def load_pair(
    ends: NDArray[np.int64],
    place: NDArray[np.float64],
    c: int,
    y: NDArray[np.float64],
    pair: NDArray[np.float64],
) -> None:
    """Copy the velocities of the ends of a contact into twelve columns; those that are not there stay zero."""
    for end in range(2):
        width = ends[c, 2 * end + 1]
        if width > 0:
            first = int(place[ends[c, 2 * end]])
            for j in range(width):
                pair[6 * end + j] = y[first + j]
        for j in range(width, 6):
            pair[6 * end + j] = 0.0


@kernel(inline=True, internal=True)
def add_pair(
    ends: NDArray[np.int64],
    place: NDArray[np.float64],
    c: int,
    pair: NDArray[np.float64],
    z: NDArray[np.float64],
) -> None:
    """Add twelve columns to the velocities of the ends of a contact, and empty them."""
    for end in range(2):
        width = ends[c, 2 * end + 1]
        if width > 0:
            first = int(place[ends[c, 2 * end]])
            for j in range(width):
                z[first + j] += pair[6 * end + j]
    for j in range(COLUMNS):
        pair[j] = 0.0


@kernel(internal=True)
def factor_inverse_mass(
    count: int,
    ends: NDArray[np.int64],
    size: int,
    B: NDArray[np.float64],
    head: NDArray[np.int64],
    past: NDArray[np.int64],
    L: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
) -> bool:
    """Factor ``B = L L^T`` where it couples velocities of one end only.

    Parameters
    ----------
    count, ends, size, B, head, past
        The problem.
    L
        Out: lower triangle, row by row, stride `size`; only from the first entry of a row of B on.
    low, high
        Out: first and last column of each row of B that is not zero.

    Returns
    -------
    factored
        False if it couples more, or is singular.
    """
    full = head.shape[0] == 0
    for i in range(size):
        j = 0 if full else head[i]
        while j < i and B[i, j] == 0.0:
            j += 1
        low[i] = j
        j = size - 1 if full else past[i] - 1
        while j > i and B[i, j] == 0.0:
            j -= 1
        high[i] = j
    for c in range(count):
        if c > 0 and same_ends(ends, c, c - 1):
            continue
        for end in range(2):
            first, width = ends[c, 2 * end], ends[c, 2 * end + 1]
            for i in range(first, first + width):
                if low[i] < first or high[i] >= first + width:
                    return False
    for i in range(size):
        first = int(low[i])
        if i - first >= 6:  # touched by nothing: stays as it is
            low[i], L[i * size + i] = i, 1.0
            continue
        for j in range(first, i):
            total = B[i, j]
            for k in range(max(first, int(low[j])), j):
                total -= L[i * size + k] * L[j * size + k]
            L[i * size + j] = total / L[j * size + j]
        total = B[i, i]
        for k in range(first, i):
            total -= L[i * size + k] * L[i * size + k]
        if not total > SINGULAR * B[i, i]:
            return False
        L[i * size + i] = math.sqrt(total)
    return True


@kernel(internal=True)
def solve_for_start(
    size: int, L: NDArray[np.float64], low: NDArray[np.float64], y: NDArray[np.float64]
) -> None:
    """Replace velocities y by ``L^-1 y``, those of a unit mass; see `factor_inverse_mass`."""
    for i in range(size):
        total = y[i]
        for j in range(int(low[i]), i):
            total -= L[i * size + j] * y[j]
        y[i] = total / L[i * size + i]


@kernel(inline=True, internal=True)
def _load_masses(
    ends: NDArray[np.int64],
    size: int,
    c: int,
    L: NDArray[np.float64],
    low: NDArray[np.float64],
    roots: NDArray[np.float64],
) -> bool:
    """Write the blocks of L of both ends, 6 x 6 each; returns whether they are diagonal."""
    diagonal = True
    for end in range(2):
        first, width = ends[c, 2 * end], ends[c, 2 * end + 1]
        for i in range(6):
            start = int(low[first + i]) - first if i < width else 6
            diagonal = diagonal and start >= i
            for j in range(6):
                inside = start <= j <= i
                roots[36 * end + 6 * i + j] = L[(first + i) * size + first + j] if inside else 0.0
    return diagonal


@kernel(internal=True)
def write_rows(
    count: int,
    ends: NDArray[np.int64],
    blocks: NDArray[np.float64],
    size: int,
    L: NDArray[np.float64],
    low: NDArray[np.float64],
    with_masses: bool,
    N: NDArray[np.float64],
    roots: NDArray[np.float64],
) -> None:
    """Write the rows of all contacts in twelve columns.

    Parameters
    ----------
    count, ends, blocks, size
        The problem.
    L, low
        See `factor_inverse_mass`; read if masses are asked for.
    with_masses
        Write ``N L`` in place of N.
    N
        Out, CONTACT numbers per contact.
    roots
        Scratch of 72 numbers.
    """
    diagonal = False
    for c in range(count):
        if with_masses and (c == 0 or not same_ends(ends, c, c - 1)):
            diagonal = _load_masses(ends, size, c, L, low, roots)
        for end in range(2):
            width, m = ends[c, 2 * end + 1], 36 * end
            for k in range(3):
                o, at = CONTACT * c + COLUMNS * k + 6 * end, 18 * end + 6 * k
                if width == 6:
                    n0, n1, n2 = blocks[c, at], blocks[c, at + 1], blocks[c, at + 2]
                    n3, n4, n5 = blocks[c, at + 3], blocks[c, at + 4], blocks[c, at + 5]
                else:
                    n0 = blocks[c, at] if width > 0 else 0.0
                    n1 = blocks[c, at + 1] if width > 1 else 0.0
                    n2 = blocks[c, at + 2] if width > 2 else 0.0
                    n3 = blocks[c, at + 3] if width > 3 else 0.0
                    n4 = blocks[c, at + 4] if width > 4 else 0.0
                    n5 = 0.0
                if with_masses and diagonal:
                    n0, n1, n2 = n0 * roots[m], n1 * roots[m + 7], n2 * roots[m + 14]
                    n3, n4, n5 = n3 * roots[m + 21], n4 * roots[m + 28], n5 * roots[m + 35]
                elif with_masses:
                    n0 = n0 * roots[m] + n1 * roots[m + 6] + n2 * roots[m + 12]
                    n0 += n3 * roots[m + 18] + n4 * roots[m + 24] + n5 * roots[m + 30]
                    n1 = n1 * roots[m + 7] + n2 * roots[m + 13] + n3 * roots[m + 19]
                    n1 += n4 * roots[m + 25] + n5 * roots[m + 31]
                    n2 = n2 * roots[m + 14] + n3 * roots[m + 20] + n4 * roots[m + 26] + n5 * roots[m + 32]
                    n3 = n3 * roots[m + 21] + n4 * roots[m + 27] + n5 * roots[m + 33]
                    n4 = n4 * roots[m + 28] + n5 * roots[m + 34]
                    n5 *= roots[m + 35]
                N[o], N[o + 1], N[o + 2], N[o + 3], N[o + 4], N[o + 5] = n0, n1, n2, n3, n4, n5
