"""Differences between the tensions of ropes that are to share a load."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, Literal

import numpy as np

from heavylift.pipeline.case.criteria.annotations import Ropes
from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Quantity, reject
from heavylift.pipeline.case.rope_parts import tensions_of


class SpreadCriterion(CriterionSection):
    """Largest difference between the tensions of ropes relative to their mean, while they carry."""

    type: Literal["spread"]
    ropes: Ropes
    """Two ropes or more, by names or patterns. Of equalizers without masses of pulleys each line is judged."""
    maximum: Annotated[float, Quantity("number", minimum=0.0)]
    """Largest difference that passes, in parts of the mean."""

    def check_case(self, case: Any, key: str) -> None:
        """One tension has no difference."""
        super().check_case(case, key)
        if len(tensions_of(case, self.ropes)) < 2:
            reject(f"{self.ropes[0]!r} alone", "two ropes or more", key=f"{key}.ropes")

    def judge(self, run: Run) -> list[CriterionResult]:
        """Difference of the largest and the smallest tension of each record over the mean of all."""
        names = run.tensions(self.ropes)
        ropes = list(names)
        tensions = np.array([run.history(name) for name in names.values()])
        mean = tensions.mean(axis=0)
        carry = mean > 0.0
        # a record without load has no spread; a run without any fails
        spread = np.full(len(run.times), -np.inf if carry.any() else np.nan)
        np.divide(np.ptp(tensions, axis=0), mean, out=spread, where=carry)
        largest, smallest = tensions.argmax(axis=0), tensions.argmin(axis=0)

        def between(record: int) -> str:
            return f"{ropes[largest[record]]} over {ropes[smallest[record]]}" if carry.any() else ""

        return [
            run.result(
                "difference of tensions over their mean",
                "1",
                [Series("", spread, self.maximum)],
                (OF_THE_CASE,),
                seen=run.records,
                note="" if carry.any() else "the ropes never carry",
                at=between,
            )
        ]
