"""Sliders whose travel is a function of time: the rows of a slider and that of its travel; 6 rows.

The sixth row is ``z_a . (p_b - p_a) - l(t) = 0``; its reaction is the force of the drive on b along z of a,
and part of the reaction force.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, filled, records
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
from heavylift.solver.joints.packing import (
    JointEntry,
    JointPlace,
    TravelMarkers,
    entry_fields,
    travel_markers,
)
from heavylift.solver.joints.reactions import add_force, record_travel
from heavylift.solver.joints.row_joints import (
    RowParts,
    fill_part_bias,
    fill_part_rows,
    pack_parts,
    record_reactions,
)
from heavylift.solver.joints.row_writing import residuals, targets, travel_bias, travel_row
from heavylift.solver.joints.slider import Slider
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.sliding_joints import SlidingOutputs

__all__ = ["DrivenSliders", "pack"]


ROW = 5


slider_outputs = outputs_at(SlidingOutputs)


class DrivenSliderEntry(JointEntry):
    """A slider, with its direction marker z of a, markers of the recorded travel, start of its profile."""

    z_a: int
    travel: TravelMarkers
    profile: int


class DrivenSliders(Arrays):
    """All driven sliders of a scene.

    Attributes
    ----------
    parts
        Rows of the sliders.
    table
        What each keeps.
    state
        Of the drives.
    profiles
        Packed, one after the other.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    parts: RowParts
    table: Records[DrivenSliderEntry]
    state: Records[DriveState]
    profiles: Floats1


def pack(joints: Sequence[Slider], places: Sequence[JointPlace], book: MarkerBook) -> DrivenSliders:
    """Make the kind."""
    profiles, starts, state = pack_profiles([joint.drive for joint in joints])
    parts = pack_parts([(joint, joint.ROWS) for joint in joints], places, book)
    table = []
    for joint, place, start in zip(joints, places, starts, strict=True):
        z_a = book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point)
        table.append(
            filled(
                DrivenSliderEntry,
                **entry_fields(book, joint, place),
                z_a=z_a,
                travel=travel_markers(book, joint, RECORD),
                profile=start,
            )
        )
    return DrivenSliders(parts, records(DrivenSliderEntry, table), state, profiles)


@implement(fill_rows, DrivenSliders)
@kernel(internal=True)
def fill_driven_slider_rows(
    kind: DrivenSliders, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows of the slider and of its travel."""
    fill_part_rows(kind.parts, with_residual, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block = entry.block
        value = travel_row(system, block, ROW, work, entry.point_a, entry.point_b, entry.z_a)
        if with_residual:
            residuals(system, block)[ROW] = value - kind.state[j].prescribed


@implement(set_targets, DrivenSliders)
@kernel(internal=True)
def aim_driven_sliders(
    kind: DrivenSliders, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Follow the profile."""
    for j in range(kind.table.shape[0]):
        entry, state = kind.table[j], kind.state[j]
        aim(system, entry.block, ROW, kind.profiles, entry.profile, state, time, step, at_midpoint)


@implement(fill_bias, DrivenSliders)
@kernel(internal=True)
def fill_driven_slider_bias(kind: DrivenSliders, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms and the prescribed acceleration."""
    fill_part_bias(kind.parts, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        gamma = travel_bias(work, entry.point_a, entry.point_b, entry.z_a)
        targets(system, entry.block)[ROW] = profile_value(kind.profiles, entry.profile, time)[2] - gamma


@implement(record_joints, DrivenSliders)
@kernel(internal=True)
def record_driven_sliders(
    kind: DrivenSliders, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """As a slider, with the force and the work of the drive."""
    record_reactions(kind.parts, work, system, row)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        out = slider_outputs(row, entry.column)
        record_travel(work, entry.travel, out.slide)
        add_force(system, entry.block, ROW, work, entry.z_a, out.reaction)
        work.sums.drive_work += drive_work(system, entry.block, ROW, kind.state[j])
