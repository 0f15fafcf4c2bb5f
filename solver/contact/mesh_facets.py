"""Contacts between triangles of which a side deforms: its points at each stage, and rows on what they are made of.

A point of a frame or shell is material, so the touched point is a sum of the corners of its triangle or edge, with the
shares it has there, and so is its velocity. Rows take it as a moving point of its body
(`heavylift.solver.contact.interface`). Both bodies are pushed in the point of the middle surface or axis, so that
friction leaves no moment between them; of two bodies that deform each in its own.
"""

from __future__ import annotations

from heavylift.contours.feature_gap import EDGE_EDGE, EDGE_VERTEX, FACE_VERTEX, VERTEX_EDGE, VERTEX_FACE
from heavylift.contours.surface_pack import CollisionSurfaces
from heavylift.contours.surface_refit import refit_surface
from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cross, rotate_back
from heavylift.solver.contact.contour_rows import put_pose_rows
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.facet_interface import (
    bound_facets,
    bound_surface_points,
    form_facets,
    form_surface_points,
    put_surface_rows,
    take_slots,
    touch_facets,
)
from heavylift.solver.contact.facet_kind import FacetSurfaces
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.mesh_kind import SurfacePairs
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__: list[str] = []

Vector = tuple[float, float, float]


@implement(form_facets, FacetSurfaces)
@kernel(internal=True)
def form_facet_points(facets: FacetSurfaces, surfaces: CollisionSurfaces, bodies: Bodies) -> None:
    """Surface by surface."""
    for row in range(facets.rows.shape[0]):
        surface = facets.rows[row].surface
        form_surface_points(bodies, facets, row, surfaces.surfaces[surface].first_point, surfaces.points)
        refit_surface(surfaces, surface)


@implement(bound_facets, FacetSurfaces)
@kernel(internal=True)
def bound_facet_motion(facets: FacetSurfaces, contacts: ContactRows, bodies: Bodies, step: float) -> None:
    """Surface by surface."""
    for row in range(facets.rows.shape[0]):
        bound_surface_points(bodies, facets, row, contacts, step)


@implement(take_slots, FacetSurfaces)
@kernel(internal=True)
def take_contact_slots(
    facets: FacetSurfaces, meshes: SurfacePairs, contacts: ContactRows, contact: int
) -> None:
    """The first one of the body that no other contact has."""
    pair = contacts.state[contact].pair
    for side in range(2):
        row = facets.row_of[meshes.pairs[pair].surfaces[side]]
        contacts.state[contact].slots[side] = 0
        if row < 0:
            continue
        found = -1
        for slot in range(facets.rows[row].first_slot, facets.rows[row].last_slot):
            if not _is_taken(meshes, contacts, contact, facets.rows[row].dof, slot):
                found = slot
                break
        contacts.state[contact].slots[side] = found
        if found < 0:
            contacts.state[contact].slots[0] = -1
            return


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
    t1, t2, t3 = cross(u1, u2, u3, v1, v2, v3)
    area = t1 * n[0] + t2 * n[1] + t3 * n[2]
    t1, t2, t3 = cross(r1, r2, r3, v1, v2, v3)
    at_b = (t1 * n[0] + t2 * n[1] + t3 * n[2]) / area
    t1, t2, t3 = cross(u1, u2, u3, r1, r2, r3)
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


@implement(touch_facets, FacetSurfaces)
@kernel(internal=True)
def touch_facet_contact(
    facets: FacetSurfaces,
    meshes: SurfacePairs,
    contacts: ContactRows,
    bodies: Bodies,
    work: Workspace,
    contact: int,
) -> None:
    """Side by side, in place of what rigid bodies have there."""
    state, touch, scratch = contacts.state[contact], meshes.touch, contacts.scratch
    pair = state.pair
    first, second = meshes.pairs[pair].surfaces[0], meshes.pairs[pair].surfaces[1]
    if facets.row_of[first] < 0 and facets.row_of[second] < 0:
        return
    relative = meshes.relative[pair]
    for side in range(2):
        row = facets.row_of[meshes.pairs[pair].surfaces[side]]
        point = touch.point_b if (side == 1) == (row >= 0) else touch.point_a
        x = point[0], point[1], point[2]
        if side == 1:
            origin = relative.origin
            x = rotate_back(relative.rotation, x[0] - origin[0], x[1] - origin[1], x[2] - origin[2])
        if row >= 0:
            feature = state.other_feature if side == 1 else state.feature
            _share(facets, meshes, state.feature_kind, feature, side == 1, facets.rows[row].surface, x)
            slot = state.slots[side]
            put_surface_rows(bodies, facets, row, slot, contacts, 2 * contact + side, 2.0 * side - 1.0, work)
        else:
            scratch.lever[0], scratch.lever[1], scratch.lever[2] = x
            pose = meshes.pairs[pair].poses[side]
            put_pose_rows(contacts, 2 * contact + side, pose, 2.0 * side - 1.0)
