"""Solver of all contacts at once: impulses that satisfy complementarity and Coulomb's law on given bodies.

Semi-smooth Newton method on the laws of P. Alart and A. Curnier (Comput. Methods Appl. Mech. Eng. 92 (1991)), true
cone of Coulomb, without association of slip and opening. The linear systems have the size of the touched velocities,
so the cost of many contacts on few bodies grows with their number only linearly; contacts that press on the same
bodies more often than needed share by their softness. Where the method does not converge, proximal steps follow.
Nothing is accepted by less than its residual; what
remains without a solution comes back as failed, with impulses that at least push and stay in their cones.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records
from heavylift.numerics.small import solve_symmetric_3
from heavylift.solver.contact.contact_rows import clip
from heavylift.solver.contact.fallback_gauss_seidel import sweep_contacts
from heavylift.solver.contact.fallback_proximal import take_proximal_steps
from heavylift.solver.contact.iteration import ACCEPTED, iterate
from heavylift.solver.contact.layout import (
    UNILATERAL,
    RowKind,
    RowParameters,
    Solution,
)
from heavylift.solver.contact.problem import (
    Problem,
    divide,
    fill_rows,
    prepare,
    workspace_length,
)
from heavylift.solver.contact.system import gather, multiply
from heavylift.solver.kinds import Table, generic, implement

__all__ = [
    "BY_GAUSS_SEIDEL",
    "BY_NEWTON",
    "BY_PROXIMAL_STEPS",
    "FAILED",
    "ContactSolvers",
    "NonsmoothNewton",
    "solve_contacts",
    "workspace_length",
]

BY_NEWTON, BY_PROXIMAL_STEPS, BY_GAUSS_SEIDEL = range(3)
FAILED = -1

LIMITS = (25, 20, 30, 60, 40, 25, 100, 60, 60)
FALLS = (1.0, 0.1, 0.3, 0.1, 0.5, 0.03, 0.5, 0.3, 0.1)
GROWTHS = (1.0, 3.0, 10.0, 2.0, 2.0, 5.0, 4.0, 30.0, 2.0)
"""Iterations of Newton's method in the first attempt; in the others for a proximal step, and how its size changes.

Each of the others misses a few of 1000 problems with wedged contacts, but not the same ones.
"""

FROM_SWEEPS = 6
"""Attempt that is preceded by sweeps over the contacts, and from which on attempts begin with what those have left."""


@kernel(internal=True)
def _solve(
    problem: Problem, workspace: NDArray[np.float64], p: NDArray[np.float64], out: NDArray[np.float64]
) -> tuple[int, int, float]:
    """Solve by Newton's method, then by proximal steps from the given impulses and from none; out: velocities."""
    n = 3 * problem.number
    work = divide(problem, workspace)
    prepare(problem, work)
    for i in range(n):
        if not abs(work.w0[i]) < np.inf:  # the bodies themselves have been lost before
            for j in range(problem.size):
                out[j] = problem.start[j]
            return FAILED, 0, np.inf
        if not abs(p[i]) < np.inf:
            p[i] = 0.0
        work.begin[i] = p[i]
    fill_rows(problem, work, 0.0, work.begin)
    status, found, total, residual = BY_NEWTON, False, 0, np.inf
    for attempt in range(len(LIMITS)):
        if attempt == FROM_SWEEPS:
            fill_rows(problem, work, 0.0, work.begin)
            found, iterations, residual = sweep_contacts(problem, work, p)
            total += iterations
            if found:
                status = BY_GAUSS_SEIDEL
                break
            for i in range(n):
                work.begin[i] = p[i]
        if attempt == 0:
            found, iterations, after = iterate(problem, work, p, LIMITS[attempt], ACCEPTED)
        else:
            from_none = 1 < attempt < FROM_SWEEPS
            for i in range(n):
                p[i] = 0.0 if from_none else work.begin[i]
            found, iterations, after = take_proximal_steps(
                problem, work, p, LIMITS[attempt], FALLS[attempt], GROWTHS[attempt]
            )
        total += iterations
        if found:
            status, residual = BY_NEWTON if attempt == 0 else BY_PROXIMAL_STEPS, after
            break
    if not found:  # impulses of the sweeps push at least
        status = FAILED
        for i in range(n):
            p[i] = work.begin[i]
    for c in range(problem.number):
        clip(problem.kinds, problem.parameters, c, p)
    gather(problem.number, problem.ends, problem.blocks, problem.size, p, 3, work.z)
    multiply(problem.size, problem.B, work.z, out)
    for i in range(problem.size):
        out[i] += problem.start[i]
    return status, total, residual


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
def solve_contacts(
    solvers: ContactSolvers,
    count: int,
    kinds: Records[RowKind],
    parameters: Records[RowParameters],
    ends: Ints2,
    blocks: Floats2,
    size: int,
    y0: Floats1,
    B: Floats2,
    p: Floats1,
    y: Floats1,
    workspace: Floats1,
    solution: Solution,
) -> None:
    """Impulses of contacts on bodies: ``w = N y``, ``y = y0 + B N^T p``.

    Parameters
    ----------
    solvers
        One kind.
    count
        Contacts.
    kinds, parameters
        See the layout; `count` of them or more.
    ends
        Per contact first velocity and number of velocities, up to 6, of its first and of its second end, shape
        (count, 4); number 0: no such end. Of length 0: N is the identity, and velocities are the rates of the rows.
    blocks
        Rows of N per contact, shape (count, 36): three rows of stride 6 of the first end, then of the second.
    size
        Touched velocities, or rows.
    y0, B
        Velocities without impulses, (size,), and their symmetric positive semidefinite inverse mass, (size, size);
        larger arrays: their first part.
    p
        In: impulses to begin with, those of the step before or zeros. Out: the solution, (3 count,).
    y
        Out: velocities, (size,).
    workspace
        At least ``workspace_length(count, size)`` numbers.
    solution
        Out: status (BY_NEWTON, BY_PROXIMAL_STEPS, BY_GAUSS_SEIDEL: solved; FAILED: p is no solution), number of
        linear systems solved, and largest violation of the laws by a contact, as a rate, relative to the largest of w
        without impulses or by them.
    """


@implement(solve_contacts, NonsmoothNewton)
@kernel(internal=True)
def solve_by_newton(
    solver: NonsmoothNewton,
    count: int,
    kinds: Records[RowKind],
    parameters: Records[RowParameters],
    ends: NDArray[np.int64],
    blocks: NDArray[np.float64],
    size: int,
    y0: NDArray[np.float64],
    B: NDArray[np.float64],
    p: NDArray[np.float64],
    y: NDArray[np.float64],
    workspace: NDArray[np.float64],
    solution: Solution,
) -> None:
    """A single contact often has a simple solution."""
    solution.status, solution.iterations, solution.residual = BY_NEWTON, 0, 0.0
    if count == 0:
        for i in range(size):
            y[i] = y0[i]
        return
    alone = ends.shape[0] == 0 and count == 1 and kinds[0].kind == UNILATERAL
    if alone and _solve_one(kinds, parameters, y0, B, p):
        for i in range(3):
            y[i] = y0[i] + B[i, 0] * p[0] + B[i, 1] * p[1] + B[i, 2] * p[2]
        return
    problem = Problem(count, kinds, parameters, ends, blocks, size, y0, B)
    status, iterations, residual = _solve(problem, workspace, p, y)
    solution.status, solution.iterations, solution.residual = status, iterations, residual
