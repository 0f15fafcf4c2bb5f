"""Parts of the time loop that every integrator shares: forces at an instant, and the record."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.interface import (
    FORCES,
    RECORD,
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    add_forces,
    add_totals,
    begin_record,
    fill_markers,
    record,
    record_forces,
    record_rows,
    start,
)
from heavylift.solver.recording import outputs_at, width_of
from heavylift.solver.scene.channels import TotalOutputs

__all__ = ["evaluate_forces", "evaluate_loads", "start_scene", "write_record"]

total_outputs, TOTAL_WIDTH = outputs_at(TotalOutputs), width_of(TotalOutputs)
"""The last of a record."""


@entry
def start_scene(bodies: Bodies, work: Workspace, time: float) -> None:
    """Complete the start state of all bodies."""
    start(bodies, time, work)


@kernel(internal=True)
def evaluate_forces(
    bodies: Bodies,
    forces: Forces,
    work: Workspace,
    time: float,
    at_midpoint: bool,
    level: int,
) -> None:
    """Markers of all bodies, then all forces, at the midpoint of the step or at the carried state."""
    fill_markers(bodies, at_midpoint, level, work)
    for marker in range(work.markers.shape[0]):
        for k in range(3):
            work.markers[marker].force[k] = 0.0
    for k in range(3):
        work.sums.gravity[k] = 0.0
    add_forces(forces, time, work)


@entry
def write_record(
    bodies: Bodies,
    forces: Forces,
    joints: Joints,
    systems: Systems,
    work: Workspace,
    time: float,
    row: Floats1,
) -> None:
    """Write the carried state, energies and momenta into a record; totals come last."""
    begin_record(forces)
    evaluate_forces(bodies, forces, work, time, False, RECORD)
    for i in range(work.row_force.shape[0]):
        work.row_force[i] = 0.0
    sums = work.sums
    sums.kinetic = sums.elastic = sums.potential = 0.0
    sums.external_work = sums.drive_work = sums.dissipated = sums.drift = 0.0
    for k in range(3):
        sums.linear_momentum[k] = sums.angular_momentum[k] = 0.0
    record_rows(systems, bodies, joints, work, time, row)
    record(bodies, time, work, row)
    add_totals(bodies, work)
    record_forces(forces, time, work, row)
    out = total_outputs(row, row.shape[0] - TOTAL_WIDTH)
    energy, momentum = out.energy, out.momentum
    energy.kinetic, energy.elastic, energy.potential = sums.kinetic, sums.elastic, sums.potential
    energy.external_work, energy.drive_work = sums.external_work, sums.drive_work
    energy.dissipated = sums.dissipated
    energy.balance = (
        sums.kinetic + sums.elastic + sums.potential - sums.external_work - sums.drive_work + sums.dissipated
    )
    for k in range(3):
        momentum.linear[k], momentum.angular[k] = sums.linear_momentum[k], sums.angular_momentum[k]


@entry
def evaluate_loads(bodies: Bodies, forces: Forces, work: Workspace, time: float) -> None:
    """Markers and forces at the carried state."""
    evaluate_forces(bodies, forces, work, time, False, FORCES)
