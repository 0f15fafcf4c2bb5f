"""Joints that are a list of rows: one kind writes the rows of all of them.

With points p, and unit directions d of a and e of b::

    point       p_b - p_a = 0              three rows
    parallel    d . e = 0,  d . f = 0      two rows: e, f are the two axes of b that are not that of d
    travel      d . (p_b - p_a) = 0
    square      d . e = 0

"Integrated simulation ... (2018)", eqs. 163-164 and sections 2.4.2 to 2.4.6, with independent rows in place of cross
products. Which rows a joint has says its description, see `heavylift.solver.scene.connections.Joint.ROWS`; what it
records besides the reaction, the angle or the travel, say its channels. Joints with rows of their own beside these
take the kernels of this file for them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.interface import RECORD, Workspace, fill_bias, fill_rows, record_joints
from heavylift.solver.joints.packing import (
    AngleMarkers,
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
    reaction_outputs,
    record_angle,
    record_travel,
    write_reaction,
)
from heavylift.solver.joints.row_writing import (
    difference,
    put_point_rows,
    residuals,
    square_bias,
    square_row,
    targets,
    travel_bias,
    travel_row,
    write_point_bias,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import MarkerBook
from heavylift.solver.recording import outputs_at
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.connections import (
    ROW_WORDS,
    AngleOutputs,
    Joint,
    Rows,
    TravelOutputs,
    axes_about,
)

__all__ = [
    "RowJoints",
    "RowParts",
    "fill_part_bias",
    "fill_part_rows",
    "pack",
    "pack_parts",
    "record_reactions",
]

LARGEST_COSINE = 0.9
"""Of the angle between two perpendicular axes, at the start: the row vanishes if they are parallel."""


class RowPart(Record):
    """Rows of a joint that belong to one word; those of its point are the first of its block.

    Attributes
    ----------
    block, row
        Block of the joint, and number of the first row in it.
    a, b, c
        Markers: of both points and the direction of a travel, or of the directions d, e, f.
    column
        First record column of the joint.
    """

    block: int
    row: int
    a: int
    b: int
    c: int
    column: int


class RowParts(Arrays):
    """Rows of joints.

    Attributes
    ----------
    points, travels, parallels, squares
        By their words.
    columns
        First record column of each joint, shape (n,).
    """

    points: Records[RowPart]
    travels: Records[RowPart]
    parallels: Records[RowPart]
    squares: Records[RowPart]
    columns: Ints1


class TurnEntry(Record):
    """A recorded angle: its markers, and the column of its outputs."""

    angle: AngleMarkers
    column: int


class SlideEntry(Record):
    """A recorded travel: its markers, and the column of its outputs."""

    travel: TravelMarkers
    column: int


class RowJoints(Arrays):
    """All joints of a scene that are a list of rows.

    Attributes
    ----------
    parts
        Their rows.
    turns, slides
        What is recorded of those that turn about an axis, and slide along one.
    state
        Whole turns, see `record_angle`.
    """

    carried_fields: ClassVar[tuple[str, ...]] = ("state",)

    parts: RowParts
    turns: Records[TurnEntry]
    state: Records[AngleState]
    slides: Records[SlideEntry]


angle_outputs = outputs_at(AngleOutputs)
travel_outputs = outputs_at(TravelOutputs)


def pack(joints: Sequence[Joint], places: Sequence[JointPlace], book: MarkerBook) -> RowJoints:
    """Make the kind."""
    parts = pack_parts([(joint, joint.ROWS) for joint in joints], places, book)
    turns, slides = [], []
    for joint, place in zip(joints, places, strict=True):
        turn, slide = place.column.at(AngleOutputs), place.column.at(TravelOutputs)
        if turn >= 0:
            turns.append(filled(TurnEntry, angle=angle_markers(book, joint, RECORD), column=turn))
        if slide >= 0:
            slides.append(filled(SlideEntry, travel=travel_markers(book, joint, RECORD), column=slide))
    return RowJoints(
        parts,
        records(TurnEntry, turns),
        records(AngleState, len(turns)),
        records(SlideEntry, slides),
    )


def pack_parts(
    joints: Iterable[tuple[Joint, Rows]], places: Sequence[JointPlace], book: MarkerBook
) -> RowParts:
    """Rows of joints, the first of their blocks.

    Raises
    ------
    InputError
        If a joint starts on another branch of its rows, or with parallel axes that are to be square.
    """
    parts: dict[str, list[RowPart]] = {word: [] for word in ROW_WORDS}
    for (joint, rows), place in zip(joints, places, strict=True):
        _refuse_starts(joint, rows, place)
        points, first = point_markers(book, joint), 0
        for word, *axes in rows:
            a, b, c = _markers(joint, word, axes, points, book)
            part = filled(RowPart, block=place.block, row=first, a=a, b=b, c=c, column=place.column)
            parts[word].append(part)
            first += len(ROW_WORDS[word])
    return RowParts(
        points=records(RowPart, parts["point"]),
        travels=records(RowPart, parts["travel"]),
        parallels=records(RowPart, parts["parallel"]),
        squares=records(RowPart, parts["square"]),
        columns=np.array([place.column for place in places], dtype=np.int64),
    )


def _markers(
    joint: Joint, word: str, axes: Sequence[str], points: tuple[int, int], book: MarkerBook
) -> tuple[int, int, int]:
    """Those of a word of rows, -1 for one that it does not have."""
    if word == "point":
        return (*points, -1)
    a, b = joint.frame_a, joint.frame_b
    direction = a.axes[:, "xyz".find(axes[0])]
    if axes[0] in "mn":
        across = a.axes @ axes_about(travel_direction(joint), source=joint.name)
        direction = across[:, "mn".index(axes[0])]
    on_a = book.direction(joint.body_a, direction, at=a.point)
    if word == "travel":
        return (*points, on_a)
    others = axes[1] if word == "square" else "xyz".replace(axes[0], "")
    on_b = [book.direction(joint.body_b, b.axes[:, "xyz".index(axis)], at=b.point) for axis in others]
    return on_a, on_b[0], on_b[1] if len(on_b) > 1 else -1


def _refuse_starts(joint: Joint, rows: Rows, place: JointPlace) -> None:
    """Refuse a start from which rows of directions lead elsewhere, or nowhere."""
    squares = [axes for word, *axes in rows if word == "square"]
    parallel = [axes[0] for word, *axes in rows if word == "parallel"]
    # with a row more, all axes are parallel
    refuse_opposite(joint, place, range(3) if parallel and squares else ["xyz".index(a) for a in parallel])
    for a, b in squares:
        if a != b:
            continue
        axes = (place.frames[0].axes[:, "xyz".index(a)], place.frames[1].axes[:, "xyz".index(b)])
        cosine = abs(float(axes[0] @ axes[1]))
        if not cosine < LARGEST_COSINE:
            raise InputError(
                f"the axes are {np.degrees(np.arccos(min(cosine, 1.0))):.1f} deg apart at the start",
                source=joint.name,
                key="axes",
                expected="two axes perpendicular to each other",
            )


@kernel(internal=True)
def fill_part_rows(parts: RowParts, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows from the markers."""
    for i in range(parts.points.shape[0]):
        part = parts.points[i]
        block, a, b = part.block, part.a, part.b
        put_point_rows(system, 2 * block, 0, work, a, -1.0)
        put_point_rows(system, 2 * block + 1, 0, work, b, 1.0)
        if with_residual:
            g = residuals(system, block)
            g[0], g[1], g[2] = difference(work, a, b)
    for i in range(parts.travels.shape[0]):
        part = parts.travels[i]
        value = travel_row(system, part.block, part.row, work, part.a, part.b, part.c)
        if with_residual:
            residuals(system, part.block)[part.row] = value
    for i in range(parts.parallels.shape[0]):
        part = parts.parallels[i]
        block, row, a, b, c = part.block, part.row, part.a, part.b, part.c
        first = square_row(system, block, row, work, a, b)
        second = square_row(system, block, row + 1, work, a, c)
        if with_residual:
            g = residuals(system, block)
            g[row], g[row + 1] = first, second
    for i in range(parts.squares.shape[0]):
        part = parts.squares[i]
        value = square_row(system, part.block, part.row, work, part.a, part.b)
        if with_residual:
            residuals(system, part.block)[part.row] = value


