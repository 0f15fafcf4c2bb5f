"""Samples of all contours of a scene in the arrays of the searches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.basis import find_span, write_basis
from heavylift.contours.splines.limits import LARGEST_DEGREE
from heavylift.contours.splines.samples import RING_ANGLES, SampleGrid, Samples, sample_points
from heavylift.numerics.objects import entry
from heavylift.numerics.records import records

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.contours.splines.spaces import SplineSpace
    from heavylift.numerics.arrays import Floats1, Floats2, Ints1
    from heavylift.numerics.records import Records

__all__ = ["pack_samples"]

_WIDE = LARGEST_DEGREE + 1


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


def _direction(
    space: SplineSpace | None, per_piece: int
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Parameters, first functions that are not zero and their values; of no space the one across a curve."""
    if space is None:
        return np.zeros(1), np.zeros(1, dtype=np.int64), np.eye(1, _WIDE)
    at = space.samples(per_piece)
    first, basis = np.zeros(at.size, dtype=np.int64), np.zeros((at.size, _WIDE))
    _write_values(space.knots, space.degree, space.functions, at, np.zeros(3 * _WIDE), first, basis)
    return at, first, basis


def pack_samples(
    spaces: Sequence[tuple[SplineSpace, ...]],
    contours: Records[PackedContour],
    weights: NDArray[np.float64],
    net: NDArray[np.float64],
    deforming: Sequence[bool],
    per_piece: int = 2,
) -> Samples:
    """Grids of all contours, and the positions of samples of those that do not deform.

    Parameters
    ----------
    spaces
        Spline spaces of each contour: one of a curve, two of a surface.
    contours, weights, net
        Packed contours, rational weights and control points [m].
    deforming
        Of each contour whether its control points move among themselves, so that its samples are placed later.
    per_piece
        Samples on every polynomial piece in each direction.
    """
    table = records(SampleGrid, len(spaces))
    parameters, first, basis = [np.zeros(0)], [np.zeros(0, dtype=np.int64)], [np.zeros((0, _WIDE))]
    start, blocks, widest, across = 0, 1, 1, 1
    for grid, own, contour, moves in zip(table, spaces, contours, deforming, strict=True):
        directions = [_direction(space, per_piece) for space in (*own, None)[:2]]
        counts = [one[0].size for one in directions]
        grid.first_u, grid.count_u = start, counts[0]
        grid.first_v, grid.count_v = start + counts[0], counts[1]
        grid.points = 0 if moves else 3 * blocks
        blocks += not moves
        start += sum(counts)
        widest, across = max(widest, counts[0] * counts[1]), max(across, int(contour.u.count) * counts[1])
        for at, functions, values in directions:
            parameters.append(at)
            first.append(functions)
            basis.append(values)
    samples = Samples(
        grids=table,
        parameters=np.concatenate(parameters),
        first=np.concatenate(first),
        basis=np.concatenate(basis),
        points=np.zeros((3 * blocks, widest)),
        across=np.zeros((4, across)),
        distances=np.zeros(widest),
        angles=np.zeros(3 * RING_ANGLES),
    )
    for grid, contour in zip(table, contours, strict=True):
        if grid.points > 0:
            sample_points(contour, weights, net, samples, grid)
    return samples
