"""Samples of all contours of a scene in the arrays of the solver."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.contours.splines.layout import LARGEST_DEGREE
from heavylift.contours.splines.samples import sample_grid, sample_points
from heavylift.contours.splines.search_circle_cold import RING_ANGLES
from heavylift.numerics.records import Records, records
from heavylift.solver.contact.kind import OF_GROUND, OF_RIGID, ContactContour, SampleGrid, Samples

if TYPE_CHECKING:
    from heavylift.contours.splines.spaces import SplineSpace

__all__ = ["pack_samples"]


def pack_samples(
    spaces: Sequence[tuple[SplineSpace, ...]],
    rows: Records[ContactContour],
    constants: NDArray[np.float64],
    net: NDArray[np.float64],
) -> Samples:
    """Grids of all contours, and the positions of samples of those that do not deform.

    Parameters
    ----------
    spaces
        Spline spaces of each contour.
    rows, constants, net
        As in `ContactRows`.
    """
    grids = [sample_grid(one) for one in spaces]
    table = records(SampleGrid, len(grids))
    widest = max((grid.count for grid in grids), default=1)
    across = max((int(row.u.count) * grid.v.size for row, grid in zip(rows, grids, strict=True)), default=1)
    parameters, first, basis = (
        [np.zeros(0)],
        [np.zeros(0, dtype=np.int64)],
        [np.zeros((0, LARGEST_DEGREE + 1))],
    )
    start = 0
    blocks = 1
    for i, grid in enumerate(grids):
        fixed = rows[i].owner in {OF_RIGID, OF_GROUND}
        row = table[i]
        row.first_u, row.count_u = start, grid.u.size
        row.first_v, row.count_v = start + grid.u.size, grid.v.size
        row.points = 3 * blocks if fixed else 0
        blocks += int(fixed)
        start += grid.u.size + grid.v.size
        parameters += [grid.u, grid.v]
        first += [grid.first_u, grid.first_v]
        basis += [grid.basis_u, grid.basis_v]
    samples = Samples(
        grids=table,
        parameters=np.concatenate(parameters),
        first=np.concatenate(first),
        basis=np.concatenate(basis),
        reach=np.zeros(len(grids)),
        points=np.zeros((3 * blocks, widest)),
        across=np.zeros((4, across)),
        distances=np.zeros(widest),
        angles=np.zeros(4 * RING_ANGLES),
    )
    for i, grid in enumerate(grids):
        at = table[i].points
        if at > 0:
            samples.reach[i] = sample_points(
                rows[i],
                constants,
                net,
                grid.first_u,
                grid.first_v,
                grid.basis_u,
                grid.basis_v,
                samples.across,
                samples.points[at : at + 3],
            )
    return samples
