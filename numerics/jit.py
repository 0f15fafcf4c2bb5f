"""The one decorator for compiled code.

What only kernels call is kept as code that is not compiled yet, and compiled once with those that call it. What Python
calls is cached on disk, in a folder whose name holds a digest of all sources that the kernel depends on, see
`heavylift.numerics.sources`. Kernels of kinds and loops do not come through this cache: `heavylift.numerics.objects`.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections.abc import Callable, Iterator
from functools import cache, update_wrapper
from pathlib import Path
from typing import Any, TypeVar, overload

import numba
from numba.core import event
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.ir import Arg, Expr
from numba.core.lowering import Lower
from numba.core.typed_passes import NativeLowering

from heavylift.numerics.sources import (
    cache_root,
    closure_digest,
    distrusted,
    edited_since_start,
    made_folder,
    say,
)

__all__ = [
    "CompileClock",
    "PartLibrary",
    "cache_folder",
    "compile_clock",
    "in_python",
    "kernel",
    "module_of",
    "view",
]

F = TypeVar("F", bound=Callable[..., Any])

KEPT_CACHES = 3
"""Cache folders of older sources of a module that are kept beside the current one."""

CACHE_PREFIX = "kernels-"
"""Of the folders below the cache root that are ours; nothing else there is ever removed."""

COMPILER_EVENT = "numba:compiler_lock"
"""Event of Numba around all of a compilation, and around loading from its cache."""

# Numba would read a file of settings, among them a cache folder, from the current folder whenever it compiles; that may
# be the folder of a case from someone else. The variables NUMBA_* stay.
numba.config._config_fname = os.devnull  # noqa: SLF001

ROUNDING_FLAGS = frozenset({"contract", "nsz", "arcp"})
"""Allowed to change the last bits; never ``nnan``/``ninf``, which would remove every ``isnan``."""


@cache
def cache_folder(module: str) -> Path:
    """Folder of the compiled kernels of a module; removes outdated ones."""
    root, prefix = cache_root(), f"{CACHE_PREFIX}{module.removeprefix('heavylift.')}-"
    current = root / (prefix + closure_digest((module,)))
    if not current.is_dir():
        with contextlib.suppress(OSError):  # a read-only home must not stop a run
            made_folder(current).chmod(0o700)  # Numba makes folders in it by the umask
            older = sorted(
                (path for path in root.glob(f"{prefix}*") if path.is_dir() and path != current),
                key=lambda path: path.stat().st_mtime,
            )
            for path in older[:-KEPT_CACHES]:
                shutil.rmtree(path, ignore_errors=True)
    return current


@contextlib.contextmanager
def _numba_cache_directory(directory: Path) -> Iterator[None]:
    """Point Numba to a cache folder while a function is decorated, and back afterwards."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(directory)
    try:
        yield
    finally:
        numba.config.CACHE_DIR = before


class PartLibrary(JITCodeLibrary):
    """Code of one kernel that only kernels call: it is linked and optimised once, with what calls it.

    Numba would optimise every function, and all that it calls, once more in each of its callers.
    """

    def __init__(self, codegen: Any, name: str) -> None:
        super().__init__(codegen, name)
        self._linked: Any = None

    def add_llvm_module(self, ll_module: Any) -> None:
        """Without passes: those of the whole follow."""
        ll_module.data_layout = self._codegen._data_layout  # noqa: SLF001  as the class above does
        self._final_module.link_in(ll_module)

    def finalize(self) -> None:
        """Leave the code as it is."""
        self._finalized = True

    def parts(self, found: dict[Any, None] | None = None) -> dict[Any, None]:
        """The library itself and all that it needs, in order."""
        found = {} if found is None else found
        if self not in found:
            found[self] = None
            for library in self._linking_libraries:
                if isinstance(library, PartLibrary):
                    library.parts(found)
                else:
                    found[library] = None
        return found

    def own_module(self) -> Any:
        """Code of this kernel alone, fit for being linked several times."""
        return super()._get_module_for_linking()

    def _get_module_for_linking(self) -> Any:
        """Code of this kernel with all that it calls."""
        if self._linked is None:
            whole = self.own_module().clone()
            for part in self.parts():
                if part is not self:
                    whole.link_in(module_of(part), preserve=True)
            self._linked = whole
        return self._linked


def module_of(library: Any) -> Any:
    """Code of a library that is fit for being linked several times, without what it needs if that is known."""
    return library.own_module() if isinstance(library, PartLibrary) else library._get_module_for_linking()  # noqa: SLF001


class _PartLower(Lower):
    """Writes the fields of groups of arrays that are arguments once, where the function begins.

    They never change, see `heavylift.numerics.arrays`, and Numba's words for an array structure are many.
    """

    def pre_lower(self) -> None:
        """Remember where the function begins."""
        super().pre_lower()
        self._beginning = self.builder.basic_block
        self._fields: dict[Any, Any] = {}

    def lower_expr(self, resty: Any, expr: Any) -> Any:
        """A field of an argument, or of a field of one, from where the function begins."""
        if expr.op == "getattr" and hasattr(self.typeof(expr.value.name), "group"):
            found = self._field(expr)
            if found is not None:
                return found
        return super().lower_expr(resty, expr)

    def _field(self, expr: Any) -> Any:
        """Value of a field; None if it belongs to no argument."""
        try:
            owner = self.func_ir.get_definition(expr.value)
        except KeyError:
            return None
        if isinstance(owner, Arg):
            key: Any = (owner.index,)
        elif isinstance(owner, Expr) and owner.op == "getattr":
            base = self._field(owner) if hasattr(self.typeof(owner.value.name), "group") else None
            if base is None:
                return None
            key = (id(base),)
        else:
            return None
        key += (expr.attr,)
        if key not in self._fields:
            of_type = self.typeof(expr.value.name)
            with self.builder.goto_block(self._beginning):
                value = self.fnargs[owner.index] if isinstance(owner, Arg) else base
                read = self.context.get_getattr(of_type, expr.attr)
                self._fields[key] = read(self.context, self.builder, of_type, value, expr.attr)
        return self._fields[key]


