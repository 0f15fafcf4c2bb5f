"""Rigid bodies of a case, and how the frames of bodies start and move."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.pipeline.assemble.described import assemble
from heavylift.pipeline.assemble.sides import Side

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.numerics.outcome import InputError
    from heavylift.pipeline.case.bodies import RigidBodySection, RigidInitialSection
    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.results.storage import OutputFolder
    from heavylift.solver.scene import scene as s
    from heavylift.solver.scene.scene import AnyBody

__all__ = [
    "assemble_body",
    "assemble_rigid",
    "check_drawn_points",
    "check_points",
    "motion_of",
    "start_body",
    "start_of_frame",
]


def assemble_body(
    case: Case, name: str, body: Any, _folder: OutputFolder
) -> tuple[AnyBody, NDArray[np.float64]]:
    """Body of a case that is given in numbers alone, and the origin of its frame in the coordinates of its geometry."""
    return start_body(case, name, body)


def start_body(_case: Case, name: str, body: Any) -> tuple[AnyBody, NDArray[np.float64]]:
    """The same: nothing of it waits for a stage."""
    if body.has_frame:
        return assemble_rigid(name, body)
    origin = np.zeros(3)
    given = {"name": name, **start_of_frame(body.initial, origin)}
    return assemble(body, {name: Side(np.zeros(3), np.eye(3), origin)}, Path(), name, **given), origin


def check_points(
    _case: Case, _body: AnyBody, _origin: NDArray[np.float64], _points: Sequence[tuple[str, ArrayLike]]
) -> None:
    """Any point is one of a rigid body."""


def check_drawn_points(
    _case: Case, _section: Any, _body: AnyBody, _points: Sequence[tuple[str, ArrayLike]]
) -> list[tuple[str, InputError]]:
    """Any point is one of a rigid body."""
    return []


def assemble_rigid(name: str, body: RigidBodySection) -> tuple[s.RigidBody, NDArray[np.float64]]:
    """Rigid body of a case, and the origin of its frame in the coordinates of its geometry [m]."""
    origin = np.array(body.drawn_origin)
    given = {"name": name, "motion": motion_of(body.frame), **start_of_frame(body.initial, origin)}
    rigid = assemble(body, {name: Side(np.zeros(3), np.eye(3), origin)}, Path(), name, **given)
    return rigid, origin


def start_of_frame(
    initial: RigidInitialSection, origin: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Initial state of a frame; by default the position of its geometry."""
    orientation = np.array([1.0, 0.0, 0.0, 0.0])
    if initial.orientation is not None:
        from heavylift.numerics.rotation import quaternion_from_rotation_vector

        axis: NDArray[np.float64] = np.array(initial.orientation.axis)
        angle = math.fmod(
            initial.orientation.angle, 4.0 * math.pi
        )  # whole turns would overflow, if there are many
        orientation = quaternion_from_rotation_vector(angle * axis / np.linalg.norm(axis))
    return {
        "position": origin.copy() if initial.position is None else np.array(initial.position),
        "orientation": orientation,
        "velocity": np.array(initial.velocity or (0.0, 0.0, 0.0)),
        "angular_velocity": np.array(initial.angular_velocity or (0.0, 0.0, 0.0)),
    }


def motion_of(frame: Any) -> s.Motion:
    """How a frame moves."""
    made: s.Motion = assemble(frame, {}, Path())
    return made
