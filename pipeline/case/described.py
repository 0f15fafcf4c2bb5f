"""Sections of a case file made from the descriptions of kinds, each when a case first needs it."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING
from functools import reduce
from operator import or_
from typing import Annotated, Any, Literal, Optional, cast, get_args

from pydantic import (
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    TypeAdapter,
    ValidationInfo,
    create_model,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from heavylift.numerics.quantity import Quantity, WorldDirection
from heavylift.pipeline.case.fields import Direction, Section, reject
from heavylift.solver.scene.descriptions import DescribedField, Family, described_fields

__all__ = ["Chosen", "make_section"]


def make_section(
    described: Any,
    base: type[Section],
    parts: Mapping[Any, Callable[[Quantity], Any]],
    changed: Mapping[str, Any] | None = None,
) -> type[Section]:
    """Section of a description.

    Parameters
    ----------
    described
        The description; its fields become keys.
    base
        What the sections of its family have in common.
    parts
        By class of a value that a table of its own describes: the section of that table for a quantity.
    changed
        Keys of the base with another type: type and default by name.

    Raises
    ------
    TypeError
        If a field hides a key of the base.
    """
    own: dict[str, Any] = {"type": (Literal[described.WORD], ...)}
    for field in described_fields(described):
        if field.name in base.model_fields or field.name in own:
            raise TypeError(f"{described.__qualname__}.{field.name} hides a key that {base.__name__} has")
        own[field.name] = (_annotation(field, parts), ... if field.default is MISSING else field.default)
    own |= changed or {}
    name = "".join(word.capitalize() for word in described.WORD.split("_")) + base.__name__.lstrip("_")
    made = create_model(
        name, __base__=base, __module__=described.__module__, __doc__=described.__doc__, **own
    )
    made.DESCRIBED = described  # type: ignore[attr-defined]
    made.CHANNELS = described.CHANNELS
    return made


def _annotation(field: DescribedField, parts: Mapping[Any, Callable[[Quantity], Any]]) -> Any:
    """Type of a key of a case file."""
    if isinstance(field.quantity, WorldDirection):
        return Direction
    choices = get_args(field.hint) or (field.hint,)
    optional = type(None) in choices
    kinds = [choice for choice in choices if choice is not type(None)]
    if len(kinds) != 1 or (kinds[0] is not float and kinds[0] not in parts):
        raise TypeError(
            f"{field.name}: {field.hint}, expected float, or one of {', '.join(kind.__name__ for kind in parts)}"
        )
    one = kinds[0]
    made = parts[one](field.quantity) if one in parts else Annotated[one, field.quantity]
    return Optional[made] if optional else made  # noqa: UP045


class Chosen:
    """Annotation of a table whose key ``type`` says by which description of a family it is made.

    Parameters
    ----------
    family
        Its descriptions.
    section
        Section of a description.
    others
        Words for tables that stand beside, for the message.
    """

    def __init__(
        self, family: Family[Any], section: Callable[[Any], type[Section]], others: Sequence[str] = ()
    ) -> None:
        self.family, self.section, self.others = family, section, others

    def validate(self, value: Any, info: ValidationInfo) -> Section:
        """The section of a table."""
        if isinstance(value, Section):
            return value
        if not isinstance(value, dict):
            reject(f"{value!r} is not a table", "a table")
        if "type" not in value:
            reject("key 'type' is missing", "the kind of this table")
        word = value["type"]
        described = self.family.get(word) if isinstance(word, str) else None
        if described is None:
            words = (*self.others, *self.family.words)
            reject(f"type = {word!r}", "one of " + ", ".join(f"'{word}'" for word in words))
        return self.section(described).model_validate(value, context=info.context)

    @property
    def sections(self) -> Iterable[type[Section]]:
        """Those of all descriptions."""
        for word in self.family.words:
            yield self.section(self.family.get(word))

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        union: Any = reduce(or_, self.sections)
        adapter: TypeAdapter[Any] = TypeAdapter(cast("Any", Annotated[union, Field(discriminator="type")]))
        return handler(adapter.core_schema)
