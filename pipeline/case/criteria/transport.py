"""Transporters: stability, strokes, loads of bogies, drives and brakes."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from heavylift.pipeline.case.criteria.base import CriterionSection
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE, Clause
from heavylift.pipeline.case.criteria.results import CriterionResult, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import Name, Quantity, refuse_unknown

_NOT_AT_ITS_END = 1.0 - 1e-9
"""Share of what tyres that slip and their motors have from which on they are at their end."""


class TransportCriterion(CriterionSection):
    """A transporter: how far it is from tipping over, and what its bogies, drives and brakes have left."""

    ORDER: ClassVar = 10

    type: Literal["transport"]
    transporter: Name
    """Transporter that is judged."""
    static_tipping: Annotated[float, Quantity("angle", minimum=0.0, maximum=1.5, closed=True)] = math.radians(
        7.0
    )
    """Least tilt of the road at which it tips over on rigid groups."""
    tipping: Annotated[float, Quantity("angle", minimum=0.0, maximum=1.5, closed=True)] = math.radians(2.0)
    """Least tilt of the road at which it tips over on compliant groups."""
    group_share: Annotated[float, Quantity("number", minimum=0.0, maximum=0.5)] = 0.0
    """Share of the weight that every group must exceed in the run."""
    stroke_reserve: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """That strokes must keep from `stroke_limits` [m], if the transporter has them."""
    drive_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.8
    """Largest part of what drives can give, if the transporter has a drive with a table."""
    traction_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 1.0
    """Largest part of what friction of driven bogies allows, if it has a drive."""
    brake_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 1.0
    """Largest part of what brakes hold at rest, if it has a drive with a `brake_force`."""

    def check_case(self, case: Any, key: str) -> None:
        """The transporter must exist."""
        super().check_case(case, key)
        names = [one.name for one in case.transporters]
        refuse_unknown("transporter", self.transporter, names, key=f"{key}.transporter")

    def judge(self, run: Run) -> list[CriterionResult]:
        """Stability first, then what the run used."""
        name = self.transporter
        transporter: Any = next(one for one in run.case.transporters if one.name == name)
        never = np.empty(0)
        rows = []
        assumed = {
            "static_tipping": "7 deg on rigid groups",
            "tipping": "2 deg on compliant groups",
            "group_share": "all groups carry",
            "stroke_reserve": "within the strokes",
            "drive_share": "0.8 of the drives",
            "traction_share": "friction of driven bogies",
            "brake_share": "brakes hold",
        }
        clauses = {key: (run.default(key, Clause(words, "assumption")),) for key, words in assumed.items()}
        for key, item, what in (
            ("static_tipping", "static", "tilt at which it tips over, rigid groups"),
            ("tipping", "compliant", "tilt at which it tips over, compliant groups"),
        ):
            if name in run.metadata.get("tipping", {}):
                value = np.array([run.number(f"tipping.{name}.{item}")])
                series = [Series(name, value, getattr(self, key))]
                rows.append(run.result(what, "rad", series, clauses[key], side=">=", times=never))
        share = run.history(f"channel.{name}.least_share")
        what = "smallest load of a group over that of all"
        series = [Series(name, share, self.group_share)]
        rows.append(run.result(what, "1", series, clauses["group_share"], side=">", seen=run.records))
        if transporter.stroke_limits is not None:
            low, high = transporter.stroke_limits
            channel = f"channel.{name}.stroke"
            series = [
                Series("up", run.history(f"{channel}_max", "max"), high - self.stroke_reserve),
                Series("down", -run.history(f"{channel}_min", "min"), -low - self.stroke_reserve),
            ]
            seen = run.seen([f"{channel}_max"], "max")
            rows.append(run.result("stroke of a bogie", "m", series, clauses["stroke_reserve"], seen=seen))
        if math.isfinite(transporter.load_limit or math.inf):
            channel = f"channel.{name}.load_max"
            series = [Series(name, run.history(channel, "max"), transporter.load_limit)]
            seen = run.seen([channel], "max")
            rows.append(run.result("load of a bogie", "N", series, (OF_THE_CASE,), seen=seen))
        drive = transporter.drive
        used = {} if drive is None else {"traction": "force of a driven bogie over what friction allows"}
        if drive is not None and len(drive.speeds):
            used["drive"] = "force of a driven bogie over what its drive can"
        if drive is not None and math.isfinite(drive.brake_force or math.inf):
            used["brake"] = "force of a driven bogie at rest over what its brakes hold"
        for key, what in used.items():
            channel, limit = f"channel.{name}.{key}_used_max", getattr(self, f"{key}_share")
            if transporter.tyres is not None:
                limit = min(
                    limit, _NOT_AT_ITS_END
                )  # then nothing is asked for more than there is: it slides at 1
            series = [Series(name, run.history(channel, "max"), limit)]
            rows.append(
                run.result(what, "1", series, clauses[f"{key}_share"], seen=run.seen([channel], "max"))
            )
        return rows
