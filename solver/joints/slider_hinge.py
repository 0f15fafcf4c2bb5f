"""Slider hinges: the point of b slides along a direction e of a, and b turns about z of a; 4 rows.

"Integrated simulation ... (2018)", section 2.4.6, with independent rows in place of cross products.

A cylindrical joint is the slider hinge that slides along its own z axis, so this file serves both. With
two directions m, n of a, square to e and to each other::

    m . (p_b - p_a) = 0,    n . (p_b - p_a) = 0,    z_a . x_b = 0,    z_a . y_b = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.jit import kernel
from heavylift.numerics.quantity import WorldDirection
from heavylift.numerics.records import Records, records
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import (
    AngleMarkers,
    JointEntry,
    JointPlace,
    TravelMarkers,
    angle_markers,
    point_markers,
    refuse_opposite,
    travel_direction,
    travel_markers,
)
from heavylift.solver.joints.reactions import (
    AngleState,
    add_force,
    add_moment,
    clear_reaction,
    record_angle,
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
from heavylift.solver.scene.connections import JOINTS, Joint, ReactionOutputs, axes_about
from heavylift.solver.scene.sliding_joints import SlidesAndTurns, SlidesAndTurnsOutputs

__all__ = [
    "Cylindrical",
    "SliderHinge",
    "SliderHingeEntry",
    "SliderHinges",
    "add_slider_hinge_reaction",
    "fill_slider_hinge_bias",
    "fill_slider_hinge_rows",
    "pack",
    "pack_entries",
]


@JOINTS.describe("slider_hinge")
@dataclass(frozen=True, eq=False, kw_only=True)
class SliderHinge(SlidesAndTurns):
    """The point of b slides along one axis of a, and b turns about another."""

    slide_axis: Annotated[NDArray[np.float64], WorldDirection()]
    """World direction of the travel at the start, any length; `axis` is that of the turn."""

    @property
    def travel_axis(self) -> NDArray[np.float64]:
        """The slide axis."""
        return self.slide_axis


@JOINTS.describe("cylindrical")
@dataclass(frozen=True, eq=False, kw_only=True)
class Cylindrical(SlidesAndTurns):
    """The point of b slides along the axis, and b turns about it."""


slider_hinge_outputs = outputs_at(SlidesAndTurnsOutputs)


class SliderHingeEntry(JointEntry):
    """Direction markers m, n, z of a, x and y of b, and markers of the recorded angle and travel."""

    m_a: int
    n_a: int
    z_a: int
    x_b: int
    y_b: int
    angle: AngleMarkers
    travel: TravelMarkers


class SliderHinges(Arrays):
    """All slider hinges and cylindrical joints of a scene.

    Attributes
    ----------
    table
        What each keeps.
    state
        Whole turns, see `record_angle`.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    table: Records[SliderHingeEntry]
    state: Records[AngleState]


def pack(
    joints: Sequence[SliderHinge | Cylindrical], places: Sequence[JointPlace], book: MarkerBook
) -> SliderHinges:
    """Make the kind."""
    rows = pack_entries(joints, places, book)
    return SliderHinges(records(SliderHingeEntry, rows), records(AngleState, len(rows)))


def pack_entries(
    joints: Sequence[Joint], places: Sequence[JointPlace], book: MarkerBook
) -> list[tuple[Any, ...]]:
    """Fields of each slider hinge."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (2,))
        across = joint.frame_a.axes @ axes_about(travel_direction(joint), source=joint.name)
        axes = (
            book.direction(joint.body_a, across[:, 0], at=joint.frame_a.point),
            book.direction(joint.body_a, across[:, 1], at=joint.frame_a.point),
            book.direction(joint.body_a, joint.frame_a.axes[:, 2], at=joint.frame_a.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 0], at=joint.frame_b.point),
            book.direction(joint.body_b, joint.frame_b.axes[:, 1], at=joint.frame_b.point),
        )
        recorded = (angle_markers(book, joint, RECORD), travel_markers(book, joint, RECORD))
        rows.append((place.block, *point_markers(book, joint), place.column, *axes, *recorded))
    return rows


@implement(fill_rows, SliderHinges)
@kernel(internal=True)
def fill_slider_hinge_rows(
    kind: SliderHinges, with_residual: bool, work: Workspace, system: RowArrays
) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        m = travel_row(system, block, 0, work, point_a, point_b, entry.m_a)
        n = travel_row(system, block, 1, work, point_a, point_b, entry.n_a)
        zx = square_row(system, block, 2, work, entry.z_a, entry.x_b)
        zy = square_row(system, block, 3, work, entry.z_a, entry.y_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2], g[3] = m, n, zx, zy


@implement(fill_bias, SliderHinges)
@kernel(internal=True)
def fill_slider_hinge_bias(kind: SliderHinges, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        target = targets(system, entry.block)
        target[0] = -travel_bias(work, entry.point_a, entry.point_b, entry.m_a)
        target[1] = -travel_bias(work, entry.point_a, entry.point_b, entry.n_a)
        target[2] = -square_bias(work, entry.z_a, entry.x_b)
        target[3] = -square_bias(work, entry.z_a, entry.y_b)


@kernel(internal=True)
def add_slider_hinge_reaction(
    system: RowArrays, entry: SliderHingeEntry, work: Workspace, out: ReactionOutputs
) -> None:
    """Force and moment of the four rows on b."""
    block = entry.block
    add_force(system, block, 0, work, entry.m_a, out)
    add_force(system, block, 1, work, entry.n_a, out)
    add_moment(system, block, 2, work, entry.x_b, entry.z_a, out)
    add_moment(system, block, 3, work, entry.y_b, entry.z_a, out)


@implement(record_joints, SliderHinges)
@kernel(internal=True)
def record_slider_hinges(
    kind: SliderHinges, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, angle, travel."""
    for j in range(kind.table.shape[0]):
        clear_reaction(slider_hinge_outputs(row, kind.table[j].column).reaction)
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        out = slider_hinge_outputs(row, entry.column)
        add_slider_hinge_reaction(system, entry, work, out.reaction)
        record_angle(work, entry.angle, kind.state[j], time, out.turn)
        record_travel(work, entry.travel, out.slide)
