"""Settle: let a scene sink to a stable position of balance under all its loads, in a motion without inertia.

Each step holds the scene where it is by a stiffness per mass ``s``, and finds the balance with that by Newton's
method::

    R(x) = s D (x - x0),    D = diag M

That is an implicit Euler step of the flow ``D dx/dt = R(x)`` over ``1/s`` (R. T. Rockafellar's proximal point
method, SIAM J. Control and Optimization 14, 1976): it goes downhill whatever its length, round bends and
mechanisms too, and turns into Newton's method as ``s`` vanishes.
"""

from __future__ import annotations

import numpy as np

from heavylift.solver.statics.newton import STILL, Progress, correct, push, stiffness
from heavylift.solver.statics.problem import StaticProblem, measure

__all__ = ["settle"]

STEPS = 400
FIRST_MOVE, FARTHEST = 0.2, 2.0
"""Displacement that the first step may promise, in units of a large one; how far any may lead beyond its promise."""

LOOSE = 1e-2
"""Residual of a step that is on its way."""

PATIENCE = 10
"""Most iterations of a step."""

DIRECT = 0.25
"""Displacement, in units of a large one, from which Newton's method alone is tried."""

SLOW = 0.02
"""Displacement of a step below which the scene may creep towards a saddle, where balance is unstable."""

PUSHES, PUSH = 10, 0.03
RUNAWAY = 150.0
"""Way in units of a large displacement beyond which nothing seems to hold the scene."""


def settle(problem: StaticProblem, progress: Progress, factor: float = 1.0) -> bool:
    """Find a stable position of balance at one load factor; returns whether there is one in reach.

    Parameters
    ----------
    problem
        Its position changes, whatever the outcome.
    progress
        Reactions to begin with; takes what was found.
    factor
        Of the loads.
    """
    progress.factor = factor
    for attempt in range(PUSHES + 1):
        if not _sink(problem, progress, factor):
            return False
        if not push(problem, progress, PUSH * (attempt + 1)):
            return True
    return False


def _sink(problem: StaticProblem, progress: Progress, factor: float) -> bool:
    """Steps until Newton's method finds a balance, stable or not."""
    now = measure(problem, factor, progress.multipliers)
    pull = now.force / problem.mass.diagonal() / problem.scale
    shift = stiffness(problem, progress)[2]
    hold = max(float(np.abs(pull).max(initial=0.0)) / FIRST_MOVE, shift)
    way, moved, pushes, shrink, arrived, enough = 0.0, np.inf, 0, 0.2, True, LOOSE
    for _ in range(STEPS):
        if moved <= SLOW and pushes < PUSHES and push(problem, progress, PUSH * (pushes + 1)):
            pushes += 1
        before = problem.snapshot(), progress.multipliers
        if arrived:  # else it has been tried from here
            if correct(problem, progress, factor, most=DIRECT, farthest=4.0, firm=True):
                return True
            problem.restore(before[0])
            progress.multipliers = before[1]
        used = progress.iterations
        arrived = correct(
            problem,
            progress,
            factor,
            anchor=hold,
            farthest=FARTHEST,
            tolerance=enough,
            patience=PATIENCE,
            firm=True,  # a step that begins where the stiffness is not positive leads nowhere: a shorter one is tried
        )
        if arrived and progress.iterations == used:  # nothing was done
            enough *= 0.1
        if arrived:
            progress.steps += 1
            moved = progress.promised
            if hold <= shift and moved <= STILL:  # held by next to nothing, and it does not move
                progress.rounded = True
                return True
            way += moved
            hold = max(hold * (shrink if moved < 0.5 else 0.5), shift)
            shrink = 0.5 * (shrink + 0.2)
            continue
        problem.restore(before[0])
        progress.multipliers = before[1]
        hold *= 4.0
        shrink = 0.8
        moved = np.inf
        if not np.isfinite(hold) or way > RUNAWAY:
            return False
    return False
