"""Loads of cranes over the curve of their capacity; off-lead and side-lead of their falls."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from heavylift.pipeline.case.criteria import lift_rules as rules
from heavylift.pipeline.case.criteria.annotations import Angle, Force, OneChannel, Rated, Rating
from heavylift.pipeline.case.criteria.base import LoadedCriterion
from heavylift.pipeline.case.criteria.lift_rules import OF_THE_CASE
from heavylift.pipeline.case.criteria.places import PlaceSection, check_axes, check_path, check_place
from heavylift.pipeline.case.criteria.results import CriterionResult, CurveFigure, Forces, Series
from heavylift.pipeline.case.criteria.run import Run
from heavylift.pipeline.case.fields import GROUND, Positive, Section, refuse_unknown, reject
from heavylift.pipeline.case.rope_parts import parts_to


class CurveSection(Section):
    """What a crane may carry at a radius: linear between its rows, nothing outside."""

    radius: Annotated[tuple[Annotated[float, Positive("length")], ...], Field(min_length=2)]
    """[m], increasing."""
    capacity: Annotated[tuple[Rated, ...], Field(min_length=2)]
    """Force or mass, one a radius."""

    @model_validator(mode="after")
    def _is_a_curve(self) -> "CurveSection":
        if len(self.radius) != len(self.capacity):
            reject(
                f"{len(self.radius)} radii and {len(self.capacity)} capacities",
                "one capacity for each radius",
                key="capacity",
            )
        for index, (a, b) in enumerate(zip(self.radius, self.radius[1:], strict=False)):
            if b <= a:
                reject(f"{b:g} m is not above {a:g} m", "increasing radii", key=f"radius.{index + 1}")
        if len({rating.is_mass for rating in self.capacity}) > 1:
            reject("masses beside forces", "capacities of one unit", key="capacity")
        return self


class ReachSection(Section):
    """Between which points the radius of a crane is."""

    centre: PlaceSection
    """On the axis from which the radius counts."""
    tip: PlaceSection
    """Where the falls begin: the head of the boom, or the trolley."""


class CraneCriterion(LoadedCriterion):
    """Load of a crane over its capacity at the radius; off-lead and side-lead of its falls.

    The capacity of a crane may include dynamics of its own: see the document of the crane.
    """

    ORDER: ClassVar = 1

    type: Literal["crane"]
    load: Force
    """Channel of the load: ``"fall.tension"``, ``"sum(fall_*.tension)"``."""
    parts: Annotated[float, Positive("number")] = 1.0
    """Number of parts of a fall: what the channel is multiplied by."""
    additional: Rated | None = None
    """Rigging that hangs on the crane and is not in the run: force or mass."""
    curve: CurveSection
    """Capacity over radius."""
    radius: Annotated[float, Positive("length")] | None = None
    """Radius of a lift at one radius [m]; or `radius_channel`, or `reach`."""
    radius_channel: Annotated[str, OneChannel("length")] | None = None
    """Channel of the radius."""
    reach: ReachSection | None = None
    """Points between which the radius is, horizontally; needed for off-lead and side-lead."""
    hook: PlaceSection | None = None
    """Lower end of the falls, for off-lead and side-lead: angles of the line from the tip, in and across the plane of
    the boom, in the axes of the body of the centre."""
    fall: str | None = None
    """Rope whose straight parts to the body of the hook are the falls, in place of the line from the tip: it leaves a
    sheave beside its centre, and that is no lead."""
    off_lead: Angle | None = None
    """Largest angle of the falls in the plane of the boom; 3 deg if absent."""
    side_lead: Angle | None = None
    """Largest angle of the falls across the plane of the boom; 3 deg if absent."""

    @model_validator(mode="after")
    def _has_one_radius(self) -> "CraneCriterion":
        keys = ("radius", "radius_channel", "reach")
        given = [key for key in keys if getattr(self, key) is not None]
        if len(given) != 1:
            what = f"both {given[0]!r} and {given[1]!r}" if given else "no radius"
            reject(what, "one of 'radius', 'radius_channel', 'reach'")
        low, high = self.curve.radius[0], self.curve.radius[-1]
        if self.radius is not None and not low <= self.radius <= high:
            reject(
                f"{self.radius:g} m is outside the crane curve",
                f"a radius from {low:g} m to {high:g} m",
                key="radius",
            )
        if self.hook is not None and self.reach is None:
            reject(
                "'hook' without 'reach'", "'reach', which gives the point where the falls begin", key="hook"
            )
        for key in ("off_lead", "side_lead", "fall"):
            if getattr(self, key) is not None and self.hook is None:
                reject(f"{key!r} without 'hook'", "'reach' and 'hook', between which the falls are", key=key)
        return self

    def check_case(self, case: Any, key: str) -> None:
        """Places must be recorded, and the fall lead to the hook."""
        super().check_case(case, key)
        places = (
            {} if self.reach is None else {"reach.centre": self.reach.centre, "reach.tip": self.reach.tip}
        )
        places |= {} if self.hook is None else {"hook": self.hook}
        for name, place in places.items():
            check_place(case, place.body, place.point, f"{key}.{name}")
        if self.reach is not None:
            check_axes(case, self.reach.centre.body, f"{key}.reach.centre.body")
        if self.fall is not None and self.hook is not None:
            refuse_unknown("rope", self.fall, [one.name for one in case.ropes], key=f"{key}.fall")
            check_path(case, self.fall, f"{key}.fall")
            if not parts_to(case, self.fall, self.hook.body):
                reject(
                    f"no part of {self.fall!r} leads to {self.hook.body!r}",
                    "a rope between the crane and the body of the hook",
                    key=f"{key}.fall",
                )

    def ratings(self) -> dict[str, Rating]:
        """Those of the curve besides."""
        curve = {f"curve.capacity.{i}": rating for i, rating in enumerate(self.curve.capacity)}
        return super().ratings() | curve

    @property
    def channel_text(self) -> str:
        """The load."""
        return self.load

    def _radius(self, run: Run) -> NDArray[np.float64]:
        """Radius at all records [m], shape (nt,)."""
        if self.radius is not None:
            return np.full(len(run.times), self.radius)
        if self.radius_channel is not None:
            return run.history(f"channel.{self.radius_channel}")
        assert self.reach is not None
        d = _between(run, self.reach.centre, self.reach.tip)
        return np.asarray(np.linalg.norm(d - np.outer(d @ run.up, run.up), axis=1))

    def _lifted(self, run: Run) -> Forces:
        more = 0.0 if self.additional is None else run.newtons(self.additional)
        return self.forces(run, {self.load: f"channel.{self.load}"}, self.parts, more)

    def _capacities(self, run: Run) -> list[float]:
        """At the radii of the curve [N]."""
        return [run.newtons(one) for one in self.curve.capacity]

    def judge(self, run: Run) -> list[CriterionResult]:
        """Load at the radius, radius within the curve, leads."""
        radius, forces = self._radius(run), self._lifted(run)
        (load,) = forces.values.values()
        if len(load) == 1:
            load = np.full(len(radius), load[0])
        low, high = self.curve.radius[0], self.curve.radius[-1]
        capacity = rules.capacity_at(self.curve.radius, self._capacities(run), radius)
        if "steps" in forces.seen:  # the load is the largest since the record before: so is the radius
            both = np.fmin(capacity[1:], capacity[:-1])
            capacity[1:] = np.where(run.entered[1:], capacity[1:], both)
        clauses = (rules.clause("static and dynamic hook load"),)
        within = ~np.isnan(capacity)
        judged = np.where(within, load, -np.inf)
        limits = np.where(within, capacity, 1.0)
        if not within.any():
            judged, limits = np.full(len(load), np.nan), np.full(len(load), np.nan)
        rows = [
            run.result(
                "load over capacity at the radius",
                "N",
                [Series(self.load, judged, limits)],
                clauses,
                factors=forces.factors,
                seen=forces.seen,
                at=lambda record: f"at radius {radius[record]:.4g} m",
                note="" if within.any() else "no record is within the crane curve",
            )
        ]
        used = np.where(within, load / limits, np.nan)
        rows[0] = replace(
            rows[0],
            history=run.over_time(used) if within.any() and len(used) > 1 else None,
        )
        if not len(forces.times) and self.radius is not None:  # at rest, at one radius: at no time
            rows[0] = replace(rows[0], time=None, phase="", history=None)
        if self.radius is None:
            beyond = radius.max() - high >= low - radius.min()
            worst = "<=" if beyond else ">="
            limit = high if beyond else low
            words = f"radius within the crane curve, {low:g} m to {high:g} m"
            outside = np.count_nonzero((radius < low) | (radius > high))
            note = f"outside the crane curve at {outside:,} of {len(radius):,} records" if outside else ""
            series = [Series("", radius, limit)]
            rows.append(run.result(words, "m", series, clauses, side=worst, seen=run.records, note=note))
        if self.hook is not None:
            rows += self._leads(run)
        return rows

    def figures(self, run: Run, lines: Sequence[CriterionResult]) -> list[CurveFigure]:
        """Load over radius, under the curve."""
        line = next(one for one in lines if one.unit == "N")
        radius = self._radius(run)
        (load,) = self._lifted(run).values.values()
        governing = None
        if math.isfinite(line.value):
            record = 0 if line.time is None else int(np.argmin(np.abs(run.times - line.time)))
            governing = float(radius[record]), line.value
        return [
            CurveFigure(
                name=f"crane_{self.name}",
                title=f"Crane curve, {self.name}",
                caption="Load over the curve of the crane",
                line=line,
                place="radius [m]",
                value="load",
                limit="capacity",
                unit="N",
                curve=(self.curve.radius, self._capacities(run)),
                values=(radius, np.broadcast_to(load, radius.shape)),
                governing=governing,
            )
        ]

    def _leads(self, run: Run) -> list[CriterionResult]:
        """Angles of the falls in the plane of the boom and across it, in the axes of the crane."""
        assert self.reach is not None
        assert self.hook is not None
        if self.fall is None:
            fall = _between(run, self.reach.tip, self.hook)
        else:
            begins, ends = run.parts(self.fall)
            lines = [
                sign * (ends[k] - begins[k]) for k, sign in parts_to(run.case, self.fall, self.hook.body)
            ]
            fall = np.mean([line / np.linalg.norm(line, axis=1, keepdims=True) for line in lines], axis=0)
        out = _between(run, self.reach.centre, self.reach.tip)
        body = self.reach.centre.body
        up = np.tile(run.up, (len(run.times), 1))
        if body != GROUND:
            up = run.turned(body, (0.0, 0.0, 1.0))
        out = out - np.sum(out * up, axis=1, keepdims=True) * up
        length = np.linalg.norm(out, axis=1, keepdims=True)
        if not (length > 0.0).all():
            raise run.error(
                "the tip is on the axis of the crane",
                "a tip beside the axis, which gives the direction of the boom",
            )
        out = out / length
        down = -np.sum(fall * up, axis=1)
        rows = []
        for what, axis, given in (
            ("off-lead, angle of the falls in the plane of the boom", out, self.off_lead),
            ("side-lead, angle of the falls across the plane of the boom", np.cross(up, out), self.side_lead),
        ):
            angle = np.abs(np.arctan2(np.sum(fall * axis, axis=1), down))
            clause = OF_THE_CASE
            if given is None:
                clause = rules.clause("off-lead and side-lead of cranes at rest")
            series = [Series("", angle, rules.LEAD if given is None else given)]
            rows.append(run.result(what, "rad", series, (clause,), seen=run.records))
        return rows


def _between(run: Run, a: PlaceSection, b: PlaceSection) -> NDArray[np.float64]:
    return run.place(b.body, b.point) - run.place(a.body, a.point)
