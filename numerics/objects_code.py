"""Object files are made here, see `heavylift.numerics.objects`: imported when something is compiled."""

from __future__ import annotations

import contextlib
import gc
import re
from collections.abc import Iterable, Iterator
from typing import Any

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba.core import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.errors import NumbaError
from numba.core.registry import cpu_target
from numba.extending import typeof_impl

from heavylift.numerics.arrays import FLOAT, NOTHING, ArrayType, Pointer, Words, word_count
from heavylift.numerics.arrays_code import WORD, CompiledWords, compiled_type, rebuild_array
from heavylift.numerics.jit_code import module_of
from heavylift.numerics.objects import FAILURE, CompileError, Entry, Unit

__all__ = ["compile_unit", "to_words"]

NUMBERS = (types.Number, types.Boolean)


def native_words(of_type: Any) -> list[ir.Type]:
    """What a parameter becomes in the interface of a compiled function."""
    if isinstance(of_type, (ArrayType, Words)):
        return [WORD] * word_count(of_type)
    if isinstance(of_type, Pointer):
        return [WORD.as_pointer()]
    return [ir.DoubleType()] if of_type == FLOAT else [WORD]


def _function_type(parameters: Iterable[Any], result: Any) -> ir.FunctionType:
    """Type of a compiled function."""
    out = ir.VoidType() if result == NOTHING else native_words(result)[0]
    return ir.FunctionType(out, [word for one in parameters for word in native_words(one)])


def to_words(context: Any, builder: Any, of_type: Any, value: Any) -> list[Any]:
    """A value as the words of the interface."""
    if isinstance(of_type, types.Array):
        array = context.make_array(of_type)(context, builder, value)
        lengths = [builder.extract_value(array.shape, i) for i in range(of_type.ndim)]
        return [builder.ptrtoint(array.data, WORD), *lengths]
    if isinstance(of_type, CompiledWords):
        return of_type.to_words(context, builder, value)
    return [builder.zext(value, WORD)] if of_type == types.boolean else [value]


def _from_words(context: Any, builder: Any, of_type: Any, words: list[Any]) -> Any:
    if isinstance(of_type, types.Array):
        return rebuild_array(context, builder, of_type, words)
    if isinstance(of_type, CompiledWords):
        return of_type.rebuild(context, builder, words)
    return builder.trunc(words[0], ir.IntType(1)) if of_type == types.boolean else words[0]


@contextlib.contextmanager
def _cycles_kept() -> Iterator[None]:
    """Do not search for unused cycles of objects: compiling makes millions of objects, most of which stay in use."""
    searching = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if searching:
            gc.enable()


@contextlib.contextmanager
def _remembered_answers() -> Iterator[None]:
    """Remember what Numba finds out thousands of times: types of operators on numbers, sizes of LLVM types."""
    context_class: Any = type(cpu_target.target_context)
    function_class: Any = types.functions.BaseFunction
    resolve, size_of = function_class.get_call_type, context_class.get_abi_sizeof
    known: dict[Any, Any] = {}
    sizes: dict[str, int] = {}

    def get_call_type(self: Any, context: Any, arguments: Any, named: Any) -> Any:
        if named or not all(
            isinstance(one, NUMBERS) and not isinstance(one, types.Literal) for one in arguments
        ):
            return resolve(self, context, arguments, named)
        key = self, arguments
        if key not in known:
            known[key] = resolve(self, context, arguments, named)
        return known[key]

    def get_abi_sizeof(self: Any, of_type: Any) -> int:
        name = str(of_type)
        if name not in sizes:
            sizes[name] = size_of(self, of_type)
        return sizes[name]

    function_class.get_call_type, context_class.get_abi_sizeof = get_call_type, get_abi_sizeof
    try:
        yield
    finally:
        function_class.get_call_type, context_class.get_abi_sizeof = resolve, size_of


