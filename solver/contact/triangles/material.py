"""The side of found features where the material of a body tells it: faces of solid elements are touched from outside.

Between the few contacts that carry a flat face, others of its points sag below what it lies on, and lie as level there
as on the right side. On which side they belong tells the material: the normal of a contact leads out of the first body
and into the second one. What would then be deeper inside than half of the element below it is on the far side of its
body.
"""

from __future__ import annotations

import math

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, FACE_VERTEX, VERTEX_FACE, fixed_point
from heavylift.contours.triangles.feature_report import UNKNOWN
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, dot, rotate, scaled
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.modal_facets import modal_row
from heavylift.solver.contact.triangles.sides import evaluate
from heavylift.solver.contact.triangles.slots import look_up

__all__ = ["settle_by_material"]

LEVEL = 0.1
"""Cosine between a normal and the way out of the material below which it tells nothing."""


@kernel(internal=True)
def settle_by_material(meshes: SurfacePairs, contacts: ContactRows, pair: int, count: int) -> None:
    """Sides and gaps of what was found and is no contact yet."""
    rows = (modal_row(meshes, contacts, pair, 0), modal_row(meshes, contacts, pair, 1))
    solid = (rows[0] >= 0 and contacts.modal.rows[rows[0]].solid) or (
        rows[1] >= 0 and contacts.modal.rows[rows[1]].solid
    )
    if not solid:
        return
    for i in range(count):
        found = meshes.found.contacts[i]
        kind, feature, other = found.kind, found.first, found.second
        if kind not in (VERTEX_FACE, FACE_VERTEX, EDGE_EDGE):
            continue
        if look_up(meshes, contacts, pair, kind, feature, other) >= 0:
            continue
        gap = evaluate(meshes, pair, i, meshes.relative[pair], found.side)
        n = (meshes.touch.normal[0], meshes.touch.normal[1], meshes.touch.normal[2])
        out = _out(meshes, contacts, pair, 0, rows[0], kind, feature)
        into = rotate(meshes.relative[pair].rotation, _out(meshes, contacts, pair, 1, rows[1], kind, other))
        a, b = dot(out, n), -dot(into, n)
        turned = (a < -LEVEL or b < -LEVEL) and a < LEVEL and b < LEVEL
        known = turned or ((a > LEVEL or b > LEVEL) and a > -LEVEL and b > -LEVEL)
        if turned:
            found.side = -found.side
            gap = -gap - 2.0 * meshes.pairs[pair].radii
            found.gap = gap
        if known:
            deepest = min(
                _half_depth(meshes, contacts, 0, rows[0], kind, feature),
                _half_depth(meshes, contacts, 1, rows[1], kind, other),
            )
            found.hit = UNKNOWN if -gap > deepest else max(found.hit, 0)


@kernel(internal=True)
def _out(
    meshes: SurfacePairs, contacts: ContactRows, pair: int, side: int, row: int, kind: int, feature: int
) -> Vector:
    """Way out of a surface at a feature, in its axes; zeros where nobody knows it."""
    modal, is_face = contacts.modal, kind == (FACE_VERTEX if side == 1 else VERTEX_FACE)
    if row >= 0:
        if not modal.rows[row].solid:
            return 0.0, 0.0, 0.0
        if is_face:
            return fixed_point(meshes.surfaces.normals, feature)
        return fixed_point(modal.edge_outward if kind == EDGE_EDGE else modal.outward, feature)
    sign = meshes.pairs[pair].outside[side]
    if sign == 0.0 or not (is_face or kind == EDGE_EDGE):
        return 0.0, 0.0, 0.0
    if is_face:
        return scaled(sign * meshes.outward[feature], fixed_point(meshes.surfaces.normals, feature))
    return scaled(sign, fixed_point(meshes.edge_outward, feature))


@kernel(internal=True)
def _half_depth(
    meshes: SurfacePairs, contacts: ContactRows, side: int, row: int, kind: int, feature: int
) -> float:
    """Half of the thickness of the elements below a feature [m]; infinite where that is not known."""
    if row < 0:
        return math.inf
    depths, surfaces = contacts.modal.half_depths, meshes.surfaces
    if kind == EDGE_EDGE:
        ends = surfaces.edges[feature].ends
        return min(depths[ends[0]], depths[ends[1]])
    if kind == (FACE_VERTEX if side == 1 else VERTEX_FACE):
        corners = surfaces.triangles[feature].corners
        return min(depths[corners[0]], depths[corners[1]], depths[corners[2]])
    return depths[feature]
