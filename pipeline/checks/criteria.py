"""Criteria of a case after its run: value, utilisation, margin, when and where each governs, and what it comes from.

Everything is taken from the records of a run, at once for all times; forces by their extremes over all steps where the
run has them. A simulated quantity replaces a factor, never both: a force is the largest one of the run, which has its
dynamics, or the one at rest times a factor, and each result lists its factors and where each of them is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.pipeline.case.criteria import (
    ClearanceCriterion,
    CraneCriterion,
    DynamicsCriterion,
    LimitCriterion,
    LugCriterion,
    ShackleCriterion,
    SlackCriterion,
    SlingAngleCriterion,
    SlingCriterion,
    TiltCriterion,
    TransportCriterion,
    parts_to,
    phase_names,
    ropes_over_pulleys,
    sensor_at,
    straight_parts,
    tensions_of,
)
from heavylift.pipeline.case.fields import GROUND
from heavylift.pipeline.checks import lift_rules as rules
from heavylift.pipeline.checks.lift_rules import Clause
from heavylift.pipeline.checks.quantities import Quantities
from heavylift.pipeline.results.rope_lines import rope_tangents

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    from heavylift.pipeline.case.case_file import Case
    from heavylift.pipeline.case.criteria import Criterion, PlaceSection, Rating
    from heavylift.pipeline.results.histories import Results

__all__ = [
    "PHASE",
    "CranePoints",
    "CriterionResult",
    "Factor",
    "crane_points",
    "evaluate_criteria",
    "evaluate_criterion",
    "phase_words",
]

PHASE = "scenario.phase"
"""Channel with the number of the phase of an operation, if the run has one."""
_IN_RUN, _GIVEN, _ON_LIMIT = "in the run", "on the value", "on the limit"
_OF_THE_CASE = Clause("limit of the case file", "case file")
_TOUCH = 1e-9  # of a time: a record at the end of a span belongs to it


class Factor(NamedTuple):
    """A factor of a criterion.

    Attributes
    ----------
    name
        E.g. ``"DAF"``.
    value
        None of what the run has and no number says.
    where
        ``"in the run"``: the value has it by simulation; ``"on the value"`` or ``"on the limit"``: multiplied there;
        ``"table, not applied"``: told for comparison.
    """

    name: str
    value: float | None
    where: str

    @property
    def text(self) -> str:
        """In words."""
        number = "" if self.value is None else f" {self.value:.4g}"
        return f"{self.name}{number} {self.where}"


@dataclass(frozen=True, eq=False)
class CriterionResult:
    """One line of the table of criteria.

    Attributes
    ----------
    name, type
        From the case.
    what
        What the value is, in words.
    value, limit, unit
        SI.
    side
        ``"<="``, ``">="`` or ``">"``: how the value must stand to its limit.
    clauses
        Where the limit and the factors come from.
    factors
        Factors, and where each is.
    where
        Rope, lug or channel that governs, and at what radius.
    time
        When [s]; None of forces at rest, and of numbers over all times.
    phase
        Of the operation then; empty if the run has none.
    seen
        Of what the extreme is: ``"12,000 steps"``, ``"401 records"``.
    note
        What else is to be known; a warning if `warns`.
    warns
        Whether it passes, but is told.
    history
        Times [s] and utilisations over the run, of the one that governs; None if there are none.
    """

    name: str
    type: str
    what: str
    value: float
    limit: float
    unit: str
    side: str = "<="
    clauses: tuple[Clause, ...] = ()
    factors: tuple[Factor, ...] = ()
    where: str = ""
    time: float | None = None
    phase: str = ""
    seen: str = ""
    note: str = ""
    warns: bool = False
    history: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None

    @property
    def passed(self) -> bool:
        """Whether the value stands to its limit as it must; a value that is no number does not."""
        if self.side == "<=":
            return self.value <= self.limit
        return self.value >= self.limit if self.side == ">=" else self.value > self.limit

    @property
    def margin(self) -> float:
        """How far the value is within its limit, in `unit`; negative beyond it."""
        return self.limit - self.value if self.side == "<=" else self.value - self.limit

    @property
    def utilisation(self) -> float | None:
        """Value over limit, of a least value limit over value; None where that says nothing: limits of zero."""
        used = float(_utilisation(np.array(self.value), self.limit, self.side))
        return used if math.isfinite(used) else None

    @property
    def source(self) -> str:
        """Clauses in words, those that nobody has confirmed marked."""
        return "; ".join(dict.fromkeys(one.text for one in self.clauses))

    def row(self) -> dict[str, Any]:
        """The line as plain values, as in ``criteria.json``; what is no number is None."""
        values = {key: getattr(self, key) for key in ("value", "limit", "utilisation", "margin", "time")}
        finite = {
            key: float(value) if value is not None and math.isfinite(value) else None
            for key, value in values.items()
        }
        return {
            "name": self.name,
            "type": self.type,
            "what": self.what,
            "value": finite["value"],
            "side": self.side,
            "limit": finite["limit"],
            "unit": self.unit,
            "utilisation": finite["utilisation"],
            "margin": finite["margin"],
            "where": self.where,
            "time": finite["time"],
            "phase": self.phase,
            "seen": self.seen,
            "factors": [factor._asdict() for factor in self.factors],
            "sources": [one._asdict() for one in self.clauses],
            "note": self.note,
            "warning": self.warns,
            "passed": self.passed,
        }


def _utilisation(values: NDArray[np.float64], limit: ArrayLike, side: str) -> NDArray[np.float64]:
    """Value over limit, or limit over value; infinite where a least value is not positive, nan without meaning."""
    limits = np.asarray(limit, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        if side == "<=":
            return np.where((limits > 0.0) & (values >= 0.0), values / limits, np.nan)
        return np.where(limits > 0.0, np.where(values > 0.0, limits / values, np.inf), np.nan)


class _Series(NamedTuple):
    """A history that is judged: of what, values, and limits at all times or one for all."""

    where: str
    values: NDArray[np.float64]
    limits: NDArray[np.float64] | float


class _Run:
    """Records of a run within the time of a criterion.

    Parameters
    ----------
    case, quantities
        The case, and its quantities.
    criterion
        The criterion.
    """

    def __init__(self, case: Case, quantities: Quantities, criterion: Any) -> None:
        self.case, self.quantities, self.criterion = case, quantities, criterion
        self.results: Results = quantities.results
        time = self.results.time
        slack = _TOUCH * max(1.0, float(np.abs(time).max(initial=0.0)))
        first = -math.inf if criterion.after is None else criterion.after - slack
        last = math.inf if criterion.until is None else criterion.until + slack
        self.inside = (time >= first) & (time <= last) & self._in_phases(criterion.phases)
        if not self.inside.any():
            raise InputError(
                f"criterion {criterion.name!r}: there is no record within its time",
                source=case.file,
                expected="'after', 'until' and 'phases' within the records",
            )
        self.times: NDArray[np.float64] = time[self.inside]
        before = np.concatenate([[True], self.inside[:-1]])
        # records whose neighbour before does not belong to the criterion
        self.entered: NDArray[np.bool_] = ~before[self.inside]
        # and those whose whole interval is before its time; one in which a phase begins counts for that phase
        self.begins = np.isclose(self.times, criterion.after or -math.inf, rtol=0.0, atol=slack)

    def _in_phases(self, wanted: Sequence[str]) -> NDArray[np.bool_]:
        """Records in some phases of the operation; all if none is named."""
        if not wanted:
            return np.ones(len(self.results.time), dtype=np.bool_)
        if PHASE not in self.results:
            raise InputError(
                f"criterion {self.criterion.name!r}: the run has no {PHASE!r}",
                source=self.case.file,
                expected="a run with phases, or no 'phases'",
            )
        names = phase_names(self.case)
        numbers = [number for number, name in enumerate(names, 1) if name in wanted]
        phases = self.results[PHASE].reshape(len(self.results.time), -1)[:, 0]
        return np.isin(phases, numbers)

    def history(self, name: str, side: str = "end") -> NDArray[np.float64]:
        """Records of a channel or stress, ``"channel.fall.tension"``, or their extremes since the record before."""
        values = self.quantities.history(f"{name}.{side}")
        found: NDArray[np.float64] = values[self.inside].copy()
        if side in {"max", "min", "absolute"} and self.begins.any():
            ends = self.quantities.history(f"{name}.end")[self.inside][self.begins]
            found[self.begins] = np.abs(ends) if side == "absolute" else ends
        return np.abs(found) if side == "absolute" else found

    @property
    def steps(self) -> NDArray[np.float64]:
        """Time from each record to the next one, where both belong to the criterion [s], shape (nt - 1,)."""
        return np.where(self.entered[1:], 0.0, np.diff(self.times))

    def seen(self, names: Sequence[str], side: str) -> str:
        """Of how many steps or records extremes are; records if they differ."""
        words = [self.quantities.seen(f"{name}.{side}").partition(" of ")[2] for name in names]
        least = min((word for word in words if word), key=lambda word: "steps" in word, default=self.records)
        if self.inside.all() or "steps" not in least:
            return least if self.inside.all() else self.records
        near = " where it was near enough to be searched" * ("near enough" in least)
        return f"the steps of {self.records}{near}"

    @property
    def records(self) -> str:
        """Number of records in words."""
        return f"{len(self.times):,} records"

    def at_rest(self, name: str) -> float:
        """Value of a channel when the criterion says that it is at rest."""
        when = self.criterion.static_at
        if isinstance(when, float):
            if when > self.results.time[-1] + _TOUCH * when:
                raise InputError(
                    f"criterion {self.criterion.name!r}: the records end at {self.results.time[-1]:.9g} s",
                    source=self.case.file,
                    expected=f"a run beyond 'static_at', {when:.9g} s",
                )
            whole = self.quantities.history(f"{name}.end")
            return float(np.interp(when, self.results.time, whole))
        values = self.history(name)
        steps = self.steps
        if when == "mean" and steps.any():
            return float(np.sum(0.5 * (values[1:] + values[:-1]) * steps) / np.sum(steps))
        return float(values[-1] if when == "end" else values[0])

    @cached_property
    def gravity(self) -> NDArray[np.float64]:
        """Acceleration, shape (3,) [m/s^2]; zeros without."""
        given = self.case.gravity
        return np.zeros(3) if given is None else np.array(given.acceleration, dtype=np.float64)

    @property
    def g(self) -> float:
        """Amount of gravity [m/s^2]."""
        return float(np.linalg.norm(self.gravity))

    @property
    def up(self) -> NDArray[np.float64]:
        """Unit vector against gravity; z without."""
        return -self.gravity / self.g if self.g > 0.0 else np.array([0.0, 0.0, 1.0])

    def newtons(self, rating: Rating) -> float:
        """Force of a rating [N]."""
        return rating.value * self.g if rating.is_mass else rating.value

    def rotations(self, body: str) -> Any:
        """From the axes of a body to those of the world, at all times."""
        from scipy.spatial.transform import Rotation

        if body == GROUND:
            return Rotation.identity(len(self.times))
        q = self.results[f"{body}.orientation"][self.inside]
        return Rotation.from_quat(q[:, [1, 2, 3, 0]])

    def place(self, body: str, point: Sequence[float]) -> NDArray[np.float64]:
        """Where a point of a body is in the world [m], shape (nt, 3)."""
        given = np.array(point, dtype=np.float64)
        if body == GROUND:
            return np.tile(given, (len(self.times), 1))
        section: Any = self.case.bodies[body]
        if section.type != "rigid":
            sensor = sensor_at(self.case, body, point)
            return np.asarray(self.results[f"{sensor}.position"][self.inside])
        if section.frame.origin == "centre_of_mass":
            given = given - np.array(section.centre_of_mass)
        position = self.results[f"{body}.position"][self.inside]
        return np.asarray(position + self.rotations(body).apply(given))

    def parts(self, name: str) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
        """Beginnings and ends of the straight parts of a rope in the world [m], each of shape (nt, 3).

        Lines of one force begin at their pulleys, which slide below the outlets along their guides; they stretch.
        """
        rope: Any = next(one for one in self.case.ropes if one.name == name)
        centres = [self.place(stop.body, stop.point) for stop in rope.path]
        pieces = straight_parts(rope)
        if hasattr(rope, "lengths"):
            turns = self.rotations(rope.path[0].body)
            down = np.asarray(turns.apply(np.array(rope.direction) / np.linalg.norm(rope.direction)))
            begins = []
            tensions = tensions_of(self.case, [name]).values()
            for (a, b), unstretched, told in zip(pieces, rope.lengths, tensions, strict=True):
                strain = self.history(f"channel.{told}") / rope.line_stiffness
                length = unstretched * (1.0 + strain[:, np.newaxis])
                w = centres[b] - centres[a]
                aside = w - np.sum(w * down, axis=1, keepdims=True) * down
                square = length**2 - np.sum(aside**2, axis=1, keepdims=True)
                begins.append(centres[b] - aside - np.sqrt(np.maximum(0.0, square)) * down)
            return begins, [centres[b] for _, b in pieces]
        axes = []
        for stop in rope.path:
            axis = np.array([0.0, 0.0, 1.0] if stop.axis is None else stop.axis, dtype=np.float64)
            turns = self.rotations(stop.body if stop.radius > 0.0 else GROUND)
            axes.append(np.asarray(turns.apply(axis / np.linalg.norm(axis))))
        arrive, leave = rope_tangents(centres, [stop.radius for stop in rope.path], axes)
        return [leave[a] for a, _ in pieces], [arrive[b] for _, b in pieces]

    def phase(self, time: float | None) -> str:
        """Phase of the operation at a time; empty if the run does not know."""
        if time is None or PHASE not in self.results:
            return ""
        record = min(int(np.searchsorted(self.results.time, time - _TOUCH)), len(self.results.time) - 1)
        number = self.results[PHASE].reshape(len(self.results.time), -1)[record, 0]
        return phase_words(self.case, float(number))

    def clauses(self, *found: Clause) -> tuple[Clause, ...]:
        """The source that the criterion gives, or those of its kind."""
        given = self.criterion.source
        return (Clause(given, "case file"),) if given else found

    def default(self, key: str, found: Clause) -> Clause:
        """The clause that the default value of a key comes from; the case file where that gives another one."""
        return _OF_THE_CASE if key in self.criterion.model_fields_set else found

    def result(
        self,
        what: str,
        unit: str,
        series: Sequence[_Series],
        clauses: tuple[Clause, ...],
        *,
        side: str = "<=",
        factors: tuple[Factor, ...] = (),
        seen: str = "",
        note: str = "",
        times: NDArray[np.float64] | None = None,
        at: Callable[[int], str] | None = None,
    ) -> CriterionResult:
        """The worst value of some histories as a line; `times` are empty of forces at rest, `at` says more of a record.

        Notes
        -----
        The worst is the one of least margin relative to its limit; a value that is no number is worse than any.
        """
        moments = self.times if times is None else times
        scores = []
        for one in series:
            limits = np.broadcast_to(np.asarray(one.limits, dtype=np.float64), one.values.shape)
            room = limits - one.values if side == "<=" else one.values - limits
            scale = np.where(np.abs(limits) > 0.0, np.abs(limits), 1.0)
            scores.append(np.where(np.isnan(room), -np.inf, room / scale))
        lowest = [float(score.min()) for score in scores]
        number = int(np.argmin(lowest))
        worst, record = series[number], int(np.argmin(scores[number]))
        limits = np.broadcast_to(np.asarray(worst.limits, dtype=np.float64), worst.values.shape)
        time = float(moments[record]) if len(moments) else None
        used = _utilisation(worst.values, limits, side)
        return CriterionResult(
            name=self.criterion.name,
            type=self.criterion.type,
            what=what,
            value=float(worst.values[record]),
            limit=float(limits[record]),
            unit=unit,
            side=side,
            clauses=self.clauses(*clauses),
            factors=factors,
            where=" ".join(filter(None, (worst.where, at(record) if at else ""))),
            time=time,
            phase=self.phase(time),
            seen=seen,
            note=note,
            history=self.over_time(used) if len(moments) > 1 and np.isfinite(used).any() else None,
        )

    def over_time(self, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times of all records [s], and values within the time of the criterion, elsewhere no numbers."""
        found = np.full(len(self.results.time), np.nan)
        found[self.inside] = values
        return self.results.time, found


