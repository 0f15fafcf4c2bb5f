"""Compiled code that belongs to no scene: object files, made once and loaded in a millisecond.

A *unit* is a set of kernels with declared signatures: all operations of one kind, or the loop of an integrator.
It is compiled as a whole, each function once, into one object file whose name holds a digest of the sources that
its kernels import, of the compiler and of the processor. So an edit compiles what it touches, and a scene that puts
known kinds together anew compiles nothing. Files are written beside their place and renamed; one that is not whole, or
cannot be written, costs time and nothing else.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import gc
import hashlib
import operator
import os
import re
import shutil
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial, update_wrapper
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys
from numba.extending import typeof_impl
from numba.np import numpy_support

from heavylift.numerics.arrays import (
    WORD,
    Arrays,
    Pointer,
    Reference,
    Words,
    declared_types,
    described,
    numba_type,
    number_as_word,
    rebuild_array,
    word_count,
)
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel, module_of
from heavylift.numerics.sources import (
    cache_root,
    closure_digest,
    distrusted,
    edited_since_start,
    made_folder,
    say,
)

__all__ = [
    "ENTRIES",
    "TROUBLES",
    "CompileError",
    "Compiled",
    "Entry",
    "Unit",
    "build_unit",
    "compiled_units",
    "entry",
    "function_pointer_type",
    "is_compiled",
    "load_unit",
    "native_function",
    "native_words",
    "objects_folder",
    "to_words",
    "writable_root",
]

NUMBERS = (types.Number, types.Boolean)

MAGIC = b"heavylift object 1\n"

KEPT_OBJECTS = 3
"""Object files of older sources of a unit that are kept beside the current one."""

TROUBLES: list[str] = []
"""What compiled code had to say in words during a call."""

FAILURE = "heavylift.failure"
_FAILURE = np.zeros(1, dtype=np.int64)
"""Address of the name of a function that has ended with an error, as one that checks bounds does."""
llvm.add_symbol(FAILURE, _FAILURE.ctypes.data)


class CompileError(RuntimeError):
    """A kernel that does not compile: which one, of what, and where."""


@dataclass(frozen=True)
class Unit:
    """What becomes one object file.

    Attributes
    ----------
    name
        Of the kind or the loop.
    entries
        Functions by symbol, each with the kernel, the types of its parameters and that of its result.
    modules
        Modules of the kernels; what they import decides when the unit is compiled anew.
    owner
        Module, name and group by which another process finds it: of a kind, or of an entry with no group.
    """

    name: str
    entries: Mapping[str, tuple[Any, tuple[Any, ...], Any]]
    modules: tuple[str, ...]
    owner: tuple[str, str, str]


@dataclass(frozen=True)
class Compiled:
    """A unit in memory: addresses by symbol; seconds of CPU time that compiling took, 0 if it was loaded."""

    addresses: Mapping[str, int]
    seconds: float


# ---- files ----


@cache
def _machine() -> bytes:
    """Compiler and processor."""
    return repr(
        (
            sys.version_info[:2],
            numba.__version__,
            llvmlite.__version__,
            (numba.config.OPT, numba.config.BOUNDSCHECK, numba.config.USING_SVML),
            np.__version__,
            cpu_target.target_context.codegen().magic_tuple(),
        )
    ).encode()


def _place(unit: Unit) -> Path:
    """Where the object file of a unit is: by sources, compiler, processor and the layout of what it is handed."""
    words = [
        f"{symbol}{tuple(map(described, types_of))}" for symbol, (_, types_of, _) in unit.entries.items()
    ]
    known = _machine() + "\n".join(sorted(words)).encode()  # their order is that of imports
    return objects_folder() / f"{unit.name}-{closure_digest(unit.modules, known)}.o"


def objects_folder() -> Path:
    """Folder of the object files."""
    return cache_root() / "objects"


_SPARE: list[Path] = []
"""Folder for this process and those that it starts, where the usual one cannot be written."""


def writable_root() -> Path:
    """Folder for new object files; a temporary one for this run, with a message, if the usual one cannot be used."""
    if not _SPARE:
        folder = objects_folder()
        reason = distrusted(folder)
        if not reason:
            try:
                with tempfile.TemporaryFile(dir=made_folder(folder)):
                    pass
            except OSError as error:
                reason = str(error.strerror)
        if reason:
            say(f"compiled kernels cannot be kept in {folder}: {reason}; they serve this run alone")
            _SPARE.append(Path(tempfile.mkdtemp(prefix="heavylift-")))
            atexit.register(shutil.rmtree, _SPARE[0], ignore_errors=True)
    return _SPARE[0] if _SPARE else cache_root()


def _stored(unit: Unit) -> bytes | None:
    """Object of a unit, where one has been kept."""
    place = _place(unit)
    data = None if distrusted(place.parent, place) else _read(place)
    return _read(_SPARE[0] / "objects" / place.name) if data is None and _SPARE else data


def _read(path: Path) -> bytes | None:
    """The object of a file; None if there is none or it is not whole."""
    try:
        if not path.is_file():  # a pipe would wait for a writer
            return None
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                return None
            digest, data = file.read(32), file.read()
    except OSError:
        return None
    return data if hashlib.blake2b(data, digest_size=32).digest() == digest else None


def _write(unit: Unit, data: bytes) -> None:
    """Whole or not at all, and those of old sources go. What an edit has made old is not kept."""
    if edited_since_start(unit.modules):
        return
    path = writable_root() / "objects" / _place(unit).name
    temporary = None
    try:
        if not _SPARE:
            made_folder(path.parent)
        path.parent.mkdir(exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=".", delete=False) as file:
            temporary = Path(file.name)
            file.write(MAGIC + hashlib.blake2b(data, digest_size=32).digest() + data)
        temporary.chmod(0o644 & ~_umask())
        temporary.replace(path)
        name = path.name.rpartition("-")[0]
        older = [(_age(other), other) for other in path.parent.glob(f"{name}-*.o") if other != path]
        for _, other in sorted(older)[:-KEPT_OBJECTS]:
            other.unlink(missing_ok=True)
    except OSError as error:  # a full disk: this run continues with what it has in memory
        say(f"compiled kernels cannot be kept in {path.parent}: {error.strerror}")
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def _umask() -> int:
    """The mask of this process, which can be read only by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _age(path: Path) -> float:
    """When a file was last used; 0 if another process has just removed it."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


# ---- code ----


def native_words(of_type: Any) -> list[ir.Type]:
    """What a parameter becomes in the interface of a compiled function."""
    if isinstance(of_type, (types.Array, Words)):
        return [WORD] * word_count(of_type)
    if isinstance(of_type, Pointer):
        return [WORD.as_pointer()]
    return [ir.DoubleType()] if of_type == types.float64 else [WORD]


def function_pointer_type(parameters: Iterable[Any], result: Any = types.none) -> ir.FunctionType:
    """Type of a compiled function."""
    out = ir.VoidType() if result == types.none else native_words(result)[0]
    return ir.FunctionType(out, [word for one in parameters for word in native_words(one)])


def to_words(context: Any, builder: Any, of_type: Any, value: Any) -> list[Any]:
    """A value as the words of the interface."""
    if isinstance(of_type, types.Array):
        array = context.make_array(of_type)(context, builder, value)
        lengths = [builder.extract_value(array.shape, i) for i in range(of_type.ndim)]
        return [builder.ptrtoint(array.data, WORD), *lengths]
    if isinstance(of_type, Words):
        return of_type.to_words(context, builder, value)
    return [builder.zext(value, WORD)] if of_type == types.boolean else [value]


def _from_words(context: Any, builder: Any, of_type: Any, words: list[Any]) -> Any:
    if isinstance(of_type, types.Array):
        return rebuild_array(context, builder, of_type, words)
    if isinstance(of_type, Words):
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


def _compile(unit: Unit) -> bytes:
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
        for symbol, (callable_kernel, parameters, result) in unit.entries.items():
            dispatcher = getattr(callable_kernel, "part", callable_kernel)
            try:
                dispatcher.compile(parameters)
            except NumbaError as error:
                raise CompileError(_explain(symbol, unit, dispatcher, error)) from None
            overload = dispatcher.overloads[tuple(parameters)]
            made = overload.signature.return_type
            if made != result and not (isinstance(made, types.Integer) and result == types.int64):
                raise CompileError(f"{symbol} of {unit.name} returns {made}, expected {result}")
            overload.library.parts(libraries)
            function = ir.Function(wrappers, function_pointer_type(parameters, result), symbol)
            builder = ir.IRBuilder(function.append_basic_block())
            words = list(function.args)
            values = []
            for of_type in parameters:
                count = len(native_words(of_type))
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
    """All parts in one module, optimised together."""
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
    # the process would die where the object is loaded; checks of bounds leave some, and `_engine` knows them then
    if missing and not numba.config.BOUNDSCHECK:
        raise CompileError(
            f"{', '.join(sorted(symbols))}: a kernel makes, reshapes or returns arrays: {', '.join(missing)} is left"
        )
    return bytes(codegen._tm.emit_object(whole))  # noqa: SLF001


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


@cache
def _engine() -> Any:
    """The engine that all objects are loaded into; symbols of Numba's helpers are known once its context is there."""
    context = cpu_target.target_context
    if numba.config.BOUNDSCHECK:
        rtsys.initialize(context)
    machine = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), jit=True
    )
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)


