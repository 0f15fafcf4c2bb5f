"""Outputs: what components of a type record, each channel a field of a class, whose kernels write it by its name.

A class of `Outputs` lists channels in the order of their columns. A field is a `channel` with its quantity and its
sentence: a number, a vector with named components, or another class of outputs (`nested`). In a kernel such a class is
a record in the columns of a component, see `heavylift.solver.recording`: ``out.tension = tension`` and
``out.force[k] = ...`` write a record, and no column has a number. Channels of which the scene decides how many
components they have, none of them perhaps, are `Parts`: ``part(row, chain.parts.sheave_speed)[k] = speed``.

A channel is one line here, and one in the kernel.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.descriptions import ChannelKind, interval_extremes

if TYPE_CHECKING:
    from heavylift.numerics.records import Record

__all__ = [
    "Columns",
    "Components",
    "Outputs",
    "Part",
    "Parts",
    "PlacedPart",
    "channel",
    "largest",
    "largest_of_all",
    "nested",
    "outputs",
    "smallest",
    "smallest_of_all",
]

Components = NDArray[np.float64]
"""Type of a channel with several components."""

O = TypeVar("O")


class PlacedPart(NamedTuple):
    """Where the components of a channel of `Parts` are: first column and how many; none of a channel that is absent."""

    first: int
    size: int


if TYPE_CHECKING:
    Part = PlacedPart
    """Type of a channel of `Parts`."""
    _Record = Record
else:
    Part, _Record = "Part", object


@dataclass(frozen=True)
class _Declared:
    """A field of a class of outputs."""

    channels: Any
    """Makes its channel of its name."""
    of: type[Outputs] | None = None


class Outputs(_Record):
    """Base of all outputs.

    Attributes
    ----------
    CHANNELS
        What is recorded, in the order of its columns, those of `nested` classes with them.
    OUTPUTS
        Fields: a channel, or another class of outputs.

    Examples
    --------
    >>> @outputs
    ... class WeightOutputs(Outputs):
    ...     weight: float = channel("force", "weight of a body")
    ...     arm: Components = channel("length", "where it acts, world axes", ("x", "y", "z"))
    >>> [channel.name for channel in WeightOutputs.CHANNELS], WeightOutputs.CHANNELS[0].unit
    (['weight', 'arm'], 'N')
    """

    CHANNELS: ClassVar[tuple[ChannelKind, ...]] = ()
    OUTPUTS: ClassVar[Mapping[str, ChannelKind | type[Outputs]]] = {}
    _record: ClassVar[type[Record]]

    @classmethod
    def record(cls) -> type[Record]:
        """The record that lies in its columns; of `Parts`, what a kind keeps of where they are."""
        if "_record" not in vars(cls):
            cls._record = _make_record(cls)
        return cls._record

    @classmethod
    def kernel_type(cls) -> Any:
        """Type in kernels."""
        return cls.record().kernel_type()


class Parts(Outputs):
    """Base of outputs whose number of components the scene decides."""


def _make_record(declared: type[Outputs]) -> type[Record]:
    """Its record: a field a channel, or a record within; kernels want it, and who reads a case does not."""
    from heavylift.numerics.records import Record

    base: Any = declared.__mro__[1]
    inherited = getattr(base, "OUTPUTS", {})
    fields: dict[str, Any] = {}
    for name, one in declared.OUTPUTS.items():
        if name in inherited:
            continue
        if isinstance(one, type):
            fields[name] = one.record()
        elif issubclass(declared, Parts):
            fields[name] = _make_record_of_part()
        else:
            count = len(one.components or ())
            fields[name] = Annotated[Components, (count,)] if count else float
    words = {"__annotations__": fields, "__module__": declared.__module__}
    made: Any = type(declared.__qualname__, (base.record() if inherited else Record,), words)
    return made


@cache
def _make_record_of_part() -> Any:
    """As `PlacedPart`."""
    from heavylift.numerics.records import Record

    words = {"__annotations__": dict.fromkeys(PlacedPart._fields, int), "__module__": __name__}
    return type("PlacedPart", (Record,), words)


_MADE: dict[tuple[str, str], type[Outputs]] = {}
"""By module and name: what a description was read with stays the class of its kernels."""


def outputs(declared: type[O]) -> type[O]:
    """Decorate a class of outputs.

    Raises
    ------
    TypeError
        If a field has no channel, a channel no annotation, one stands twice, an annotation does not say what it is,
        there are several bases, or parts within what has fixed columns.
    """
    place = declared.__module__, declared.__qualname__
    if place in _MADE:
        known: Any = _MADE[place]
        return known
    made: Any = declared
    where = ".".join(place)
    in_parts = issubclass(made, Parts)
    found: dict[str, Any] = dict(made.OUTPUTS)
    for name, annotation in inspect.get_annotations(made).items():
        given = vars(made).get(name)
        if name in found:
            raise TypeError(f"{where}.{name} stands twice")
        if not isinstance(given, _Declared):
            raise TypeError(
                f"{where}.{name}: {given!r}, expected a channel with its quantity and its sentence"
            )
        if given.of is not None and issubclass(given.of, Parts) and not in_parts:
            raise TypeError(
                f"{where}.{name}: {given.of.__name__} has no fixed columns, expected it beside this class"
            )
        one = given.of if given.of is not None else given.channels(name)
        expected = _annotation(one, in_parts=in_parts)
        if str(annotation) != expected:
            raise TypeError(f"{where}.{name}: {annotation}, expected {expected}")
        found[name] = one
        delattr(made, name)
    bare = [name for name, one in vars(made).items() if isinstance(one, _Declared)]
    if bare:
        raise TypeError(f"{where}.{bare[0]} has no annotation")
    if len(made.__bases__) > 1:
        raise TypeError(f"{where} has several bases, expected one, and others nested")
    made.OUTPUTS = found
    made.CHANNELS = tuple(_flat(found))
    names = [one.name for one in made.CHANNELS]
    if len(set(names)) < len(names):
        raise TypeError(
            f"{where}: records {', '.join(sorted({n for n in names if names.count(n) > 1}))} twice"
        )
    _MADE[place] = made
    return declared


def _annotation(one: ChannelKind | type[Outputs], *, in_parts: bool) -> str:
    """What the annotation of a field must say."""
    if isinstance(one, type):
        return one.__name__
    if one.components is None or in_parts:
        return "Part" if in_parts else "Part, in a class of Parts"
    return "Components" if one.components else "float"


def _flat(found: Mapping[str, Any]) -> list[ChannelKind]:
    """Channels of fields in order."""
    channels: list[ChannelKind] = []
    for one in found.values():
        nested_in: Any = one
        channels += nested_in.CHANNELS if isinstance(one, type) else (one,)
    return channels


def channel(
    quantity: str,
    sentence: str,
    components: tuple[str, ...] | None = (),
    *,
    unit: str = "",
    by_owner: bool = False,
) -> Any:
    """Channel that has the name of the field; see `ChannelKind`."""
    return _Declared(lambda name: ChannelKind(name, quantity, sentence, components, unit, by_owner))


def largest(quantity: str, of: str, components: tuple[str, ...] | None = (), **seen: str) -> Any:
    """Channel ``OF_max``: largest value of the channel `of` since the last record; see `interval_extremes`."""
    return _Declared(lambda _name: interval_extremes(of, quantity, components=components, **seen)[0])


def smallest(quantity: str, of: str, components: tuple[str, ...] | None = (), **seen: str) -> Any:
    """Channel ``OF_min``, see `largest`."""
    return _Declared(lambda _name: interval_extremes(of, quantity, components=components, **seen)[1])


def nested(of: type[O]) -> Any:
    """Another class of outputs, whose channels keep their names."""
    found: Any = of
    return _Declared(None, found)


def largest_of_all(of: type[O]) -> Any:
    """As another class of outputs, of each of its channels the largest value since the last record."""
    return _Declared(lambda _name: _extremes(of, 0))


def smallest_of_all(of: type[O]) -> Any:
    """As another class of outputs, of each of its channels the smallest value since the last record."""
    return _Declared(lambda _name: _extremes(of, 1))


def _extremes(seen: Any, which: int) -> type[Outputs]:
    """The class with other channels; its record is the same."""
    channels = {
        one.name: interval_extremes(one.name, one.quantity, components=one.components)[which]
        for one in seen.CHANNELS
    }
    words = {"OUTPUTS": channels, "CHANNELS": tuple(channels.values()), "record": staticmethod(seen.record)}
    return type(seen.__name__, (seen,), words)


class Columns(int):
    """Where the outputs of a component are in a record: its first column, and by name where each of its channels is."""

    _places: Mapping[str, tuple[int, int]]

    def __new__(cls, first: int, channels: Sequence[tuple[str, int]]) -> Self:
        """Of channels with their numbers of columns, from a column on."""
        made = super().__new__(cls, first)
        places, column = {}, first
        for name, width in channels:
            places[name] = column, width
            column += width
        made._places = places
        return made

    def of(self, name: str) -> PlacedPart:
        """Where a channel is; one that is not recorded has no columns."""
        return PlacedPart(*self._places.get(name, (-1, 0)))

    def at(self, declared: type[Outputs]) -> int:
        """Column where a class of outputs begins; -1 if the component records nothing of it.

        Raises
        ------
        TypeError
            If its channels do not follow each other.
        """
        found = [self.of(one.name) for one in declared.CHANNELS]
        if all(width == 0 for _, width in found):
            return -1
        column = first = found[0][0]
        for one, (place, width) in zip(declared.CHANNELS, found, strict=True):
            if place != column or width != len(one.columns()):
                raise TypeError(
                    f"{declared.__name__}: channel {one.name!r} does not follow the one before it"
                )
            column += width
        return first
