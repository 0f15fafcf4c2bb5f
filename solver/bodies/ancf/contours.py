"""Frames and shells as contours: control points of their shape, points that contacts aim at, rows of contacts.

In collisions of triangles, points of their surfaces and rows on these.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.packed_contour import PackedContour
from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, rotate_back
from heavylift.solver.bodies.ancf.joints import apply_inverse_of_meshes, take_impulses
from heavylift.solver.bodies.ancf.kind import MASS_SET, Meshes, MovingPoints
from heavylift.solver.bodies.ancf.moving import (
    body_with_points,
    point_response,
    point_value,
    prepare_points,
    vector_length,
)
from heavylift.solver.bodies.ancf.step import forget_mean_velocity, is_iterated
from heavylift.solver.contact.interface import (
    bound_motion,
    form_controls,
    pose_contours,
    put_contour_rows,
    put_surface_rows,
    settle_points,
)
from heavylift.solver.contact.kind import OF_MESH, ContactRows
from heavylift.solver.contact.triangles.facet_kind import FacetSurfaces
from heavylift.solver.interface import Systems, Workspace, forget_accelerations, joint_rows
from heavylift.solver.kinds import implement

__all__ = [
    "aim_point",
    "bound_facets",
    "form_facets",
    "form_net",
]


# ---- surfaces of triangles ----


@kernel(internal=True)
def _sum_vectors(facets: FacetSurfaces, nodal: NDArray[np.float64], point: int, begin: int) -> Vector:
    """A point of a surface from nodal vectors, which begin at a place."""
    x = y = z = 0.0
    for e in range(facets.first[point], facets.first[point + 1]):
        at, factor = begin + facets.entries[e], facets.factors[e]
        x += factor * nodal[at]
        y += factor * nodal[at + 1]
        z += factor * nodal[at + 2]
    return x, y, z


@kernel(internal=True)
def form_facets(kind: Meshes, facets: FacetSurfaces) -> None:
    """Points of all surfaces of a kind at the stage, in the axes of the nodal coordinates, which stand still."""
    for row in range(facets.rows.shape[0]):
        body = body_with_points(kind, facets.rows[row].dof)
        if body < 0:
            continue
        begin, own = kind.table[body].first_node * len(kind.shape[1]), facets.rows[row].own_point
        first, points = facets.rows[row].first_point, facets.points
        for i in range(facets.rows[row].points):
            x, y, z = _sum_vectors(facets, kind.mid_position, own + i, begin)
            points[first + i, 0], points[first + i, 1], points[first + i, 2] = x, y, z


@kernel(internal=True)
def bound_facets(kind: Meshes, contacts: ContactRows, step: float) -> None:
    """How far the fastest point of each surface moves in the step at the velocity of the stage, into its pose."""
    facets = contacts.facets
    for row in range(facets.rows.shape[0]):
        body = body_with_points(kind, facets.rows[row].dof)
        if body < 0:
            continue
        begin, own = kind.table[body].first_node * len(kind.shape[1]), facets.rows[row].own_point
        fastest = 0.0
        for i in range(facets.rows[row].points):
            x, y, z = _sum_vectors(facets, kind.mid_velocity, own + i, begin)
            fastest = max(fastest, x * x + y * y + z * z)
        contacts.poses[facets.rows[row].pose].step_shift = step * math.sqrt(fastest)


@kernel(internal=True)
def _aim_at(
    moving: MovingPoints,
    kind: Meshes,
    body: int,
    facets: FacetSurfaces,
    row: int,
    slot: int,
    work: Workspace,
    at: int,
) -> None:
    """A moving point becomes the touched point; its velocity into the workspace."""
    shift, own = kind.table[body].first_node * len(kind.shape[1]), facets.rows[row].own_point
    point = moving.bodies[body].first_point + slot
    begin = moving.points[point].first_entry
    end = begin
    for corner in range(3):
        share, of = facets.shares[corner], own + facets.corners[corner]
        if share == 0.0:
            continue
        for e in range(facets.first[of], facets.first[of + 1]):
            place, factor = shift + facets.entries[e], share * facets.factors[e]
            to = end - 1  # neighbours have vectors in common
            while to >= begin and moving.entries[to] != place:
                to -= 1
            if to < begin:
                to = end
                end += 1
                moving.entries[to], moving.factors[to] = place, 0.0
            moving.factors[to] += factor
    moving.points[point].entry_count = end - begin
    moving.points[point].live = True
    moving.points[point].current_set = -1
    x, y, z = point_value(moving, kind, point, kind.velocity)
    work.velocity[at], work.velocity[at + 1], work.velocity[at + 2] = x, y, z


@implement(put_surface_rows, Meshes)
@kernel(internal=True)
def put_rows_on_meshes(kind: Meshes, contacts: ContactRows, contact: int, side: int, work: Workspace) -> None:
    """Directions of the contact into the columns of the moving point, zeros into all others."""
    attachment, facets = 2 * contact + side, contacts.facets
    number = contacts.table[contact].axes if side == 1 else contacts.table[contact].contour
    row = facets.row_of[number] if facets.rows.shape[0] > 0 else -1
    body = body_with_points(kind, facets.rows[row].dof) if row >= 0 else -1
    if body < 0:
        return
    sign, slot = 2.0 * side - 1.0, contacts.state[contact].slots[side]
    lanes, scratch = len(contacts.shape[1]), contacts.scratch
    pose, width = contacts.poses[number], contacts.attachments[attachment].width
    column = width - 3 * kind.table[body].moving_count + 3 * slot
    _aim_at(kind.moving, kind, body, facets, row, slot, work, kind.table[body].dof + column)
    panel = contacts.attachments[attachment].panel
    for k in range(width * lanes):
        contacts.panels[panel + k] = 0.0
    panel += column * lanes
    for r in range(3):
        d = scratch.directions[r]
        d1, d2, d3 = rotate_back(pose.rotation, d)
        contacts.panels[panel + r] = sign * d1
        contacts.panels[panel + lanes + r] = sign * d2
        contacts.panels[panel + 2 * lanes + r] = sign * d3


# ---- the shape ----


# ---- splines ----


@kernel(internal=True)
def form_net(
    kind: Meshes,
    dof: int,
    nodal: Floats1,
    contour: PackedContour,
    u: tuple[int, int],
    v: tuple[int, int],
    net: NDArray[np.float64],
) -> None:
    """Control points of a window of the shape of the mesh whose first velocity is `dof`, from a nodal vector.

    Both ends of the window, in u and in v, belong to it, and one of a ring goes round.
    """
    moving = kind.moving
    body = body_with_points(kind, dof)
    if body < 0:
        return
    count_u, count_v = contour.u.count, contour.v.count
    origin, q = moving.bodies[body].first_control, nodal
    for i in range(u[0], u[1] + 1):
        for j in range(v[0], v[1] + 1):
            local = (i % count_u) * count_v + j % count_v
            x = y = z = 0.0
            for k in range(4):
                at, factor = (
                    moving.control_places[origin + local, k],
                    moving.control_factors[origin + local, k],
                )
                x += factor * q[at]
                y += factor * q[at + 1]
                z += factor * q[at + 2]
            to = contour.first_control + local
            net[to, 0], net[to, 1], net[to, 2] = x, y, z


@implement(form_controls, Meshes)
@kernel(internal=True)
def form_contour_controls(
    kind: Meshes, contacts: ContactRows, contour: int, first_u: int, last_u: int, first_v: int, last_v: int
) -> None:
    """Of the stage."""
    row = contacts.contours[contour]
    if row.owner == OF_MESH:
        u, v = (first_u, last_u), (first_v, last_v)
        form_net(kind, row.dof, kind.mid_position, row, u, v, contacts.net)


@implement(pose_contours, Meshes)
@kernel(internal=True)
def pose_mesh_contours(kind: Meshes, at_midpoint: bool, contacts: ContactRows) -> None:
    """The axes stand still; of the carried state the coordinates are those of the stage."""
    if not at_midpoint:
        for i in range(kind.position.shape[0]):
            kind.mid_position[i] = kind.position[i]
    form_facets(kind, contacts.facets)


# ---- moving points ----


@kernel(internal=True)
def aim_point(
    moving: MovingPoints,
    kind: Meshes,
    dof: int,
    slot: int,
    controls: NDArray[np.int64],
    weights: NDArray[np.float64],
    first: int,
    count: int,
) -> None:
    """What a moving point of the mesh whose first velocity is `dof` is from now on.

    It is the sum of `count` control points of the shape times their weights, which begin at a place; control (i, j) has
    the number ``i count_v + j``. Control points of several elements may take part, as under a footprint. Weights that
    are derivatives of basis functions make it a tangent instead of a point.
    """
    body = body_with_points(kind, dof)
    if body < 0:
        return
    point = moving.bodies[body].first_point + slot
    begin, origin = moving.points[point].first_entry, moving.bodies[body].first_control
    end = begin
    for c in range(count):
        weight, row = weights[first + c], origin + controls[c]
        if weight == 0.0:
            continue
        for k in range(4):
            factor, place = weight * moving.control_factors[row, k], moving.control_places[row, k]
            if factor == 0.0:
                continue
            at = end - 1  # neighbours have vectors in common
            while at >= begin and moving.entries[at] != place:
                at -= 1
            if at < begin:
                at = end
                end += 1
                moving.entries[at], moving.factors[at] = place, 0.0
            moving.factors[at] += factor
    moving.points[point].entry_count = end - begin
    moving.points[point].live = True
    moving.points[point].current_set = -1


@kernel(internal=True)
def _settle(moving: MovingPoints, kind: Meshes, systems: Systems, at_midpoint: bool, work: Workspace) -> None:
    """`settle_points` of a kind."""
    take_impulses(kind, systems, kind.velocity_change)
    for body in range(kind.table.shape[0]):
        first, count = moving.bodies[body].first_point, kind.table[body].moving_count
        which = kind.body[body].stage_set if at_midpoint else MASS_SET
        prepare_points(moving, kind, body, which)
        # bodies that iterate contain all impulses in their velocities of the midpoint
        solved = at_midpoint and is_iterated(kind, body) and kind.body[body].change >= 0.0
        dof = kind.table[body].dof + 3 * kind.table[body].base_count
        for i in range(count):
            if not moving.points[first + i].live:
                continue
            x, y, z = point_value(moving, kind, first + i, kind.mid_velocity if solved else kind.velocity)
            if at_midpoint and not solved:
                a, b, c = point_response(moving, kind, first + i, body, which, kind.forward_solution)
                x, y, z = x + a, y + b, z + c
            at = dof + 3 * i
            work.velocity[at], work.velocity[at + 1], work.velocity[at + 2] = x, y, z
            if not solved:
                _add_pushes(moving, kind, body, i, work.velocity, at)
    for i in range(joint_rows(systems)):
        apply_inverse_of_meshes(kind, at_midpoint, joint_rows(systems, i))


@kernel(internal=True)
def _add_pushes(
    moving: MovingPoints, kind: Meshes, body: int, slot: int, velocity: NDArray[np.float64], at: int
) -> None:
    """What impulses do to a moving point; minus them stands in `velocity_change`."""
    bases, count = kind.table[body].base_count, kind.table[body].moving_count
    length = vector_length(kind, body)
    begin = moving.points[moving.bodies[body].first_point + slot].vectors
    begin -= kind.table[body].first_node * len(kind.shape[1])
    first = kind.table[body].first_base
    for base in range(first, first + bases + count):
        place = kind.bases[base].place
        moves = base - first - bases
        row = moving.bodies[body].compliance + 9 * slot * count + 3 * moves
        for c in range(3):
            push = kind.velocity_change[place + c]
            if push == 0.0:
                continue
            for k in range(3):
                if moves < 0:
                    velocity[at + k] += moving.vectors[begin + k * length + place + c] * push
                else:
                    velocity[at + k] -= moving.compliance[row + 3 * k * count + c] * push


@implement(settle_points, Meshes)
@kernel(internal=True)
def settle_points_of_meshes(kind: Meshes, systems: Systems, at_midpoint: bool, work: Workspace) -> None:
    """From the right-hand side of the stage, forward-substituted, and from the impulses on bases and points."""
    _settle(kind.moving, kind, systems, at_midpoint, work)


# ---- rows of contacts ----


@implement(put_contour_rows, Meshes)
@kernel(internal=True)
def put_mesh_contour_rows(kind: Meshes, contacts: ContactRows, contact: int, count: int) -> None:
    """``-d`` into the columns of the moving point, ``-e`` into those of the tangent beside a curve."""
    contour = contacts.table[contact].contour
    if contacts.contours[contour].owner != OF_MESH:
        return
    dof, slot = contacts.contours[contour].dof, contacts.table[contact].slot
    body = body_with_points(kind, dof)
    if body < 0:
        return
    lanes, scratch, pose = len(contacts.shape[1]), contacts.scratch, contacts.poses[contour]
    side = 2 * contact
    column = contacts.attachments[side].width - 3 * kind.table[body].moving_count + 3 * slot
    panel = contacts.attachments[side].panel + column * lanes
    aim_point(kind.moving, kind, dof, slot, contacts.places, scratch.weights, 0, count)
    beside, turning = pose.radius > 0.0 or pose.width > 0.0, scratch.has_slopes
    if turning:
        aim_point(kind.moving, kind, dof, slot + 1, contacts.places, scratch.slope_weights, 0, count)
    for r in range(3):
        d = scratch.directions[r]
        d1, d2, d3 = rotate_back(pose.rotation, d)
        contacts.panels[panel + r] = -d1
        contacts.panels[panel + lanes + r] = -d2
        contacts.panels[panel + 2 * lanes + r] = -d3
        if beside:
            for k in range(3):
                slope = scratch.slopes[r, k] if turning else 0.0
                contacts.panels[panel + (3 + k) * lanes + r] = -slope


@implement(bound_motion, Meshes)
@kernel(internal=True)
def bound_mesh_motion(kind: Meshes, contacts: ContactRows, step: float, work: Workspace) -> None:
    """The fastest control point: all points of the shape are between them, and move by the velocity of the stage."""
    moving, speed = kind.moving, kind.mid_velocity
    for contour in range(contacts.contours.shape[0]):
        row = contacts.contours[contour]
        body = body_with_points(kind, row.dof) if row.owner == OF_MESH else -1
        if body < 0:
            continue
        origin = moving.bodies[body].first_control
        largest = 0.0
        for control in range(origin, origin + row.u.count * row.v.count):
            x = y = z = 0.0
            for k in range(4):
                at, factor = moving.control_places[control, k], moving.control_factors[control, k]
                x += factor * speed[at]
                y += factor * speed[at + 1]
                z += factor * speed[at + 2]
            largest = max(largest, x * x + y * y + z * z)
        contacts.poses[contour].step_shift = step * math.sqrt(largest)
    bound_facets(kind, contacts, step)


@implement(forget_accelerations, Meshes)
@kernel(internal=True)
def forget_mesh_accelerations(kind: Meshes) -> None:
    """Of all nodes."""
    for body in range(kind.table.shape[0]):
        forget_mean_velocity(kind, body)
