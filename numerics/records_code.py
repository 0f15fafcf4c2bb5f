"""What the compiler knows of records, see `heavylift.numerics.records`: imported when something is compiled."""

from __future__ import annotations

import operator
from functools import cache
from typing import Any

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

from heavylift.numerics.arrays_code import (
    WORD,
    CompiledPointer,
    CompiledWords,
    PointerModel,
    compiled_as,
    compiled_type,
    rebuild_array,
    unbox_address,
)
from heavylift.numerics.records import (
    WORD_BYTES,
    LaneRecordsType,
    Record,
    RecordAt,
    RecordsType,
    RecordType,
    clear_record,
    copy_record,
)


@compiled_as(RecordType)
class CompiledRecord(CompiledPointer):
    """A record: a pointer to it."""

    def __init__(self, kind: RecordType) -> None:
        self.record = kind.record
        super().__init__(name=kind.name)

    @property
    def key(self) -> Any:
        """Classes of one name differ."""
        return self.name, self.record

    def can_convert_to(self, typingctx: Any, other: Any) -> Any:
        """A subclass begins with the fields of its base."""
        del typingctx
        if isinstance(other, CompiledRecord) and issubclass(self.record, other.record):
            return Conversion.exact if self.record is other.record else Conversion.safe
        return None


@compiled_as(RecordsType)
class CompiledRecords(CompiledWords):
    """An array of records: its address and length."""

    def __init__(self, kind: RecordsType) -> None:
        self.record = kind.record
        super().__init__(name=kind.name)

    @property
    def key(self) -> Any:
        """Classes of one name differ."""
        return self.name, self.record

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


@compiled_as(LaneRecordsType)
class CompiledLaneRecords(CompiledWords):
    """An array of records of lanes: its address, its length, and its lanes unless the type has them."""

    def __init__(self, kind: LaneRecordsType) -> None:
        self.record, self.lanes = kind.record, kind.lanes
        super().__init__(name=kind.name)

    @property
    def key(self) -> Any:
        """Classes of one name differ."""
        return self.name, self.record

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


class CompiledLaneRecord(types.Type):
    """One record of lanes."""

    def __init__(self, record: type[Record], lanes: int) -> None:
        self.record, self.lanes = record, lanes
        super().__init__(name=f"LaneRecord[{record.__module__}.{record.__qualname__}, {lanes}]")

    @property
    def key(self) -> Any:
        """Classes of one name differ."""
        return self.name, self.record


@register_model(CompiledLaneRecords)
@register_model(CompiledLaneRecord)
class _LanesModel(models.StructModel):
    def __init__(self, manager: Any, of_type: Any) -> None:
        members = [("data", types.misc.CPointer(types.int64)), ("count", types.int64), ("lanes", types.int64)]
        super().__init__(manager, of_type, members)


@infer_getattr
class _LaneFields(AttributeTemplate):
    key = CompiledLaneRecord

    def generic_resolve(self, of_type: Any, name: str) -> Any:
        """A vector of lanes."""
        return types.Array(types.float64, 1, "C") if name in of_type.record.fields_of else None


@lower_getattr_generic(CompiledLaneRecord)
def _lane_field(context: Any, builder: Any, of_type: Any, value: Any, name: str) -> Any:
    one = cgutils.create_struct_proxy(of_type)(context, builder, value)
    lanes = ir.Constant(WORD, of_type.lanes) if of_type.lanes else one.lanes
    place = list(of_type.record.fields_of).index(name)
    at = builder.gep(one.data, [builder.mul(ir.Constant(WORD, place), lanes)], source_etype=WORD)
    vector = types.Array(types.float64, 1, "C")
    return rebuild_array(context, builder, vector, [builder.ptrtoint(at, WORD), lanes])


register_model(CompiledRecord)(PointerModel)
unbox(CompiledRecord)(unbox_address)


@register_model(CompiledRecords)
class _RecordsModel(models.StructModel):
    def __init__(self, manager: Any, of_type: Any) -> None:
        super().__init__(
            manager, of_type, [("data", types.misc.CPointer(types.int64)), ("count", types.int64)]
        )


@unbox(CompiledRecords)
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
        return compiled_type(RecordsType(value.dtype.type))
    return _type_of_array(value, context)


@typeof_impl.register(Record)
def _type_of_record(value: Record, context: Any) -> Any:
    del context
    return compiled_type(RecordType(type(value)))


@lower_cast(CompiledRecord, CompiledRecord)
def _cast(context: Any, builder: Any, from_type: Any, to_type: Any, value: Any) -> Any:
    del context, builder, from_type, to_type
    return value


@infer_getattr
class _Fields(AttributeTemplate):
    key = CompiledRecord

    def generic_resolve(self, of_type: Any, name: str) -> Any:
        """Type of a field."""
        if name == "words":
            return types.Array(types.float64, 1, "C")
        known = of_type.record.fields_of.get(name)
        return None if known is None else compiled_type(known[0])


