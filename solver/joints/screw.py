"""Screws: the point of b travels along z of a as b turns about it; 5 rows.

The rows of a cylindrical joint, and with the pitch p, the travel a radian::

    z_a . (p_b - p_a) - p phi = 0

The travel says how many whole turns the angle ``phi`` has made: that is certain while the last row is off by less than
half a lead, so a screw is rigid, and starts on the turn on which both are zero. The last row transmits the force f of
the thread along the axis and the moment ``-p f`` about it (R. Featherstone, Rigid Body Dynamics Algorithms, 2008,
section 4.4: the helical joint).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity
from heavylift.numerics.records import Records, filled, records
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import (
    AngleMarkers,
    JointEntry,
    JointPlace,
    TravelMarkers,
    angle_markers,
    entry_fields,
    travel_markers,
)
from heavylift.solver.joints.reactions import add_force, reactions, record_travel
from heavylift.solver.joints.row_joints import (
    RowParts,
    fill_part_bias,
    fill_part_rows,
    pack_parts,
    record_reactions,
)
from heavylift.solver.joints.row_writing import (
    add_direction_row,
    angle_bias,
    angle_row,
    difference,
    dot,
    hinge_angle,
    hinge_rate,
    near_angle,
    residuals,
    targets,
    travel_bias,
    vector,
)
from heavylift.solver.joints.slider_hinge import Cylindrical
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import JOINTS, Joint, Place
from heavylift.solver.scene.outputs import channel, outputs
from heavylift.solver.scene.sliding_joints import SlidesAndTurnsOutputs

__all__ = ["Screw", "Screws", "pack"]

THREAD = 4
"""Row of the thread."""


@outputs
class ScrewOutputs(SlidesAndTurnsOutputs):
    """What a screw records."""

    thread_force: float = channel("force", "force of the thread of a screw on side b, along the axis")


@JOINTS.describe("screw")
@dataclass(frozen=True, eq=False, kw_only=True)
class Screw(Joint):
    """The point of b travels along the axis as b turns about it, by the lead a turn."""

    PLACE: ClassVar = Place.AXIS
    ROTATIONAL: ClassVar = (False, False, True, True, False)
    CHANNELS: ClassVar = ScrewOutputs.CHANNELS
    COORDINATE: ClassVar = "angle"

    lead: Annotated[float, Quantity("length")]
    """Travel a turn [m], not zero; positive for a right-handed thread."""


screw_outputs = outputs_at(ScrewOutputs)


class ScrewEntry(JointEntry):
    """Direction marker z of a, markers of angle and travel, the travel a radian [m]."""

    z_a: int
    turn: AngleMarkers
    angle: AngleMarkers
    travel: TravelMarkers
    pitch: float


class Screws(Arrays):
    """All screws of a scene: rows of the cylindrical joints, and what each keeps."""

    parts: RowParts
    table: Records[ScrewEntry]


def pack(joints: Sequence[Screw], places: Sequence[JointPlace], book: MarkerBook) -> Screws:
    """Make the kind.

    Raises
    ------
    InputError
        If a lead is zero or not finite, the screw is compliant, its axes point away from each other at the start, or
        travel and angle do not belong to one turn there.
    """
    for joint in joints:
        if not (math.isfinite(joint.lead) and joint.lead != 0.0):
            raise InputError(
                f"a lead of {joint.lead} m",
                source=joint.name,
                key="lead",
                expected="a travel a turn that is not zero, or a hinge",
            )
        if joint.compliance > 0.0 or joint.relaxation > 0.0:
            key = "compliance" if joint.compliance > 0.0 else "relaxation"
            raise InputError(
                f"{getattr(joint, key):g} of a screw, whose thread could slip",
                source=joint.name,
                key=key,
                expected="none: a screw is rigid; a soft body or joint beside it",
            )
    parts = pack_parts([(joint, Cylindrical.ROWS) for joint in joints], places, book)
    table = []
    for joint, place in zip(joints, places, strict=True):
        pitch = joint.lead / (2.0 * math.pi)
        _refuse_other_turns(joint, place, pitch)
        z_a = book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point)
        angle, travel = angle_markers(book, joint, RECORD), travel_markers(book, joint, RECORD)
        table.append(
            filled(
                ScrewEntry,
                z_a=z_a,
                turn=angle_markers(book, joint),
                angle=angle,
                travel=travel,
                pitch=pitch,
                **entry_fields(book, joint, place),
            )
        )
    return Screws(parts, records(ScrewEntry, table))


def _refuse_other_turns(joint: Screw, place: JointPlace, pitch: float) -> None:
    """Refuse a start whose travel belongs to another turn than its angle, which lies in (-pi, pi]."""
    a, b = place.frames
    along = float(a.axes[:, 2] @ (b.point - a.point))
    angle = math.atan2(-float(b.axes[:, 1] @ a.axes[:, 0]), float(b.axes[:, 0] @ a.axes[:, 0]))
    if not abs(along / pitch - angle) < math.pi:
        raise InputError(
            f"a travel of {along:.6g} m, {along / joint.lead:.3g} turns, at an angle of {angle:.6g} rad",
            source=joint.name,
            key="points",
            expected="a start within half a turn of where both are zero: move the point of side a along the axis",
        )


@kernel(internal=True)
def _scale_row(system: RowArrays, attachment: int, row: int, factor: float) -> None:
    begin, lanes = system.attachments[attachment].panel + row, system.lanes
    for k in range(system.attachments[attachment].width):
        system.panels[begin + k * lanes] *= factor


@implement(fill_rows, Screws)
@kernel(internal=True)
def fill_screw_rows(kind: Screws, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows of a cylindrical joint and of the thread."""
    fill_part_rows(kind.parts, with_residual, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        turn = entry.turn
        angle = angle_row(system, block, THREAD, work, turn.x_a, turn.x_b, turn.y_b)
        _scale_row(system, 2 * block, THREAD, -entry.pitch)
        _scale_row(system, 2 * block + 1, THREAD, -entry.pitch)
        e, r = vector(work, entry.z_a), difference(work, point_a, point_b)
        add_direction_row(system, 2 * block, THREAD, work, entry.z_a, r)
        add_direction_row(system, 2 * block, THREAD, work, point_a, (-e[0], -e[1], -e[2]))
        add_direction_row(system, 2 * block + 1, THREAD, work, point_b, e)
        if with_residual:
            along = dot(e, r)
            turned = near_angle(angle, along / entry.pitch)
            residuals(system, block)[THREAD] = along - entry.pitch * turned


@implement(fill_bias, Screws)
@kernel(internal=True)
def fill_screw_bias(kind: Screws, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    fill_part_bias(kind.parts, work, system)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        turning = angle_bias(work, entry.turn.x_a, entry.turn.x_b, entry.turn.y_b)
        along = travel_bias(work, entry.point_a, entry.point_b, entry.z_a)
        targets(system, entry.block)[THREAD] = entry.pitch * turning - along


@implement(record_joints, Screws)
@kernel(internal=True)
def record_screws(
    kind: Screws, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, angle, travel, force of the thread."""
    record_reactions(kind.parts, work, system, row)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        out = screw_outputs(row, entry.column)
        add_force(system, entry.block, THREAD, work, entry.z_a, out.reaction)
        force, e = reactions(system, entry.block)[THREAD], vector(work, entry.z_a)
        for k in range(3):
            out.reaction.reaction_moment[k] -= entry.pitch * force * e[k]
        record_travel(work, entry.travel, out.slide)
        seen = entry.angle
        angle = hinge_angle(work, seen.x_a, seen.x_b, seen.y_b)
        out.turn.angle = near_angle(angle, out.slide.travel / entry.pitch)
        out.turn.angular_rate = hinge_rate(work, seen.x_a, seen.x_b, seen.y_b)
        out.thread_force = force
