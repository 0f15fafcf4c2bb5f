"""Seams: triangles that meet without being joined, as the plates of CAD models do.

Directions in which an edge or a vertex may push follow from the triangles that it joins (`feature_judge`). Plates that
abut, overlap or meet in T-junctions join nothing: each of their borders would be an edge in the open, and what slides
over the seam would be stopped by it. So the triangles that a border *lies in* become its neighbours too, found once
from positions:

- a vertex of a border has the corners of every triangle that it touches as neighbours;
- an edge of a border has a neighbour on a side if triangles that contain it cover it on that side from end to end.

An edge that is covered in part stays a border: its other part is one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["Seams", "find_seams"]

TOLERANCE, MOST = 1e-5, 1e-4
"""Distance at which parts touch, over the extension of the surfaces, and at most [m]: CAD files have six digits, and
plates that lie on each other are thicker."""

CHUNK = 2_000_000
"""Pairs of boxes that are looked at together."""

MOST_CELLS = 64
"""In which a box is looked for."""


class Seams(NamedTuple):
    """Neighbours that nothing joins.

    Attributes
    ----------
    vertices, vertex_neighbours
        Vertices of borders, and one neighbour each; shape (m,).
    edges, edge_opposite
        Edges of borders, and a point on the side of a triangle that covers it each; shape (k,).
    """

    vertices: NDArray[np.int64]
    vertex_neighbours: NDArray[np.int64]
    edges: NDArray[np.int64]
    edge_opposite: NDArray[np.int64]


def find_seams(
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
    normals: NDArray[np.float64],
    ends: NDArray[np.int64],
    borders: NDArray[np.int64],
) -> Seams:
    """Neighbours of the borders of a surface.

    Parameters
    ----------
    points
        [m], shape (n, 3).
    corners, normals
        Of the faces, shape (nt, 3) each.
    ends
        Points of all edges, shape (ne, 2).
    borders
        Edges that one face has, shape (nb,). Of a closed surface there are none, and nothing is looked for.
    """
    none = np.zeros(0, dtype=np.int64)
    if not len(borders) or not len(corners):
        return Seams(none, none, none, none)
    used = points[corners]
    tolerance = min(TOLERANCE * float(np.ptp(used.reshape(-1, 3), axis=0).max()), MOST)
    lower, upper = used.min(axis=1) - tolerance, used.max(axis=1) + tolerance
    vertices = np.unique(ends[borders])
    at, faces = _touching(points[vertices], points[vertices], lower, upper)
    owners, others = _neighbours_of_vertices(points, corners, normals, vertices[at], faces, tolerance)
    first, last = points[ends[borders, 0]], points[ends[borders, 1]]
    at, faces = _touching(np.minimum(first, last), np.maximum(first, last), lower, upper)
    edges, opposite = _neighbours_of_edges(points, corners, normals, ends, borders[at], faces, tolerance)
    return Seams(owners, others, edges, opposite)


def _touching(
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    face_lower: NDArray[np.float64],
    face_upper: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of boxes, and of boxes of faces, that meet.

    Notes
    -----
    Faces of about one size stand in the cells of a grid of that size, eight each at most. A box that would be looked
    for in many cells is compared with all faces between its ends along the longest axis.
    """
    extents = (face_upper - face_lower).max(axis=1)
    level = np.ceil(np.log2(extents / extents.min())).astype(np.int64)
    origin = np.minimum(face_lower.min(axis=0), lower.min(axis=0))
    found = [
        pairs
        for faces in (np.flatnonzero(level == k) for k in np.unique(level))
        for pairs in _touching_of_one_size(lower, upper, face_lower, face_upper, faces, origin)
    ]
    boxes, faces = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((faces, boxes))  # whatever the cells are
    return boxes[order], faces[order]


