"""Positions and derivatives of contours at many parameters, for Python: checks, pictures, reports."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.evaluate import SCRATCH, Evaluation, curve_point, surface_point
from heavylift.contours.splines.neutral import NeutralContour, packed
from heavylift.numerics.objects import entry
from heavylift.numerics.records import records

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.packed_contour import PackedContour
    from heavylift.numerics.arrays import Floats1, Floats2
    from heavylift.numerics.records import Records

__all__ = ["evaluate_contour", "sample_grid"]


@entry
def fill_surface(
    contour: PackedContour,
    knots: Floats1,
    weights: Floats1,
    net: Floats2,
    parameters: Floats2,
    scratch: Floats1,
    out: Records[Evaluation],
) -> None:
    """One result a row of parameters (u, v)."""
    for k in range(parameters.shape[0]):
        surface_point(contour, knots, weights, net, parameters[k, 0], parameters[k, 1], scratch, out[k])


@entry
def fill_curve(
    contour: PackedContour,
    knots: Floats1,
    weights: Floats1,
    net: Floats2,
    parameters: Floats2,
    scratch: Floats1,
    out: Records[Evaluation],
) -> None:
    """One result a row of parameters (u,)."""
    for k in range(parameters.shape[0]):
        curve_point(contour, knots, weights, net, parameters[k, 0], scratch, out[k])


def evaluate_contour(
    contour: NeutralContour,
    parameters: NDArray[np.float64],
    coordinates: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Position, tangents and second derivatives.

    Parameters
    ----------
    contour
        A curve or surface.
    parameters
        Shape (k,) of a curve, (k, 2) of a surface.
    coordinates
        Modal coordinates of the body, shape (nf,); undeformed if absent.

    Returns
    -------
    NDArray
        Shape (k, 6, 3): S, S_u, S_v, S_uu, S_uv, S_vv in the body frame [m]; zero where a curve has none.
    """
    shape = contour if coordinates is None else contour.deformed(coordinates)
    table, knots, weights, net = packed([shape])
    at = np.ascontiguousarray(parameters, dtype=np.float64).reshape(-1, len(contour.spaces))
    out = records(Evaluation, len(at))
    fill = fill_surface if contour.is_surface else fill_curve
    fill(table[0], knots, weights, net, at, np.zeros(SCRATCH), out)
    return out.view(np.float64).reshape(-1, 6, 3)


def sample_grid(
    contour: NeutralContour, per_piece: int, coordinates: NDArray[np.float64] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Samples spread over all polynomial pieces.

    Parameters
    ----------
    contour
        A curve or surface.
    per_piece
        Parts into which a piece is cut in each direction.
    coordinates
        Modal coordinates, see `evaluate_contour`.

    Returns
    -------
    tuple
        Parameters, shape (a, 1) or (a, b, 2), and values as of `evaluate_contour`, shape (a, 6, 3) or (a, b, 6, 3).
    """
    axes = [space.samples(per_piece) for space in contour.spaces]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = evaluate_contour(contour, grid.reshape(-1, len(axes)), coordinates)
    return grid, values.reshape(*grid.shape[:-1], 6, 3)
