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

TOTAL_COLUMNS = 13
"""Columns at the end of a record: six energies, their balance, two momenta."""

__all__ = ["TOTAL_COLUMNS", "evaluate_forces", "evaluate_loads", "start_scene", "write_record"]


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
    end = row.shape[0] - TOTAL_COLUMNS
    row[end], row[end + 1], row[end + 2] = sums.kinetic, sums.elastic, sums.potential
    row[end + 3], row[end + 4], row[end + 5] = sums.external_work, sums.drive_work, sums.dissipated
    for k in range(3):
        row[end + 7 + k], row[end + 10 + k] = sums.linear_momentum[k], sums.angular_momentum[k]
    row[end + 6] = (
        sums.kinetic + sums.elastic + sums.potential - sums.external_work - sums.drive_work + sums.dissipated
    )


@entry
def evaluate_loads(bodies: Bodies, forces: Forces, work: Workspace, time: float) -> None:
    """Markers and forces at the carried state."""
    evaluate_forces(bodies, forces, work, time, False, FORCES)
