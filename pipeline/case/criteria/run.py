"""What a criterion sees of a run: its records within the time that counts, and lines of the table made of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE, Clause
from heavylift.pipeline.case.criteria.results import CriterionResult, Series, utilisation
from heavylift.pipeline.case.rope_parts import tensions_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case.criteria.annotations import Rating
    from heavylift.pipeline.case.criteria.results import Factor

__all__ = ["Run"]


class Run(ABC):
    """Records of a run within the time of a criterion.

    Attributes
    ----------
    case, criterion
        The case, and the criterion that is judged.
    times
        Of its records [s], shape (nt,).
    entered
        Records whose neighbour before does not belong to the criterion, shape (nt,).
    """

    case: Any
    criterion: Any
    times: NDArray[np.float64]
    entered: NDArray[np.bool_]

    @property
    @abstractmethod
    def metadata(self) -> Mapping[str, Any]:
        """Summary of the run by itself."""

    @abstractmethod
    def history(self, name: str, side: str = "end") -> NDArray[np.float64]:
        """Records of a channel or stress, ``"channel.fall.tension"``, shape (nt,).

        With a side ``"max"``, ``"min"`` or ``"absolute"`` their extremes since the record before.
        """

    @abstractmethod
    def stress(self, body: str) -> Any:
        """Stress of a flexible body with a table ``stress``, over the whole run."""

    @abstractmethod
    def at_rest(self, name: str) -> float:
        """Value of a channel at the time at which the criterion takes it to be at rest."""

    @abstractmethod
    def number(self, text: str) -> float:
        """Value of a quantity of checks, whatever the time of the criterion."""

    @abstractmethod
    def statistic(self, word: str, values: NDArray[np.float64]) -> Any:
        """A statistic of checks, ``"rms"``, of a history."""

    @abstractmethod
    def seen(self, names: Sequence[str], side: str) -> str:
        """Of how many steps or records extremes are; records if they differ."""

    @abstractmethod
    def turned(self, body: str, vector: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """A vector in the axes of a body in those of the world, shape (nt, 3)."""

    @abstractmethod
    def place(self, body: str, point: Sequence[float]) -> NDArray[np.float64]:
        """Where a point of a body is in the world [m], shape (nt, 3)."""

    @abstractmethod
    def parts(self, name: str) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
        """Beginnings and ends of the straight parts of a rope in the world [m], each of shape (nt, 3)."""

    @abstractmethod
    def phase(self, time: float | None) -> str:
        """Phase of the operation at a time; empty if the run does not know."""

    @abstractmethod
    def over_time(self, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times of all records [s], and values within the time of the criterion, elsewhere no numbers."""

    def tensions(self, ropes: Sequence[str], *, least: bool = False) -> dict[str, str]:
        """What ropes carry: by what is judged of them, the quantity without its statistic."""
        return {
            label: f"channel.{name}" for label, name in tensions_of(self.case, ropes, least=least).items()
        }

    @property
    def steps(self) -> NDArray[np.float64]:
        """Time from each record to the next one, where both belong to the criterion [s], shape (nt - 1,)."""
        return np.where(self.entered[1:], 0.0, np.diff(self.times))

    @property
    def records(self) -> str:
        """Number of records in words."""
        return f"{len(self.times):,} records"

    @cached_property
    def gravity(self) -> NDArray[np.float64]:
        """Acceleration, shape (3,) [m/s^2]; zeros without."""
        given = self.case.gravity
        return np.zeros(3) if given is None else np.array(given.acceleration, dtype=np.float64)

    @property
    def g(self) -> float:
        """Amount of gravity [m/s^2]."""
        return float(np.linalg.norm(self.gravity))

    @property
    def up(self) -> NDArray[np.float64]:
        """Unit vector against gravity; z without."""
        return -self.gravity / self.g if self.g > 0.0 else np.array([0.0, 0.0, 1.0])

    def newtons(self, rating: Rating) -> float:
        """Force of a rating [N]."""
        return rating.value * self.g if rating.is_mass else rating.value

    def error(self, problem: str, expected: str) -> InputError:
        """Why the criterion cannot be judged, to be raised."""
        return InputError(
            f"criterion {self.criterion.name!r}: {problem}", source=self.case.file, expected=expected
        )

    def tension_at_rest(self, rope: str, name: str) -> float:
        """Tension of a rope at rest [N].

        Raises
        ------
        InputError
            If it has none.
        """
        static = self.at_rest(name)
        if not static > 0.0:
            raise self.error(f"{rope!r} has no tension at rest", "'static_at' when it carries")
        return static

    def clauses(self, *found: Clause) -> tuple[Clause, ...]:
        """The source that the criterion gives, or those of its kind."""
        given = self.criterion.source
        return (Clause(given, "case file"),) if given else found

    def default(self, key: str, found: Clause) -> Clause:
        """The clause that the default value of a key comes from; the case file where that gives another one."""
        return OF_THE_CASE if key in self.criterion.model_fields_set else found

    def result(
        self,
        what: str,
        unit: str,
        series: Sequence[Series],
        clauses: tuple[Clause, ...],
        *,
        side: str = "<=",
        factors: tuple[Factor, ...] = (),
        seen: str = "",
        note: str = "",
        times: NDArray[np.float64] | None = None,
        at: Callable[[int], str] | None = None,
    ) -> CriterionResult:
        """The worst value of some histories as a line; `times` are empty of forces at rest, `at` says more of a record.

        Notes
        -----
        The worst is the one of least margin relative to its limit; a value that is no number is worse than any.
        """
        moments = self.times if times is None else times
        scores = []
        for one in series:
            limits = np.broadcast_to(np.asarray(one.limits, dtype=np.float64), one.values.shape)
            room = limits - one.values if side == "<=" else one.values - limits
            scale = np.where(np.abs(limits) > 0.0, np.abs(limits), 1.0)
            scores.append(np.where(np.isnan(room), -np.inf, room / scale))
        lowest = [float(score.min()) for score in scores]
        number = int(np.argmin(lowest))
        worst, record = series[number], int(np.argmin(scores[number]))
        limits = np.broadcast_to(np.asarray(worst.limits, dtype=np.float64), worst.values.shape)
        time = float(moments[record]) if len(moments) else None
        used = utilisation(worst.values, limits, side)
        return CriterionResult(
            name=self.criterion.name,
            type=self.criterion.type,
            what=what,
            value=float(worst.values[record]),
            limit=float(limits[record]),
            unit=unit,
            side=side,
            clauses=self.clauses(*clauses),
            factors=factors,
            where=" ".join(filter(None, (worst.where, at(record) if at else ""))),
            time=time,
            phase=self.phase(time),
            seen=seen,
            note=note,
            history=self.over_time(used) if len(moments) > 1 and np.isfinite(used).any() else None,
        )
