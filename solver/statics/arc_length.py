"""Positions of balance along a path that load steps cannot follow: over limit points, where a scene snaps through.

Both the load factor and the position are unknown; the length of the displacement in each step is given
(M. A. Crisfield, Computers & Structures 13, 1981, the cylindrical form)::

    R(x, f) = 0,    Du . D Du = s^2,    D = diag M / sum

so that a step may go along with less load, and along unstable positions too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.statics.newton import BALANCED, CLOSED, NOISE, STEADY, Progress, correct, large
from heavylift.solver.statics.problem import (
    StaticProblem,
    factorise,
    measure,
    rounding_floor,
    stability_shift,
    unstable_count,
)

__all__ = ["LoadPath", "trace_path"]

POLISHED = 1e-10
PATIENCE = 14
EASY = 5
"""Iterations after which a step keeps its length."""

FIRST_MOVE, MOST = 0.03, 0.4
"""Displacement of the first step, and of the longest, in units of a large one."""

SMALLEST = 1e-6
"""Step relative to the longest at which the path is given up."""


@dataclass
class LoadPath:
    """What was found along a path.

    Attributes
    ----------
    factors
        Load factors.
    observed
        What the observer returned.
    unstable
        Number of unstable directions.
    reached
        Whether the factor that was asked for was reached.
    """

    factors: list[float] = field(default_factory=list)
    observed: list[NDArray[np.float64]] = field(default_factory=list)
    unstable: list[int] = field(default_factory=list)
    reached: bool = False


def trace_path(
    problem: StaticProblem,
    progress: Progress,
    *,
    until: float = 1.0,
    steps: int = 300,
    longest: float = MOST,
    stable_end: bool = True,
    observe: Callable[[], Sequence[float] | NDArray[np.float64]] | None = None,
) -> LoadPath:
    """Follow positions of balance from that at hand, at first with growing load.

    Parameters
    ----------
    problem
        In balance; left at the end of the path.
    progress
        Load factor and reactions of the present position; takes those of the end.
    until
        Load factor at which the path ends.
    steps
        Most steps.
    longest
        Longest step in units of a large displacement.
    stable_end
        End at a stable position only.
    observe
        Called at each position; e.g. returns coordinates of some points.
    """
    path = LoadPath()
    mass = problem.mass.diagonal()
    weight = mass / float(mass[problem.positions].sum())

    def note(unstable: int) -> None:
        path.factors.append(progress.factor)
        path.unstable.append(unstable)
        path.observed.append(np.array(observe() if observe else (), dtype=np.float64))

    before_last: NDArray[np.float64] | None = None
    length = 0.0
    for _ in range(steps + 1):
        now = measure(problem, progress.factor, progress.multipliers)
        K = problem.tangent(progress.factor, progress.multipliers)
        progress.iterations += 1
        shift = stability_shift(problem, K, now.weight)
        unstable = unstable_count(problem, K, now.G, shift)
        note(unstable)
        if progress.factor == until and len(path.factors) > 1:
            path.reached = True
            return path
        solver = factorise(problem, K, now.G, 0.0, check=False)
        if solver is None:
            solver = factorise(problem, K, now.G, shift, check=False)
        if solver is None:
            return path
        tangent = solver.solve(now.load, np.zeros(len(now.gap)))
        size = large(problem, tangent[0])
        norm = float(np.sqrt(np.sum(weight * tangent[0] ** 2)))
        if not 0.0 < norm < np.inf:
            return path
        if before_last is None:
            sign = 1.0 if until >= progress.factor else -1.0
            length = min(FIRST_MOVE, longest) / size * norm
        else:
            sign = 1.0 if float(np.sum(weight * before_last * tangent[0])) >= 0.0 else -1.0
            length = min(length, longest / size * norm)
        begin = problem.snapshot(), progress.factor, progress.multipliers
        while True:
            change = _step(problem, progress, weight, length, sign, tangent)
            if change is not None:
                break
            problem.restore(begin[0])
            progress.factor, progress.multipliers = begin[1], begin[2]
            length *= 0.4
            if length < SMALLEST * longest / size * norm:
                return path
        crossed = (begin[1] - until) * (progress.factor - until) <= 0.0 and before_last is not None
        first_crossed = before_last is None and sign * (progress.factor - until) >= 0.0
        before_last, used = change[0], change[1]
        if crossed or first_crossed:
            beyond = problem.snapshot(), progress.factor, progress.multipliers
            farthest = 2.0 * large(problem, before_last) / 0.02
            if correct(problem, progress, until, farthest=farthest, damped=False) and (
                not stable_end or _is_stable(problem, progress)
            ):
                continue
            problem.restore(beyond[0])
            progress.factor, progress.multipliers = beyond[1], beyond[2]
        progress.steps += 1
        length *= min(2.0, max(0.5, np.sqrt(EASY / max(used, 1))))
    return path


def _is_stable(problem: StaticProblem, progress: Progress) -> bool:
    """Whether no direction is unstable."""
    now = measure(problem, progress.factor, progress.multipliers)
    K = problem.tangent(progress.factor, progress.multipliers)
    return unstable_count(problem, K, now.G, stability_shift(problem, K, now.weight)) == 0


def _step(
    problem: StaticProblem,
    progress: Progress,
    weight: NDArray[np.float64],
    length: float,
    sign: float,
    tangent: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], int] | None:
    """One step; returns the displacement and the iterations it took, or None if it does not converge."""

    def dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
        return float(np.sum(weight * a * b))

    more = sign * length / np.sqrt(dot(tangent[0], tangent[0]))
    went = more * tangent[0]
    problem.move(went)
    factor = progress.factor + more
    multipliers = progress.multipliers + more * tangent[1]
    last, floor, size, promised = np.inf, 0.0, np.inf, large(problem, went)
    for iteration in range(1, PATIENCE + 1):
        now = measure(problem, factor, multipliers)
        if not np.isfinite(now.residual):
            return None
        enough = max(BALANCED, min(floor, NOISE))
        good = now.residual <= POLISHED or (now.residual <= enough and now.residual > 0.3 * last)
        good = good or (now.residual <= floor and size <= STEADY * promised)
        if now.gap_size <= CLOSED and good:
            progress.factor, progress.multipliers, progress.residual = factor, multipliers, now.residual
            return went, iteration
        last = now.residual
        K = problem.tangent(factor, multipliers)
        progress.iterations += 1
        floor = rounding_floor(problem, K, now.weight)
        solver = factorise(problem, K, now.G, 0.0, check=False)
        if solver is None:
            return None
        back, back_l = solver.solve(now.force, -now.gap)
        along, along_l = solver.solve(now.load, np.zeros(len(now.gap)))
        # |went + back + m along| = length; of the two solutions the one that continues
        a, b = dot(along, along), 2.0 * dot(went + back, along)
        c = dot(went + back, went + back) - length**2
        root = b * b - 4.0 * a * c
        if not root >= 0.0 or a == 0.0:
            return None
        choices = [(-b + s * np.sqrt(root)) / (2.0 * a) for s in (1.0, -1.0)]
        m = max(choices, key=lambda m: dot(went + back + m * along, went))
        change = back + m * along
        size = large(problem, change)
        problem.move(change)
        went = went + change
        factor += m
        multipliers = multipliers + back_l + m * along_l
    return None
