"""Relaxation: let a scene move under all its loads, with dissipation, until it is at rest.

The generalised-alpha method (J. Chung and G. M. Hulbert, J. Applied Mechanics 60, 1993), with constraints and
rotations as in M. Arnold and O. Bruls, Multibody System Dynamics 18, 2007::

    M a' = R(x'),   g(x') = 0                                    (' at the end of a step)
    (1 - am) b' + am b = (1 - af) a' + af a
    x' = x + h v + h^2 (1/2 - beta) b + h^2 beta b',   v' = v + h (1 - gamma) b + h gamma b'

High frequencies are dissipated by the method; slow swings end because velocities are taken away each time when
the kinetic energy has just passed a maximum. Gyroscopic moments, which do no work, are left out: only the place
of rest matters. A step is repeated with half its length if the kinetic energy grows by more than the work of the
forces.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.statics.newton import Progress, correct, large, push
from heavylift.solver.statics.problem import Factor, StaticProblem, factorise, measure

__all__ = ["Relaxation", "relax"]

SPECTRAL_RADIUS = 0.8
"""Of the method at infinite frequency."""

STEPS = 5000
PATIENCE = 12
CONVERGED, CLOSED = 1e-6, 1e-9
FIRST_MOVE = 0.02
"""Displacement of the first step from rest, in units of a large one."""

LONGEST_MOVE = 0.3
GAIN = 0.05
"""Growth of the energy in a step relative to the largest kinetic energy that is not accepted."""

DIRECT = 0.02
"""Displacement, in units of a large one, from which Newton's method is trusted to find the place of rest."""


@dataclass(frozen=True)
class Relaxation:
    """How it went.

    Attributes
    ----------
    at_rest
        Whether a stable position of balance was found.
    steps, time
        Steps and simulated time [s].
    stops
        How often velocities were taken away.
    dissipated
        Energy that was taken [J].
    balance
        Largest growth of the energy in a step beyond the work done, relative to the largest kinetic energy.
    """

    at_rest: bool
    steps: int
    time: float
    stops: int
    dissipated: float
    balance: float


def relax(
    problem: StaticProblem, progress: Progress, factor: float = 1.0, *, steps: int = STEPS
) -> Relaxation:
    """Let a scene come to rest from its present position.

    Parameters
    ----------
    problem
        Left where it is at rest, or where steps came to an end.
    progress
        Reactions to begin with; takes those at rest.
    factor
        Of the loads.
    steps
        Most steps.
    """
    motion = _Motion(problem, progress, factor)
    motion.begin()
    pushes = 0
    while motion.steps < steps:
        if not motion.step():
            break
        if motion.is_slow():
            before = problem.snapshot(), progress.multipliers
            if correct(problem, progress, factor, most=DIRECT, farthest=4.0):
                pushes += 1
                if pushes > 8 or not push(problem, progress, 0.03 * pushes):
                    return motion.report(pushes <= 8)
            else:
                problem.restore(before[0])
                progress.multipliers = before[1]
            motion.stop()
    return motion.report(False)


