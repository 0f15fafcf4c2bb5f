"""Shackles by their working load limit, breaking load and proof load."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from dataclasses import replace
from typing import ClassVar, Literal

from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import Rated, Ropes
from heavylift.pipeline.case.criteria.base import RiggedCriterion
from heavylift.pipeline.case.criteria.results import ON_LIMIT, CriterionResult, Factor, Series
from heavylift.pipeline.case.criteria.run import Run


class ShackleCriterion(RiggedCriterion):
    """Force of shackles over the least of what their three ratings allow.

    The working load limit is one for forces at rest: with `static_at` alone it is multiplied by the amplification of
    the run, without it the largest force counts against the limit as it is.
    """

    ORDER: ClassVar = 4
    STATIC_ALONE: ClassVar = True

    type: Literal["shackle"]
    ropes: Ropes
    """Ropes at whose ends the shackles are, by names or patterns."""
    working_load_limit: Rated
    """WLL of one shackle: force or mass."""
    breaking_load: Rated | None = None
    """Minimum breaking load."""
    proof_load: Rated | None = None
    """Load of its proof test."""

    def judge(self, run: Run) -> list[CriterionResult]:
        """Largest force over the least rating."""
        channels = run.tensions(self.ropes)
        forces = self.forces(run, channels)
        wll, factors, note = run.newtons(self.working_load_limit), list(forces.factors), ""
        series = []
        amplifications = dict.fromkeys(forces.values, self.dynamic_factor or 1.0)
        if self.dynamic_factor is None and self.static_at is not None:
            for rope in forces.values:
                static = run.tension_at_rest(rope, channels[rope])
                largest = float(run.history(channels[rope], "max").max())
                amplifications[rope] = max(1.0, largest / static)
        for rope, values in forces.values.items():
            ratings = {"WLL": wll * amplifications[rope]}
            ratings |= (
                {} if self.breaking_load is None else {"MBL / 3": run.newtons(self.breaking_load) / 3.0}
            )
            ratings |= {} if self.proof_load is None else {"proof load": run.newtons(self.proof_load)}
            least = min(ratings, key=lambda name: ratings[name])
            series.append(Series(f"{rope} ({least})", values, ratings[least]))
        if self.dynamic_factor is None and self.static_at is None:
            note = (
                "the working load limit, one for forces at rest, is compared with the largest force as it is"
            )
        result = run.result(
            "force over the least of WLL, MBL / 3, proof load",
            "N",
            series,
            (rules.clause("shackle"),),
            factors=tuple(factors),
            seen=forces.seen,
            times=forces.times,
            note=note,
        )
        amplification = amplifications[result.where.partition(" (")[0]]
        if amplification != 1.0:
            result = replace(
                result, factors=(*result.factors, Factor("DAF on the WLL", amplification, ON_LIMIT))
            )
        return [result]
