"""Solver of all contacts at once: impulses that satisfy complementarity and Coulomb's law on given bodies.

Semi-smooth Newton method on the laws of P. Alart and A. Curnier (Comput. Methods Appl. Mech. Eng. 92 (1991)), true
cone of Coulomb, without association of slip and opening. The linear systems have the size of the touched velocities,
so the cost of many contacts on few bodies grows with their number only linearly; contacts that press on the same
bodies more often than needed share by their softness. Where the method does not converge, proximal steps follow,
until the work is more than a bound.
Nothing is accepted by less than its residual; what
remains without a solution comes back as failed, with impulses that at least push and stay in their cones.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records
from heavylift.numerics.small import solve_symmetric_3
from heavylift.solver.contact.laws.rows import clip
from heavylift.solver.contact.layout import UNILATERAL, Problem, RowKind, RowParameters, Work
from heavylift.solver.contact.solve.fallback_gauss_seidel import sweep_contacts
from heavylift.solver.contact.solve.fallback_proximal import share_redundant, take_proximal_steps
from heavylift.solver.contact.solve.iteration import ACCEPTED, iterate, measure_rates
from heavylift.solver.contact.solve.problem import fill_rows, next_island, prepare
from heavylift.solver.contact.solve.system import gather, multiply_blocks
from heavylift.solver.kinds import Table, generic, implement

__all__ = [
    "BY_GAUSS_SEIDEL",
    "BY_NEWTON",
    "BY_PROXIMAL_STEPS",
    "FAILED",
    "ContactSolvers",
    "NonsmoothNewton",
    "solve_contacts",
]

BY_NEWTON, BY_PROXIMAL_STEPS, BY_GAUSS_SEIDEL = range(3)
FAILED = -1

FIRST_LIMIT = 25
"""Iterations of Newton's method in the first attempt."""

LIMITS = (20, 30, 60, 40, 25, 0, 100, 60, 60)
FALLS = (0.1, 0.3, 0.1, 0.5, 0.03, 0.0, 0.5, 0.3, 0.1)
GROWTHS = (3.0, 10.0, 2.0, 2.0, 5.0, 0.0, 4.0, 30.0, 2.0)
"""Iterations of Newton's method for a proximal step of further attempts, and how its size changes.

Each of them misses a few of 1000 problems with wedged contacts, but not the same ones.
"""

SWEEP_WORK = 3e7
"""Products of all sweeps: a few tenths of a second."""

FROM_SWEEPS = 5
"""Attempt that is made of sweeps over the contacts, and after which attempts begin with what those have left."""

MOST_FACTORS, MOST_ROWS = 2e8, 1e6
"""Iterations times the multiplications of a factor, and times the contacts, after which no more attempts are made:
tenths of a second.

What has a solution is found in some hundred iterations; what has none, as a wall with targets that fit no motion, is
given up after them. Its best impulses are kept, with their residual.
"""

OF_A_CONTACT = 4000.0
"""Multiplications of a factor that take as long as all else that an iteration does for a contact."""


@kernel(internal=True)
def _factor_work(problem: Problem) -> float:
    """Multiplications in a factor of the island."""
    low, high = problem.counts.low, problem.counts.high
    if problem.ends.shape[0] == 0 or not problem.work.marks.unit_mass:
        return float(high - low) ** 3 / 3.0
    total = 0.0
    for i in range(low, high):
        reach = problem.work.reach[i] - i
        total += reach * reach
    return total


