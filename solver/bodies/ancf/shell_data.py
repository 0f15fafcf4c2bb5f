"""Where the numbers of shell elements lie, and the tables that all elements of a body share.

A shell element is a product of cubic Hermite functions along its two directions. Vector instructions work
on the Gauss points of a line along eta: *lanes*, eight numbers, of which the first `gauss_points` count and the
others are zero. Lines follow each other along xi.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["FUNCTIONS", "NODE_PLACES", "XI_PAIRS", "gauss_rule", "hermite", "tables"]

LANES = 8

# data of an element from `ELEMENT_DATA` on
MASS = 0  # 16 x 16
BENDING = 256  # 16 x 16
LENGTHS = 512  # along x and y
MATERIAL = 514  # E t / (1 - nu^2), nu, E t^3 / (12 (1 - nu^2)), t
CENTRE = 518  # rows of 16: at the centre r_1, r_2, r_11, r_22, r_12 in orthonormal axes, the first along X_xi
POINTS = 600  # by line: `LINE` numbers
METRIC = 0  # lanes of X_1.X_1/2, X_2.X_2/2, X_1.X_2
MODULI = 24  # lanes of D11, D22, D33, D12, D13, D23, with weight and area of the point
LINE = 72

# tables of a body from `CONSTANTS` on
COUNT = 0  # Gauss points of a line
ETA = 8  # lanes of four functions, then of their derivatives
XI = 72  # by line: four functions, four derivatives
WEIGHTS = 136  # lanes along eta; by line along xi
PAIRS = 152  # by pair i >= k of functions along xi and line: H'_i H'_k, H'_i H_k, H_i H'_k, H_i H_k
PRODUCTS = 472  # by lane: H_j H_l, H_j H'_l, H'_j H_l, H'_j H'_l, 16 numbers each
TABLES = 984

STRAINS_PER_LINE = 24
"""Lanes of E_11, E_22 and 2 E_12."""

NODE_PLACES = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Places of the nodes of an element along its two directions."""

FUNCTIONS = tuple(
    (2 * x + slope_x, 2 * y + slope_y)
    for x, y in NODE_PLACES
    for slope_x, slope_y in ((0, 0), (1, 0), (0, 1), (1, 1))
)
"""Functions along xi and eta whose product belongs to each of the 16 vectors, node by node."""


XI_PAIRS = tuple((row, column) for row in range(4) for column in range(row + 1))
"""Pairs of functions along xi that stiffness is made of."""


def gauss_rule(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and weights on the unit interval."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights


def hermite(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cubic functions of the value and slope at 0 and at 1, and two derivatives, by place; shape (3, p, 4)."""
    x = np.asarray(places, dtype=np.float64)[:, np.newaxis]
    one = np.ones_like(x)
    values = [1.0 - 3.0 * x**2 + 2.0 * x**3, x * (1.0 - x) ** 2, x**2 * (3.0 - 2.0 * x), x**2 * (x - 1.0)]
    first = [6.0 * x * (x - 1.0), (1.0 - x) * (1.0 - 3.0 * x), 6.0 * x * (1.0 - x), x * (3.0 * x - 2.0)]
    second = [6.0 * (2.0 * x - 1.0), 6.0 * x - 4.0, 6.0 * (1.0 - 2.0 * x), 6.0 * x - 2.0]
    return np.stack([np.concatenate([one * f for f in row], axis=1) for row in (values, first, second)])


def tables(count: int) -> NDArray[np.float64]:
    """Tables for a number of Gauss points along each direction, shape (984,)."""
    points, weights = gauss_rule(count)
    H, dH, _ = hermite(points)
    out = np.zeros(TABLES)
    out[COUNT] = count
    eta = out[ETA:XI].reshape(2, 4, LANES)
    eta[0, :, :count], eta[1, :, :count] = H.T, dH.T
    out[XI:WEIGHTS].reshape(LANES, 2, 4)[:count] = np.stack([H, dH], axis=1)
    out[WEIGHTS:PAIRS].reshape(2, LANES)[:, :count] = weights
    pairs = out[PAIRS:PRODUCTS].reshape(10, LANES, 4)
    for number, (i, k) in enumerate(XI_PAIRS):
        pairs[number, :count] = np.stack(
            [dH[:, i] * dH[:, k], dH[:, i] * H[:, k], H[:, i] * dH[:, k], H[:, i] * H[:, k]], axis=1
        )
    products = out[PRODUCTS:].reshape(LANES, 4, 4, 4)
    for number, (left, right) in enumerate(((H, H), (H, dH), (dH, H), (dH, dH))):
        products[:count, number] = left[:, :, np.newaxis] * right[:, np.newaxis, :]
    return out
