"""Splines through points: parameters of the points, knots between them, and the matrix that is solved once.

Piegl & Tiller, The NURBS Book, section 9.2. Fitting is linear in the points: with the parameters of the undeformed
shape, control points of any deformed shape follow from the same matrix. "Deformable bodies ... sliding contacts"
(2014), eq. 3.18 to 3.21, is this fit for one shape.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from heavylift.contours.splines.basis import find_span, wrap, write_basis
from heavylift.contours.splines.limits import LARGEST_DEGREE
from heavylift.contours.splines.spaces import SplineSpace, clamped_space, closed_space
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.numerics.arrays import Floats1, Floats2

__all__ = [
    "Parametrisation",
    "basis_matrix",
    "control_points",
    "interpolation_space",
    "parameters_along",
    "parameters_averaged",
]

Parametrisation = Literal["chord", "centripetal", "uniform"]

EXPONENTS: dict[str, float] = {"chord": 1.0, "centripetal": 0.5, "uniform": 0.0}
"""Of the distance of neighbours, to which their difference in parameter is proportional."""

LARGEST_CONDITION = 1e8
"""Of the fit; above it the points hardly determine a spline."""

SAME_PLACE = 1e-9
"""Relative to the length of a curve: neighbours closer than this are one point."""


def _steps(points: NDArray[np.float64], closed: bool) -> NDArray[np.float64]:
    """Distances of neighbours, shape (..., k - 1) if open; (..., k) if closed, back to the first point."""
    following = np.roll(points, -1, axis=-2)
    steps = np.linalg.norm(following - points, axis=-1)
    return steps if closed else steps[..., :-1]


def parameters_along(
    points: NDArray[np.float64],
    parametrisation: Parametrisation = "chord",
    closed: bool = False,
    source: str = "contour",
) -> NDArray[np.float64]:
    """Parameters of the points of a curve (The NURBS Book, eq 9.3 to 9.6).

    Parameters
    ----------
    points
        In order [m], shape (k, 3).
    parametrisation
        Steps in proportion to the distance of neighbours, to its root, or all alike.
    closed
        The first point follows upon the last.
    source
        Name of the contour, for messages.

    Returns
    -------
    NDArray
        Shape (k,), from 0; the last is 1 if open, below 1 if closed.

    Raises
    ------
    InputError
        Neighbours in one place.
    """
    exponent = _exponent(parametrisation, source)
    steps = _steps(points, closed)
    same = np.flatnonzero(steps <= SAME_PLACE * np.sum(steps))
    if same.size:
        one = int(same[0])
        other = (one + 1) % len(points)
        seam = closed and other == 0
        raise InputError(
            f"points {one + 1} and {other + 1} are both at {points[one].tolist()} m",
            source=source,
            expected="a closed contour without its first point again at the end"
            if seam
            else "different points",
        )
    return _cumulated(steps**exponent, closed)


def parameters_averaged(
    points: NDArray[np.float64],
    parametrisation: Parametrisation = "chord",
    closed: bool = False,
    source: str = "contour",
) -> NDArray[np.float64]:
    """Parameters of one direction of a grid of points, averaged over its lines (The NURBS Book, algorithm A9.3).

    Parameters
    ----------
    points
        Lines of points [m], shape (lines, k, 3); lines that shrink to one point (a pole) have no say.
    parametrisation, closed, source
        See `parameters_along`.

    Returns
    -------
    NDArray
        Shape (k,), see `parameters_along`.

    Raises
    ------
    InputError
        No line has a length, or neighbouring lines across lie on each other.
    """
    exponent = _exponent(parametrisation, source)
    steps = _steps(points, closed)
    lengths = np.sum(steps, axis=1)
    used = lengths > SAME_PLACE * np.max(lengths)
    if not np.any(used):
        raise InputError("all points of every line are in one place", source=source, expected="a surface")
    relative = steps[used] / lengths[used, None]
    weighted = relative**exponent
    same = np.flatnonzero(np.mean(relative, axis=0) <= SAME_PLACE)
    if same.size:
        one = int(same[0])
        other = (one + 1) % points.shape[1]
        seam = closed and other == 0
        raise InputError(
            f"lines {one + 1} and {other + 1} of points lie on each other",
            source=source,
            expected="a closed contour without its first line again at the end"
            if seam
            else "different lines",
        )
    return _cumulated(np.mean(weighted / np.sum(weighted, axis=1, keepdims=True), axis=0), closed)


def _exponent(parametrisation: str, source: str) -> float:
    if parametrisation not in EXPONENTS:
        raise InputError(
            f"parametrisation {parametrisation!r}",
            source=source,
            expected="one of " + ", ".join(repr(key) for key in EXPONENTS),
        )
    return EXPONENTS[parametrisation]


def _cumulated(steps: NDArray[np.float64], closed: bool) -> NDArray[np.float64]:
    sums = np.concatenate([[0.0], np.cumsum(steps)])
    sums /= sums[-1]
    return sums[:-1] if closed else sums


def interpolation_space(
    parameters: NDArray[np.float64], degree: int, closed: bool = False, source: str = "contour"
) -> tuple[SplineSpace, NDArray[np.float64]]:
    """Space of as many functions as points, whose knots make the fit well posed.

    Open: every inner knot is the mean of ``degree`` consecutive parameters (The NURBS Book, eq 9.8), which keeps the
    matrix of the fit totally positive (Schoenberg and Whitney). Closed: knots at the parameters if the degree is odd,
    when the fit is the smoothest periodic curve through the points; halfway between them if it is even, since at the
    points an even number of equal steps would be singular.

    Parameters
    ----------
    parameters
        Of the points, from `parameters_along`, shape (k,).
    degree
        Of the splines.
    closed
        Whether the space is periodic.
    source
        Name of the contour, for messages.

    Returns
    -------
    tuple
        The space, and the parameters in it: those of a closed one of even degree are moved to begin at a knot.

    Raises
    ------
    InputError
        Too few points for the degree, or a degree that there are no kernels for.
    """
    count = len(parameters)
    if not 1 <= degree <= LARGEST_DEGREE:
        raise InputError(f"degree {degree}", source=source, key="degree", expected=f"1 to {LARGEST_DEGREE}")
    if count <= degree:
        raise InputError(
            f"{count} points for degree {degree}",
            source=source,
            expected=f"at least {degree + 1} points, or a lower degree",
        )
    if not closed:
        starts = range(1, count - degree)
        means = [np.mean(parameters[start : start + degree]) for start in starts]
        return clamped_space(degree, np.array(means)), parameters
    if degree % 2:
        return closed_space(degree, parameters), parameters
    before = np.concatenate([[parameters[-1] - 1.0], parameters[:-1]])
    middle = 0.5 * (before + parameters)
    return closed_space(degree, middle - middle[0]), parameters - middle[0]


@entry
def fill_basis_matrix(
    knots: Floats1,
    degree: int,
    count: int,
    closed: int,
    parameters: Floats1,
    scratch: Floats1,
    matrix: Floats2,
) -> None:
    """Rows of `basis_matrix`, added to zeros."""
    functions = count + degree if closed else count
    for row in range(parameters.shape[0]):
        u = wrap(parameters[row], closed)
        span = find_span(knots, 0, degree, functions, u)
        write_basis(knots, 0, degree, span, u, scratch, 0)
        for k in range(degree + 1):
            matrix[row, (span - degree + k) % count] += scratch[k]


def basis_matrix(space: SplineSpace, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weight of every control point at some parameters.

    Parameters
    ----------
    space
        The splines.
    parameters
        Shape (k,).

    Returns
    -------
    NDArray
        Shape (k, count).
    """
    matrix = np.zeros((len(parameters), space.count))
    at = np.ascontiguousarray(parameters, dtype=np.float64)
    scratch = np.zeros(3 * (LARGEST_DEGREE + 1))
    fill_basis_matrix(space.knots, space.degree, space.count, int(space.closed), at, scratch, matrix)
    return matrix


def control_points(
    space: SplineSpace,
    parameters: NDArray[np.float64],
    values: NDArray[np.float64],
    axis: int = 0,
    source: str = "contour",
) -> NDArray[np.float64]:
    """Control points of splines through values: ``N^-1`` along one axis of an array.

    Parameters
    ----------
    space, parameters
        From `interpolation_space`.
    values
        As many as parameters along the axis; all other axes are fitted with the same matrix.
    axis
        Direction of the parameter.
    source
        Name of the contour, for messages.

    Raises
    ------
    InputError
        The parameters do not determine the splines.
    """
    matrix = basis_matrix(space, parameters)
    condition = float(np.linalg.cond(matrix))
    if not condition < LARGEST_CONDITION:
        raise InputError(
            f"the fit of degree {space.degree} through {len(parameters)} points has the condition {condition:.1e}",
            source=source,
            expected="degree 3, or points at more even distances",
        )
    moved = np.moveaxis(values, axis, 0)
    solved = np.linalg.solve(matrix, moved.reshape(len(parameters), -1)).reshape(moved.shape)
    return np.ascontiguousarray(np.moveaxis(solved, 0, axis))