class _Motion:
    """State of the motion: velocity, acceleration, algorithmic acceleration."""

    def __init__(self, problem: StaticProblem, progress: Progress, factor: float) -> None:
        self.problem, self.progress, self.factor = problem, progress, factor
        rho = SPECTRAL_RADIUS
        self.am, self.af = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
        self.gamma = 0.5 - self.am + self.af
        self.beta = 0.25 * (1.0 - self.am + self.af) ** 2
        self.v = self.a = self.b = np.zeros(problem.count)
        self.h = self.time = self.dissipated = self.kinetic = self.last_kinetic = self.peak = 0.0
        self.balance = 0.0
        self.steps = self.stops = self.since = 0
        self._slow = False

    def begin(self) -> None:
        """Accelerations at rest, and a step that moves the scene a little."""
        problem = self.problem
        now = measure(problem, self.factor, self.progress.multipliers)
        solver = factorise(problem, problem.mass.tocsc(), now.G, 0.0, check=False)
        if solver is None:
            return
        pull = now.force - now.G.T @ self.progress.multipliers
        self.a, self.progress.multipliers = solver.solve(pull, np.zeros(len(now.gap)))
        self.b = self.a
        fastest = float(np.abs(self.a / problem.scale).max(initial=0.0))
        self.h = float(np.sqrt(2.0 * FIRST_MOVE / fastest)) if fastest > 0.0 else 1.0

    def stop(self) -> None:
        """Take the velocities away."""
        self.dissipated += self.kinetic
        self.v = np.zeros(self.problem.count)
        self.kinetic = self.last_kinetic = 0.0
        self.stops += 1
        self.since = 0
        self._slow = False
        h = self.h
        self.begin()
        self.h = min(max(self.h, h), 1e3 * h) if h > 0.0 else self.h

    def is_slow(self) -> bool:
        """Whether the kinetic energy has just passed a maximum."""
        return self._slow

    def step(self) -> bool:
        """One step, shortened until it is good; returns whether it was made."""
        before = self.problem.snapshot()
        for _ in range(40):
            found = self._try(self.h)
            if found is not None:
                break
            self.problem.restore(before)
            self.h *= 0.5
        if found is None:
            return False
        self.v, self.a, self.b, multipliers, moved, kinetic, gain, rounds = found
        self.progress.multipliers = multipliers
        self.balance = max(self.balance, gain)
        self.last_kinetic, self.kinetic = self.kinetic, kinetic
        self.peak = max(self.peak, kinetic)
        self.steps += 1
        self.since += 1
        self.time += self.h
        self._slow = (self.since > 2 and kinetic < self.last_kinetic) or kinetic == 0.0
        if rounds <= 5 and moved < 0.5 * LONGEST_MOVE:
            self.h *= 1.3
        return True

    def _try(
        self, h: float
    ) -> (
        tuple[
            NDArray[np.float64],
            NDArray[np.float64],
            NDArray[np.float64],
            NDArray[np.float64],
            float,
            float,
            float,
            int,
        ]
        | None
    ):
        """Velocity, accelerations, multipliers, displacement, kinetic energy, growth of energy, iterations."""
        problem, M = self.problem, self.problem.mass
        am, af, beta, gamma = self.am, self.af, self.beta, self.gamma
        per_mass = (1.0 - am) / (h * h * beta * (1.0 - af))
        a = np.zeros(problem.count)
        b = (af * self.a - am * self.b) / (1.0 - am)
        went = h * self.v + h * h * ((0.5 - beta) * self.b + beta * b)
        v = self.v + h * ((1.0 - gamma) * self.b + gamma * b)
        multipliers = self.progress.multipliers
        if not np.isfinite(went).all():
            return None
        begin, force_before = problem.snapshot(), self._work_force()
        problem.move(went)
        for rounds in range(PATIENCE):
            now = measure(problem, self.factor, multipliers)
            left = now.force - M @ a
            size = np.sqrt(np.sum(left * left / M.diagonal()))
            if not np.isfinite(size):
                return None
            if size <= CONVERGED * now.weight and now.gap_size <= CLOSED and rounds:
                break
            K = problem.tangent(self.factor, multipliers) + per_mass * M
            self.progress.iterations += 1
            solver: Factor | None = factorise(problem, K, now.G, 0.0, check=False)
            if solver is None:
                return None
            dx, dl = solver.solve(left, -now.gap)
            if not large(problem, went + dx) <= LONGEST_MOVE * 3.0:  # nor a factor whose numbers are none
                return None
            problem.move(dx)
            went = went + dx
            v = v + gamma / (beta * h) * dx
            a = a + per_mass * dx
            multipliers = multipliers + dl
            b = b + dx / (beta * h * h)
        else:
            return None
        moved = large(problem, went)
        if moved > LONGEST_MOVE:
            return None
        kinetic = 0.5 * float(v @ (M @ v))
        work = self._work(begin, force_before, went)
        scale = max(self.peak, kinetic, abs(work))
        gain = (kinetic - self.kinetic - work) / scale if scale > 0.0 else 0.0
        if gain > GAIN:
            return None
        return v, a, b, multipliers, moved, kinetic, gain, rounds

    def _work(self, begin: Any, force_before: NDArray[np.float64], went: NDArray[np.float64]) -> float:
        """Work along a step by Simpson's rule: exact for dead loads and strains of Green-Lagrange."""
        problem = self.problem
        end, force_after = problem.snapshot(), self._work_force()
        problem.restore(begin)
        problem.move(0.5 * went)
        force_between = self._work_force()
        problem.restore(end)
        return float((force_before + 4.0 * force_between + force_after) @ went) / 6.0

    def _work_force(self) -> NDArray[np.float64]:
        """Forces that do work: all but the reactions."""
        return self.factor * self.problem.external_force() - self.problem.internal_force()

    def report(self, at_rest: bool) -> Relaxation:
        """What happened."""
        return Relaxation(at_rest, self.steps, self.time, self.stops, self.dissipated, self.balance)
