"""Which sheaves of ropes slide, found for certain: pivots along a path on which friction loses its strength.

While no law changes its branch, flows q and mean tensions T of ropes over sheaves are linear in the frictions f. With
the tensions a_j before and b_j = a_j + f_j beyond a sheave (`heavylift.solver.force_elements.sheave_friction`) is
wanted ::

    q = q_0 - Q f,      v = (1 - eta) b - f + c t >= 0,     q+ >= 0,    v q+ = 0,       q = q+ - q-
                        w = f + (1 - eta) a + c t >= 0,     q- >= 0,    w q- = 0,       t = 0

This is friction with a bound that depends on the tensions, a linear complementarity problem without symmetry. For
large t everything sticks. C. E. Lemke (Manage. Sci. 11, 1965) follows the solutions from there to t = 0, a state at a
time and t up and down as it must, without ever coming twice to one place. Q is positive definite and friction only
loses power, so solutions stay within bounds on the way while tensions are positive, and it cannot end elsewhere. The
numbers c, all of the size of the tensions, differ, lest two states of something symmetric change at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record

__all__ = ["SearchCounts", "SheaveSearch", "find_states", "make_search"]

PIVOTS = 50
"""Pivots relative to the number of unknowns after which the search is given up; some two are what it takes."""

FLAT = 1e-12
"""Of the largest number in a column, which counts as none."""

GOLDEN = 0.6180339887498949


class SearchCounts(Record):
    """Where a search is.

    Attributes
    ----------
    sheaves
        That take part.
    phase, pushed
        For who asks: what a round is for, and the sheave whose friction it has changed.
    rounds, attempts
        Rounds of the iteration of the step, and searches in it.
    """

    sheaves: int
    phase: int
    pushed: int
    rounds: int
    attempts: int


class SheaveSearch(Arrays):
    """Room for a search over m sheaves of r ropes, in the order of the ropes.

    Attributes
    ----------
    counts
        How many there are.
    number, rope
        Numbers of the sheaves that take part and of their ropes, shape (m,).
    force, flow
        At which all is linear, and the flow there [N], [m/s], shape (m,).
    push
        Change of the force with which the response is measured [N], shape (m,).
    share, loss
        W and 1 - eta, shape (m,).
    creep, held
        Of a row that sticks: flow per force [m/s/N] less than `held` [N], shape (m,).
    tension
        Mean tensions at `force` [N], shape (r,).
    response, stiffness
        Derivatives of flows and of mean tensions by the forces, shape (m, m) and (r, m).
    branch
        Found: 0 of a sheave that sticks, 1 or -1 of one that slides, shape (m,).
    inverse
        Of Q, shape (m, m).
    table
        What is in the basis by what is not, with t and a constant, shape (2 m, 2 m + 2).
    inside, outside, place
        Unknowns of rows and of columns, and columns of unknowns or -1.
    """

    counts: SearchCounts
    number: Ints1
    rope: Ints1
    force: Floats1
    flow: Floats1
    push: Floats1
    share: Floats1
    loss: Floats1
    creep: Floats1
    held: Floats1
    tension: Floats1
    response: Floats2
    stiffness: Floats2
    branch: Ints1
    inverse: Floats2
    table: Floats2
    inside: Ints1
    outside: Ints1
    place: Ints1


def make_search(sheaves: int, ropes: int) -> SheaveSearch:
    """Room for a search over some sheaves and ropes."""
    whole: dict[str, Any] = {name: np.zeros(sheaves, dtype=np.int64) for name in ("number", "rope", "branch")}
    names = ("force", "flow", "push", "share", "loss", "creep", "held")
    real: dict[str, Any] = {name: np.zeros(sheaves) for name in names}
    return SheaveSearch(
        counts=SearchCounts.one(),
        **whole,
        **real,
        tension=np.zeros(ropes),
        response=np.zeros((sheaves, sheaves)),
        stiffness=np.zeros((ropes, sheaves)),
        inverse=np.zeros((sheaves, sheaves)),
        table=np.zeros((2 * sheaves, 2 * sheaves + 2)),
        inside=np.zeros(2 * sheaves, dtype=np.int64),
        outside=np.zeros(2 * sheaves + 1, dtype=np.int64),
        place=np.zeros(4 * sheaves + 1, dtype=np.int64),
    )


@kernel(internal=True)
def _invert(search: SheaveSearch) -> bool:
    """Inverse of Q, positive definite, by Gauss and Jordan without exchanges; false if it is not."""
    m, A = search.counts.sheaves, search.inverse
    for i in range(m):
        for j in range(m):
            A[i, j] = -0.5 * (search.response[i, j] + search.response[j, i])
        A[i, i] += search.creep[i]
    for k in range(m):
        pivot = A[k, k]
        if not pivot > 0.0:
            return False
        A[k, k] = 1.0
        for j in range(m):
            A[k, j] /= pivot
        for i in range(m):
            if i != k:
                factor = A[i, k]
                A[i, k] = 0.0
                for j in range(m):
                    A[i, j] -= factor * A[k, j]
    return True


@kernel(internal=True)
def _stuck_force(search: SheaveSearch, j: int) -> float:
    """Friction of a sheave while all of them stick [N]."""
    m = search.counts.sheaves
    total = 0.0
    for k in range(m):
        q = search.flow[k] + search.creep[k] * (search.held[k] - search.force[k])
        total += search.inverse[j, k] * q
    return search.force[j] + total


@kernel(internal=True)
def _fill_table(search: SheaveSearch) -> None:
    """Rows v and w by columns q+ and q-, t and a constant; `flow` becomes the forces while all stick."""
    m, table = search.counts.sheaves, search.table
    n = 2 * m
    for j in range(m):
        search.push[j] = _stuck_force(search, j)
    scale = 0.0
    for j in range(m):
        scale = max(scale, abs(search.tension[search.rope[j]]), abs(search.push[j]))
    for j in range(m):
        rope, loss = search.rope[j], search.loss[j]
        for k in range(n + 2):
            table[j, k] = table[m + j, k] = 0.0
        before = search.tension[rope]
        for i in range(m):
            by = search.stiffness[rope, i]
            before += by * (search.push[i] - search.force[i])
            if search.rope[i] == rope:
                by += (1.0 if i < j else 0.0) - search.share[i]
                before += ((1.0 if i < j else 0.0) - search.share[i]) * search.push[i]
            high = loss * by - (1.0 - loss if i == j else 0.0)  # of v by the force of sheave i
            low = loss * by + (1.0 if i == j else 0.0)
            for k in range(m):
                table[j, k] -= high * search.inverse[i, k]
                table[m + j, k] -= low * search.inverse[i, k]
        f = search.push[j]
        table[j, n + 1] = loss * (before + f) - f
        table[m + j, n + 1] = f + loss * before
        share = GOLDEN * (j + 1)
        table[j, n] = scale * (1.0 + 0.5 * (share - np.floor(share)))
        share = GOLDEN * (m + j + 1)
        table[m + j, n] = scale * (1.0 + 0.5 * (share - np.floor(share)))
    for j in range(n):
        for k in range(m):
            table[j, m + k] = -table[j, k]


@kernel(internal=True)
def _pivot(search: SheaveSearch, r: int, e: int) -> None:
    """Exchange the unknown of a row with that of a column."""
    n, table = 2 * search.counts.sheaves, search.table
    scale = 1.0 / table[r, e]
    table[r, e] = -1.0
    for k in range(n + 2):
        table[r, k] *= -scale
    for i in range(n):
        if i != r:
            factor = table[i, e]
            table[i, e] = 0.0
            for k in range(n + 2):
                table[i, k] += factor * table[r, k]
    leaving, entering = search.inside[r], search.outside[e]
    search.inside[r], search.outside[e] = entering, leaving
    search.place[leaving], search.place[entering] = e, -1


@kernel(internal=True)
def _leaving(search: SheaveSearch, e: int, t: int) -> int:
    """Row whose unknown first comes to zero while that of a column grows, t before others; -1 if none does."""
    n, table = 2 * search.counts.sheaves, search.table
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(table[i, e]))
    found, least, steepest = -1, np.inf, 0.0
    for i in range(n):
        slope = -table[i, e]
        if slope > FLAT * largest:
            ratio = max(0.0, table[i, n + 1]) / slope
            if ratio < least or (ratio == least and (search.inside[i] == t or slope > steepest)):
                found, least, steepest = i, ratio, slope
                if search.inside[i] == t:
                    steepest = np.inf
    return found


@kernel
def find_states(search: SheaveSearch) -> bool:
    """States of all sheaves, and their frictions into `force`; false if they are not found.

    Parameters
    ----------
    search
        With `counts.sheaves` and all that is given of them; `flow`, `push` and `response` are used up.
    """
    m = search.counts.sheaves
    n, t = 2 * m, 4 * m
    table = search.table
    if not _invert(search):
        return False
    _fill_table(search)
    for k in range(n):
        search.inside[k], search.outside[k] = k, n + k
        search.place[k], search.place[n + k] = -1, k
    search.outside[n], search.place[t] = t, n
    row, lowest = -1, 0.0
    for i in range(n):
        need = table[i, n + 1] / table[i, n]
        if need < lowest:
            row, lowest = i, need
    column, left = n, PIVOTS * (n + 1)
    while row >= 0 and left > 0:
        leaving = search.inside[row]
        _pivot(search, row, column)
        if leaving == t:
            break
        column = search.place[leaving + n if leaving < n else leaving - n]
        row = _leaving(search, column, t)
        left -= 1
        if row < 0:
            return False
    if left == 0:
        return False
    for j in range(m):
        search.branch[j] = 0
        search.flow[j] = 0.0
    for i in range(n):
        unknown = search.inside[i] - n
        if 0 <= unknown < n:
            j = unknown if unknown < m else unknown - m
            sense = 1 if unknown < m else -1
            search.branch[j] = sense
            search.flow[j] += sense * table[i, n + 1]
    for j in range(m):
        f = search.push[j]
        for k in range(m):
            f -= search.inverse[j, k] * search.flow[k]
        search.force[j] = f
    return True
