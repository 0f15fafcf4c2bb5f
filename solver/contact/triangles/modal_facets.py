"""Points of surfaces that deform with modes: formed where something is near, everywhere when a list is made anew."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.modal_sums import modal_points
from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    EDGE_VERTEX,
    FACE_VERTEX,
    VERTEX_EDGE,
    VERTEX_FACE,
)
from heavylift.contours.triangles.pair_search import list_holds
from heavylift.contours.triangles.surface_layout import RelativeMotion
from heavylift.contours.triangles.surface_pack import CollisionSurfaces
from heavylift.contours.triangles.surface_refit import refit_features, refit_surface
from heavylift.numerics.jit import kernel
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.modal_kind import ModalSurfaces

__all__ = ["follow_modes", "make_whole", "modal_row", "place_near", "place_touched"]


@kernel(inline=True, internal=True)
def modal_row(meshes: SurfacePairs, contacts: ContactRows, pair: int, side: int) -> int:
    """Row of the surface of a pair on one side, -1 if it does not deform with modes."""
    if contacts.modal.rows.shape[0] == 0:
        return -1
    return contacts.modal.row_of[meshes.pairs[pair].poses[side]]


@kernel(internal=True)
def make_whole(modal: ModalSurfaces, surfaces: CollisionSurfaces, row: int) -> None:
    """Place all points of a surface, and bring all that follows from them up to date.

    What its points have travelled has been counted by the coordinates; `reaches` and `middles` stay those of the
    undeformed surface, since they must not depend on when this was done.
    """
    one = modal.rows[row]
    if one.whole:
        return
    s = one.surface
    _place(modal, surfaces, row, modal.everything, one.points)
    travel, reach = surfaces.travels[s], surfaces.reaches[s]
    x, y, z = surfaces.middles[s, 0], surfaces.middles[s, 1], surfaces.middles[s, 2]
    refit_surface(surfaces, s)
    surfaces.travels[s], surfaces.reaches[s] = travel, reach
    surfaces.middles[s, 0], surfaces.middles[s, 1], surfaces.middles[s, 2] = x, y, z
    one.whole = True


@kernel(internal=True)
def _place(
    modal: ModalSurfaces, surfaces: CollisionSurfaces, row: int, points: NDArray[np.int64], count: int
) -> None:
    """``X + Phi q`` of some points of a surface."""
    one = modal.rows[row]
    modal_points(
        modal.shapes,
        one.shapes,
        one.modes,
        modal.coordinates,
        one.first_coordinate,
        points,
        count,
        surfaces.points,
        one.first_point,
    )


@kernel(internal=True)
def follow_modes(meshes: SurfacePairs, contacts: ContactRows, first: bool) -> None:
    """Before a search: how far points can have moved since the last one, and what is needed where it is now."""
    modal, surfaces = contacts.modal, meshes.surfaces
    if modal.rows.shape[0] == 0:
        return
    _find_needed(meshes, modal)
    for row in range(modal.rows.shape[0]):
        one = modal.rows[row]
        way = 0.0
        for i in range(one.first_coordinate, one.first_coordinate + one.modes):
            way += abs(modal.coordinates[i] - modal.placed[i]) * modal.largest[i]
            modal.placed[i] = modal.coordinates[i]
        surfaces.travels[one.surface] += way
        one.whole = one.whole and way == 0.0
        if not one.whole and one.needed > 0:
            needed = modal.needed[one.first_needed : one.first_needed + one.needed]
            _place(modal, surfaces, row, needed, one.needed)
            refit_features(
                surfaces,
                modal.triangles,
                one.first_triangle,
                one.triangles,
                modal.edges,
                one.first_edge,
                one.edges,
            )
        if first:
            make_whole(modal, surfaces, row)
    _place_contacts(meshes, contacts)


@kernel(internal=True)
def place_near(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, motion: RelativeMotion, reach: float
) -> None:
    """Before the search of a pair: if its list does not hold, whole surfaces to make another one from."""
    modal = contacts.modal
    a, b = modal_row(meshes, contacts, pair, 0), modal_row(meshes, contacts, pair, 1)
    if (a < 0 and b < 0) or list_holds(meshes.surfaces, modal.lists, pair, motion, reach):
        return
    if a >= 0:
        make_whole(modal, meshes.surfaces, a)
    if b >= 0:
        make_whole(modal, meshes.surfaces, b)


@kernel(internal=True)
def place_touched(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Points that contacts are between, at any stage, and normals of their faces."""
    for row in range(contacts.modal.rows.shape[0]):
        # coordinates of a stage are none of a search: what that needs is formed anew
        contacts.modal.rows[row].whole = False
    if contacts.modal.rows.shape[0] > 0:
        _place_contacts(meshes, contacts)