@register_pass(mutates_CFG=True, analysis_only=False)
class _LowerPart(NativeLowering):
    """Writes code without compiling it."""

    _name = "lower_part"
    lowering_class = _PartLower

    def run_pass(self, state: Any) -> bool:
        """Into a library of parts."""
        codegen = state.targetctx.codegen()
        state.library = PartLibrary(codegen, state.func_id.func_qualname)
        state.flags.no_compile = True
        changed = bool(super().run_pass(state))
        state.library.finalize()
        entry: Any = [].append  # a dispatcher wants an entry point that is a key; nothing ever calls it
        state.targetctx.insert_user_function(entry, state["cr"].fndesc, [state.library])
        state["cr"] = state["cr"]._replace(cfunc=entry)
        return changed


class PartCompiler(CompilerBase):
    """Numba's passes with `_LowerPart` as the last but one."""

    unused: frozenset[str] = frozenset()

    def define_pipelines(self) -> list[Any]:
        """Of the usual ones only that without Python objects."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [
            (_LowerPart, text) if pass_class is NativeLowering else (pass_class, text)
            for pass_class, text in passes.passes
            if pass_class.__name__ not in self.unused
        ]
        passes.finalize()
        return [passes]


UNUSED_PASSES = frozenset(
    {
        "AnnotateTypes",
        "DumpParforDiagnostics",
        "FindLiterallyCalls",
        "InlineClosureLikes",
        "LiteralUnroll",
        "MakeFunctionToJitFunction",
        "NopythonRewrites",
        "RewriteDynamicRaises",
        "WithLifting",
    }
)
"""Passes of Numba for what internal kernels do not contain: closures, expressions of whole arrays, exceptions."""


class InternalCompiler(PartCompiler):
    """The same without passes for what internal kernels do not contain."""

    unused = UNUSED_PASSES


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
        flags = set(ROUNDING_FLAGS | {"reassoc"}) if reassociate else set(ROUNDING_FLAGS)

        def compiled_by(pipeline: type[CompilerBase] | None) -> Any:
            return numba.njit(
                error_model="numpy",
                fastmath=flags,
                forceinline=inline,
                no_cpython_wrapper=pipeline is not None,
                _nrt=not internal,
                no_cfunc_wrapper=True,
                **({} if pipeline is None else {"pipeline_class": pipeline}),
            )(python_function)

        compiled = compiled_by(InternalCompiler if internal else None)
        if compiled is not python_function:
            update_wrapper(compiled, python_function)
            if internal:
                _call_from_kernels(compiled, compiled)
            else:
                _cache_when_compiled(compiled)
                _call_from_kernels(compiled, compiled_by(PartCompiler))
        return compiled

    return decorate if function is None else decorate(function)


def in_python(function: F) -> F:
    """A kernel as the plain function that it was made of: for what Python calls a few times with a few numbers.

    It must not call other kernels.
    """
    plain: F = getattr(function, "py_func", function)
    return plain


def _cache_when_compiled(dispatcher: Any) -> None:
    """Find the cache folder, for which all sources are read, when a kernel is called for the first time."""
    compile_now = dispatcher.compile

    def compile_cached(signature: Any) -> Any:
        dispatcher.compile = compile_now
        folder = cache_folder(dispatcher.py_func.__module__)
        kept = os.access(folder, os.W_OK) and not edited_since_start((dispatcher.py_func.__module__,))
        reason = distrusted(folder)
        if reason:
            say(f"compiled kernels are not kept: {reason}")
        if kept and not reason:  # else Numba would cache beside the sources, where stale code can load
            with _numba_cache_directory(folder):
                dispatcher.enable_caching()
        return compile_now(signature)

    dispatcher.compile = compile_cached


def _call_from_kernels(dispatcher: Any, called: Any) -> None:
    """Let kernels that call a kernel use a part of their own code, the same for literal arguments as for all others.

    Numba would compile a kernel once more for each literal that it is called with, and all that it calls.
    """
    resolve = called.get_call_template

    def get_call_template(args: Any, kws: Any) -> Any:
        return resolve(
            tuple(numba.types.unliteral(one) for one in args),
            {name: numba.types.unliteral(one) for name, one in kws.items()},
        )

    dispatcher.get_call_template = get_call_template
    if called is not dispatcher:
        dispatcher.get_overload = called.get_overload
        dispatcher.part = called


def view(function: F) -> F:
    """Put a function that returns a part of an array into its callers, before they are compiled.

    Compiled by itself it would have to count the references to what it returns.
    """
    inlined = numba.njit(inline="always", error_model="numpy")(function)
    update_wrapper(inlined, function)
    return inlined


class CompileClock(event.Listener):
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

    def on_start(self, event: Any) -> None:
        """Note the time; kernels compile those that they call."""
        del event
        if self._depth == 0:
            self._begin = time.thread_time()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Add what passed since the outermost start."""
        del event
        self._depth -= 1
        if self._depth == 0:
            self.seconds += time.thread_time() - self._begin


@contextlib.contextmanager
def compile_clock() -> Iterator[CompileClock]:
    """Measure what compilation takes of the work that is done inside."""
    clock = CompileClock()
    with event.install_listener(COMPILER_EVENT, clock):
        yield clock
