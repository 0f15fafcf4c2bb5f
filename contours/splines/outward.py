"""On which side of a surface the material is, told from the other nodes of the body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["inward_share"]

CLEARLY_SMALLER = 1.5
"""Ratio of the largest empty balls on both sides from which the smaller one tells the material."""


def inward_share(
    points: NDArray[np.float64], normals: NDArray[np.float64], nodes: NDArray[np.float64]
) -> tuple[float, float]:
    """Shares of points of a surface whose normal points out of, and into, the material.

    At every point a ball that touches the surface there grows on either side until it meets a node: one of diameter
    ``r^2 / h`` meets a node at the distance r and the height h. In the material it meets one soon, outside late (of a
    hollow, on its other side) or never. A point with balls of about one size has no say.

    Parameters
    ----------
    points, normals
        Of the surface, shape (k, 3) [m] and unit vectors.
    nodes
        Of the body, shape (n, 3).

    Returns
    -------
    tuple
        Outward and inward share; what is missing to 1 is undecided.
    """
    outward = inward = 0
    for point, normal in zip(points, normals, strict=True):
        way = nodes - point
        square = np.sum(way * way, axis=1)
        away = square > 0.0
        # inverse diameters: finite for nodes in the tangent plane
        height = (way[away] @ normal) / square[away]
        before = np.max(height, initial=0.0)
        behind = -np.min(height, initial=0.0)
        if behind > CLEARLY_SMALLER * before:
            outward += 1
        elif before > CLEARLY_SMALLER * behind:
            inward += 1
    return outward / len(points), inward / len(points)
