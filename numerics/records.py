"""Rows of memory with named fields: what a kind stores for each of its components.

A subclass of `Record` lists fields as a dataclass does: ``mass: float``, ``count: int``, ``slack: bool``,
``position: Vector``, or another record. ``twist: Annotated[NDArray[np.float64], (6,), "velocity"]`` spans the fields
from ``velocity`` on: it shows six numbers of them as one vector and takes no memory. The ``layout`` is a NumPy dtype:
``row.mass`` and ``row.position[2]`` mean the same in kernels and in plain Python, where a record is a NumPy scalar that
shares its memory, and ``rows["mass"]`` are the masses of all. In kernels a record is a pointer: a field costs one load,
and nothing counts columns by hand.
"""

from __future__ import annotations

import ctypes
import operator
import typing
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Generic, Self, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import (
    ArrayType,
    KernelType,
    NumberType,
    Pointer,
    Words,
    declared_types,
    described,
)
from heavylift.numerics.hints import array_scalar
from heavylift.numerics.jit import when_compiling

__all__ = [
    "Matrix3",
    "Matrix6",
    "Quaternion",
    "Record",
    "Records",
    "Vector",
    "Vector6",
    "filled",
    "filled_rows",
    "record_at",
    "records",
]

when_compiling("heavylift.numerics.records_code")

Vector = Annotated[NDArray[np.float64], (3,)]
"""Field of three numbers; one of another shape is ``Annotated[NDArray[...], shape]``."""
Quaternion = Annotated[NDArray[np.float64], (4,)]
Vector6 = Annotated[NDArray[np.float64], (6,)]
Lanes = Annotated[NDArray[np.float64], (1,)]
"""Field of `LaneRecords`: a vector whose length the array says."""
Matrix3 = Annotated[NDArray[np.float64], (3, 3)]
Matrix6 = Annotated[NDArray[np.float64], (6, 6)]

LINE = 64
"""Bytes in a cache line."""

WORD_BYTES = 8

R_co = TypeVar("R_co", bound="Record", covariant=True)
R = TypeVar("R", bound="Record")

if TYPE_CHECKING:

    class _Scalar:  # NumPy's stubs say that nobody inherits from a scalar
        @property
        def __array_interface__(self) -> dict[str, Any]: ...
        def __getitem__(self, name: str) -> Any: ...
        def __setitem__(self, name: str, value: Any) -> None: ...

else:
    _Scalar = np.void


class Record(_Scalar):
    """Base of all records. A subclass begins with the fields of its base.

    Attributes
    ----------
    layout
        Its dtype: fields in order, each from a whole word; with ``whole_lines=True`` records fill cache lines.
    """

    layout: ClassVar[np.dtype[Any]]
    fields_of: ClassVar[dict[str, tuple[Any, int]]]

    def __init_subclass__(cls, *, whole_lines: bool = False) -> None:
        """Lay the fields out."""
        super().__init_subclass__()
        names, formats, place = [], [], 0
        offsets: list[int] = []
        for name, annotation in declared_types(cls).items():
            if typing.get_origin(annotation) is ClassVar or name in ("layout", "fields_of"):
                continue
            of_field = _field_layout(cls, name, annotation)
            first = _first_of_span(annotation)
            names.append(name)
            formats.append(of_field)
            if first is not None:
                offsets.append(offsets[names.index(first)])
                continue
            offsets.append(place)
            place += -(-of_field.itemsize // WORD_BYTES) * WORD_BYTES
        size = -(-place // LINE) * LINE if whole_lines else place
        plain = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})
        cls.layout = np.dtype((cls, plain))
        cls.fields_of = {
            name: (_field_type(of_field), offset)
            for name, of_field, offset in zip(names, formats, offsets, strict=True)
        }
        for name in names:
            setattr(cls, name, property(operator.itemgetter(name), _setter(name)))

    @property
    def address(self) -> int:
        """Where it is in memory."""
        return int(np.frombuffer(self, dtype=np.uint8).ctypes.data)  # type: ignore[call-overload]

    @property
    def words(self) -> NDArray[np.float64]:
        """All of it as words that are copied or cleared together; a view, in kernels too."""
        count = type(self).layout.itemsize // WORD_BYTES
        memory: Any = (ctypes.c_double * count).from_address(self.address)
        memory.owner = self
        return np.frombuffer(memory, dtype=np.float64)

    @classmethod
    def kernel_type(cls) -> RecordType:
        """Type in kernels."""
        return RecordType(cls)

    @classmethod
    def one(cls) -> Self:
        """A single record, all fields 0."""
        made: Self = records(cls, 1)[0]
        return made


