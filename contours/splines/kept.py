"""Contours through points, and their checks, made once for the same points: see `heavylift.numerics.derived`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.contours.splines.checks import check_contour
from heavylift.contours.splines.neutral import NeutralContour, neutral_curve, neutral_surface
from heavylift.contours.splines.spaces import SplineSpace
from heavylift.numerics.derived import derived

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.contours.splines.interpolation import Parametrisation

__all__ = ["ContourArrays", "kept_check", "kept_contour"]


class ContourArrays(NamedTuple):
    """A contour as arrays.

    Attributes
    ----------
    degrees, counts, closed, knot_counts
        Of its directions.
    knots
        Of all directions, one after another.
    control, modal, weights
        As of `NeutralContour`.
    """

    degrees: NDArray[np.int64]
    counts: NDArray[np.int64]
    closed: NDArray[np.bool_]
    knot_counts: NDArray[np.int64]
    knots: NDArray[np.float64]
    control: NDArray[np.float64]
    modal: NDArray[np.float64]
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, contour: NeutralContour) -> ContourArrays:
        """Arrays of a contour."""
        spaces = contour.spaces
        return cls(
            np.array([one.degree for one in spaces], dtype=np.int64),
            np.array([one.count for one in spaces], dtype=np.int64),
            np.array([one.closed for one in spaces], dtype=np.bool_),
            np.array([len(one.knots) for one in spaces], dtype=np.int64),
            np.concatenate([one.knots for one in spaces]),
            contour.control,
            contour.modal,
            contour.weights,
        )

    def made(self) -> NeutralContour:
        """The contour of the arrays."""
        parts = np.split(self.knots, np.cumsum(self.knot_counts)[:-1])
        rows = zip(self.degrees, parts, self.counts, self.closed, strict=True)
        spaces = [SplineSpace(int(degree), knots, int(n), bool(closed)) for degree, knots, n, closed in rows]
        return NeutralContour(tuple(spaces), self.control, self.modal, self.weights)


def kept_contour(
    points: NDArray[np.float64],
    *,
    degrees: tuple[int, ...],
    closed: tuple[bool, ...],
    parametrisation: Parametrisation,
    mode_shapes: NDArray[np.float64] | None,
    source: str,
) -> NeutralContour:
    """A curve through points of shape (k, 3) or a surface through points of shape (a, b, 3).

    Parameters
    ----------
    degrees, closed
        Of its directions.
    points, parametrisation, mode_shapes, source
        As of `neutral_curve` and `neutral_surface`.

    Raises
    ------
    InputError
        As these.
    """
    return derived(
        ContourArrays, _through_points, points, degrees, closed, parametrisation, mode_shapes, source
    ).made()


def _through_points(
    points: NDArray[np.float64],
    degrees: tuple[int, ...],
    closed: tuple[bool, ...],
    parametrisation: Parametrisation,
    mode_shapes: NDArray[np.float64] | None,
    source: str,
) -> ContourArrays:
    if len(degrees) == 1:
        found = neutral_curve(
            points,
            degree=degrees[0],
            closed=closed[0],
            parametrisation=parametrisation,
            mode_shapes=mode_shapes,
            source=source,
        )
    else:
        found = neutral_surface(
            points,
            degrees=(degrees[0], degrees[1]),
            closed=(closed[0], closed[1]),
            parametrisation=parametrisation,
            mode_shapes=mode_shapes,
            source=source,
        )
    return ContourArrays.of(found)


class _Sound(NamedTuple):
    """A contour that has passed its checks."""

    points: int


def kept_check(
    contour: NeutralContour, *, flip: bool, nodes: NDArray[np.float64] | None, source: str
) -> None:
    """Checks of a contour, as `check_contour`: what has passed them passes again.

    Raises
    ------
    InputError
        The first check that fails.
    """
    derived(_Sound, _checked, contour, flip, nodes, source)


def _checked(
    contour: NeutralContour,
    flip: bool,
    nodes: NDArray[np.float64] | None,
    source: str,
) -> _Sound:
    check_contour(contour, flip=flip, nodes=nodes, source=source)
    return _Sound(len(contour.control))