def compile_unit(unit: Unit) -> bytes:
    """Object file of a unit.

    Raises
    ------
    CompileError
        Names the kernel, the unit, the file and the line.
    """
    context = cpu_target.target_context
    codegen = context.codegen()
    wrappers = codegen._create_empty_module(unit.name)  # noqa: SLF001
    libraries: dict[Any, None] = {}
    with global_compiler_lock, _cycles_kept(), _remembered_answers():
        for symbol, (callable_kernel, kinds, result_kind) in unit.entries.items():
            parameters, result = tuple(map(compiled_type, kinds)), compiled_type(result_kind)
            dispatcher = getattr(callable_kernel.compiled, "part", callable_kernel.compiled)
            try:
                dispatcher.compile(parameters)
            except NumbaError as error:
                raise CompileError(_explain(symbol, unit, dispatcher, error)) from None
            overload = dispatcher.overloads[parameters]
            made = overload.signature.return_type
            if made != result and not (isinstance(made, types.Integer) and result == types.int64):
                raise CompileError(f"{symbol} of {unit.name} returns {made}, expected {result}")
            overload.library.parts(libraries)
            function = ir.Function(wrappers, _function_type(kinds, result_kind), symbol)
            builder = ir.IRBuilder(function.append_basic_block())
            words = list(function.args)
            values = []
            for kind, of_type in zip(kinds, parameters, strict=True):
                count = word_count(kind)
                values.append(_from_words(context, builder, of_type, words[:count]))
                words = words[count:]
            called = context.declare_function(wrappers, overload.fndesc)
            status, value = context.call_conv.call_function(builder, called, made, parameters, values)
            with builder.if_then(status.is_error, likely=False):
                name = context.insert_const_string(wrappers, symbol)
                place = wrappers.globals.get(FAILURE) or ir.GlobalVariable(wrappers, WORD, FAILURE)
                builder.store(builder.ptrtoint(name, WORD), place)
            if result == types.none:
                builder.ret_void()
            else:
                builder.ret(to_words(context, builder, result, value)[0])
        return _link(codegen, wrappers, libraries, set(unit.entries))


def _link(codegen: Any, wrappers: Any, libraries: Iterable[Any], symbols: set[str]) -> bytes:
    """All parts in one module, optimised together: names that it needs from elsewhere, a zero, and the object."""
    whole = llvm.parse_assembly(str(wrappers))
    whole.data_layout = codegen._data_layout  # noqa: SLF001
    for library in libraries:
        whole.link_in(module_of(library), preserve=True)
    for value in (*whole.functions, *whole.global_variables):
        if not value.is_declaration and value.name not in symbols:
            value.linkage = "internal"
    # reference counts that cancel are found after the first of them, and removed by the second
    cheap, cheap_builder = codegen._module_pass_manager(slp_vectorize=False, cost="cheap")  # noqa: SLF001
    cheap.run(whole, cheap_builder)
    full, full_builder = codegen._module_pass_manager()  # noqa: SLF001
    full.run(whole, full_builder)
    whole.verify()
    missing = sorted(
        one.name for one in whole.functions if one.is_declaration and one.name.startswith("NRT_")
    )
    # the process would die where the object is loaded; checks of bounds leave some, and `load_unit` has them given then
    if missing and not numba.config.BOUNDSCHECK:
        raise CompileError(
            f"{', '.join(sorted(symbols))}: a kernel makes, reshapes or returns arrays: {', '.join(missing)} is left"
        )
    asked = (one.name for one in (*whole.functions, *whole.global_variables) if one.is_declaration)
    names = "\n".join(sorted(name for name in asked if not name.startswith("llvm.")))
    return names.encode() + b"\0" + bytes(codegen._tm.emit_object(whole))  # noqa: SLF001


def _explain(symbol: str, unit: Unit, dispatcher: Any, error: Exception) -> str:
    """One line of a page of type inference: the innermost place that the compiler names."""
    text = str(error)
    places = re.findall(r'File "([^"]+)", line (\d+)', text)
    if places:
        file, line = places[-1]
    else:
        file, line = dispatcher.py_func.__code__.co_filename, str(dispatcher.py_func.__code__.co_firstlineno)
    reasons = [part.strip() for part in text.splitlines() if part.strip() and "\x1b" not in part]
    message = next(
        (part for part in reasons if not part.startswith(("Failed", "During", "File"))), type(error).__name__
    )
    return f"{unit.name}: {symbol.rpartition('.')[2]} does not compile: {file}, line {line}: {message}"


@typeof_impl.register(Entry)
def _type_of_entry(value: Entry, context: Any) -> Any:
    """Kernels call the kernel behind it."""
    del context
    behind: Any = value.kernel
    return types.Dispatcher(behind.compiled)
