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
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import (
    lower_builtin,
    lower_cast,
    lower_getattr,
    lower_getattr_generic,
    lower_setattr_generic,
)
from numba.core.typeconv import Conversion
from numba.core.typing.context import BaseContext
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_getattr, infer_global
from numba.core.typing.templates import signature as call_signature
from numba.extending import NativeValue, register_model, typeof_impl, unbox
from numba.np import numpy_support
from numpy.typing import NDArray

from heavylift.numerics.arrays import (
    WORD,
    Pointer,
    Words,
    _PointerModel,
    declared_types,
    described,
    rebuild_array,
    unbox_address,
)
from heavylift.numerics.hints import array_scalar

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
    def numba_type(cls) -> RecordType:
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


def _field_type(of_field: np.dtype[Any]) -> Any:
    """Numba type of a field."""
    if of_field.subdtype is not None:
        scalar, shape = of_field.subdtype
        return types.Array(numpy_support.from_dtype(scalar), len(shape), "C")
    if issubclass(of_field.type, Record):
        return RecordType(of_field.type)
    return numpy_support.from_dtype(of_field)


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

    def numba_type(self) -> LaneRecordsType:
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

    def numba_type(self) -> RecordsType:
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


# ---- in kernels ----


class RecordType(Pointer):
    """Numba type of a record: a pointer to it."""

    def __init__(self, record: type[Record]) -> None:
        self.record = record
        super().__init__(name=f"{record.__module__}.{record.__qualname__}")

    def accept(self, value: Any, where: str) -> Any:
        """Only a record of the class or of a subclass."""
        if not isinstance(value, self.record):
            raise TypeError(f"{where}: {type(value).__name__}, expected {self.record.__name__}")
        return value

    def can_convert_to(self, typingctx: Any, other: Any) -> Any:
        """A subclass begins with the fields of its base."""
        del typingctx
        if isinstance(other, RecordType) and issubclass(self.record, other.record):
            return Conversion.exact if self.record is other.record else Conversion.safe
        return None

    def described(self) -> str:
        """All that compiled code knows of it."""
        parts = [f"{name} {place} {described(of)}" for name, (of, place) in self.record.fields_of.items()]
        shapes = [str(self.record.layout[name].shape) for name in self.record.fields_of]
        return f"{self}({', '.join(parts)}; {shapes}; {self.record.layout.itemsize})"


class RecordsType(Words):
    """Numba type of an array of records: its address and length."""

    word_count = 2

    def __init__(self, record: type[Record]) -> None:
        self.record = record
        super().__init__(name=f"Records[{record.__module__}.{record.__qualname__}]")

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

    def rebuild(self, context: Any, builder: Any, words: list[Any]) -> Any:
        """Structure from address and length."""
        made = cgutils.create_struct_proxy(self)(context, builder)
        made.data = builder.inttoptr(words[0], WORD.as_pointer())
        made.count = words[1]
        return made._getvalue()  # noqa: SLF001

    def to_words(self, context: Any, builder: Any, value: Any) -> list[Any]:
        """Address and length of a structure."""
        made = cgutils.create_struct_proxy(self)(context, builder, value)
        return [builder.ptrtoint(made.data, WORD), made.count]


class LaneRecordsType(Words):
    """Numba type of an array of records of lanes: its address, its length, and its lanes unless the type has them."""

    word_count = 3

    def __init__(self, record: type[Record], lanes: int) -> None:
        self.record, self.lanes = record, lanes
        super().__init__(name=f"LaneRecords[{record.__module__}.{record.__qualname__}, {lanes}]")

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

    def rebuild(self, context: Any, builder: Any, words: list[Any]) -> Any:
        """Structure from address, length and lanes."""
        made = cgutils.create_struct_proxy(self)(context, builder)
        made.data = builder.inttoptr(words[0], WORD.as_pointer())
        made.count, made.lanes = words[1], words[2]
        return made._getvalue()  # noqa: SLF001

    def to_words(self, context: Any, builder: Any, value: Any) -> list[Any]:
        """Address, length and lanes of a structure."""
        made = cgutils.create_struct_proxy(self)(context, builder, value)
        return [builder.ptrtoint(made.data, WORD), made.count, made.lanes]


class LaneRecordType(types.Type):
    """Numba type of one record of lanes."""

    def __init__(self, record: type[Record], lanes: int) -> None:
        self.record, self.lanes = record, lanes
        super().__init__(name=f"LaneRecord[{record.__module__}.{record.__qualname__}, {lanes}]")


