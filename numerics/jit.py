"""The one decorator for compiled code.

What only kernels call is kept as code that is not compiled yet, and compiled once with those that call it. What Python
calls is cached on disk, in a folder whose name holds a digest of all sources that the kernel depends on, see
`heavylift.numerics.sources`. Kernels of kinds and loops do not come through this cache: `heavylift.numerics.objects`.

A kernel is the function that it is made of until something is compiled: only then is the compiler imported, with the
modules that teach it what kernels work on (`when_compiling`). A scene whose object files are there runs without it.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
import time
from collections.abc import Callable, Iterator
from functools import cached_property, update_wrapper
from typing import Any, NoReturn, TypeVar, overload

__all__ = [
    "ROUNDING_FLAGS",
    "CompileClock",
    "Intrinsic",
    "Kernel",
    "compile_clock",
    "in_python",
    "intrinsic",
    "kernel",
    "runs_in_python",
    "view",
    "when_compiling",
    "with_compiler",
]

F = TypeVar("F", bound=Callable[..., Any])

ROUNDING_FLAGS = frozenset({"contract", "nsz", "arcp"})
"""Allowed to change the last bits; never ``nnan``/``ninf``, which would remove every ``isnan``."""

_TAUGHT: list[str] = []
"""Modules that belong to the compiler, in the order in which they are imported."""

_COMPILER: list[bool] = []
"""Has an entry once they are imported."""


def when_compiling(module: str) -> None:
    """Name a module that the compiler needs for what stands in the calling module.

    It is imported when something is compiled, and belongs to the sources that compiled code depends on, as an import
    does: `heavylift.numerics.sources` reads this call, so it stands at the beginning of a line with the name as text.
    """
    _TAUGHT.append(module)
    if _COMPILER:
        importlib.import_module(module)


when_compiling("heavylift.numerics.jit_code")


def with_compiler(module: str = "heavylift.numerics.jit_code") -> Any:
    """A module that works with Numba; imports all of them at the first call."""
    if not _COMPILER:
        for name in _TAUGHT:  # those that are imported may name more
            importlib.import_module(name)
        _COMPILER.append(True)
    return sys.modules[module]


def runs_in_python() -> bool:
    """Whether kernels are plain Python, by ``NUMBA_DISABLE_JIT``."""
    numba = sys.modules.get("numba")
    if numba is None and os.environ.get("NUMBA_DISABLE_JIT", "0") != "0":
        numba = importlib.import_module("numba")
    return numba is not None and bool(numba.config.DISABLE_JIT)


class Kernel:
    """What `kernel` and `view` make of a function: callable from Python and from kernels.

    Attributes
    ----------
    py_func
        The function.
    compiled
        Dispatcher of Numba; imports Numba and makes it at the first use. What it has is seen here too.
    """

    def __init__(self, function: Callable[..., Any], **options: Any) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._options = options

    @cached_property
    def compiled(self) -> Any:
        """As said above."""
        return with_compiler().dispatcher(self.py_func, **self._options)

    def __call__(self, *values: Any, **named: Any) -> Any:
        """Compile it for what it is given, and run it."""
        return self.compiled(*values, **named)

    def __getattr__(self, name: str) -> Any:
        """What the dispatcher has."""
        if name.startswith("_"):
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return getattr(self.compiled, name)

    def __reduce__(self) -> str:
        """A copy is the same object; another process imports it."""
        return self.py_func.__qualname__


class Intrinsic:
    """What `intrinsic` makes of a function."""

    def __init__(self, function: Callable[..., Any]) -> None:
        update_wrapper(self, function)
        self.function = function

    def __call__(self, *values: Any) -> NoReturn:
        """Only kernels call it."""
        raise NotImplementedError(f"{self.function.__name__} is for kernels only")

    def __reduce__(self) -> str:
        """A copy is the same object."""
        return self.function.__qualname__


def intrinsic(function: Callable[..., Any]) -> Any:
    """Let kernels call a function that writes code itself, as `numba.extending.intrinsic` does."""
    return Intrinsic(function)


@overload
def kernel(function: F, /) -> F: ...


@overload
def kernel(*, inline: bool = ..., reassociate: bool = ..., internal: bool = ...) -> Callable[[F], F]: ...


def kernel(
    function: F | None = None, /, *, inline: bool = False, reassociate: bool = False, internal: bool = False
) -> Any:
    """Compile a function with Numba and cache the machine code on disk.

    Parameters
    ----------
    function
        Typed arrays and scalars in, arrays written in place; no Python objects.
    inline
        Let LLVM inline the function into its callers: for small hot kernels, where
        handing over array structures costs more than the work itself.
    reassociate
        Allow sums to be added in another order, so that dot products use vector
        instructions. Changes rounding only; NaN and infinity stay visible.
    internal
        The function is called from kernels only: it gets no wrapper for Python, which saves compile time, and
        counts no references, which in loops over views of arrays costs more than their arithmetic. It may
        neither allocate nor return arrays; for views see `view`.
    """

    def decorate(python_function: F) -> F:
        if runs_in_python():
            return python_function
        made: Any = Kernel(python_function, inline=inline, reassociate=reassociate, internal=internal)
        return made

    return decorate if function is None else decorate(function)


def in_python(function: F) -> F:
    """A kernel as the plain function that it was made of: for what Python calls a few times with a few numbers.

    It must not call other kernels.
    """
    plain: F = getattr(function, "py_func", function)
    return plain


def view(function: F) -> F:
    """Put a function that returns a part of an array into its callers, before they are compiled.

    Compiled by itself it would have to count the references to what it returns.
    """
    if runs_in_python():
        return function
    made: Any = Kernel(function, put_in=True)
    return made


class CompileClock:
    """Adds up the CPU time of this thread that goes into compiling kernels or loading them.

    Attributes
    ----------
    seconds
        So far; complete when no kernel is being compiled.
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth = 0
        self._begin = 0.0

    def start(self) -> None:
        """Note the time; kernels compile those that they call."""
        if self._depth == 0:
            self._begin = time.thread_time()
        self._depth += 1

    def end(self) -> None:
        """Add what passed since the outermost start."""
        self._depth -= 1
        if self._depth == 0:
            self.seconds += time.thread_time() - self._begin


CLOCKS: list[CompileClock] = []
"""Those that are running."""


@contextlib.contextmanager
def compile_clock() -> Iterator[CompileClock]:
    """Measure what compilation takes of the work that is done inside."""
    clock = CompileClock()
    CLOCKS.append(clock)
    try:
        yield clock
    finally:
        CLOCKS.remove(clock)
