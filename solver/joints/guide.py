"""Guides: b goes along x of a as it is driven, without leaving its line or turning away; free to heave, roll and pitch.

::

    x_a . (p_b - p_a) - l(t) = 0,    y_a . (p_b - p_a) = 0,    y_a . x_b = 0,     l(t) = v t + drive

The reaction of the first row is what its drives give to a vehicle, those of the others what its wheels hold across.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.quantity import Quantity
from heavylift.numerics.records import Records, filled, records
from heavylift.solver.drive import profile_value
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints, set_targets
from heavylift.solver.joints.driving import DriveState, aim, drive_work, pack_profiles
from heavylift.solver.joints.packing import (
    JointEntry,
    JointPlace,
    TravelMarkers,
    entry_fields,
    refuse_opposite,
    travel_markers,
)
from heavylift.solver.joints.reactions import (
    add_force,
    add_moment,
    clear_reaction,
    record_travel,
)
from heavylift.solver.joints.row_writing import (
    residuals,
    square_bias,
    square_row,
    targets,
    travel_bias,
    travel_row,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.bodies import Profile
from heavylift.solver.scene.connections import JOINTS, Joint, Place
from heavylift.solver.scene.sliding_joints import SlidingOutputs

__all__ = ["Guide", "Guides", "pack"]


@JOINTS.describe("guide")
@dataclass(frozen=True, eq=False, kw_only=True)
class Guide(Joint):
    """The point of b goes along x of a as it is driven, and b does not turn about z; it may heave, roll and pitch."""

    PLACE: ClassVar = Place.AXIS
    ROTATIONAL: ClassVar = (False, False, True)
    CHANNELS: ClassVar = SlidingOutputs.CHANNELS

    speed: Annotated[float, Quantity("velocity")] = 0.0
    """Of b along x of a, constant [m/s]."""
    drive: Annotated[Profile | None, Quantity("length")] = None
    """Additional travel as a function of time [m]."""

    @property
    def travel_axis(self) -> NDArray[np.float64]:
        """Direction of its travel in the joint frame of a."""
        return np.array([1.0, 0.0, 0.0])


guide_outputs = outputs_at(SlidingOutputs)


class GuideEntry(JointEntry):
    """A guide, with direction markers x, y of a and x of b, markers for records, its speed and start of its profile."""

    x_a: int
    y_a: int
    x_b: int
    seen: TravelMarkers
    speed: float
    profile: int


class Guides(Arrays):
    """All guides of a scene.

    Attributes
    ----------
    table
        What each keeps.
    state
        Of the drives.
    profiles
        Packed, one after the other.
    ways
        Prescribed by the speeds at the end of the last step [m], shape (n,).
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state", "ways")

    table: Records[GuideEntry]
    state: Records[DriveState]
    profiles: Floats1
    ways: Floats1


def pack(joints: Sequence[Guide], places: Sequence[JointPlace], book: MarkerBook) -> Guides:
    """Make the kind."""
    profiles, starts, state = pack_profiles([joint.drive for joint in joints])
    rows = []
    for joint, place, start in zip(joints, places, starts, strict=True):
        refuse_opposite(joint, place, (0, 1, 2))
        a, b = joint.frame_a, joint.frame_b
        x_a, y_a = (book.direction(joint.body_a, a.axes[:, k], at=a.point) for k in range(2))
        x_b = book.direction(joint.body_b, b.axes[:, 0], at=b.point)
        rows.append(
            filled(
                GuideEntry,
                **entry_fields(book, joint, place),
                x_a=x_a,
                y_a=y_a,
                x_b=x_b,
                seen=travel_markers(book, joint, RECORD),
                speed=joint.speed,
                profile=start,
            )
        )
    return Guides(records(GuideEntry, rows), state, profiles, np.zeros(len(rows)))


@implement(fill_rows, Guides)
@kernel(internal=True)
def fill_guide_rows(kind: Guides, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, a, b = entry.block, entry.point_a, entry.point_b
        along = travel_row(system, block, 0, work, a, b, entry.x_a)
        across = travel_row(system, block, 1, work, a, b, entry.y_a)
        turn = square_row(system, block, 2, work, entry.y_a, entry.x_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = along - kind.state[j].prescribed - kind.ways[j], across, turn


@implement(set_targets, Guides)
@kernel(internal=True)
def aim_guides(
    kind: Guides, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """Follow speed and profile."""
    for j in range(kind.table.shape[0]):
        entry, state = kind.table[j], kind.state[j]
        aim(system, entry.block, 0, kind.profiles, entry.profile, state, time, step, at_midpoint)
        if at_midpoint:
            way = entry.speed * (time + step) - kind.ways[j]
            targets(system, entry.block)[0] += way / step
        else:
            way = entry.speed * time - kind.ways[j]
            residuals(system, entry.block)[0] -= way
            targets(system, entry.block)[0] += entry.speed
            state.advance += way
            kind.ways[j] = entry.speed * time


@implement(fill_bias, Guides)
@kernel(internal=True)
def fill_guide_bias(kind: Guides, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms, and the prescribed acceleration."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        target = targets(system, entry.block)
        driven = profile_value(kind.profiles, entry.profile, time)[2]
        target[0] = driven - travel_bias(work, entry.point_a, entry.point_b, entry.x_a)
        target[1] = -travel_bias(work, entry.point_a, entry.point_b, entry.y_a)
        target[2] = -square_bias(work, entry.y_a, entry.x_b)


@implement(record_joints, Guides)
@kernel(internal=True)
def record_guides(
    kind: Guides, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, travel, work of the drive."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, guide_outputs(row, entry.column)
        clear_reaction(out.reaction)
        add_force(system, block, 0, work, entry.x_a, out.reaction)
        add_force(system, block, 1, work, entry.y_a, out.reaction)
        add_moment(system, block, 2, work, entry.x_b, entry.y_a, out.reaction)
        record_travel(work, entry.seen, out.slide)
        work.sums.drive_work += drive_work(system, block, 0, kind.state[j])
