"""Classes of what a case file describes, for programs in Python: one a section, with its keys and its checks.

``[[ropes]]`` with a ``type`` of a wire rope is a `Rope`, ``[bodies.NAME]`` of ``type = "rigid"`` a `RigidBody`,
``[simulate]`` is `Simulate`: the name is that of the description. Nothing is described here. Keys, defaults, units and
words come from the sections of the case file, which check the values as well; so a new kind has its class without a
line of code.
"""

from __future__ import annotations

import contextlib
import copy
import inspect
import re
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self, get_origin

from pydantic import ValidationError

from heavylift.numerics.outcome import InputError, InputErrors
from heavylift.numerics.words import nearest
from heavylift.pipeline.case.case_file import ASKING, Case
from heavylift.pipeline.case.errors import input_errors, is_chosen, known_keys, sections_in
from heavylift.pipeline.case.fields import Section
from heavylift.pipeline.case.interface_names import POINTS
from heavylift.pipeline.case.tables import TABLES
from heavylift.pipeline.model.plain import plain
from heavylift.pipeline.model.words import docstring, words_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

__all__ = ["TABLES_OF_CASE", "CaseTable", "Component", "component_class", "component_names"]

_OWN_KEYS = {"title", "sources", "parameters"}
"""Keys of a case that are no tables."""


class ModelErrors(InputErrors):
    """Everything that is wrong with a model, one line each; also when it comes from another process."""

    def __reduce__(self) -> tuple[type[ModelErrors], tuple[list[InputError]]]:
        return type(self), (self.errors,)


def raised(errors: list[InputError]) -> InputError:
    """One error as it is, or all of several."""
    return errors[0] if len(errors) == 1 else ModelErrors(errors)


@contextlib.contextmanager
def told(located: Callable[[InputError], InputError] | None) -> Iterator[None]:
    """Errors at the components of a program, if a model says where they are."""
    try:
        yield
    except InputError as error:
        if located is None:
            raise
        parts = error.errors if isinstance(error, InputErrors) else [error]
        raise raised([located(one) for one in parts]) from None


class CaseTable(NamedTuple):
    """A table of a case file.

    Attributes
    ----------
    key
        ``"ropes"``, ``"simulate"``, ...
    form
        ``"named"``: tables by name, ``[bodies.NAME]``; ``"list"``: ``[[ropes]]``; ``"single"``: ``[simulate]``.
    label
        Key of the name of an entry of a list; empty without one.
    shares
        Whether names of its entries are those of channels, which are unique among all such tables.
    """

    key: str
    form: Literal["named", "list", "single"]
    label: str = ""
    shares: bool = False

    @property
    def sections(self) -> tuple[type[Section], ...]:
        """Sections of its entries."""
        field = Case.model_fields[self.key]
        found = dict.fromkeys(sections_in(field.annotation))
        for mark in field.metadata:
            found |= dict.fromkeys(sections_in(mark))
        return tuple(section for section in found if issubclass(section, Section))


def _tables() -> Iterator[CaseTable]:
    for key, field in Case.model_fields.items():
        origin = get_origin(field.annotation)
        if key in _OWN_KEYS:
            continue
        shares = key in TABLES and TABLES[key].names == "own"
        if origin is dict:
            yield CaseTable(key, "named", shares=shares)
        elif origin is tuple:
            label = {"check": "id", "repeat": ""}.get(key, "name")
            yield CaseTable(key, "list", label, shares)
        else:
            yield CaseTable(key, "single")


TABLES_OF_CASE: Mapping[str, CaseTable] = {table.key: table for table in _tables()}
"""Tables of a case file by key, in its order."""


class _ComponentClass(type):
    """Class of components: its signature and its words are those of the section."""

    TABLE: CaseTable
    SECTION: type[Section]

    @property
    def __signature__(cls) -> inspect.Signature:
        return _signature(cls)

    @property
    def __doc__(cls) -> str:  # type: ignore[override]
        return docstring(cls)

    def __dir__(cls) -> list[str]:
        return sorted({*super().__dir__(), *known_keys([cls.SECTION])})