def phase_words(case: Case, number: float) -> str:
    """Name of the phase of an operation with a number from 1, as the case file says it; else its number."""
    names = phase_names(case)
    if names and number > len(names):
        return "the end, after all phases"
    return names[int(number) - 1] if names and number >= 1.0 else f"phase {number:g}"


class _Forces(NamedTuple):
    """Forces that are judged: by where they are, their times, none of forces at rest, and what is inside."""

    values: dict[str, NDArray[np.float64]]
    times: NDArray[np.float64]
    factors: tuple[Factor, ...]
    seen: str


def _forces(
    run: _Run,
    channels: dict[str, str],
    scale: float = 1.0,
    more: float = 0.0,
    amounts: dict[str, NDArray[np.float64]] | None = None,
) -> _Forces:
    """Forces of channels ``"channel.fall.tension"``, by where: largest ones of the run, or those at rest with a factor.

    `scale` is the number of parts of a fall, `more` what is added at rest [N]. `amounts` are the largest ones of the
    run where forces have a sign that does not count.
    """
    criterion = run.criterion
    own = [
        Factor(word, value, _GIVEN)
        for word, key in (("skew", "skew_factor"), ("yaw", "yaw_factor"))
        if (value := getattr(criterion, key, 1.0)) != 1.0
    ]
    product = math.prod(factor.value or 1.0 for factor in own)
    if criterion.dynamic_factor is None:
        largest = amounts or {where: run.history(name, "max") for where, name in channels.items()}
        values = {where: product * (scale * found + more) for where, found in largest.items()}
        daf = Factor("DAF", None, _IN_RUN)
        return _Forces(values, run.times, (daf, *own), run.seen(list(channels.values()), "max"))
    factor = criterion.dynamic_factor
    resting = {where: run.at_rest(name) for where, name in channels.items()}
    values = {
        where: np.array([product * factor * (scale * (abs(rest) if amounts else rest) + more)])
        for where, rest in resting.items()
    }
    return _Forces(values, np.empty(0), (Factor("DAF", factor, _GIVEN), *own), "")


