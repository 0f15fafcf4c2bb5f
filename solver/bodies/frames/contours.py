"""Contours on bodies with a frame: their pose, their rows and how far they move in a step."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.frames.base import FrameBodies
from heavylift.solver.bodies.frames.motion import body_with
from heavylift.solver.contact.interface import bound_motion, keep_places, pose_contours, put_contour_rows
from heavylift.solver.contact.kind import OF_MODAL_FACETS, OF_MODES, OF_RIGID, ContactRows
from heavylift.solver.contact.search.contour_rows import put_frame_rows
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement

__all__ = ["frame_speed", "owner_of"]


@kernel(inline=True, internal=True)
def owner_of(kind: FrameBodies, contacts: ContactRows, contour: int) -> int:
    """Row of the body that a contour is on, -1 if that is not of this kind."""
    owner = contacts.contours[contour].owner
    if owner != OF_RIGID and owner != OF_MODES and owner != OF_MODAL_FACETS:  # noqa: PLR1714  a set costs time here
        return -1
    return body_with(kind, contacts.contours[contour].dof)


@implement(pose_contours, FrameBodies)
@kernel(internal=True)
def pose_frame_contours(kind: FrameBodies, at_midpoint: bool, contacts: ContactRows) -> None:
    """Pose of the frame."""
    for contour in range(contacts.contours.shape[0]):
        body = owner_of(kind, contacts, contour)
        if body >= 0:
            for k in range(9):
                contacts.poses[contour].rotation[k] = kind.frame[body].mid_rotation[k]
            for k in range(3):
                contacts.poses[contour].origin[k] = kind.frame[body].mid_position[k]


@implement(put_contour_rows, FrameBodies)
@kernel(internal=True)
def put_frame_contour_rows(kind: FrameBodies, contacts: ContactRows, contact: int, count: int) -> None:
    """The six velocities of the frame."""
    if owner_of(kind, contacts, contacts.table[contact].contour) >= 0:
        put_frame_rows(contacts, contact)


@kernel(internal=True)
def frame_speed(dof: int, reach: float, work: Workspace) -> float:
    """Largest velocity [m/s] of a point within a distance from the origin of a frame: its own, and its spin there."""
    v, w = 0.0, 0.0
    for k in range(3):
        v += work.velocity[dof + k] ** 2
        w += work.velocity[dof + 3 + k] ** 2
    return math.sqrt(v) + math.sqrt(w) * reach


@implement(bound_motion, FrameBodies)
@kernel(internal=True)
def bound_frame_motion(kind: FrameBodies, contacts: ContactRows, step: float, work: Workspace) -> None:
    """Velocity, and spin at the largest distance."""
    for contour in range(contacts.contours.shape[0]):
        if owner_of(kind, contacts, contour) >= 0:
            dof, reach = contacts.contours[contour].dof, contacts.poses[contour].reach
            contacts.poses[contour].step_shift = step * frame_speed(dof, reach, work)


@implement(keep_places, FrameBodies)
@kernel(internal=True)
def keep_frame_places(kind: FrameBodies, contacts: ContactRows, back: bool) -> None:
    """Position and quaternion."""
    for i in range(contacts.slept.shape[0]):
        slept = contacts.slept[i]
        body = body_with(kind, contacts.sleepers[i].dof) if slept.island > 0 else -1
        if body < 0:
            continue
        frame = kind.frame[body]
        if back:
            for k in range(3):
                frame.position[k] = slept.position[k]
            for k in range(4):
                frame.orientation[k] = slept.orientation[k]
        else:
            for k in range(3):
                slept.position[k] = frame.position[k]
            for k in range(4):
                slept.orientation[k] = frame.orientation[k]
