"""Frames and shells in collisions of triangles: points of their surfaces, and rows on them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import rotate_back
from heavylift.solver.bodies.ancf.contours import body_with_points
from heavylift.solver.bodies.ancf.kind import (
    CURRENT,
    DOF,
    ENTRIES,
    ENTRY_COUNT,
    FIRST_NODE,
    FIRST_POINT,
    LIVE,
    MID_Q,
    MID_V,
    MOVING,
    FrameMeshes,
    Meshes,
    MovingPoints,
    ShellMeshes,
    V,
)
from heavylift.solver.bodies.ancf.moving import point_value
from heavylift.solver.contact.facet_interface import (
    bound_surface_points,
    form_surface_points,
    put_surface_rows,
)
from heavylift.solver.contact.facet_kind import OF_DOF, OF_POSE, OWN_POINT, POINTS, FacetSurfaces
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.interface import Workspace
from heavylift.solver.kinds import implement
from heavylift.solver.rows import PANEL, WIDTH

__all__: list[str] = []


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


@implement(form_surface_points, FrameMeshes)
@implement(form_surface_points, ShellMeshes)
@kernel(internal=True)
def form_points_of_meshes(
    kind: Meshes, facets: FacetSurfaces, row: int, first: int, points: NDArray[np.float64]
) -> None:
    """In the axes of the nodal coordinates, which stand still."""
    body = body_with_points(kind, facets.rows[row, OF_DOF])
    if body < 0:
        return
    begin, own = kind.table[body, FIRST_NODE] * len(kind.shape[1]), facets.rows[row, OWN_POINT]
    for i in range(facets.rows[row, POINTS]):
        x, y, z = _sum_vectors(facets, kind.nodal[MID_Q], own + i, begin)
        points[first + i, 0], points[first + i, 1], points[first + i, 2] = x, y, z


@implement(bound_surface_points, FrameMeshes)
@implement(bound_surface_points, ShellMeshes)
@kernel(internal=True)
def bound_points_of_meshes(
    kind: Meshes, facets: FacetSurfaces, row: int, contacts: ContactRows, step: float
) -> None:
    """The fastest point."""
    body = body_with_points(kind, facets.rows[row, OF_DOF])
    if body < 0:
        return
    begin, own = kind.table[body, FIRST_NODE] * len(kind.shape[1]), facets.rows[row, OWN_POINT]
    fastest = 0.0
    for i in range(facets.rows[row, POINTS]):
        x, y, z = _sum_vectors(facets, kind.nodal[MID_V], own + i, begin)
        fastest = max(fastest, x * x + y * y + z * z)
    contacts.poses[facets.rows[row, OF_POSE]].step_shift = step * math.sqrt(fastest)


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
    shift, own = kind.table[body, FIRST_NODE] * len(kind.shape[1]), facets.rows[row, OWN_POINT]
    point = moving.bodies[body, FIRST_POINT] + slot
    begin = moving.points[point, ENTRIES]
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
    moving.points[point, ENTRY_COUNT] = end - begin
    moving.points[point, LIVE] = 1
    moving.points[point, CURRENT] = -1
    x, y, z = point_value(moving, kind, point, V)
    work.velocity[at], work.velocity[at + 1], work.velocity[at + 2] = x, y, z


@implement(put_surface_rows, FrameMeshes)
@implement(put_surface_rows, ShellMeshes)
@kernel(internal=True)
def put_rows_on_meshes(
    kind: Meshes,
    facets: FacetSurfaces,
    row: int,
    slot: int,
    contacts: ContactRows,
    attachment: int,
    sign: float,
    work: Workspace,
) -> None:
    """Directions of the contact into the columns of the moving point, zeros into all others."""
    dof = facets.rows[row, OF_DOF]
    body = body_with_points(kind, dof)
    if body < 0:
        return
    lanes, scratch = len(contacts.shape[1]), contacts.scratch
    pose, width = contacts.poses[facets.rows[row, OF_POSE]], contacts.attachments[attachment, WIDTH]
    column = width - 3 * kind.table[body, MOVING] + 3 * slot
    _aim_at(kind.moving, kind, body, facets, row, slot, work, kind.table[body, DOF] + column)
    panel = contacts.attachments[attachment, PANEL]
    for k in range(width * lanes):
        contacts.panels[panel + k] = 0.0
    panel += column * lanes
    for r in range(3):
        d = scratch.directions[r]
        d1, d2, d3 = rotate_back(pose.rotation, d[0], d[1], d[2])
        contacts.panels[panel + r] = sign * d1
        contacts.panels[panel + lanes + r] = sign * d2
        contacts.panels[panel + 2 * lanes + r] = sign * d3
