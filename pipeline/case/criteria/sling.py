"""Slings and wire ropes by their breaking load and a safety factor."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, ClassVar, Literal

from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import FactorValue, Rated, Ropes
from heavylift.pipeline.case.criteria.base import RiggedCriterion
from heavylift.pipeline.case.criteria.results import ON_LIMIT, CriterionResult, Factor, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Quantity


class SlingCriterion(RiggedCriterion):
    """Force of slings and wire ropes times the safety factor over their breaking load; the worst one counts."""

    ORDER: ClassVar = 2

    type: Literal["sling"]
    ropes: Ropes
    """Ropes, by names or patterns: ``["sling_*"]``. Of equalizers without masses of pulleys each line is judged."""
    breaking_load: Rated
    """Minimum breaking load of one rope: force or mass."""
    termination_factor: FactorValue
    """Factor for the splice or socket at its ends: 1 of a socket, 1.25 where 80 % of the breaking load are left."""
    bending_ratio: Annotated[float, Quantity("number", minimum=1.0)] | None = None
    """D/d of the smallest pin or sheave that it bends about; straight if absent."""
    load_factor: FactorValue = 1.3
    """gamma_f."""
    consequence_factor: FactorValue = 1.3
    """gamma_c."""
    wear_factor: FactorValue = 1.0
    """gamma_w: 1.0, 1.1 or 1.2."""
    material_factor: FactorValue = 1.5
    """gamma_m: 1.5, or 1.35 of a rope as new."""
    twist_factor: FactorValue = 1.0
    """gamma_tw."""

    def judge(self, run: Run) -> list[CriterionResult]:
        """Largest force over the breaking load by the factor."""
        bending = 1.0 if self.bending_ratio is None else rules.bending_factor(self.bending_ratio)
        reduction = max(self.termination_factor, bending)
        factor = rules.sling_factor(
            reduction=reduction,
            load=self.load_factor,
            consequence=self.consequence_factor,
            wear=self.wear_factor,
            material=self.material_factor,
            twist=self.twist_factor,
        )
        forces = self.forces(run, run.tensions(self.ropes))
        breaking = run.newtons(self.breaking_load)
        names = ["sling utilisation", "sling safety factor"]
        if not {"consequence_factor", "wear_factor", "material_factor"} <= self.model_fields_set:
            names.append("partial factors")
        if "load_factor" not in self.model_fields_set:
            names.append("load factor gamma_f")
        if bending > self.termination_factor:
            names.append("bending of a rope")
        return [
            run.result(
                "force over breaking load / gamma_sf",
                "N",
                [Series(rope, values, breaking / factor) for rope, values in forces.values.items()],
                tuple(rules.clause(name) for name in names),
                factors=(
                    *forces.factors,
                    Factor("gamma_r", reduction, ON_LIMIT),
                    Factor("gamma_sf", factor, ON_LIMIT),
                ),
                seen=forces.seen,
                times=forces.times,
            )
        ]
