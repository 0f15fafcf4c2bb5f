"""Accelerations of a scene at its present state, as the default step has them when it is very short.

In a step of length h the velocities of the middle are ``v + h/2 a + O(h^2)``, with everything that acts: forces, rows
with laws, constraints. Nothing that a step carries is changed by finding them.
"""

from __future__ import annotations

from heavylift.numerics.objects import entry
from heavylift.solver.integrate.dele2 import refine
from heavylift.solver.integrate.loop import evaluate_forces
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    complete,
    correct,
    factor,
    predict,
    solve_again,
    solve_midpoint,
)

__all__ = ["find_middle"]

NOMINAL = 1e30
"""Step over which open joints would be closed [s]: not at all."""


@entry
def find_middle(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """Velocities in the middle of a step from the present state, in the workspace; impulses of the rows in theirs."""
    predict(bodies, time, step)
    evaluate_forces(bodies, forces, work, time + 0.5 * step, True, FORCES)
    factor(bodies, step, work)
    solve_midpoint(systems, systems, bodies, joints, work, time, step, NOMINAL)
    work.control.changed = 0
    correct(bodies, step, work)
    if work.control.changed > 0:
        solve_again(systems, systems, joints, work, time, step)
    complete(bodies, systems, True, step, work)
    refine(bodies, systems, joints, work, time, step)
