"""The table of a case file that says how an operation runs: phases, what they do, what they wait for."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from fnmatch import fnmatchcase
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Dimension, Kind, parse_quantity
from heavylift.pipeline.case.channel_kinds import Declared, joint_coordinate
from heavylift.pipeline.case.channel_names import combination_of, is_pattern, split_name
from heavylift.pipeline.case.fields import (
    AnyOf,
    CaseContext,
    Name,
    Positive,
    Quantity,
    Section,
    as_list,
    quantity_schema,
    reject,
)
from heavylift.pipeline.case.quantity_names import (
    ACROSS,
    QuantityName,
    channel_members,
    parse_quantity_name,
    single_components,
)
from heavylift.solver.scene.scenario import (
    Action,
    Condition,
    Connect,
    DriveSpeed,
    DriveTo,
    Fail,
    Limit,
    Note,
    PathGoOn,
    PathSpeed,
    Phase,
    Release,
    ReleaseJoint,
    Restore,
    Scenario,
    Signal,
    TankRate,
    Term,
    Track,
    WinchBrake,
    WinchFollow,
    WinchHaul,
    WinchLength,
    WinchLevel,
    WinchSpeed,
    WinchTension,
)

__all__ = ["Hook", "Known", "ScenarioSection", "key_as_given", "scenario_of"]

TAUT = 1.0
"""Tension from which on a rope counts as taut by default [N]."""


class Hook(NamedTuple):
    """Of some falls: parts of rope that carry the block, and depth of the hook below its sheaves [m]."""

    parts: int
    depth: float


@dataclass(frozen=True)
class Known:
    """What a case has that a scenario can name.

    Attributes
    ----------
    names
        What it declares.
    ropes, tanks, drives
        Names of ropes of type wire, of tanks, and of drives.
    other_ropes
        Names of ropes of other types, which can be told nothing; to say so.
    together
        By drive those that it does not go without: of a gantry crane, whose girder and trolleys are driven each.
    hooks
        Falls by name.
    vehicles
        Names of transporters with a path.
    joints
        Names.
    helpers
        Names of pumps and of levelled transporters, and which of both.
    controllers
        Pumps of each controller by its name.
    girders
        By trolley of a gantry crane: its girder, and how far it may go from the middle of that [m].
    """

    names: Declared
    ropes: tuple[str, ...] = ()
    tanks: tuple[str, ...] = ()
    drives: tuple[str, ...] = ()
    hooks: Mapping[str, Hook] = field(default_factory=dict)
    other_ropes: tuple[str, ...] = ()
    together: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    vehicles: tuple[str, ...] = ()
    girders: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    joints: tuple[str, ...] = ()
    helpers: Mapping[str, Literal["pump", "levelling"]] = field(default_factory=dict)
    controllers: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def machines(self) -> dict[str, list[tuple[str, Any]]]:
        """What may fail, by the names that a user gives it: names and sorts of all that it is."""
        found: dict[str, list[tuple[str, Any]]] = {
            name: [(pump, "pump") for pump in pumps] for name, pumps in self.controllers.items()
        }
        found |= {name: [(name, sort)] for name, sort in self.helpers.items()}
        found |= {name: [(name, "tank")] for name in self.tanks}
        found |= {name: [(name, "drive")] for name in self.drives}
        found |= {name: [(self.rope_of(name), "winch")] for name in self.hooks}
        return found | {name: [(name, "winch")] for name in self.ropes}

    def fitting(self, key: str, patterns: Iterable[str], known: Iterable[str]) -> list[str]:
        """Names that fit some patterns of a key, each once; a name without a pattern stands for itself.

        Raises
        ------
        InputError
            If nothing fits one of them.
        """
        found: dict[str, None] = {}
        known = list(known)
        for pattern in patterns:
            fits = [name for name in known if fnmatchcase(name, pattern)]
            if not fits and _WHAT.get(key, "").startswith("rope") and pattern in self.other_ropes:
                fits = [pattern]
            if not fits:
                near = get_close_matches(pattern, known, 1)
                raise InputError(
                    f"{pattern!r} is no {_WHAT.get(key, key)}"
                    + (f"; did you mean {near[0]!r}?" if near else ""),
                    key=key,
                    expected=f"one of: {', '.join(known) or 'there are none'}",
                )
            found |= dict.fromkeys(fits)
        return list(found)

    def rope_of(self, hook: str) -> str:
        """Rope of some falls."""
        return f"{hook}_rope"


_WHAT = {
    **dict.fromkeys(("winch", "connect", "taut", "slack"), "rope"),
    "release": "rope or joint",
    **dict.fromkeys(
        ("fail", "restore"), "winch, hook, drive, tank, pump, controller or levelled transporter"
    ),
    "of": "body",
    "path": "transporter with 'legs'",
    "arrived": "rope, hook, tank, drive or transporter on a path",
}
"""What a key names, if it is not called so itself."""


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
Value = Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]


def _kind(info: ValidationInfo) -> Kind | None:
    """Kind of the quantity of a section; None if that is wrong or absent."""
    name, context = info.data.get("quantity"), CaseContext.of(info)
    return None if name is None else _parsed(name, None if context is None else context.names).kind


_PATTERN = re.compile(r"[A-Za-z*?\[][A-Za-z0-9_*?!\[\].-]*")


def _pattern(name: str) -> str:
    if not _PATTERN.fullmatch(name) or len(name) > 120:
        reject(f"{name!r} is no name", "a name, or a pattern such as 'fall_*'")
    return name


Names = Annotated[
    tuple[Annotated[str, AfterValidator(_pattern)], ...],
    Field(min_length=1),
    BeforeValidator(as_list),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}, mode="validation"
    ),
]
"""A name, a pattern of names, or several."""

MASS_FLOW = Kind("mass flow", "kg/s", Dimension(0, 1, -1))


class _MassFlow(Quantity):
    """Annotation of a mass per time."""

    @property
    def unit(self) -> str:
        """SI unit."""
        return MASS_FLOW.unit

    def parse(self, value: object) -> float:
        """SI number of an input value."""
        return parse_quantity(value, MASS_FLOW)

    def __get_pydantic_json_schema__(self, _schema: Any, _handler: Any) -> dict[str, Any]:
        return quantity_schema()


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
    """In place of a quantity: all these are at rest where they were told to go: ropes, hooks, tanks, drives."""
    user: Literal["continue"] | None = None
    """In place of a quantity: someone says so while the run goes, ``heavylift scenario CASE --send continue``."""
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
            every = [*known.ropes, *hooks, *known.tanks, *known.drives, *known.vehicles]
            fits = known.fitting("arrived", self.arrived, every)
            terms = tuple(Term(name) for name in dict.fromkeys(hooks.get(name, name) for name in fits))
            return Condition(
                Signal(terms, "arrived", f"arrived: {', '.join(self.arrived)}"), 0.0, hold=self.hold
            )
        for word, function in (("taut", "smallest"), ("slack", "largest")):
            patterns = getattr(self, word)
            if patterns is not None:
                own = known.names.channels
                ropes = known.fitting(word, patterns, [name for name in own if "tension" in own[name]])
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
    return () if patterns is None else tuple(known.fitting("of", patterns, sorted(known.names.bodies)))


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
            reject("several sorts of conditions", "'all', 'any', or the keys of one condition")
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
    """Whether the run ends where it is not so, or that is only told."""

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


_RAMPS = {"ramp", "acceleration", "jerk"}
_OWN = {
    "winch": {
        "speed",
        "length",
        "distance",
        "follow",
        "ratio",
        "tension",
        "brake",
        "level",
        "dead_band",
        *_RAMPS,
    },
    "hook": {"speed", "distance", "height", "brake", "level", "dead_band", *_RAMPS},
    "drive": {"speed", "position", "distance", *_RAMPS},
    "tank": {"rate", "mass"},
    "path": {"speed", "ramp", "acceleration", "planned"},
    "release": set(),
    "fail": set(),
    "restore": set(),
    "connect": {"slack"},
    "note": set(),
}
"""What an action is for, and the keys that belong to it."""
_TELLS = {
    "winch": ("length", "distance", "follow", "tension", "brake", "level"),
    "hook": ("distance", "height", "brake", "level"),
    "drive": ("position", "distance"),
}
"""Keys of which there is one, or else a speed alone."""


def _see_together(drives: Collection[str], known: Known, key: str) -> None:
    """Refuse an action on a part of a crane whose other parts do not go, or stand, with it."""
    for name in drives:
        missing = [other for other in known.together.get(name, ()) if other not in drives]
        if missing:
            raise InputError(
                f"{name!r} without {missing[0]!r}, which travels with it",
                key=key,
                expected=f"one action for all of: {', '.join([name, *known.together[name]])}",
            )


class ActionSection(Section):
    """What happens when a phase begins: what is told to a winch, hook, drive, tank, path; release, connection, note."""

    winch: Names | None = None
    """Ropes whose winches get another speed, or a length to go to, ...: a name, a pattern such as ``"fall_*"``, or a
    list."""
    hook: Names | None = None
    """Falls whose hooks move: their winches haul n times as fast, n the parts of rope."""
    drive: Names | None = None
    """Joints with a drive, or bodies with an axis whose frame is driven or fixed: ``"trolley.x"``, ``"mast.angle"``."""
    tank: Names | None = None
    """Tanks whose pumps run."""
    path: Names | None = None
    """Transporters with `legs`: with a `speed` they go to the end of the leg on which they are, or stop if it is 0."""
    planned: Literal[True] | None = None
    """A transporter goes on: this leg and all others as they are planned."""
    speed: Value | None = None
    """Of winch, hook, drive or transporter [m/s], [rad/s]; hauls in, or hoists, if positive. With a place to go to the
    largest one, as with `tension` and `level`."""
    length: Annotated[float, Positive("length")] | None = None
    """Unstretched length of the rope at which its winch stops [m]."""
    distance: Value | None = None
    """How far it goes [m], [rad], and stops: hauls in or hoists if positive."""
    height: Annotated[float, Quantity("length")] | None = None
    """In the world, at which the hook stops [m]: it goes what it is below that as the phase begins, n parts times in
    rope; what ropes stretch and cranes tilt meanwhile is not made up for."""
    position: Value | None = None
    """Value of the coordinate of the joint, displacement or angle of the frame, where the drive stops [m], [rad]."""
    ramp: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time in which the speed changes [s], with a constant acceleration; with a place to go to from rest to the
    speed."""
    acceleration: Value | None = None
    """In place of `ramp`, of all changes of the speed [m/s^2], [rad/s^2]; of a hook that of the hook."""
    jerk: Value | None = None
    """Of all changes of the acceleration [m/s^3], [rad/s^3]."""
    follow: Name | None = None
    """Rope whose winch this one copies from now on, by length."""
    ratio: Annotated[float, Quantity("number")] = 1.0
    """Length of this rope per length of the one that it follows."""
    tension: Annotated[float, Positive("force")] | None = None
    """Tension that the winch keeps, at most with `speed` [N]: of one with a ``brake`` or ``tensions``."""
    level: bool | None = None
    """Whether these winches, two or more, each with a ``brake`` or ``tensions``, keep equal parts of what they hold, of
    hooks of the load: at most with `speed`, beside whatever they are told."""
    dead_band: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.05
    """Part of `tension`, or of the share of `level`, by which it may be off before the winch moves."""
    brake: bool | None = None
    """Whether the brake is set: the drum rests where it is, until it slips."""
    rate: Annotated[float, _MassFlow("mass flow")] | None = None
    """Of the pump [kg/s]: fills if positive, and stops when the tank is empty."""
    mass: Annotated[float, Quantity("mass", minimum=0.0, closed=True)] | None = None
    """At which the pump stops [kg]; the rate is positive then."""
    release: Names | None = None
    """Ropes and joints that let go."""
    fail: Names | None = None
    """What drives something fails, at once: the winch of a rope or of a hook, a drive, the pump of a tank, a pump of a
    controller, a controller with all its pumps, the levelling of a transporter. Its brake holds it where it is."""
    restore: Names | None = None
    """What has failed works again: it stands until it is told something, or its controller looks."""
    connect: Names | None = None
    """Ropes that hold from now on."""
    slack: Annotated[float, Quantity("length")] = 0.0
    """What a connected rope is longer than its path [m]; shorter by at most 2 % if negative."""
    note: str | None = None
    """Words for the log."""

    @field_validator("speed", "distance", "position", "acceleration", "jerk", mode="before")
    @classmethod
    def _has_the_unit_of_what_moves(cls, value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        travel, angle = _KINDS[str(info.field_name)]
        turns = _turns(info.data.get("drive"), CaseContext.of(info))
        least = 0.0 if info.field_name in {"acceleration", "jerk"} else None
        if turns is None:
            return AnyOf(Quantity(travel, least), Quantity(angle, least)).parse(value)
        return Quantity(angle if turns else travel, least).validate(value)

    @model_validator(mode="after")
    def _is_one_action(self) -> "ActionSection":
        given = [key for key in _OWN if getattr(self, key) is not None]
        if len(given) != 1:
            problem = f"{' and '.join(map(repr, given))} in one action" if given else "no action"
            reject(problem, f"one of {', '.join(map(repr, _OWN))}")
        subject = given[0]
        odd = sorted(self.model_fields_set - {subject} - _OWN[subject])
        if odd:
            reject(
                f"{odd[0]!r} of {subject!r}",
                f"{', '.join(sorted(_OWN[subject])) or 'no other key'}",
                key=odd[0],
            )
        if subject == "tank":
            self._check_pump()
        elif subject == "path":
            self._check_path()
        elif subject in _TELLS:
            self._check_move(subject)
        return self

    def _check_pump(self) -> None:
        if self.rate is None:
            reject("a tank without 'rate'", "'rate' of its pump", key="rate")
        if self.mass is not None and not self.rate > 0.0:
            reject(f"{self.rate:g} kg/s with a mass", "a positive rate: its sense follows", key="rate")

    def _check_path(self) -> None:
        if (self.speed is None) == (self.planned is None):
            problem = "both 'speed' and 'planned'" if self.planned else "a path without 'speed'"
            reject(problem, "'speed', 0 to stop, or 'planned = true' to go on", key="speed")
        if self.planned:
            odd = sorted(self.model_fields_set - {"path", "planned"})
            if odd:
                reject(f"{odd[0]!r} beside 'planned'", "what the legs say", key=odd[0])
        elif self.speed is not None and self.speed < 0.0:
            reject(f"{self.speed:g} m/s", "a speed of 0 or more: it goes along its path", key="speed")
        if self.ramp and self.acceleration is not None:
            reject("both 'ramp' and 'acceleration'", "one of them", key="acceleration")

    def _check_move(self, subject: str) -> None:
        told = [key for key in _TELLS[subject] if getattr(self, key) is not None]
        if len(told) > 1:
            reject(f"both {told[0]!r} and {told[1]!r}", "one of them", key=told[1])
        tells = told[0] if told else ""
        if tells in {"brake", "follow"} or self.level is False:
            odd = sorted(
                self.model_fields_set - {subject, tells} - ({"ratio"} if tells == "follow" else set())
            )
            if odd:
                reject(f"{odd[0]!r} beside {tells!r}", "an action of its own", key=odd[0])
            return
        if self.speed is None:
            more = f"'speed', and one of {', '.join(map(repr, _TELLS[subject]))} if more is meant"
            reject(f"a {subject} without 'speed'", more, key="speed")
        if tells and not self.speed > 0.0:
            unit = "" if subject == "drive" else " m/s"
            reject(f"{self.speed:g}{unit} with a {tells}", "a positive speed: its sense follows", key="speed")
        if "ratio" in self.model_fields_set:
            reject("'ratio' without 'follow'", "'follow', a rope to follow", key="ratio")
        if "dead_band" in self.model_fields_set and tells not in {"tension", "level"}:
            reject("'dead_band' without 'tension' or 'level'", "one of them", key="dead_band")
        ramps = sorted(_RAMPS & self.model_fields_set)
        if ramps and tells in {"tension", "level"}:
            reject(f"{ramps[0]!r} beside {tells!r}", "'speed' alone", key=ramps[0])
        if self.ramp and self.acceleration is not None:
            reject("both 'ramp' and 'acceleration'", "one of them", key="acceleration")
        if self.jerk is not None and self.acceleration is None:
            reject("'jerk' without 'acceleration'", "'acceleration' as well", key="jerk")

    def made(self, known: Known, group: int) -> tuple[Action, ...]:
        """For the solver: one for each thing that is named; `group` is a number of its own.

        Raises
        ------
        InputError
            If a name is that of nothing.
        """
        if self.note is not None:
            return (Note(self.note),)
        if self.release is not None:
            names = known.fitting("release", self.release, [*known.ropes, *known.joints])
            return tuple(ReleaseJoint(name) if name in known.joints else Release(name) for name in names)
        for kind, machines in ((Fail, self.fail), (Restore, self.restore)):
            if machines is not None:
                key = "fail" if kind is Fail else "restore"
                names = known.fitting(key, machines, list(known.machines))
                found = dict.fromkeys(one for name in names for one in known.machines[name])
                _see_together([name for name, sort in found if sort == "drive"], known, key)
                return tuple(kind(*one) for one in found)
        if self.connect is not None:
            return tuple(
                Connect(name, self.slack) for name in known.fitting("connect", self.connect, known.ropes)
            )
        if self.tank is not None:
            assert self.rate is not None
            return tuple(
                TankRate(name, self.rate, self.mass) for name in known.fitting("tank", self.tank, known.tanks)
            )
        limits: dict[str, Any] = {"acceleration": self.acceleration or 0.0, "jerk": self.jerk or 0.0}
        if self.path is not None:
            vehicles = known.fitting("path", self.path, known.vehicles)
            if self.planned:
                return tuple(PathGoOn(name) for name in vehicles)
            assert self.speed is not None
            return tuple(PathSpeed(name, self.speed, self.ramp, **limits) for name in vehicles)
        if self.drive is not None:
            assert self.speed is not None
            place, by = (self.position, False) if self.distance is None else (self.distance, True)
            drives = known.fitting("drive", self.drive, known.drives)
            _see_together(drives, known, "drive")
            if place is None:
                return tuple(DriveSpeed(name, self.speed, self.ramp, **limits) for name in drives)
            return tuple(DriveTo(name, place, self.speed, self.ramp, by, **limits) for name in drives)
        if self.hook is not None:
            hooks = known.fitting("hook", self.hook, known.hooks)
            self._check_group("hook", hooks)
            return tuple(self._of_winch(known.rope_of(one), known.hooks[one], group, one) for one in hooks)
        assert self.winch is not None
        ropes = known.fitting("winch", self.winch, known.ropes)
        self._check_group("winch", ropes)
        return tuple(self._of_winch(rope, Hook(1, 0.0), group, "") for rope in ropes)

    def _check_group(self, key: str, names: list[str]) -> None:
        if self.level and len(names) < 2:
            raise InputError(f"{names[0]!r} alone is level", key=key, expected="two or more")

    def _of_winch(self, rope: str, hook: Hook, group: int, owner: str) -> Action:
        """For a rope that goes n times as fast as its hook."""
        n, speed = hook.parts, self.speed or 0.0
        if self.brake is not None:
            return WinchBrake(rope, self.brake)
        if self.level is not None:
            return WinchLevel(rope, 1.0 / n if self.level else 0.0, n * speed, self.dead_band, group)
        if self.follow is not None:
            return WinchFollow(rope, self.follow, self.ratio)
        if self.tension is not None:
            return WinchTension(rope, self.tension, speed, self.dead_band)
        limits: dict[str, Any] = {
            "acceleration": n * (self.acceleration or 0.0),
            "jerk": n * (self.jerk or 0.0),
        }
        if self.length is not None:
            return WinchLength(rope, self.length, speed, self.ramp, **limits)
        if self.distance is not None:
            return WinchHaul(rope, n * self.distance, n * speed, self.ramp, **limits)
        if self.height is not None:
            place = Signal((Term(f"{owner}_block.position", "z"),))
            return WinchHaul(rope, self.height + hook.depth, n * speed, self.ramp, place, float(n), **limits)
        return WinchSpeed(rope, n * speed, self.ramp, **limits)


_KINDS = {
    "speed": ("velocity", "angular velocity"),
    "distance": ("length", "angle"),
    "position": ("length", "angle"),
    "acceleration": ("acceleration", "angular acceleration"),
    "jerk": ("jerk", "angular jerk"),
}
"""Kinds of what moves along, and of what turns."""


def _turns(drives: Iterable[str] | None, context: CaseContext | None) -> bool | None:
    """Whether some drives turn; None if that is not known. What is no drive moves along."""
    if drives is None:
        return False
    joints = {} if context is None else context.names.joints
    found = set()
    for pattern in drives:
        if "." in pattern:
            found.add(pattern.endswith(".angle"))
            continue
        found |= {
            joint_coordinate(of_type) == "angle"
            for name, of_type in joints.items()
            if fnmatchcase(name, pattern)
        }
    if len(found) == 2:
        reject("drives that turn and drives that move along", "an action for each sort")
    return found.pop() if found else None


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
    """When it ends; only the last phase may go on to the end of the run."""
    limits: tuple[LimitSection, ...] = ()
    """What is watched while it lasts."""
    timeout: TimeoutSection | None = None
    """When it takes too long."""


class TrackSection(Section):
    """Phases that go on beside the others, as of a crane that works by itself."""

    name: Name
    """Its name."""
    phases: Annotated[tuple[PhaseSection, ...], Field(min_length=1)]
    """In order."""


class ScenarioSection(Section):
    """Phases of an operation, one after the other."""

    phases: Annotated[tuple[PhaseSection, ...], Field(min_length=1)]
    """In order."""
    tracks: tuple[TrackSection, ...] = ()
    """Rows of phases that go on beside these."""
    prepared: tuple[Name, ...] = ()
    """Names of ropes that are not connected at the start."""
    at_end: Literal["go_on", "stop"] = "go_on"
    """Whether the run goes on to its duration when the last phase is done, or stops there."""


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
                actions += _told(f"{key}.{i}.actions.{k}", lambda one=action, n=group: one.made(known, n))
            until, place = phase.until, f"{key}.{i}.until"
            conditions = () if until is None else _told(place, lambda one=until: one.conditions(known))
            limits = [
                _told(f"{key}.{i}.limits.{k}", lambda one=limit: one.made(known))
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
    """Limits that end a run where a trolley that is told something leaves its girder."""
    actions = [action for row in rows for phase in row for action in phase.actions]
    told = [action.drive for action in actions if isinstance(action, (DriveSpeed, DriveTo))]
    found = []
    for trolley in dict.fromkeys(name.removesuffix(".x") for name in told if name.endswith(".x")):
        if trolley in known.girders:
            girder, half = known.girders[trolley]
            terms = (Term(f"{trolley}.position", "x"), Term(f"{girder}.position", "x", -1.0))
            way = Signal(terms, "sum", f"way of {trolley!r} from the middle of its girder")
            slack = 1e-6 * half
            found += [Limit(way, half + slack), Limit(way, -half - slack, below=False)]
    return found


def _told(key: str, make: Any) -> Any:
    """What something makes, whose errors are told at a key."""
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
            word = ".hook" if action.hook is not None and rest == ".winch" else rest
            return f"{place}.{k}{word}"
        number -= count
    return key
