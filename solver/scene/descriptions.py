"""Descriptions: the single definition of each component type.

A *description* is a frozen dataclass, in the file of its kind, of the values of one component: each field is
annotated with its quantity, and a sentence stands below it. Its class says under which word a case file knows it, what
it records, and in ``check`` what its keys must say together. The section of the case file, the JSON schema, the tables
of keys, the sentences of channels, the object itself and its row of the report are made from it; nothing of it stands
anywhere else. A *part* is the description of a table within that of another one. An object that was not made from a
case file is checked by the same words, see `check_object`.

A `Family` finds descriptions that belong together: each module of a package may bring some. A file that nobody names is
not looked at: a case with hinges knows nothing of screws. And of a file that is named only the description is executed,
with what it refers to: who reads a case does not import a compiler. When the kernels are wanted, the module is imported
as any other, and finds its description there already.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import math
import sys
import types
from dataclasses import MISSING, Field, fields
from itertools import pairwise
from numbers import Real
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Generic,
    Literal,
    NamedTuple,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.hints import unaliased
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import (
    Absent,
    AsDrawn,
    BodyDirection,
    BodyPoint,
    ByCoordinate,
    ByExponent,
    NameOf,
    PointsFile,
    Quantity,
    Shape,
    Square,
    TableFile,
    WorldDirection,
)
from heavylift.numerics.units import KINDS, parse_unit

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

__all__ = [
    "XYZ",
    "ChannelKind",
    "DescribedField",
    "Family",
    "Meaning",
    "check_object",
    "check_table",
    "described_fields",
    "forward",
    "import_all",
    "interval_extremes",
    "is_described",
    "is_parallel",
    "known_channels",
    "no_rows",
    "owner_coordinate",
    "recorded_channels",
    "upwards",
    "zero_point",
]

PARALLEL = 1e-9
"""Sine of the angle below which two directions are parallel."""
LONGEST_WORD = 100
"""Characters of a word that may be the name of a file."""

T = TypeVar("T")
U = TypeVar("U")
XYZ = ("x", "y", "z")


def interval_extremes(
    name: str,
    quantity: str,
    seen: str = "at the ends of all steps",
    components: tuple[str, ...] | None = (),
) -> tuple[ChannelKind, ...]:
    """Channels of the largest and smallest value since the last record of what a channel shows of an instant."""
    words = f"value of `{name}` since the last record, {seen} and at this record"
    return (
        ChannelKind(f"{name}_max", quantity, f"largest {words}", components),
        ChannelKind(f"{name}_min", quantity, f"smallest {words}", components),
    )


@dataclass(frozen=True)
class ChannelKind:
    """A channel that components of a type record.

    Attributes
    ----------
    name
        Last part of the name of the channel.
    quantity
        Name of a `heavylift.numerics.units.Kind`.
    sentence
        What it is, in words.
    components
        Names of its columns; empty of a number, whose column has its own name; None if the scene decides.
    unit
        SI unit, another name for that of the quantity if given: energies are J, not N m.
    by_owner
        Whether it may be another quantity than a channel with this name elsewhere, which is declared before it.
    """

    name: str
    quantity: str
    sentence: str
    components: tuple[str, ...] | None = ()
    unit: str = ""
    by_owner: bool = False

    def __post_init__(self) -> None:
        if self.quantity not in KINDS or not self.sentence:
            raise TypeError(
                f"channel {self.name!r}: {self.quantity!r}, expected a known quantity and a sentence"
            )
        kind = KINDS[self.quantity]
        if self.unit and parse_unit(self.unit) != (1.0, kind.dimension):
            raise TypeError(f"channel {self.name!r} in {self.unit}, expected another name for {kind.unit}")
        object.__setattr__(self, "unit", self.unit or kind.unit)
        known = _CHANNELS.setdefault(self.name, [])
        if known and known[0].quantity != self.quantity and not self.by_owner:
            raise TypeError(
                f"channel {self.name!r} is a {self.quantity} here, and elsewhere a {known[0].quantity}"
            )
        if {(), None} <= {self.components, *(one.components for one in known)}:
            raise TypeError(f"channel {self.name!r} is one number in one place, and several in another one")
        known.append(self)

    def columns(self, chosen: Mapping[str, tuple[str, ...]] | None = None) -> tuple[str, ...]:
        """Name of each column; `chosen` are components, by channel, that the scene decides: none if it is absent."""
        if self.components is None or self.name in (chosen or {}):
            return (chosen or {})[self.name]
        return self.components or (self.name,)


_CHANNELS: dict[str, list[ChannelKind]] = {}
"""By name; all of one quantity, but for those that have theirs from their owner."""


Meaning = (
    Quantity
    | ByCoordinate
    | ByExponent
    | WorldDirection
    | BodyDirection
    | BodyPoint
    | NameOf
    | TableFile
    | PointsFile
)
"""Annotations that say what a value is."""


class DescribedField(NamedTuple):
    """A key that a description brings: its name, type without annotations, annotations, and default.

    Without default the key is needed; `default` then is `dataclasses.MISSING`.
    """

    name: str
    hint: Any
    marks: tuple[Any, ...]
    default: Any

    def mark(self, kind: Any) -> Any:
        """Its annotation of a class, or None."""
        return next((mark for mark in self.marks if isinstance(mark, kind)), None)

    @property
    def quantity(self) -> Any:
        """What it is; None of a flag, a word of choice, a number that counts, or a table."""
        return self.mark(Meaning)

    @property
    def absent(self) -> bool:
        """Whether a case file may leave it out, which none of its values means."""
        return self.mark(Absent) is not None


class Family(Generic[T]):
    """Descriptions of one family, by the words of case files.

    Parameters
    ----------
    name
        What a member is called in messages, e.g. "joint".
    package
        Modules of this package may describe members; the one with the name of a word is looked at first.
    others
        Packages after it whose modules may describe members too; ``"name.*"`` is all packages within one.
    default
        Word of a table that says none.
    typed
        Whether a table gives its word, as its ``type``; if not, it is the name of the list in which it stands.
    key
        In which a table gives its word, if not as its ``type``.
    alphabetical
        Whether its words are listed in that order, behind those that have an ``ORDER``; if not, as they are described.
    """

    def __init__(
        self,
        name: str,
        package: str,
        *others: str,
        default: str = "",
        typed: bool = True,
        key: str = "type",
        alphabetical: bool = True,
    ) -> None:
        self.name, self.package, self.key, self._alphabetical = name, package, key, alphabetical
        self._packages = (package, *others)
        self.default, self.typed = default, typed
        self._members: dict[str, type[T]] = {}
        self._parts: dict[str, type[Any]] = {}
        self._complete = False

    def describe(self, word: str) -> Callable[[type[T]], type[T]]:
        """Decorate the dataclass that describes what a case file calls `word`.

        Raises
        ------
        TypeError
            If another one has the word, a channel stands twice, a field has no quantity, or hides one of a base class.
        """

        def register(described: type[T]) -> type[T]:
            other = self._members.get(word)
            if other is not None and _place(other) == _place(described):
                return other  # its kernels are imported now
            if other is not None:
                raise TypeError(
                    f"{self.name} {word!r} is described twice: {_place(other)} and {_place(described)}"
                )
            channels = [channel.name for channel in getattr(described, "CHANNELS", ())]
            twice = sorted({name for name in channels if channels.count(name) > 1})
            if twice:
                raise TypeError(f"{_place(described)}: records {', '.join(twice)} twice")
            for base in described.__mro__[1:]:
                hidden = _named_in(described, described) & _named_in(base, described)
                if hidden:
                    raise TypeError(
                        f"{_place(described)}: {', '.join(sorted(hidden))} hides that of {base.__name__}"
                    )
            self._complete_description(word, described)
            self._members[word] = described
            return described

        return register

    def part(self, described: type[U]) -> type[U]:
        """Decorate the dataclass that describes a table within those of this family, beside one of them."""
        other = self._parts.setdefault(_place(described), described)
        if other is described:
            self._complete_description("", described)
        return other

    def _complete_description(self, word: str, described: Any) -> None:
        described.WORD, described.FAMILY = word, self
        described.FIELDS = _find_fields(described)

    def get(self, word: str) -> type[T] | None:
        """Description that a word stands for; None if there is none."""
        if word not in self._members and word.isidentifier() and len(word) <= LONGEST_WORD:
            for package, folder in self._folders:
                if (file := folder / f"{word}.py").is_file():
                    _read(file, f"{package}.{word}")
            if word not in self._members and not self._complete:
                self._read_those_with(f'.describe("{word}")')
            if word not in self._members:
                self._read_all()
        return self._members.get(word)

    @property
    def words(self) -> tuple[str, ...]:
        """All words in their order."""
        self._read_all()
        if not self._alphabetical:
            return tuple(self._members)
        return tuple(
            sorted(self._members, key=lambda word: (getattr(self._members[word], "ORDER", math.inf), word))
        )

    @property
    def _folders(self) -> list[tuple[str, Path]]:
        """Packages and their folders: another one may be added to the path of a package."""
        found = []
        for named in self._packages:
            package = named.removesuffix(".*")
            folders = [Path(folder) for folder in importlib.import_module(package).__path__]
            if named == package:
                found += [(package, folder) for folder in folders]
            else:
                within = (file.parent for folder in folders for file in sorted(folder.glob("*/__init__.py")))
                found += [(f"{package}.{folder.name}", folder) for folder in within]
        return found

    def _read_all(self) -> None:
        if not self._complete:
            self._read_those_with(".describe(")
            self._complete = True

    def _read_those_with(self, words: str) -> None:
        """Read the files in which some words stand."""
        for package, folder in self._folders:
            for file in sorted(folder.glob("[!_]*.py")):
                _read(file, f"{package}.{file.stem}", words)


def _read(file: Path, name: str, words: str = ".describe(") -> None:
    """Execute the descriptions of a module, and the imports and definitions that they refer to; nothing else of it."""
    if name in sys.modules:
        return
    text = file.read_text(encoding="utf-8")
    if words not in text:
        return
    tree = ast.parse(text, str(file))
    given: dict[str, list[ast.stmt]] = {}
    for node in tree.body:
        for bound in _bound(node):
            given.setdefault(bound, []).append(node)
    wanted = [node for node in tree.body if any(map(_describes, getattr(node, "decorator_list", ())))]
    if not wanted:
        return
    kept = {
        id(node) for node in tree.body if isinstance(node, ast.ImportFrom) and node.module == "__future__"
    }
    while wanted:
        node = wanted.pop()
        if id(node) not in kept:
            kept.add(id(node))
            if isinstance(node, ast.ClassDef) and not any(map(_is_kept, node.decorator_list)):
                # imported again with the kernels it would be another class
                raise TypeError(
                    f"{name}.{node.name}: what descriptions are made of stands in a module without kernels"
                )
            names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
            wanted += [definition for used in names for definition in given.get(used, ())]
    tree.body = [node for node in tree.body if id(node) in kept]
    module = types.ModuleType(name)
    module.__file__ = str(file)
    sys.modules[name] = module  # dataclasses look names of annotations up there
    try:
        exec(compile(tree, str(file), "exec"), module.__dict__)  # noqa: S102
    finally:
        del sys.modules[name]


def _describes(decorator: ast.expr) -> bool:
    named = decorator.func if isinstance(decorator, ast.Call) else decorator
    return isinstance(named, ast.Attribute) and named.attr in {"describe", "part"}


def _is_kept(decorator: ast.expr) -> bool:
    """Whether a class that is decorated so stays the same when it is read with the kernels."""
    return _describes(decorator) or (isinstance(decorator, ast.Name) and decorator.id == "outputs")


def _bound(node: ast.stmt) -> list[str]:
    """Names that a statement of a module binds."""
    if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
        return [node.name]
    found = []
    for part in ast.walk(node):
        if isinstance(part, ast.alias):
            found.append(part.asname or part.name.partition(".")[0])
        elif isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            found.append(part.id)
    return found


def import_all(package: types.ModuleType) -> list[types.ModuleType]:
    """Import the modules of a package, also those in a folder that was added to its path.

    Raises
    ------
    TypeError
        With both places, if two files have one name.
    """
    found = []
    for folder in package.__path__:
        for file in sorted(Path(folder).glob("[!_]*.py")):
            module = importlib.import_module(f"{package.__name__}.{file.stem}")
            if Path(str(module.__file__)) != file:
                raise TypeError(f"{file}: another file of this name is {module.__file__}")
            found.append(module)
    return found


def described_fields(described: Any) -> tuple[DescribedField, ...]:
    """Keys that a description brings beside those of its base, in their order."""
    found: tuple[DescribedField, ...] = described.FIELDS
    return found


def recorded_channels(described: Any, coordinate: str = "") -> tuple[ChannelKind, ...]:
    """Channels of components of a description.

    Parameters
    ----------
    described
        The description.
    coordinate
        Coordinate of the joint along which one acts, ``"angle"`` or ``"travel"``; all that may be if empty.
    """
    by_coordinate = getattr(described, "CHANNEL_BY_COORDINATE", None)
    if by_coordinate is None or hasattr(described, "CHANNELS"):
        found: tuple[ChannelKind, ...] = getattr(described, "CHANNELS", ())
        return found
    return (by_coordinate[coordinate],) if coordinate else tuple(by_coordinate.values())


def is_described(hint: Any) -> bool:
    """Whether a type is a description."""
    return isinstance(hint, type) and "FIELDS" in vars(hint)


def _find_fields(described: type) -> tuple[DescribedField, ...]:
    """Keys of a description; a field without quantity is a `TypeError`.

    Fields of its bases without annotation are no keys: they give where a component is, in another form than a case
    file.
    """
    hints: dict[str, Any] = {}
    for base in reversed(described.__mro__):
        own, says = _named_in(base, described), "WORD" in vars(base)
        if own and (says or any("Annotated" in str(text) for text in inspect.get_annotations(base).values())):
            given = inspect.get_annotations(base, eval_str=True)
            hints |= {k: v for k, v in given.items() if k in own and (says or get_origin(v) is Annotated)}
    by_name: dict[str, Field[Any]] = {field.name: field for field in fields(described)}
    found = []
    hints.pop("name", None)  # everything has one
    for name, hint in hints.items():
        annotated = get_origin(hint) is Annotated
        inner, marks = (get_args(hint)[0], get_args(hint)[1:]) if annotated else (hint, ())
        inner = unaliased(inner)
        kinds = [mark for mark in marks if isinstance(mark, Meaning)]
        if len(kinds) != 1 and (kinds or not all(map(_speaks_for_itself, _leaves(inner)))):
            raise TypeError(f"{_place(described)}.{name}: {hint}, expected an annotation with its quantity")
        field = by_name[name]
        default = field.default_factory() if field.default_factory is not MISSING else field.default
        found.append(DescribedField(name, inner, marks, default))
    return tuple(found)


def _leaves(hint: Any) -> list[Any]:
    """Types that a list or a choice of types is made of."""
    hint = unaliased(hint)
    if get_origin(hint) in {tuple, Union, types.UnionType}:
        inner = [part for part in get_args(hint) if part not in {..., type(None)}]
        return [leaf for part in inner for leaf in _leaves(part)]
    return [hint]


def _speaks_for_itself(hint: Any) -> bool:
    """Whether a value is a flag, a word of choice, a number that counts, or a table described elsewhere."""
    if get_origin(hint) is Annotated:
        return any(isinstance(mark, Meaning) for mark in get_args(hint)[1:])
    return hint in {bool, int} or get_origin(hint) is Literal or is_described(hint)


def _named_in(base: type, described: type) -> set[str]:
    """Fields of a description that the body of one of its classes names."""
    return set(inspect.get_annotations(base)) & {field.name for field in fields(described)}


def known_channels() -> Mapping[str, Sequence[ChannelKind]]:
    """Channels by name that descriptions which have been imported declare, of all their owners."""
    return _CHANNELS


def no_rows() -> NDArray[np.float64]:
    """An empty table."""
    return np.zeros(0)


def zero_point() -> NDArray[np.float64]:
    """Default of a point: the origin."""
    return np.zeros(3)


def forward() -> NDArray[np.float64]:
    """Default of a direction: along x."""
    return np.array([1.0, 0.0, 0.0])


def upwards() -> NDArray[np.float64]:
    """Default of a direction: along z."""
    return np.array([0.0, 0.0, 1.0])


def is_parallel(a: Sequence[float], b: Sequence[float]) -> bool:
    """Whether two directions, neither zero, are parallel."""
    across = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return math.hypot(*across) <= PARALLEL * math.hypot(*a) * math.hypot(*b)


def named(spec: Any, *keys: str) -> bool:
    """Whether one of some keys stands in a case file; always, of an object, whose values may be its defaults."""
    found = getattr(spec, "model_fields_set", None)
    return found is None or not found.isdisjoint(keys)


def check_table(
    key: str, places: Sequence[float], values_key: str, values: Sequence[Any], *, shortest: int = 1
) -> None:
    """Refuse a table that has not one value a place, or places that do not increase.

    Raises
    ------
    InputError
        With the key of the list.
    """
    if len(places) != len(values):
        raise InputError(
            f"{len(places)} {key} and {len(values)} {values_key}",
            key=values_key,
            expected=f"one of {values_key} for each of {key}",
        )
    if any(b <= a for a, b in pairwise(places)):
        raise InputError(f"{key} {list(places)}", key=key, expected=f"increasing {key}")
    if 0 < len(places) < shortest:
        raise InputError(f"a table of {len(places)} rows", expected=f"{shortest} or more")


def owner_coordinate(field: DescribedField) -> str:
    """Coordinate that a table says of an angle or a length: a function of time, for instance."""
    kind = field.quantity.kind if isinstance(field.quantity, Quantity) else ""
    return {"angle": "angle", "length": "travel"}.get(kind, "")


def check_object(thing: Any, coordinate: str = "", source: str = "") -> None:
    """What a case file is checked for, of an object made otherwise: ranges of numbers, and what its keys say together.

    The ``check`` of a description sees its keys as in the case file: lists, and None for what it leaves out.

    Parameters
    ----------
    thing
        The object; one without description is passed over.
    coordinate
        Coordinate of the joint along which it acts, ``"angle"`` or ``"travel"``.
    source
        Name of the component, if it has none of its own.

    Raises
    ------
    InputError
        With the name of the component and the key.
    """
    if not is_described(type(thing)):
        return
    try:
        _spec(thing, "", coordinate)
    except InputError as error:
        name = source or thing.name
        raise InputError(error.problem, source=name, key=error.key, expected=error.expected) from None


def _spec(thing: Any, key: str, coordinate: str) -> types.SimpleNamespace:
    """Keys of a component as in a case file; checked."""
    spec = types.SimpleNamespace()
    for field in described_fields(type(thing)):
        place = f"{key}{field.name}"
        value = _as_said(field, getattr(thing, field.name), place, coordinate)
        _check_range(field, value, place, coordinate)
        setattr(spec, field.name, value)
    check = getattr(thing, "check", None)
    if check is not None:
        try:
            check(spec)
        except InputError as error:
            place = f"{key}{error.key}".removesuffix(".")
            raise InputError(error.problem, key=place, expected=error.expected) from None
    return spec


def _as_said(field: DescribedField, value: Any, key: str, coordinate: str) -> Any:
    """Value of a key as in the case file."""
    coordinate = owner_coordinate(field) or coordinate
    if is_described(type(value)):
        return _spec(value, f"{key}.", coordinate)
    if isinstance(value, (tuple, list)):
        return [
            _as_said(field, entry, f"{key}.{number}", coordinate)
            if isinstance(entry, (tuple, list)) or is_described(type(entry))
            else entry
            for number, entry in enumerate(value)
        ]
    value = _listed(value)
    if field.absent and not field.mark(AsDrawn):
        left = field.mark(Absent).value
        left = _listed(field.default if left is None and field.default is not MISSING else left)
        return None if value == left or (value != value and left != left) else value  # noqa: PLR0124
    return value


def _listed(value: Any) -> Any:
    """An array as lists."""
    return value.tolist() if isinstance(value, np.ndarray) else value


def _check_range(field: DescribedField, value: Any, key: str, coordinate: str) -> None:
    """Numbers are finite and within their bounds, and as many as are needed."""
    quantity, shape = field.quantity, _shape(field)
    if value is not None and shape is not None:
        given = np.array(value, dtype=np.float64)
        if given.shape != shape or not np.all(np.isfinite(given)):
            raise InputError(f"{value}", key=key, expected=f"finite numbers, shape {shape}")
    if isinstance(quantity, ByCoordinate):
        quantity = quantity.travel if coordinate == "travel" else quantity.angle
    if not isinstance(quantity, Quantity) or not isinstance(value, (Real, list, tuple)):
        return  # a table has ranges of its own
    for number in np.ravel(np.array(value, dtype=np.float64)):
        try:
            quantity.parse(float(number))
        except InputError as error:
            raise InputError(error.problem, key=key, expected=error.expected) from None


def _shape(field: DescribedField) -> tuple[int, ...] | None:
    """Shape of an array; None if it may be any."""
    many = isinstance(field.quantity, BodyPoint) and field.mark(Shape) is not None
    if isinstance(field.quantity, (BodyPoint, BodyDirection, WorldDirection)) and not many:
        return (3,)
    if square := field.mark(Square):
        return (square.size, square.size)
    shape = field.mark(Shape)
    return None if shape is None or None in shape.lengths else shape.lengths


def _place(described: type) -> str:
    return f"{described.__module__.removeprefix('heavylift.')}.{described.__qualname__}"
