"""Ropes that must not go slack."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from dataclasses import replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import Moment, Ropes
from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import Clause
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Quantity


class SlackCriterion(CriterionSection):
    """Smallest tension of ropes; with `static_at` also how much of the tension at rest the dynamics take away."""

    ORDER: ClassVar = 9

    type: Literal["slack"]
    ropes: Ropes
    """Ropes, by names or patterns."""
    minimum: Annotated[float, Quantity("force", minimum=0.0, closed=True)] = 0.0
    """Tension that all must exceed [N]."""
    static_at: Moment | None = None
    """When the tension is the one at rest."""
    dynamic_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.9
    """Largest part of the tension at rest that the dynamics may take away."""

    def judge(self, run: Run) -> list[CriterionResult]:
        """Smallest tension, and what dynamics take away."""
        channels = run.tensions(self.ropes, least=True)
        tensions = {rope: run.history(name, "min") for rope, name in channels.items()}
        seen = run.seen(list(channels.values()), "min")
        result = run.result(
            "smallest tension",
            "N",
            [Series(rope, values, self.minimum) for rope, values in tensions.items()],
            (run.default("minimum", Clause("no slack", "assumption")),),
            side=">",
            seen=seen,
        )
        if not result.passed and len(run.times) > 1:
            slack = tensions[result.where] <= self.minimum
            duration = float(np.sum(run.steps[slack[1:]]))
            result = replace(result, note=f"for {duration:.4g} s by records")
        rows = [result]
        if self.static_at is not None:
            series = []
            for rope, values in tensions.items():
                static = run.tension_at_rest(rope, channels[rope])
                series.append(Series(rope, 1.0 - values / static, self.dynamic_share))
            clause = run.default("dynamic_share", rules.clause("slack slings"))
            what = "part of the tension at rest that dynamics take away"
            rows.append(run.result(what, "1", series, (clause,), seen=seen))
        return rows
