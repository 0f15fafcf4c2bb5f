"""What criteria find: lines of their table, histories and forces that are judged, figures of a report."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.case.criteria.lift_rules import Clause

__all__ = [
    "GIVEN",
    "IN_RUN",
    "ON_LIMIT",
    "CriterionResult",
    "CurveFigure",
    "Factor",
    "Forces",
    "Series",
    "utilisation",
]

IN_RUN, GIVEN, ON_LIMIT = "in the run", "on the value", "on the limit"
"""Where factors are."""


class Factor(NamedTuple):
    """A factor of a criterion.

    Attributes
    ----------
    name
        E.g. ``"DAF"``.
    value
        None of what the run has and no number says.
    where
        ``"in the run"``: the value has it by simulation; ``"on the value"`` or ``"on the limit"``: multiplied there;
        ``"table, not applied"``: for comparison.
    """

    name: str
    value: float | None
    where: str

    @property
    def text(self) -> str:
        """In words."""
        number = "" if self.value is None else f" {self.value:.4g}"
        return f"{self.name}{number} {self.where}"


@dataclass(frozen=True, eq=False)
class CriterionResult:
    """One line of the table of criteria.

    Attributes
    ----------
    name, type
        From the case.
    what
        What the value is, in words.
    value, limit, unit
        SI.
    side
        ``"<="``, ``">="`` or ``">"``: how the value must stand to its limit.
    clauses
        Where the limit and the factors come from.
    factors
        Factors, and where each is.
    where
        Rope, lug or channel that governs, and at what radius.
    time
        When [s]; None of forces at rest, and of numbers over all times.
    phase
        Of the operation then; empty if the run has none.
    seen
        Of what the extreme is: ``"12,000 steps"``, ``"401 records"``.
    note
        What else is to be known; a warning if `warns`.
    warns
        Whether it passes with a warning.
    history
        Times [s] and utilisations over the run, of the one that governs; None if there are none.
    """

    name: str
    type: str
    what: str
    value: float
    limit: float
    unit: str
    side: str = "<="
    clauses: tuple[Clause, ...] = ()
    factors: tuple[Factor, ...] = ()
    where: str = ""
    time: float | None = None
    phase: str = ""
    seen: str = ""
    note: str = ""
    warns: bool = False
    history: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    @property
    def passed(self) -> bool:
        """Whether the value stands to its limit as it must; a value that is no number does not."""
        if self.side == "<=":
            return self.value <= self.limit
        return self.value >= self.limit if self.side == ">=" else self.value > self.limit

    @property
    def margin(self) -> float:
        """How far the value is within its limit, in `unit`; negative beyond it."""
        return self.limit - self.value if self.side == "<=" else self.value - self.limit

    @property
    def utilisation(self) -> float | None:
        """Value over limit, of a least value limit over value; None where that gives no information: limits of zero."""
        used = float(utilisation(np.array(self.value), self.limit, self.side))
        return used if math.isfinite(used) else None

    @property
    def source(self) -> str:
        """Clauses in words, those that nobody has confirmed marked."""
        return "; ".join(dict.fromkeys(one.text for one in self.clauses))

    def row(self) -> dict[str, Any]:
        """The line as plain values, as in ``criteria.json``; what is no number is None."""
        values = {key: getattr(self, key) for key in ("value", "limit", "utilisation", "margin", "time")}
        finite = {
            key: float(value) if value is not None and math.isfinite(value) else None
            for key, value in values.items()
        }
        return {
            "name": self.name,
            "type": self.type,
            "what": self.what,
            "value": finite["value"],
            "side": self.side,
            "limit": finite["limit"],
            "unit": self.unit,
            "utilisation": finite["utilisation"],
            "margin": finite["margin"],
            "where": self.where,
            "time": finite["time"],
            "phase": self.phase,
            "seen": self.seen,
            "factors": [factor._asdict() for factor in self.factors],
            "sources": [one._asdict() for one in self.clauses],
            "note": self.note,
            "warning": self.warns,
            "passed": self.passed,
        }


def utilisation(values: NDArray[np.float64], limit: ArrayLike, side: str) -> NDArray[np.float64]:
    """Value over limit, or limit over value; infinite where a least value is not positive, nan without meaning."""
    limits = np.asarray(limit, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        if side == "<=":
            return np.where((limits > 0.0) & (values >= 0.0), values / limits, np.nan)
        return np.where(limits > 0.0, np.where(values > 0.0, limits / values, np.inf), np.nan)


class Series(NamedTuple):
    """A history that is judged: of what, values, and limits at all times or one for all."""

    where: str
    values: NDArray[np.float64]
    limits: NDArray[np.float64] | float


class Forces(NamedTuple):
    """Forces that are judged: by where they are, their times, none of forces at rest, and what is inside."""

    values: dict[str, NDArray[np.float64]]
    times: NDArray[np.float64]
    factors: tuple[Factor, ...]
    seen: str


@dataclass(frozen=True, eq=False)
class CurveFigure:
    """Values of a run over a place, beside a curve of limits over the same place.

    Attributes
    ----------
    name
        Of the picture, unique in the report.
    title, caption
        Heading, and a sentence without its end: the report adds what `line` uses.
    line
        The line of the table that belongs to it.
    place, value, limit
        Words of the axes and of the curve: ``"radius [m]"``, ``"load"``, ``"capacity"``.
    unit
        SI, of values and limits.
    curve
        Places and limits of the curve, in the order of places.
    values
        Places and values over the run, each of shape (nt,).
    governing
        Place and value that are nearest to the curve; None if there is none.
    """

    name: str
    title: str
    caption: str
    line: CriterionResult
    place: str
    value: str
    limit: str
    unit: str
    curve: tuple[Sequence[float], Sequence[float]]
    values: tuple[NDArray[np.float64], NDArray[np.float64]]
    governing: tuple[float, float] | None = None