@kernel(internal=True)
def _solve(problem: Problem) -> tuple[int, int, float]:
    """Island by island; the worst status and residual, and iterations as if all of them were of the whole problem."""
    work, out, counts = problem.work, problem.y, problem.counts
    prepare(problem, work)
    for i in range(3 * counts.number):
        if not abs(work.w0[i]) < np.inf:  # the bodies themselves have been lost before
            for j in range(counts.size):
                out[j] = problem.start[j]
            return FAILED, 0, np.inf
    status, solved, residual = BY_NEWTON, 0, 0.0
    problem.solution.effort = 0.0
    while next_island(problem, work):
        found, iterations, left = _solve_island(problem)
        worse = found == FAILED or (status != FAILED and found > status)
        status = found if worse else status
        solved += iterations * (counts.last - counts.first)
        if iterations > 0:
            cost = float(counts.last - counts.first) + _factor_work(problem) / OF_A_CONTACT
            problem.solution.effort += iterations * cost
        residual = max(residual, left)
    for c in range(counts.number):
        clip(problem.kinds, problem.parameters, c, problem.p)
    gather(counts.number, problem.ends, problem.blocks, counts.size, problem.p, 3, work.z)
    multiply_blocks(counts.size, problem.B, problem.head, problem.past, work.z, out)
    for i in range(counts.size):
        out[i] += problem.start[i]
    return status, -(-solved // counts.number), residual


@kernel(internal=True)
def _solve_island(problem: Problem) -> tuple[int, int, float]:
    """Solve by Newton's method, then by proximal steps from the given impulses and from none."""
    first, last = 3 * problem.counts.first, 3 * problem.counts.last
    work, p = problem.work, problem.p
    for i in range(first, last):
        if not abs(p[i]) < np.inf:
            p[i] = 0.0
        work.begin[i] = p[i]
        work.rough[i] = 0.0
    fill_rows(problem, work, 0.0, work.begin)
    status = BY_NEWTON
    found, total, residual = iterate(problem, work, p, FIRST_LIMIT, ACCEPTED)
    if found:
        return status, total, residual
    number = (last - first) // 3
    most = int(min(MOST_FACTORS / max(_factor_work(problem), 1.0), MOST_ROWS / float(number)))
    least = np.inf
    for attempt in range(2):
        if not found and (attempt == 0 or total < most):
            status = BY_PROXIMAL_STEPS
            for i in range(first, last):
                p[i] = 0.0 if attempt == 0 else work.begin[i]
            found, iterations, residual = share_redundant(problem, work, p, most)
            total += iterations
            if not found:
                least = _keep_best(problem, work, p, least)
    swept = False
    for attempt in range(len(LIMITS)):
        if found or (swept and total >= most):
            break
        if attempt == FROM_SWEEPS or total >= most:
            swept = True
            fill_rows(problem, work, 0.0, work.begin)
            found, iterations, residual = sweep_contacts(problem, work, p, SWEEP_WORK)
            total += iterations
            for i in range(first, last):
                work.begin[i] = p[i]
            if found:
                status = BY_GAUSS_SEIDEL
            else:
                least = _keep_best(problem, work, p, least)
            continue
        from_none = 0 < attempt < FROM_SWEEPS
        for i in range(first, last):
            p[i] = 0.0 if from_none else work.begin[i]
        limits = (LIMITS[attempt], most)
        found, iterations, after = take_proximal_steps(
            problem, work, p, limits, FALLS[attempt], GROWTHS[attempt]
        )
        total += iterations
        if found:
            residual = after
        else:
            least = _keep_best(problem, work, p, least)
    if not found:
        status, residual = FAILED, least
        for i in range(first, last):
            p[i] = work.rough[i]
    return status, total, residual


@kernel(internal=True)
def _keep_best(problem: Problem, work: Work, p: NDArray[np.float64], least: float) -> float:
    """Keep impulses of an attempt that found no solution if no others have a smaller residual; returns the smallest.

    They are kept inside their cones: impulses that push, with friction within its bound, take energy out and let
    bodies come together by no more than their residual.
    """
    for i in range(3 * problem.counts.first, 3 * problem.counts.last):
        if not abs(p[i]) < np.inf:
            return least
    for c in range(problem.counts.first, problem.counts.last):
        clip(problem.kinds, problem.parameters, c, p)
    fill_rows(problem, work, 0.0, p)
    residual = measure_rates(problem, work, p)
    if residual < least:
        for i in range(3 * problem.counts.first, 3 * problem.counts.last):
            work.rough[i] = p[i]
        return residual
    return least


@kernel(inline=True, internal=True)
def _solve_one(
    kinds: Records[RowKind],
    parameters: Records[RowParameters],
    w0: NDArray[np.float64],
    W: NDArray[np.float64],
    p: NDArray[np.float64],
) -> bool:
    """Solve a single unilateral contact that is open, without friction, or sticks; False if it is none of these."""
    mu = parameters[0].friction
    o0, o1, o2 = parameters[0].offset[0], parameters[0].offset[1], parameters[0].offset[2]
    S, b = parameters[0].softness[0], parameters[0].target[0]
    g = w0[0] - W[0, 1] * o1 - W[0, 2] * o2 - b  # without impulse on the tangents
    if g - (W[0, 0] + S) * o0 >= 0.0:
        p[0], p[1], p[2] = -o0, -o1, -o2
        return True
    if mu <= 0.0:
        p[0], p[1], p[2] = -g / (W[0, 0] + S), -o1, -o2
        return True
    p0, p1, p2 = solve_symmetric_3(
        W[0, 0] + S,
        W[1, 1] + parameters[0].softness[1],
        W[2, 2] + parameters[0].softness[2],
        W[0, 1],
        W[0, 2],
        W[1, 2],
        b - w0[0],
        parameters[0].target[1] - w0[1],
        parameters[0].target[2] - w0[2],
    )
    P0, P1, P2 = p0 + o0, p1 + o1, p2 + o2
    if P0 >= 0.0 and mu * mu * P0 * P0 >= P1 * P1 + P2 * P2:
        p[0], p[1], p[2] = p0, p1, p2
        return True
    return False


class ContactSolvers(Table):
    """What solves the contacts of a scene, compiled by itself: one kind."""


class NonsmoothNewton(Arrays):
    """The solver of this file; it has nothing of its own."""


@generic("contact")
def solve_contacts(solvers: ContactSolvers, problem: Problem) -> None:
    """Impulses and velocities of a problem.

    Notes
    -----
    The status of the solution is BY_NEWTON, BY_PROXIMAL_STEPS or BY_GAUSS_SEIDEL, or FAILED: then the impulses are no
    solution. Iterations are linear systems solved; of contacts that do not act on each other a mean, weighted by their
    number. The residual is the largest violation of the laws by a contact, as a
    rate, relative to the largest rate without impulses or by them.
    """


@implement(solve_contacts, NonsmoothNewton)
@kernel(internal=True)
def solve_by_newton(solver: NonsmoothNewton, problem: Problem) -> None:
    """A single contact often has a simple solution."""
    solution, count, start, B = problem.solution, problem.counts.number, problem.start, problem.B
    solution.status, solution.iterations, solution.residual = BY_NEWTON, 0, 0.0
    solution.effort = 0.0
    if count == 0:
        for i in range(problem.counts.size):
            problem.y[i] = start[i]
        return
    alone = problem.ends.shape[0] == 0 and count == 1 and problem.kinds[0].kind == UNILATERAL
    if alone and _solve_one(problem.kinds, problem.parameters, start, B, problem.p):
        for i in range(3):
            problem.y[i] = start[i] + B[i, 0] * problem.p[0] + B[i, 1] * problem.p[1] + B[i, 2] * problem.p[2]
        return
    status, iterations, residual = _solve(problem)
    solution.status, solution.iterations, solution.residual = status, iterations, residual
