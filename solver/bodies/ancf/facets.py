"""Frames and shells in collisions of triangles: points of their surfaces, and rows on them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate_back
from heavylift.solver.bodies.ancf.kind import Meshes, MovingPoints
from heavylift.solver.bodies.ancf.moving import body_with_points, point_value
from heavylift.solver.contact.interface import put_surface_rows
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.facet_kind import FacetSurfaces
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement

__all__ = ["bound_facets", "form_facets"]


@kernel(internal=True)
def _sum_vectors(
    facets: FacetSurfaces, nodal: NDArray[np.float64], point: int, begin: int
) -> tuple[float, float, float]:
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
    row = facets.row_of[number]
    body = body_with_points(kind, facets.rows[row].dof)
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