class Component(metaclass=_ComponentClass):
    """A table of a case: a body, a joint, a rope, a sea, ...

    Keys are attributes: ``rope.length = "12 m"``, and items: ``rope["length"]``. What was not given is the default;
    None takes a key away. Values are as in a case file, numbers in SI or texts with a unit.

    Examples
    --------
    >>> import heavylift as hl
    >>> push = hl.PointForce("push", body="load", point=[0, 0, 0], times=[0, 1], forces=[[0, 0, 0], ["5 kN", 0, 0]])
    >>> push.body = "module"
    >>> push.times, push["name"]
    ([0, 1], 'push')
    >>> push.body = 3
    Traceback (most recent call last):
    heavylift.numerics.outcome.InputError: ...PointForce('push').body: 3 is not a string; expected a string
    """

    TABLE: ClassVar[CaseTable]
    SECTION: ClassVar[type[Section]]

    _name: str | None
    _row: dict[str, Any]
    _made_at: str
    _model: Any  # that it is in

    def __init__(self, name: str | None = None, /, **keys: Any) -> None:
        cls = type(self)
        row: dict[str, Any] = {}
        for key, value in (("_made_at", line_of_program()), ("_model", None), ("_name", None), ("_row", row)):
            object.__setattr__(self, key, value)
        label = cls.TABLE.label or ("name" if cls.TABLE.form == "named" else "")
        if name is not None:
            self._take_name(name, label, keys)
            keys = {label: name, **keys}
        if isinstance(keys.get(label), str):  # known to the messages that follow
            object.__setattr__(self, "_name", keys[label])
            row[label] = keys[label]
        try:
            given = plain(keys)
        except InputError as error:
            raise self._told(error) from None
        if cls.TABLE.form == "named":
            object.__setattr__(self, "_name", given.pop("name", None))
            if self._name is None:
                raise self._told(
                    InputError("is missing", key="name", expected="a name as the first argument")
                )
        row.clear()
        first = {label: given[label]} if label in given else {}
        row.update({**first, **words_of(cls.SECTION, needed=True), **given})
        self._check()

    def _take_name(self, name: object, label: str, keys: Mapping[str, Any]) -> None:
        """See that a first argument is a name, and that there can be one."""
        table = f"[{self.TABLE.key}]" if self.TABLE.form == "single" else f"[[{self.TABLE.key}]]"
        if not label:
            raise self._told(InputError(f"{name!r}", key="name", expected=f"keys only: {table} has no name"))
        if not isinstance(name, str):
            raise self._told(InputError(f"{name!r} is not a string", key=label, expected="a name"))
        if label in keys:
            raise self._told(InputError(f"{name!r} and {keys[label]!r}", key=label, expected="one name"))

    @classmethod
    def _of(cls, row: dict[str, Any], name: str | None) -> Self:
        """The component of a table that is there already."""
        made = object.__new__(cls)
        for key, value in (("_made_at", ""), ("_model", None), ("_name", name), ("_row", row)):
            object.__setattr__(made, key, value)
        return made

    def _copied(self) -> Self:
        """The same with a table of its own, in no model."""
        made = self._of(copy.deepcopy(self._row), self._name)
        object.__setattr__(made, "_made_at", self._made_at)
        return made

    @property
    def _own_name(self) -> str | None:
        found = self._name if self.TABLE.form == "named" else self._row.get(self.TABLE.label)
        return found if isinstance(found, str) else None

    @property
    def _words(self) -> str:
        """How messages call it: ``Rope('hoist')``."""
        name = self._own_name
        return f"{type(self).__name__}({name!r})" if name is not None else type(self).__name__

    def _told(self, error: InputError, key: str | None = None) -> InputError:
        """An error with the line of the program and the name of this component."""
        place = error.key if key is None else key
        return InputError(
            error.problem,
            source=self._made_at or error.source,
            key=f"{self._words}.{place}" if place else self._words,
            expected=error.expected,
        )

    def _check(self) -> None:
        """See that its values can be right, whatever else is in the case.

        Raises
        ------
        InputError
            One line for each key that is unknown, missing or wrong.
        """
        if self.TABLE.key == "repeat":  # its texts have indices and parameters
            return
        try:
            self.SECTION.model_validate(self._row)
        except ValidationError as error:
            # units of what names channels are known where the channels are
            unknown = {"case", "value_error"} if self.TABLE.key in ASKING else set()
            found = input_errors(error, self._row, self.SECTION, "", without=unknown)
            wrong = [one for one in found if not _names_interface(self._row, one.key)]
            if wrong:
                raise raised(
                    [self._told(one, "" if one.key == "case" else one.key) for one in wrong]
                ) from None

    def __getitem__(self, key: str) -> Any:
        if key in self._row:
            return self._row[key]
        if key == "name" and self.TABLE.form == "named":
            return self._name
        for name, field in self.SECTION.model_fields.items():
            if key == (field.alias or name):
                default = field.get_default(call_default_factory=True)
                return None if field.is_required() or isinstance(default, Section) else default
        known = sorted(known_keys([self.SECTION]))
        near = nearest(key, known)
        hint = f"; did you mean {near!r}?" if near else ""
        raise self._told(InputError(f"unknown key{hint}", key=key, expected=f"one of: {', '.join(known)}"))

    def __setitem__(self, key: str, value: Any, /) -> None:
        before = dict(self._row)
        try:
            given = None if value is None else plain(value, key)
        except InputError as error:
            raise self._told(error) from None
        if value is None:
            self._row.pop(key, None)
        else:
            self._row[key] = given
        made_at = self._made_at
        self._tell_line()
        try:
            self._check()
        except InputError:
            self._row.clear()
            self._row.update(before)
            object.__setattr__(self, "_made_at", made_at)
            raise

    def _tell_line(self) -> None:
        """Let messages name the line of the program that changes what was read from a file."""
        if not self._made_at:
            object.__setattr__(self, "_made_at", line_of_program())

    def __getattr__(self, key: str) -> Any:
        if key.startswith("_"):
            raise AttributeError(f"{type(self).__name__} has no attribute {key!r}")
        try:
            return self[key]
        except InputError as error:
            raise AttributeError(str(error)) from None

    def __setattr__(self, key: str, value: Any) -> None:
        self[key] = value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *known_keys([self.SECTION])})

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and (self._name, self._row) == (other._name, other._row)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        label = self.TABLE.label
        keys = [
            f"{key}={value!r}"
            for key, value in self._row.items()
            if key not in {label, *words_of(self.SECTION)}
        ]
        name = self._own_name
        return f"{type(self).__name__}({', '.join([repr(name)] * (name is not None) + keys)})"


