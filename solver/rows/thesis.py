"""Joints in the first-order scheme of "Integrated simulation ... (2018)", eq. 49, signs and impulses as corrected.

With ``Gamma = 1 / (1 + 4 tau/h)``, all matrices at the start of the step and the impulse as unknown::

    G v+ + (4 Gamma eps / h^2) P = -(4 Gamma / h) g + Gamma G v

The scheme is stable for relaxation times of two steps and more, critically damped at two, which is taken
where a joint says less.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Bodies,
    Joints,
    Systems,
    Workspace,
    apply_inverse,
    fill_rows,
    thesis_velocity,
    write_velocity,
)
from heavylift.solver.kinds import implement, optional
from heavylift.solver.rows.solver import assemble, factor_rows, solve_rows, subtract_rates
from heavylift.solver.rows.structure import (
    REGULARISATION,
    RowSystem,
)

__all__ = ["solve_thesis"]


@optional("thesis")
def solve_thesis(
    systems: Systems, bodies: Bodies, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """Rows: end velocities of the bodies, with what the rows do to them; reactions."""


@implement(solve_thesis, RowSystem)
@kernel(internal=True)
def solve_thesis_rows(
    system: RowSystem, bodies: Bodies, joints: Joints, work: Workspace, time: float, step: float
) -> None:
    """One linear solve, with targets from the carried state, at which the markers are filled."""
    rows, lanes = len(system.shape[0]), len(system.shape[1])
    blocks = system.attachments.shape[0] // 2
    fill_rows(joints, True, work, system)
    write_velocity(bodies, work)
    for node in range(blocks):
        for r in range(lanes):
            system.rows[node].solution[r] = 0.0
    subtract_rates(system, work.velocity)
    for node in range(blocks):
        row = system.rows[node]
        for r in range(rows):
            row.impulse[r] = 0.0
            scale = row.scale[r]
            if scale > 0.0:
                tau = max(row.relaxation[r], 2.0 * step)
                gamma = 1.0 / (1.0 + 4.0 * tau / step)
                rate = -row.solution[r]
                row.target[r] = gamma * rate - 4.0 * gamma / step * row.residual[r]
                row.softness[r] = REGULARISATION * scale + 4.0 * gamma / (step * step) * row.compliance[r]
    thesis_velocity(bodies, time, step, work)
    apply_inverse(bodies, False, system)
    assemble(system)
    factor_rows(system)
    solve_rows(system, work.velocity)
    for node in range(blocks):
        row = system.rows[node]
        for r in range(rows):
            row.reaction[r] = row.impulse[r] / step
