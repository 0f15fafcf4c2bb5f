"""How many steps a fixed step makes in a period of what really moves: measured, not guessed.

With the velocities v of a body at steps on end, their masses m and their means over the run::

    4 sin^2(pi/N) = sum m (v_n - v_{n-1})^2 / sum m (v_n - mean)^2

gives the number N of steps in a period: exact for one oscillation, where many are together the energies weigh them
(the mean square frequency of Rice's formula, S. O. Rice, Bell System Tech. J. 24, 1945, in differences). Whatever makes
a body move is in it: waves, ropes, springs, pendulums. A stiff rope at rest, or one that stretches along with what a
slow motion asks for, has no share in it, however short its own period is; and what the midpoint rule cannot follow
changes its sign with every step, so N is 2 there.

The first steps are looked at one by one, later ones in pairs, one of many: a step is not to cost more for it.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import Bodies, Workspace, add_forces, watch_motions
from heavylift.solver.kinds import implement

__all__ = ["StepCounts", "pack_step_counts"]

DENSE, STRIDE = 512, 64
"""Steps that are all looked at, and of how many a pair is after that."""

BEFORE, LEVEL, SQUARES, CHANGES, SUMS = range(5)
"""Rows of `sums`: velocity of the last step that was looked at, and sums of velocities, squares, squared changes."""


class StepCounts(Arrays):
    """Sums over steps.

    Attributes
    ----------
    step
        Length of all steps [s]; shorter ones, at impacts, are left out.
    inertia
        By velocity [kg, kg m2], 0 of those that are not looked at.
    sums
        Rows `BEFORE` to `CHANGES`, by velocity.
    tally
        Step whose velocities are in `BEFORE`, 0 if none; number of changes in the sums.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("sums", "tally")

    step: float
    inertia: Floats1
    sums: Floats2
    tally: Ints1

    def of_bodies(
        self, owner: NDArray[np.int64], count: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Steps in a period of each body, infinite at rest, and mean energy of its motion [J].

        Parameters
        ----------
        owner
            Number of the body of each velocity.
        count
            Bodies.
        """
        changes = max(1, int(self.tally[1]))
        with np.errstate(
            divide="ignore", invalid="ignore", over="ignore"
        ):  # runs that diverge have other watches
            mean = self.sums[LEVEL] / changes
            spread = np.maximum(0.0, self.sums[SQUARES] / changes - mean**2)
            moving = np.bincount(owner, self.inertia * spread, count)
            changed = np.bincount(owner, self.inertia * self.sums[CHANGES] / changes, count)
            sine = np.where(moving > 0.0, np.sqrt(np.minimum(1.0, 0.25 * changed / moving)), 0.0)
            periods = np.where(sine > 0.0, np.pi / np.arcsin(sine), np.inf)
        return periods.astype(np.float64), np.asarray(0.5 * moving, dtype=np.float64)


def pack_step_counts(step: float, velocities: int) -> StepCounts:
    """Make the kind for steps of a length [s] and a number of velocities; who knows the bodies sets `inertia`."""
    return StepCounts(
        float(step), np.zeros(velocities), np.zeros((SUMS, velocities)), np.zeros(2, dtype=np.int64)
    )


@implement(add_forces, StepCounts)
@kernel(internal=True)
def add_no_force(kind: StepCounts, time: float, work: Workspace) -> None:
    """It only watches."""


@implement(watch_motions, StepCounts)
@kernel(internal=True)
def watch_step_counts(kind: StepCounts, bodies: Bodies, work: Workspace) -> None:
    """Change of the velocities since the step before, of whole steps on end."""
    count = work.control.step_count
    if count > DENSE and count % STRIDE > 1:
        return
    tally, sums = kind.tally, kind.sums
    if abs(work.control.last_step - kind.step) > 1e-9 * kind.step:
        tally[0] = 0
        return
    on_end = tally[0] > 0 and tally[0] == count - 1
    for i in range(work.velocity.shape[0]):
        v = work.velocity[i]
        if on_end:
            change = v - sums[BEFORE, i]
            sums[LEVEL, i] += v
            sums[SQUARES, i] += v * v
            sums[CHANGES, i] += change * change
        sums[BEFORE, i] = v
    tally[0] = count
    if on_end:
        tally[1] += 1