def _tensions(run: _Run, ropes: Sequence[str], *, least: bool = False) -> dict[str, str]:
    """What ropes carry: by what is judged of them, the quantity without its statistic."""
    return {label: f"channel.{name}" for label, name in tensions_of(run.case, ropes, least=least).items()}


def _sling(run: _Run, c: SlingCriterion) -> list[CriterionResult]:
    bending = 1.0 if c.bending_ratio is None else rules.bending_factor(c.bending_ratio)
    reduction = max(c.termination_factor, bending)
    factor = rules.sling_factor(
        reduction=reduction,
        load=c.load_factor,
        consequence=c.consequence_factor,
        wear=c.wear_factor,
        material=c.material_factor,
        twist=c.twist_factor,
    )
    forces = _forces(run, _tensions(run, c.ropes))
    breaking = run.newtons(c.breaking_load)
    names = ["sling utilisation", "sling safety factor"]
    if not {"consequence_factor", "wear_factor", "material_factor"} <= c.model_fields_set:
        names.append("partial factors")
    if "load_factor" not in c.model_fields_set:
        names.append("load factor gamma_f")
    if bending > c.termination_factor:
        names.append("bending of a rope")
    return [
        run.result(
            "force over breaking load / gamma_sf",
            "N",
            [_Series(rope, values, breaking / factor) for rope, values in forces.values.items()],
            tuple(rules.clause(name) for name in names),
            factors=(
                *forces.factors,
                Factor("gamma_r", reduction, _ON_LIMIT),
                Factor("gamma_sf", factor, _ON_LIMIT),
            ),
            seen=forces.seen,
            times=forces.times,
        )
    ]