def _setter(name: str) -> Any:
    def put(record: Any, value: Any) -> None:
        record[name] = value

    return put


def _field_layout(owner: type, name: str, annotation: Any) -> np.dtype[Any]:
    """Dtype of a field.

    Raises
    ------
    TypeError
        If records have no such fields.
    """
    simple = {float: np.float64, int: np.int64, bool: np.bool_}
    if annotation in simple:
        return np.dtype(simple[annotation])
    if isinstance(annotation, type) and issubclass(annotation, Record):
        return annotation.layout
    if hasattr(annotation, "record"):  # a class that says what it is in memory
        of_class: type[Record] = annotation.record()
        return of_class.layout
    if typing.get_origin(annotation) is Annotated:
        array, shape = typing.get_args(annotation)[:2]
        return np.dtype((array_scalar(array), shape))
    raise TypeError(
        f"{owner.__name__}.{name}: {annotation!r}, expected a number, an array of known shape or a record"
    )


def _first_of_span(annotation: Any) -> str | None:
    """Name of the first of the neighbouring fields that a field spans; None if it has memory of its own."""
    words = typing.get_args(annotation) if typing.get_origin(annotation) is Annotated else ()
    return words[2] if len(words) > 2 else None


def _field_type(of_field: np.dtype[Any]) -> KernelType:
    """Type of a field in kernels."""
    if of_field.subdtype is not None:
        scalar, shape = of_field.subdtype
        return ArrayType(scalar, len(shape))
    if issubclass(of_field.type, Record):
        return RecordType(of_field.type)
    return NumberType(of_field)


if TYPE_CHECKING:

    class Records(Generic[R_co]):
        """One-dimensional array of records."""

        shape: tuple[int]
        size: int
        nbytes: int
        dtype: np.dtype[Any]
        ctypes: Any

        @overload
        def __getitem__(self, place: int | np.integer[Any]) -> R_co: ...
        @overload
        def __getitem__(self, place: slice | NDArray[Any] | list[int]) -> Records[R_co]: ...
        @overload
        def __getitem__(self, place: str) -> NDArray[Any]: ...
        def __getitem__(self, place: Any) -> Any: ...
        @overload
        def __setitem__(self, place: int | np.integer[Any], value: Record) -> None: ...
        @overload
        def __setitem__(
            self, place: slice | NDArray[Any] | list[int], value: Records[Any] | Record
        ) -> None: ...
        @overload
        def __setitem__(self, place: str, value: Any) -> None: ...
        def __setitem__(self, place: Any, value: Any) -> None: ...
        def __len__(self) -> int: ...
        def __iter__(self) -> typing.Iterator[R_co]: ...
        def copy(self) -> Records[R_co]: ...  # noqa: D102
        def view(self, dtype: Any) -> NDArray[Any]: ...  # noqa: D102

else:

    class Records:
        """One-dimensional array of records: ``Records[Row]`` is the annotation of a field or parameter."""

        def __class_getitem__(cls, record: type[Record]) -> Any:
            """The same object each time."""
            return _records_of(record)


if TYPE_CHECKING:

    class LaneRecords(Records[R_co]):
        """Records whose fields are vectors of lanes, as many as the array says."""

else:

    class LaneRecords:
        """Records whose fields are vectors of lanes; the record lists them as ``Lanes``. `lane_records` makes one."""

        def __class_getitem__(cls, record: type[Record]) -> Any:
            """The same object each time."""
            return known_lanes(record, 0)


class _LaneRecordsOf:
    """Annotation of an array of records of lanes."""

    def __init__(self, record: type[Record], lanes: int) -> None:
        self.record, self.lanes = record, lanes

    def kernel_type(self) -> LaneRecordsType:
        """Type in kernels."""
        return LaneRecordsType(self.record, self.lanes)


@cache
def known_lanes(record: Any, lanes: int) -> Any:
    """Annotation for kernels that know the number of lanes when they are compiled; the arrays are the same."""
    return _LaneRecordsOf(record, lanes)


def _with_lanes(record: Any, lanes: int) -> Any:
    """The record with vectors of some length."""
    fields = dict.fromkeys(record.fields_of, Annotated[NDArray[np.float64], (lanes,)])
    return type(
        f"{record.__name__}{lanes}", (Record,), {"__annotations__": fields, "__module__": record.__module__}
    )


_lanes_of: typing.Callable[[Any, int], Any] = cache(_with_lanes)
"""As `_with_lanes`, one class for each length."""