def _touching_of_one_size(
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    face_lower: NDArray[np.float64],
    face_upper: NDArray[np.float64],
    faces: NDArray[np.int64],
    origin: NDArray[np.float64],
) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    size = float((face_upper[faces] - face_lower[faces]).max())
    counts = (
        np.floor((np.maximum(face_upper.max(axis=0), upper.max(axis=0)) - origin) / size).astype(np.int64) + 1
    )

    def cell(place: NDArray[np.float64]) -> NDArray[np.int64]:
        found: NDArray[np.int64] = np.floor((place - origin) / size).astype(np.int64)
        return found

    def number(cells: NDArray[np.int64]) -> NDArray[np.int64]:
        found: NDArray[np.int64] = (cells[:, 0] * counts[1] + cells[:, 1]) * counts[2] + cells[:, 2]
        return found

    def meeting(one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.int64]:
        kept = np.arange(len(one))
        for axis in range(3):
            low, high = lower[one[kept], axis], upper[one[kept], axis]
            of_face = face_upper[other[kept], axis], face_lower[other[kept], axis]
            kept = kept[(low <= of_face[0]) & (high >= of_face[1])]
        return kept

    many = np.prod((cell(upper) - cell(lower) + 1).astype(np.float64), axis=1) > MOST_CELLS
    few = np.flatnonzero(~many)
    face, cells = _in_cells(faces, cell(face_lower[faces]), cell(face_upper[faces]))
    box, wanted = _in_cells(few, cell(lower[few]), cell(upper[few]))
    keys = number(cells)
    order = np.argsort(keys, kind="stable")
    keys, face = keys[order], face[order]
    asked = number(wanted)
    begin, end = np.searchsorted(keys, asked, side="left"), np.searchsorted(keys, asked, side="right")
    found = []
    for rows, places in _spread(begin, end):
        one, other = box[rows], face[places]
        meet = meeting(one, other)
        one, other, asked_in = one[meet], other[meet], asked[rows[meet]]
        # two boxes may share several cells, of which one has the lower corner of what they share
        first = number(cell(np.maximum(lower[one], face_lower[other]))) == asked_in
        found.append((one[first], other[first]))
    large = np.flatnonzero(many)
    axis = int(np.argmax(np.ptp(face_lower[faces], axis=0)))
    along = faces[np.argsort(face_lower[faces, axis])]
    begin = np.searchsorted(face_lower[along, axis], lower[large, axis] - size, side="left")
    end = np.searchsorted(face_lower[along, axis], upper[large, axis], side="right")
    for rows, places in _spread(begin, end):
        one, other = large[rows], along[places]
        meet = meeting(one, other)
        found.append((one[meet], other[meet]))
    return found