def _shackle(run: _Run, c: ShackleCriterion) -> list[CriterionResult]:
    channels = _tensions(run, c.ropes)
    forces = _forces(run, channels)
    wll, factors, note = run.newtons(c.working_load_limit), list(forces.factors), ""
    series = []
    amplifications = dict.fromkeys(forces.values, c.dynamic_factor or 1.0)
    if c.dynamic_factor is None and c.static_at is not None:
        for rope in forces.values:
            static = run.at_rest(channels[rope])
            if not static > 0.0:
                raise InputError(
                    f"criterion {c.name!r}: {rope!r} has no tension at rest",
                    source=run.case.file,
                    expected="'static_at' when it carries",
                )
            largest = float(run.history(channels[rope], "max").max())
            amplifications[rope] = max(1.0, largest / static)
    for rope, values in forces.values.items():
        ratings = {"WLL": wll * amplifications[rope]}
        ratings |= {} if c.breaking_load is None else {"MBL / 3": run.newtons(c.breaking_load) / 3.0}
        ratings |= {} if c.proof_load is None else {"proof load": run.newtons(c.proof_load)}
        least = min(ratings, key=lambda name: ratings[name])
        series.append(_Series(f"{rope} ({least})", values, ratings[least]))
    if c.dynamic_factor is None and c.static_at is None:
        note = "the working load limit, one for forces at rest, is compared with the largest force as it is"
    result = run.result(
        "force over the least of WLL, MBL / 3, proof load",
        "N",
        series,
        (rules.clause("shackle"),),
        factors=tuple(factors),
        seen=forces.seen,
        times=forces.times,
        note=note,
    )
    amplification = amplifications[result.where.partition(" (")[0]]
    if amplification != 1.0:
        result = replace(
            result, factors=(*result.factors, Factor("DAF on the WLL", amplification, _ON_LIMIT))
        )
    return [result]


