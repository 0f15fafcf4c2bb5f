"""Parts of the time loop that every integrator shares: forces at an instant, and the record."""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.interface import (
    DISSIPATED,
    DRIVE_WORK,
    ELASTIC,
    EXTERNAL_WORK,
    FIELD,
    KINETIC,
    LINEAR_MOMENTUM,
    POINT_FORCE,
    POTENTIAL,
    RECORD,
    SUM_COUNT,
    Bodies,
    Forces,
    Joints,
    Systems,
    Workspace,
    add_forces,
    add_totals,
    begin_record,
    fill_markers,
    gather_rows,
    record,
    record_forces,
    record_rows,
    start,
)

TOTAL_COLUMNS = 13
"""Columns at the end of a record: six energies, their balance, two momenta."""

__all__ = ["TOTAL_COLUMNS", "evaluate_forces", "start_scene", "write_record"]


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
            work.markers[marker, POINT_FORCE + k] = 0.0
    for k in range(3):
        work.sums[FIELD + k] = 0.0
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
    gather_rows(systems, bodies, joints, work, time)
    record(bodies, time, work, row)
    sums = work.sums
    for i in range(KINETIC, SUM_COUNT):
        sums[i] = 0.0
    add_totals(bodies, work)
    record_forces(forces, time, work, row)
    record_rows(systems, joints, work, time, row)
    end = row.shape[0] - TOTAL_COLUMNS
    for i in range(6):
        row[end + i] = sums[KINETIC + i]
        row[end + 7 + i] = sums[LINEAR_MOMENTUM + i]
    row[end + 6] = (
        sums[KINETIC]
        + sums[ELASTIC]
        + sums[POTENTIAL]
        - sums[EXTERNAL_WORK]
        - sums[DRIVE_WORK]
        + sums[DISSIPATED]
    )
