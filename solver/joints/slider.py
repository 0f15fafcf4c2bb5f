"""Sliders: the point of b slides along z of a without turning; 5 rows.

"Integrated simulation ... (2018)", section 2.4.4, with independent rows in place of cross products::

    x_a . (p_b - p_a) = 0,  y_a . (p_b - p_a) = 0,  z_a . x_b = 0,  z_a . y_b = 0,  x_a . y_b = 0
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
    JointEntry,
    JointPlace,
    TravelMarkers,
    point_markers,
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
from heavylift.solver.scene.connections import JOINTS, Joint, Limits, Place
from heavylift.solver.scene.sliding_joints import SlidingOutputs

__all__ = ["Slider", "SliderEntry", "Sliders", "pack", "pack_entries", "slider_outputs"]


@JOINTS.describe("slider")
@dataclass(frozen=True, eq=False, kw_only=True)
class Slider(Joint):
    """The point of b slides along the axis without turning, by the travel."""

    PLACE: ClassVar = Place.AXIS
    ROTATIONAL: ClassVar = (False, False, True, True, True)
    CHANNELS: ClassVar = SlidingOutputs.CHANNELS
    COORDINATE: ClassVar = "travel"

    drive: Annotated[Profile | None, Quantity("length")] = None
    """The travel as a function of time [m]: one row more."""
    limits: Annotated[Limits | None, Quantity("length")] = None
    """Stops of the travel."""
    friction: Annotated[float, Quantity("force", minimum=0.0, closed=True)] = 0.0
    """Dry friction [N]."""

    @property
    def kind_module(self) -> str:
        """A drive has a file of its own."""
        return super().kind_module if self.drive is None else "heavylift.solver.joints.driven_slider"

    @property
    def rotational(self) -> tuple[bool, ...]:
        """With the row of the drive."""
        return self.ROTATIONAL if self.drive is None else (*self.ROTATIONAL, False)


slider_outputs = outputs_at(SlidingOutputs)


class SliderEntry(JointEntry):
    """A slider, with direction markers x, y, z of a and x, y of b, and markers of the recorded travel."""

    x_a: int
    y_a: int
    z_a: int
    x_b: int
    y_b: int
    travel: TravelMarkers


class Sliders(Arrays):
    """All sliders of a scene."""

    table: Records[SliderEntry]


def pack(joints: Sequence[Slider], places: Sequence[JointPlace], book: MarkerBook) -> Sliders:
    """Make the kind."""
    return Sliders(records(SliderEntry, pack_entries(joints, places, book)))


def pack_entries(
    joints: Sequence[Slider], places: Sequence[JointPlace], book: MarkerBook
) -> list[tuple[Any, ...]]:
    """Fields of each slider."""
    rows = []
    for joint, place in zip(joints, places, strict=True):
        refuse_opposite(joint, place, (0, 1, 2))
        axes_a = (
            book.direction(joint.body_a, joint.frame_a.axes[:, k], at=joint.frame_a.point) for k in range(3)
        )
        axes_b = (
            book.direction(joint.body_b, joint.frame_b.axes[:, k], at=joint.frame_b.point) for k in range(2)
        )
        points, recorded = point_markers(book, joint), travel_markers(book, joint, RECORD)
        rows.append((place.block, *points, place.column, *axes_a, *axes_b, recorded))
    return rows


@implement(fill_rows, Sliders)
@kernel(internal=True)
def fill_slider_rows(kind: Sliders, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, point_a, point_b = entry.block, entry.point_a, entry.point_b
        x = travel_row(system, block, 0, work, point_a, point_b, entry.x_a)
        y = travel_row(system, block, 1, work, point_a, point_b, entry.y_a)
        zx = square_row(system, block, 2, work, entry.z_a, entry.x_b)
        zy = square_row(system, block, 3, work, entry.z_a, entry.y_b)
        xy = square_row(system, block, 4, work, entry.x_a, entry.y_b)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2], g[3], g[4] = x, y, zx, zy, xy


@implement(fill_bias, Sliders)
@kernel(internal=True)
def fill_slider_bias(kind: Sliders, time: float, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        target = targets(system, entry.block)
        target[0] = -travel_bias(work, entry.point_a, entry.point_b, entry.x_a)
        target[1] = -travel_bias(work, entry.point_a, entry.point_b, entry.y_a)
        target[2] = -square_bias(work, entry.z_a, entry.x_b)
        target[3] = -square_bias(work, entry.z_a, entry.y_b)
        target[4] = -square_bias(work, entry.x_a, entry.y_b)


@implement(record_joints, Sliders)
@kernel(internal=True)
def record_sliders(
    kind: Sliders, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, travel."""
    for j in range(kind.table.shape[0]):
        entry = kind.table[j]
        block, out = entry.block, slider_outputs(row, entry.column)
        clear_reaction(out.reaction)
        add_force(system, block, 0, work, entry.x_a, out.reaction)
        add_force(system, block, 1, work, entry.y_a, out.reaction)
        add_moment(system, block, 2, work, entry.x_b, entry.z_a, out.reaction)
        add_moment(system, block, 3, work, entry.y_b, entry.z_a, out.reaction)
        add_moment(system, block, 4, work, entry.y_b, entry.x_a, out.reaction)
        record_travel(work, entry.travel, out.slide)