def _angles(
    run: _Run,
    what: str,
    found: dict[str, NDArray[np.float64]],
    channels: dict[str, str],
    limit: float,
    side: str,
    clauses: tuple[Clause, ...],
) -> CriterionResult:
    """Angles of ropes where they carry; a rope that never does has none, and is named."""
    harmless = math.inf if side == ">=" else -math.inf
    series, never = [], []
    for rope, angles in found.items():
        carries = run.history(channels[rope]) > 0.0
        if carries.any():
            series.append(_Series(rope, np.where(carries, angles, harmless), limit))
        else:
            never.append(rope)
    note = f"never carries: {', '.join(never)}" if never else ""
    if not series:
        series = [_Series("", np.full(len(run.times), np.nan), limit)]
    result = run.result(what, "rad", series, clauses, side=side, seen=run.records, note=note)
    return replace(result, history=None) if not math.isfinite(result.value) else result


def _sling_angle(run: _Run, c: SlingAngleCriterion) -> list[CriterionResult]:
    channels = _tensions(run, c.ropes)
    found: dict[str, NDArray[np.float64]] = {}
    for rope in c.ropes:
        angles = []
        for begin, end in zip(*run.parts(rope), strict=True):
            d = end - begin
            rise = np.abs(d @ run.up)
            angles.append(np.arctan2(rise, np.linalg.norm(d - np.outer(d @ run.up, run.up), axis=1)))
        own = list(tensions_of(run.case, [rope]))
        of_each = angles if len(own) > 1 else [np.min(angles, axis=0)]
        found |= dict(zip(own, of_each, strict=True))
    clauses = (run.default("minimum", Clause("30 deg, warning below 45 deg", "assumption")),)
    what = "smallest angle to the horizontal"
    result = _angles(run, what, found, channels, c.minimum, ">=", clauses)
    if result.passed and result.value < c.warning:
        words = f"below {math.degrees(c.warning):.4g} deg"
        result = replace(result, warns=True, note="; ".join(filter(None, (words, result.note))))
    return [result]


def _lug(run: _Run, c: LugCriterion) -> list[CriterionResult]:
    def channels(part: str) -> dict[str, str]:
        return {lug: f"channel.{lug}.{part}" for lug in c.lugs}

    def amounts(part: str) -> dict[str, NDArray[np.float64]]:
        """Largest amounts since the record before of what has a sign."""
        return {
            lug: np.maximum(run.history(name, "max"), -run.history(name, "min"))
            for lug, name in channels(part).items()
        }

    forces, angles = _forces(run, channels("force")), amounts("angle")
    idle = [lug for lug in c.lugs if not run.history(f"channel.{lug}.force", "max").any()]
    carrying = [lug for lug in c.lugs if lug not in idle]
    rows = [
        run.result(
            "angle to the plane of the eye",
            "rad",
            [_Series(lug, angles[lug], c.maximum_angle) for lug in carrying]
            or [_Series("", np.full(len(run.times), np.nan), c.maximum_angle)],
            (run.default("maximum_angle", rules.clause("out-of-plane angle at padeyes")),),
            seen=run.seen(list(channels("angle").values()), "max"),
            note=f"never carries: {', '.join(idle)}" if idle else "",
        )
    ]
    point = rules.clause("lift point load")
    if c.in_plane is not None:
        inside = _forces(run, channels("in_plane"))
        limit = run.newtons(c.in_plane)
        rows.append(
            run.result(
                "force in the plane of the eye",
                "N",
                [_Series(lug, values, limit) for lug, values in inside.values.items()],
                (point,),
                factors=inside.factors,
                seen=inside.seen,
                times=inside.times,
            )
        )
    if c.out_of_plane is not None:
        across = _forces(run, channels("out_of_plane"), amounts=amounts("out_of_plane"))
        limit = run.newtons(c.out_of_plane)
        rows.append(
            run.result(
                "force across the plane of the eye",
                "N",
                [
                    _Series(lug, np.maximum(values, c.lateral_share * forces.values[lug]), limit)
                    for lug, values in across.values.items()
                ],
                (point, run.default("lateral_share", rules.clause("lateral load at lift points"))),
                factors=(*across.factors, Factor("least lateral share", c.lateral_share, _GIVEN)),
                seen=across.seen,
                times=across.times,
            )
        )
    return rows


class CranePoints(NamedTuple):
    """What the curve of a crane is drawn with.

    Attributes
    ----------
    times
        [s], shape (nt,).
    radius, load
        [m], [N], shape (nt,).
    capacities
        At the radii of the curve [N].
    """

    times: NDArray[np.float64]
    radius: NDArray[np.float64]
    load: NDArray[np.float64]
    capacities: tuple[float, ...]


