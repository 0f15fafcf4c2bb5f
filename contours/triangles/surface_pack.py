"""Surfaces of triangles as the arrays that collision kernels read: points, triangles in leaf order, edges, trees."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.contours.triangles.seams import Seams, find_seams
from heavylift.contours.triangles.surface_layout import (
    IS_FACE,
    OWNS_A,
    OWNS_AB,
    BoundingBox,
    Edge,
    PackedSurface,
    TreeNode,
    Triangle,
)
from heavylift.contours.triangles.surface_tree import build_tree
from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1
from heavylift.numerics.derived import derived
from heavylift.numerics.records import R, Records, filled, records

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["CollisionSurfaces", "pack_surfaces"]

WORTH_KEEPING = 500
"""Triangles, or edges of borders, from which on what follows from them is kept: of fewer it is computed faster."""

FLATTEST_FACE = 1e-12
"""Smallest height over longest edge of a triangle that still has a normal."""


class CollisionSurfaces(Arrays):
    """All surfaces of a scene, one after another.

    Attributes
    ----------
    points
        In the axes of the body of their surface [m], shape (n, 3).
    triangles
        In leaf order of their trees, shape (nt,).
    normals
        Unit normals of faces, wound as given, shape (nt, 3); zeros for what is no face.
    edges
        Shape (ne,).
    edge_first
        Rows of `edge_inward` of each edge: from its own number to the next, shape (ne + 1,).
    edge_inward
        For each face at an edge the unit vector in the plane of the face, perpendicular to the edge, into the face;
        shape (k, 3).
    vertex_first
        Places in `vertex_neighbours` of each point: from its own number to the next, shape (n + 1,).
    vertex_neighbours
        Points that an edge joins to the point, shape (2 ne,).
    nodes
        Of the trees, shape (nn,).
    boxes
        Of the nodes, shape (nn,); without the radii.
    surfaces
        Shape (ns,).
    radii
        Rounding [m], shape (ns,).
    reaches
        Largest distance of a point of the surface from the origin of its axes [m], shape (ns,).
    order
        Number of each triangle in its surface as it was given, shape (nt,).
    triangle_boxes
        Of the triangles, shape (nt,); without the radii.
    edge_opposite
        Point of the face opposite to the edge, for each row of `edge_inward`, shape (k,).
    fitted_points
        Points for which boxes, normals and `edge_inward` hold [m], shape (n, 3).
    travels
        Sum over all refits of the longest way that a point of the surface has gone in each [m], shape (ns,).
    middles
        Middle of the box around each surface [m], shape (ns, 3).
    """

    points: Floats2
    triangles: Records[Triangle]
    normals: Floats2
    edges: Records[Edge]
    edge_first: Ints1
    edge_inward: Floats2
    vertex_first: Ints1
    vertex_neighbours: Ints1
    nodes: Records[TreeNode]
    boxes: Records[BoundingBox]
    surfaces: Records[PackedSurface]
    radii: Floats1
    reaches: Floats1
    order: Ints1
    triangle_boxes: Records[BoundingBox]
    edge_opposite: Ints1
    fitted_points: Floats2
    travels: Floats1
    middles: Floats2


class _Part(NamedTuple):
    """One surface, its rows counted from zero."""

    points: NDArray[np.float64]
    triangles: Records[Triangle]
    normals: NDArray[np.float64]
    edges: Records[Edge]
    opposite_counts: NDArray[np.int64]
    opposite: NDArray[np.int64]
    neighbour_counts: NDArray[np.int64]
    neighbours: NDArray[np.int64]
    nodes: Records[TreeNode]
    boxes: Records[BoundingBox]
    order: NDArray[np.int64]
    triangle_boxes: Records[BoundingBox]
    reach: float


def pack_surfaces(
    surfaces: Sequence[TriangleSurface], bodies: Sequence[object] | None = None
) -> CollisionSurfaces:
    """Arrays of all surfaces of a scene, with their trees, edges and neighbours.

    Parameters
    ----------
    surfaces
        In the axes of their bodies; there may be none.
    bodies
        What tells the body of each: surfaces of one body meet in seams. If absent each has its own.

    Notes
    -----
    A point that no triangle uses keeps its row, but nothing owns it: it never touches anything.
    """
    parts = [_part(surface) for surface in surfaces]
    table = records(PackedSurface, len(parts))
    triangles = _joined(Triangle, [part.triangles for part in parts])
    edges = _joined(Edge, [part.edges for part in parts])
    nodes = _joined(TreeNode, [part.nodes for part in parts])
    point = triangle = edge = node = 0
    opposite, neighbours = [], []
    for s, part in enumerate(parts):
        table[s] = filled(
            PackedSurface,
            first_point=point,
            first_triangle=triangle,
            first_edge=edge,
            root=node,
            triangle_count=len(part.triangles),
            point_count=len(part.points),
        )
        rows = triangles[triangle : triangle + len(part.triangles)]
        rows["corners"] += point
        joined = rows["edges"]
        joined[joined >= 0] += edge
        rows["surface"] = s
        sides = edges[edge : edge + len(part.edges)]
        sides["ends"] += point
        sides["triangle"] += triangle
        tree = nodes[node : node + len(part.nodes)]
        tree["left"] += np.where(tree["left"] >= 0, node, 0)
        tree["first"] += triangle
        opposite.append(part.opposite + point)
        neighbours.append(part.neighbours + point)
        point += len(part.points)
        triangle += len(part.triangles)
        edge += len(part.edges)
        node += len(part.nodes)

    points = _stack([part.points for part in parts], 3)
    normals = _stack([part.normals for part in parts], 3)
    joined = np.concatenate([part.opposite_counts for part in parts] or [np.zeros(0, dtype=np.int64)])
    owner = np.repeat(np.arange(len(edges)), joined)
    is_face: NDArray[np.bool_] = (triangles["flags"] & IS_FACE) != 0
    of_faces = np.where(is_face[:, np.newaxis], triangles["edges"], -1)
    lone = of_faces >= 0
    lone[lone] = joined[of_faces[lone]] == 1
    edge_rows, vertex_rows = [(owner, _stack(opposite, 0, np.int64))], []
    counts = _stack([part.neighbour_counts for part in parts], 0, np.int64)
    vertex_rows.append((np.repeat(np.arange(len(points)), counts), _stack(neighbours, 0, np.int64)))
    # what is rounded by another radius is not level with it
    level = [(s if bodies is None else bodies[s], surface.radius) for s, surface in enumerate(surfaces)]
    group = np.array([level.index(one) for one in level], dtype=np.int64)
    for one in np.unique(group):
        of_body = is_face & (group[triangles["surface"]] == one)
        borders = np.unique(of_faces[of_body][lone[of_body]])
        members = np.flatnonzero(group == one)
        seams = _seams(
            points,
            np.concatenate([np.arange(first, first + count) for first, count in _rows_of(table[members])]),
            triangles["corners"][of_body],
            normals[of_body],
            edges["ends"][borders],
        )
        edge_rows.append((borders[seams.edges], seams.edge_opposite))
        vertex_rows.append((seams.vertices, seams.vertex_neighbours))
    edge_first, owner, edge_opposite = _in_rows(edge_rows, len(edges))
    vertex_first, _, vertex_neighbours = _in_rows(vertex_rows, len(points))
    return CollisionSurfaces(
        points=points,
        triangles=triangles,
        normals=normals,
        edges=edges,
        edge_first=edge_first,
        edge_inward=_inward(points, edges[owner], edge_opposite),
        vertex_first=vertex_first,
        vertex_neighbours=vertex_neighbours,
        nodes=nodes,
        boxes=_joined(BoundingBox, [part.boxes for part in parts]),
        surfaces=table,
        radii=np.array([surface.radius for surface in surfaces], dtype=np.float64),
        reaches=np.array([part.reach for part in parts], dtype=np.float64),
        order=_stack([part.order for part in parts], 0, np.int64),
        triangle_boxes=_joined(BoundingBox, [part.triangle_boxes for part in parts]),
        edge_opposite=edge_opposite,
        fitted_points=points.copy(),
        travels=np.zeros(len(parts)),
        middles=_stack([part.boxes["centre"][:1] for part in parts], 3),
    )


def _rows_of(table: Records[PackedSurface]) -> list[tuple[int, int]]:
    """First point and number of points of surfaces."""
    return [(int(one.first_point), int(one.point_count)) for one in table]


def _seams(
    points: NDArray[np.float64],
    own: NDArray[np.int64],
    corners: NDArray[np.int64],
    normals: NDArray[np.float64],
    borders: NDArray[np.int64],
) -> Seams:
    """Seams of the surfaces of a body; where the points of others stand in the scene does not matter.

    Parameters
    ----------
    points
        Of the scene, shape (n, 3).
    own
        Those of the body, ascending.
    corners, normals
        Of its faces.
    borders
        Points of its borders, shape (nb, 2).

    Returns
    -------
    Seams
        Points of the scene; edges are rows of `borders`.
    """
    place = np.zeros(len(points), dtype=np.int64)
    place[own] = np.arange(len(own))
    rows = np.arange(len(borders))
    inputs = points[own], place[corners], normals, place[borders], rows
    found = derived(Seams, find_seams, *inputs) if len(rows) > WORTH_KEEPING else find_seams(*inputs)
    return Seams(own[found.vertices], own[found.vertex_neighbours], found.edges, own[found.edge_opposite])


def _part(surface: TriangleSurface) -> _Part:
    """Arrays of one surface, as they are kept or made."""
    points = np.array(surface.points, dtype=np.float64)
    given = np.asarray(surface.triangles, dtype=np.int64)
    if len(given) <= WORTH_KEEPING:
        return _pack_one(points, given)
    return derived(_Part, _pack_one, points, given, rows=(Triangle, Edge, TreeNode, BoundingBox))


def _pack_one(points: NDArray[np.float64], given: NDArray[np.int64]) -> _Part:
    """Arrays of one surface."""
    corners = points[given]
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    tree = build_tree(lower, upper)
    corner = given[tree.order]
    normals, faces = _normals(points, corner)

    rows = records(Triangle, len(corner))
    rows["corners"] = corner
    rows["flags"] = IS_FACE * faces
    # the first triangle in leaf order that has a point owns it, and likewise edges
    _, first = np.unique(corner.ravel(), return_index=True)
    np.add.at(rows["flags"], first // 3, OWNS_A << (first % 3))
    edges, owner = _edges(corner, len(points), rows["edges"])
    np.add.at(rows["flags"], owner // 3, OWNS_AB << (owner % 3))

    # corner (i + 2) is opposite to the side from corner i to i + 1
    numbers = rows["edges"][faces].ravel()
    by_edge = np.argsort(numbers, kind="stable")
    opposite = corner[faces][:, [2, 0, 1]].ravel()[by_edge]
    ends = edges["ends"]
    starts = np.concatenate([ends[:, 0], ends[:, 1]])
    by_point = np.argsort(starts, kind="stable")

    boxes = records(BoundingBox, len(corner))
    boxes["centre"] = (0.5 * (lower + upper))[tree.order]
    boxes["half"] = (0.5 * (upper - lower))[tree.order]
    return _Part(
        points=points,
        triangles=rows,
        normals=normals,
        edges=edges,
        opposite_counts=np.bincount(numbers, minlength=len(edges)),
        opposite=opposite,
        neighbour_counts=np.bincount(starts, minlength=len(points)),
        neighbours=np.concatenate([ends[:, 1], ends[:, 0]])[by_point],
        nodes=tree.nodes,
        boxes=tree.boxes,
        order=tree.order,
        triangle_boxes=boxes,
        reach=float(np.linalg.norm(points[np.unique(given)], axis=1).max()),
    )


def _normals(
    points: NDArray[np.float64], corner: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Unit normals of triangles, shape (nt, 3), and which of them are faces, shape (nt,)."""
    a, b, c = (points[corner[:, k]] for k in range(3))
    sides = np.stack([b - a, c - b, a - c])
    longest = (sides * sides).sum(axis=2).max(axis=0)
    product = np.cross(b - a, c - a)
    length = np.linalg.norm(product, axis=1)
    faces = length > FLATTEST_FACE * longest
    product[~faces] = 0.0
    return product / np.where(faces, length, 1.0)[:, np.newaxis], faces