@register_model(LaneRecordsType)
@register_model(LaneRecordType)
class _LanesModel(models.StructModel):
    def __init__(self, manager: Any, of_type: Any) -> None:
        members = [("data", types.misc.CPointer(types.int64)), ("count", types.int64), ("lanes", types.int64)]
        super().__init__(manager, of_type, members)


@infer_getattr
class _LaneFields(AttributeTemplate):
    key = LaneRecordType

    def generic_resolve(self, of_type: Any, name: str) -> Any:
        """A vector of lanes."""
        return types.Array(types.float64, 1, "C") if name in of_type.record.fields_of else None


@lower_getattr_generic(LaneRecordType)
def _lane_field(context: Any, builder: Any, of_type: Any, value: Any, name: str) -> Any:
    one = cgutils.create_struct_proxy(of_type)(context, builder, value)
    lanes = ir.Constant(WORD, of_type.lanes) if of_type.lanes else one.lanes
    place = list(of_type.record.fields_of).index(name)
    at = builder.gep(one.data, [builder.mul(ir.Constant(WORD, place), lanes)], source_etype=WORD)
    vector = types.Array(types.float64, 1, "C")
    return rebuild_array(context, builder, vector, [builder.ptrtoint(at, WORD), lanes])


register_model(RecordType)(_PointerModel)
unbox(RecordType)(unbox_address)


@register_model(RecordsType)
class _RecordsModel(models.StructModel):
    def __init__(self, manager: Any, of_type: Any) -> None:
        super().__init__(
            manager, of_type, [("data", types.misc.CPointer(types.int64)), ("count", types.int64)]
        )


@unbox(RecordsType)
def _unbox_records(of_type: Any, value: Any, c: Any) -> NativeValue:
    made = cgutils.create_struct_proxy(of_type)(c.context, c.builder)
    interface = c.pyapi.object_getattr_string(value, "ctypes")
    address = c.pyapi.object_getattr_string(interface, "data")
    count = c.pyapi.object_getattr_string(value, "size")
    made.data = c.builder.inttoptr(c.pyapi.long_as_longlong(address), WORD.as_pointer())
    made.count = c.pyapi.long_as_longlong(count)
    for one in (interface, address, count):
        c.pyapi.decref(one)
    return NativeValue(made._getvalue(), is_error=cgutils.is_not_null(c.builder, c.pyapi.err_occurred()))  # noqa: SLF001


_type_of_array = typeof_impl.dispatch(np.ndarray)


@typeof_impl.register(np.ndarray)
def _type_of_records(value: Any, context: Any) -> Any:
    if issubclass(value.dtype.type, Record):
        return RecordsType(value.dtype.type)
    return _type_of_array(value, context)


@typeof_impl.register(Record)
def _type_of_record(value: Record, context: Any) -> RecordType:
    del context
    return RecordType(type(value))


@lower_cast(RecordType, RecordType)
def _cast(context: Any, builder: Any, from_type: Any, to_type: Any, value: Any) -> Any:
    del context, builder, from_type, to_type
    return value


@infer_getattr
class _Fields(AttributeTemplate):
    key = RecordType

    def generic_resolve(self, of_type: Any, name: str) -> Any:
        """Type of a field."""
        if name == "words":
            return types.Array(types.float64, 1, "C")
        known = of_type.record.fields_of.get(name)
        return None if known is None else known[0]