def _radius(run: _Run, c: CraneCriterion) -> NDArray[np.float64]:
    """Radius at all records [m], shape (nt,)."""
    if c.radius is not None:
        return np.full(len(run.times), c.radius)
    if c.radius_channel is not None:
        return run.history(f"channel.{c.radius_channel}")
    assert c.reach is not None
    d = _between(run, c.reach.centre, c.reach.tip)
    return np.asarray(np.linalg.norm(d - np.outer(d @ run.up, run.up), axis=1))


def _between(run: _Run, a: PlaceSection, b: PlaceSection) -> NDArray[np.float64]:
    return run.place(b.body, b.point) - run.place(a.body, a.point)


def _crane_load(run: _Run, c: CraneCriterion) -> _Forces:
    more = 0.0 if c.additional is None else run.newtons(c.additional)
    return _forces(run, {c.load: f"channel.{c.load}"}, c.parts, more)


def _crane(run: _Run, c: CraneCriterion) -> list[CriterionResult]:
    radius, forces = _radius(run, c), _crane_load(run, c)
    (load,) = forces.values.values()
    if len(load) == 1:
        load = np.full(len(radius), load[0])
    low, high = c.curve.radius[0], c.curve.radius[-1]
    capacity = rules.capacity_at(c.curve.radius, [run.newtons(one) for one in c.curve.capacity], radius)
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
            [_Series(c.load, judged, limits)],
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
    if not len(forces.times) and c.radius is not None:  # at rest, at one radius: at no time
        rows[0] = replace(rows[0], time=None, phase="", history=None)
    if c.radius is None:
        beyond = radius.max() - high >= low - radius.min()
        worst = "<=" if beyond else ">="
        limit = high if beyond else low
        words = f"radius within the crane curve, {low:g} m to {high:g} m"
        outside = np.count_nonzero((radius < low) | (radius > high))
        note = f"outside the crane curve at {outside:,} of {len(radius):,} records" if outside else ""
        series = [_Series("", radius, limit)]
        rows.append(run.result(words, "m", series, clauses, side=worst, seen=run.records, note=note))
    if c.hook is not None:
        rows += _leads(run, c)
    return rows


def _leads(run: _Run, c: CraneCriterion) -> list[CriterionResult]:
    """Angles of the falls in the plane of the boom and across it, in the axes of the crane."""
    assert c.reach is not None
    assert c.hook is not None
    if c.fall is None:
        fall = _between(run, c.reach.tip, c.hook)
    else:
        begins, ends = run.parts(c.fall)
        lines = [sign * (ends[k] - begins[k]) for k, sign in parts_to(run.case, c.fall, c.hook.body)]
        fall = np.mean([line / np.linalg.norm(line, axis=1, keepdims=True) for line in lines], axis=0)
    out = _between(run, c.reach.centre, c.reach.tip)
    body = c.reach.centre.body
    up = np.tile(run.up, (len(run.times), 1))
    if body != GROUND:
        up = np.asarray(run.rotations(body).apply(np.array([0.0, 0.0, 1.0])))
    out = out - np.sum(out * up, axis=1, keepdims=True) * up
    length = np.linalg.norm(out, axis=1, keepdims=True)
    if not (length > 0.0).all():
        raise InputError(
            f"criterion {c.name!r}: the tip is on the axis of the crane",
            source=run.case.file,
            expected="a tip beside the axis, which says where the boom points",
        )
    out = out / length
    down = -np.sum(fall * up, axis=1)
    rows = []
    for what, axis, given in (
        ("off-lead, angle of the falls in the plane of the boom", out, c.off_lead),
        ("side-lead, angle of the falls across the plane of the boom", np.cross(up, out), c.side_lead),
    ):
        angle = np.abs(np.arctan2(np.sum(fall * axis, axis=1), down))
        clause = _OF_THE_CASE
        if given is None:
            clause = rules.clause("off-lead and side-lead of cranes at rest")
        series = [_Series("", angle, rules.LEAD if given is None else given)]
        rows.append(run.result(what, "rad", series, (clause,), seen=run.records))
    return rows


def _dynamic_factor(run: _Run, c: DynamicsCriterion) -> list[CriterionResult]:
    name = f"channel.{c.load}"
    load = c.parts * run.history(name, "max")
    static = c.parts * run.at_rest(name) if c.static_load is None else run.newtons(c.static_load)
    if not static > 0.0:
        raise InputError(
            f"criterion {c.name!r}: {c.load!r} has no load at rest",
            source=run.case.file,
            expected="'static_at' when it carries, or 'static_load'",
        )
    factors: tuple[Factor, ...] = (Factor("DAF", None, _IN_RUN),)
    clause = _OF_THE_CASE
    limit = c.maximum
    if limit is None:
        if run.g == 0.0:
            raise InputError(
                f"criterion {c.name!r}: no weight without gravity",
                source=run.case.file,
                expected="[gravity], or 'maximum'",
            )
        try:
            limit = rules.table_factor(static / run.g, c.operation)
        except InputError as error:
            raise InputError(
                f"criterion {c.name!r}: {error.problem}", source=run.case.file, expected=error.expected
            ) from None
        clause = rules.clause("dynamic amplification in air")
        factors = (*factors, Factor(f"DAF of the table, {c.operation},", limit, "not applied"))
    return [
        run.result(
            "largest load over load at rest",
            "1",
            [_Series(c.load, load / static, limit)],
            (clause,),
            factors=factors,
            seen=run.seen([name], "max"),
            note=f"load at rest {static / 1000.0:.6g} kN",
        )
    ]