def lane_records(record: type[R], count: int, lanes: int) -> LaneRecords[R]:
    """Array of records whose fields are vectors of some lanes, all 0; it begins at a cache line."""
    made: Any = records(_lanes_of(record, lanes), count)
    return made


class _RecordsOf:
    """Annotation of an array of records."""

    def __init__(self, record: type[Record]) -> None:
        self.record = record

    def kernel_type(self) -> RecordsType:
        """Type in kernels."""
        return RecordsType(self.record)


@cache
def _records_of(record: type[Record]) -> _RecordsOf:
    return _RecordsOf(record)


def records(record: type[R], rows: int | typing.Iterable[R]) -> Records[R]:
    """Array of records that begins at a cache line.

    Parameters
    ----------
    record
        Their class.
    rows
        How many, all fields 0; or the records themselves, as `filled` makes them.

    Raises
    ------
    TypeError
        If one of them is another thing, such as the values of its fields in order.
    """
    given = [] if isinstance(rows, int) else list(rows)
    count = rows if isinstance(rows, int) else len(given)
    size = count * record.layout.itemsize
    buffer = np.zeros(size + LINE, dtype=np.uint8)
    start = -buffer.ctypes.data % LINE
    made: Any = buffer[start : start + size].view(record.layout)
    for i, row in enumerate(given):
        if not isinstance(row, record):
            raise TypeError(
                f"{type(row).__name__} in a table of {record.__name__}: expected `filled` records"
            )
        made[i] = row
    return made


@cache
def _own_fields(record: Any) -> dict[str, None]:
    """Names of its fields, without those that span others."""
    found = declared_types(record)
    return {name: None for name in record.fields_of if _first_of_span(found[name]) is None}


def filled(record: type[R], **fields: Any) -> R:
    """A record by the names of all its fields: what packers make rows of.

    Parameters
    ----------
    record
        Its class.
    fields
        Values: numbers, vectors, of a record within that record.

    Raises
    ------
    TypeError
        If a field is missing, there is none of that name, or a record within is given by its values in order.

    Examples
    --------
    >>> class Spring(Record):
    ...     marker: int
    ...     stiffness: float
    >>> records(Spring, [filled(Spring, stiffness=2e3, marker=k) for k in range(2)])["stiffness"]
    array([2000., 2000.])
    >>> filled(Spring, marker=1)
    Traceback (most recent call last):
    TypeError: Spring without 'stiffness'
    """
    _check_names(record, fields)
    made = record.one()
    within = _records_within(typing.cast("Any", record))
    for name, value in fields.items():
        if name in within and not isinstance(value, within[name]):
            raise TypeError(
                f"{record.__name__}.{name}: {type(value).__name__}, expected a {within[name].__name__}"
            )
        made[name] = value
    return made


def filled_rows(record: type[R], **columns: Any) -> Records[R]:
    """Array of records by the columns of all their fields: as `filled`, for tables that are made of arrays.

    Parameters
    ----------
    record
        Their class.
    columns
        Values of each field in all rows, of one length.

    Raises
    ------
    TypeError
        As `filled`.
    ValueError
        If they differ in length.

    Examples
    --------
    >>> class Level(Record):
    ...     time: float
    ...     height: float
    >>> filled_rows(Level, time=[0.0, 60.0], height=[0.5, 0.75])[1].height
    np.float64(0.75)
    """
    _check_names(record, columns)
    counts = {name: len(values) for name, values in columns.items()}
    if len(set(counts.values())) > 1:
        raise ValueError(f"{record.__name__}: columns of different lengths, {counts}")
    made = records(record, next(iter(counts.values()), 0))
    for name, values in columns.items():
        made[name] = values
    return made


def _check_names(record: Any, fields: typing.Mapping[str, Any]) -> None:
    """Refuse fields that are missing or unknown."""
    own = _own_fields(record)
    if fields.keys() != own.keys():
        unknown, missing = fields.keys() - own.keys(), own.keys() - fields.keys()
        problems = [f"with unknown {', '.join(map(repr, sorted(unknown)))}"] if unknown else []
        problems += [f"without {', '.join(repr(name) for name in own if name in missing)}"] if missing else []
        raise TypeError(f"{record.__name__} {' and '.join(problems)}")


@cache
def _records_within(record: Any) -> dict[str, type[Record]]:
    """Classes of those of its fields that are records."""
    found = {name: record.layout[name].type for name in record.fields_of}
    return {name: of_class for name, of_class in found.items() if issubclass(of_class, Record)}


# ---- types in kernels ----


