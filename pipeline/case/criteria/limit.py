"""Any quantity of checks within a limit."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationInfo, WithJsonSchema, field_validator, model_validator

from heavylift.pipeline.case.checks import quantity_in_unit
from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import QuantityString, quantity_schema, reject

_Limit = Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]


class LimitCriterion(CriterionSection):
    """Any quantity of checks within limits."""

    ORDER: ClassVar = 11
    NEEDS_SIMULATION: ClassVar = False

    type: Literal["limit"]
    quantity: QuantityString
    """As in checks, patterns included: ``"channel.barge.angular_velocity.x.rms"``; the worst of a group counts."""
    maximum: _Limit | None = None
    """Largest value that passes, in the unit of the quantity."""
    minimum: _Limit | None = None
    """Smallest value that passes, in place of `maximum`."""

    @field_validator("maximum", "minimum", mode="before")
    @classmethod
    def _has_the_unit(cls, value: Any, info: ValidationInfo) -> Any:
        return None if value is None else quantity_in_unit(info, value)

    @model_validator(mode="after")
    def _has_one_limit(self) -> "LimitCriterion":
        if (self.maximum is None) == (self.minimum is None):
            which = "both" if self.maximum is not None else "neither"
            other = "and" if self.maximum is not None else "nor"
            reject(f"{which} 'maximum' {other} 'minimum'", "one of them: a criterion each")
        over_time = self.quantity.partition(".")[0] in {"channel", "stress"}
        given = [key for key in ("after", "until", "phases") if getattr(self, key) not in {None, ()}]
        if given and not over_time:
            key = given[0]
            reject(
                f"{key!r} with {self.quantity!r}, which is not over time", "a channel or a stress", key=key
            )
        return self

    def quantities(self) -> dict[str, str]:
        """The one that is judged."""
        return {"quantity": self.quantity}

    @property
    def channel_text(self) -> str:
        """Its channel, if it is of one."""
        return self.quantity

    def judge(self, run: Run) -> list[CriterionResult]:
        """The worst of all members of a group."""
        quantity = run.case.quantity(self.quantity)
        side, limit = ("<=", self.maximum) if self.maximum is not None else (">=", self.minimum)
        assert limit is not None
        members = quantity.members or (("", self.quantity),)
        family = run.case.quantity(members[0][1]).family
        statistic = self.quantity.rpartition(".")[2] if family in {"channel", "stress"} else ""
        clause = OF_THE_CASE
        series, times, notes = [], np.empty(0), list[str]()
        for where, text in members:
            name = text.removesuffix(f".{statistic}")
            if statistic in {"max", "min", "absolute"}:
                values, times = run.history(name, statistic), run.times
            elif statistic:
                values = np.array([run.statistic(statistic, run.history(name))])
            else:
                values = np.array([run.number(text)])
            if statistic in {"max", "min", "absolute"} and (statistic != "min") != (side == "<="):
                # the largest value of all must exceed a limit, not every value
                extreme = values.argmin() if statistic == "min" else values.argmax()
                values, times = values[[extreme]], np.empty(0)
            series.append(Series(where, values, limit))
            if statistic == ("max" if side == "<=" else "min"):
                notes.append(_beyond(run.history(name, "min" if side == "<=" else "max"), side, limit, where))
        seen = (
            run.seen([text.removesuffix(f".{statistic}") for _, text in members], statistic)
            if len(times)
            else ""
        )
        note = next(filter(None, notes), "")
        unit = quantity.kind.unit
        return [
            run.result(self.quantity, unit, series, (clause,), side=side, seen=seen, times=times, note=note)
        ]


def _beyond(values: NDArray[np.float64], side: str, limit: float, where: str) -> str:
    """That values within a limit are beyond the same amount on the other side of zero; empty if they are not."""
    sign = 1.0 if side == "<=" else -1.0
    worst = float(values.min() if side == "<=" else values.max())
    if sign * limit <= 0.0 or sign * worst >= -abs(limit):
        return ""
    whose = f"{where}: " if where else ""
    what = "smallest" if side == "<=" else "largest"
    return f"{whose}the {what} is {worst:.6g}, beyond the same amount; 'absolute' judges both sides"
