"""Newton's method for all contacts at once.

Impulses are kept and corrected, not computed from rates: with a softness of 1e-7 of the inverse masses ``(b - w)/S``
would amplify the rounding of w to 1e-9 of the impulses. Full steps are taken. Where they do not lead to a solution, a
search along them does not either: it stops at kinks of the laws. An iteration passes twice over the rows of all
contacts: once from velocities to linearised laws and their sums, once from the step of the velocities to impulses.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.laws.rows import (
    RECORD,
    ROWS,
    linearise,
    linearise_unilateral,
    linearised_contact,
    solved_rows,
)
from heavylift.solver.contact.layout import UNILATERAL, Problem, Work
from heavylift.solver.contact.solve.end_blocks import CONTACT, add_pair, load_pair, same_ends
from heavylift.solver.contact.solve.envelope import factor_near_diagonal, solve_near_diagonal
from heavylift.solver.contact.solve.system import (
    COUPLING,
    SCRATCH,
    add_unit,
    add_unit_to_product,
    assemble_rows,
    factor,
    multiply,
    solve_factored,
    update,
)
from heavylift.solver.contact.solve.twelve_rows import add_rows, multiply_rows

__all__ = ["ACCEPTED", "iterate", "measure", "measure_rates"]

ACCEPTED = 1e-10
"""Residual of a solution, relative to the largest rate without impulses or change of rate by them."""

REFINED = 1e-8
"""A correction smaller than this part of the impulses is the last one: the next is smaller by a factor like that."""

NO_GAIN = 1e-13
"""Residual below which a correction that gains nothing is taken for rounding, relative as above."""

AT_REST = 2e-11
"""Residual of impulses to begin with, below which they are a solution, relative to rates without impulses alone.

