"""Reference of the flexible pendulum: its element in the plane, on its own, integrated by DOP853.

A pinned rod of cubic elements r(s) = S(s) e with nodes r, r' in the plane, unloaded along x, and falling from
there. With the elastic energy per length

    green-lagrange:  EA e^2 / 2 + EI r''.r'' / 2,    e = (r'.r' - 1) / 2
    exact:           EA e^2 / 2 + EI K^2 / 2,        e = |r'| - 1,  K = (r' x r'') / |r'|^2

and the consistent mass matrix M, banded and factored once, M e'' = Q - dU/de. Gauss quadrature with 5 points,
which is exact for Green-Lagrange strains. DOP853 follows every wave along the rod.

    python make_reference.py        writes the tables and prints its checks
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import cho_solve_banded, cholesky_banded

LENGTH, DENSITY, AREA, SECOND_MOMENT = 1.2, 5540.0, 0.0018, 1.215e-8

Array = NDArray[np.float64]


class Run(NamedTuple):
    """One pendulum: elements, Young's modulus [Pa], gravity [m/s2], time [s], model, relative tolerance."""

    elements: int
    modulus: float
    gravity: float
    duration: float
    exact: bool = False
    tolerance: float = 1e-8

    @property
    def times(self) -> Array:
        """When the tip is recorded [s], shape (101,)."""
        return self.duration * np.arange(101) / 100


RUNS = {
    "reference_g981.csv": Run(160, 0.7e6, 9.81, 0.8),
    "reference_g981_exact.csv": Run(160, 0.7e6, 9.81, 0.8, exact=True),
    "../flexible_pendulum_g50/reference_g50.csv": Run(160, 0.7e6, 50.0, 0.3),
    "../flexible_pendulum_g50/reference_g50_exact.csv": Run(160, 0.7e6, 50.0, 0.3, exact=True),
    "../flexible_pendulum_stiff/reference_plastic.csv": Run(10, 0.7e9, 9.81, 1.0),
    "../flexible_pendulum_stiff/reference_steel.csv": Run(10, 2.1e11, 9.81, 1.0, tolerance=1e-7),
}


def shapes(l: float) -> tuple[Array, Array, Array, Array]:
    """S, S', S'' at the Gauss points of an element, shape (5, 4), and weights times length, shape (5,)."""
    node, weight = np.polynomial.legendre.leggauss(5)
    x, one = 0.5 * (1.0 + node), np.ones(5)
    S = np.stack([1 - 3 * x**2 + 2 * x**3, l * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, l * (x**3 - x**2)])
    S1 = np.stack([6 * (x**2 - x), l * (1 - 4 * x + 3 * x**2), 6 * (x - x**2), l * (3 * x**2 - 2 * x)]) / l
    S2 = np.stack([12 * x - 6 * one, l * (6 * x - 4), 6 * one - 12 * x, l * (6 * x - 2)]) / l**2
    return S.T, S1.T, S2.T, 0.5 * l * weight


