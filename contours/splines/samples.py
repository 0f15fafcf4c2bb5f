"""A grid of points on a contour, a few on every polynomial piece, from which a search begins when nothing is known."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.basis import find_span, write_basis
from heavylift.contours.splines.layout import LARGEST_DEGREE
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.spaces import SplineSpace
    from heavylift.numerics.arrays import Floats1, Floats2, Ints1

__all__ = ["SampleGrid", "sample_grid", "sample_points"]

_WIDE = LARGEST_DEGREE + 1


@dataclass(frozen=True, eq=False)
class SampleGrid:
    """Parameters of a grid and the basis functions there, computed once for a contour.

    Attributes
    ----------
    u, v
        Parameters, shapes (a,) and (b,); of a curve ``v = (0,)``.
    first_u, first_v
        First non-zero function at each, int64, shapes (a,) and (b,).
    basis_u, basis_v
        Values of the non-zero functions, shapes (a, LARGEST_DEGREE + 1) and (b, LARGEST_DEGREE + 1).
    """

    u: NDArray[np.float64]
    v: NDArray[np.float64]
    first_u: NDArray[np.int64]
    first_v: NDArray[np.int64]
    basis_u: NDArray[np.float64]
    basis_v: NDArray[np.float64]

    @property
    def count(self) -> int:
        """Samples of the grid; number ``i * b + j`` is that of ``u[i], v[j]``."""
        return self.u.size * self.v.size


@entry
def _write_values(
    knots: Floats1,
    degree: int,
    functions: int,
    parameters: Floats1,
    scratch: Floats1,
    first: Ints1,
    basis: Floats2,
) -> None:
    """Non-zero functions at some parameters."""
    for i in range(parameters.size):
        span = find_span(knots, 0, degree, functions, parameters[i])
        write_basis(knots, 0, degree, span, parameters[i], scratch, 0)
        first[i] = span - degree
        for k in range(degree + 1):
            basis[i, k] = scratch[k]


def sample_grid(spaces: tuple[SplineSpace, ...], per_piece: int = 2) -> SampleGrid:
    """Grid on a curve (one space) or a surface (two).

    Parameters
    ----------
    spaces
        Spline spaces of the directions.
    per_piece
        Samples on every polynomial piece in each direction.
    """
    parameters, firsts, values = [], [], []
    for space in spaces:
        at = space.samples(per_piece)
        first = np.zeros(at.size, dtype=np.int64)
        basis = np.zeros((at.size, _WIDE))
        _write_values(space.knots, space.degree, space.functions, at, np.zeros(3 * _WIDE), first, basis)
        parameters.append(at)
        firsts.append(first)
        values.append(basis)
    if len(spaces) == 1:
        constant = np.zeros((1, _WIDE))
        constant[0, 0] = 1.0
        parameters.append(np.zeros(1))
        firsts.append(np.zeros(1, dtype=np.int64))
        values.append(constant)
    return SampleGrid(parameters[0], parameters[1], firsts[0], firsts[1], values[0], values[1])


@entry
def sample_points(
    contour: PackedContour,
    weights: Floats1,
    net: Floats2,
    first_u: Ints1,
    first_v: Ints1,
    basis_u: Floats2,
    basis_v: Floats2,
    across: Floats2,
    points: Floats2,
) -> float:
    """Positions of the samples for control points that have moved; again whenever a flexible body has.

    Parameters
    ----------
    contour, weights, net
        Packed contour, rational weights, control points [m], all of them formed.
    first_u, first_v, basis_u, basis_v
        Of a `SampleGrid` of a x b samples.
    across
        Scratch, shape (4, count_u * b).
    points
        Out, one coordinate a row so that distances are computed side by side [m], shape (3, a * b).

    Returns
    -------
    float
        Reach of a sample [m]: three quarters of its largest distance to the next one in u plus that in v, of which it
        represents one half.
    """
    count_u, count_v = contour.u.count, contour.v.count
    wide_u, wide_v = contour.u.degree + 1, contour.v.degree + 1
    first_weight, first_control = contour.first_weight, contour.first_control
    a, b = first_u.size, first_v.size
    for i in range(count_u):
        for j in range(b):
            px = py = pz = total = 0.0
            for k in range(wide_v):
                column = first_v[j] + k
                local = i * count_v + (column - count_v if column >= count_v else column)
                w = basis_v[j, k]
                if first_weight >= 0:
                    w *= weights[first_weight + local]
                px += w * net[first_control + local, 0]
                py += w * net[first_control + local, 1]
                pz += w * net[first_control + local, 2]
                total += w
            at = i * b + j
            across[0, at], across[1, at], across[2, at], across[3, at] = px, py, pz, total
    for i in range(a):
        for j in range(b):
            px = py = pz = total = 0.0
            for k in range(wide_u):
                row = first_u[i] + k
                at = (row - count_u if row >= count_u else row) * b + j
                w = basis_u[i, k]
                px += w * across[0, at]
                py += w * across[1, at]
                pz += w * across[2, at]
                total += w * across[3, at]
            at = i * b + j
            points[0, at], points[1, at], points[2, at] = px / total, py / total, pz / total
    step_u = 0.0
    step_v = 0.0
    for i in range(a):
        for j in range(b):
            at = i * b + j
            if i + 1 < a:
                step_u = max(step_u, _apart(points, at, at + b))
            if j + 1 < b:
                step_v = max(step_v, _apart(points, at, at + 1))
    return 0.75 * (math.sqrt(step_u) + math.sqrt(step_v))


@kernel(inline=True, internal=True)
def _apart(points: NDArray, k: int, m: int) -> float:
    """Squared distance of two samples."""
    dx = points[0, k] - points[0, m]
    dy = points[1, k] - points[1, m]
    dz = points[2, k] - points[2, m]
    return dx * dx + dy * dy + dz * dz