So are the forces of what stands then, however heavy it is. Relative to what impulses do, which with masses a million
times apart is a million times more, forces of the heavy body would be off by as much."""

REFINEMENTS = 6
"""Most corrections of an accepted solution."""

ROUNDING = 1e-15
"""Residual that rounding leaves, relative to W times the largest impulse."""


@kernel(internal=True)
def _sum_impulses(problem: Problem, work: Work, p: NDArray[np.float64]) -> None:
    """``z = N^T p``."""
    ends, z, sums, counts = problem.ends, work.z, work.sums, problem.counts
    for i in range(counts.low, counts.high):
        z[i] = 0.0
    for c in range(counts.first, counts.last):
        if c > counts.first and not same_ends(ends, c, c - 1):
            add_pair(ends, work.place, c - 1, sums, z)
        p0, p1, p2 = p[3 * c], p[3 * c + 1], p[3 * c + 2]
        if p0 != 0.0 or p1 != 0.0 or p2 != 0.0:
            add_rows(work.N, CONTACT * c, p0, p1, p2, sums)
    add_pair(ends, work.place, counts.last - 1, sums, z)


@kernel(internal=True)
def _by_mass(problem: Problem, work: Work, z: NDArray[np.float64]) -> None:
    """Write ``y = B z``; the same where the masses are in the rows."""
    if work.marks.unit_mass:
        for i in range(problem.counts.low, problem.counts.high):
            work.y[i] = z[i]
    else:
        multiply(problem.counts.size, problem.B, z, work.y)


@kernel(internal=True)
def _evaluate(problem: Problem, work: Work, p: NDArray[np.float64]) -> tuple[float, float, float]:
    """Find rates and linearised laws, on blocks from ``z = N^T p`` and with ``x = N^T r`` as a result.

    Returns the largest residual of a contact, what it is measured by, and the part of that which belongs to rates.
    """
    first, last, size, ends = problem.counts.first, problem.counts.last, problem.counts.size, problem.ends
    kinds = problem.kinds
    w, w0, x, records, place, N = work.w, work.w0, work.x, work.records, work.place, work.N
    on_blocks = ends.shape[0] > 0
    if on_blocks:
        _by_mass(problem, work, work.z)
        for i in range(problem.counts.low, problem.counts.high):
            work.y[i] += work.y0[i]
            x[i] = 0.0
    else:
        multiply(size, problem.B, p, w)
        for i in range(size):
            w[i] += w0[i]
    worst, largest, scale = 0.0, 0.0, work.marks.scale
    finite = True
    for c in range(first, last):
        i, o = 3 * c, CONTACT * c
        if on_blocks:
            if c == first or not same_ends(ends, c, c - 1):
                if c > first:
                    add_pair(ends, place, c - 1, work.sums, x)
                load_pair(ends, place, c, work.y, work.pair)
            v0, v1, v2 = multiply_rows(N, o, work.pair)
            w[i], w[i + 1], w[i + 2] = v0, v1, v2
        else:
            v0, v1, v2 = w[i], w[i + 1], w[i + 2]
        p0, p1, p2 = p[i], p[i + 1], p[i + 2]
        impulse, rate, parameters = (p0, p1, p2), (v0, v1, v2), problem.parameters[c]
        r_n, r_t = work.inverse[2 * c], work.inverse[2 * c + 1]
        record, row = linearised_contact(records, RECORD * c), solved_rows(work.rows, ROWS * c)
        if kinds[c].kind == UNILATERAL:
            square = linearise_unilateral(parameters, row, impulse, rate, r_n, r_t, record)
        else:
            square = linearise(kinds[c], parameters, row, impulse, rate, r_n, r_t, record)
        r0, r1, r2 = record.r[0], record.r[1], record.r[2]
        if on_blocks and (r0 != 0.0 or r1 != 0.0 or r2 != 0.0):
            add_rows(N, o, r0, r1, r2, work.sums)
        worst = max(worst, square)
        finite = finite and square < np.inf
        scale = max(scale, abs(v0 - w0[i]), abs(v1 - w0[i + 1]), abs(v2 - w0[i + 2]))
        normal, tangent = work.diagonal[2 * c], work.diagonal[2 * c + 1]
        largest = max(largest, abs(p0) * normal, max(abs(p1), abs(p2)) * tangent)
    if on_blocks:
        add_pair(ends, place, last - 1, work.sums, x)
    if not finite:
        return np.inf, scale, scale
    return math.sqrt(worst), max(scale, ROUNDING / ACCEPTED * largest), scale


@kernel(internal=True)
def measure(problem: Problem, work: Work, p: NDArray[np.float64]) -> float:
    """Residual of impulses, relative as that of a solution."""
    if problem.ends.shape[0] > 0:
        _sum_impulses(problem, work, p)
    residual, scale, _ = _evaluate(problem, work, p)
    return residual / scale if scale > 0.0 else residual


@kernel(internal=True)
def measure_rates(problem: Problem, work: Work, p: NDArray[np.float64]) -> float:
    """Residual of impulses that are no solution, relative to rates alone, whatever the impulses."""
    if problem.ends.shape[0] > 0:
        _sum_impulses(problem, work, p)
    residual, _, scale = _evaluate(problem, work, p)
    return residual / scale if scale > 0.0 else residual


@kernel(internal=True)
def _solve_step(problem: Problem, work: Work, fresh: bool) -> bool:
    """Solve for the sums of a step on the velocities, from x into y; returns False if the matrix is singular."""
    size, marks, low, high = problem.counts.size, work.marks, problem.counts.low, problem.counts.high
    changed = update(problem.counts, problem.ends, work.place, work.N, work.records, work.held, work.K)
    if changed or fresh:
        marks.near_diagonal = False
        if marks.unit_mass:
            add_unit(size, low, high, work.K, work.reach, work.A)
            if factor_near_diagonal(size, low, high, work.A, work.reach):
                marks.near_diagonal = True
            else:
                for i in range(size * size):
                    work.A[i] = 0.0
                for i in range(size):  # of the other islands nothing is asked
                    if not low <= i < high:
                        work.A[i * size + i], work.x[i] = 1.0, 0.0
                add_unit(size, low, high, work.K, work.reach, work.A)
        else:
            add_unit_to_product(size, work.K, problem.B, work.A)
        if not marks.near_diagonal and not factor(size, work.A, work.pivots):
            return False
    if marks.near_diagonal:
        solve_near_diagonal(size, low, high, work.A, work.reach, work.x)
    else:
        solve_factored(size, work.A, work.pivots, work.x)
    _by_mass(problem, work, work.x)
    return True


@kernel(internal=True)
def _correct(problem: Problem, work: Work, p: NDArray[np.float64], fresh: bool) -> float:
    """Add a step of Newton's method to p; returns its largest size over that of p, weighted by W; below zero: none."""
    first, last, size, ends = problem.counts.first, problem.counts.last, problem.counts.size, problem.ends
    place = work.place
    records, dw, x, z, N = work.records, work.dw, work.x, work.z, work.N
    on_blocks = ends.shape[0] > 0
    if on_blocks:
        if not _solve_step(problem, work, fresh):
            return -1.0
        for i in range(problem.counts.low, problem.counts.high):
            z[i] = 0.0
    else:
        n = assemble_rows(last, size, problem.B, records, work.A, work.active, x)
        if not factor(n, work.A, work.pivots):
            return -1.0
        solve_factored(n, work.A, work.pivots, x)
        for c in range(first, last):
            record = linearised_contact(records, RECORD * c)
            for i in range(3):
                dw[3 * c + i] = record.r[i]
        for i in range(n):
            dw[int(work.active[i])] = x[i]
    step, largest = 0.0, 0.0
    for c in range(first, last):
        i = 3 * c
        if on_blocks:
            if c == first or not same_ends(ends, c, c - 1):
                if c > first:
                    add_pair(ends, place, c - 1, work.sums, z)
                load_pair(ends, place, c, work.y, work.pair)
            u0, u1, u2 = multiply_rows(N, CONTACT * c, work.pair)
            a = linearised_contact(records, RECORD * c)
            d0 = a.r[0] - a.d00 * u0
            d1 = a.r[1] - a.d10 * u0 - a.d11 * u1 - a.d12 * u2
            d2 = a.r[2] - a.d20 * u0 - a.d21 * u1 - a.d22 * u2
        else:
            d0, d1, d2 = dw[i], dw[i + 1], dw[i + 2]
        p0, p1, p2 = p[i] + d0, p[i + 1] + d1, p[i + 2] + d2
        p[i], p[i + 1], p[i + 2] = p0, p1, p2
        if on_blocks and (p0 != 0.0 or p1 != 0.0 or p2 != 0.0):
            add_rows(N, CONTACT * c, p0, p1, p2, work.sums)
        normal, tangent = work.diagonal[2 * c], work.diagonal[2 * c + 1]
        step = max(step, abs(d0) * normal, max(abs(d1), abs(d2)) * tangent)
        largest = max(largest, abs(p0) * normal, max(abs(p1), abs(p2)) * tangent)
    if on_blocks:
        add_pair(ends, place, last - 1, work.sums, z)
    return step / largest if largest > 0.0 else 0.0


