"""The table of a case file that says how an operation runs: phases, what they do, what they wait for."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationInfo, WithJsonSchema, field_validator, model_validator

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Kind
from heavylift.pipeline.case.channel_kinds import Declared
from heavylift.pipeline.case.channel_names import combination_of, is_pattern, split_name
from heavylift.pipeline.case.fields import (
    CaseContext,
    Name,
    Positive,
    Quantity,
    Section,
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
    Limit,
    Note,
    Phase,
    Release,
    Scenario,
    Signal,
    Term,
    WinchLength,
    WinchSpeed,
)

__all__ = ["ScenarioSection", "scenario_of"]

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


class _Comparison(Section):
    """A quantity and a value."""

    @field_validator("above", "below", mode="before", check_fields=False)
    @classmethod
    def _has_the_unit_of_the_quantity(cls, value: Any, info: ValidationInfo) -> Any:
        kind = _kind(info)
        if value is None or kind is None:
            return None if value is None else 0.0
        return Quantity(kind.name).parse(value)


class ConditionSection(_Comparison):
    """Something that becomes true."""

    quantity: SignalName | None = None
    """What is looked at: ``OWNER.CHANNEL``, ``OWNER.CHANNEL.COMPONENT``, or sums and differences of such."""
    above: Value | None = None
    """True from this value on upwards; in the unit of the quantity."""
    below: Value | None = None
    """True from this value on downwards."""
    time: Annotated[float, Positive("time")] | None = None
    """In place of a quantity: time since the phase began [s]."""
    hold: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """How long it has to be true without a break [s]."""

    @model_validator(mode="after")
    def _is_one_condition(self) -> "ConditionSection":
        _one_condition(self)
        return self

    def made(self, names: Declared) -> Condition:
        """For the solver."""
        if self.time is not None:
            return Condition(None, self.time, hold=self.hold)
        assert self.quantity is not None
        value = self.above if self.below is None else self.below
        assert value is not None
        return Condition(_signal(self.quantity, names), value, self.below is not None, self.hold)


def _one_condition(said: Any) -> None:
    """A time, or a quantity and a value."""
    given = [key for key in ("above", "below") if getattr(said, key) is not None]
    if said.time is not None:
        if said.quantity is not None or given:
            reject("'time' beside another condition", "'all' or 'any' of two conditions", key="time")
    elif said.quantity is None:
        reject("neither 'quantity' nor 'time'", "one of them")
    elif len(given) != 1:
        reject("both 'above' and 'below'" if given else "neither 'above' nor 'below'", "one of them")


class UntilSection(_Comparison):
    """When a phase ends: a condition, or several."""

    quantity: SignalName | None = None
    """What is looked at: ``OWNER.CHANNEL``, ``OWNER.CHANNEL.COMPONENT``, or sums and differences of such."""
    above: Value | None = None
    """True from this value on upwards; in the unit of the quantity."""
    below: Value | None = None
    """True from this value on downwards."""
    time: Annotated[float, Positive("time")] | None = None
    """In place of a quantity: time since the phase began [s]."""
    hold: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """How long it has to be true without a break [s]."""
    all: tuple[ConditionSection, ...] = ()
    """In place of one condition: all of these, together."""
    any: tuple[ConditionSection, ...] = ()
    """In place of one condition: any of these."""

    @model_validator(mode="after")
    def _is_one_sort(self) -> "UntilSection":
        if not self.all and not self.any:
            _one_condition(self)
        elif (
            (self.all and self.any)
            or self.quantity is not None
            or self.time is not None
            or self.hold
            or self.above is not None
            or self.below is not None
        ):
            reject("several sorts of conditions", "'all', 'any', or the keys of one condition")
        return self

    def made(self, names: Declared) -> tuple[Condition, ...]:
        """For the solver."""
        if self.all or self.any:
            return tuple(one.made(names) for one in (self.all or self.any))
        keys = ("quantity", "above", "below", "time", "hold")
        return (ConditionSection.model_construct(**{key: getattr(self, key) for key in keys}).made(names),)


class LimitSection(_Comparison):
    """What has to be so while a phase lasts."""

    quantity: SignalName
    """What is looked at, as of a condition."""
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


class ActionSection(Section):
    """What happens when a phase begins: one of ``winch``, ``release``, ``connect`` and ``note``."""

    winch: Name | None = None
    """Name of the rope whose winch gets another speed, or a length to go to."""
    speed: Annotated[float, Quantity("velocity")] | None = None
    """Speed of the winch [m/s]; hauls in if positive. With a length the largest speed, positive."""
    length: Annotated[float, Positive("length")] | None = None
    """Unstretched length of the rope at which its winch stops [m]."""
    ramp: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time in which the speed changes [s], with a constant acceleration; with a length from rest to the speed."""
    release: Name | None = None
    """Name of a rope that lets go."""
    connect: Name | None = None
    """Name of a rope that holds from now on."""
    slack: Annotated[float, Quantity("length")] = 0.0
    """What the connected rope is longer than its path [m]; shorter by at most 2 % if negative."""
    note: str | None = None
    """Words for the log."""

    @model_validator(mode="after")
    def _is_one_action(self) -> "ActionSection":
        own = {"winch": {"speed", "length", "ramp"}, "release": set(), "connect": {"slack"}, "note": set()}
        given = [key for key in own if getattr(self, key) is not None]
        if len(given) != 1:
            problem = f"{' and '.join(map(repr, given))} in one action" if given else "no action"
            reject(problem, "one of 'winch', 'release', 'connect' and 'note'")
        odd = sorted(self.model_fields_set - {given[0]} - own[given[0]])
        if odd:
            reject(
                f"{odd[0]!r} of {given[0]!r}",
                f"{', '.join(sorted(own[given[0]])) or 'no other key'}",
                key=odd[0],
            )
        if self.winch is not None and self.speed is None:
            reject("a winch without 'speed'", "'speed', and 'length' if it is to stop there", key="speed")
        if self.length is not None and self.speed is not None and not self.speed > 0.0:
            reject(f"{self.speed:g} m/s with a length", "a positive speed: its sense follows", key="speed")
        return self

    def made(self) -> Action:
        """For the solver."""
        if self.winch is not None:
            assert self.speed is not None
            if self.length is None:
                return WinchSpeed(self.winch, self.speed, self.ramp)
            return WinchLength(self.winch, self.length, self.speed, self.ramp)
        if self.release is not None:
            return Release(self.release)
        return Note(self.note or "") if self.connect is None else Connect(self.connect, self.slack)


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


class ScenarioSection(Section):
    """Phases of an operation, one after the other."""

    phases: Annotated[tuple[PhaseSection, ...], Field(min_length=1)]
    """In order."""
    prepared: tuple[Name, ...] = ()
    """Names of ropes that are not connected at the start."""
    at_end: Literal["go_on", "stop"] = "go_on"
    """Whether the run goes on to its duration when the last phase is done, or stops there."""


def scenario_of(section: ScenarioSection, names: Declared) -> Scenario:
    """The scenario for the solver.

    Parameters
    ----------
    section
        Of the case.
    names
        What the case declares.
    """
    phases = []
    for phase in section.phases:
        until = phase.until
        limits = []
        for one in phase.limits:
            value = one.above if one.below is None else one.below
            assert value is not None
            stop = one.otherwise == "stop"
            limits.append(Limit(_signal(one.quantity, names), value, one.below is not None, stop))
        phases.append(
            Phase(
                phase.name,
                tuple(action.made() for action in phase.actions),
                () if until is None else until.made(names),
                "any" if until is not None and until.any else "all",
                tuple(limits),
                0.0 if phase.timeout is None else phase.timeout.after,
            )
        )
    return Scenario(tuple(phases), section.prepared, section.at_end == "stop")
