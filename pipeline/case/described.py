"""Sections of a case file made from the descriptions of kinds, each when a case first needs it."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import contextlib
import importlib
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import MISSING
from fnmatch import fnmatchcase
from functools import cache, cached_property, reduce
from operator import or_
from types import GenericAlias, UnionType
from typing import Annotated, Any, ClassVar, Literal, Optional, Union, cast, get_args, get_origin

import numpy as np
from annotated_types import Interval
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
    TypeAdapter,
    ValidationInfo,
    WithJsonSchema,
    create_model,
    field_validator,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from heavylift.numerics.hints import unaliased
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import (
    BodyDirection,
    BodyPoint,
    ByCoordinate,
    ByExponent,
    Key,
    Least,
    NameOf,
    PointsFile,
    Quantity,
    Shape,
    Square,
    TableFile,
    WorldDirection,
    quantity_schema,
)
from heavylift.pipeline.case.channel_kinds import has_both, joint_coordinate
from heavylift.pipeline.case.channel_names import is_pattern
from heavylift.pipeline.case.columns import read_table
from heavylift.pipeline.case.fields import (
    BodyName,
    BodyPlace,
    CaseContext,
    Direction,
    InFolder,
    KnownHull,
    LengthVector,
    Section,
    SideName,
    UniqueName,
    parse_list,
    refuse_unknown,
    reject,
)
from heavylift.pipeline.case.interface_names import POINTS
from heavylift.solver.scene.connections import JOINTS, Between
from heavylift.solver.scene.descriptions import (
    DescribedField,
    described_fields,
    is_described,
    owner_coordinate,
    recorded_channels,
)

__all__ = ["BetweenSection", "Chosen", "Later", "checked", "make_section", "section_of"]

Parts = Mapping[Any, Callable[[Quantity], Any]]


class _NamedSection(Section):
    """What everything has that has a name."""

    name: UniqueName
    """Name; the first part of its channels."""


class BetweenSection(_NamedSection):
    """What all have that is between two points."""

    between: tuple[SideName, SideName]
    """Its two sides a and b: names of bodies, or ``"ground"`` for the world."""
    points: tuple[BodyPlace, BodyPlace]
    """One point a side [m] in the coordinates of the geometry of the body, or the name of an interface of it; of the
    ground in the world."""

    DESCRIBED: ClassVar[type[Between]]

    @field_validator("between")
    @classmethod
    def _joins_two(cls, value: tuple[str, str]) -> tuple[str, str]:
        checked(cls.DESCRIBED.check_sides, value)
        return value


def section_of(described: Any, coordinate: str = "") -> type[Section]:
    """Section of a description, with the keys of where the component is; `coordinate` as in `make_section`."""
    return _section_of(described, coordinate)


@cache
def _section_of(described: Any, coordinate: str) -> type[Section]:
    if issubclass(described, Between):
        return make_section(described, BetweenSection)
    named = "name" in described.__dataclass_fields__
    return make_section(described, _NamedSection if named else Section, coordinate=coordinate)


def make_section(
    described: Any,
    base: type[Section],
    parts: Parts | None = None,
    changed: Mapping[str, Any] | None = None,
    optional: Collection[str] = (),
    coordinate: str = "",
) -> type[Section]:
    """Section of a description.

    Parameters
    ----------
    described
        The description; its fields become keys, its ``check`` the last check of the section.
    base
        What the sections of its family have in common.
    parts
        By class of a value that a table of its own describes: the section of that table for a quantity.
    changed
        Keys of the base with another type: type and default by name.
    optional
        Keys of the description that may be left out, because the base has others in their place.
    coordinate
        ``"angle"`` or ``"travel"`` of the table of a function, or the like, of one: what `ByCoordinate` then is.

    Raises
    ------
    TypeError
        If a field hides a key of the base.
    """
    own: dict[str, Any] = {}
    if described.WORD and described.FAMILY.typed:
        default = described.WORD if described.FAMILY.default == described.WORD else ...
        own[described.FAMILY.key] = (Literal[described.WORD], default)
    for field in sorted(described_fields(described), key=lambda field: field.mark(ByExponent) is not None):
        if field.name in base.model_fields or field.name in own:
            raise TypeError(f"{described.__qualname__}.{field.name} hides a key that {base.__name__} has")
        made, default = _annotation(_along(field, coordinate), parts or {}, coordinate), _default(field)
        if key := field.mark(Key):
            default = Field(default, alias=key.word)
        own[field.name] = (made | None, None) if field.name in optional else (made, default)
    own |= changed or {}
    within = base.DESCRIBED.__name__ if hasattr(base, "DESCRIBED") else ""
    made = create_model(
        f"{coordinate.title()}{described.__name__}{within}Section",
        __base__=base,
        __module__=described.__module__,
        __doc__=described.__doc__,
        __validators__={"check": model_validator(mode="after")(_run_check)},  # type: ignore[dict-item]
        **own,
    )
    made.DESCRIBED = described
    if hasattr(described, "CHANNELS") or not base.CHANNELS:
        made.CHANNELS = recorded_channels(described)
    return made


def _along(field: DescribedField, coordinate: str) -> DescribedField:
    """A field whose coordinate is known."""
    marks = (getattr(m, coordinate) if coordinate and isinstance(m, ByCoordinate) else m for m in field.marks)
    return field._replace(marks=tuple(marks))


def _run_check(section: Any) -> Any:
    check = getattr(section.DESCRIBED, "check", None)
    if check is not None:
        checked(check, section)
    return section


def checked(check: Callable[[Any], None], value: Any, key: str = "") -> None:
    """Run a check of a description on what a case file gives; `key` is that of the table, if it is not validated."""
    try:
        check(value)
    except InputError as error:
        reject(error.problem, error.expected, key=".".join(filter(None, (key, error.key))))


def _default(field: DescribedField) -> Any:
    """What a key that is not there stands for in a section."""
    if field.absent:
        return None
    if isinstance(field.default, np.ndarray):
        return tuple(field.default.tolist())
    return ... if field.default is MISSING else field.default


def _annotation(field: DescribedField, parts: Parts, coordinate: str) -> Any:
    """Type of a key of a case file."""
    made = _type(field.hint, field, parts, owner_coordinate(field) or coordinate)
    least = field.mark(Least)
    if least is not None:
        made = Annotated[made, Field(min_length=least.count)]
    if field.absent:
        made = Optional[made]  # noqa: UP045
    power = field.mark(ByExponent)
    if power is not None:
        made = Annotated[made, BeforeValidator(_InItsUnit(power).parse)]
    along = field.mark(ByCoordinate)
    return made if along is None else Annotated[made, BeforeValidator(_InUnitsOfTheJoint(along).parse)]


def _type(hint: Any, field: DescribedField, parts: Parts, coordinate: str) -> Any:
    """Type of a value of a case file; `coordinate` is that of the tables within it."""
    hint = unaliased(hint)
    if get_origin(hint) is Annotated:  # an entry of a list with a meaning of its own
        hint, *marks = get_args(hint)
        field = field._replace(marks=tuple(marks))
    quantity, origin, inner = field.quantity, get_origin(hint), get_args(hint)
    if origin in {Union, UnionType}:
        choices = [_type(kind, field, parts, coordinate) for kind in inner if kind is not type(None)]
        if len(choices) > 1 and any(map(is_described, inner)):
            tags = ("a table" if is_described(kind) else "a number" for kind in inner)
            choices = [Annotated[made, Tag(tag)] for made, tag in zip(choices, tags, strict=True)]
            return Annotated[reduce(or_, choices), Discriminator(_form)]
        if len(choices) > 1 and any(get_origin(unaliased(kind)) is tuple for kind in inner):
            lists = (get_origin(unaliased(kind)) is tuple for kind in inner if kind is not type(None))
            tags = ("a list" if one else "a number" for one in lists)
            choices = [Annotated[made, Tag(tag)] for made, tag in zip(choices, tags, strict=True)]
            return Annotated[reduce(or_, choices), Discriminator(_is_list)]
        made: Any = reduce(or_, choices)
        return Optional[made] if type(None) in inner else made  # noqa: UP045
    if hint in parts:
        return parts[hint](quantity)
    if isinstance(quantity, (WorldDirection, BodyDirection)):
        return Direction
    if isinstance(quantity, BodyPoint):
        if field.mark(Shape) is not None:
            return GenericAlias(tuple, (LengthVector, ...))
        return BodyPlace if field.name in POINTS else LengthVector
    if isinstance(quantity, NameOf):
        if quantity.what in _LISTS:
            return _LISTS[quantity.what]
        name = _NAMES[quantity.what]
        return GenericAlias(tuple, (name, ...)) if origin is tuple else name
    square = field.mark(Square)
    if square is not None:
        return _matrix(square.size, quantity)
    if isinstance(quantity, PointsFile):
        return Annotated[str, InFolder()]
    if isinstance(quantity, TableFile):
        return Annotated[str, InFolder(), AfterValidator(_ReadsTable(quantity).check)]
    if origin is tuple:
        kinds = tuple(part if part is ... else _type(part, field, parts, coordinate) for part in inner)
        return GenericAlias(tuple, kinds)
    if origin is np.ndarray and field.mark(Shape) is not None:
        made = _number(quantity)
        for length in reversed(field.mark(Shape).lengths):
            made = GenericAlias(tuple, (made, ...) if length is None else (made,) * length)
        return made
    if hint in {bool, int}:
        limits = [mark for mark in field.marks if isinstance(mark, Interval)]
        return Annotated[(hint, Field(strict=True), *limits)]
    if origin is Literal:
        return hint
    if is_described(hint):
        return section_of(hint, coordinate)
    if hint is float:
        return _number(quantity)
    known = ", ".join(kind.__name__ for kind in parts)
    raise TypeError(f"{field.name}: {hint}, expected float{', or one of ' * bool(known)}{known}")


def _form(value: Any) -> str:
    return "a table" if isinstance(value, (dict, Section)) else "a number"


def _is_list(value: Any) -> str:
    return "a list" if isinstance(value, (list, tuple)) else "a number"


def _number(quantity: Quantity | ByCoordinate) -> Any:
    if isinstance(quantity, ByCoordinate):
        return Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]
    if isinstance(quantity, ByExponent):
        schema = quantity_schema("number in N/m^exponent", exclusiveMinimum=0.0)
        return Annotated[float, WithJsonSchema(schema, mode="validation")]
    return Annotated[float, quantity]


def _matrix(size: int, quantity: Quantity) -> Any:
    count = {"type": "array", "minItems": size, "maxItems": size}
    row = {**count, "items": quantity_schema()}
    schema = {"anyOf": [row, {**count, "items": row}]}
    rows = tuple[tuple[float, ...], ...]
    return Annotated[rows, BeforeValidator(_Rows(size, quantity).parse), WithJsonSchema(schema)]


class _Rows:
    """Parses a square matrix, which may be given by its diagonal."""

    def __init__(self, size: int, quantity: Quantity) -> None:
        self.size, self.quantity = size, quantity

    def parse(self, value: Any) -> list[list[float]]:
        """Rows in SI."""
        n = self.size
        expected = f"{n} numbers on the diagonal, or {n} rows of {n}"
        if not isinstance(value, (list, tuple)) or len(value) != n:
            reject(f"{value!r}", expected)
        rows = [row for row in value if isinstance(row, (list, tuple))]
        if not rows:
            diagonal = parse_list(self.quantity, value)
            return [[entry if i == k else 0.0 for k in range(n)] for i, entry in enumerate(diagonal)]
        if len(rows) < n or any(len(row) != n for row in rows):
            reject(f"{value!r}", expected)
        return [parse_list(self.quantity, row, f"{i}.") for i, row in enumerate(rows)]


class _InItsUnit:
    """Parses a stiffness whose unit depends on an exponent."""

    def __init__(self, quantity: ByExponent) -> None:
        self.quantity = quantity

    def parse(self, value: Any, info: ValidationInfo) -> Any:
        """A value in SI; one if the exponent is wrong, which is reported already."""
        exponent = self.quantity.exponent or info.data.get("exponent")
        if value is None or exponent is None:
            return None if value is None else 1.0
        try:
            return self.quantity.parse(value, exponent)
        except InputError as error:
            reject(error.problem, error.expected)


class _InUnitsOfTheJoint:
    """Parses what is an angle, or the like, for a joint that turns, and a travel for one that slides."""

    def __init__(self, quantities: ByCoordinate) -> None:
        self.quantities = quantities

    def parse(self, value: Any, info: ValidationInfo) -> Any:
        """A value, or a list of values, in SI; zeros if the joint is not known, whose error is reported already."""
        if value is None or "joint" not in info.data:
            return [] if isinstance(value, list) else 0.0
        context = CaseContext.of(info)
        if context is None:  # no joints are known: either will do
            return [self._either(one) for one in value] if isinstance(value, list) else self._either(value)
        joints = context.names.joints
        kind = joints.get(info.data["joint"], "")
        if has_both(kind) and info.data.get("coordinate") is None:
            reject(
                f"joint {info.data['joint']!r} has an angle and a travel",
                "'coordinate', which selects one of them",
            )
        slides = joint_coordinate(kind, info.data.get("coordinate")) == "travel"
        quantity = self.quantities.travel if slides else self.quantities.angle
        return parse_list(quantity, value) if isinstance(value, list) else quantity.parse(value)

    def _either(self, value: Any) -> float:
        with contextlib.suppress(InputError):
            return self.quantities.angle.parse(value)
        return self.quantities.travel.parse(value)


class _ReadsTable:
    """Refuses a file that is not the table that is wanted."""

    def __init__(self, wanted: TableFile) -> None:
        self.wanted = wanted

    def check(self, name: str, info: ValidationInfo) -> str:
        """The name of the file."""
        context = CaseContext.of(info)
        if context is not None:
            try:
                read_table(context.folder / name, self.wanted)
            except InputError as error:
                where = f"{name}: {error.key}: " if error.key else f"{name}: "
                reject(where + error.problem, error.expected)
        return name


def _turns_or_slides(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context is None:
        return name
    joints = context.names.joints
    refuse_unknown("joint", name, joints)
    described = JOINTS.get(joints[name])
    if described is not None and not described.COORDINATE and not has_both(joints[name]):
        has = "neither an angle nor a travel"
        reject(f"joint {name!r} of type {joints[name]!r} has {has}", "a hinge or a slider")
    return name


def _known_fluid(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context:
        refuse_unknown("wind or current", name, context.names.fluids)
    return name


def _known_rope(name: str, info: ValidationInfo) -> str:
    context = CaseContext.of(info)
    if context:
        refuse_unknown("rope", name, _ropes_of(context))
    return name


def _known_ropes(given: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
    """Names of ropes that names and patterns stand for, each once."""
    context = CaseContext.of(info)
    if context is None:
        return given
    found: list[str] = []
    for index, name in enumerate(given):
        if is_pattern(name):
            fits = [rope for rope in _ropes_of(context) if fnmatchcase(rope, name)]
            if not fits:
                known = ", ".join(_ropes_of(context)[:20])
                reject(f"no rope fits {name!r}", f"ropes of: {known or 'none'}", key=str(index))
            found += fits
        else:
            refuse_unknown("rope", name, _ropes_of(context), key=str(index))
            found.append(name)
    return tuple(dict.fromkeys(found))


def _ropes_of(context: CaseContext) -> list[str]:
    """Names of what has a path along which there are tensions."""
    return [name for name, channels in context.names.channels.items() if "segment_tension" in channels]


_NAMES: Mapping[str, Any] = {
    "body": BodyName,
    "side": SideName,
    "hull": KnownHull,
    "joint": Annotated[str, AfterValidator(_turns_or_slides)],
    "fluid": Annotated[str, AfterValidator(_known_fluid), Field(validate_default=True)],
    "rope": str,  # what it follows is known where all ropes are
    "known rope": Annotated[str, AfterValidator(_known_rope)],
    "tank": str,  # as are tanks, pumps, and what heights are measured from
    "pump": str,
    "datum": str,
}
"""By what a name is the name of."""

_LISTS: Mapping[str, Any] = {"ropes": Annotated[tuple[str, ...], AfterValidator(_known_ropes)]}
"""The same of names that are known as a whole, since a pattern among them stands for several."""


class Chosen:
    """Annotation of a table that a description of a family makes: the one that its key ``type`` names.

    Parameters
    ----------
    family
        Its descriptions.
    section
        Section of a description.
    word
        The description, in place of a key ``type``.
    """

    def __init__(
        self, family: Any, section: Callable[[Any], type[Section]] = section_of, *, word: str = ""
    ) -> None:
        self.family, self.section, self.word = family, section, word

    def validate(self, value: Any, info: ValidationInfo) -> Section:
        """The section of a table."""
        if isinstance(value, Section):
            return value
        if not isinstance(value, dict):
            reject(f"{value!r} is not a table", "a table")
        word, described = self._word(value), self.described(value)
        if described is None:
            known = ", ".join(f"'{word}'" for word in self.family.words)
            key = self.family.key
            reject(f"{key} = {word!r}" if word != "" else f"key {key!r} is missing", f"one of {known}")
        return self.section(described).model_validate(value, context=info.context)

    def _word(self, row: Mapping[str, Any]) -> Any:
        return self.word or row.get(self.family.key, self.family.default)

    def described(self, row: Mapping[str, Any]) -> Any:
        """The description of a table as read from TOML; None if there is none with its word."""
        word = self._word(row)
        return self.family.get(word) if isinstance(word, str) else None

    @property
    def sections(self) -> Iterable[type[Section]]:
        """Those of all descriptions."""
        for word in [self.word] if self.word else self.family.words:
            yield self.section(self.family.get(word))

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        made: Any = reduce(or_, self.sections)
        if self.word:
            return _defined(made, handler)
        chosen: TypeAdapter[Any] = TypeAdapter(
            cast("Any", Annotated[made, Field(discriminator=self.family.key)])
        )
        return handler(chosen.core_schema)


class Later:
    """Annotation of a table whose section is imported when a case has such a table.

    Parameters
    ----------
    module, name
        Where the section is, or the union of some that it may be.
    """

    def __init__(self, module: str, name: str) -> None:
        self.module, self.name = module, name

    @cached_property
    def sections(self) -> Any:
        """The section, or the union."""
        return getattr(importlib.import_module(self.module), self.name)

    @cached_property
    def _adapter(self) -> TypeAdapter[Any]:
        return TypeAdapter(self.sections)

    def validate(self, value: Any, info: ValidationInfo) -> Any:
        """The section of a table."""
        return self._adapter.validate_python(value, context=info.context)

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return _defined(self.sections, handler)


def _defined(sections: Any, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
    """Schema of a section by its definition, which one that is used once would not have."""
    twice: TypeAdapter[Any] = TypeAdapter(cast("Any", tuple[sections, sections]))
    found: JsonSchemaValue = handler(twice.core_schema)["prefixItems"][0]
    return found
