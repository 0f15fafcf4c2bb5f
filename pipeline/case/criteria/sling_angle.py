"""Angles of slings to the horizontal."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from heavylift.pipeline.case.criteria.annotations import Angle, Ropes
from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import Clause
from heavylift.pipeline.case.criteria.places import check_path
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import reject


class SlingAngleCriterion(CriterionSection):
    """Smallest angle of ropes to the horizontal while they carry."""

    ORDER: ClassVar = 3

    type: Literal["sling_angle"]
    ropes: Ropes
    """Ropes, by names or patterns."""
    minimum: Angle = 0.5235987755982988
    """Smallest angle that passes; 30 deg by default."""
    warning: Angle = 0.7853981633974483
    """Angle below which there is a warning; 45 deg by default."""

    @model_validator(mode="after")
    def _warns_before(self) -> "SlingAngleCriterion":
        if self.warning < self.minimum:
            reject("is below 'minimum'", "the larger angle", key="warning")
        return self

    def check_case(self, case: Any, key: str) -> None:
        """Ropes need a path."""
        super().check_case(case, key)
        for number, name in enumerate(self.ropes):
            check_path(case, name, f"{key}.ropes.{number}")

    def judge(self, run: Run) -> list[CriterionResult]:
        """Smallest angle while they carry."""
        channels = run.tensions(self.ropes)
        found: dict[str, Any] = {}
        for rope in self.ropes:
            angles = []
            for begin, end in zip(*run.parts(rope), strict=True):
                d = end - begin
                rise = np.abs(d @ run.up)
                angles.append(np.arctan2(rise, np.linalg.norm(d - np.outer(d @ run.up, run.up), axis=1)))
            own = list(run.tensions([rope]))
            of_each = angles if len(own) > 1 else [np.min(angles, axis=0)]
            found |= dict(zip(own, of_each, strict=True))
        series, never = [], []
        for rope, values in found.items():
            carries = run.history(channels[rope]) > 0.0
            if carries.any():
                series.append(Series(rope, np.where(carries, values, math.inf), self.minimum))
            else:
                never.append(rope)
        result = run.result(
            "smallest angle to the horizontal",
            "rad",
            series or [Series("", np.full(len(run.times), np.nan), self.minimum)],
            (run.default("minimum", Clause("30 deg, warning below 45 deg", "assumption")),),
            side=">=",
            seen=run.records,
            note=f"never carries: {', '.join(never)}" if never else "",
        )
        if not math.isfinite(result.value):
            result = replace(result, history=None)
        if result.passed and result.value < self.warning:
            words = f"below {math.degrees(self.warning):.4g} deg"
            result = replace(result, warns=True, note="; ".join(filter(None, (words, result.note))))
        return [result]