def _place_of_field(builder: Any, of_type: Any, value: Any, name: str) -> tuple[Any, Any]:
    """Type of a field and pointer to its first word."""
    kind, offset = of_type.record.fields_of[name]
    return compiled_type(kind), builder.gep(
        value, [ir.Constant(WORD, offset // WORD_BYTES)], source_etype=WORD
    )


@lower_getattr_generic(CompiledRecord)
def _field(context: Any, builder: Any, of_type: Any, value: Any, name: str) -> Any:
    if name == "words":
        count = ir.Constant(WORD, of_type.record.layout.itemsize // WORD_BYTES)
        floats = types.Array(types.float64, 1, "C")
        return rebuild_array(context, builder, floats, [builder.ptrtoint(value, WORD), count])
    field_type, at = _place_of_field(builder, of_type, value, name)
    if isinstance(field_type, CompiledRecord):
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
    if isinstance(target, CompiledRecord):
        kind = target.record.fields_of.get(attr, (None, 0))[0]
        field = None if kind is None else compiled_type(kind)
        cut = isinstance(field, (types.Integer, types.Boolean)) and isinstance(value, types.Float)
        if not isinstance(field, (types.Number, types.Boolean)) or cut:
            return None
    return _resolve_setattr(self, target, attr, value)


BaseContext.resolve_setattr = _refuse_what_does_not_fit


@lower_setattr_generic(CompiledRecord)
def _set_field(context: Any, builder: Any, signature: Any, values: Any, name: str) -> None:
    field_type, at = _place_of_field(builder, signature.args[0], values[0], name)
    model = context.data_model_manager[field_type]
    data = model.as_data(builder, values[1])
    builder.store(data, builder.bitcast(at, data.type.as_pointer()))


@infer_getattr
class _ArrayAttributes(AttributeTemplate):
    key = CompiledRecords

    def resolve_shape(self, of_type: Any) -> Any:
        """As of an array."""
        del of_type
        return types.containers.UniTuple(types.int64, 1)

    def resolve_size(self, of_type: Any) -> Any:
        """As of an array."""
        del of_type
        return types.int64


@lower_getattr(CompiledRecords, "size")
def _size(context: Any, builder: Any, of_type: Any, value: Any) -> Any:
    return cgutils.create_struct_proxy(of_type)(context, builder, value).count


@lower_getattr(CompiledRecords, "shape")
def _shape(context: Any, builder: Any, of_type: Any, value: Any) -> Any:
    count = cgutils.create_struct_proxy(of_type)(context, builder, value).count
    return context.make_tuple(builder, types.containers.UniTuple(types.int64, 1), [count])


@infer_global(len)
class _Length(AbstractTemplate):
    def generic(self, arguments: Any, named: Any) -> Any:
        """Of an array of records."""
        del named
        of_records = isinstance(arguments[0], (CompiledRecords, CompiledLaneRecords))
        return call_signature(types.int64, *arguments) if of_records else None


@lower_builtin(len, CompiledRecords)
@lower_builtin(len, CompiledLaneRecords)
def _length(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    return cgutils.create_struct_proxy(signature.args[0])(context, builder, values[0]).count


@infer_global(operator.getitem)
class _Item(AbstractTemplate):
    def generic(self, arguments: Any, named: Any) -> Any:
        """A record, or those from one to another."""
        del named
        array, index = arguments
        if isinstance(array, CompiledRecords) and isinstance(index, types.Integer):
            return call_signature(compiled_type(RecordType(array.record)), array, types.int64)
        if isinstance(array, CompiledLaneRecords) and isinstance(index, types.Integer):
            return call_signature(CompiledLaneRecord(array.record, array.lanes), array, types.int64)
        if isinstance(array, CompiledRecords) and index == types.slice2_type:
            return call_signature(array, array, index)
        return None


def _record_pointer(builder: Any, array: Any, record: Any, place: Any) -> Any:
    words = ir.Constant(WORD, record.layout.itemsize // WORD_BYTES)
    return builder.gep(array.data, [builder.mul(place, words)], source_etype=WORD)


@lower_builtin(operator.getitem, CompiledRecords, types.Integer)
def _item(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    of_type = signature.args[0]
    array = cgutils.create_struct_proxy(of_type)(context, builder, values[0])
    if context.enable_boundscheck:
        cgutils.do_boundscheck(context, builder, values[1], array.count)
    return _record_pointer(builder, array, of_type.record, values[1])


@lower_builtin(operator.getitem, CompiledLaneRecords, types.Integer)
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


@lower_builtin(operator.getitem, CompiledRecords, types.slice2_type)
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


def _words_of(context: Any, builder: Any, of_type: Any, value: Any) -> tuple[Any, Any]:
    """Address and number of words of a record."""
    if isinstance(of_type, CompiledLaneRecord):
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
            isinstance(one, (CompiledRecord, CompiledLaneRecord)) and one == arguments[0] for one in arguments
        )
        return call_signature(types.none, *arguments) if known else None


@lower_builtin(copy_record, CompiledRecord, CompiledRecord)
@lower_builtin(copy_record, CompiledLaneRecord, CompiledLaneRecord)
def _copy(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    target, count = _words_of(context, builder, signature.args[0], values[0])
    source, _ = _words_of(context, builder, signature.args[1], values[1])
    cgutils.raw_memmove(builder, target, source, count, WORD_BYTES)
    return context.get_dummy_value()


@lower_builtin(clear_record, CompiledRecord)
@lower_builtin(clear_record, CompiledLaneRecord)
def _clear(context: Any, builder: Any, signature: Any, values: Any) -> Any:
    target, count = _words_of(context, builder, signature.args[0], values[0])
    with cgutils.for_range(builder, count) as loop:
        builder.store(ir.Constant(WORD, 0), builder.gep(target, [loop.index], source_etype=WORD))
    return context.get_dummy_value()


@cache
def _type_of_place(seen: RecordAt[Any]) -> Any:
    of_type, words = compiled_type(RecordType(seen.record)), seen.words

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

    lower_builtin(seen, types.Array, types.Integer)(see)
    return types.Function(Template)


@typeof_impl.register(RecordAt)
def _type_of_record_at(value: RecordAt[Any], context: Any) -> Any:
    del context
    return _type_of_place(value)
