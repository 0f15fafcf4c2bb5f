"""A grid of points on every contour, a few on each polynomial piece, from which a search begins that knows nothing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour

__all__ = ["RING_ANGLES", "SampleGrid", "Samples", "sample_points"]

RING_ANGLES = 24
"""Around a ring, at which the gap is looked up first."""


class SampleGrid(Record):
    """Samples of one contour: number ``i * count_v + j`` is that of parameters i in u and j in v.

    Attributes
    ----------
    first_u, count_u, first_v, count_v
        First parameter in u and in v, and how many; of a curve ``v = (0,)``.
    points
        First of three rows of positions.
    reach
        Of a sample [m]: three quarters of its largest distance to the next one in u plus that in v, of which it
        represents one half.
    """

    first_u: int
    count_u: int
    first_v: int
    count_v: int
    points: int
    reach: float


class Samples(Arrays):
    """Grids of all contours, and scratch of the searches from them.

    Attributes
    ----------
    grids
        Of each contour.
    parameters, first, basis
        Of all grids one after another, u before v: parameter, first function that is not zero, values of the functions,
        shapes (a,), (a,) and (a, LARGEST_DEGREE + 1).
    points
        Positions [m], three rows a contour as wide as the largest grid, one coordinate a row so that distances are
        computed side by side. Contours that deform share the first three.
    across, distances, angles
        Scratch: sums along v, distances of samples, and gap and parameters at RING_ANGLES angles of a ring.
    """

    grids: Records[SampleGrid]
    parameters: Floats1
    first: Ints1
    basis: Floats2
    points: Floats2
    across: Floats2
    distances: Floats1
    angles: Floats1


@entry
def sample_points(
    contour: PackedContour, weights: Floats1, net: Floats2, samples: Samples, grid: SampleGrid
) -> None:
    """Positions and reach of samples for control points that have moved; again whenever a flexible body has.

    Parameters
    ----------
    contour, weights, net
        Packed contour, rational weights, control points [m], all of them formed.
    samples, grid
        All samples, and the grid of this contour.
    """
    count_u, count_v = contour.u.count, contour.v.count
    wide_u, wide_v = contour.u.degree + 1, contour.v.degree + 1
    first_weight, first_control = contour.first_weight, contour.first_control
    a, b = grid.count_u, grid.count_v
    of_u, of_v = grid.first_u, grid.first_v
    first, basis, across = samples.first, samples.basis, samples.across
    points = samples.points[grid.points : grid.points + 3]
    for i in range(count_u):
        for j in range(b):
            px = py = pz = total = 0.0
            for k in range(wide_v):
                column = first[of_v + j] + k
                local = i * count_v + (column - count_v if column >= count_v else column)
                w = basis[of_v + j, k]
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
                row = first[of_u + i] + k
                at = (row - count_u if row >= count_u else row) * b + j
                w = basis[of_u + i, k]
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
    grid.reach = 0.75 * (math.sqrt(step_u) + math.sqrt(step_v))


@kernel(inline=True, internal=True)
def _apart(points: NDArray, k: int, m: int) -> float:
    """Squared distance of two samples."""
    dx = points[0, k] - points[0, m]
    dy = points[1, k] - points[1, m]
    dz = points[2, k] - points[2, m]
    return dx * dx + dy * dy + dz * dz
