"""Curves and surfaces of other programs: NURBS given by knots, control points and weights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.neutral import NeutralContour
from heavylift.contours.splines.spaces import SplineSpace
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["imported_contour"]

SAME_POINT = 1e-9
"""Relative to the size of the net: control points at both sides of a seam that are one."""


def imported_contour(
    knots: Sequence[NDArray[np.float64]],
    control: NDArray[np.float64],
    degrees: Sequence[int],
    *,
    weights: NDArray[np.float64] | None = None,
    closed: Sequence[bool] | None = None,
    source: str = "contour",
) -> NeutralContour:
    """Contour of a rigid body from a NURBS; its domain becomes [0, 1].

    Parameters
    ----------
    knots
        Of each direction, not decreasing, any domain: clamped, or periodic if closed.
    control
        Control points [m] (not multiplied by weights), shape (a, 3) of a curve, (a, b, 3) of a surface.
    degrees
        Of each direction.
    weights
        Rational weights, shape (a,) or (a, b); all alike make a polynomial contour.
    closed
        Of each direction: whether both ends are one place; all open if absent. Three forms are understood: clamped
        knots with the first control points again as last ones (a circle of most programs); ``count + degree + 1``
        periodic knots with the first ``degree`` control points again at the end; ``count + 2 degree + 1`` periodic
        knots and every control point once.
    source
        Name of the contour, for messages.

    Returns
    -------
    NeutralContour
        Without modal coordinates.

    Raises
    ------
    InputError
        Knots, points and degrees that do not fit together, or ends of a closed direction that do not meet.
    """
    net = np.asarray(control, dtype=np.float64)
    directions = net.ndim - 1
    if directions not in {1, 2} or net.shape[-1] != 3:
        raise InputError(
            f"shape {net.shape}", source=source, key="control", expected="shape (a, 3) or (a, b, 3)"
        )
    if len(knots) != directions or len(degrees) != directions:
        raise InputError(
            f"{len(knots)} knot vectors and {len(degrees)} degrees for control points of shape {net.shape}",
            source=source,
            expected=f"{directions} of each",
        )
    if weights is None:
        weights = np.ones(net.shape[:-1])
    weights = np.asarray(weights, dtype=np.float64)
    if weights.shape != net.shape[:-1]:
        raise InputError(
            f"shape {weights.shape}", source=source, key="weights", expected=f"shape {net.shape[:-1]}"
        )
    points = np.concatenate([net, weights[..., None]], axis=-1)
    spaces = []
    for axis in range(directions):
        around = closed is not None and bool(closed[axis])
        where = source if directions == 1 else f"{source}, {('first', 'second')[axis]} direction"
        space, points = _direction(np.asarray(knots[axis], float), points, axis, degrees[axis], around, where)
        spaces.append(space)
    polynomial = np.all(points[..., 3] == points.flat[3])
    flat = points.reshape(-1, 4)
    return NeutralContour(
        tuple(spaces),
        np.ascontiguousarray(flat[:, :3]),
        np.zeros((0, len(flat), 3)),
        np.empty(0) if polynomial else np.ascontiguousarray(flat[:, 3]),
    )


def _direction(
    knots: NDArray[np.float64],
    points: NDArray[np.float64],
    axis: int,
    degree: int,
    closed: bool,
    source: str,
) -> tuple[SplineSpace, NDArray[np.float64]]:
    """Space of one direction and the points with repeated ones left out."""
    count = points.shape[axis]
    lengths = {count + degree + 1} | ({count + 2 * degree + 1} if closed else set())
    if knots.ndim != 1 or knots.size not in lengths:
        raise InputError(
            f"{knots.size} knots for {count} control points of degree {degree}",
            source=source,
            key="knots",
            expected=" or ".join(str(length) for length in sorted(lengths)),
        )
    last = knots.size - degree - 1
    begin, end = knots[degree], knots[last]
    if not end > begin:
        raise InputError(
            f"the domain is {begin:g} to {end:g}",
            source=source,
            key="knots",
            expected="a domain with a length",
        )
    unit = (knots - begin) / (end - begin)
    unit[knots == end] = 1.0
    if closed and knots.size == count + degree + 1:
        clamped = np.all(unit[: degree + 1] == 0.0) and np.all(unit[last:] == 1.0)
        repeated = 1 if clamped else degree
        _check_seam(points, axis, repeated, source)
        points = np.take(points, np.arange(count - repeated), axis=axis)
        if clamped:
            # the knot beyond each end is the neighbour of the seam on its other side, the seam itself stays p-fold
            unit = np.concatenate([[unit[last - 1] - 1.0], unit[1:-1], _after_seam(unit, degree)])
    try:
        space = SplineSpace(degree, unit, points.shape[axis], closed)
    except InputError as error:
        raise InputError(error.problem, source=source, key=error.key, expected=error.expected) from None
    return space, points


def _after_seam(unit: NDArray[np.float64], degree: int) -> NDArray[np.float64]:
    """Knots beyond the p-fold knot at the end of a clamped closed spline: those after its beginning, a period on.

    The space of ``count - 1`` functions has ``count + 2 degree`` knots; ``count + degree`` exist.
    """
    period = np.concatenate([unit[degree + 1 : -degree - 1], np.ones(degree)])  # of one turn, after the seam
    turns = -(-degree // len(period))
    return np.concatenate([period + 1.0 + turn for turn in range(turns)])[:degree]


def _check_seam(points: NDArray[np.float64], axis: int, repeated: int, source: str) -> None:
    """The last control points of a closed direction are its first ones again."""
    count = points.shape[axis]
    first = np.take(points, np.arange(repeated), axis=axis)
    last = np.take(points, np.arange(count - repeated, count), axis=axis)
    size = np.ptp(points[..., :3].reshape(-1, 3), axis=0).max()
    gap = np.abs(first - last)
    if np.max(gap[..., :3]) > SAME_POINT * size or np.max(gap[..., 3]) > SAME_POINT:
        raise InputError(
            f"the last {repeated} control points differ from the first by up to {np.max(gap[..., :3]):g} m",
            source=source,
            key="closed",
            expected="ends that meet, or an open direction",
        )