@kernel(internal=True)
def _place_contacts(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Features of all contacts."""
    modal, surfaces = contacts.modal, meshes.surfaces
    for c in range(contacts.counts.of_contours, contact_count(contacts)):
        for side in range(2):
            row = modal_row(meshes, contacts, contacts.state[c].pair, side)
            if row >= 0 and not modal.rows[row].whole:
                _place_feature(modal, surfaces, row, contacts, c, side)


@kernel(internal=True)
def _place_feature(
    modal: ModalSurfaces, surfaces: CollisionSurfaces, row: int, contacts: ContactRows, c: int, side: int
) -> None:
    """Of one side of a contact."""
    state, kind = contacts.state[c], contacts.state[c].feature_kind
    feature = state.other_feature if side == 1 else state.feature
    first = modal.rows[row].first_point
    corners, count = contacts.facets.corners, 1
    if kind == (FACE_VERTEX if side == 1 else VERTEX_FACE):
        count = 3
        for k in range(3):
            corners[k] = surfaces.triangles[feature].corners[k] - first
    elif kind in (EDGE_EDGE, EDGE_VERTEX if side == 1 else VERTEX_EDGE):
        count = 2
        for k in range(2):
            corners[k] = surfaces.edges[feature].ends[k] - first
    else:
        corners[0] = feature - first
    _place(modal, surfaces, row, corners, count)
    if count == 3:
        corners[0] = feature
        refit_features(surfaces, corners, 0, 1, corners, 0, 0)


# ---- what is needed ----


@kernel(internal=True)
def _find_needed(meshes: SurfacePairs, modal: ModalSurfaces) -> None:
    """Triangles on the lists of near ones, their edges, and all points next to them; if a list is another one."""
    table = modal.lists.table
    traversals = 0
    for pair in range(table.shape[0]):
        traversals += table[pair].traversals
    if traversals == modal.state.traversals:
        return
    modal.state.traversals = traversals
    modal.state.mark += 1
    for row in range(modal.rows.shape[0]):
        modal.rows[row].needed = modal.rows[row].triangles = modal.rows[row].edges = 0
    for pair in range(table.shape[0]):
        one = table[pair]
        a, b = modal.row_of_surface[one.surface_a], modal.row_of_surface[one.surface_b]
        if a < 0 and b < 0:
            continue
        for i in range(one.first, one.first + one.count):
            if a >= 0:
                _need_triangle(modal, meshes.surfaces, a, modal.lists.pairs[i, 0])
            if b >= 0:
                _need_triangle(modal, meshes.surfaces, b, modal.lists.pairs[i, 1])


@kernel(internal=True)
def _need_triangle(modal: ModalSurfaces, surfaces: CollisionSurfaces, row: int, triangle: int) -> None:
    """With its edges, and what lies beside these."""
    mark, one = modal.state.mark, modal.rows[row]
    if modal.triangle_marks[triangle] == mark:
        return
    modal.triangle_marks[triangle] = mark
    modal.triangles[one.first_triangle + one.triangles] = triangle
    one.triangles += 1
    for k in range(3):
        corner, edge = surfaces.triangles[triangle].corners[k], surfaces.triangles[triangle].edges[k]
        _need_point(modal, surfaces, row, corner)
        for i in range(surfaces.vertex_first[corner], surfaces.vertex_first[corner + 1]):
            _need_point(modal, surfaces, row, surfaces.vertex_neighbours[i])
        if edge < 0 or modal.edge_marks[edge] == mark:
            continue
        modal.edge_marks[edge] = mark
        modal.edges[one.first_edge + one.edges] = edge
        one.edges += 1
        for i in range(surfaces.edge_first[edge], surfaces.edge_first[edge + 1]):
            _need_point(modal, surfaces, row, surfaces.edge_opposite[i])


@kernel(internal=True)
def _need_point(modal: ModalSurfaces, surfaces: CollisionSurfaces, row: int, point: int) -> None:
    """In the surface that it is of: seams join surfaces of one body."""
    if modal.point_marks[point] == modal.state.mark:
        return
    modal.point_marks[point] = modal.state.mark
    first = modal.rows[row].first_point
    if not first <= point < first + modal.rows[row].points:
        row = -1
        for other in range(modal.rows.shape[0]):
            first = modal.rows[other].first_point
            if first <= point < first + modal.rows[other].points:
                row = other
    one = modal.rows[row]
    modal.needed[one.first_needed + one.needed] = point - one.first_point
    one.needed += 1
