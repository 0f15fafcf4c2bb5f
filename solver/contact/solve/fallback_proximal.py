"""Solution of contacts where Newton's method finds none from the start: proximal steps.

Every step solves the problem with a further softness tau about the impulses q of the step before::

    w + (S + tau) p - (b + tau q)

in place of ``w + S p - b``. That is an implicit step of ``dp/ds = -(w + S p - b)`` on the cones: for a large tau it has
one solution, and Newton's method finds it; where the flow rests, the problem itself is solved. tau falls after a
success and grows after a failure (as in the pseudo-transient continuation of C. T. Kelley and D. E. Keyes, SIAM J.
Numer. Anal. 35 (1998)). A reduction of the softness alone ends where a branch of solutions turns back; this does not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.contact.layout import Problem, Work
from heavylift.solver.contact.solve.iteration import ACCEPTED, iterate
from heavylift.solver.contact.solve.problem import fill_rows

__all__ = ["take_proximal_steps"]

ROUGH = 1e-9
"""Residual of a step, relative."""

STEPS = 100
PATIENCE = 4
"""Steps between attempts at the problem itself."""

SMALLEST = 1e-4
"""tau over W below which every step is followed by an attempt."""


@kernel(internal=True)
def take_proximal_steps(
    problem: Problem, work: Work, p: NDArray[np.float64], limit: int, fall: float, growth: float
) -> tuple[bool, int, float]:
    """Solve the contacts by proximal steps.

    Parameters
    ----------
    problem, work
        With the diagonal filled in.
    p
        Impulses to begin with, replaced by the solution or, if none is found, by the last step.
    limit
        Iterations for a step.
    fall, growth
        Factors of tau after a success and after a failure.

    Returns
    -------
    found, iterations, residual
        As of `iterate`; iterations of all steps.
    """
    n = 3 * problem.counts.number
    tau, total, residual = 1.0, 0, np.inf
    kept = work.kept
    for i in range(n):
        kept[i] = p[i]
    for step in range(STEPS):
        fill_rows(problem, work, tau, kept)
        found, iterations, _ = iterate(problem, work, p, limit, ROUGH)
        total += iterations
        if found:
            tau *= fall
            for i in range(n):
                kept[i] = p[i]
        else:
            tau *= growth
            for i in range(n):
                p[i] = kept[i]
        if step % PATIENCE == PATIENCE - 1 or tau < SMALLEST:
            fill_rows(problem, work, 0.0, kept)
            found, iterations, residual = iterate(problem, work, p, limit, ACCEPTED)
            total += iterations
            if found:
                return True, total, residual
            for i in range(n):
                p[i] = kept[i]
    return False, total, residual
