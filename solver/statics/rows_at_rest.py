"""Rows at the carried state, before time starts: for linear algebra, and with the forces of springs and laws."""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.integrate.loop import evaluate_forces
from heavylift.solver.interface import (
    FORCES,
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    fill_markers,
    fill_rows,
    joint_rows,
    relinearise,
    set_targets,
)
from heavylift.solver.rows.structure import RowArrays

__all__ = ["fill_at_rest", "fill_rigid_rows"]

LAW_ITERATIONS = 50


@entry
def fill_rigid_rows(
    bodies: Bodies,
    joints: Joints,
    system: RowArrays,
    work: Workspace,
    time: float,
) -> None:
    """Rows, residuals and target velocities at the carried state."""
    fill_markers(bodies, False, FORCES, work)
    fill_rows(joints, True, work, system)
    lanes = system.lanes
    for node in range(system.attachments.shape[0] // 2):
        for r in range(lanes):
            system.rows[node].target[r] = 0.0
    set_targets(joints, time, 1.0, False, work, system)


@kernel(internal=True)
def _fit_rows(system: RowArrays, joints: Joints, work: Workspace, time: float, step: float) -> None:
    """Residuals; targets and softness of the compliant rows at velocity zero.

    As at the midpoint of a very small step, without regularisation.
    """
    lanes = system.lanes
    fill_rows(joints, True, work, system)
    for node in range(system.attachments.shape[0] // 2):
        row = system.rows[node]
        for r in range(lanes):
            compliance = row.compliance[r]
            if row.scale[r] > 0.0 and compliance > 0.0:
                delay = 0.5 * step + row.relaxation[r]
                row.target[r] = -row.residual[r] / delay
                row.softness[r] = 2.0 * compliance / (step * delay)
    set_targets(joints, time, step, True, work, system)
    for _ in range(LAW_ITERATIONS):
        for node in range(system.attachments.shape[0] // 2):
            row = system.rows[node]
            for r in range(lanes):
                if row.scale[r] > 0.0 and row.compliance[r] > 0.0:
                    row.impulse[r] = row.target[r] / row.softness[r]
        work.control.changed = 0
        relinearise(joints, time, step, work, system)
        if work.control.changed == 0:
            return


@entry
def fill_at_rest(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
    step: float,
) -> None:
    """Markers, marker forces and rows at the carried state, at rest."""
    evaluate_forces(bodies, forces, work, time, False, FORCES)
    for i in range(joint_rows(systems)):
        _fit_rows(joint_rows(systems, i), joints, work, time, step)