class Pendulum:
    """Forces and accelerations; coordinates of all nodes e = (r, r'), shape (2 n + 2, 2)."""

    def __init__(self, run: Run) -> None:
        self.run, n = run, run.elements
        self.l = LENGTH / n
        self.S, self.S1, self.S2, self.w = shapes(self.l)
        self.rigidity = run.modulus * AREA, run.modulus * SECOND_MOMENT
        mass = DENSITY * AREA * np.einsum("g,gi,gj->ij", self.w, self.S, self.S)
        band = np.zeros((4, 2 * n + 2))
        for first in range(0, 2 * n, 2):
            for i in range(4):
                for j in range(i + 1):
                    band[i - j, first + j] += mass[i, j]
        band[0, 0] = 1.0
        band[1:, 0] = 0.0  # the pin
        self.factor = cholesky_banded(band, lower=True), True
        weight = DENSITY * AREA * run.gravity * self.w @ self.S
        self.weight = np.zeros((2 * n + 2, 2))
        self.add(self.weight[:, 1], np.broadcast_to(-weight, (n, 4)))
        self.start = np.zeros((2 * n + 2, 2))
        self.start[0::2, 0] = self.l * np.arange(n + 1)
        self.start[1::2, 0] = 1.0

    def add(self, total: Array, parts: Array) -> None:
        """Add vectors of elements, shape (n, 4, ...), to those of nodes."""
        total[:-2:2] += parts[:, 0]
        total[1:-2:2] += parts[:, 1]
        total[2::2] += parts[:, 2]
        total[3::2] += parts[:, 3]

    def slopes(self, e: Array) -> tuple[Array, Array]:
        """R' and r'' at the Gauss points, shape (n, 5, 2)."""
        local = np.stack([e[:-2:2], e[1:-2:2], e[2::2], e[3::2]], axis=1)
        return self.S1 @ local, self.S2 @ local

    def strains(self, e: Array) -> tuple[Array, Array]:
        """Axial strain and curvature (its size), shape (n, 5)."""
        t, c = self.slopes(e)
        square = (t * t).sum(axis=2)
        if not self.run.exact:
            return 0.5 * (square - 1.0), np.sqrt((c * c).sum(axis=2))
        return np.sqrt(square) - 1.0, (t[..., 0] * c[..., 1] - t[..., 1] * c[..., 0]) / square

    def energy(self, e: Array, v: Array) -> float:
        """Kinetic, elastic and potential energy [J]."""
        local = np.stack([v[:-2:2], v[1:-2:2], v[2::2], v[3::2]], axis=1)
        kinetic = DENSITY * AREA * self.w @ ((self.S @ local) ** 2).sum(axis=(0, 2))
        strain, curvature = self.strains(e)
        EA, EI = self.rigidity
        elastic = (EA * strain**2 + EI * curvature**2).sum(axis=0) @ self.w
        return float(0.5 * (kinetic + elastic) - (self.weight * e).sum())

    def acceleration(self, e: Array) -> Array:
        """M^-1 (Q - dU/de)."""
        EA, EI = self.rigidity
        t, c = self.slopes(e)
        square = (t * t).sum(axis=2, keepdims=True)
        if self.run.exact:
            size = np.sqrt(square)
            turned_t, turned_c = np.stack([-t[..., 1], t[..., 0]], 2), np.stack([c[..., 1], -c[..., 0]], 2)
            K = (turned_t * c).sum(axis=2, keepdims=True) / square
            axial = EA * (size - 1.0) * t / size + EI * K * (turned_c - 2.0 * K * t) / square
            bending = EI * K * turned_t / square
        else:
            axial, bending = EA * 0.5 * (square - 1.0) * t, EI * c
        weighted = self.w[:, np.newaxis]
        force = self.weight.copy()
        self.add(force, -(self.S1.T @ (weighted * axial) + self.S2.T @ (weighted * bending)))
        force[0] = 0.0
        return cho_solve_banded(self.factor, force, check_finite=False)

    def solution(self) -> tuple[Array, float]:
        """Tip at the sample times [m], shape (101, 2), and the largest change of energy [J]."""
        size, shape = self.start.size, self.start.shape

        def rate(_: float, y: Array) -> Array:
            return np.concatenate([y[size:], self.acceleration(y[:size].reshape(shape)).ravel()])

        y = np.concatenate([self.start.ravel(), np.zeros(size)])
        run = self.run
        found = solve_ivp(
            rate, (0.0, run.duration), y, "DOP853", run.times, rtol=run.tolerance, atol=1e-2 * run.tolerance
        ).y.T
        energies = [self.energy(row[:size].reshape(shape), row[size:].reshape(shape)) for row in found]
        return found[:, size - 4 : size - 2], float(np.ptp(energies))


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the tip [m] by file name, shape (101, 3)."""
    return {name: np.column_stack([run.times, Pendulum(run).solution()[0]]) for name, run in RUNS.items()}


def main() -> None:
    """Write the tables and print the checks."""
    for name, run in RUNS.items():
        tip, change = Pendulum(run).solution()
        table = np.column_stack([run.times, tip])
        rows = ["time,x,y", *(",".join(map(repr, row)) for row in table.tolist())]
        (Path(__file__).parent / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
        sys.stdout.write(f"{name}: the energy changes by {change:.1e} J\n")


if __name__ == "__main__":
    main()
