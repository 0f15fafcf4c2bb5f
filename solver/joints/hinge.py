"""Hinges: the points and the z axes of both sides coincide; 5 rows.

"Integrated simulation ... (2018)", section 2.4.3, with two independent rows in place of the cross product
of the axes, whose three rows have rank two::

    p_b - p_a = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.quantity import Quantity
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import (
    AngleMarkers,
    JointEntry,
    JointPlace,
    angle_markers,
    point_markers,
    refuse_opposite,
)
from heavylift.solver.joints.reactions import (
    AngleState,
    add_moment,
    record_angle,
    write_reaction,
)
from heavylift.solver.joints.row_writing import (
    difference,
    put_point_rows,
    residuals,
    square_bias,
    square_row,
    targets,
    write_point_bias,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.bodies import Profile
from heavylift.solver.scene.connections import (
    JOINTS,
    AngleOutputs,
    Joint,
    Limits,
    Place,
    ReactionOutputs,
)
from heavylift.solver.scene.outputs import Outputs, nested, outputs

__all__ = ["Hinge", "HingeEntry", "HingeOutputs", "Hinges", "hinge_outputs", "pack", "pack_entries"]


@outputs
class HingeOutputs(Outputs):
    """What a hinge records."""

    reaction: ReactionOutputs = nested(ReactionOutputs)
    turn: AngleOutputs = nested(AngleOutputs)


@JOINTS.describe("hinge")
@dataclass(frozen=True, eq=False, kw_only=True)
class Hinge(Joint):
    """The points and the axes coincide; b turns about the axis, by the angle.

    The angle turns x of a into x of b about z.
    """

    PLACE: ClassVar = Place.AXIS
    ROTATIONAL: ClassVar = (False, False, False, True, True)
    CHANNELS: ClassVar = HingeOutputs.CHANNELS
    COORDINATE: ClassVar = "angle"

    drive: Annotated[Profile | None, Quantity("angle")] = None
    """The angle as a function of time [rad]: one row more."""
    limits: Annotated[Limits | None, Quantity("angle")] = None
    """Stops of the angle."""
    friction: Annotated[float, Quantity("moment or energy", minimum=0.0, closed=True)] = 0.0
    """Dry friction [N m]."""

    @property
    def kind_module(self) -> str:
        """A drive has a file of its own."""
        return super().kind_module if self.drive is None else "heavylift.solver.joints.driven_hinge"

    @property
    def rotational(self) -> tuple[bool, ...]:
        """With the row of the drive."""
        return self.ROTATIONAL if self.drive is None else (*self.ROTATIONAL, True)


hinge_outputs = outputs_at(HingeOutputs)


class HingeEntry(JointEntry):
    """A hinge, with direction markers z of a, x and y of b, and markers of the recorded angle."""

    z_a: int
    x_b: int
    y_b: int
    angle: AngleMarkers


class Hinges(Arrays):
    """All hinges of a scene.

    Attributes
    ----------
    table
        What each keeps.
    state
        Whole turns, see `record_angle`.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[HingeEntry]
    state: Records[AngleState]


def pack(joints: Sequence[Hinge], places: Sequence[JointPlace], book: MarkerBook) -> Hinges:
    """Make the kind."""
    rows = pack_entries(joints, places, book)
    return Hinges(records(HingeEntry, rows), records(AngleState, len(rows)))


def pack_entries(
    joints: Sequence[Hinge], places: Sequence[JointPlace], book: MarkerBook
) -> list[tuple[Any, ...]]:
    """Fields of each hinge."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (2,))
        axes = (
            book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 0], at=joint.frame_b.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 1], at=joint.frame_b.point),
        )
        points, angle = point_markers(book, joint), angle_markers(book, joint, RECORD)
        rows.append((place.block, *points, place.column, *axes, angle))
    return rows


@implement(fill_rows, Hinges)
@kernel(internal=True)
def fill_hinge_rows(kind: Hinges, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        put_point_rows(system, 2 * block, 0, work, point_a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, point_b, 1.0)
        zx = square_row(system, block, 3, work, entry.z_a, entry.x_b)
        zy = square_row(system, block, 4, work, entry.z_a, entry.y_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, point_a, point_b)
            g[3], g[4] = zx, zy


@implement(fill_bias, Hinges)
@kernel(internal=True)
def fill_hinge_bias(kind: Hinges, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_point_bias(system, entry.block, work, entry.point_a, entry.point_b)
        target = targets(system, entry.block)
        target[3] = -square_bias(work, entry.z_a, entry.x_b)
        target[4] = -square_bias(work, entry.z_a, entry.y_b)


@implement(record_joints, Hinges)
@kernel(internal=True)
def record_hinges(
    kind: Hinges, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, angle."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        write_reaction(system, entry.block, hinge_outputs(row, entry.column).reaction)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, hinge_outputs(row, entry.column)
        add_moment(system, block, 3, work, entry.x_b, entry.z_a, out.reaction)
        add_moment(system, block, 4, work, entry.y_b, entry.z_a, out.reaction)
        record_angle(work, entry.angle, kind.state[j], time, out.turn)
