"""Last resort: contact after contact is solved with the others held (projected Gauss-Seidel method).

Slow where contacts are redundant, but from the first sweep on all impulses push and stay in their cones, which a failed
Newton method does not promise (M. Jean, Comput. Methods Appl. Mech. Eng. 177 (1999)).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import vector_at
from heavylift.solver.contact.laws.rows import (
    RECORD,
    ROWS,
    clip,
    linearise,
    linearised_contact,
    solved_rows,
)
from heavylift.solver.contact.layout import CURVE, INACTIVE, Problem, Work
from heavylift.solver.contact.solve.end_blocks import CONTACT
from heavylift.solver.contact.solve.iteration import ACCEPTED, measure
from heavylift.solver.contact.solve.system import END
from heavylift.solver.contact.solve.twelve_rows import COLUMNS

__all__ = ["sweep_contacts"]

SWEEPS = 3000
CHECK = 50
"""Sweeps between measurements of the residual; a part of all of them."""

PUSHES = 5
"""Impulses on a contact in a sweep; each adds as many columns of B as a row has, or changes twelve velocities."""


@kernel(internal=True)
def _rate(problem: Problem, work: Work, row: int, y: NDArray[np.float64]) -> float:
    """Rate of one row; y as `_push` changes it."""
    if problem.ends.shape[0] == 0:
        return y[row]
    c, k = row // 3, row % 3
    total = 0.0
    for end in range(2):
        first, width = problem.ends[c, 2 * end], problem.ends[c, 2 * end + 1]
        if width == 0:
            continue
        if work.marks.unit_mass:
            first, o = int(work.place[first]), CONTACT * c + COLUMNS * k + 6 * end
            for j in range(width):
                total += work.N[o + j] * y[first + j]
        else:
            o = END * end + 6 * k
            for j in range(width):
                total += problem.blocks[c, o + j] * y[first + j]
    return total


@kernel(internal=True, reassociate=True)
def _push(problem: Problem, work: Work, row: int, impulse: float, y: NDArray[np.float64]) -> None:
    """Add an impulse on one row to the velocities: those of a unit mass, in their places, if masses are in the rows."""
    size = problem.counts.size
    if problem.ends.shape[0] == 0:
        for i in range(size):
            y[i] += problem.B[row, i] * impulse
        return
    c, k = row // 3, row % 3
    for end in range(2):
        first, width = problem.ends[c, 2 * end], problem.ends[c, 2 * end + 1]
        if width == 0:
            continue
        if work.marks.unit_mass:
            first, o = int(work.place[first]), CONTACT * c + COLUMNS * k + 6 * end
            for j in range(width):
                y[first + j] += work.N[o + j] * impulse
            continue
        o = END * end + 6 * k
        for j in range(width):
            share = problem.blocks[c, o + j] * impulse
            if share != 0.0:
                for i in range(size):
                    y[i] += problem.B[first + j, i] * share


@kernel(internal=True)
def _response(problem: Problem, work: Work, row: int, x: NDArray[np.float64]) -> float:
    """Rate of one row by an impulse on it: an entry on the diagonal of W."""
    if work.marks.unit_mass:
        total, o = 0.0, COLUMNS * row
        for j in range(COLUMNS):
            total += work.N[o + j] * work.N[o + j]
        return total
    for i in range(problem.counts.size):
        x[i] = 0.0
    _push(problem, work, row, 1.0, x)
    return _rate(problem, work, row, x)


@kernel(internal=True)
def _solve_contact(
    problem: Problem, work: Work, c: int, p: NDArray[np.float64], y: NDArray[np.float64]
) -> None:
    """Correct the impulses of one contact: normal rows first, then slip towards the rates that are left."""
    kinds, parameters, response = problem.kinds, problem.parameters, work.kept
    record, solved = linearised_contact(work.records, RECORD * c), solved_rows(work.rows, ROWS * c)
    first = 3 * c
    normals = 2 if kinds[c].kind == CURVE else 1
    for i in range(normals):
        row, before = first + i, p[first + i]
        work.w[row] = _rate(problem, work, row, y)
        r_n = 1.0 / (response[first] + solved.softness[0])
        impulse, rate = vector_at(p, first), vector_at(work.w, first)
        linearise(kinds[c], parameters[c], solved, impulse, rate, r_n, 1.0, record)
        reaction = record.d00 if i == 0 else record.d11
        p[row] += record.r[i] / (1.0 + reaction * response[row])
        _push(problem, work, row, p[row] - before, y)
    if kinds[c].kind == INACTIVE or parameters[c].friction <= 0.0:
        size = 0.0
    else:
        size = 1.0 / (
            max(response[first + 1], response[first + 2]) + max(solved.softness[1], solved.softness[2])
        )
        if normals == 1:
            size *= 0.5  # both tangents at once
    before1, before2 = p[first + 1], p[first + 2]
    before = p[first]
    for i in range(normals, 3):
        if size > 0.0:
            g = _rate(problem, work, first + i, y) + solved.softness[i] * p[first + i] - solved.target[i]
            p[first + i] -= size * g
    clip(kinds, parameters, c, p)
    _push(problem, work, first, p[first] - before, y)
    _push(problem, work, first + 1, p[first + 1] - before1, y)
    _push(problem, work, first + 2, p[first + 2] - before2, y)


@kernel(internal=True)
def sweep_contacts(
    problem: Problem, work: Work, p: NDArray[np.float64], most: float
) -> tuple[bool, int, float]:
    """Sweep over the contacts until the laws hold.

    Parameters
    ----------
    problem, work
        With the diagonal and the rows filled in.
    p
        Impulses to begin with, replaced.
    most
        Products after which no more sweeps are made, about; they are measured once at least.

    Returns
    -------
    found, sweeps, residual
        As of Newton's method.
    """
    counts, size = problem.counts, problem.counts.high - problem.counts.low
    first, past = counts.first, counts.last
    count, y = past - first, work.x
    for row in range(3 * first, 3 * past):
        if not abs(p[row]) < np.inf:
            p[row] = 0.0
        work.kept[row] = _response(problem, work, row, y)
    residual = np.inf
    columns = 1 if problem.ends.shape[0] == 0 else COLUMNS
    products = COLUMNS if work.marks.unit_mass else columns * size
    checks = int(most / float(PUSHES * products * count)) // CHECK
    last = CHECK * min(max(checks, 1), SWEEPS // CHECK)
    for sweep in range(last + 1):
        if sweep % CHECK == 0:  # afresh, without the rounding of many pushes
            residual = measure(problem, work, p)
            if residual <= ACCEPTED or sweep == last:
                return residual <= ACCEPTED, sweep, residual
            for i in range(counts.low, counts.high):
                y[i] = work.y0[i] if work.marks.unit_mass else problem.start[i]
            for row in range(3 * first, 3 * past):
                if p[row] != 0.0:
                    _push(problem, work, row, p[row], y)
        for c in range(first, past):
            _solve_contact(problem, work, c, p, y)
    return False, last, residual