class RecordType(Pointer):
    """A record: a pointer to it."""

    def __init__(self, record: type[Record]) -> None:
        self.record = record
        super().__init__(f"{record.__module__}.{record.__qualname__}", record)

    def accept(self, value: Any, where: str) -> Any:
        """Only a record of the class or of a subclass."""
        if not isinstance(value, self.record):
            raise TypeError(f"{where}: {type(value).__name__}, expected {self.record.__name__}")
        return value

    def described(self) -> str:
        """All that compiled code knows of it."""
        parts = [f"{name} {place} {described(of)}" for name, (of, place) in self.record.fields_of.items()]
        shapes = [str(self.record.layout[name].shape) for name in self.record.fields_of]
        return f"{self}({', '.join(parts)}; {shapes}; {self.record.layout.itemsize})"


class RecordsType(Words):
    """An array of records: its address and length."""

    word_count = 2

    def __init__(self, record: type[Record]) -> None:
        self.record = record
        super().__init__(f"Records[{record.__module__}.{record.__qualname__}]", record)

    def words(self, value: Any, where: str) -> list[int]:
        """Address and length.

        Raises
        ------
        TypeError
            If kernels would misread the array; names the place and both types.
        """
        fits = isinstance(value, np.ndarray) and value.ndim == 1 and value.flags.c_contiguous
        if not fits or value.dtype != self.record.layout:
            found = (
                f"{value.dtype.type.__name__} {value.ndim}-d"
                if isinstance(value, np.ndarray)
                else type(value).__name__
            )
            raise TypeError(f"{where}: {found}, expected a contiguous array of {self.record.__name__}")
        return [value.ctypes.data, len(value)]

    def read_as(self, other: Any) -> bool:
        """Whether code for another type reads it rightly."""
        same = isinstance(other, RecordsType) and issubclass(self.record, other.record)
        return same and self.record.layout.itemsize == other.record.layout.itemsize

    def described(self) -> str:
        """All that compiled code knows of it."""
        return f"Records[{RecordType(self.record).described()}]"


class LaneRecordsType(Words):
    """An array of records of lanes: its address, its length, and its lanes unless the type has them."""

    word_count = 3

    def __init__(self, record: type[Record], lanes: int) -> None:
        self.record, self.lanes = record, lanes
        super().__init__(f"LaneRecords[{record.__module__}.{record.__qualname__}, {lanes}]", record, lanes)

    def words(self, value: Any, where: str) -> list[int]:
        """Address, length and lanes.

        Raises
        ------
        TypeError
            If kernels would misread the array.
        """
        lanes = value.dtype[0].shape[0] if isinstance(value, np.ndarray) and value.dtype.names else 0
        if lanes == 0 or self.lanes not in {0, lanes}:
            raise TypeError(f"{where}: expected {self}")
        return [*RecordsType(_lanes_of(self.record, lanes)).words(value, where), lanes]

    def read_as(self, other: Any) -> bool:
        """Whether code for another type reads it rightly."""
        return (
            isinstance(other, LaneRecordsType)
            and self.record is other.record
            and other.lanes in {0, self.lanes}
        )

    def described(self) -> str:
        """All that compiled code knows of it."""
        return f"{self}{list(self.record.fields_of)}"


def numbers_in(group: Any) -> list[NDArray[np.float64]]:
    """All floats and records that a group of arrays holds, as arrays that can be kept and put back; views."""
    found = []
    for value in group:
        if isinstance(value, Record):
            found.append(value.words)
        elif isinstance(value, np.ndarray) and (value.dtype == np.float64 or value.dtype.names):
            found.append(value)
    return found


class RecordAt(Generic[R]):
    """What `record_at` makes; see there."""

    def __init__(self, record: type[R]) -> None:
        self.record, self.words = record, record.layout.itemsize // WORD_BYTES

    def __call__(self, values: NDArray[np.float64], place: int) -> R:
        """The record at a place."""
        found: R = values[place : place + self.words].view(self.record.layout)[0]
        return found


def record_at(record: type[R]) -> typing.Callable[[NDArray[np.float64], int], R]:
    """Function that sees a record in a flat array of floats, from a place on: for data of changing length.

    Parameters
    ----------
    record
        Class of the record.

    Returns
    -------
    callable
        For kernels and Python; it does not look at the end of the array unless bounds are checked.
    """
    return RecordAt(record)


def copy_record(target: R, source: R) -> None:
    """All fields of a record into another one of its class; kernels copy the memory."""
    target.words[:] = source.words


def clear_record(record: Record) -> None:
    """All fields 0."""
    record.words[:] = 0.0
