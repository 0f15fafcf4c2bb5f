"""Compiled code that belongs to no scene: object files, made once and loaded in a millisecond.

A *unit* is a set of kernels with declared signatures: all operations of one kind, or the loop of an integrator.
It is compiled as a whole, each function once, into one object file whose name holds a digest of the sources that
its kernels import, of the compiler and of the processor. So an edit compiles what it touches, and a scene that puts
known kinds together anew compiles nothing. Files are written beside their place and renamed; one that is not whole, or
cannot be written, costs time and nothing else.
"""

from __future__ import annotations

import atexit
import ctypes
import hashlib
import operator
import os
import shutil
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial, update_wrapper
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numpy as np

from heavylift.numerics.arrays import (
    FLOAT,
    INTEGER,
    NOTHING,
    Arrays,
    ArrayType,
    Pointer,
    Reference,
    Words,
    declared_types,
    described,
    kernel_type,
    number_as_word,
    word_count,
)
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import Kernel, in_python, kernel, when_compiling, with_compiler
from heavylift.numerics.packages import version_of
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
    "is_compiled",
    "load_unit",
    "native_function",
    "objects_folder",
    "writable_root",
]

when_compiling("heavylift.numerics.objects_code")

MAGIC = b"heavylift object 2\n"

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

USUAL = 3, None, False, None, None, None
"""What `heavylift.numerics.jit_code.settings` says if nobody asks Numba for something else."""

CONFIGURATION = Path(".numba_config.yaml")
"""File in the current folder that Numba reads when it is imported."""


def _settings() -> tuple[Any, ...]:
    """What Numba is told of how to compile; it is imported only if something may tell it."""
    told = any(name.startswith("NUMBA_") for name in os.environ) or CONFIGURATION.exists()
    if (
        told or "numba" in sys.modules or llvm.targets.has_svml()
    ):  # a vector library, which may be there or not
        settings: tuple[Any, ...] = with_compiler().settings()
        return settings
    return USUAL


@cache
def _machine() -> bytes:
    """Compiler and processor."""
    return repr(
        (
            sys.version_info[:2],
            version_of("numba"),
            llvmlite.__version__,
            _settings(),
            np.__version__,
            (llvm.get_default_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()),
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


def _compile(unit: Unit) -> bytes:
    """Object file of a unit, see `heavylift.numerics.objects_code`."""
    made: bytes = with_compiler("heavylift.numerics.objects_code").compile_unit(unit)
    return made


@cache
def _engine() -> Any:
    """The engine that all objects are loaded into; functions of the process are known once it is there."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
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
    names, _, code = data.partition(b"\0")
    engine = _engine()
    # what is not known is of Numba; the process would die where the object is loaded
    if not all(map(llvm.address_of_symbol, filter(None, names.decode().split("\n")))):
        with_compiler().give_helpers()
    try:
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
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
    if isinstance(of_type, ArrayType):
        dtype, dimensions = of_type.dtype, of_type.ndim
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
    if of_type == FLOAT:
        return lambda words, value: words.append(float(value))
    if of_type == INTEGER:
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
        ctypes.c_double if of_type == FLOAT else ctypes.c_int64
        for of_type in kinds
        for _ in range(word_count(of_type))
    ]
    out = None if result == NOTHING else (ctypes.c_double if result == FLOAT else ctypes.c_int64)
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
    result = kernel_type(hints.pop("return", None))
    parameters = []
    for name in function.__code__.co_varnames[: function.__code__.co_argcount]:
        try:
            parameters.append(kernel_type(hints[name]))
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
        function = in_python(self.kernel)
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
        if not isinstance(self.kernel, Kernel):
            return partial(self.kernel, *first)
        unit = self.unit
        ((symbol, (_, parameters, result)),) = unit.entries.items()
        return native_function(load_unit(unit).addresses[symbol], parameters, result, first)

    def __call__(self, *values: Any) -> Any:
        """Compile or load it at the first call."""
        if not isinstance(self.kernel, Kernel):
            return self.kernel(*values)
        if self._call is None:
            self._call = self.with_first()
        return self._call(*values)


def entry(function: Callable[..., Any]) -> Entry:
    """Declare a kernel that Python calls, with annotations of all its types."""
    return Entry(function)
