"""Hinges whose angle is a function of time: the rows of a hinge and that of its angle; 6 rows.

``phi`` turns x of a into x of b about z; the sixth row is ``phi - l(t) = 0``. Its reaction is the torque of
the drive on b, and part of the reaction moment.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, records
from heavylift.solver.drive import profile_value
from heavylift.solver.interface import (
    Workspace,
    fill_bias,
    fill_rows,
    record_joints,
    set_targets,
)
from heavylift.solver.joints import hinge
from heavylift.solver.joints.driving import DriveState, aim, drive_work, pack_profiles
from heavylift.solver.joints.hinge import (
    Hinge,
    HingeEntry,
    fill_hinge_bias,
    fill_hinge_rows,
    hinge_outputs,
    record_hinges,
)
from heavylift.solver.joints.packing import JointPlace
from heavylift.solver.joints.reactions import AngleState, add_torque
from heavylift.solver.joints.row_writing import angle_bias, angle_row, near_angle, residuals, targets
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowArrays

__all__ = ["DrivenHinges", "pack"]


ROW = 5


class DrivenHingeEntry(HingeEntry):
    """A hinge, with its direction marker x of a and the start of its profile."""

    x_a: int
    profile: int


class DrivenHingeState(AngleState):
    """Whole turns of a hinge, and its drive."""

    drive: DriveState


class DrivenHinges(Arrays):
    """All driven hinges of a scene.

    Attributes
    ----------
    table
        What each keeps.
    state
        Whole turns and drives.
    profiles
        Packed, one after the other.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[DrivenHingeEntry]
    state: Records[DrivenHingeState]
    profiles: Floats1


def pack(joints: Sequence[Hinge], places: Sequence[JointPlace], book: MarkerBook) -> DrivenHinges:
    """Make the kind."""
    rows = hinge.pack_entries(joints, places, book)
    x_a = [book.direction(joint.body_a, joint.frame_a.axes[:, 0], at=joint.frame_a.point) for joint in joints]
    profiles, starts, drives = pack_profiles([joint.drive for joint in joints])
    entries = ((*row, x, start) for row, x, start in zip(rows, x_a, starts, strict=True))
    table = records(DrivenHingeEntry, entries)
    state = records(DrivenHingeState, len(rows))
    state["drive"] = drives
    return DrivenHinges(table, state, profiles)


@implement(fill_rows, DrivenHinges)
@kernel(internal=True)
def fill_driven_hinge_rows(
    kind: DrivenHinges, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows of the hinge and of its angle."""
    fill_hinge_rows(kind, with_residual, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        angle = angle_row(system, entry.block, ROW, work, entry.x_a, entry.x_b, entry.y_b)
        if with_residual:
            off = angle - kind.state[j].drive.prescribed
            residuals(system, entry.block)[ROW] = near_angle(off, 0.0)


@implement(set_targets, DrivenHinges)
@kernel(internal=True)
def aim_driven_hinges(
    kind: DrivenHinges, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Follow the profile."""
    for j in range(kind.table.shape[0]):
        entry, state = kind.table[j], kind.state[j].drive
        aim(system, entry.block, ROW, kind.profiles, entry.profile, state, time, step, at_midpoint)


@implement(fill_bias, DrivenHinges)
@kernel(internal=True)
def fill_driven_hinge_bias(kind: DrivenHinges, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms and the prescribed acceleration."""
    fill_hinge_bias(kind, time, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        gamma = angle_bias(work, entry.x_a, entry.x_b, entry.y_b)
        targets(system, entry.block)[ROW] = profile_value(kind.profiles, entry.profile, time)[2] - gamma


@implement(record_joints, DrivenHinges)
@kernel(internal=True)
def record_driven_hinges(
    kind: DrivenHinges, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a hinge, with the torque and the work of the drive."""
    record_hinges(kind, time, work, system, row)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, hinge_outputs(row, entry.column)
        add_torque(system, block, ROW, work, entry.z_a, out.reaction)
        prescribed = profile_value(kind.profiles, entry.profile, time)[0]
        out.turn.angle = near_angle(out.turn.angle, prescribed)
        work.sums.drive_work += drive_work(system, block, ROW, kind.state[j].drive)
