"""The list of criteria of a case file: any kind that has a file in `heavylift.pipeline.case.criteria`."""

from __future__ import annotations

import importlib
import inspect
import sys
from functools import cache, reduce
from operator import or_
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from pydantic import AfterValidator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from heavylift.pipeline.case import criteria as package
from heavylift.pipeline.case.criteria.base import CriterionSection

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from pydantic import ValidationInfo
    from pydantic.json_schema import JsonSchemaValue

__all__ = ["Criteria", "criterion_kinds"]


@cache
def criterion_kinds() -> dict[str, type[CriterionSection]]:
    """Kinds of criteria by their words, in the order of schema and messages.

    All files of the package are read, also those in a folder that was added to its path.

    Raises
    ------
    TypeError
        With both places, if two kinds have one word; or if a kind has no word, or does not say how it is judged.
    """
    found: dict[str, type[CriterionSection]] = {}
    for kind in _read_kinds():
        if inspect.isabstract(kind) or "type" not in kind.model_fields:
            raise TypeError(f"{_place(kind)}: a kind of criteria has a key 'type' with one word, and `judge`")
        (word,) = kind.model_fields["type"].annotation.__args__  # type: ignore[union-attr]
        if word in found:
            raise TypeError(f"{_place(kind)}: {word!r} is the word of {_place(found[word])}")
        found[word] = kind
    return dict(sorted(found.items(), key=lambda one: (one[1].ORDER, one[0])))


def _read_kinds() -> Iterator[type[CriterionSection]]:
    for folder in package.__path__:
        for file in sorted(Path(folder).glob("[!_]*.py")):
            module = importlib.import_module(f"{package.__name__}.{file.stem}")
            if Path(str(module.__file__)) != file:
                raise TypeError(f"{file}: another file of this name is {module.__file__}")
            for kind in vars(module).values():
                own = inspect.isclass(kind) and kind.__module__ == module.__name__
                # what other kinds derive from stands in `base`
                if (
                    own
                    and issubclass(kind, CriterionSection)
                    and module.__name__ != CriterionSection.__module__
                ):
                    yield kind


def _place(kind: type) -> str:
    return f"{sys.modules[kind.__module__].__file__}, {kind.__name__}"


@cache
def _adapter() -> TypeAdapter[Any]:
    made: Any = reduce(or_, criterion_kinds().values())
    return TypeAdapter(cast("Any", tuple[Annotated[made, Field(discriminator="type")], ...]))


class _AnyKind:
    """Annotation of a list of criteria, whose kinds are read when a case has some."""

    def validate(self, value: Any, info: ValidationInfo) -> Any:
        """The criteria of a list of tables."""
        return _adapter().validate_python(value, context=info.context)

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return handler(_adapter().core_schema)


def _one_each(criteria: Sequence[Any]) -> Sequence[Any]:
    names = [criterion.name for criterion in criteria]
    for index, name in enumerate(names):
        if name in names[:index]:
            raise PydanticCustomError(
                "case",
                "{problem}",
                {
                    "problem": f"{name!r} is used before",
                    "expected": "one criterion a name",
                    "key": f"{index}.name",
                },
            )
    return criteria


Criteria = Annotated[tuple[CriterionSection, ...], _AnyKind(), AfterValidator(_one_each)]
"""All criteria of a case."""