def _place_of_field(builder: Any, of_type: Any, value: Any, name: str) -> tuple[Any, Any]:
    """Type of a field and pointer to its first word."""
    field_type, offset = of_type.record.fields_of[name]
    return field_type, builder.gep(value, [ir.Constant(WORD, offset // WORD_BYTES)], source_etype=WORD)


@lower_getattr_generic(RecordType)
def _field(context: Any, builder: Any, of_type: Any, value: Any, name: str) -> Any:
    if name == "words":
        count = ir.Constant(WORD, of_type.record.layout.itemsize // WORD_BYTES)
        floats = types.Array(types.float64, 1, "C")
        return rebuild_array(context, builder, floats, [builder.ptrtoint(value, WORD), count])
    field_type, at = _place_of_field(builder, of_type, value, name)
    if isinstance(field_type, RecordType):
        return at
    if isinstance(field_type, types.Array):
        lengths = [ir.Constant(WORD, length) for length in of_type.record.layout[name].shape]
        return rebuild_array(context, builder, field_type, [builder.ptrtoint(at, WORD), *lengths])
    data_type = context.get_data_type(field_type)
    return context.data_model_manager[field_type].load_from_data_pointer(
        builder, builder.bitcast(at, data_type.as_pointer())
    )


_resolve_setattr = BaseContext.resolve_setattr


def _refuse_what_does_not_fit(self: Any, target: Any, attr: str, value: Any) -> Any:
    """A field is set to a number of its type: a view would be written over it, a fraction cut."""
    if isinstance(target, RecordType):
        field = target.record.fields_of.get(attr, (None, 0))[0]
        cut = isinstance(field, (types.Integer, types.Boolean)) and isinstance(value, types.Float)
        if not isinstance(field, (types.Number, types.Boolean)) or cut:
            return None
    return _resolve_setattr(self, target, attr, value)


BaseContext.resolve_setattr = _refuse_what_does_not_fit


@lower_setattr_generic(RecordType)
def _set_field(context: Any, builder: Any, signature: Any, values: Any, name: str) -> None:
    field_type, at = _place_of_field(builder, signature.args[0], values[0], name)
    model = context.data_model_manager[field_type]
    data = model.as_data(builder, values[1])
    builder.store(data, builder.bitcast(at, data.type.as_pointer()))


@infer_getattr
class _ArrayAttributes(AttributeTemplate):
    key = RecordsType

    def resolve_shape(self, of_type: Any) -> Any:
        """As of an array."""
        del of_type
        return types.containers.UniTuple(types.int64, 1)

    def resolve_size(self, of_type: Any) -> Any:
        """As of an array."""
        del of_type
        return types.int64


@lower_getattr(RecordsType, "size")
def _size(context: Any, builder: Any, of_type: Any, value: Any) -> Any:
    return cgutils.create_struct_proxy(of_type)(context, builder, value).count


@lower_getattr(RecordsType, "shape")
def _shape(context: Any, builder: Any, of_type: Any, value: Any) -> Any:
    count = cgutils.create_struct_proxy(of_type)(context, builder, value).count
    return context.make_tuple(builder, types.containers.UniTuple(types.int64, 1), [count])


@infer_global(len)
class _Length(AbstractTemplate):
    def generic(self, arguments: Any, named: Any) -> Any:
        """Of an array of records."""
        del named
        of_records = isinstance(arguments[0], (RecordsType, LaneRecordsType))
        return call_signature(types.int64, *arguments) if of_records else None


@lower_builtin(len, RecordsType)
@lower_builtin(len, LaneRecordsType)
def _length(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    return cgutils.create_struct_proxy(signature.args[0])(context, builder, values[0]).count


@infer_global(operator.getitem)
class _Item(AbstractTemplate):
    def generic(self, arguments: Any, named: Any) -> Any:
        """A record, or those from one to another."""
        del named
        array, index = arguments
        if isinstance(array, RecordsType) and isinstance(index, types.Integer):
            return call_signature(RecordType(array.record), array, types.int64)
        if isinstance(array, LaneRecordsType) and isinstance(index, types.Integer):
            return call_signature(LaneRecordType(array.record, array.lanes), array, types.int64)
        if isinstance(array, RecordsType) and index == types.slice2_type:
            return call_signature(array, array, index)
        return None


def _record_pointer(builder: Any, array: Any, record: Any, place: Any) -> Any:
    words = ir.Constant(WORD, record.layout.itemsize // WORD_BYTES)
    return builder.gep(array.data, [builder.mul(place, words)], source_etype=WORD)


@lower_builtin(operator.getitem, RecordsType, types.Integer)
def _item(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    of_type = signature.args[0]
    array = cgutils.create_struct_proxy(of_type)(context, builder, values[0])
    if context.enable_boundscheck:
        cgutils.do_boundscheck(context, builder, values[1], array.count)
    return _record_pointer(builder, array, of_type.record, values[1])


@lower_builtin(operator.getitem, LaneRecordsType, types.Integer)
def _lane_item(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    of_type = signature.args[0]
    array = cgutils.create_struct_proxy(of_type)(context, builder, values[0])
    if context.enable_boundscheck:
        cgutils.do_boundscheck(context, builder, values[1], array.count)
    lanes = ir.Constant(WORD, of_type.lanes) if of_type.lanes else array.lanes
    width = builder.mul(ir.Constant(WORD, len(of_type.record.fields_of)), lanes)
    one = cgutils.create_struct_proxy(signature.return_type)(context, builder)
    one.data = builder.gep(array.data, [builder.mul(values[1], width)], source_etype=WORD)
    one.count, one.lanes = array.count, lanes
    return one._getvalue()  # noqa: SLF001


@lower_builtin(operator.getitem, RecordsType, types.slice2_type)
def _part(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    of_type = signature.args[0]
    array = cgutils.create_struct_proxy(of_type)(context, builder, values[0])
    part = context.make_helper(builder, signature.args[1], values[1])
    last = builder.select(builder.icmp_signed("<", part.stop, array.count), part.stop, array.count)
    made = cgutils.create_struct_proxy(of_type)(context, builder)
    made.data = _record_pointer(builder, array, of_type.record, part.start)
    count = builder.sub(last, part.start)
    zero = ir.Constant(WORD, 0)
    made.count = builder.select(builder.icmp_signed("<", count, zero), zero, count)
    return made._getvalue()  # noqa: SLF001


def numbers_in(group: Any) -> list[NDArray[np.float64]]:
    """All floats and records that a group of arrays holds, as arrays that can be kept and put back; views."""
    found = []
    for value in group:
        if isinstance(value, Record):
            found.append(value.words)
        elif isinstance(value, np.ndarray) and (value.dtype == np.float64 or value.dtype.names):
            found.append(value)
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
    of_type = RecordType(record)
    words = record.layout.itemsize // WORD_BYTES

    def seen(values: NDArray[np.float64], place: int) -> R:
        found: R = values[place : place + words].view(record.layout)[0]
        return found

    class Template(AbstractTemplate):
        key = seen

        def generic(self, arguments: Any, named: Any) -> Any:
            array, _ = arguments
            flat = isinstance(array, types.Array) and array.ndim == 1 and array.layout == "C"
            return None if named or not flat else call_signature(of_type, array, types.int64)

    def see(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        if context.enable_boundscheck and words > 0:
            last = builder.add(arguments[1], ir.Constant(WORD, words - 1))
            cgutils.do_boundscheck(context, builder, last, builder.extract_value(array.shape, 0))
        data = builder.bitcast(array.data, WORD.as_pointer())
        return builder.gep(data, [arguments[1]], source_etype=WORD)

    infer_global(seen, types.Function(Template))
    lower_builtin(seen, types.Array, types.Integer)(see)
    return seen


def copy_record(target: R, source: R) -> None:
    """All fields of a record into another one of its class; kernels copy the memory."""
    target.words[:] = source.words


def clear_record(record: Record) -> None:
    """All fields 0."""
    record.words[:] = 0.0


def _words_of(context: Any, builder: Any, of_type: Any, value: Any) -> tuple[Any, Any]:
    """Address and number of words of a record."""
    if isinstance(of_type, LaneRecordType):
        one = cgutils.create_struct_proxy(of_type)(context, builder, value)
        lanes = ir.Constant(WORD, of_type.lanes) if of_type.lanes else one.lanes
        return one.data, builder.mul(ir.Constant(WORD, len(of_type.record.fields_of)), lanes)
    return value, ir.Constant(WORD, of_type.record.layout.itemsize // WORD_BYTES)


@infer_global(copy_record)
@infer_global(clear_record)
class _OfRecords(AbstractTemplate):
    def generic(self, arguments: Any, named: Any) -> Any:
        """Of one record, or of two of one class."""
        del named
        known = all(
            isinstance(one, (RecordType, LaneRecordType)) and one == arguments[0] for one in arguments
        )
        return call_signature(types.none, *arguments) if known else None


@lower_builtin(copy_record, RecordType, RecordType)
@lower_builtin(copy_record, LaneRecordType, LaneRecordType)
def _copy(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    target, count = _words_of(context, builder, signature.args[0], values[0])
    source, _ = _words_of(context, builder, signature.args[1], values[1])
    cgutils.raw_memmove(builder, target, source, count, WORD_BYTES)
    return context.get_dummy_value()


@lower_builtin(clear_record, RecordType)
@lower_builtin(clear_record, LaneRecordType)
def _clear(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    target, count = _words_of(context, builder, signature.args[0], values[0])
    with cgutils.for_range(builder, count) as loop:
        builder.store(ir.Constant(WORD, 0), builder.gep(target, [loop.index], source_etype=WORD))
    return context.get_dummy_value()
