"""What joints need when a scene is packed: markers on bodies, a place among the rows, record columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record, filled
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.interface import ROWS
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.bodies import Driven
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame
from heavylift.solver.scene.outputs import Columns

if TYPE_CHECKING:
    from heavylift.solver.scene.scene import AnyBody

__all__ = [
    "AngleMarkers",
    "JointEntry",
    "JointPlace",
    "TravelMarkers",
    "angle_markers",
    "entry_fields",
    "point_markers",
    "refuse_opposite",
    "start_frames",
    "travel_direction",
    "travel_markers",
]


@dataclass(frozen=True)
class JointPlace:
    """Where a joint goes, and where its bodies start.

    Attributes
    ----------
    block
        Number of its block of rows.
    column
        Where its outputs are in a record.
    frames
        Joint frames of a and b in the world at the start.
    """

    block: int
    column: Columns
    frames: tuple[JointFrame, JointFrame]


class JointEntry(Record):
    """What every joint of two points keeps.

    Attributes
    ----------
    block
        Number of its block of rows.
    point_a, point_b
        Markers of its points on both sides.
    column
        First record column.
    """

    block: int
    point_a: int
    point_b: int
    column: int


class AngleMarkers(Record):
    """Direction markers x of a, x of b, y of b: what the angle of a joint about its z axis is made of."""

    x_a: int
    x_b: int
    y_b: int


class TravelMarkers(Record):
    """Markers of the two points and of the direction on a: what the travel of a joint is made of."""

    point_a: int
    point_b: int
    axis: int


def point_markers(book: MarkerBook, joint: Joint, level: int = ROWS) -> tuple[int, int]:
    """Markers of the two points of a joint."""
    return (
        book.point(joint.body_a, joint.frame_a.point, level),
        book.point(joint.body_b, joint.frame_b.point, level),
    )


def entry_fields(book: MarkerBook, joint: Joint, place: JointPlace) -> dict[str, int]:
    """Fields of a `JointEntry` by name: ``filled(Entry, **entry_fields(book, joint, place), length=...)``."""
    point_a, point_b = point_markers(book, joint)
    return {"block": place.block, "point_a": point_a, "point_b": point_b, "column": place.column}


def angle_markers(book: MarkerBook, joint: Joint, level: int = ROWS) -> AngleMarkers:
    """See `AngleMarkers`."""
    return filled(
        AngleMarkers,
        x_a=book.direction(joint.body_a, joint.frame_a.axes[:, 0], level, at=joint.frame_a.point),
        x_b=book.direction(joint.body_b, joint.frame_b.axes[:, 0], level, at=joint.frame_b.point),
        y_b=book.direction(joint.body_b, joint.frame_b.axes[:, 1], level, at=joint.frame_b.point),
    )


def travel_markers(book: MarkerBook, joint: Joint, level: int = ROWS) -> TravelMarkers:
    """See `TravelMarkers`."""
    point_a, point_b = point_markers(book, joint, level)
    along = joint.frame_a.axes @ travel_direction(joint)
    axis = book.direction(joint.body_a, along, level, at=joint.frame_a.point)
    return filled(TravelMarkers, point_a=point_a, point_b=point_b, axis=axis)


def travel_direction(joint: Joint) -> NDArray[np.float64]:
    """Unit direction of the travel in the joint frame of a: z, or the slide axis.

    Raises
    ------
    InputError
        If the slide axis has length zero or is not finite.
    """
    axis = np.asarray(joint.travel_axis, dtype=np.float64)
    length = float(np.linalg.norm(axis))
    if not 0.0 < length < np.inf:
        raise InputError(
            f"slide axis {axis.tolist()}",
            source=joint.name,
            key="slide_axis",
            expected="a direction that is not zero",
        )
    return axis / length


def start_frames(joint: Joint, bodies: Sequence[AnyBody]) -> tuple[JointFrame, JointFrame]:
    """Joint frames of both sides in the world at the start, deformation left out.

    Raises
    ------
    InputError
        If a side is neither the ground nor one of the bodies.
    """
    by_name = {body.name: body for body in bodies}
    frames = []
    for name, frame in ((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b)):
        if name == GROUND:
            frames.append(frame)
            continue
        if name not in by_name:
            raise InputError(
                f"there is no body {name!r}",
                source=joint.name,
                key="between",
                expected=f"{GROUND} or one of {', '.join(sorted(by_name))}",
            )
        position, orientation = _start_pose(by_name[name])
        R = rotation_matrix(orientation)
        frames.append(JointFrame(position + R @ frame.point, R @ frame.axes))
    return frames[0], frames[1]


def _start_pose(body: AnyBody) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position [m] and quaternion of a body frame at the start; a driven frame may start elsewhere."""
    if not isinstance(body.motion, Driven):
        return body.position, body.orientation
    from heavylift.solver.drive import drive_pose, pack_drive

    pose = np.empty(7)
    drive_pose(pack_drive(body.motion, body.position, body.orientation), 0.0, pose)
    return pose[:3], pose[3:]


def refuse_opposite(joint: Joint, place: JointPlace, axes: Sequence[int]) -> None:
    """Refuse a start on the wrong branch: rows that are inner products vanish for opposite axes too.

    Raises
    ------
    InputError
        If an axis of b is nearer to the opposite of that of a than to it.
    """
    frame_a, frame_b = place.frames
    for k in axes:
        a, b = frame_a.axes[:, k], frame_b.axes[:, k]
        if not a @ b > 0.0:
            raise InputError(
                f"the {'xyz'[k]} axes of {joint.body_a!r} and {joint.body_b!r} are"
                f" {np.degrees(np.arccos(np.clip(a @ b, -1.0, 1.0))):.0f} deg apart at the start",
                source=joint.name,
                key="axes",
                expected="the same direction on both sides",
            )