@kernel(internal=True)
def iterate(
    problem: Problem, work: Work, p: NDArray[np.float64], limit: int, accepted: float
) -> tuple[bool, int, float]:
    """Correct impulses until the laws of all contacts hold.

    Parameters
    ----------
    problem, work
        With the diagonal and the rows filled in.
    p
        Impulses, corrected in place.
    limit
        Most iterations.
    accepted
        Residual of a solution, relative to the rates; ACCEPTED: continue from there to the limit of rounding.

    Returns
    -------
    found
        The residual is small enough.
    iterations
        Systems solved.
    residual
        Relative.
    """
    if problem.ends.shape[0] > 0:
        counts = problem.counts
        for i in range(COUPLING * counts.first, COUPLING * counts.last):
            work.held[i] = 0.0
        for i in range(COUPLING * counts.number, COUPLING * counts.number + SCRATCH):
            work.held[i] = 0.0
        size = counts.size
        if work.marks.unit_mass:  # nothing else is read
            for i in range(counts.low, counts.high):
                for j in range(i, int(work.reach[i]) + 1):
                    work.K[i * size + j] = work.K[j * size + i] = 0.0
        else:
            for i in range(size * size):
                work.K[i] = 0.0
        _sum_impulses(problem, work, p)
    best, step, refinements = np.inf, np.inf, 0
    iteration, relative = 0, np.inf
    while True:
        residual, scale, _ = _evaluate(problem, work, p)
        relative = residual / scale if scale > 0.0 else residual
        known = iteration == 0 and residual <= AT_REST * work.marks.free
        if relative <= accepted and (accepted > ACCEPTED or step <= REFINED or known):
            return True, iteration, relative
        if relative <= accepted and relative < best:
            gain = relative < 0.5 * best
            best = relative
            for i in range(3 * problem.counts.first, 3 * problem.counts.last):
                work.best[i] = p[i]
            if not gain and best < NO_GAIN:
                return True, iteration, best
        elif best < NO_GAIN:
            break
        if best < np.inf:
            refinements += 1
        if refinements > REFINEMENTS or not relative < np.inf or (iteration >= limit and refinements == 0):
            break
        step = _correct(problem, work, p, iteration == 0)
        if step < 0.0:
            break
        iteration += 1
    if best < np.inf:
        for i in range(3 * problem.counts.first, 3 * problem.counts.last):
            p[i] = work.best[i]
        return True, iteration, best
    return False, iteration, relative
