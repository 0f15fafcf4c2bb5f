"""Distances that must be kept."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import OneChannel
from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Quantity, reject


class ClearanceCriterion(CriterionSection):
    """Smallest distance: a gap of surfaces, a relative motion, a difference of heights."""

    ORDER: ClassVar = 7

    type: Literal["clearance"]
    distance: Annotated[str, OneChannel("length", group=True)]
    """Channel, or pattern of channels: ``"landing.gap"``, ``"swing.distance"``, ``"hook.position.z"``."""
    place: Literal["to_boom", "under_load", "near_final_place", "on_barge", "sideways"] | None = None
    """What the distance is, by which the limit is chosen: 3, 3, 1.5, 5 and 3 m."""
    minimum: Annotated[float, Quantity("length")] | None = None
    """Smallest distance that passes [m], in place of that of `place`."""

    @model_validator(mode="after")
    def _has_a_limit(self) -> "ClearanceCriterion":
        if self.place is None and self.minimum is None:
            reject("neither 'place' nor 'minimum'", "one of them")
        return self

    def judge(self, run: Run) -> list[CriterionResult]:
        """Smallest distance."""
        limit, clause = self.minimum, OF_THE_CASE
        if limit is None:
            assert self.place is not None
            limit, name = rules.CLEARANCES[self.place]
            clause = rules.clause(name)
        text = f"channel.{self.distance}"
        quantity = run.case.quantity(f"{text}.min")
        channels = {
            where or self.distance: member.removesuffix(".min")
            for where, member in quantity.members or (("", f"{text}.min"),)
        }
        return [
            run.result(
                "smallest distance" + (f", {self.place.replace('_', ' ')}" if self.place else ""),
                "m",
                [Series(where, run.history(name, "min"), limit) for where, name in channels.items()],
                (clause,),
                side=">=",
                seen=run.seen(list(channels.values()), "min"),
            )
        ]
