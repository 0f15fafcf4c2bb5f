"""The reference shape of a frame element: cubic Hermite through two nodes with unit tangents.

``X(xi) = S1 X_1 + S2 t_1 + S3 X_2 + S4 t_2`` with ``S2, S4`` proportional to the length l, which is that of the curve.
Its parameter is not quite its arc length: derivatives by that use the metric ``J = |X_xi|``, which is l at the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["ReferenceElement", "gauss_points", "hermite", "reference_element"]

STRAIGHT = 1e-6
"""Largest angle between tangent and chord of an element that counts as straight [rad]."""

LENGTH_POINTS = 24
"""Gauss points of the length of a curve: 15 digits up to half a turn."""


@cache
def gauss_points(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and weights on [0, 1], shape (count,) each."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def hermite(xi: NDArray[np.float64] | float, length: float, derivative: int = 0) -> NDArray[np.float64]:
    """Shape functions or their derivatives by ``xi``, shape (..., 4): of r, r' of the first node and of the second."""
    x = np.asarray(xi, dtype=np.float64)
    if derivative == 0:
        rows = (1 - x * x * (3 - 2 * x), x * (1 - x) ** 2, x * x * (3 - 2 * x), x * x * (x - 1))
    elif derivative == 1:
        rows = (6 * x * (x - 1), 1 + x * (3 * x - 4), 6 * x * (1 - x), x * (3 * x - 2))
    else:
        rows = (12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2)
    return np.stack((rows[0], length * rows[1], rows[2], length * rows[3]), axis=-1)


@dataclass(frozen=True, eq=False)
class ReferenceElement:
    """An element before it is deformed.

    Attributes
    ----------
    length
        Of its axis [m].
    vectors
        Position and tangent of the first and the second node, shape (4, 3).
    straight
        Whether it is.
    """

    length: float
    vectors: NDArray[np.float64]
    straight: bool

    def points(self, xi: NDArray[np.float64] | float, derivative: int = 0) -> NDArray[np.float64]:
        """Positions [m] or their derivatives by ``xi``, shape (..., 3)."""
        return hermite(xi, self.length, derivative) @ self.vectors

    def metric(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """``J = ds / dxi`` [m]."""
        if self.straight:
            return np.full(np.shape(xi), self.length)
        return np.linalg.norm(self.points(xi, 1), axis=-1)

    def slopes(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Rows of ``r'`` by arc length, shape (..., 4)."""
        return hermite(xi, self.length, 1) / self.metric(xi)[..., None]

    def second(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """Rows of ``r''`` by arc length, shape (..., 4): ``r_xixi / J^2 - r_xi J_xi / J^3``."""
        metric = self.metric(xi)[..., None]
        rows = hermite(xi, self.length, 2) / metric**2
        if self.straight:
            return rows
        first, second = self.points(xi, 1), self.points(xi, 2)
        rate = np.sum(first * second, axis=-1, keepdims=True) / metric
        return rows - hermite(xi, self.length, 1) * rate / metric**3

    def curvature(self, xi: NDArray[np.float64] | float) -> NDArray[np.float64]:
        """``|X' x X''|`` [1/m]."""
        if self.straight:
            return np.zeros(np.shape(xi))
        return np.linalg.norm(
            np.cross(self.slopes(xi) @ self.vectors, self.second(xi) @ self.vectors), axis=-1
        )


def reference_element(vectors: NDArray[np.float64]) -> ReferenceElement | None:
    """Element through two nodes, or None if no curve of a sensible length has these tangents.

    Parameters
    ----------
    vectors
        Position and unit tangent of the first and the second node, shape (4, 3).
    """
    chord = vectors[2] - vectors[0]
    length = float(np.linalg.norm(chord))
    if not 0.0 < length < np.inf:
        return None
    direction = chord / length
    if max(np.linalg.norm(vectors[1] - direction), np.linalg.norm(vectors[3] - direction)) < STRAIGHT:
        # equal elements get equal lengths, whatever their nodes are rounded to
        return ReferenceElement(float(f"{length:.14g}"), vectors, straight=True)
    xi, weights = gauss_points(LENGTH_POINTS)
    shortest = length
    for _ in range(200):  # the length contracts towards that of the curve which it makes
        speeds = np.linalg.norm(hermite(xi, length, 1) @ vectors, axis=1)
        longer = float(weights @ speeds)
        if abs(longer - length) <= 4e-16 * longer:
            break
        length = longer
    else:
        if abs(longer - length) > 1e-12 * longer:
            return None
    if not length < 2.0 * shortest or np.min(speeds) < 0.3 * length:
        return None
    return ReferenceElement(length, vectors, straight=False)