def _names_interface(row: Mapping[str, Any], key: str) -> bool:
    """Whether a key is that of a point for which the name of an interface stands, which the case knows."""
    parts = key.split(".")
    if not any(part in POINTS or part == "points" for part in parts):
        return False
    node: Any = row
    for part in parts:
        if isinstance(node, list) and part.isdecimal() and int(part) < len(node):
            node = node[int(part)]
        elif isinstance(node, dict) and part in node:
            node = node[part]
        else:
            return False
    return isinstance(node, str)


def line_of_program() -> str:
    """File and line of the program that called this package: ``"lift.py:12"``, in a notebook ``"cell:3"``."""
    frame: Any = sys._getframe(1)  # noqa: SLF001
    while frame is not None and str(frame.f_globals.get("__name__", "")).partition(".")[0] == "heavylift":
        frame = frame.f_back
    if frame is None:
        return ""
    file = frame.f_code.co_filename
    return f"{'cell' if 'ipykernel' in file else Path(file).name}:{frame.f_lineno}"


def _name(section: type[Section]) -> str:
    return section.__name__.removesuffix("Section")


@cache
def classes_of(table: str) -> Mapping[str, type[Component]]:
    """Classes of the components of a table of a case, by their names."""
    found: dict[str, type[Component]] = {}
    for section in TABLES_OF_CASE[table].sections:
        content = {"__module__": "heavylift", "TABLE": TABLES_OF_CASE[table], "SECTION": section}
        made: Any = _ComponentClass(_name(section), (Component,), content)
        found[made.__name__] = made
    return found


def class_of_row(table: str, row: Mapping[str, Any]) -> type[Component]:
    """Class of an entry of a table of a case."""
    classes = list(classes_of(table).values())
    fits = [one for one in classes if is_chosen(one.SECTION, row)]
    return (fits or classes)[0]


def component_class(name: str) -> type[Component] | None:
    """The class with a name; None if there is none."""
    word = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()
    # most are in the table of their name, and the sections of others need not be made
    tables = sorted(TABLES_OF_CASE, key=lambda key: not key.startswith(word))
    return next((classes_of(table)[name] for table in tables if name in classes_of(table)), None)


@cache
def component_names() -> tuple[str, ...]:
    """Names of all classes, in the order of the tables of a case."""
    return tuple(name for table in TABLES_OF_CASE for name in classes_of(table))


def _signature(cls: _ComponentClass) -> inspect.Signature:
    """Its keys: those that are required first."""
    parameter = inspect.Parameter
    own = words_of(cls.SECTION)
    keys = []
    for name, field in cls.SECTION.model_fields.items():
        key = field.alias or name
        if key in own or key == cls.TABLE.label or not key.isidentifier():
            continue
        default = parameter.empty if field.is_required() else field.get_default(call_default_factory=True)
        keys.append(parameter(key, parameter.KEYWORD_ONLY, default=default))
    named = cls.TABLE.form == "named" or bool(cls.TABLE.label)
    first = [parameter("name", parameter.POSITIONAL_ONLY)] if named else []
    return inspect.Signature([*first, *sorted(keys, key=lambda one: one.default is not parameter.empty)])
