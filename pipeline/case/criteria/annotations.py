"""Values of keys that several kinds of criteria have: ratings, moments, channels, names of ropes and lugs."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import contextlib
from typing import Annotated, Any, NamedTuple

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, parse_quantity
from heavylift.pipeline.case.fields import CaseContext, Quantity, quantity_schema, reject
from heavylift.pipeline.case.quantity_names import (
    channel_members,
    parse_quantity_name,
    single_components,
)

__all__ = [
    "Angle",
    "FactorValue",
    "Force",
    "Lugs",
    "Moment",
    "OneChannel",
    "Rated",
    "Rating",
    "Ropes",
    "Time",
]


class Rating(NamedTuple):
    """What something may carry, or weighs, as it was given."""

    value: float
    """[N], or [kg] of a mass."""
    is_mass: bool
    """Whether it is multiplied by the gravity of the case."""


class _Rated:
    """Annotation of a force, or of a mass whose weight is meant; validates to a `Rating`."""

    def parse(self, value: object) -> Rating:
        """A rating from a number in N, or a string with a unit of force or mass."""
        if isinstance(value, Rating):
            return value
        expected = "a force or a mass > 0, e.g. '850 kN' or '85 t'"
        kind = "force"
        if isinstance(value, str):
            with contextlib.suppress(InputError):
                parse_quantity(value, KINDS["mass"])
                kind = "mass"
            with contextlib.suppress(InputError):
                parse_quantity(value, KINDS["force"])
                kind = "force"
        try:
            number = parse_quantity(value, KINDS[kind])
        except InputError as error:
            reject(error.problem, expected)
        if number <= 0.0:
            reject(f"{value!r} is too small", expected)
        return Rating(number, kind == "mass")

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, _handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        words = "force: number in N, or a string with a unit of force or mass"
        return quantity_schema(words, exclusiveMinimum=0.0)


class _Moment:
    """Annotation of when something is at rest: a word or a time [s]."""

    WORDS = ("start", "end", "mean")

    def parse(self, value: object) -> str | float:
        """A word, or a time in SI."""
        if value in self.WORDS:
            return str(value)
        try:
            return Quantity("time", minimum=0.0, closed=True).parse(value)
        except InputError as error:
            reject(error.problem, "'start', 'end', 'mean', or a time within the run, e.g. '30 s'")

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, _handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [{"type": "number", "minimum": 0.0}, {"type": "string"}]}


class OneChannel:
    """Annotation of a channel, or of a combination, that is one number of a kind: ``"sum(fall_*.tension)"``."""

    def __init__(self, kind: str, *, group: bool = False) -> None:
        self.kind, self.group = kind, group

    def check(self, name: str, info: ValidationInfo) -> str:
        """The name, if it is recorded, has one component and the wanted unit."""
        context = CaseContext.of(info)
        names = None if context is None else context.names
        try:
            quantity = parse_quantity_name(f"channel.{name}.end", names)
        except InputError as error:
            reject(
                error.problem.replace("quantity 'channel.", "channel '").replace(".end'", "'"), self._expected
            )
        wanted = KINDS[self.kind]
        if quantity.kind.dimension != wanted.dimension:
            reject(f"{name!r} is in {quantity.kind.unit}, no {self.kind}", self._expected)
        if names is None:
            return name
        if quantity.owner and quantity.owner not in names.names:
            reject(
                f"{name!r} names {quantity.owner!r}, which does not exist",
                f"one of: {', '.join(names.names)}",
            )
        if quantity.members and not self.group:
            count = len(quantity.members)
            reject(f"{name!r} is of {count} items", f"one number, e.g. 'sum({name})'")
        components = None if quantity.component else single_components(quantity.item, names)
        if not quantity.members and components is not None and len(components) > 1:
            reject(f"{name!r} has {len(components)} components", f"one of them: {', '.join(components)}")
        return name

    @property
    def _expected(self) -> str:
        unit = KINDS[self.kind].unit
        return f"a recorded channel in {unit}, OWNER.CHANNEL[.COMPONENT], or a combination of such channels"

    def __get_pydantic_core_schema__(self, _source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_after_validator_function(self.check, handler(str))


class _Owners:
    """Annotation of names, and patterns of names, of what has a channel; validates to all that they stand for."""

    def __init__(self, one: str, channel: str, lacks: str) -> None:
        self.one, self.channel, self.lacks = one, channel, lacks

    def check(self, given: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        """Each name once."""
        context = CaseContext.of(info)
        if context is None:
            return given
        found: list[str] = []
        for index, pattern in enumerate(given):
            try:
                members = channel_members(f"{pattern}.{self.channel}", context.names)
                for member in members:
                    parse_quantity_name(f"channel.{member}.max", context.names)
                    if member.partition(".")[0] not in context.names.names:
                        raise InputError(f"{pattern!r} does not exist", expected=f"a {self.one}")  # noqa: TRY301
            except InputError as error:
                problem = error.problem if "exist" in error.problem else f"{pattern!r} {self.lacks}"
                owners = [name for name, own in context.names.channels.items() if self.channel in own]
                reject(
                    problem if "no name fits" not in error.problem else f"no {self.one} fits {pattern!r}",
                    f"{self.one}s or patterns of {self.one}s: {', '.join(owners[:20]) or 'the case has none'}",
                    key=str(index),
                )
            found += [member.partition(".")[0] for member in members]
        return tuple(dict.fromkeys(found))

    def __get_pydantic_core_schema__(self, _source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_after_validator_function(self.check, handler(_source))


Ropes = Annotated[tuple[str, ...], Field(min_length=1), _Owners("rope", "tension", "has no tension")]
"""Names of ropes, and of what else has a tension, and patterns; validates to all that they stand for."""
Lugs = Annotated[tuple[str, ...], Field(min_length=1), _Owners("lug", "out_of_plane", "is no lug")]
"""Names of lugs and patterns; validates to all that they stand for."""
Rated = Annotated[Rating, _Rated()]
Moment = Annotated[str | float, _Moment()]
FactorValue = Annotated[float, Quantity("number", minimum=1.0, closed=True)]
Angle = Annotated[float, Quantity("angle", minimum=0.0, maximum=1.5707963267948966)]
Time = Annotated[float, Quantity("time", minimum=0.0, closed=True)]
Force = Annotated[str, OneChannel("force")]
