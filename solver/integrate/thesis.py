"""The first-order scheme of the 2018 thesis, eq. 49, for comparison with the default.

All forces and matrices at the start of the step, end velocity by one linear solve, configuration by
the end velocity.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats2
from heavylift.numerics.objects import entry
from heavylift.solver.integrate.loop import evaluate_forces, write_record
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    check,
    complete,
    joint_rows,
    thesis_advance,
    thesis_velocity,
)
from heavylift.solver.rows.thesis import solve_thesis

__all__ = ["run"]


@entry  # eleven parameters: the scene is five; which steps, how exact and where records go are six
def run(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    step: float,
    tolerance: float,
    first: int,
    last: int,
    every: int,
    records: Floats2,
) -> int:
    """Step from index `first` to `last`; arguments and result as in the default integrator."""
    row = 0
    for index in range(first, last):
        time = index * step
        evaluate_forces(bodies, forces, work, time, False, FORCES)
        solve_thesis(systems, bodies, joints, work, time, step)
        if joint_rows(systems) == 0:
            thesis_velocity(bodies, time, step, work)
        complete(bodies, systems, True, step, work)
        check(bodies, step, work)
        if work.status.outcome != 0:
            return index
        thesis_advance(bodies, time, step, work)
        work.control.step_count += 1
        if (index + 1) % every == 0:
            write_record(bodies, forces, joints, systems, work, (index + 1) * step, records[row])
            row += 1
    return last
