"""Frame elements written again from the energy: polynomials, complex steps, no shared formula.

Strains are functions of all coordinates; gradients are their complex-step derivatives, exact to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss
from scipy.integrate import quad
from scipy.optimize import brentq

if TYPE_CHECKING:
    from collections.abc import Callable


def hermite_polynomials(length: float) -> list[Polynomial]:
    """From their conditions: value and slope at both ends of [0, 1]."""
    conditions = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 1, 1], [0, 1, 2, 3]], dtype=float)
    scale = [1.0, length, 1.0, length]
    return [
        Polynomial(np.linalg.solve(conditions, s * unit)) for s, unit in zip(scale, np.eye(4), strict=True)
    ]


@dataclass
class Section:
    EA: float
    EI: float
    mass: float
    """Per length [kg/m]."""


@dataclass
class OracleElement:
    """One element with 12 coordinates; `reference` holds r, r' of its nodes, shape (4, 3)."""

    reference: np.ndarray
    section: Section
    exact: bool
    curved: bool = False
    initial_strain: float = 0.0

    def __post_init__(self) -> None:
        X = self.reference

        def excess(length: float) -> float:
            derivatives = [p.deriv() for p in hermite_polynomials(length)]

            def speed(x: float) -> float:
                return float(np.linalg.norm(sum(p(x) * v for p, v in zip(derivatives, X, strict=True))))

            return quad(speed, 0.0, 1.0, epsabs=1e-13, epsrel=1e-13)[0] - length

        chord = float(np.linalg.norm(X[2] - X[0]))
        self.length = (
            brentq(excess, 0.9 * chord, 2.0 * chord, xtol=1e-15, rtol=1e-14) if self.curved else chord
        )
        self.N = hermite_polynomials(self.length)

        self.axial = [self.rows(0.5 * (x + 1)) for x in leggauss(5)[0]]
        self.bending = [self.rows(0.5 * (x + 1)) for x in leggauss(3)[0]]

    def row(self, xi: float, order: int) -> np.ndarray:
        """Derivative of the shape functions by xi."""
        return np.array([p.deriv(order)(xi) for p in self.N])

    def rows(self, xi: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Rows of r', r'' by arc length of the reference, and the metric: chain rule with s(xi)."""
        N1, N2 = self.row(xi, 1), self.row(xi, 2)
        X1, X2 = N1 @ self.reference, N2 @ self.reference
        J = float(np.sqrt(X1 @ X1))
        dJ = float(X1 @ X2) / J
        return N1 / J, (N2 - N1 / J * dJ) / J**2, J

    def strains(self, q: np.ndarray) -> np.ndarray:
        found, x = [], q.reshape(4, 3)
        for first, _, _ in self.axial:
            d = first @ x
            found.append((np.sqrt(d @ d) - 1 if self.exact else 0.5 * (d @ d - 1)) + self.initial_strain)
        for first, second, _ in self.bending if self.exact else ():
            k = curvature(first @ x, second @ x)
            if self.curved:
                k0 = curvature(first @ self.reference, second @ self.reference)
                found.append(np.sqrt(k @ k) - np.sqrt(k0 @ k0))
            else:
                found.extend(k)
        return np.array(found)

    def weights(self) -> np.ndarray:
        """Stiffness of each strain."""
        found = []
        bending_strains = 1 if self.curved else 3
        for (_, _, J), w in zip(self.axial, leggauss(5)[1], strict=True):
            found.append(0.5 * w * J * self.section.EA)
        for (_, _, J), w in zip(self.bending if self.exact else (), leggauss(3)[1], strict=False):
            found += [0.5 * w * J * self.section.EI] * bending_strains
        return np.array(found)

    def gradients(self, q: np.ndarray) -> np.ndarray:
        """``B = de/dq``."""
        return complex_step(self.strains, q)

    def forces(self, q: np.ndarray, strains: np.ndarray) -> np.ndarray:
        return self.gradients(q).T @ (self.weights() * strains)

    def stiffness(self, q: np.ndarray, strains: np.ndarray, geometric: float) -> np.ndarray:
        """``B^T C B + geometric d(B^T)/dq C e``; the second derivatives by differences of sixth order."""
        B = self.gradients(q)
        material = B.T @ (self.weights()[:, None] * B)
        if geometric == 0.0:
            return material
        columns = []
        for i in range(12):
            step = np.zeros(12)
            step[i] = 2e-3 * (1.0 if i % 6 > 2 else self.length)
            d = [
                (k, self.forces(q + k * step, strains) - self.forces(q - k * step, strains))
                for k in (1, 2, 3)
            ]
            columns.append((1.5 * d[0][1] - 0.3 * d[1][1] + d[2][1] / 30.0) / (2.0 * step[i]))
        return material + geometric * np.array(columns).T

    def integral(self, f: Callable[[float], np.ndarray]) -> np.ndarray:
        """Over the length of the reference."""
        x, w = leggauss(40)
        return sum(
            0.5 * wi * self.rows(0.5 * (xi + 1))[2] * f(0.5 * (xi + 1)) for xi, wi in zip(x, w, strict=True)
        )

    def mass_matrix(self) -> np.ndarray:
        """Scalar, 4 x 4."""

        def product(xi: float) -> np.ndarray:
            S = self.row(xi, 0)
            return np.outer(S, S)

        return self.section.mass * self.integral(product)

    def bending_matrix(self) -> np.ndarray:
        """Scalar, 4 x 4, of a straight element."""

        def product(xi: float) -> np.ndarray:
            S = self.row(xi, 2) / self.length**2
            return np.outer(S, S)

        return self.section.EI * self.integral(product)


def curvature(d: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Material curvature; `numpy.cross` is slow on single vectors."""
    k = np.array([d[1] * c[2] - d[2] * c[1], d[2] * c[0] - d[0] * c[2], d[0] * c[1] - d[1] * c[0]])
    return k / (d @ d)


def complex_step(f: Callable[[np.ndarray], np.ndarray], q: np.ndarray) -> np.ndarray:
    """Jacobian, shape (f, q)."""
    columns = []
    for i in range(len(q)):
        z = q.astype(complex)
        z[i] += 1e-30j
        columns.append(f(z).imag / 1e-30)
    return np.array(columns).T