@kernel(internal=True)
def fill_part_bias(parts: RowParts, work: Workspace, system: RowArrays) -> None:
    """Quadratic velocity terms."""
    for i in range(parts.points.shape[0]):
        part = parts.points[i]
        write_point_bias(system, part.block, work, part.a, part.b)
    for i in range(parts.travels.shape[0]):
        part = parts.travels[i]
        targets(system, part.block)[part.row] = -travel_bias(work, part.a, part.b, part.c)
    for i in range(parts.parallels.shape[0]):
        part = parts.parallels[i]
        target, row = targets(system, part.block), part.row
        target[row] = -square_bias(work, part.a, part.b)
        target[row + 1] = -square_bias(work, part.a, part.c)
    for i in range(parts.squares.shape[0]):
        part = parts.squares[i]
        targets(system, part.block)[part.row] = -square_bias(work, part.a, part.b)


@kernel(internal=True)
def record_reactions(parts: RowParts, work: Workspace, system: RowArrays, row: NDArray[np.float64]) -> None:
    """Force and moment of the rows on b."""
    for i in range(parts.columns.shape[0]):
        clear_reaction(reaction_outputs(row, parts.columns[i]))
    for i in range(parts.points.shape[0]):
        part = parts.points[i]
        write_reaction(system, part.block, reaction_outputs(row, part.column))
    for i in range(parts.travels.shape[0]):
        part = parts.travels[i]
        add_force(system, part.block, part.row, work, part.c, reaction_outputs(row, part.column))
    for i in range(parts.parallels.shape[0]):
        part = parts.parallels[i]
        out = reaction_outputs(row, part.column)
        add_moment(system, part.block, part.row, work, part.b, part.a, out)
        add_moment(system, part.block, part.row + 1, work, part.c, part.a, out)
    for i in range(parts.squares.shape[0]):
        part = parts.squares[i]
        out = reaction_outputs(row, part.column)
        add_moment(system, part.block, part.row, work, part.b, part.a, out)


@implement(fill_rows, RowJoints)
@kernel(internal=True)
def fill_row_joints(kind: RowJoints, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """All rows."""
    fill_part_rows(kind.parts, with_residual, work, system)


@implement(fill_bias, RowJoints)
@kernel(internal=True)
def fill_row_joint_bias(kind: RowJoints, time: float, work: Workspace, system: RowArrays) -> None:
    """Of all rows."""
    fill_part_bias(kind.parts, work, system)


@implement(record_joints, RowJoints)
@kernel(internal=True)
def record_row_joints(
    kind: RowJoints, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Reaction on b, angles, travels."""
    record_reactions(kind.parts, work, system, row)
    for i in range(kind.turns.shape[0]):
        turn = kind.turns[i]
        record_angle(work, turn.angle, kind.state[i], time, angle_outputs(row, turn.column))
    for i in range(kind.slides.shape[0]):
        slide = kind.slides[i]
        record_travel(work, slide.travel, travel_outputs(row, slide.column))
