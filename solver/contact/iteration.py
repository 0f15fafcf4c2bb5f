"""Newton's method for all contacts at once.

Impulses are kept and corrected, not computed from rates: with a softness of 1e-7 of the inverse masses ``(b - w)/S``
would amplify the rounding of w to 1e-9 of the impulses. Full steps are taken. Where they do not lead to a solution, a
search along them does not either: it stops at kinks of the laws.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel, view
from heavylift.solver.contact.contact_rows import (
    D00,
    D10,
    D11,
    D12,
    D20,
    D21,
    D22,
    R0,
    R1,
    R2,
    RECORD,
    ROWS,
    linearise,
)
from heavylift.solver.contact.layout import COMPLIANT, OFFSET, SOFTNESS, TARGET
from heavylift.solver.contact.system import (
    COUPLING,
    END,
    SCRATCH,
    assemble,
    assemble_rows,
    factor,
    gather,
    multiply,
    solve_factored,
    spread,
)

__all__ = [
    "ACCEPTED",
    "Problem",
    "Work",
    "divide",
    "fill_rows",
    "find_diagonal",
    "iterate",
    "measure",
    "workspace_length",
]

ACCEPTED = 1e-10
"""Residual of a solution, relative to the largest rate without impulses or change of rate by them."""

REFINED = 1e-8
"""A correction smaller than this part of the impulses is the last one: the next is smaller by a factor like that."""

NO_GAIN = 1e-13
"""Residual below which a correction that gains nothing is taken for rounding, relative as above."""

REFINEMENTS = 6
"""Most corrections of an accepted solution."""

ROUNDING = 1e-15
"""Residual that rounding leaves, relative to W times the largest impulse."""


class Problem(NamedTuple):
    """Contacts and what they touch; arrays as in the entry points."""

    number: int
    kinds: NDArray[np.int64]
    parameters: NDArray[np.float64]
    ends: NDArray[np.int64]
    blocks: NDArray[np.float64]
    size: int
    start: NDArray[np.float64]
    B: NDArray[np.float64]


class Work(NamedTuple):
    """Parts of the workspace."""

    diagonal: NDArray[np.float64]  # (2 count,): W of the normal, mean of the tangents
    inverse: NDArray[np.float64]  # (2 count,): r of the laws
    rows: NDArray[np.float64]  # (6 count,)
    records: NDArray[np.float64]  # (10 count,)
    held: NDArray[np.float64]  # (7 count + SCRATCH,)
    w0: NDArray[np.float64]  # (3 count,)
    w: NDArray[np.float64]  # (3 count,)
    dw: NDArray[np.float64]  # (3 count,)
    best: NDArray[np.float64]  # (3 count,)
    kept: NDArray[np.float64]  # (3 count,)
    begin: NDArray[np.float64]  # (3 count,)
    z: NDArray[np.float64]  # (size,)
    y: NDArray[np.float64]  # (size,)
    x: NDArray[np.float64]  # (size,)
    pivots: NDArray[np.float64]  # (size,)
    active: NDArray[np.float64]  # (size,)
    K: NDArray[np.float64]  # (size^2,), empty without blocks
    A: NDArray[np.float64]  # (size^2,)


@kernel
def workspace_length(count: int, size: int) -> int:
    """Numbers that the solver needs as workspace.

    Parameters
    ----------
    count
        Contacts.
    size
        Touched velocities; three times the contacts for `solve_contacts`.
    """
    return 45 * count + SCRATCH + 5 * size + 2 * size * size


@view
def divide(problem: Problem, workspace: NDArray[np.float64]) -> Work:
    """Parts of the workspace."""
    n, m = problem.number, problem.size
    held = 38 * n
    vectors = held + COUPLING * n + SCRATCH
    squares = vectors + 5 * m
    return Work(
        workspace[: 2 * n],
        workspace[2 * n : 4 * n],
        workspace[4 * n : 10 * n],
        workspace[10 * n : 20 * n],
        workspace[held:vectors],
        workspace[20 * n : 23 * n],
        workspace[23 * n : 26 * n],
        workspace[26 * n : 29 * n],
        workspace[29 * n : 32 * n],
        workspace[32 * n : 35 * n],
        workspace[35 * n : 38 * n],
        workspace[vectors : vectors + m],
        workspace[vectors + m : vectors + 2 * m],
        workspace[vectors + 2 * m : vectors + 3 * m],
        workspace[vectors + 3 * m : vectors + 4 * m],
        workspace[vectors + 4 * m : squares],
        workspace[squares : squares + m * m],
        workspace[squares + m * m : squares + 2 * m * m],
    )


@kernel(internal=True, reassociate=True)
def find_diagonal(problem: Problem, work: Work) -> None:
    """Write the diagonal of W of each contact, for N a bound of it from the diagonal of B, and the rates without p."""
    count, ends, blocks, B = problem.number, problem.ends, problem.blocks, problem.B
    for c in range(count):
        n = t = 0.0
        if ends.shape[0] == 0:
            n = B[3 * c, 3 * c]
            t = 0.5 * (B[3 * c + 1, 3 * c + 1] + B[3 * c + 2, 3 * c + 2])
        else:
            for end in range(2):
                first, o, width = ends[c, 2 * end], END * end, ends[c, 2 * end + 1]
                if width == 6:  # unrolled
                    for j in range(6):
                        n0, n1, n2 = blocks[c, o + j], blocks[c, o + 6 + j], blocks[c, o + 12 + j]
                        n += n0 * n0 * B[first + j, first + j]
                        t += (n1 * n1 + n2 * n2) * B[first + j, first + j]
                else:
                    for j in range(width):
                        n0, n1, n2 = blocks[c, o + j], blocks[c, o + 6 + j], blocks[c, o + 12 + j]
                        n += n0 * n0 * B[first + j, first + j]
                        t += (n1 * n1 + n2 * n2) * B[first + j, first + j]
            t *= 0.5
        work.diagonal[2 * c] = n if n > 0.0 else 1.0
        work.diagonal[2 * c + 1] = t if t > 0.0 else 1.0
    spread(count, ends, blocks, problem.size, problem.start, work.w0)


@kernel(internal=True)
def fill_rows(problem: Problem, work: Work, factor_of_diagonal: float, near: NDArray[np.float64]) -> None:
    """Write softness and target of all rows, with a further softness relative to the diagonal about impulses `near`."""
    parameters, rows = problem.parameters, work.rows
    for c in range(problem.number):
        for i in range(3):
            more = factor_of_diagonal * work.diagonal[2 * c + min(i, 1)]
            S, b = parameters[c, SOFTNESS + i], parameters[c, TARGET + i]
            if i == 0 and problem.kinds[c, 0] == COMPLIANT:
                S = b = 0.0
            rows[ROWS * c + i] = S + more
            rows[ROWS * c + 3 + i] = b + (more * near[3 * c + i] if more > 0.0 else 0.0)
        work.inverse[2 * c] = 1.0 / (work.diagonal[2 * c] + rows[ROWS * c])
        work.inverse[2 * c + 1] = 1.0 / (
            work.diagonal[2 * c + 1] + 0.5 * (rows[ROWS * c + 1] + rows[ROWS * c + 2])
        )


@kernel(internal=True)
def _evaluate(problem: Problem, work: Work, p: NDArray[np.float64]) -> tuple[float, float]:
    """Find rates and linearised laws; returns the largest residual of a contact and what it is measured by."""
    count, size = problem.number, problem.size
    w, w0, start = work.w, work.w0, problem.start
    if problem.ends.shape[0] == 0:
        multiply(size, problem.B, p, w)
        for i in range(size):
            w[i] += start[i]
    else:
        y = work.y
        gather(count, problem.ends, problem.blocks, size, p, 3, work.z)
        multiply(size, problem.B, work.z, y)
        for i in range(size):
            y[i] += start[i]
        spread(count, problem.ends, problem.blocks, size, y, w)
    worst, largest, scale = 0.0, 0.0, 0.0
    finite = True
    for c in range(count):
        square = linearise(
            problem.kinds,
            problem.parameters,
            work.rows,
            c,
            p,
            w,
            work.inverse[2 * c],
            work.inverse[2 * c + 1],
            work.records,
            RECORD * c,
        )
        worst = max(worst, square)
        finite = finite and square < np.inf
        i = 3 * c
        v0, v1, v2 = w0[i], w0[i + 1], w0[i + 2]
        scale = max(scale, abs(v0), abs(v1), abs(v2), abs(w[i] - v0), abs(w[i + 1] - v1), abs(w[i + 2] - v2))
        largest = max(
            largest,
            abs(p[i]) * work.diagonal[2 * c],
            max(abs(p[i + 1]), abs(p[i + 2])) * work.diagonal[2 * c + 1],
        )
        o = problem.parameters[c]  # what the step has given before counts like what is asked for now
        scale = max(scale, abs(o[OFFSET]) * work.diagonal[2 * c])
        scale = max(scale, max(abs(o[OFFSET + 1]), abs(o[OFFSET + 2])) * work.diagonal[2 * c + 1])
    if not finite:
        return np.inf, scale
    return math.sqrt(worst), max(scale, ROUNDING / ACCEPTED * largest)


@kernel(internal=True)
def measure(problem: Problem, work: Work, p: NDArray[np.float64]) -> float:
    """Residual of impulses, relative as that of a solution."""
    residual, scale = _evaluate(problem, work, p)
    return residual / scale if scale > 0.0 else residual


@kernel(internal=True)
def _correct(problem: Problem, work: Work, p: NDArray[np.float64], fresh: bool) -> float:
    """Add a step of Newton's method to p; returns its largest size over that of p, weighted by W; below zero: none."""
    count, size = problem.number, problem.size
    records, dw, x = work.records, work.dw, work.x
    if problem.ends.shape[0] == 0:
        n = assemble_rows(count, size, problem.B, records, work.A, work.active, x)
        if not factor(n, work.A, work.pivots):
            return -1.0
        solve_factored(n, work.A, work.pivots, x)
        for c in range(count):
            for i in range(3):
                dw[3 * c + i] = records[RECORD * c + R0 + i]
        for i in range(n):
            dw[int(work.active[i])] = x[i]
    else:
        if assemble(
            count, problem.ends, problem.blocks, size, problem.B, records, work.held, work.K, work.A, fresh
        ) and not factor(size, work.A, work.pivots):
            return -1.0
        gather(count, problem.ends, problem.blocks, size, records, RECORD, x)
        solve_factored(size, work.A, work.pivots, x)
        multiply(size, problem.B, x, work.y)
        spread(count, problem.ends, problem.blocks, size, work.y, dw)
        for c in range(count):
            a = RECORD * c
            u0, u1, u2 = dw[3 * c], dw[3 * c + 1], dw[3 * c + 2]
            dw[3 * c] = records[a + R0] - records[a + D00] * u0
            dw[3 * c + 1] = (
                records[a + R1] - records[a + D10] * u0 - records[a + D11] * u1 - records[a + D12] * u2
            )
            dw[3 * c + 2] = (
                records[a + R2] - records[a + D20] * u0 - records[a + D21] * u1 - records[a + D22] * u2
            )
    step, largest = 0.0, 0.0
    for c in range(count):
        i = 3 * c
        d0, d1, d2 = dw[i], dw[i + 1], dw[i + 2]
        p0, p1, p2 = p[i] + d0, p[i + 1] + d1, p[i + 2] + d2
        p[i], p[i + 1], p[i + 2] = p0, p1, p2
        normal, tangent = work.diagonal[2 * c], work.diagonal[2 * c + 1]
        step = max(step, abs(d0) * normal, max(abs(d1), abs(d2)) * tangent)
        largest = max(largest, abs(p0) * normal, max(abs(p1), abs(p2)) * tangent)
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
        Residual of a solution, relative to the rates; ACCEPTED: go on from there to the limit of rounding.

    Returns
    -------
    found
        The residual is small enough.
    iterations
        Systems solved.
    residual
        Relative.
    """
    for i in range(work.held.shape[0]):
        work.held[i] = 0.0
    for i in range(work.K.shape[0]):
        work.K[i] = 0.0
    best, step, refinements = np.inf, np.inf, 0
    iteration, relative = 0, np.inf
    while True:
        residual, scale = _evaluate(problem, work, p)
        relative = residual / scale if scale > 0.0 else residual
        if relative <= accepted and (accepted > ACCEPTED or step <= REFINED):
            return True, iteration, relative
        if relative <= accepted and relative < best:
            gain = relative < 0.5 * best
            best = relative
            for i in range(3 * problem.number):
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
        for i in range(3 * problem.number):
            p[i] = work.best[i]
        return True, iteration, best
    return False, iteration, relative
