"""Angles of bodies to the vertical."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
from heavylift.pipeline.case.criteria.places import check_axes
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import BodyName, Direction, Quantity


class TiltCriterion(CriterionSection):
    """Angle of an axis of a body to the vertical."""

    ORDER: ClassVar = 8

    type: Literal["tilt"]
    body: BodyName
    """Rigid or flexible body."""
    axis: Direction = (0.0, 0.0, 1.0)
    """Axis that is upright when the body is level, in the coordinates of its geometry."""
    maximum: Annotated[float, Quantity("angle", minimum=0.0, maximum=3.141592653589793)]
    """Largest angle."""

    def check_case(self, case: Any, key: str) -> None:
        """The body needs axes."""
        super().check_case(case, key)
        check_axes(case, self.body, f"{key}.body")

    def judge(self, run: Run) -> list[CriterionResult]:
        """Largest angle."""
        axis = np.array(self.axis, dtype=np.float64)
        axes = run.turned(self.body, axis / np.linalg.norm(axis))
        angle = np.arctan2(np.linalg.norm(np.cross(axes, run.up), axis=1), axes @ run.up)
        clause = OF_THE_CASE
        return [
            run.result(
                "angle to the vertical",
                "rad",
                [Series(self.body, angle, self.maximum)],
                (clause,),
                seen=run.records,
            )
        ]
