"""The table of a case file that says how an operation runs: phases, what they do, what they wait for."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field, replace
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationInfo, field_validator, model_validator

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Dimension, Kind, parse_quantity
from heavylift.pipeline.case.actions import ActionSection, Names, Value
from heavylift.pipeline.case.channel_kinds import Declared
from heavylift.pipeline.case.channel_names import combination_of, is_pattern, split_name
from heavylift.pipeline.case.fields import CaseContext, Name, Positive, Quantity, Section, reject
from heavylift.pipeline.case.quantity_names import (
    ACROSS,
    QuantityName,
    channel_members,
    parse_quantity_name,
    single_components,
)
from heavylift.solver.scene.actions import Action, Targets
from heavylift.solver.scene.operations import MOVES
from heavylift.solver.scene.scenario import Condition, Limit, Phase, Scenario, Track
from heavylift.solver.scene.signals import Signal, Term

__all__ = ["Known", "ScenarioSection", "key_as_given", "scenario_of"]

TAUT = 1.0
"""Tension from which on a rope counts as taut by default [N]."""


@dataclass(frozen=True, kw_only=True)
class Known(Targets):
    """What a case has that a scenario can name.

    Attributes
    ----------
    names
        What it declares.
    girders
        By trolley of a gantry crane: its girder, and how far it may go from the middle of that [m].
    """

    names: Declared
    girders: Mapping[str, tuple[str, float]] = field(default_factory=dict)


_EXAMPLE = "a channel or a sum of channels, e.g. 'load.position.z' or 'sum(fall_*.tension)'"


def _parsed(text: str, names: Declared | None) -> QuantityName:
    """A channel with its component, and its kind.

    Raises
    ------
    InputError
        If there is no such channel, or it is not one number.
    """
    whole = f"channel.{text}.end"
    try:
        quantity = parse_quantity_name(whole, names)
    except InputError as error:
        problem = error.problem.replace(f"quantity {whole!r}", repr(text)).replace(whole, text)
        expected = _EXAMPLE if "STATISTIC" in error.expected else error.expected
        raise InputError(problem, expected=expected) from None
    if quantity.members or is_pattern(split_name(text)[0].partition("(")[0]):
        raise InputError(f"{text!r} stands for several channels", expected="one, or the sum of all: sum(...)")
    if names is not None and quantity.owner and quantity.owner not in names.names:
        raise InputError(
            f"{text!r} names {quantity.owner!r}, which does not exist",
            expected=f"one of: {', '.join(names.names)}",
        )
    if names is not None and not quantity.component:
        components = single_components(quantity.item, names)
        if components is not None and len(components) > 1:
            raise InputError(
                f"{text!r} has {len(components)} components",
                expected=f"one of them: {', '.join(components)}; or {', '.join(ACROSS)}",
            )
    return quantity


def _terms(text: str, weight: float, names: Declared) -> Iterator[Term]:
    """What a channel, or a sum or difference of some, is made of."""
    first, *rest = split_name(text)
    combination = combination_of(first)
    if combination is None:
        for member in channel_members(text, names) if is_pattern(first) else (text,):
            quantity = _parsed(member, names)
            yield Term(quantity.item, quantity.component, weight)
        return
    if combination.function == "ratio":
        raise InputError(f"{text!r} is a ratio", expected="sums and differences of channels")
    for number, term in enumerate(combination.terms):
        sign = -1.0 if combination.function == "difference" and number else 1.0
        yield from _terms(".".join([term, *rest]), sign * weight, names)


def _signal(text: str, names: Declared) -> Signal:
    """What is looked at.

    Raises
    ------
    InputError
        If there is no such channel, or it is not one number.
    """
    quantity = _parsed(text, names)
    component = quantity.component
    if "(" not in text and component in ACROSS:
        function: Any = component
        return Signal((Term(quantity.item),), function, text)
    return Signal(tuple(_terms(text, 1.0, names)), "sum", text)


def _known_signal(text: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    try:
        if context is None:
            _parsed(text, None)
        else:
            _signal(text, context.names)
    except InputError as error:
        reject(error.problem, error.expected)
    return text


SignalName = Annotated[str, AfterValidator(_known_signal)]
"""Name of a number that is recorded."""


def _kind(info: ValidationInfo) -> Kind | None:
    """Kind of the quantity of a section; None if that is wrong or absent."""
    name, context = info.data.get("quantity"), CaseContext.of(info)
    return None if name is None else _parsed(name, None if context is None else context.names).kind


def _share_of_weight(value: Any) -> float | None:
    """A part of a weight, ``"0.9 W"``; None of what is none."""
    if not isinstance(value, str) or not value.strip().endswith(" W"):
        return None
    return parse_quantity(value.strip()[:-2], Kind("number", "1", Dimension()))


class _Comparison(Section):
    """A quantity and a value."""

    @field_validator("above", "below", mode="before", check_fields=False)
    @classmethod
    def _has_the_unit_of_the_quantity(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        kind = _kind(info)
        share = _share_of_weight(value)
        if info.data.get("of"):
            if share is None or (kind is not None and kind.name != "force"):
                reject(
                    f"{value!r} with 'of'",
                    "a force, and a part of the weight of these bodies such as '0.9 W'",
                )
            return share
        if share is not None and kind is not None and kind.name == "force":
            reject(f"{value!r} without 'of'", "'of', the bodies of whose weight it is a part; or a force")
        if info.data.get("taut") or info.data.get("slack"):
            return Quantity("force").parse(value)
        return 0.0 if kind is None else Quantity(kind.name).parse(value)


class ConditionSection(_Comparison):
    """Something that becomes true."""

    quantity: SignalName | None = None
    """What is looked at: ``OWNER.CHANNEL``, ``OWNER.CHANNEL.COMPONENT``, or sums and differences of such."""
    of: Names | None = None
    """Names of bodies: the values are parts of their weight then, ``"0.9 W"``."""
    taut: Names | None = None
    """In place of a quantity: all these ropes are taut, their tensions `above` 1 N or what is given."""
    slack: Names | None = None
    """In place of a quantity: all these ropes are slack, their tensions `below` 1 N or what is given."""
    above: Value | None = None
    """True from this value on upwards; in the unit of the quantity."""
    below: Value | None = None
    """True from this value on downwards."""
    time: Annotated[float, Positive("time")] | None = None
    """In place of a quantity: time since the phase began [s]."""
    arrived: Names | None = None
    """In place of a quantity: all these are at rest at their commanded positions: ropes, hooks, tanks, drives."""
    user: Literal["continue"] | None = None
    """In place of a quantity: the operator sends this during the run, ``heavylift scenario CASE --send continue``."""
    hold: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """How long it has to be true without a break [s]."""

    @model_validator(mode="after")
    def _is_one_condition(self) -> "ConditionSection":
        _one_condition(self)
        return self

    def made(self, known: Known) -> Condition:
        """For the solver."""
        if self.time is not None:
            return Condition(None, self.time, hold=self.hold)
        if self.user is not None:
            return Condition(Signal((), "told"), 0.5, hold=self.hold)
        if self.arrived is not None:
            hooks = {name: known.rope_of(name) for name in known.hooks}
            every = [*known.ropes, *hooks, *known.tanks, *known.drives, *known.paths]
            fits = known.fitting(
                "arrived", self.arrived, every, "rope, hook, tank, drive or transporter on a path"
            )
            terms = tuple(Term(name) for name in dict.fromkeys(hooks.get(name, name) for name in fits))
            return Condition(
                Signal(terms, "arrived", f"arrived: {', '.join(self.arrived)}"), 0.0, hold=self.hold
            )
        for word, function in (("taut", "smallest"), ("slack", "largest")):
            patterns = getattr(self, word)
            if patterns is not None:
                own = known.names.channels
                ropes = known.fitting(
                    word, patterns, [name for name in own if "tension" in own[name]], "rope"
                )
                lines = [
                    name for name in ropes if "stopped_time" in own[name]
                ]  # each of which is one of them
                terms = tuple(Term(f"{name}.tension") for name in ropes)
                terms += tuple(Term(f"{name}.segment_tension") for name in lines)
                signal = Signal(terms, function, f"{function}({', '.join(patterns)}).tension")  # type: ignore[arg-type]
                given = self.above if word == "taut" else self.below
                return Condition(signal, TAUT if given is None else given, word == "slack", self.hold)
        assert self.quantity is not None
        value = self.above if self.below is None else self.below
        assert value is not None
        signal = _signal(self.quantity, known.names)
        return Condition(signal, value, self.below is not None, self.hold, _bodies(self.of, known))


def _bodies(patterns: Iterable[str] | None, known: Known) -> tuple[str, ...]:
    """Names of bodies."""
    return (
        () if patterns is None else tuple(known.fitting("of", patterns, sorted(known.names.bodies), "body"))
    )


_SUBJECTS = ("quantity", "taut", "slack", "time", "arrived", "user")


def _one_condition(spec: Any) -> None:
    """One thing to look at, with the values that it takes."""
    subjects = [key for key in _SUBJECTS if getattr(spec, key) is not None]
    if len(subjects) != 1:
        problem = f"{subjects[0]!r} beside another condition" if subjects else "neither 'quantity' nor 'time'"
        key = "time" if "time" in subjects else subjects[-1] if subjects else ""
        reject(
            problem,
            "'all' or 'any' of two conditions" if subjects else f"one of them, or of {', '.join(_SUBJECTS)}",
            key=key,
        )
    given = [key for key in ("above", "below") if getattr(spec, key) is not None]
    takes = {"quantity": {"above", "below"}, "taut": {"above"}, "slack": {"below"}}.get(subjects[0], set())
    odd = [key for key in given if key not in takes]
    if odd:
        reject(
            f"{odd[0]!r} beside {subjects[0]!r}", f"{' or '.join(sorted(takes)) or 'no value'}", key=odd[0]
        )
    if subjects[0] == "quantity" and len(given) != 1:
        reject("both 'above' and 'below'" if given else "neither 'above' nor 'below'", "one of them")
    if spec.of is not None and subjects[0] != "quantity":
        reject(f"'of' beside {subjects[0]!r}", "a quantity", key="of")


class UntilSection(ConditionSection):
    """When a phase ends: a condition, or several."""

    all: tuple[ConditionSection, ...] = ()
    """In place of one condition: all of these, together."""
    any: tuple[ConditionSection, ...] = ()
    """In place of one condition: any of these."""

    @model_validator(mode="after")
    def _is_one_condition(self) -> "UntilSection":
        if not self.all and not self.any:
            _one_condition(self)
        elif (self.all and self.any) or self.model_fields_set - {"all", "any"}:
            reject("several types of conditions", "'all', 'any', or the keys of one condition")
        return self

    def conditions(self, known: Known) -> tuple[Condition, ...]:
        """For the solver."""
        return tuple(one.made(known) for one in (self.all or self.any)) or (self.made(known),)


class LimitSection(_Comparison):
    """What has to be so while a phase lasts."""

    quantity: SignalName
    """What is looked at, as of a condition."""
    of: Names | None = None
    """Names of bodies: the value is a part of their weight then, ``"1.1 W"``."""
    above: Value | None = None
    """It has to be above this value; in the unit of the quantity."""
    below: Value | None = None
    """It has to be below this value."""
    otherwise: Literal["stop", "warn"] = "stop"
    """Whether the run ends where the limit is violated, or there is only a warning."""

    @model_validator(mode="after")
    def _has_one_end(self) -> "LimitSection":
        if (self.above is None) == (self.below is None):
            both = self.above is not None
            reject("both 'above' and 'below'" if both else "neither 'above' nor 'below'", "one of them")
        return self

    def made(self, known: Known) -> Limit:
        """For the solver."""
        value = self.above if self.below is None else self.below
        assert value is not None
        signal, stop = _signal(self.quantity, known.names), self.otherwise == "stop"
        return Limit(signal, value, self.below is not None, stop, _bodies(self.of, known))


class TimeoutSection(Section):
    """When a phase takes too long."""

    after: Annotated[float, Positive("time")]
    """Time since the phase began [s]."""
    then: Literal["stop"] = "stop"
    """The run ends, and that is no success."""


class PhaseSection(Section):
    """A part of an operation."""

    name: Name
    """Its name."""
    actions: tuple[ActionSection, ...] = ()
    """What happens at its start, in order."""
    until: UntilSection | None = None
    """When it ends; only the last phase may continue to the end of the run."""
    limits: tuple[LimitSection, ...] = ()
    """What is watched while it lasts."""
    timeout: TimeoutSection | None = None
    """When it takes too long."""


class TrackSection(Section):
    """Phases that run in parallel with the others, as of a crane that works independently."""

    name: Name
    """Its name."""
    phases: Annotated[tuple[PhaseSection, ...], Field(min_length=1)]
    """In order."""


class ScenarioSection(Section):
    """Phases of an operation, one after the other."""

    phases: Annotated[tuple[PhaseSection, ...], Field(min_length=1)]
    """In order."""
    tracks: tuple[TrackSection, ...] = ()
    """Sequences of phases that run in parallel with these."""
    prepared: tuple[Name, ...] = ()
    """Names of ropes that are not connected at the start."""
    at_end: Literal["go_on", "stop"] = "go_on"
    """Whether the run continues to its duration when the last phase is done, or stops there."""


def _rows(section: ScenarioSection) -> list[tuple[str, tuple[PhaseSection, ...]]]:
    """Keys of all rows of phases, and the phases."""
    tracks = [(f"tracks.{i}.phases", track.phases) for i, track in enumerate(section.tracks)]
    return [("phases", section.phases), *tracks]


def scenario_of(section: ScenarioSection, known: Known) -> Scenario:
    """The scenario for the solver.

    Parameters
    ----------
    section
        Of the case.
    known
        What the case has.

    Raises
    ------
    InputError
        If a name is that of nothing; the key says where in the scenario.
    """
    rows, group = [], 0
    for key, phases in _rows(section):
        row = []
        for i, phase in enumerate(phases):
            actions: list[Action] = []
            for k, action in enumerate(phase.actions):
                group += 1
                actions += _reported(f"{key}.{i}.actions.{k}", lambda one=action, n=group: one.made(known, n))
            until, place = phase.until, f"{key}.{i}.until"
            conditions = () if until is None else _reported(place, lambda one=until: one.conditions(known))
            limits = [
                _reported(f"{key}.{i}.limits.{k}", lambda one=limit: one.made(known))
                for k, limit in enumerate(phase.limits)
            ]
            row.append(
                Phase(
                    phase.name,
                    tuple(actions),
                    conditions,
                    "any" if until is not None and until.any else "all",
                    tuple(limits),
                    0.0 if phase.timeout is None else phase.timeout.after,
                )
            )
        rows.append(tuple(row))
    ends = _girder_ends(rows, known)
    rows = [tuple(replace(phase, limits=(*phase.limits, *ends)) for phase in row) for row in rows]
    tracks = tuple(Track(spec.name, row) for spec, row in zip(section.tracks, rows[1:], strict=True))
    return Scenario(rows[0], section.prepared, section.at_end == "stop", tracks)


def _girder_ends(rows: Iterable[tuple[Phase, ...]], known: Known) -> list[Limit]:
    """Limits that end a run where a commanded trolley leaves its girder."""
    commands = [action.command() for row in rows for phase in row for action in phase.actions]
    told = [one.name for one in commands if one.actuates == "drive" and one.operation in MOVES]
    found = []
    for trolley in dict.fromkeys(name.removesuffix(".x") for name in told if name.endswith(".x")):
        if trolley in known.girders:
            girder, half = known.girders[trolley]
            terms = (Term(f"{trolley}.position", "x"), Term(f"{girder}.position", "x", -1.0))
            way = Signal(terms, "sum", f"way of {trolley!r} from the middle of its girder")
            slack = 1e-6 * half
            found += [Limit(way, half + slack), Limit(way, -half - slack, below=False)]
    return found


def _reported(key: str, make: Any) -> Any:
    """Result of a function, whose errors are reported at a key."""
    try:
        return make()
    except InputError as error:
        raise InputError(
            error.problem, key=f"{key}.{error.key}".rstrip("."), expected=error.expected
        ) from None


def key_as_given(section: ScenarioSection, known: Known, key: str) -> str:
    """Key in the case of something wrong with an action of the scenario, which may be one of several made from it."""
    found = re.fullmatch(r"(.*phases\.(\d+)\.actions)\.(\d+)(.*)", key)
    if found is None:
        return key
    place, phase, number, rest = found[1], int(found[2]), int(found[3]), found[4]
    phases = dict(_rows(section))[place.rpartition(f".{phase}.actions")[0]]
    for k, action in enumerate(phases[phase].actions):
        count = len(action.made(known, 0))
        if number < count:
            word = rest.removeprefix(".")
            return f"{place}.{k}.{action.kind.CALLED.get(word, word)}".rstrip(".")
        number -= count
    return key
