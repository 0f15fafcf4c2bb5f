"""What the compiler knows of operations and tables, see `heavylift.solver.kinds`: imported to compile something."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.types.containers import BaseTuple
from numba.core.types.misc import VarArg
from numba.core.typing.templates import AbstractTemplate, Signature
from numba.core.typing.templates import signature as call_signature
from numba.extending import register_model, typeof_impl, unbox

from heavylift.numerics.arrays import Reference
from heavylift.numerics.arrays_code import (
    WORD,
    CompiledPointer,
    CompiledReference,
    PointerModel,
    compiled_as,
    compiled_type,
    constant_word,
    unbox_address,
)
from heavylift.numerics.objects_code import to_words
from heavylift.solver.kinds import NO_KINDS, WORD_BYTES, KindOperation, Members, Table, TableType


@compiled_as(TableType)
class CompiledTable(CompiledPointer):
    """A table."""

    def __init__(self, kind: TableType) -> None:
        self.table = kind.table
        super().__init__(name=kind.name)

    @property
    def key(self) -> Any:
        """Classes of one name, as in functions, differ."""
        return self.name, self.table

    def can_convert_from(self, typingctx: Any, other: Any) -> Any:
        """An empty tuple is an empty table."""
        del typingctx
        return Conversion.safe if isinstance(other, BaseTuple) and len(other) == 0 else None


register_model(CompiledTable)(PointerModel)
unbox(CompiledTable)(unbox_address)


@lower_cast(BaseTuple, CompiledTable)
def _empty_table(context: Any, builder: Any, from_type: Any, to_type: Any, value: Any) -> Any:
    del context, from_type, to_type, value
    return builder.module.globals.get(NO_KINDS) or ir.GlobalVariable(builder.module, WORD, NO_KINDS)


@typeof_impl.register(Table)
def _type_of_table(value: Table, context: Any) -> Any:
    del context
    return compiled_type(TableType(type(value)))


@cache
def _type_of(operation: KindOperation) -> Any:
    """What kernels call: of a table by its lists, of a single kind directly."""
    parameters = tuple(map(compiled_type, operation.parameters))

    class Template(AbstractTemplate):
        key = operation

        def generic(self, arguments: Any, named: Any) -> Signature | None:
            if named or not arguments:
                return None
            first = arguments[0]
            if isinstance(first, CompiledTable):
                if (
                    first.table is not operation.table
                ):  # another class of tables has another function in its place
                    return None
                return call_signature(types.none, first, *parameters)
            kinds = first.types if isinstance(first, BaseTuple) else (first,)
            if all(isinstance(kind, CompiledReference) for kind in kinds):
                for kind in kinds:
                    function = operation.chosen(kind.group)
                    if function is not None:
                        of_type = self.context.resolve_value_type(function)
                        of_type.get_call_type(self.context, (kind, *arguments[1:]), {})
                return call_signature(types.none, *arguments)
            return None

    lower_builtin(operation, CompiledTable, VarArg(types.Any))(_lower_table_call(operation))
    lower_builtin(operation, CompiledReference, VarArg(types.Any))(_lower_kind_call(operation))
    lower_builtin(operation, BaseTuple, VarArg(types.Any))(_lower_kind_call(operation))
    return types.Function(Template)


@typeof_impl.register(KindOperation)
def _type_of_operation(value: KindOperation, context: Any) -> Any:
    del context
    return _type_of(value)


@cache
def _type_of_list(members: Members) -> Any:
    class Template(AbstractTemplate):
        key = members

        def generic(self, arguments: Any, named: Any) -> Signature | None:
            if (
                named
                or not isinstance(arguments[0], CompiledTable)
                or arguments[0].table is not members.table
            ):
                return None
            if len(arguments) == 1:
                return call_signature(types.int64, *arguments)
            return call_signature(compiled_type(Reference(members.base)), arguments[0], types.int64)

    def count(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        first, last = _ends_of_list(builder, members.symbol, values[0])
        return builder.sdiv(builder.sub(last, first), ir.Constant(WORD, 2 * WORD_BYTES))

    def choose(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        first, _ = _ends_of_list(builder, members.symbol, values[0])
        pairs = builder.inttoptr(first, WORD.as_pointer())
        at = builder.gep(pairs, [builder.mul(values[1], ir.Constant(WORD, 2))], source_etype=WORD)
        return builder.inttoptr(constant_word(builder, at, 1), WORD.as_pointer())

    lower_builtin(members, CompiledTable)(count)
    lower_builtin(members, CompiledTable, types.Integer)(choose)
    return types.Function(Template)


@typeof_impl.register(Members)
def _type_of_members(value: Members, context: Any) -> Any:
    del context
    return _type_of_list(value)


def _ends_of_list(builder: Any, symbol: str, table: Any) -> tuple[Any, Any]:
    """Addresses of the first pair of a list, and behind its last."""
    module = builder.module
    slot = module.globals.get(symbol) or ir.GlobalVariable(module, WORD, symbol)
    at = builder.gep(table, [constant_word(builder, slot, 0)], source_etype=WORD)
    return constant_word(builder, at, 0), constant_word(builder, at, 1)


def _lower_table_call(operation: KindOperation) -> Callable[..., Any]:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        first, last = _ends_of_list(builder, operation.symbol, values[0])
        words = [
            word
            for of_type, value in zip(signature.args[1:], values[1:], strict=True)
            for word in to_words(context, builder, of_type, value)
        ]
        pointer = WORD.as_pointer()
        function_type = ir.FunctionType(ir.VoidType(), [pointer, *(word.type for word in words)])
        before = builder.block
        loop, after = builder.append_basic_block("serve"), builder.append_basic_block("served")
        builder.cbranch(builder.icmp_unsigned("!=", first, last), loop, after)
        builder.position_at_end(loop)
        entry = builder.phi(WORD)
        entry.add_incoming(first, before)
        pair = builder.inttoptr(entry, pointer)
        function = builder.inttoptr(constant_word(builder, pair, 0), function_type.as_pointer())
        kind = builder.inttoptr(constant_word(builder, pair, 1), pointer)
        builder.call(function, [kind, *words])
        following = builder.add(entry, ir.Constant(WORD, 2 * WORD_BYTES))
        entry.add_incoming(following, builder.block)
        builder.cbranch(builder.icmp_unsigned("!=", following, last), loop, after)
        builder.position_at_end(after)
        return context.get_dummy_value()

    return lower


def _lower_kind_call(operation: KindOperation) -> Callable[..., Any]:
    def lower(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        first = signature.args[0]
        if isinstance(first, BaseTuple):
            kinds = list(zip(first.types, cgutils.unpack_tuple(builder, values[0]), strict=True))
        else:
            kinds = [(first, values[0])]
        for kind, value in kinds:
            function = operation.chosen(kind.group)
            if function is not None:
                of_type = context.typing_context.resolve_value_type(function)
                of_call = of_type.get_call_type(context.typing_context, (kind, *signature.args[1:]), {})
                called = context.get_function(of_type, of_call)
                context.add_linking_libs(called.libs)
                called(builder, (value, *values[1:]))
        return context.get_dummy_value()

    return lower
