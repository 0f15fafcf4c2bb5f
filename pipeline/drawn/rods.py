"""Rods that tie points of a rigid body together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping

    from numpy.typing import NDArray

    from heavylift.solver.scene.drawn import At

__all__ = ["rods", "shortest_tree"]


def shortest_tree(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Pairs of points that join all of them by lines of least length, shape (n - 1, 2)."""
    from scipy.sparse.csgraph import minimum_spanning_tree

    distance = np.linalg.norm(points[:, None] - points[None, :], axis=2)
    # a metre more of each changes no tree; without, points at one place would count as not joined
    tree = minimum_spanning_tree(distance + 1.0).tocoo()
    return np.column_stack([tree.row, tree.col]).astype(np.int64)


def rods(
    centres: Mapping[str, NDArray[np.float64]],
    attached: Iterable[At],
    holding: Container[str],
    boxes: Container[str],
) -> list[tuple[str, NDArray[np.float64], NDArray[np.int64]]]:
    """What ties points of rigid bodies together.

    A star from the centre of mass; of a body that holds a frame or shell the shortest tree, since a star in a rim would
    lie across the stresses of its shell. The centre is in that tree if the body is a box there.

    Parameters
    ----------
    centres
        Centres of mass of rigid bodies in their frames [m], by name.
    attached
        Points of any bodies.
    holding
        Names of bodies that hold a frame or shell.
    boxes
        Names of bodies that are drawn as boxes.

    Returns
    -------
    list
        Of each rigid body its name, points, shape (n, 3), and pairs of them, shape (m, 2).
    """
    points_of: dict[str, list[NDArray[np.float64]]] = {}
    for at in attached:
        if at.body in centres:
            points_of.setdefault(at.body, []).append(np.asarray(at.point, dtype=np.float64))
    found = []
    for name, given in points_of.items():
        points, count = np.array([centres[name], *given]), len(given)
        if name not in holding:
            pairs = np.column_stack([np.zeros(count, dtype=np.int64), 1 + np.arange(count)])
        elif name in boxes:
            pairs = shortest_tree(points)
        else:
            points = points[1:]
            pairs = shortest_tree(points)
        found.append((name, points, pairs))
    return found
