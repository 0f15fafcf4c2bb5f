"""One contact between triangles at a stage: gap, directions and rows on both bodies, from its two features."""

from __future__ import annotations

import math

from heavylift.contours.triangles.feature_gap import (
    EDGE_EDGE,
    EDGE_VERTEX,
    FACE_VERTEX,
    VERTEX_FACE,
    VERTEX_VERTEX,
    contact_gap,
    feature_gap,
)
from heavylift.contours.triangles.surface_layout import RelativePose
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import rotate, rotate_back, subtract
from heavylift.solver.contact.kind import ContactRows
from heavylift.solver.contact.search.contour_rows import put_pose_rows
from heavylift.solver.contact.search.directions import put_directions
from heavylift.solver.contact.triangles.facets import refit_facets, touch_facets
from heavylift.solver.contact.triangles.interface import pose_surfaces, touch_triangles
from heavylift.solver.contact.triangles.kind import SurfacePairs
from heavylift.solver.contact.triangles.modal_facets import place_touched
from heavylift.solver.interface import Bodies, Workspace
from heavylift.solver.kinds import implement

__all__ = ["relative_pose"]

Direction = tuple[float, float, float]


@kernel(internal=True)
def relative_pose(first: RelativePose, second: RelativePose, out: RelativePose) -> None:
    """``R = R_A^T R_B`` and ``p = R_A^T (p_B - p_A)`` of two poses."""
    for j in range(3):
        r = rotate_back(first.rotation, (second.rotation[j], second.rotation[3 + j], second.rotation[6 + j]))
        for i in range(3):
            out.rotation[3 * i + j] = r[i]
    p = rotate_back(
        first.rotation,
        subtract(second.origin, first.origin),
    )
    for i in range(3):
        out.origin[i] = p[i]


@implement(pose_surfaces, SurfacePairs)
@kernel(internal=True)
def pose_mesh_surfaces(meshes: SurfacePairs, contacts: ContactRows) -> None:
    """Of all pairs."""
    refit_facets(contacts, meshes.surfaces)
    place_touched(meshes, contacts)
    for pair in range(meshes.pairs.shape[0]):
        first = contacts.poses[meshes.pairs[pair].poses[0]]
        second = contacts.poses[meshes.pairs[pair].poses[1]]
        relative_pose(first, second, meshes.relative[pair])


@kernel(internal=True)
def _tangent(
    meshes: SurfacePairs, pair: int, kind: int, feature: int, other: int, n1: float, n2: float, n3: float
) -> Direction:
    """A unit vector perpendicular to the normal, in the axes of the first surface; it moves with the features.

    Elastic slip is carried along it, so it is no matter of how the bodies lie in the world.
    """
    points = meshes.surfaces.points
    on_second = kind == FACE_VERTEX
    a, b = 0, 0
    if kind == VERTEX_FACE:
        a, b = meshes.surfaces.triangles[feature].corners[0], meshes.surfaces.triangles[feature].corners[1]
    elif kind == FACE_VERTEX:
        a, b = meshes.surfaces.triangles[other].corners[0], meshes.surfaces.triangles[other].corners[1]
    elif kind != VERTEX_VERTEX:
        on_second = kind == EDGE_VERTEX
        edge = other if on_second else feature
        a, b = meshes.surfaces.edges[edge].ends[0], meshes.surfaces.edges[edge].ends[1]
    t1, t2, t3 = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    if on_second:
        t1, t2, t3 = rotate(meshes.relative[pair].rotation, (t1, t2, t3))
    share = t1 * n1 + t2 * n2 + t3 * n3
    t1, t2, t3 = t1 - share * n1, t2 - share * n2, t3 - share * n3
    size = math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    if not size > 0.0:  # two points: any direction serves
        if abs(n1) < 0.6:
            t1, t2, t3 = 1.0 - n1 * n1, -n1 * n2, -n1 * n3
        else:
            t1, t2, t3 = -n2 * n1, 1.0 - n2 * n2, -n2 * n3
        size = math.sqrt(t1 * t1 + t2 * t2 + t3 * t3)
    return t1 / size, t2 / size, t3 / size


@kernel(internal=True)
def _keep_side(meshes: SurfacePairs, contacts: ContactRows, c: int, pair: int) -> None:
    """The product of two edges turns over where they pass through parallel: the side does then, and not the normal."""
    state, touch = contacts.state[c], meshes.touch
    if state.feature_kind != EDGE_EDGE:
        return
    feature, other = state.feature, state.other_feature
    relative = meshes.relative[pair]
    contact_gap(meshes.surfaces, EDGE_EDGE, feature, other, 0.0, state.side, relative, touch)
    pose = contacts.poses[contacts.table[c].contour]
    n1, n2, n3 = rotate(pose.rotation, touch.normal)
    if n1 * state.normal[0] + n2 * state.normal[1] + n3 * state.normal[2] < 0.0:
        state.side = -state.side


@implement(touch_triangles, SurfacePairs)
@kernel(internal=True)
def narrow_phase_mesh(
    meshes: SurfacePairs, contacts: ContactRows, bodies: Bodies, c: int, work: Workspace
) -> None:
    """Both bodies are pushed in one point, half way between their surfaces."""
    state, scratch, touch = contacts.state[c], contacts.scratch, meshes.touch
    pair = state.pair
    first_pose, second_pose = contacts.table[c].contour, contacts.table[c].axes
    kind, feature, other = state.feature_kind, state.feature, state.other_feature
    relative = meshes.relative[pair]
    _keep_side(meshes, contacts, c, pair)
    state.end_gap = feature_gap(
        meshes.surfaces, kind, feature, other, meshes.pairs[pair].radii, state.side, relative, touch
    )
    state.beside = touch.beyond
    n1, n2, n3 = touch.normal[0], touch.normal[1], touch.normal[2]
    t1, t2, t3 = _tangent(meshes, pair, kind, feature, other, n1, n2, n3)
    put_directions(contacts, first_pose, n1, n2, n3, t1, t2, t3)
    shift = 0.5 * (
        meshes.surfaces.radii[meshes.pairs[pair].surfaces[0]]
        - meshes.surfaces.radii[meshes.pairs[pair].surfaces[1]]
    )
    x1 = 0.5 * (touch.point_a[0] + touch.point_b[0]) + shift * n1
    x2 = 0.5 * (touch.point_a[1] + touch.point_b[1]) + shift * n2
    x3 = 0.5 * (touch.point_a[2] + touch.point_b[2]) + shift * n3
    scratch.lever[0], scratch.lever[1], scratch.lever[2] = x1, x2, x3
    put_pose_rows(contacts, 2 * c, first_pose, -1.0)
    pose = contacts.poses[first_pose]
    s = rotate(pose.rotation, (x1, x2, x3))
    y = rotate_back(
        relative.rotation, (x1 - relative.origin[0], x2 - relative.origin[1], x3 - relative.origin[2])
    )
    for k in range(3):
        state.touched[k] = pose.origin[k] + s[k]
        state.normal[k] = scratch.directions[0, k]
        state.tangent[k] = scratch.directions[1, k]
        scratch.lever[k] = y[k]
    put_pose_rows(contacts, 2 * c + 1, second_pose, 1.0)
    touch_facets(meshes, contacts, bodies, work, c)