def _edges(
    corner: NDArray[np.int64], point_count: int, numbers: NDArray[np.int64]
) -> tuple[Records[Edge], NDArray[np.int64]]:
    """Edges of triangles, shape (ne,), and the place of the first side of each among all sides, shape (ne,).

    Parameters
    ----------
    numbers
        Out: edge of each side, shape (nt, 3); -1 for a side between a point and itself, and for the way back along
        a lone segment.
    """
    start = corner.ravel()
    end = corner[:, [1, 2, 0]].ravel()
    keys = np.minimum(start, end) * point_count + np.maximum(start, end)
    real = (start != end).reshape(-1, 3)
    table = keys.reshape(-1, 3)
    real[:, 1] &= (table[:, 1] != table[:, 0]) | ~real[:, 0]
    real[:, 2] &= ((table[:, 2] != table[:, 0]) | ~real[:, 0]) & ((table[:, 2] != table[:, 1]) | ~real[:, 1])
    sides = np.flatnonzero(real)
    _, first, number = np.unique(keys[sides], return_index=True, return_inverse=True)
    numbers[...] = -1
    numbers[real] = number.ravel()
    owner = sides[first]
    edges = records(Edge, len(owner))
    edges["ends"][:, 0] = start[owner]
    edges["ends"][:, 1] = end[owner]
    edges["triangle"] = owner // 3
    return edges, owner


