"""Lugs by the forces of ropes on them and the angle to the plane of the eye."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import Angle, Lugs, Rated
from heavylift.pipeline.case.criteria.base import RiggedCriterion
from heavylift.pipeline.case.criteria.results import GIVEN, CriterionResult, Factor, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Quantity


class LugCriterion(RiggedCriterion):
    """Forces of ropes on lugs, in the plane of the eye and across it, and their angle to that plane."""

    ORDER: ClassVar = 5

    type: Literal["lug"]
    lugs: Lugs
    """Lugs of ``[[lugs]]``, by names or patterns: ``["lug_*"]``."""
    in_plane: Rated | None = None
    """What a lug may carry in its plane; not judged if absent."""
    out_of_plane: Rated | None = None
    """What a lug may carry across its plane; not judged if absent."""
    lateral_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 0.03
    """Least lateral force relative to the force of the rope, where that of the run is smaller; 0.05 afloat."""
    maximum_angle: Angle = 0.08726646259971647
    """Largest angle to the plane of the eye while the rope carries; 5 deg by default."""

    def judge(self, run: Run) -> list[CriterionResult]:
        """Angle, and forces in the plane and across it."""

        def channels(part: str) -> dict[str, str]:
            return {lug: f"channel.{lug}.{part}" for lug in self.lugs}

        def amounts(part: str) -> dict[str, NDArray[np.float64]]:
            """Largest amounts since the record before of what has a sign."""
            return {
                lug: np.maximum(run.history(name, "max"), -run.history(name, "min"))
                for lug, name in channels(part).items()
            }

        forces, angles = self.forces(run, channels("force")), amounts("angle")
        idle = [lug for lug in self.lugs if not run.history(f"channel.{lug}.force", "max").any()]
        carrying = [lug for lug in self.lugs if lug not in idle]
        rows = [
            run.result(
                "angle to the plane of the eye",
                "rad",
                [Series(lug, angles[lug], self.maximum_angle) for lug in carrying]
                or [Series("", np.full(len(run.times), np.nan), self.maximum_angle)],
                (run.default("maximum_angle", rules.clause("out-of-plane angle at padeyes")),),
                seen=run.seen(list(channels("angle").values()), "max"),
                note=f"never carries: {', '.join(idle)}" if idle else "",
            )
        ]
        point = rules.clause("lift point load")
        if self.in_plane is not None:
            inside = self.forces(run, channels("in_plane"))
            limit = run.newtons(self.in_plane)
            rows.append(
                run.result(
                    "force in the plane of the eye",
                    "N",
                    [Series(lug, values, limit) for lug, values in inside.values.items()],
                    (point,),
                    factors=inside.factors,
                    seen=inside.seen,
                    times=inside.times,
                )
            )
        if self.out_of_plane is not None:
            across = self.forces(run, channels("out_of_plane"), amounts=amounts("out_of_plane"))
            limit = run.newtons(self.out_of_plane)
            rows.append(
                run.result(
                    "force across the plane of the eye",
                    "N",
                    [
                        Series(lug, np.maximum(values, self.lateral_share * forces.values[lug]), limit)
                        for lug, values in across.values.items()
                    ],
                    (point, run.default("lateral_share", rules.clause("lateral load at lift points"))),
                    factors=(*across.factors, Factor("least lateral share", self.lateral_share, GIVEN)),
                    seen=across.seen,
                    times=across.times,
                )
            )
        return rows
