"""Spline spaces of one parameter: degree, knots, how many control points, open or closed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.splines.limits import LARGEST_DEGREE
from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["SplineSpace", "clamped_space", "closed_space"]

PERIOD_TOLERANCE = 1e-12
"""Relative to the period: how well knots at the two ends of a closed space must repeat."""


@dataclass(frozen=True, eq=False)
class SplineSpace:
    """All splines of one degree over given knots, on the domain [0, 1].

    An open space has ``count`` functions; its knots are clamped: the first and the last ``degree + 1`` are equal. A
    closed one has ``count + degree`` functions on ``count`` control points, function i belonging to point
    ``i % count``; its knots continue periodically beyond both ends of the domain.

    Attributes
    ----------
    degree
        1 to `LARGEST_DEGREE`.
    knots
        Not decreasing, shape (count + degree + 1,) if open, (count + 2 degree + 1,) if closed.
    count
        Control points; more than the degree.
    closed
        Whether 1 is the same place as 0.
    """

    degree: int
    knots: NDArray[np.float64]
    count: int
    closed: bool

    def __post_init__(self) -> None:
        """Check the knots.

        Raises
        ------
        InputError
            Degree, count or knots that make no space.
        """
        knots = np.array(self.knots, dtype=np.float64, ndmin=1)
        knots.setflags(write=False)
        object.__setattr__(self, "knots", knots)
        degree, count = self.degree, self.count
        if not 1 <= degree <= LARGEST_DEGREE:
            raise InputError(
                f"degree {degree} of a spline", key="degree", expected=f"a degree from 1 to {LARGEST_DEGREE}"
            )
        if count <= degree:
            raise InputError(
                f"{count} control points for degree {degree}",
                key="count",
                expected=f"at least {degree + 1} points, or a lower degree",
            )
        length = count + (2 * degree if self.closed else degree) + 1
        if knots.shape != (length,):
            raise InputError(
                f"{knots.size} knots for {count} control points of degree {degree}",
                key="knots",
                expected=f"{length} knots of a{' closed' if self.closed else 'n open'} spline",
            )
        self._check_knots(knots)

    def _check_knots(self, knots: NDArray[np.float64]) -> None:
        """Order, domain, ends and multiplicity of the knots."""
        degree, count = self.degree, self.count
        if not np.all(np.isfinite(knots)) or np.any(np.diff(knots) < 0.0):
            fall = int(np.argmax(~(np.diff(knots) >= 0.0)))
            raise InputError(
                f"knot {fall + 2} ({knots[fall + 1]:g}) is below knot {fall + 1} ({knots[fall]:g})",
                key="knots",
                expected="knots that do not decrease",
            )
        first, last = knots[degree], knots[self.functions]
        if first != 0.0 or last != 1.0:
            raise InputError(
                f"the domain is {first:g} to {last:g}", key="knots", expected="a domain from 0 to 1"
            )
        if self.closed:
            jumps = np.diff(knots)
            if np.max(np.abs(jumps[count:] - jumps[: jumps.size - count])) > PERIOD_TOLERANCE:
                raise InputError(
                    "the knots beyond the ends do not repeat those inside",
                    key="knots",
                    expected="periodic knots of a closed spline",
                )
            inside, largest = knots, degree
        else:
            if knots[0] != 0.0 or knots[-1] != 1.0:
                raise InputError(
                    "the knots of an open spline are not clamped",
                    key="knots",
                    expected=f"{degree + 1} equal knots at both ends",
                )
            inside, largest = knots[degree + 1 : -degree - 1], degree
        values, multiplicity = np.unique(inside, return_counts=True)
        if np.any(multiplicity > largest):
            where = int(np.argmax(multiplicity))
            raise InputError(
                f"knot {values[where]:g} stands {multiplicity[where]} times inside a spline of degree {degree}",
                key="knots",
                expected=f"at most {largest} times, else the contour falls apart there",
            )

    @property
    def functions(self) -> int:
        """Basis functions: more than control points if closed."""
        return self.count + self.degree if self.closed else self.count

    def breaks(self) -> NDArray[np.float64]:
        """Ends of the polynomial pieces within the domain, strictly increasing from 0 to 1."""
        return np.unique(self.knots[self.degree : self.functions + 1])

    def samples(self, per_piece: int) -> NDArray[np.float64]:
        """Parameters spread evenly over every piece: both ends if open, the seam once if closed.

        Parameters
        ----------
        per_piece
            Parts into which a piece is cut.
        """
        breaks = self.breaks()
        parts = np.arange(per_piece) / per_piece
        inside = (breaks[:-1, None] + np.diff(breaks)[:, None] * parts).ravel()
        return inside if self.closed else np.append(inside, 1.0)


def clamped_space(degree: int, inner: NDArray[np.float64]) -> SplineSpace:
    """Open space with given knots between its ends.

    Parameters
    ----------
    degree
        Of the splines.
    inner
        Knots above 0 and below 1, not decreasing.
    """
    knots = np.concatenate([np.zeros(degree + 1), np.asarray(inner, dtype=np.float64), np.ones(degree + 1)])
    return SplineSpace(degree, knots, knots.size - degree - 1, closed=False)


def closed_space(degree: int, period: NDArray[np.float64]) -> SplineSpace:
    """Closed space with the given knots in one period.

    Parameters
    ----------
    degree
        Of the splines.
    period
        Knots from 0 on and below 1, the first 0, shape (count,).
    """
    inside = np.asarray(period, dtype=np.float64)
    count = inside.size
    if count <= degree:
        raise InputError(
            f"{count} control points for degree {degree}",
            key="count",
            expected=f"at least {degree + 1} points, or a lower degree",
        )
    knots = np.concatenate([inside[count - degree :] - 1.0, inside, 1.0 + inside[: degree + 1]])
    return SplineSpace(degree, knots, count, closed=True)