def _clearance(run: _Run, c: ClearanceCriterion) -> list[CriterionResult]:
    limit, clause = c.minimum, _OF_THE_CASE
    if limit is None:
        assert c.place is not None
        limit, name = rules.CLEARANCES[c.place]
        clause = rules.clause(name)
    text = f"channel.{c.distance}"
    quantity = run.case.quantity(f"{text}.min")
    channels = {
        where or c.distance: member.removesuffix(".min")
        for where, member in quantity.members or (("", f"{text}.min"),)
    }
    return [
        run.result(
            "smallest distance" + (f", {c.place.replace('_', ' ')}" if c.place else ""),
            "m",
            [_Series(where, run.history(name, "min"), limit) for where, name in channels.items()],
            (clause,),
            side=">=",
            seen=run.seen(list(channels.values()), "min"),
        )
    ]


def _tilt(run: _Run, c: TiltCriterion) -> list[CriterionResult]:
    axis = np.array(c.axis, dtype=np.float64)
    axes = np.asarray(run.rotations(c.body).apply(axis / np.linalg.norm(axis)))
    angle = np.arctan2(np.linalg.norm(np.cross(axes, run.up), axis=1), axes @ run.up)
    clause = _OF_THE_CASE
    return [
        run.result(
            "angle to the vertical", "rad", [_Series(c.body, angle, c.maximum)], (clause,), seen=run.records
        )
    ]


def _slack(run: _Run, c: SlackCriterion) -> list[CriterionResult]:
    channels = _tensions(run, c.ropes, least=True)
    tensions = {rope: run.history(name, "min") for rope, name in channels.items()}
    seen = run.seen(list(channels.values()), "min")
    result = run.result(
        "smallest tension",
        "N",
        [_Series(rope, values, c.minimum) for rope, values in tensions.items()],
        (run.default("minimum", Clause("no slack", "assumption")),),
        side=">",
        seen=seen,
    )
    if not result.passed and len(run.times) > 1:
        slack = tensions[result.where] <= c.minimum
        duration = float(np.sum(run.steps[slack[1:]]))
        result = replace(result, note=f"for {duration:.4g} s by records")
    rows = [result]
    if c.static_at is not None:
        series = []
        for rope, values in tensions.items():
            static = run.at_rest(channels[rope])
            if not static > 0.0:
                raise InputError(
                    f"criterion {c.name!r}: {rope!r} has no tension at rest",
                    source=run.case.file,
                    expected="'static_at' when it carries",
                )
            series.append(_Series(rope, 1.0 - values / static, c.dynamic_share))
        clause = run.default("dynamic_share", rules.clause("slack slings"))
        what = "part of the tension at rest that dynamics take away"
        rows.append(run.result(what, "1", series, (clause,), seen=seen))
    return rows


_NOT_AT_ITS_END = 1.0 - 1e-9
"""Share of what tyres that slip and their motors have from which on they are at their end."""


def _transport(run: _Run, c: TransportCriterion) -> list[CriterionResult]:
    name = c.transporter
    transporter: Any = next(one for one in run.case.transporters if one.name == name)
    never = np.empty(0)
    rows = []
    assumed = {
        "static_tipping": "7 deg on rigid groups",
        "tipping": "2 deg with what groups give way",
        "group_share": "all groups carry",
        "stroke_reserve": "within the strokes",
        "drive_share": "0.8 of the drives",
        "traction_share": "friction of driven bogies",
        "brake_share": "brakes hold",
    }
    clauses = {key: (run.default(key, Clause(words, "assumption")),) for key, words in assumed.items()}
    for key, item, what in (
        ("static_tipping", "static", "tilt at which it tips over, rigid groups"),
        ("tipping", "compliant", "tilt at which it tips over, groups that give way"),
    ):
        if name in run.results.metadata.get("tipping", {}):
            value = np.array([run.quantities.number(f"tipping.{name}.{item}")])
            series = [_Series(name, value, getattr(c, key))]
            rows.append(run.result(what, "rad", series, clauses[key], side=">=", times=never))
    share = run.history(f"channel.{name}.least_share")
    what = "smallest load of a group over that of all"
    series = [_Series(name, share, c.group_share)]
    rows.append(run.result(what, "1", series, clauses["group_share"], side=">", seen=run.records))
    if transporter.stroke_limits is not None:
        low, high = transporter.stroke_limits
        channel = f"channel.{name}.stroke"
        series = [
            _Series("up", run.history(f"{channel}_max", "max"), high - c.stroke_reserve),
            _Series("down", -run.history(f"{channel}_min", "min"), -low - c.stroke_reserve),
        ]
        seen = run.seen([f"{channel}_max"], "max")
        rows.append(run.result("stroke of a bogie", "m", series, clauses["stroke_reserve"], seen=seen))
    if math.isfinite(transporter.load_limit or math.inf):
        channel = f"channel.{name}.load_max"
        series = [_Series(name, run.history(channel, "max"), transporter.load_limit)]
        seen = run.seen([channel], "max")
        rows.append(run.result("load of a bogie", "N", series, (_OF_THE_CASE,), seen=seen))
    drive = transporter.drive
    used = {} if drive is None else {"traction": "force of a driven bogie over what friction allows"}
    if drive is not None and len(drive.speeds):
        used["drive"] = "force of a driven bogie over what its drive can"
    if drive is not None and math.isfinite(drive.brake_force or math.inf):
        used["brake"] = "force of a driven bogie at rest over what its brakes hold"
    for key, what in used.items():
        channel, limit = f"channel.{name}.{key}_used_max", getattr(c, f"{key}_share")
        if transporter.tyres is not None:
            limit = min(
                limit, _NOT_AT_ITS_END
            )  # then nothing is asked for more than there is: it slides at 1
        series = [_Series(name, run.history(channel, "max"), limit)]
        rows.append(run.result(what, "1", series, clauses[f"{key}_share"], seen=run.seen([channel], "max")))
    return rows