_LOADED: dict[str, Compiled] = {}
_LOADING = threading.RLock()


def compiled_units() -> Mapping[str, Compiled]:
    """Units that this process has loaded or compiled, by name."""
    return _LOADED


def is_compiled(unit: Unit) -> bool:
    """Whether there is a whole object file, or the unit is in memory."""
    return unit.name in _LOADED or _stored(unit) is not None


def build_unit(unit: Unit) -> float:
    """Compile a unit into its object file, whatever is there; returns the CPU time of this thread [s]."""
    begin = time.thread_time()
    _place(unit)  # by the sources as they are before compiling
    _write(unit, _compile(unit))
    return time.thread_time() - begin


def load_unit(unit: Unit) -> Compiled:
    """Addresses of a unit, compiled first if there is no object file that can be loaded."""
    with _LOADING:
        if unit.name not in _LOADED:
            begin = time.thread_time()
            data = _stored(unit)
            loaded = None if data is None else _load(data, unit)
            seconds = 0.0
            if loaded is None:
                data = _compile(unit)
                _write(unit, data)
                loaded = _load(data, unit)
                seconds = time.thread_time() - begin
            if loaded is None:
                raise CompileError(f"{unit.name}: what was compiled cannot be loaded")
            _LOADED[unit.name] = Compiled(loaded, seconds)
        return _LOADED[unit.name]


