"""Contacts between triangles of which a side deforms: its points at each stage, and rows on what they are made of.

A point of a frame or shell is material, so the touched point is a sum of the corners of its triangle or edge, with the
shares it has there, and so is its velocity. Rows take it as a moving point of its body
(`heavylift.solver.contact.interface`). Both bodies are pushed in the point of the middle surface or axis, so that
friction leaves no moment between them; of two bodies that deform each in its own.

A body with modes has a frame, which is pushed like a rigid body, half way between both surfaces; its modes are pushed
by the displacements of the touched point.
"""

from __future__ import annotations

from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    EDGE_VERTEX,
    FACE_VERTEX,
    VERTEX_EDGE,
    VERTEX_FACE,
    to_axes_of_b,
)
from heavylift.contours.triangles.surface_pack import CollisionSurfaces
from heavylift.contours.triangles.surface_refit import refit_surface
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, cross, rotate_back, subtract, vector
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.interface import put_surface_rows
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.search.contour_rows import put_pose_rows
from heavylift.solver.contact.triangles.facet_kind import FacetSurfaces
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.modal_facets import modal_row
from heavylift.solver.interface import Bodies, Workspace

__all__ = ["refit_facets", "take_slots", "touch_facets"]


@kernel(internal=True)
def refit_facets(contacts: ContactRows, surfaces: CollisionSurfaces) -> None:
    """Normals, edges and trees of all surfaces that deform, from their points of the stage."""
    for row in range(contacts.facets.rows.shape[0]):
        refit_surface(surfaces, contacts.facets.rows[row].surface)


@kernel(internal=True)
def take_slots(meshes: SurfacePairs, contacts: ContactRows, contact: int) -> None:
    """Moving points for a new contact of its pair, the first ones that no other contact has; -1 if all are taken."""
    state, facets = contacts.state[contact], contacts.facets
    for side in range(2):
        row = deforming_row(meshes, contacts, contact, side)
        state.slots[side] = 0
        if row < 0:
            continue
        found = -1
        for slot in range(facets.rows[row].first_slot, facets.rows[row].last_slot):
            if not _is_taken(meshes, contacts, contact, facets.rows[row].dof, slot):
                found = slot
                break
        state.slots[side] = found
        if found < 0:
            state.slots[0] = -1
            return


@kernel(inline=True, internal=True)
def deforming_row(meshes: SurfacePairs, contacts: ContactRows, contact: int, side: int) -> int:
    """Row of the surface of a contact on one side, -1 if it is rigid."""
    if contacts.facets.rows.shape[0] == 0:
        return -1
    return contacts.facets.row_of[meshes.pairs[contacts.state[contact].pair].poses[side]]


@kernel(internal=True)
def _is_taken(meshes: SurfacePairs, contacts: ContactRows, contact: int, dof: int, slot: int) -> bool:
    """Whether another contact between triangles has a moving point of a body."""
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        state = contacts.state[c]
        for side in range(2):
            of = meshes.sides[2 * state.pair + side].dof
            if c != contact and of == dof and state.slots[side] == slot:
                return True
    return False


@kernel(internal=True)
def _share_on_edge(facets: FacetSurfaces, meshes: SurfacePairs, edge: int, x: Vector) -> None:
    """Of a point of the line along an edge."""
    points = meshes.surfaces.points
    a, b = meshes.surfaces.edges[edge].ends[0], meshes.surfaces.edges[edge].ends[1]
    along = square = 0.0
    for k in range(3):
        d = points[b, k] - points[a, k]
        along += (x[k] - points[a, k]) * d
        square += d * d
    facets.corners[0], facets.corners[1], facets.corners[2] = a, b, b
    facets.shares[0], facets.shares[1], facets.shares[2] = 1.0 - along / square, along / square, 0.0


