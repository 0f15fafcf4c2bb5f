"""Von Mises stress of a flexible body against the yield strength, by plate group."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE, Clause
from heavylift.pipeline.case.criteria.results import ON_LIMIT, CriterionResult, Factor, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import BodyName, Quantity, refuse_unknown, reject
from heavylift.pipeline.case.steel import STEEL_SOURCE
from heavylift.pipeline.case.stress import PropertyName


class YieldCriterion(CriterionSection):
    """Von Mises stress over the yield strength, of groups of a flexible body with a table ``stress``."""

    ORDER: ClassVar = 10.5

    type: Literal["yield"]
    body: BodyName
    """Flexible body with a table ``stress``."""
    groups: tuple[PropertyName, ...] = ()
    """Groups of that table, or properties of a structure; all that have a yield strength if empty."""
    stress: Literal["whole", "centre"] = "whole"
    """``whole``: both sides of plates, solids and corners of beams; ``centre``: the membrane of plates at the centres
    of their elements, as for the strength of the whole block."""
    maximum: Annotated[float, Quantity("number", minimum=0.0)] = 1.0
    """Largest utilisation, the partial factor of the table included."""

    def check_case(self, case: Any, key: str) -> None:
        """The body needs its table, and strengths in it."""
        super().check_case(case, key)
        table = getattr(case.bodies[self.body], "stress", None)
        if table is None:
            reject(f"{self.body!r} has no table 'stress'", "a flexible body with one", key=f"{key}.body")
        named = [one.name for one in table.groups]
        if named:
            for index, group in enumerate(self.groups):
                refuse_unknown("group", group, named, key=f"{key}.groups.{index}")
        if not table.has_strength:
            weak = [one.name for one in table.groups if not one.has_strength]
            asked = self.groups or named or ("",)
            missing = [one for one in asked if one in weak or not named]
            if missing and (self.groups or len(weak) == len(named)):
                what = f"group {missing[0]!r}" if missing[0] else "it"
                reject(
                    f"{what} has no yield strength",
                    "'grade' or 'yield_strength' in the table 'stress'",
                    key=f"{key}.body",
                )

    def judge(self, run: Run) -> list[CriterionResult]:
        """The group that is used most."""
        stress = run.stress(self.body)
        side = "" if self.stress == "whole" else self.stress
        strong = [
            group.name
            for group in stress.groups.values()
            if group.strength.size and (group.total.any() if not side else side in group.sides)
        ]
        chosen = self.groups or tuple(strong)
        unknown = [name for name in chosen if name not in strong]
        if unknown or not chosen:
            what = f"group {unknown[0]!r}" if unknown else f"body {self.body!r}"
            raise run.error(
                f"{what} has no {self.stress} stress with a yield strength",
                f"groups of it: {', '.join(strong) or 'there are none'}",
            )
        prefix = f"stress.{self.body}"
        series = [
            Series(
                name, run.history(".".join(filter(None, (prefix, name, side, "utilisation")))), self.maximum
            )
            for name in chosen
        ]
        table = run.case.bodies[self.body].stress
        factors = (Factor("gamma_M", table.gamma_M, ON_LIMIT),) if table.gamma_M != 1.0 else ()
        what = "von Mises stress over the yield strength" + (" (centres of plates)" if side else "")
        found = run.result(what, "1", series, (OF_THE_CASE,), factors=factors, seen=run.records)
        group = stress.group(found.where)
        owner = next((one for one in table.groups if one.name == group.name and one.has_strength), table)
        clause = OF_THE_CASE if owner.grade is None else Clause(STEEL_SOURCE, "seen")
        record = int(np.argmin(np.abs(stress.times - (found.time or 0.0))))
        place = group.place_at(record, side, used=True)
        words = ", ".join(f"{value:.4g}" for value in np.round(place, 6) + 0.0)
        return [replace(found, where=f"{found.where} at ({words}) m", clauses=run.clauses(clause))]