def _load(data: bytes, unit: Unit) -> dict[str, int] | None:
    """Addresses of an object in memory; None if it is none."""
    try:
        engine = _engine()
        engine.add_object_file(llvm.ObjectFileRef.from_data(data))
        engine.finalize_object()
    except RuntimeError:
        return None
    addresses = {symbol: int(engine.get_function_address(symbol)) for symbol in unit.entries}
    return addresses if all(addresses.values()) else None


# ---- calls from Python ----


def _place_in_memory(array: Any) -> int:
    """Address of the numbers of an array, four times as fast as `ctypes.data` finds it."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))
    except (TypeError, ValueError):  # nobody may write to it, or it has no numbers
        return int(array.ctypes.data)


def _encoder(of_type: Any) -> Callable[[list[Any], Any], None]:
    """Function that appends the words of a value of this type to a list, or raises a TypeError."""
    if isinstance(of_type, types.Array):
        dtype, dimensions = numpy_support.as_dtype(of_type.dtype), of_type.ndim
        place = _place_in_memory if dtype.names is None else lambda array: array.ctypes.data

        def put_array(words: list[Any], value: Any) -> None:
            if value.ndim != dimensions or not value.flags.c_contiguous or value.dtype != dtype:
                raise TypeError(f"{value.dtype} array of shape {value.shape}, expected {of_type}")
            words.append(place(value))
            words.extend(value.shape)

        return put_array
    if isinstance(of_type, Words):
        return lambda words, value: words.extend(of_type.words(value, "an argument"))
    if isinstance(of_type, Pointer):
        return lambda words, value: words.append(value.address)
    if of_type == types.float64:
        return lambda words, value: words.append(float(value))
    if of_type == types.int64:
        return lambda words, value: words.append(operator.index(value))
    return lambda words, value: words.append(number_as_word(of_type, value))


def native_function(
    address: int, parameters: Iterable[Any], result: Any, first: Iterable[Any] = ()
) -> Callable[..., Any]:
    """A compiled function as a callable of Python values: arrays, numbers and what has an `address`.

    Its first values may be given, if they have addresses: what they are is then looked at once, not at every call.
    """
    kinds = tuple(parameters)
    codes = [
        ctypes.c_double if isinstance(word, ir.DoubleType) else ctypes.c_int64
        for of_type in kinds
        for word in native_words(of_type)
    ]
    out = None if result == types.none else (ctypes.c_double if result == types.float64 else ctypes.c_int64)
    call = ctypes.CFUNCTYPE(out, *codes)(address)

    # what depends on the types alone is decided here: a statics calls small kernels some ten thousand times
    given = [kinds[i].accept(value, f"argument {i + 1}") for i, value in enumerate(first)]
    count = len(kinds) - len(given)
    encoders = [_encoder(of_type) for of_type in kinds[len(given) :]]
    pointers = [
        (i, of_type, f"argument {len(given) + i + 1}")
        for i, of_type in enumerate(kinds[len(given) :])
        if isinstance(of_type, Pointer)
    ]

    def function(*values: Any) -> Any:
        if len(values) != count:
            raise TypeError(f"{len(given) + len(values)} arguments, expected {len(kinds)}")
        held = list(values)
        for i, of_type, where in pointers:
            held[i] = of_type.accept(held[i], where)
        # may import kernels that declare operations: tables stay as they are afterwards
        for one in given:
            one.address  # noqa: B018
        for i, _, _ in pointers:
            held[i].address  # noqa: B018
        words: list[Any] = [one.address for one in given]
        for encode, value in zip(encoders, held, strict=True):
            encode(words, value)
        answer = call(*words)
        if _FAILURE[0]:
            name, _FAILURE[0] = ctypes.string_at(int(_FAILURE[0])).decode(), 0
            raise RuntimeError(f"{name} ended with an error, as an index out of bounds does")
        if TROUBLES:
            first = TROUBLES[0]
            TROUBLES.clear()
            raise RuntimeError(first)
        return answer

    return function


def signature(function: Callable[..., Any]) -> tuple[tuple[Any, ...], Any]:
    """Types of the parameters and of the result of a function, from its annotations.

    Raises
    ------
    TypeError
        Names the function and the parameter.
    """
    hints = declared_types(function)
    result = numba_type(hints.pop("return", None))
    parameters = []
    for name in function.__code__.co_varnames[: function.__code__.co_argcount]:
        try:
            parameters.append(numba_type(hints[name]))
        except (KeyError, TypeError) as error:
            raise TypeError(f"{function.__module__}.{function.__qualname__}, {name}: {error}") from None
    return tuple(parameters), result


ENTRIES: list[Entry] = []
"""All that have been imported."""


class Entry:
    """A kernel with a declared signature that Python calls: compiled once, whatever the scene."""

    def __init__(self, function: Callable[..., Any]) -> None:
        update_wrapper(self, function)
        self.kernel = kernel(internal=True)(function)
        self._call: Callable[..., Any] | None = None
        ENTRIES.append(self)

    @property
    def unit(self) -> Unit:
        """Of this function alone."""
        kernel_of_numba: Any = self.kernel
        function = getattr(kernel_of_numba, "py_func", kernel_of_numba)
        name = f"{function.__module__.removeprefix('heavylift.')}.{function.__qualname__}"
        parameters, result = signature(function)
        modules = {function.__module__}
        for of_type in parameters:
            if isinstance(of_type, Reference):  # imported for the type checker alone, perhaps
                modules |= {base.__module__ for base in of_type.group.__mro__ if issubclass(base, Arrays)}
        return Unit(
            name,
            {name: (self.kernel, parameters, result)},
            tuple(sorted(modules)),
            (function.__module__, function.__name__, ""),
        )

    def with_first(self, *first: Any) -> Callable[..., Any]:
        """A callable of its other values; the first ones have addresses. Compiles or loads it.

        Raises
        ------
        TypeError
            If kernels would misread a value; names its number and both types.
        """
        if not isinstance(self.kernel, Dispatcher):
            return partial(self.kernel, *first)
        unit = self.unit
        ((symbol, (_, parameters, result)),) = unit.entries.items()
        return native_function(load_unit(unit).addresses[symbol], parameters, result, first)

    def __call__(self, *values: Any) -> Any:
        """Compile or load it at the first call."""
        if not isinstance(self.kernel, Dispatcher):
            return self.kernel(*values)
        if self._call is None:
            self._call = self.with_first()
        return self._call(*values)


def entry(function: Callable[..., Any]) -> Entry:
    """Declare a kernel that Python calls, with annotations of all its types."""
    return Entry(function)


@typeof_impl.register(Entry)
def _type_of_entry(value: Entry, context: Any) -> Any:
    """Kernels call the kernel behind it."""
    del context
    return types.Dispatcher(value.kernel)
