"""The list of criteria of a case file: any kind that has a file in `heavylift.pipeline.case.criteria`."""

from __future__ import annotations

import importlib
import inspect
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from heavylift.pipeline.case import criteria as package
from heavylift.pipeline.case.described import Chosen
from heavylift.solver.scene.descriptions import Family, import_all

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from types import ModuleType

    from heavylift.pipeline.case.criteria.base import CriterionSection

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
    for kind in _kinds_in(import_all(package)):
        word = _word(kind)
        if word in found:
            raise TypeError(f"{_place(kind)}: {word!r} is the word of {_place(found[word])}")
        found[word] = kind
    return dict(sorted(found.items(), key=lambda one: (one[1].ORDER, one[0])))


@cache
def _kind_in_its_file(word: str) -> type[CriterionSection] | None:
    """Kind of a word by which a file of the package is called; None if there is none in that file, or no such file."""
    if not word.isidentifier() or word.startswith("_"):
        return None
    files = [folder for folder in package.__path__ if (Path(folder) / f"{word}.py").is_file()]
    if len(files) != 1:
        return None
    kinds = _kinds_in([importlib.import_module(f"{package.__name__}.{word}")])
    return next((kind for kind in kinds if _word(kind) == word), None)


def _word(kind: type[CriterionSection]) -> str:
    """Value of the key ``type`` of a kind."""
    words = get_args(kind.model_fields["type"].annotation) if "type" in kind.model_fields else ()
    if inspect.isabstract(kind) or len(words) != 1:
        raise TypeError(f"{_place(kind)}: a kind of criteria has a key 'type' with one word, and `judge`")
    word: str = words[0]
    return word


def _kinds_in(modules: Iterable[ModuleType]) -> Iterator[type[CriterionSection]]:
    """Classes that files of the package define, but for what they derive from, which stands in `base`."""
    from heavylift.pipeline.case.criteria.base import CriterionSection

    given = CriterionSection.__module__
    for module in modules:
        for kind in vars(module).values():
            own = inspect.isclass(kind) and kind.__module__ == module.__name__ != given
            if own and issubclass(kind, CriterionSection):
                yield kind


def _place(kind: type) -> str:
    return f"{sys.modules[kind.__module__].__file__}, {kind.__name__}"


class _Kinds(Family[Any]):
    """The kinds as a family: their sections are written as such, and not made of descriptions."""

    def get(self, word: str) -> type[CriterionSection] | None:
        """Section that a word stands for; None if there is none."""
        return _kind_in_its_file(word) or criterion_kinds().get(word)

    @property
    def words(self) -> tuple[str, ...]:
        """All words in their order."""
        return tuple(criterion_kinds())


def _section(kind: type[CriterionSection]) -> type[CriterionSection]:
    return kind


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


Criteria = Annotated[
    tuple[Annotated[Any, Chosen(_Kinds("criterion", package.__name__), _section)], ...],
    AfterValidator(_one_each),
]
"""All criteria of a case."""
