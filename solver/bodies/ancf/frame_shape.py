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

EXPONENTS = np.arange(4)
CUBICS = np.zeros((3, 4, 4))
"""Coefficients of 1, xi, xi^2, xi^3 in the shape functions of an element of length 1, by derivative."""
CUBICS[0] = [[1, 0, 0, 0], [0, 1, 0, 0], [-3, -2, 3, -1], [2, 1, -2, 1]]
CUBICS[1, :3] = CUBICS[0, 1:] * np.array([[1], [2], [3]])
CUBICS[2, :3] = CUBICS[1, 1:] * np.array([[1], [2], [3]])

LENGTH_POINTS = 24
"""Gauss points of the length of a curve: 15 digits up to half a turn."""


@cache
def gauss_points(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and weights on [0, 1], shape (count,) each."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def hermite(xi: NDArray[np.float64] | float, length: float, derivative: int = 0) -> NDArray[np.float64]:
    """Shape functions or their derivatives by ``xi``, shape (..., 4): of r, r' of the first node and of the second."""
    powers = np.asarray(xi, dtype=np.float64)[..., None] ** EXPONENTS
    return powers @ CUBICS[derivative] * np.array([1.0, length, 1.0, length])


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
        return ReferenceElement(float(f"{length:.13g}"), vectors, straight=True)
    xi, weights = gauss_points(LENGTH_POINTS)
    rows = hermite(xi, 1.0, 1)
    fixed, slopes = rows[:, ::2] @ vectors[::2], rows[:, 1::2] @ vectors[1::2]
    shortest, change = length, np.inf
    for _ in range(20):  # Newton for the length of the curve that it makes
        rates = fixed + length * slopes
        speeds = np.linalg.norm(rates, axis=1)
        gain = weights @ (np.sum(rates * slopes, axis=1) / speeds)
        change = (weights @ speeds - length) / (1.0 - gain)
        length += change
        if abs(change) <= 1e-15 * length:
            break
    usable = abs(change) < 1e-12 * length and 0.999 * shortest < length < 2.0 * shortest
    if not usable or np.min(speeds) < 0.3 * length:  # folded, or turned back
        return None
    return ReferenceElement(length, vectors, straight=False)
