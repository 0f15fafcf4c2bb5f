"""Contours of rigid bodies: their control points stand still in principal axes through the centre of mass."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.solver.bodies.rigid import RigidBodies
from heavylift.solver.contact.contour_rows import put_frame_rows
from heavylift.solver.contact.interface import (
    bound_motion,
    forget_accelerations,
    pose_contours,
    put_contour_rows,
)
from heavylift.solver.contact.kind import OF_RIGID, ContactRows
from heavylift.solver.drive import FREE
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []


@kernel(inline=True, internal=True)
def owner_of(kind: RigidBodies, contacts: ContactRows, contour: int) -> int:
    """Row of the body that a contour is on, -1 if that is not of this kind."""
    if contacts.contours[contour].owner != OF_RIGID:
        return -1
    body = (contacts.contours[contour].dof - kind.table[0].dof) // 6
    return body if 0 <= body < kind.table.shape[0] else -1  # of another kind: rigid bodies that float


@implement(pose_contours, RigidBodies)
@kernel(internal=True)
def pose_rigid_contours(kind: RigidBodies, at_midpoint: bool, contacts: ContactRows) -> None:
    """Pose of the principal frame."""
    for contour in range(contacts.contours.shape[0]):
        body = owner_of(kind, contacts, contour)
        if body >= 0:
            for k in range(9):
                contacts.poses[contour].rotation[k] = kind.frame[body].mid_rotation[k]
            for k in range(3):
                contacts.poses[contour].origin[k] = kind.frame[body].mid_position[k]


@implement(put_contour_rows, RigidBodies)
@kernel(internal=True)
def put_rigid_contour_rows(kind: RigidBodies, contacts: ContactRows, contact: int, count: int) -> None:
    """The six velocities of the frame."""
    contour = contacts.table[contact].contour
    if owner_of(kind, contacts, contour) >= 0:
        put_frame_rows(contacts, contact)


@implement(bound_motion, RigidBodies)
@kernel(internal=True)
def bound_rigid_motion(kind: RigidBodies, contacts: ContactRows, step: float, work: Workspace) -> None:
    """Velocity, and spin at the largest distance."""
    for contour in range(contacts.contours.shape[0]):
        if owner_of(kind, contacts, contour) >= 0:
            v, w = 0.0, 0.0
            dof = contacts.contours[contour].dof
            for k in range(3):
                v += work.velocity[dof + k] ** 2
                w += work.velocity[dof + 3 + k] ** 2
            contacts.poses[contour].step_shift = step * (
                math.sqrt(v) + math.sqrt(w) * contacts.poses[contour].reach
            )


@implement(forget_accelerations, RigidBodies)
@kernel(internal=True)
def forget_rigid_accelerations(kind: RigidBodies) -> None:
    """Of the frame; that of its spin is Euler's of a body without moments, which the middle of the next step needs."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        w1, w2, w3 = frame.spin[0], frame.spin[1], frame.spin[2]
        i1, i2, i3 = frame.principal_inertia[0], frame.principal_inertia[1], frame.principal_inertia[2]
        for k in range(3):
            frame.acceleration[k] = 0.0
        frame.spin_rate[0] = (i2 - i3) / i1 * w2 * w3
        frame.spin_rate[1] = (i3 - i1) / i2 * w3 * w1
        frame.spin_rate[2] = (i1 - i2) / i3 * w1 * w2