def _in_cells(
    things: NDArray[np.int64], first: NDArray[np.int64], last: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Things and the cells that they reach into, from their first to their last one; shape (m,) and (m, 3)."""
    widths = last - first + 1
    sizes = widths.prod(axis=1)
    row = np.repeat(np.arange(len(things)), sizes)
    within = np.arange(len(row)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    w = widths[row]
    steps = np.column_stack([within // (w[:, 1] * w[:, 2]), within // w[:, 2] % w[:, 1], within % w[:, 2]])
    return things[row], first[row] + steps


def _spread(
    begin: NDArray[np.int64], end: NDArray[np.int64]
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Rows, each with all its places from its begin on, `CHUNK` pairs at a time."""
    counts = end - begin
    sums = np.concatenate([[0], np.cumsum(counts)])
    start = 0
    while start < len(counts):
        stop = max(int(np.searchsorted(sums, sums[start] + CHUNK, side="right")) - 1, start + 1)
        part = counts[start:stop]
        within = np.arange(int(part.sum())) - np.repeat(np.cumsum(part) - part, part)
        yield np.repeat(np.arange(start, stop), part), np.repeat(begin[start:stop], part) + within
        start = stop


def _heights(
    points: NDArray[np.float64], corners: NDArray[np.int64], normals: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """First corners of faces, and for each side its point and the unit vector in the plane into the face, (n, 3, 3)."""
    corner = points[corners]
    along = np.roll(corner, -1, axis=1) - corner
    inward = np.cross(normals[:, np.newaxis], along)
    inward /= np.linalg.norm(inward, axis=2, keepdims=True)
    return corner[:, 0], corner, inward


def _neighbours_of_vertices(
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
    normals: NDArray[np.float64],
    vertices: NDArray[np.int64],
    faces: NDArray[np.int64],
    tolerance: float,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Vertices, and corners of the faces that they touch without being a corner of them."""
    new = ~np.any(corners[faces] == vertices[:, np.newaxis], axis=1)
    vertices, faces = vertices[new], faces[new]
    origin, corner, inward = _heights(points, corners[faces], normals[faces])
    place = points[vertices]
    height = np.abs(np.einsum("ij,ij->i", place - origin, normals[faces]))
    depth = np.einsum("ikj,ikj->ik", place[:, np.newaxis] - corner, inward).min(axis=1)
    touches = (height <= tolerance) & (depth >= -tolerance)
    owners, others = np.repeat(vertices[touches], 3), corners[faces[touches]].ravel()
    apart = np.linalg.norm(points[owners] - points[others], axis=1) > tolerance
    return owners[apart], others[apart]


def _neighbours_of_edges(
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
    normals: NDArray[np.float64],
    ends: NDArray[np.int64],
    edges: NDArray[np.int64],
    faces: NDArray[np.int64],
    tolerance: float,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Edges, and corners of faces that cover them on a side from end to end."""
    own = (corners[faces][:, :, np.newaxis] == ends[edges][:, np.newaxis, :]).any(axis=1).all(axis=1)
    edges, faces = edges[~own], faces[~own]
    start, end = points[ends[edges, 0]], points[ends[edges, 1]]
    origin, corner, inward = _heights(points, corners[faces], normals[faces])
    normal = normals[faces]
    flat = np.abs(np.einsum("ij,ij->i", start - origin, normal)) <= tolerance
    flat &= np.abs(np.einsum("ij,ij->i", end - origin, normal)) <= tolerance
    edges, faces, start, end, corner, inward = (x[flat] for x in (edges, faces, start, end, corner, inward))
    # the part of the edge between the three sides of the face, as parameters from 0 to 1
    at_start = np.einsum("ikj,ikj->ik", start[:, np.newaxis] - corner, inward) + tolerance
    at_end = np.einsum("ikj,ikj->ik", end[:, np.newaxis] - corner, inward) + tolerance
    slope = at_end - at_start
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = -at_start / slope
    low = np.where(slope > 0.0, crossing, 0.0).max(axis=1, initial=0.0)
    high = np.where(slope < 0.0, crossing, 1.0).min(axis=1, initial=1.0)
    never = np.any((at_start < 0.0) & (at_end < 0.0), axis=1)
    long = np.linalg.norm(end - start, axis=1)
    good = ~never & ((high - low) * long > tolerance)
    edges, faces, low, high, start, end, long = (x[good] for x in (edges, faces, low, high, start, end, long))
    # on which side of the edge the corners of the face are
    along = (end - start) / long[:, np.newaxis]
    across = np.cross(normals[faces], along)
    aside = np.einsum("ikj,ij->ik", points[corners[faces]] - start[:, np.newaxis], across)
    order = np.argsort(edges, kind="stable")
    # an edge in one face is covered on the sides on which this has corners, if it is from end to end
    _, first_row, count = np.unique(edges[order], return_index=True, return_counts=True)
    alone = order[first_row[count == 1]]
    slack = 3.0 * tolerance / long[alone]
    alone = alone[(low[alone] <= slack) & (high[alone] + slack >= 1.0)]
    found_edges, found_points = [], []
    for sign in (1.0, -1.0):
        reach = (sign * aside[alone]).max(axis=1)
        side = alone[reach > tolerance]
        found_edges.append(edges[side])
        found_points.append(corners[faces[side], (sign * aside[side]).argmax(axis=1)])
    order = order[np.repeat(count > 1, count)]
    plane, sense = _planes(edges[order], across[order])
    by_plane = np.argsort(plane, kind="stable")
    rows, plane, sense = order[by_plane], plane[by_plane], sense[by_plane]
    first_row = np.flatnonzero(np.diff(plane, prepend=-1))
    number, places, ends_at = [], [], []
    for k, sign in enumerate((1.0, -1.0)):
        towards = aside[rows] * (sign * sense)[:, np.newaxis]
        reach = towards.max(axis=1)
        covered = _covered(plane, low[rows], high[rows], 3.0 * tolerance / long[rows], reach > tolerance)
        # of the faces in a plane the one that reaches furthest
        best = np.lexsort((-reach, plane))[first_row[covered]]
        number.append(2 * np.flatnonzero(covered) + k)
        places.append(edges[rows[best]])
        ends_at.append(corners[faces[rows[best]], towards[best].argmax(axis=1)])
    in_turn = np.argsort(np.concatenate(number))
    found_edges.append(np.concatenate(places)[in_turn])
    found_points.append(np.concatenate(ends_at)[in_turn])
    return np.concatenate(found_edges), np.concatenate(found_points)


def _planes(
    edges: NDArray[np.int64], across: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Group the faces at each edge by their planes; all edges take their next plane at once.

    Parameters
    ----------
    edges
        Edge of each face, ascending, shape (m,).
    across
        Perpendicular to the edge in the plane of the face, shape (m, 3).

    Returns
    -------
    tuple
        Number of the plane, ascending from edge to edge, and whether the face is wound as the first in the plane
        (1) or the other way (-1); shape (m,).
    """
    turn, sense = np.zeros(len(edges), dtype=np.int64), np.zeros(len(edges))
    left, turns = np.arange(len(edges)), 0
    while len(left):
        begins = np.flatnonzero(np.diff(edges[left], prepend=-1))
        leader = np.repeat(left[begins], np.diff(begins, append=len(left)))
        product = np.einsum("ij,ij->i", across[left], across[leader])
        same = np.abs(product) > 1.0 - 1e-4
        product[left == leader] = 1.0  # also of an edge so short that it is not level
        same |= left == leader
        turn[left[same]], sense[left[same]] = turns, np.sign(product[same])
        left, turns = left[~same], turns + 1
    _, number = np.unique(edges * turns + turn, return_inverse=True)
    return number.astype(np.int64).ravel(), sense


def _covered(
    group: NDArray[np.int64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    slack: NDArray[np.float64],
    counts: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Whether the intervals of each group that count cover that from 0 to 1 together; shape of the groups.

    Parameters
    ----------
    group
        Of each interval, ascending without gaps.
    low, high
        Ends of the intervals.
    slack
        Width of a gap that is none.
    counts
        Which of them count.
    """
    group_count = int(group.max(initial=-1)) + 1
    chosen = np.flatnonzero(counts)
    chosen = chosen[np.lexsort((low[chosen], group[chosen]))]
    own = group[chosen]
    reached = high[chosen] + slack[chosen]
    # the furthest end so far, in steps of doubled width
    width, longest = 1, int(np.bincount(own).max(initial=0))
    while width < longest:
        same = own[width:] == own[:-width]
        reached[width:] = np.where(same, np.maximum(reached[width:], reached[:-width]), reached[width:])
        width *= 2
    begins = np.diff(own, prepend=-1) != 0
    before = np.where(begins, slack[chosen], np.maximum(slack[chosen], np.roll(reached, 1)))
    found = np.zeros(group_count, dtype=np.bool_)
    last = np.diff(own, append=-1) != 0
    found[own[last]] = np.maximum(slack[chosen], reached)[last] >= 1.0
    found[own[low[chosen] > before]] = False
    return found
