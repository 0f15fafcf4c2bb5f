"""Triangles cut into smaller ones, until no side is longer than a given size; shape and winding stay the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["refined_triangles"]

MOST = 200_000
"""Triangles beyond which a size is taken for a slip of units."""


def refined_triangles(
    points: NDArray[np.float64], triangles: NDArray[np.int64], size: float, *, name: str = "surface"
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Halve the longest side of every triangle that is too long, with its neighbour, until none is.

    Parameters
    ----------
    points, triangles
        Shape (nv, 3) [m] and (nt, 3).
    size
        Longest side of a triangle [m].
    name
        Of the surface, for messages.

    Returns
    -------
    tuple
        Points, the given ones first, and triangles wound as those they are part of. Neighbours continue sharing all
        corners along their sides.

    Raises
    ------
    InputError
        If the size is not positive, or so small that there would be more than 200,000 triangles.

    Notes
    -----
    Bisection of longest sides keeps angles from degenerating (Rosenberg and Stenger, *A lower bound on the angles of
    triangles constructed by bisecting the longest side*, Mathematics of Computation 29, 1975).
    """
    if not 0.0 < size < np.inf:
        raise InputError(f"{size!r}", source=name, key="size", expected="a length > 0 [m]")
    P, T = np.array(points, dtype=np.float64), np.array(triangles, dtype=np.int64)
    while True:
        sides = np.linalg.norm(
            P[T] - P[np.roll(T, -1, axis=1)], axis=2
        )  # side k is from corner k to the next
        long = sides.max(axis=1) > size * (1.0 + 1e-12)
        if not long.any():
            return P, T
        if len(T) > MOST:
            raise InputError(
                f"{size:g} m gives more than {MOST} triangles",
                source=name,
                key="size",
                expected="a larger size [m]",
            )
        # the first corner becomes the beginning of the longest side, of equal ones the same in both neighbours
        ends = np.sort(np.stack([T, np.roll(T, -1, axis=1)], axis=2), axis=2)
        order = np.lexsort((ends[:, :, 1].ravel(), ends[:, :, 0].ravel(), np.round(sides / size, 9).ravel()))
        rank = np.empty(order.size, dtype=np.int64)
        rank[order] = np.arange(order.size)
        first = np.argmax(rank.reshape(sides.shape), axis=1)
        T = T[np.arange(len(T))[:, None], (first[:, None] + np.arange(3)) % 3]
        keys = np.sort(T[:, :2], axis=1)
        split = np.unique(keys[long], axis=0)
        number = {(int(a), int(b)): len(P) + k for k, (a, b) in enumerate(split)}
        P = np.concatenate([P, 0.5 * (P[split[:, 0]] + P[split[:, 1]])])
        T = _bisected(T, number)


def _bisected(T: NDArray[np.int64], number: dict[tuple[int, int], int]) -> NDArray[np.int64]:
    """Triangles cut at the new points on their sides; the first side of each is its longest."""
    rows: list[tuple[int, int, int]] = []
    for a, b, c in T.tolist():
        ab, bc, ca = (number.get((min(p, q), max(p, q)), -1) for p, q in ((a, b), (b, c), (c, a)))
        if ab < 0 and (bc >= 0 or ca >= 0):
            # a shorter side is cut for a neighbour's sake: straight to the corner across
            if bc >= 0 and ca >= 0:
                rows += [(bc, c, ca), (a, b, bc), (a, bc, ca)]
            else:
                rows += [(a, b, bc), (a, bc, c)] if bc >= 0 else [(a, b, ca), (ca, b, c)]
            continue
        if ab < 0:
            rows.append((a, b, c))
            continue
        rows += [(ab, b, bc), (ab, bc, c)] if bc >= 0 else [(ab, b, c)]
        rows += [(ab, c, ca), (ab, ca, a)] if ca >= 0 else [(ab, c, a)]
    return np.array(rows, dtype=np.int64)