@kernel(internal=True)
def _share_in_face(facets: FacetSurfaces, meshes: SurfacePairs, face: int, x: Vector) -> None:
    """Of a point of the plane of a triangle (Ericson, *Real-Time Collision Detection*, 2005, section 3.4)."""
    points = meshes.surfaces.points
    a, b, c = (
        meshes.surfaces.triangles[face].corners[0],
        meshes.surfaces.triangles[face].corners[1],
        meshes.surfaces.triangles[face].corners[2],
    )
    n = meshes.surfaces.normals[face]
    u1, u2, u3 = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    v1, v2, v3 = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
    r1, r2, r3 = x[0] - points[a, 0], x[1] - points[a, 1], x[2] - points[a, 2]
    t1, t2, t3 = cross((u1, u2, u3), (v1, v2, v3))
    area = t1 * n[0] + t2 * n[1] + t3 * n[2]
    t1, t2, t3 = cross((r1, r2, r3), (v1, v2, v3))
    at_b = (t1 * n[0] + t2 * n[1] + t3 * n[2]) / area
    t1, t2, t3 = cross((u1, u2, u3), (r1, r2, r3))
    at_c = (t1 * n[0] + t2 * n[1] + t3 * n[2]) / area
    facets.corners[0], facets.corners[1], facets.corners[2] = a, b, c
    facets.shares[0], facets.shares[1], facets.shares[2] = 1.0 - at_b - at_c, at_b, at_c


@kernel(internal=True)
def _share(
    facets: FacetSurfaces,
    meshes: SurfacePairs,
    kind: int,
    feature: int,
    second: bool,
    surface: int,
    x: Vector,
) -> None:
    """Corners and shares of the touched point on one side, which is x in the axes of the surface."""
    own_face = FACE_VERTEX if second else VERTEX_FACE
    own_edge = EDGE_VERTEX if second else VERTEX_EDGE
    if kind == own_face:
        _share_in_face(facets, meshes, feature, x)
    elif kind == EDGE_EDGE or kind == own_edge:  # noqa: PLR1714, SIM109  a set costs time here
        _share_on_edge(facets, meshes, feature, x)
    else:
        facets.corners[0] = facets.corners[1] = facets.corners[2] = feature
        facets.shares[0], facets.shares[1], facets.shares[2] = 1.0, 0.0, 0.0
    for k in range(3):
        facets.corners[k] -= meshes.surfaces.surfaces[surface].first_point


@kernel(internal=True)
def touch_facets(
    meshes: SurfacePairs, contacts: ContactRows, bodies: Bodies, work: Workspace, contact: int
) -> None:
    """Rows of a contact of which a side deforms, in place of what rigid bodies have there; directions are found."""
    facets, state, touch, scratch = contacts.facets, contacts.state[contact], meshes.touch, contacts.scratch
    pair = state.pair
    rows = (deforming_row(meshes, contacts, contact, 0), deforming_row(meshes, contacts, contact, 1))
    modal = (modal_row(meshes, contacts, pair, 0), modal_row(meshes, contacts, pair, 1))
    relative = meshes.relative[pair]
    for side in range(2):
        if modal[side] >= 0:
            x = to_axes_of_b(touch.point_b, relative) if side == 1 else vector(touch.point_a)
            feature = state.other_feature if side == 1 else state.feature
            surface = meshes.pairs[pair].surfaces[side]
            _share(facets, meshes, state.feature_kind, feature, side == 1, surface, x)
            put_surface_rows(bodies, contacts, contact, side, work)
    if rows[0] < 0 and rows[1] < 0:
        return
    for side in range(2):
        row = rows[side]
        point = touch.point_b if (side == 1) == (row >= 0) else touch.point_a
        x = point[0], point[1], point[2]
        if side == 1:
            origin = relative.origin
            x = rotate_back(relative.rotation, subtract(x, origin))
        if row >= 0:
            feature = state.other_feature if side == 1 else state.feature
            _share(facets, meshes, state.feature_kind, feature, side == 1, facets.rows[row].surface, x)
            put_surface_rows(bodies, contacts, contact, side, work)
        else:
            scratch.lever[0], scratch.lever[1], scratch.lever[2] = x
            pose = meshes.pairs[pair].poses[side]
            put_pose_rows(contacts, 2 * contact + side, pose, 2.0 * side - 1.0)
