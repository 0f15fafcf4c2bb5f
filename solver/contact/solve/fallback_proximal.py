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
from heavylift.solver.contact.solve.iteration import ACCEPTED, iterate, measure
from heavylift.solver.contact.solve.problem import fill_rows

__all__ = ["share_redundant", "take_proximal_steps"]

ROUGH = 1e-9
"""Residual of a step, relative."""

STEPS = 100
PATIENCE = 4
"""Steps between attempts at the problem itself."""

SMALLEST = 1e-4
"""tau over W below which every step is followed by an attempt."""


SHARING = 0.1
"""tau over W of the first step: what bears more than once is then shared without stress of its own."""

SHARINGS, OF_A_SHARING = 60, 15
"""Steps, and iterations of Newton's method for one of them."""

SHARED = 1e-7
"""Residual over the rate that matters (`ProblemSize.least_rate`) where steps gain nothing more: targets that no
impulses without such stress fulfil. A gap moves by no more than what gaps are found to."""

SHARED_OF_FREE, STALLED_OF_FREE = 2e-5, 1e-2
"""The same over the largest rate of a step without impulses (`ProblemSize.free_rate`), whichever is less: in short
steps weights make no rates that matter, and are to be borne all the same. The second one after `STALLS` steps in a row
have gained nothing."""

STALLS = 6

ALONE = 10.0
"""tau over W up to which a step is tried: there each contact stands almost for itself."""


@kernel(internal=True)
def share_redundant(
    problem: Problem, work: Work, p: NDArray[np.float64], most: int
) -> tuple[bool, int, float]:
    """Solve contacts that bear the same load more than once by proximal steps of one small tau.

    Rates and targets of such contacts fit each other but for rounding and terms of second order. With a softness of
    1e-9 these become impulses 1e9 times as large, which press contacts against each other up to the bounds of their
    friction: hard to find, and without meaning. A step with a larger tau spreads the load instead, and steps from there
    take away what tau itself does to it, which in directions without redundancy falls by about tau a step.

    Parameters
    ----------
    problem, work
        With the diagonal filled in.
    p
        Impulses to begin with, replaced.
    most
        Iterations of all steps, about.

    Returns
    -------
    found, iterations, residual
        As of `iterate`; found also if steps gain nothing more at a residual that `SHARED` allows.
    """
    start, past = 3 * problem.counts.first, 3 * problem.counts.last
    shared, stalled, stalls = 0.0, 0.0, 0
    if work.marks.scale > 0.0:
        matters, free = SHARED * problem.counts.least_rate, problem.counts.free_rate
        shared = min(matters, SHARED_OF_FREE * free) / work.marks.scale
        stalled = min(matters, STALLED_OF_FREE * free) / work.marks.scale
    total, before, residual, tau = 0, np.inf, np.inf, SHARING
    kept = work.kept
    for i in range(start, past):
        kept[i] = p[i]
    for _ in range(SHARINGS):
        if total >= most:
            break
        fill_rows(problem, work, tau, kept)
        found, iterations, _ = iterate(problem, work, p, OF_A_SHARING, ROUGH)
        total += iterations
        if not found:
            if tau >= ALONE:
                return False, total, np.inf
            tau *= 10.0
            for i in range(start, past):
                p[i] = kept[i]
            continue
        fill_rows(problem, work, 0.0, kept)
        before, residual = residual, measure(problem, work, p)
        for i in range(start, past):
            kept[i] = p[i]
        gains = residual < 0.5 * before
        stalls = 0 if gains else stalls + 1
        allowed = 0.0 if gains else (shared if stalls < STALLS else stalled)
        if residual <= max(ACCEPTED, allowed):
            found, iterations, after = iterate(problem, work, p, OF_A_SHARING, ACCEPTED)
            total += iterations
            if found:
                return True, total, after
            for i in range(start, past):
                p[i] = kept[i]
            return True, total, residual
        tau *= 0.2 if gains else 0.5
    return residual <= stalled, total, residual


@kernel(internal=True)
def take_proximal_steps(
    problem: Problem,
    work: Work,
    p: NDArray[np.float64],
    limits: tuple[int, int],
    fall: float,
    growth: float,
) -> tuple[bool, int, float]:
    """Solve the contacts by proximal steps.

    Parameters
    ----------
    problem, work
        With the diagonal filled in.
    p
        Impulses to begin with, replaced by the solution or, if none is found, by the last step.
    limits
        Iterations for a step, and of all steps, about.
    fall, growth
        Factors of tau after a success and after a failure.

    Returns
    -------
    found, iterations, residual
        As of `iterate`; iterations of all steps.
    """
    start, past = 3 * problem.counts.first, 3 * problem.counts.last
    tau, total, residual = 1.0, 0, np.inf
    kept = work.kept
    for i in range(start, past):
        kept[i] = p[i]
    limit, most = limits
    for step in range(STEPS):
        if total >= most:
            break
        fill_rows(problem, work, tau, kept)
        found, iterations, _ = iterate(problem, work, p, limit, ROUGH)
        total += iterations
        if found:
            tau *= fall
            for i in range(start, past):
                kept[i] = p[i]
        else:
            tau *= growth
            for i in range(start, past):
                p[i] = kept[i]
        if step % PATIENCE == PATIENCE - 1 or tau < SMALLEST:
            fill_rows(problem, work, 0.0, kept)
            found, iterations, residual = iterate(problem, work, p, limit, ACCEPTED)
            total += iterations
            if found:
                return True, total, residual
            for i in range(start, past):
                p[i] = kept[i]
    return False, total, residual
