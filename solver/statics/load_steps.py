"""Load steps: loads grow from nothing, and the scene follows along positions of balance.

A step is as long as the stiffness at its beginning allows. One that does not converge, or that leads much farther
than its beginning promised, is shortened: at a limit point the scene would jump, and steps come to an end.
"""

from __future__ import annotations

from heavylift.solver.statics.newton import BALANCED, CLOSED, ROUNDED, Progress, correct
from heavylift.solver.statics.problem import StaticProblem, measure

__all__ = ["follow_load", "promise"]

SMALLEST_STEP = 1e-3
"""Relative to the first step, or to the load factor at hand if that is larger."""

FIRST_MOVE = 0.2
"""Largest displacement that the first step may promise, in units of a large one."""

MOST = 0.5
"""Largest displacement that any step may promise."""

ON_THE_WAY = 1e-5
"""Residual of steps before the last."""

GROWTH = ((4, 8.0), (6, 4.0), (8, 2.0), (10, 1.0), (1000, 0.5))
"""Iterations of a step, and by what the next one is longer."""

JUMP = 2.5
"""A step that leads so much farther than promised is one over a limit point."""


def promise(problem: StaticProblem, progress: Progress, target: float = 1.0) -> float:
    """Displacement that the stiffness at hand promises for a load factor, in units of a large one."""
    before = problem.snapshot()
    correct(problem, progress, target, most=0.0)
    problem.restore(before)
    return progress.promised


def follow_load(problem: StaticProblem, progress: Progress, target: float = 1.0) -> bool:
    """Bring the load factor to a target in steps; returns whether it was reached.

    Parameters
    ----------
    problem
        On failure it is left at the last good factor.
    progress
        Load factor and reactions to begin with; takes what was found.
    target
        Load factor.
    """
    now = measure(problem, progress.factor, progress.multipliers)
    loads = measure(problem, target, progress.multipliers).weight
    nothing = now.weight == 0.0 or now.residual * now.weight <= ROUNDED * loads
    if not (nothing and now.gap_size <= CLOSED) and not correct(problem, progress, progress.factor):
        return False
    whole = target - progress.factor
    step, first = whole, 0.0
    while progress.factor != target:
        goal = progress.factor + step
        if abs(goal - target) < 1e-3 * abs(step) or abs(goal - progress.factor) > abs(
            target - progress.factor
        ):
            goal = target
        before, used = problem.snapshot(), progress.iterations
        most = MOST if first else FIRST_MOVE
        enough = BALANCED if goal == target else ON_THE_WAY
        if correct(problem, progress, goal, most=most, farthest=JUMP, tolerance=enough):
            first = first or abs(step)
            progress.steps += 1
            easy = progress.iterations - used
            step *= next(more for most_of, more in GROWTH if easy <= most_of)
            continue
        problem.restore(before)
        step = goal - progress.factor
        step *= max(0.5 * most / progress.promised, 1e-9) if progress.promised > most else 0.3
        if abs(step) < SMALLEST_STEP * max(first, abs(progress.factor)) or abs(step) < 1e-14 * abs(whole):
            return False
    return True