def _limit(run: _Run, c: LimitCriterion) -> list[CriterionResult]:
    quantity = run.case.quantity(c.quantity)
    side, limit = ("<=", c.maximum) if c.maximum is not None else (">=", c.minimum)
    assert limit is not None
    members = quantity.members or (("", c.quantity),)
    family = run.case.quantity(members[0][1]).family
    statistic = c.quantity.rpartition(".")[2] if family in {"channel", "stress"} else ""
    clause = _OF_THE_CASE
    series, times, notes = [], np.empty(0), list[str]()
    for where, text in members:
        name = text.removesuffix(f".{statistic}")
        if statistic in {"max", "min", "absolute"}:
            values, times = run.history(name, statistic), run.times
        elif statistic:
            values = np.array([run.quantities.statistic(statistic, run.history(name), run.times)])
        else:
            values = np.array([run.quantities.number(text)])
        if statistic in {"max", "min", "absolute"} and (statistic != "min") != (side == "<="):
            # the largest value of all must exceed a limit, not every value
            extreme = values.argmin() if statistic == "min" else values.argmax()
            values, times = values[[extreme]], np.empty(0)
        series.append(_Series(where, values, limit))
        if statistic == ("max" if side == "<=" else "min"):
            notes.append(_beyond(run.history(name, "min" if side == "<=" else "max"), side, limit, where))
    seen = (
        run.seen([text.removesuffix(f".{statistic}") for _, text in members], statistic) if len(times) else ""
    )
    note = next(filter(None, notes), "")
    unit = quantity.kind.unit
    return [run.result(c.quantity, unit, series, (clause,), side=side, seen=seen, times=times, note=note)]


def _beyond(values: NDArray[np.float64], side: str, limit: float, where: str) -> str:
    """That values within a limit are beyond the same amount on the other side of zero; empty if they are not."""
    sign = 1.0 if side == "<=" else -1.0
    worst = float(values.min() if side == "<=" else values.max())
    if sign * limit <= 0.0 or sign * worst >= -abs(limit):
        return ""
    whose = f"{where}: " if where else ""
    what = "smallest" if side == "<=" else "largest"
    return f"{whose}the {what} is {worst:.6g}, beyond the same amount; 'absolute' judges both sides"


_EVALUATED: dict[type, Callable[[_Run, Any], list[CriterionResult]]] = {
    ClearanceCriterion: _clearance,
    CraneCriterion: _crane,
    DynamicsCriterion: _dynamic_factor,
    LimitCriterion: _limit,
    LugCriterion: _lug,
    ShackleCriterion: _shackle,
    SlackCriterion: _slack,
    SlingAngleCriterion: _sling_angle,
    SlingCriterion: _sling,
    TiltCriterion: _tilt,
    TransportCriterion: _transport,
}


def evaluate_criteria(case: Case, out: Path, results: Results | None = None) -> list[CriterionResult]:
    """Evaluate every criterion of a case from the files of its stages: one line or more each, in their order.

    Parameters
    ----------
    case
        The case.
    out
        Its output folder.
    results
        Its records, if they have been read.

    Raises
    ------
    InputErrors
        Every criterion that cannot be evaluated.
    """
    quantities = Quantities(case, out)
    if results is not None:
        quantities.__dict__["results"] = results
    found: list[CriterionResult] = []
    errors: list[InputError] = []
    for criterion in case.criteria:
        try:
            found += evaluate_criterion(case, quantities, criterion)
        except InputErrors as error:
            errors += error.errors
        except InputError as error:
            errors.append(error)
    if errors:
        raise InputErrors(errors)
    return found


def evaluate_criterion(case: Case, quantities: Quantities, criterion: Criterion) -> list[CriterionResult]:
    """Lines of one criterion."""
    found = _EVALUATED[type(criterion)](_Run(case, quantities, criterion), criterion)
    inner = ropes_over_pulleys(case, getattr(criterion, "quantity", getattr(criterion, "load", "")))
    if not inner:
        return found
    words = "; ".join(
        f"the tension of {name!r} is that of the rope over its pulleys, its lines have {name}.segment_tension"
        for name in inner
    )
    return [
        replace(one, note="; ".join(filter(None, (one.note, words))), warns=one.warns or one.passed)
        for one in found
    ]


def crane_points(case: Case, quantities: Quantities, criterion: CraneCriterion) -> CranePoints:
    """Radius and load of a crane at all records, and its curve in newtons."""
    run = _Run(case, quantities, criterion)
    (load,) = _crane_load(run, criterion).values.values()
    return CranePoints(
        run.times,
        _radius(run, criterion),
        np.broadcast_to(load, run.times.shape),
        tuple(run.newtons(one) for one in criterion.curve.capacity),
    )
