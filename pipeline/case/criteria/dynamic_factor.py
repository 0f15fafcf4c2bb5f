"""Dynamic amplification of a hook load, beside the table for lifts in air."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from heavylift.numerics.outcome import InputError
from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import FactorValue, Force, Moment, Rated
from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
from heavylift.pipeline.case.criteria.results import IN_RUN, CriterionResult, Factor, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Positive, reject


class DynamicsCriterion(CriterionSection):
    """Largest load of a hook relative to that at rest, beside the factor of the table for lifts in air."""

    ORDER: ClassVar = 6

    type: Literal["dynamic_factor"]
    load: Force
    """Channel of the load, as for ``crane``."""
    parts: Annotated[float, Positive("number")] = 1.0
    """Number of parts of a fall."""
    operation: Literal["onshore", "inshore", "offshore"]
    """Column of the table."""
    static_load: Rated | None = None
    """Load at rest: force or mass; or `static_at`."""
    static_at: Moment | None = None
    """When the load is the one at rest: ``start``, ``end``, ``mean`` or a time [s]."""
    maximum: FactorValue | None = None
    """Limit in place of that of the table."""

    @model_validator(mode="after")
    def _knows_the_load_at_rest(self) -> "DynamicsCriterion":
        if (self.static_load is None) == (self.static_at is None):
            reject(
                "both 'static_load' and 'static_at'"
                if self.static_at is not None
                else "neither 'static_load' nor 'static_at'",
                "one of them: the load at rest",
            )
        return self

    @property
    def channel_text(self) -> str:
        """The load."""
        return self.load

    def judge(self, run: Run) -> list[CriterionResult]:
        """Largest load over that at rest."""
        name = f"channel.{self.load}"
        load = self.parts * run.history(name, "max")
        static = self.parts * run.at_rest(name) if self.static_load is None else run.newtons(self.static_load)
        if not static > 0.0:
            raise run.error(
                f"{self.load!r} has no load at rest", "'static_at' when it carries, or 'static_load'"
            )
        factors: tuple[Factor, ...] = (Factor("DAF", None, IN_RUN),)
        clause = OF_THE_CASE
        limit = self.maximum
        if limit is None:
            if run.g == 0.0:
                raise run.error("no weight without gravity", "[gravity], or 'maximum'")
            try:
                limit = rules.table_factor(static / run.g, self.operation)
            except InputError as error:
                raise run.error(error.problem, error.expected) from None
            clause = rules.clause("dynamic amplification in air")
            factors = (*factors, Factor(f"DAF of the table, {self.operation},", limit, "not applied"))
        return [
            run.result(
                "largest load over load at rest",
                "1",
                [Series(self.load, load / static, limit)],
                (clause,),
                factors=factors,
                seen=run.seen([name], "max"),
                note=f"load at rest {static / 1000.0:.6g} kN",
            )
        ]