def _inward(
    points: NDArray[np.float64], edges: Records[Edge], opposite: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Unit vectors perpendicular to edges, towards a point each, shape (k, 3)."""
    along = points[edges["ends"][:, 1]] - points[edges["ends"][:, 0]]
    along /= np.linalg.norm(along, axis=1)[:, np.newaxis]
    inward = points[opposite] - points[edges["ends"][:, 0]]
    for _ in range(2):  # once more: of a sliver little is left by the first
        inward -= (inward * along).sum(axis=1)[:, np.newaxis] * along
        inward /= np.linalg.norm(inward, axis=1)[:, np.newaxis]
    return inward


def _in_rows(
    parts: list[tuple[NDArray[np.int64], NDArray[np.int64]]], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Where the rows of each owner begin and the last end, and owners and values in the order of the owners."""
    owners, values = (np.concatenate([part[k] for part in parts]) for k in range(2))
    order = np.argsort(owners, kind="stable")
    first = np.concatenate([[0], np.cumsum(np.bincount(owners, minlength=count))])
    return first.astype(np.int64), owners[order], np.ascontiguousarray(values[order])


def _joined(record: type[R], parts: list[Records[R]]) -> Records[R]:
    """Records one after another."""
    made = records(record, sum(map(len, parts)))
    start = 0
    for part in parts:
        made[start : start + len(part)] = part
        start += len(part)
    return made


def _stack(arrays: list[NDArray], width: int, kind: type = np.float64) -> NDArray:
    """Arrays below each other; rows of the given width if there are none. Width 0: of one axis."""
    empty: NDArray = np.zeros((0, width) if width else 0, dtype=kind)
    return np.ascontiguousarray(np.concatenate([*arrays, empty]), dtype=kind)
