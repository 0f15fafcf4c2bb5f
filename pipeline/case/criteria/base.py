"""What criteria have in common: keys that all have, those of criteria of forces, and what each answers for itself."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from abc import abstractmethod
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from heavylift.pipeline.case.criteria.annotations import FactorValue, Moment, Rating, Time
from heavylift.pipeline.case.criteria.results import (
    GIVEN,
    IN_RUN,
    CriterionResult,
    CurveFigure,
    Factor,
    Forces,
)
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Name, Section, refuse_unknown, reject

__all__ = ["CriterionSection", "LoadedCriterion", "RiggedCriterion", "phase_names"]


class CriterionSection(Section):
    """What all criteria have."""

    ORDER: ClassVar[float] = math.inf
    """Place of a kind among the others in schema and messages; kinds without one follow by their words."""
    NEEDS_SIMULATION: ClassVar[bool] = True
    """Whether a case without ``[simulate]`` cannot have it."""

    name: Name
    """Unique in the case."""
    after: Time | None = None
    """Only from this time of the run on [s]; from its start if absent."""
    until: Time | None = None
    """Only up to this time [s]; to the end if absent."""
    phases: tuple[str, ...] = ()
    """Only in these phases of the operation, by name; in all if absent."""
    source: Annotated[str, Field(pattern=r"\S")] | None = None
    """Where the limit comes from; if absent the clause that the kind of criterion has, with its status."""

    @model_validator(mode="after")
    def _has_a_span(self) -> "CriterionSection":
        if self.until is not None and self.until <= (self.after or 0.0):
            reject(f"{self.until:g} s is not later than 'after'", "a later time", key="until")
        return self

    @abstractmethod
    def judge(self, run: Run) -> list[CriterionResult]:
        """Lines of the table, from the records of a run.

        Raises
        ------
        InputError
            If they do not have what it needs.
        """

    def figures(self, run: Run, lines: Sequence[CriterionResult]) -> list[CurveFigure]:  # noqa: ARG002
        """Figures of a report beside the utilisation over time, which all have; `lines` are its own."""
        return []

    def check_case(self, case: Any, key: str) -> None:
        """What it names must be in the case, and what it needs be recorded.

        Parameters
        ----------
        case
            The case.
        key
            Of the criterion: ``"criteria.0"``.

        Raises
        ------
        PydanticCustomError
            By `reject`, with the key.
        """
        if self.NEEDS_SIMULATION and case.simulate is None:
            reject("needs a [simulate] section", "a case that is simulated", key=key)
        self._check_times(case, key)
        for number, phase in enumerate(self.phases):
            refuse_unknown("phase", phase, phase_names(case), key=f"{key}.phases.{number}")
        for name, rating in self.ratings().items():
            if rating.is_mass and (case.gravity is None or not any(case.gravity.acceleration)):
                reject("a mass without gravity", "a force, or [gravity]", key=f"{key}.{name}")

    def _check_times(self, case: Any, key: str) -> None:
        if case.simulate is None:
            return
        duration = case.simulate.duration
        for name in ("after", "until", "static_at"):
            value = getattr(self, name, None)
            if isinstance(value, float) and value > duration:
                expected = f"a time within the run, up to {duration:.9g} s"
                reject(f"{value:g} s", expected, key=f"{key}.{name}")

    def ratings(self) -> dict[str, Rating]:
        """Forces and masses that it gives, by their keys."""
        found = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in found.items() if isinstance(value, Rating)}

    def quantities(self) -> dict[str, str]:
        """Quantities of checks that it names, by their keys."""
        return {}

    @property
    def channel_text(self) -> str:
        """Channel, or combination of channels, that is judged as it is; empty if there is none."""
        return ""


class LoadedCriterion(CriterionSection):
    """What criteria of forces have: which dynamics are inside."""

    dynamic_factor: FactorValue | None = None
    """Dynamic amplification factor on the force at rest, at the time `static_at`; if absent the largest force of the
    run counts, in which the dynamics are, and no factor."""
    static_at: Moment | None = None
    """When the force is the one at rest: ``start``, ``end``, ``mean`` (over the time that counts), or a time [s]."""

    STATIC_ALONE: ClassVar[bool] = False
    """Whether the force at rest has a meaning beside that of the run."""

    @model_validator(mode="after")
    def _one_of_both(self) -> "LoadedCriterion":
        if self.dynamic_factor is not None and self.static_at is None:
            reject(
                "is missing: 'dynamic_factor' multiplies the force at rest, never the largest one of the run",
                "'start', 'end', 'mean' or a time",
                key="static_at",
            )
        if self.dynamic_factor is None and self.static_at is not None and not self.STATIC_ALONE:
            reject(
                "'static_at' without 'dynamic_factor'",
                "both, or neither: the run has its dynamics",
                key="static_at",
            )
        return self

    def own_factors(self) -> tuple[Factor, ...]:
        """Factors on the force besides that of its dynamics."""
        return ()

    def forces(
        self,
        run: Run,
        channels: dict[str, str],
        scale: float = 1.0,
        more: float = 0.0,
        amounts: dict[str, NDArray[np.float64]] | None = None,
    ) -> Forces:
        """Forces of channels, by where: the largest ones of the run, or those at rest with a factor.

        Parameters
        ----------
        run
            The run.
        channels
            Channels by where: ``{"fall": "channel.fall.tension"}``.
        scale
            Number of parts of a fall.
        more
            What is added at rest [N].
        amounts
            The largest ones of the run where forces have a sign that does not count, shape (nt,).
        """
        own = self.own_factors()
        product = math.prod(factor.value or 1.0 for factor in own)
        if self.dynamic_factor is None:
            largest = amounts or {where: run.history(name, "max") for where, name in channels.items()}
            values = {where: product * (scale * found + more) for where, found in largest.items()}
            daf = Factor("DAF", None, IN_RUN)
            return Forces(values, run.times, (daf, *own), run.seen(list(channels.values()), "max"))
        factor = self.dynamic_factor
        resting = {where: run.at_rest(name) for where, name in channels.items()}
        values = {
            where: np.array([product * factor * (scale * (abs(rest) if amounts else rest) + more)])
            for where, rest in resting.items()
        }
        return Forces(values, np.empty(0), (Factor("DAF", factor, GIVEN), *own), "")


class RiggedCriterion(LoadedCriterion):
    """What criteria of slings, shackles and lugs have."""

    skew_factor: FactorValue = 1.0
    """Skew load factor on the force; 1 where the run has the real lengths, or three points carry."""
    yaw_factor: FactorValue = 1.0
    """Factor for yaw of lifts on two hooks, where the run does not have it."""

    def own_factors(self) -> tuple[Factor, ...]:
        """Skew and yaw, unless they are 1."""
        given = (("skew", self.skew_factor), ("yaw", self.yaw_factor))
        return tuple(Factor(word, value, GIVEN) for word, value in given if value != 1.0)


def phase_names(case: Any) -> list[str]:
    """Names of the phases of the operation in their order, as in the case file; empty if it has none."""
    scenario = case.document.get("scenario")
    phases = scenario.get("phases") if isinstance(scenario, dict) else None
    entries = phases if isinstance(phases, list) else []
    return [str(one.get("name", number)) for number, one in enumerate(entries, 1) if isinstance(one, dict)]
