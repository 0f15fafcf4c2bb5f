"""Newton's method for a position of balance at one load factor.

Steps are whole ones, uphill too: stiff bodies that turn stretch for a moment, and a search that forbids it would
creep. Where the stiffness is not positive along what the joints allow, it is damped by a multiple of the mass
(K. Levenberg, Q. Appl. Math. 2, 1944), so that searches keep to positions that can be stable.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.statics.problem import (
    Balance,
    Factor,
    StaticProblem,
    factorise,
    measure,
    rounding_floor,
    stability_shift,
    unstable_count,
)

__all__ = [
    "BALANCED",
    "CLOSED",
    "NOISE",
    "ROUNDED",
    "STEADY",
    "STILL",
    "Progress",
    "correct",
    "large",
    "push",
    "stiffness",
]

BALANCED = 1e-8
"""Residual relative to the loads that counts as equilibrium; iterations continue below it while they help."""

POLISHED = 1e-11
CLOSED = 1e-10
"""Gap of the joints relative to the length of the scene."""

STILL = 1e-12
"""Displacement, in units of a large one, that rounding alone makes; then a residual of `ROUNDED` will do."""

ROUNDED = 1e-5
"""Residual relative to the loads that rounding may leave where nothing moves any more."""

NOISE = 1e-2
"""The same where it is within the rounding of the forces: small loads on what is thin and stiff in its plane."""

STEADY = 1e-6
"""Displacement relative to that under the loads which tells, too, that a residual is rounding, however large."""

PATIENCE = 16
GROWTHS = 4
"""Iterations in a row that may make the residual larger."""

DAMPINGS = 30
RELAXED = 0.1
"""Part of the damping of the last iteration that is tried first if none does not do."""


@dataclass
class Progress:
    """How far a search has come.

    Attributes
    ----------
    multipliers
        Reactions of the rigid rows.
    factor
        Of the loads at the last position of balance.
    steps, iterations
        Load steps, stiffness matrices.
    residual
        Of the last iteration.
    promised
        Displacement that the first iteration of the last search asked for, in units of a large one.
    rounded
        Whether the residual of the last search is rounding of forces far larger than the loads.
    """

    multipliers: NDArray[np.float64]
    factor: float = 0.0
    steps: int = 0
    iterations: int = 0
    residual: float = np.inf
    promised: float = np.inf
    rounded: bool = False


def large(problem: StaticProblem, increment: NDArray[np.float64]) -> float:
    """A displacement in units of a large one."""
    return float(np.abs(increment / problem.scale).max(initial=0.0))


def correct(
    problem: StaticProblem,
    progress: Progress,
    factor: float,
    *,
    most: float = np.inf,
    farthest: float = np.inf,
    anchor: float = 0.0,
    tolerance: float = BALANCED,
    patience: int = PATIENCE,
    damped: bool = True,
    firm: bool = False,
) -> bool:
    """Search for a position of balance; returns whether it was found.

    Parameters
    ----------
    problem
        Its position changes, whatever the outcome.
    progress
        Reactions to begin with; takes what was found.
    factor
        Of the loads.
    most
        Displacement that the first iteration may ask for, in units of a large one.
    farthest
        Displacement, in units of the first one, beyond which the search is given up.
    anchor
        Holds the scene where it begins, by this stiffness per mass [1/s2].
    tolerance
        Residual that counts as balance; the smallest that is possible is found unless more is allowed here.
    patience
        Most iterations.
    damped
        Avoid unstable positions. Otherwise the nearest position of balance is taken, stable or not.
    firm
        Give up where the stiffness is not positive to begin with.
    """
    multipliers, mass = progress.multipliers.copy(), problem.mass.diagonal()
    went = np.zeros(problem.count)
    last, best, grown, size, floor, damping = np.inf, np.inf, 0, np.inf, 0.0, 0.0
    good: tuple[Any, NDArray[np.float64], float] | None = (
        None  # a balance, and whether more helps is to be seen
    )
    for iteration in range(patience + 1):
        now = measure(problem, factor, multipliers)
        force = now.force - anchor * mass * went
        residual = float(np.sqrt(np.sum(force * force / mass))) / now.weight if now.weight > 0.0 else 0.0
        progress.residual = residual
        if not np.isfinite(residual):
            return False
        still = size <= STILL and residual <= ROUNDED
        enough = max(tolerance, min(floor, NOISE))
        balanced = residual <= POLISHED or (residual <= enough and residual > 0.3 * last)
        still = still or (residual <= floor and size <= max(STEADY * progress.promised, STILL))
        if now.gap_size <= CLOSED and (balanced or still or (tolerance > BALANCED and residual <= tolerance)):
            progress.multipliers, progress.factor = multipliers, factor
            progress.rounded = ROUNDED < residual <= floor
            return True
        if good is not None and residual >= good[2]:  # along what nothing holds steps lead nowhere
            problem.restore(good[0])
            progress.multipliers, progress.factor, progress.residual = good[1], factor, good[2]
            progress.rounded = good[2] > ROUNDED
            return True
        if residual <= enough and now.gap_size <= CLOSED:
            good = problem.snapshot(), multipliers, residual
        grown = grown + 1 if residual > last else 0
        if iteration == patience or grown > GROWTHS or (iteration > 4 and residual > 1e6 * best):
            return False
        last, best = residual, min(best, residual)
        K = problem.tangent(factor, multipliers)
        progress.iterations += 1
        floor = rounding_floor(problem, K, now.weight)
        if damped and not (firm and iteration == 0):
            solver, damping = _positive(problem, K, now, anchor, damping)
        elif damped:
            solver = factorise(problem, K, now.G, anchor)
        else:
            solver = factorise(problem, K, now.G, 0.0, check=False)
        if solver is None:
            return False
        dx, dl = solver.solve(force, -now.gap)
        size = large(problem, dx)
        if iteration == 0:
            progress.promised = size
        if not np.isfinite(size) or (iteration == 0 and size > most):
            return False
        part = min(1.0, 1.0 / max(size, 1e-300))
        problem.advance(part * dx)
        went += part * dx
        multipliers = multipliers + part * dl
        if large(problem, went) > farthest * max(progress.promised, 0.02):
            return False
    return False


def _positive(
    problem: StaticProblem, K: Any, now: Balance, least: float, before: float = 0.0
) -> tuple[Factor | None, float]:
    """The factor with the least damping that makes the stiffness positive, or nearly so, and that damping.

    Where `least` does not do, the search begins a little below the damping that was needed before.
    """
    shift = stability_shift(problem, K, now.weight)
    trial = least
    for _ in range(DAMPINGS):
        solver = factorise(problem, K, now.G, trial)
        if solver is not None:
            return solver, trial
        trial = max(10.0 * trial, shift, RELAXED * before)
    return None, trial


def stiffness(problem: StaticProblem, progress: Progress) -> tuple[Any, Balance, float]:
    """Stiffness and balance at the present position, and what counts as zero in it [1/s2]."""
    now = measure(problem, progress.factor, progress.multipliers)
    K = problem.tangent(progress.factor, progress.multipliers)
    progress.iterations += 1
    return K, now, stability_shift(problem, K, now.weight)


def push(problem: StaticProblem, progress: Progress, size: float) -> bool:
    """At an unstable position go a little along the softest direction; returns whether it was unstable.

    Parameters
    ----------
    problem
        In a position of balance.
    progress
        Load factor and reactions.
    size
        Of the push, in units of a large displacement.

    Notes
    -----
    The direction is found by inverse iteration with the damped stiffness.
    """
    K, now, shift = stiffness(problem, progress)
    if not unstable_count(problem, K, now.G, shift):
        return False
    solver, _ = _positive(problem, K, now, shift)
    if solver is None:
        return False
    mass = problem.mass.diagonal()
    rest = np.zeros(len(now.gap))
    x = np.random.default_rng(1).normal(size=problem.count) / np.sqrt(mass)
    for _ in range(30):
        x, _ = solver.solve(mass * x, rest)
        x /= np.sqrt(float(x @ (mass * x)))
    problem.move(x * (size / large(problem, x)))
    return True
