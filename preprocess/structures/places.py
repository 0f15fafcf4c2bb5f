"""Places of a structure: the nearest point of its plates, beams and solids, and the triangles of its surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.preprocess.finite_elements.mesh import Mesh

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

__all__ = ["distances_to_triangles", "nearest_place", "surface_faces", "surface_triangles"]

_NEWTON_STEPS = 20
_CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])

Place = tuple["NDArray[np.int64]", "NDArray[np.float64]", float]


def surface_faces(
    nodes: NDArray[np.float64], shells: Sequence[NDArray[np.int64]], bricks: Sequence[NDArray[np.int64]]
) -> NDArray[np.int64]:
    """Plates, triangles with their last node twice, and outer faces of eight-node bricks, shape (nf, 4)."""
    found = [elements[:, [0, 1, 2, -1]] for elements in shells]
    if bricks:
        found.append(Mesh(nodes, np.concatenate(bricks), "hex8").boundary_faces())
    return np.concatenate([np.empty((0, 4), dtype=np.int64), *found])


def surface_triangles(
    nodes: NDArray[np.float64],
    shells: Sequence[NDArray[np.int64]],
    solids: Iterable[tuple[str, NDArray[np.int64]]],
) -> NDArray[np.int64]:
    """Triangles of plates, wound about their normals, and of the outer faces of solids, wound outwards.

    Parameters
    ----------
    nodes
        Positions [m], shape (n, 3).
    shells
        Nodes of quadrilaterals (ne, 4) and triangles (ne, 3).
    solids
        Types and nodes of solid elements.

    Returns
    -------
    NDArray
        Shape (nt, 3): each plate once, two triangles of a quadrilateral.
    """
    found = [elements[:, [0, 1, 2]] for elements in shells]
    found += [elements[:, [0, 2, 3]] for elements in shells if elements.shape[1] == 4]
    by_type: dict[str, list[NDArray[np.int64]]] = {}
    for element_type, elements in solids:
        by_type.setdefault(element_type, []).append(elements)
    found += [
        Mesh(nodes, np.concatenate(parts), element_type).boundary_triangles()
        for element_type, parts in by_type.items()
    ]
    return np.concatenate([np.empty((0, 3), dtype=np.int64), *found])


def nearest_place(
    nodes: NDArray[np.float64],
    shells: Sequence[NDArray[np.int64]],
    beams: Sequence[NDArray[np.int64]],
    solids: Iterable[tuple[str, NDArray[np.int64]]],
    point: NDArray[np.float64],
) -> Place:
    """Nodes and weights of the place of a structure nearest to a point, and its distance [m].

    Plates and beams count where their nodes are, whatever their offset. Weights are the shape functions of plates and
    solids; along a beam they are linear.
    """
    found: list[Place] = []
    triangles = surface_triangles(nodes, shells, ())
    if len(triangles):
        weights, distance = _on_triangles(nodes[triangles], point)
        best = int(np.argmin(distance))
        found.append((triangles[best], weights[best], float(distance[best])))
        quads = [elements for elements in shells if elements.shape[1] == 4]
        of_quad = best - (len(triangles) - sum(len(elements) for elements in quads))
        corners = _quadrilateral_of(shells, best, of_quad)
        if corners is not None:
            place = weights[best] @ nodes[triangles[best]]
            four = _in_quadrilateral(nodes[corners], place)
            found[0] = (corners, four, float(np.linalg.norm(four @ nodes[corners] - point)))
    lines = np.concatenate([np.empty((0, 2), dtype=np.int64), *beams])
    if len(lines):
        share, distance = _on_lines(nodes[lines], point)
        best = int(np.argmin(distance))
        found.append((lines[best], np.array([1.0 - share[best], share[best]]), float(distance[best])))
    for element_type, elements in solids:
        found.append(Mesh(nodes, elements, element_type).nearest_place(point))
    return min(found, key=lambda place: place[2])


def distances_to_triangles(corners: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distances of points (m, 3) from triangles (m, 3, 3), one by one [m], shape (m,)."""
    return _on_triangles(corners, points)[1]


def _quadrilateral_of(
    shells: Sequence[NDArray[np.int64]], triangle: int, second: int
) -> NDArray[np.int64] | None:
    """Corners of the quadrilateral that a triangle of `surface_triangles` is a half of; None if it is none."""
    if second >= 0:  # of the second halves
        return np.concatenate([elements for elements in shells if elements.shape[1] == 4])[second]
    for elements in shells:
        if triangle < len(elements):
            return elements[triangle] if elements.shape[1] == 4 else None
        triangle -= len(elements)
    return None


def _on_triangles(
    corners: NDArray[np.float64], point: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Weights (m, 3) of the points of triangles (m, 3, 3) nearest to one point or to one each, and distances [m]."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("mi,mi->m", normal, normal), np.finfo(np.float64).tiny)
    weights = np.empty((len(corners), 3))
    for k, (first, second) in enumerate(((b, c), (c, a), (a, b))):
        weights[:, k] = np.einsum("mi,mi->m", np.cross(first - point, second - point), normal) / square
    inside = (weights >= 0.0).all(axis=1)
    distance = np.linalg.norm(np.einsum("mk,mki->mi", weights, corners) - point, axis=1)
    distance[~inside] = np.inf
    for i, j in ((0, 1), (1, 2), (2, 0)):
        share, away = _on_lines(corners[:, [i, j]], point)
        nearer = ~inside & (away < distance)
        distance[nearer] = away[nearer]
        weights[nearer] = 0.0
        weights[nearer, i], weights[nearer, j] = 1.0 - share[nearer], share[nearer]
    return weights, distance


def _on_lines(
    ends: NDArray[np.float64], point: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Share of the second end in the points of lines (m, 2, 3) nearest to one point or to one each, and distances."""
    along = ends[:, 1] - ends[:, 0]
    square = np.maximum(np.einsum("mi,mi->m", along, along), np.finfo(np.float64).tiny)
    share = np.clip(np.einsum("mi,mi->m", point - ends[:, 0], along) / square, 0.0, 1.0)
    return share, np.linalg.norm(ends[:, 0] + share[:, None] * along - point, axis=1)


def _in_quadrilateral(corners: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bilinear shape functions at the point of a quadrilateral (4, 3) nearest to a place, by Newton's method."""
    local = np.zeros(2)
    for _ in range(_NEWTON_STEPS):
        factors = 1.0 + local * _CORNERS
        slopes = 0.25 * np.stack([_CORNERS[:, 0] * factors[:, 1], _CORNERS[:, 1] * factors[:, 0]])
        gap = place - 0.25 * factors.prod(axis=1) @ corners
        step = np.linalg.lstsq((slopes @ corners).T, gap, rcond=None)[0]
        before, local = local, np.clip(local + step, -1.0, 1.0)
        if np.abs(local - before).max() <= 1e-14:
            break
    weights: NDArray[np.float64] = 0.25 * (1.0 + local * _CORNERS).prod(axis=1)
    return weights
