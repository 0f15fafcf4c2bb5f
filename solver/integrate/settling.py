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

from heavylift.solver.integrate.static_newton import Progress, correct, push, stiffness
from heavylift.solver.integrate.static_problem import StaticProblem, measure

__all__ = ["settle"]

STEPS = 400
FIRST_MOVE, MOST = 0.2, 2.0
"""Displacement that the first step may promise, and how far any may lead, in units of a large one."""

LOOSE = 1e-4
"""Residual of a step that is on its way."""

DIRECT = 0.05
"""Displacement, in units of a large one, below which Newton's method alone is tried."""

PUSHES, PUSH = 8, 0.03
RUNAWAY = 40.0
"""Way in lengths of the scene beyond which nothing seems to hold it."""


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
    """Steps until Newton's method finds the balance."""
    now = measure(problem, factor, progress.multipliers)
    mass = problem.mass.diagonal()
    pull = now.force / mass / problem.scale
    hold = float(np.abs(pull).max(initial=0.0)) / FIRST_MOVE
    K, _, shift = stiffness(problem, progress)
    del K
    hold = max(hold, shift)
    went, way = np.zeros(problem.count), 0.0
    for _ in range(STEPS):
        before = problem.snapshot()
        if correct(problem, progress, factor, most=DIRECT, farthest=4.0):
            return True
        problem.restore(before)
        hold = max(shift, hold)
        if correct(problem, progress, factor, anchor=hold, farthest=MOST, tolerance=LOOSE, patience=10):
            progress.steps += 1
            way += progress.promised
            hold *= 0.2 if progress.promised < 0.5 else 0.5
            continue
        problem.restore(before)
        hold *= 5.0
        if not np.isfinite(hold) or way * float(np.min(problem.scale)) > RUNAWAY * problem.length:
            return False
    del went
    return False
