"""Outward directions of closed surfaces: from windings and positions at the start, which no search of contacts reads.

So it can judge them: a face of a closed surface pushes what was outside of it outwards, and what was within it inwards.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.triangles.surface_pack import WORTH_KEEPING
from heavylift.numerics.derived import derived
from heavylift.numerics.joined import joined

if TYPE_CHECKING:
    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

__all__ = ["ClosedParts", "closed_parts", "outside_of"]

FLAT = 1e-9
"""Of the cube of its extension: the least volume that tells in from out."""

BEYOND = 1e-6
"""Of the extension of a surface: what lies so far beyond its box lies outside of it."""

SHARPEST = 0.1
"""Length of the sum of the normals of two faces below which their edge has no direction outwards."""


class ClosedParts(NamedTuple):
    """Parts of surfaces, and which of them are closed.

    Attributes
    ----------
    part, outward
        Of each triangle: its part, counted through all surfaces, and 1 where the normal of its winding points out of
        it, -1 where it points in, 0 where the part is open or wound in several ways.
    edge_outward
        Unit vector out of the part at each edge, shape (ne, 3); zeros where there is none.
    """

    part: NDArray[np.int64]
    outward: NDArray[np.float64]
    edge_outward: NDArray[np.float64]


def closed_parts(surfaces: CollisionSurfaces, deforming: Collection[int]) -> ClosedParts:
    """Parts that hang together by points; closed is one whose sides all meet one that runs the other way.

    Parameters
    ----------
    surfaces
        All surfaces.
    deforming
        Numbers of those that deform: none of their parts counts as closed.
    """
    triangles = surfaces.triangles
    inputs = (
        surfaces.points,
        triangles["corners"],
        triangles["edges"],
        surfaces.normals,
        len(surfaces.edges),
        np.isin(triangles["surface"], list(deforming)),
    )
    if len(triangles) <= WORTH_KEEPING:
        return _closed_parts(*inputs)
    return derived(ClosedParts, _closed_parts, *inputs)


def _closed_parts(
    points: NDArray[np.float64],
    corners: NDArray[np.int64],
    edges: NDArray[np.int64],
    normals: NDArray[np.float64],
    edge_count: int,
    deforms: NDArray[np.bool_],
) -> ClosedParts:
    """The same of arrays; `deforms` tells of each triangle whether its surface does."""
    count = len(points)
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    label = joined(count, np.column_stack([start, end]))
    _, part = np.unique(label[corners[:, 0]], return_inverse=True)
    part = part.astype(np.int64).ravel()
    parts = int(part.max(initial=-1)) + 1
    owner = np.repeat(part, 3)
    keys, number, times = np.unique(start * count + end, return_inverse=True, return_counts=True)
    met = np.isin(end * count + start, keys) & (times[number.ravel()] == 1)
    shut = np.bincount(owner[~met], minlength=parts) == 0
    shut[np.unique(part[deforms])] = False
    volume, size = np.zeros(parts), np.zeros(parts)
    # measured from a corner of each part, or rounding far from the origin would make volumes of its own
    first = np.zeros((parts, 3))
    first[part[::-1]] = points[corners[::-1, 0]]
    a, b, c = (points[corners[:, k]] - first[part] for k in range(3))
    np.add.at(volume, part, (a * np.cross(b, c)).sum(axis=1) / 6.0)
    np.maximum.at(size, part, np.abs(np.stack([a, b, c])).max(axis=(0, 2)))
    shut &= np.abs(volume) > FLAT * size**3
    outward = np.where(shut, np.sign(volume), 0.0)[part]
    return ClosedParts(part, outward, _edges_outward(edges, normals, edge_count, outward))


def _edges_outward(
    edges: NDArray[np.int64], normals: NDArray[np.float64], edge_count: int, outward: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Half way between the normals of the faces at each edge."""
    total = np.zeros((edge_count, 3))
    for side in range(3):
        there = edges[:, side] >= 0
        np.add.at(total, edges[there, side], (outward[:, np.newaxis] * normals)[there])
    length = np.linalg.norm(total, axis=1)
    known = length > SHARPEST
    total[~known] = 0.0
    return total / np.where(known, length, 1.0)[:, np.newaxis]


def outside_of(
    surfaces: CollisionSurfaces,
    parts: ClosedParts,
    a: int,
    b: int,
    R: NDArray[np.float64],
    p: NDArray[np.float64],
) -> float:
    """Where surface b begins: 1 outside of all closed parts of surface a, -1 within its only part, 0 if neither.

    Parameters
    ----------
    surfaces, parts
        All surfaces, and their parts.
    a, b
        Numbers of two surfaces.
    R, p
        Pose of b in the axes of a, shapes (3, 3) and (3,).
    """
    rows_a, rows_b = (_rows(surfaces, s) for s in (a, b))
    if not parts.outward[rows_a].any():
        return 0.0
    of_a = surfaces.points[surfaces.triangles["corners"][rows_a]]
    used = surfaces.triangles["corners"][rows_b]
    of_b = surfaces.points[used] @ R.T + p
    low, high = of_a.min(axis=(0, 1)), of_a.max(axis=(0, 1))
    margin = BEYOND * float((high - low).max())
    away = ((of_b < low - margin) | (of_b > high + margin)).any(axis=(1, 2))
    labels = parts.part[rows_b]
    near = np.setdiff1d(labels, labels[away])  # parts of which every point lies in the box of a
    if not len(near):
        return 1.0
    own = parts.part[rows_a]
    found = {
        _within(_extremes(of_b[labels == label].reshape(-1, 3)), of_a[own == one])
        for label in near
        for one in np.unique(own[parts.outward[rows_a] != 0.0])
    }
    if found == {False}:
        return 1.0
    alone = len(np.unique(own)) == 1 and len(near) == len(np.unique(labels))
    return -1.0 if found == {True} and alone else 0.0


def _rows(surfaces: CollisionSurfaces, number: int) -> slice:
    """Triangles of a surface."""
    one = surfaces.surfaces[number]
    return slice(int(one.first_triangle), int(one.first_triangle + one.triangle_count))


def _extremes(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The outermost points along the axes, and two more: some of them do not touch."""
    return points[np.unique([*points.argmin(axis=0), *points.argmax(axis=0), 0, len(points) // 2])]


def _within(points: NDArray[np.float64], corners: NDArray[np.float64]) -> bool | None:
    """Whether points are within a closed surface, by its solid angles (Van Oosterom and Strackee, 1983).

    None if some are and some are not, or all of them touch it.
    """
    known = set()
    for point in points:
        a, b, c = (corners[:, k] - point for k in range(3))
        p, q, r = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        above = (a * np.cross(b, c)).sum(axis=1)
        below = p * q * r + (a * b).sum(axis=1) * r + (a * c).sum(axis=1) * q + (b * c).sum(axis=1) * p
        if ((np.abs(above) <= BEYOND * p * q * r) & (below <= 0.0)).any():
            continue  # it touches a triangle
        turns = abs(float(np.arctan2(above, below).sum())) / (2.0 * np.pi)
        known.add(turns > 0.5)
    return known.pop() if len(known) == 1 else None
