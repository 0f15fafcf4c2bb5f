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
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.drive import profile_value
from heavylift.solver.interface import (
    RECORD,
    Workspace,
    fill_bias,
    fill_rows,
    record_joints,
    set_targets,
)
from heavylift.solver.joints.driving import DriveState, aim, drive_work, pack_profiles
from heavylift.solver.joints.hinge import Hinge, HingeOutputs
from heavylift.solver.joints.packing import AngleMarkers, JointPlace, angle_markers
from heavylift.solver.joints.reactions import AngleState, add_torque, record_angle
from heavylift.solver.joints.row_joints import (
    RowParts,
    fill_part_bias,
    fill_part_rows,
    pack_parts,
    record_reactions,
)
from heavylift.solver.joints.row_writing import angle_bias, angle_row, near_angle, residuals, targets
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays

__all__ = ["DrivenHinges", "pack"]


ROW = 5


hinge_outputs = outputs_at(HingeOutputs)


class DrivenHingeEntry(Record):
    """A hinge: block, first record column, direction marker z of a, markers of angle, start of its profile."""

    block: int
    column: int
    z_a: int
    driven: AngleMarkers
    recorded: AngleMarkers
    profile: int


class DrivenHingeState(AngleState):
    """Whole turns of a hinge, and its drive."""

    drive: DriveState


class DrivenHinges(Arrays):
    """All driven hinges of a scene.

    Attributes
    ----------
    parts
        Rows of the hinges.
    table
        What each keeps.
    state
        Whole turns and drives.
    profiles
        Packed, one after the other.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    parts: RowParts
    table: Records[DrivenHingeEntry]
    state: Records[DrivenHingeState]
    profiles: Floats1


def pack(joints: Sequence[Hinge], places: Sequence[JointPlace], book: MarkerBook) -> DrivenHinges:
    """Make the kind."""
    profiles, starts, drives = pack_profiles([joint.drive for joint in joints])
    parts = pack_parts([(joint, joint.ROWS) for joint in joints], places, book)
    table = []
    for joint, place, start in zip(joints, places, starts, strict=True):
        z_a = book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point)
        table.append(
            filled(
                DrivenHingeEntry,
                block=place.block,
                column=place.column,
                z_a=z_a,
                driven=angle_markers(book, joint),
                recorded=angle_markers(book, joint, RECORD),
                profile=start,
            )
        )
    state = records(DrivenHingeState, len(table))
    state["drive"] = drives
    return DrivenHinges(parts, records(DrivenHingeEntry, table), state, profiles)


@implement(fill_rows, DrivenHinges)
@kernel(internal=True)
def fill_driven_hinge_rows(
    kind: DrivenHinges, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows of the hinge and of its angle."""
    fill_part_rows(kind.parts, with_residual, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        seen = entry.driven
        angle = angle_row(system, entry.block, ROW, work, seen.x_a, seen.x_b, seen.y_b)
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
    fill_part_bias(kind.parts, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        gamma = angle_bias(work, entry.driven.x_a, entry.driven.x_b, entry.driven.y_b)
        targets(system, entry.block)[ROW] = profile_value(kind.profiles, entry.profile, time)[2] - gamma


@implement(record_joints, DrivenHinges)
@kernel(internal=True)
def record_driven_hinges(
    kind: DrivenHinges, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a hinge, with the torque and the work of the drive."""
    record_reactions(kind.parts, work, system, row)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, hinge_outputs(row, entry.column)
        record_angle(work, entry.recorded, kind.state[j], time, out.turn)
        add_torque(system, block, ROW, work, entry.z_a, out.reaction)
        prescribed = profile_value(kind.profiles, entry.profile, time)[0]
        out.turn.angle = near_angle(out.turn.angle, prescribed)
        work.sums.drive_work += drive_work(system, block, ROW, kind.state[j].drive)
