"""The bicubic shell element once more, in plain NumPy and along other ways than the package.

Shape functions come from the monomials of a bicubic polynomial and its 16 nodal conditions; strain from the
deformation gradient in orthonormal axes; forces from complex steps of the energy; second derivatives from
the chain rule solved for Cartesian ones.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from heavylift.solver.scene.meshes import ShellBody, ShellSection

CORNERS = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def monomials(x: float, y: float, i: int, j: int) -> np.ndarray:
    """Derivatives i along x and j along y of x^m y^n, m and n up to 3."""

    def powers(z: float, order: int) -> list[float]:
        return [math.perm(m, order) * z ** (m - order) if m >= order else 0.0 for m in range(4)]

    return np.outer(powers(x, i), powers(y, j)).ravel()


@cache
def coefficients(a: float, b: float) -> np.ndarray:
    """Of the monomials in the 16 shape functions of nodal vectors by lengths."""
    conditions = [
        monomials(u, v, du, dv) / (a**du * b**dv)
        for u, v in CORNERS
        for du, dv in ((0, 0), (1, 0), (0, 1), (1, 1))
    ]
    return np.linalg.inv(np.array(conditions)).T


def functions(lengths: np.ndarray, x: float, y: float, i: int, j: int) -> np.ndarray:
    """Derivatives by unit coordinates of the 16 shape functions of nodal vectors by lengths."""
    return coefficients(*map(float, lengths)) @ monomials(x, y, i, j)


class Element:
    """One element of a body: energy, forces, tangent, matrices."""

    def __init__(self, body: ShellBody, number: int, points: int | None = None) -> None:
        self.section: ShellSection = body.sections[0]
        self.lengths = body.lengths[number]
        nodal = np.concatenate([body.nodes[:, np.newaxis], body.slopes], axis=1)
        self.X = nodal[body.elements[number]].reshape(16, 3)
        at, weights = np.polynomial.legendre.leggauss(points or body.gauss_points)
        at, weights = 0.5 * (at + 1.0), 0.5 * weights
        self.points = [(x, y) for x in at for y in at]
        self.weights = [p * q for p in weights for q in weights]
        E, nu, t = self.section.youngs_modulus, self.section.poissons_ratio, self.section.thickness
        self.C = (
            t * E / (1.0 - nu**2) * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
        )
        self.D = self.C * t**2 / 12.0
        self.dS = np.array(
            [
                [functions(self.lengths, x, y, 1, 0), functions(self.lengths, x, y, 0, 1)]
                for x, y in self.points
            ]
        )
        X = self.dS @ self.X  # (p, a, 3)
        first = X[:, 0] / np.linalg.norm(X[:, 0], axis=1, keepdims=True)
        normal = np.cross(X[:, 0], X[:, 1])
        self.areas = np.linalg.norm(normal, axis=1)
        second = np.cross(normal / self.areas[:, np.newaxis], first)
        self.frames = np.stack([first, second], axis=1)
        self.J = np.einsum("pak,pxk->pxa", X, self.frames)

    def strains(self, q: np.ndarray) -> np.ndarray:
        """xx, yy, 2xy in orthonormal axes, shape (p, 3)."""
        F = np.einsum("pan,nk,pax->pkx", self.dS, q.reshape(16, 3), np.linalg.inv(self.J))
        E = 0.5 * (np.einsum("pkx,pky->pxy", F, F) - np.eye(2))
        return np.stack([E[:, 0, 0], E[:, 1, 1], 2.0 * E[:, 0, 1]], axis=1)

    def energy(self, q: np.ndarray) -> complex:
        e = self.strains(q)
        return 0.5 * np.einsum("p,p,pr,rs,ps->", self.weights, self.areas, e, self.C, e)

    def forces(self, q: np.ndarray) -> np.ndarray:
        """Gradient of the energy, by complex steps, shape (48,)."""
        out = np.zeros(48)
        for c in range(48):
            moved = q.astype(complex).ravel()
            moved[c] += 1e-30j
            out[c] = self.energy(moved).imag / 1e-30
        return out

    def tangent(self, q: np.ndarray) -> np.ndarray:
        """Central differences of the forces; they are cubic, so Richardson's rule makes them exact."""
        out = np.zeros((48, 48))
        h = 1e-2
        for c in range(48):
            step = np.zeros(48)
            step[c] = h
            one = (self.forces(q.ravel() + step) - self.forces(q.ravel() - step)) / (2.0 * h)
            two = (self.forces(q.ravel() + 2.0 * step) - self.forces(q.ravel() - 2.0 * step)) / (4.0 * h)
            out[:, c] = (4.0 * one - two) / 3.0
        return out

    def mass(self) -> np.ndarray:
        S = np.array([functions(self.lengths, x, y, 0, 0) for x, y in self.points])
        weights = np.array(self.weights) * self.areas * self.section.density * self.section.thickness
        return S.T @ (weights[:, np.newaxis] * S)

    def bending(self) -> np.ndarray:
        out = np.zeros((16, 16))
        for p, (x, y) in enumerate(self.points):
            orders = ((1, 0), (0, 1), (2, 0), (0, 2), (1, 1))
            S = [functions(self.lengths, x, y, *order) for order in orders]
            x_1, x_2, x_11, x_22, x_12 = (self.frames[p] @ (s @ self.X) for s in S)
            chain = np.zeros((5, 5))  # by S_x, S_y, S_xx, S_yy, S_xy
            chain[0, :2], chain[1, :2] = x_1, x_2
            for row, bent, u, v in ((2, x_11, x_1, x_1), (3, x_22, x_2, x_2), (4, x_12, x_1, x_2)):
                chain[row] = [*bent, u[0] * v[0], u[1] * v[1], u[0] * v[1] + u[1] * v[0]]
            curvature = np.linalg.solve(chain, np.array(S))[2:]
            curvature[2] *= 2.0
            out += self.weights[p] * self.areas[p] * curvature.T @ self.D @ curvature
        return out
