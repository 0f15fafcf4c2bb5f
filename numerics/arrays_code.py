"""What the compiler knows of groups of arrays, see `heavylift.numerics.arrays`: imported when something is compiled.

A type of the compiler is made from a `KernelType`: `compiled_type` of one is always the same object.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import impl_ret_borrowed, lower_cast, lower_getattr_generic
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import NativeValue, register_model, typeof_impl, unbox
from numba.np import numpy_support
from numba.np.arrayobj import populate_array

from heavylift.numerics.arrays import (
    NOTHING,
    Arrays,
    ArrayType,
    KernelType,
    NumberType,
    Reference,
    begins_as,
    layout,
    word_count,
)

__all__ = [
    "WORD",
    "CompiledPointer",
    "CompiledReference",
    "CompiledWords",
    "PointerModel",
    "compiled_as",
    "compiled_type",
    "constant_word",
    "rebuild_array",
    "unbox_address",
]

WORD = ir.IntType(64)

_MADE_BY: dict[type, Callable[[Any], Any]] = {
    ArrayType: lambda kind: types.Array(numpy_support.from_dtype(kind.dtype), kind.ndim, "C"),
    NumberType: lambda kind: numpy_support.from_dtype(kind.dtype),
    KernelType: {NOTHING: types.none}.__getitem__,
}


def _compiled_type(kind: KernelType) -> Any:
    """Type of the compiler."""
    return _MADE_BY[type(kind)](kind)


compiled_type: Callable[[KernelType], Any] = cache(_compiled_type)
"""Type of the compiler, the same object each time."""


class CompiledWords(types.Type):
    """What is handed over as several words, and rebuilt from them.

    Attributes
    ----------
    rebuild
        From context, builder and words to the value in compiled code.
    to_words
        From context, builder and a value in compiled code to its words.
    """

    rebuild: Callable[..., Any]
    to_words: Callable[..., list[Any]]


class CompiledPointer(types.Type):
    """What is handed over by its address."""


def compiled_as(kind: type[KernelType]) -> Callable[[type], type]:
    """Make a class of compiled types that of a class of kernel types, from which it is made."""

    def note(of_class: type) -> type:
        _MADE_BY[kind] = of_class
        return of_class

    return note


@compiled_as(Reference)
class CompiledReference(CompiledPointer):
    """A group of arrays."""

    def __init__(self, kind: Reference) -> None:
        self.group = kind.group
        super().__init__(name=kind.name)

    @property
    def key(self) -> Any:
        """Classes of one name, as in functions, differ."""
        return self.name, self.group

    def can_convert_to(self, typingctx: Any, other: Any) -> Any:
        """A subclass begins with the fields of its base."""
        del typingctx
        if isinstance(other, CompiledReference) and begins_as(self.group, other.group):
            return Conversion.exact if self.group is other.group else Conversion.safe
        return None

    def unify(self, typingctx: Any, other: Any) -> Any:
        """Never."""
        del typingctx
        return self if self == other else None


@register_model(CompiledPointer)
@register_model(CompiledReference)
class PointerModel(models.PrimitiveModel):
    """An address."""

    def __init__(self, manager: Any, of_type: Any) -> None:
        super().__init__(manager, of_type, WORD.as_pointer())


@typeof_impl.register(Arrays)
def _type_of_group(value: Arrays, context: Any) -> CompiledReference:
    del context
    return CompiledReference(Reference(type(value)))


@unbox(CompiledReference)
def unbox_address(of_type: Any, value: Any, c: Any) -> NativeValue:
    """Pointer of a Python object with an `address`."""
    del of_type
    address = c.pyapi.object_getattr_string(value, "address")
    number = cgutils.alloca_once_value(c.builder, ir.Constant(WORD, 0))
    with c.builder.if_then(cgutils.is_not_null(c.builder, address)):
        c.builder.store(c.pyapi.long_as_longlong(address), number)
        c.pyapi.decref(address)
    pointer = c.builder.inttoptr(c.builder.load(number), WORD.as_pointer())
    return NativeValue(pointer, is_error=cgutils.is_not_null(c.builder, c.pyapi.err_occurred()))


@lower_cast(CompiledReference, CompiledReference)
def _cast(context: Any, builder: Any, from_type: Any, to_type: Any, value: Any) -> Any:
    del context, builder, from_type, to_type
    return value


@infer_getattr
class _Fields(AttributeTemplate):
    key = CompiledReference

    def generic_resolve(self, reference: Any, name: str) -> Any:
        """Type of a field or class variable."""
        known = layout(reference.group)
        if name in known:
            return compiled_type(known[name][0])
        constant = getattr(reference.group, name, None)
        return None if constant is None else self.context.resolve_value_type(constant)


def constant_word(builder: Any, pointer: Any, place: int) -> Any:
    """A word of a block that never changes."""
    at = builder.gep(pointer, [ir.Constant(WORD, place)], source_etype=WORD)
    word = builder.load(at, typ=WORD)
    word.set_metadata("invariant.load", builder.module.add_metadata([]))
    return word


def rebuild_array(context: Any, builder: Any, of_type: Any, words: list[Any]) -> Any:
    """Array structure from an address and lengths."""
    array = context.make_array(of_type)(context, builder)
    itemsize = ir.Constant(WORD, context.get_abi_sizeof(context.get_data_type(of_type.dtype)))
    data = builder.inttoptr(words[0], context.get_data_type(of_type.dtype).as_pointer())
    strides = [itemsize]
    for length in reversed(words[2:]):
        strides.insert(0, builder.mul(strides[0], length))
    populate_array(array, data=data, shape=words[1:], strides=strides, itemsize=itemsize, meminfo=None)
    return array._getvalue()  # noqa: SLF001


@lower_getattr_generic(CompiledReference)
def _field(context: Any, builder: Any, reference: Any, value: Any, name: str) -> Any:
    known = layout(reference.group)
    if name not in known:
        constant = getattr(reference.group, name)
        of_type = context.typing_context.resolve_value_type(constant)
        return context.get_constant_generic(builder, of_type, constant)
    kind, place = known[name]
    of_type = compiled_type(kind)
    if isinstance(of_type, (types.Array, CompiledWords)):
        words = [constant_word(builder, value, place + i) for i in range(word_count(kind))]
        if isinstance(of_type, CompiledWords):
            return of_type.rebuild(context, builder, words)
        return impl_ret_borrowed(context, builder, of_type, rebuild_array(context, builder, of_type, words))
    word = constant_word(builder, value, place)
    if isinstance(of_type, CompiledPointer):
        return builder.inttoptr(word, WORD.as_pointer())
    if of_type == types.float64:
        return builder.bitcast(word, ir.DoubleType())
    return builder.trunc(word, ir.IntType(1)) if of_type == types.boolean else word
