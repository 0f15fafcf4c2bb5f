"""Where the numbers of shell elements lie, and the tables that all elements of a body share.

A shell element is a product of cubic Hermite functions along its two directions. Vector instructions work
on the Gauss points of a line along eta: *lanes*, eight numbers, of which the first `gauss_points` count and the
others are zero. Lines follow each other along xi.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, record_at

__all__ = [
    "FUNCTIONS",
    "NODE_PLACES",
    "STRESS_PLACES",
    "XI_PAIRS",
    "ShellData",
    "ShellLine",
    "ShellTables",
    "gauss_rule",
    "hermite",
    "place_of",
    "shell_data",
    "shell_line",
    "shell_tables",
    "tables",
]

LANES = 8

STRESS_PLACES = 7
"""Places along each side of an element, ends included, at whose grid the largest stress is looked for. Pictures draw
some of these and no others, so that none shows more than is recorded."""


class ShellData(Record, whole_lines=True):
    """Data of an element; its lines of Gauss points follow.

    Attributes
    ----------
    mass, bending
        Scalar matrices of the 16 nodal vectors.
    lengths
        Along x and y.
    stretching, poissons_ratio, plate_stiffness, thickness
        ``E t / (1 - nu^2)``, nu, ``E t^3 / (12 (1 - nu^2))``, t.
    centre
        Rows for r_1, r_2, r_11, r_22, r_12 at the centre in orthonormal axes, the first along X_xi.
    axes
        At the places of stress, by xi and eta: ``|X_1|``, and the components of ``X_2`` along and across ``X_1``;
        derivatives on a unit square.
    """

    mass: Annotated[NDArray[np.float64], (16, 16)]
    bending: Annotated[NDArray[np.float64], (16, 16)]
    lengths: Annotated[NDArray[np.float64], (2,)]
    stretching: float
    poissons_ratio: float
    plate_stiffness: float
    thickness: float
    centre: Annotated[NDArray[np.float64], (5, 16)]
    axes: Annotated[NDArray[np.float64], (STRESS_PLACES, STRESS_PLACES, 3)]


class ShellLine(Record):
    """A line of Gauss points of an element, in lanes.

    Attributes
    ----------
    metric
        X_1.X_1/2, X_2.X_2/2, X_1.X_2.
    moduli
        D11, D22, D33, D12, D13, D23, with weight and area of the point.
    """

    metric: Annotated[NDArray[np.float64], (3, 8)]
    moduli: Annotated[NDArray[np.float64], (6, 8)]


class ShellTables(Record, whole_lines=True):
    """What all elements of a body share.

    Attributes
    ----------
    eta
        Lanes of four functions, then of their derivatives.
    xi
        By line: four functions, four derivatives.
    weights
        Lanes along eta; by line along xi.
    pairs
        By pair i >= k of functions along xi and line: H'_i H'_k, H'_i H_k, H_i H'_k, H_i H_k.
    products
        By lane: H_j H_l, H_j H'_l, H'_j H_l, H'_j H'_l, 16 numbers each.
    count
        Gauss points of a line.
    places
        At the places of stress: four functions, then their first and second derivatives on the unit interval.
    """

    eta: Annotated[NDArray[np.float64], (2, 4, 8)]
    xi: Annotated[NDArray[np.float64], (8, 2, 4)]
    weights: Annotated[NDArray[np.float64], (2, 8)]
    pairs: Annotated[NDArray[np.float64], (10, 8, 4)]
    products: Annotated[NDArray[np.float64], (8, 4, 4, 4)]
    count: int
    places: Annotated[NDArray[np.float64], (STRESS_PLACES, 3, 4)]


WORD = 8
POINTS, LINE = ShellData.layout.itemsize // WORD, ShellLine.layout.itemsize // WORD
"""Place of the lines in the data of an element, and numbers of one."""

shell_data, _shell_line, shell_tables = record_at(ShellData), record_at(ShellLine), record_at(ShellTables)


@kernel(inline=True, internal=True)
def shell_line(constants: NDArray[np.float64], data: int, number: int) -> ShellLine:
    """A line of the element whose data begin at a place."""
    return _shell_line(constants, data + POINTS + number * LINE)


def place_of(record: type[Record], field: str) -> int:
    """Word of a record with which a field begins, for code that is made of vector instructions."""
    return int(record.fields_of[field][1]) // WORD


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
    """`ShellTables` as words, for a number of Gauss points along each direction."""
    points, weights = gauss_rule(count)
    H, dH, _ = hermite(points)
    out = ShellTables.one()
    out.count = count
    out.eta[0, :, :count], out.eta[1, :, :count] = H.T, dH.T
    out.xi[:count] = np.stack([H, dH], axis=1)
    out.weights[:, :count] = weights
    for number, (i, k) in enumerate(XI_PAIRS):
        out.pairs[number, :count] = np.stack(
            [dH[:, i] * dH[:, k], dH[:, i] * H[:, k], H[:, i] * dH[:, k], H[:, i] * H[:, k]], axis=1
        )
    for number, (left, right) in enumerate(((H, H), (H, dH), (dH, H), (dH, dH))):
        out.products[:count, number] = left[:, :, np.newaxis] * right[:, np.newaxis, :]
    out.places[:] = np.swapaxes(hermite(np.linspace(0.0, 1.0, STRESS_PLACES)), 0, 1)
    return out.words.copy()
