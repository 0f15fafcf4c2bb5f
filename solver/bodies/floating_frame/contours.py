"""Contours of flexible bodies: control points linear in the modal coordinates, nothing is fitted in a step.

``P(q) = P_0 + P_Phi q`` with constant arrays ("Deformable bodies with complex geometries ... sliding contacts" (2014),
section 3.3, fits the contour anew in every step instead). A touched point is a weighted sum of few control points, so
position, tangents and Jacobian come from the same products of basis functions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.modal_sums import modal_points, modal_shapes
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate_back
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies
from heavylift.solver.bodies.frames.contours import frame_speed, owner_of, pose_frame_contours
from heavylift.solver.bodies.frames.motion import body_with
from heavylift.solver.contact.interface import (
    bound_motion,
    form_controls,
    pose_contours,
    put_contour_rows,
    put_surface_rows,
)
from heavylift.solver.contact.kind import OF_MODES, ContactRows
from heavylift.solver.contact.search.contour_rows import put_frame_rows
from heavylift.solver.drive import FIXED
from heavylift.solver.interface import Workspace, forget_accelerations
from heavylift.solver.kinds import implement

__all__: list[str] = []

AT_ONCE = 512
"""Control points that are formed together: `places` has room for so many."""


@implement(pose_contours, FloatingFrameBodies)
@kernel(internal=True)
def pose_flexible_contours(kind: FloatingFrameBodies, at_midpoint: bool, contacts: ContactRows) -> None:
    """Pose of the frame; of surfaces of triangles the modal coordinates, which contacts form their points from."""
    pose_frame_contours(kind, at_midpoint, contacts)
    modal = contacts.modal
    for row in range(modal.rows.shape[0]):
        body = body_with(kind, modal.rows[row].dof)
        if body >= 0:
            to, first = modal.rows[row].first_coordinate, kind.table[body].first_mode
            for i in range(modal.rows[row].modes):
                modal.coordinates[to + i] = kind.mid_modal_position[first + i]


@implement(form_controls, FloatingFrameBodies)
@kernel(internal=True)
def form_flexible_controls(
    kind: FloatingFrameBodies,
    contacts: ContactRows,
    contour: int,
    first_u: int,
    last_u: int,
    first_v: int,
    last_v: int,
) -> None:
    """``P_0 + P_Phi q``; windows of closed contours go round."""
    body = owner_of(kind, contacts, contour)
    if body < 0:
        return
    row = contacts.contours[contour]
    count = 0
    for i in range(first_u, last_u + 1):
        for j in range(first_v, last_v + 1):
            contacts.places[count] = (i % row.u.count) * row.v.count + j % row.v.count
            count += 1
            if count == AT_ONCE:
                _form_listed(kind, body, contacts, contour, count)
                count = 0
    _form_listed(kind, body, contacts, contour, count)


@kernel(internal=True)
def _form_listed(
    kind: FloatingFrameBodies, body: int, contacts: ContactRows, contour: int, count: int
) -> None:
    """The control points whose numbers stand in `places`."""
    row = contacts.contours[contour]
    modal_points(
        contacts.constants,
        row.controls,
        kind.table[body].mode_count,
        kind.mid_modal_position,
        kind.table[body].first_mode,
        contacts.places,
        count,
        contacts.net,
        row.first_control,
    )


@implement(put_contour_rows, FloatingFrameBodies)
@kernel(internal=True)
def put_flexible_contour_rows(
    kind: FloatingFrameBodies, contacts: ContactRows, contact: int, count: int
) -> None:
    """Frame, then modes: ``-( d . Phi(u, v) + e . Phi_u(u, v) )`` in the axes of the contour."""
    contour = contacts.table[contact].contour
    body = owner_of(kind, contacts, contour)
    if body < 0:
        return
    put_frame_rows(contacts, contact)
    lanes = len(contacts.shape[1])
    n, scratch, shapes = kind.table[body].mode_count, contacts.scratch, contacts.shapes
    panel = contacts.attachments[2 * contact].panel + 6 * lanes
    turning = scratch.has_slopes
    _sum_shapes(contacts, contour, count, n, scratch.weights, 0)
    if turning:
        _sum_shapes(contacts, contour, count, n, scratch.slope_weights, 3 * n)
    pose = contacts.poses[contour]
    for r in range(3):
        d = scratch.directions[r]
        d1, d2, d3 = rotate_back(pose.rotation, d)
        for i in range(n):
            contacts.panels[panel + i * lanes + r] = -(
                d1 * shapes[i] + d2 * shapes[n + i] + d3 * shapes[2 * n + i]
            )
        if turning:
            e1, e2, e3 = scratch.slopes[r, 0], scratch.slopes[r, 1], scratch.slopes[r, 2]
            begin = 3 * n
            for i in range(n):
                contacts.panels[panel + i * lanes + r] -= (
                    e1 * shapes[begin + i] + e2 * shapes[begin + n + i] + e3 * shapes[begin + 2 * n + i]
                )


@kernel(inline=True, internal=True)
def _sum_shapes(
    contacts: ContactRows, contour: int, count: int, n: int, weights: NDArray[np.float64], out: int
) -> None:
    """Weighted mode shapes of some control points, component by component."""
    begin = contacts.contours[contour].controls
    modal_shapes(contacts.constants, begin, n, contacts.places, count, weights, 0, contacts.shapes, out)


@implement(put_surface_rows, FloatingFrameBodies)
@kernel(internal=True)
def put_flexible_surface_rows(
    kind: FloatingFrameBodies, contacts: ContactRows, contact: int, side: int, work: Workspace
) -> None:
    """Modes: ``d . sum w Phi`` of the corners between which the touched point lies; the frame has its rows already."""
    number = contacts.table[contact].axes if side == 1 else contacts.table[contact].contour
    body = owner_of(kind, contacts, number)
    if body < 0:
        return
    modal, facets, shapes = contacts.modal, contacts.facets, contacts.shapes
    one, lanes, sign = modal.rows[modal.row_of[number]], len(contacts.shape[1]), 2.0 * side - 1.0
    n = one.modes
    modal_shapes(modal.shapes, one.shapes, n, facets.corners, 3, facets.shares, 0, shapes, 0)
    panel = contacts.attachments[2 * contact + side].panel + 6 * lanes
    for r in range(3):
        d = contacts.scratch.directions[r]
        d1, d2, d3 = rotate_back(contacts.poses[number].rotation, (sign * d[0], sign * d[1], sign * d[2]))
        for i in range(n):
            contacts.panels[panel + i * lanes + r] = (
                d1 * shapes[i] + d2 * shapes[n + i] + d3 * shapes[2 * n + i]
            )


@implement(bound_motion, FloatingFrameBodies)
@kernel(internal=True)
def bound_flexible_motion(
    kind: FloatingFrameBodies, contacts: ContactRows, step: float, work: Workspace
) -> None:
    """Frame as of rigid bodies, with some room for the deformation, and each mode where its shape is largest."""
    for contour in range(contacts.contours.shape[0]):
        body = owner_of(kind, contacts, contour)
        if body < 0:
            continue
        n, dof = kind.table[body].mode_count, kind.table[body].dof
        row = contacts.contours[contour]
        speed = 0.0
        if row.owner == OF_MODES:
            largest = row.controls + row.u.count * row.v.count * (3 + 3 * n)
            for i in range(n):
                speed += abs(work.velocity[dof + 6 + i]) * contacts.constants[largest + i]
        else:
            modal = contacts.modal
            first = modal.rows[modal.row_of[contour]].first_coordinate
            for i in range(n):
                speed += abs(work.velocity[dof + 6 + i]) * modal.largest[first + i]
        if kind.table[body].motion != FIXED:
            speed += frame_speed(dof, 2.0 * contacts.poses[contour].reach, work)
        contacts.poses[contour].step_shift = step * speed


@implement(forget_accelerations, FloatingFrameBodies)
@kernel(internal=True)
def forget_floating_accelerations(kind: FloatingFrameBodies) -> None:
    """Of frames, modes and products."""
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        for k in range(3):
            frame.acceleration[k] = frame.spin_rate[k] = 0.0
        for k in range(6):
            frame.lag[k] = 0.0
        if kind.table[body].motion == FIXED:  # nothing else brings its stage to the carried state
            first = kind.table[body].first_mode
            for i in range(first, first + kind.table[body].mode_count):
                kind.mid_modal_position[i] = kind.modal_position[i]
                kind.mid_modal_velocity[i] = kind.modal_velocity[i]
    for i in range(kind.modal_position.shape[0]):
        kind.modal_acceleration[i] = 0.0
    for r in range(kind.acceleration_products.shape[0]):
        kind.acceleration_products[r] = 0.0
