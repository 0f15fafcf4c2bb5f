"""The default integrator: second order, one linear solve and one correction a step.

The idea of the discrete Euler-Lagrange equation of "Integrated simulation ... (2018)", eq. 49, at the
midpoint of the step: everything stiff enters one symmetric solve, momenta are carried, and no second
derivative of anything is needed. What a body does in each call is in its own files.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.integrate.loop import evaluate_forces, write_record
from heavylift.solver.interface import (
    STATUS_OUTCOME,
    Workspace,
    advance,
    check,
    correct,
    factor,
    finish,
    predict,
)

__all__ = ["run"]


@kernel
def run(
    bodies: tuple[Any, ...],
    forces: tuple[Any, ...],
    work: Workspace,
    step: float,
    first: int,
    last: int,
    every: int,
    records: NDArray[np.float64],
) -> int:
    """Step from index `first` to `last`; time is the index times the step, so it never drifts.

    Parameters
    ----------
    bodies, forces
        Tuples of kinds.
    work
        Shared arrays.
    step
        [s].
    first, last
        Step indices.
    every
        A record is written after each step whose index is divisible by this.
    records
        Receives them, shape (rows, columns).

    Returns
    -------
    int
        Index of the last step that was completed; `work.status` says why if it is not `last`.
    """
    row = 0
    for index in range(first, last):
        time = index * step
        predict(bodies, time, step)
        evaluate_forces(bodies, forces, work, time + 0.5 * step, True)
        factor(bodies, step, work)
        correct(bodies, step, work)
        check(bodies, step, work)
        if work.status[STATUS_OUTCOME] != 0:
            return index
        advance(bodies, time, step, work)
        finish(bodies, step, work)
        if (index + 1) % every == 0:
            write_record(bodies, forces, work, (index + 1) * step, records[row])
            row += 1
    return last
