"""What `heavylift.numerics.jit` does with Numba: imported when something is compiled."""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable, Iterator
from functools import cache, update_wrapper
from pathlib import Path
from typing import Any

import numba
from numba.core import event, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.ir import Arg, Expr
from numba.core.lowering import Lower
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys
from numba.core.typed_passes import NativeLowering
from numba.extending import intrinsic, typeof_impl

from heavylift.numerics.jit import CLOCKS, ROUNDING_FLAGS, Intrinsic, Kernel
from heavylift.numerics.sources import (
    cache_root,
    closure_digest,
    distrusted,
    edited_since_start,
    made_folder,
    say,
)

__all__ = ["PartLibrary", "cache_folder", "dispatcher", "give_helpers", "module_of", "settings"]

KEPT_CACHES = 3
"""Cache folders of older sources of a module that are kept beside the current one."""

CACHE_PREFIX = "kernels-"
"""Of the folders below the cache root that are ours; nothing else there is ever removed."""

COMPILER_EVENT = "numba:compiler_lock"
"""Event of Numba around all of a compilation, and around loading from its cache."""

# Numba would read a file of settings, among them a cache folder, from the current folder whenever it compiles; that may
# be the folder of a case from someone else. The variables NUMBA_* stay.
numba.config._config_fname = os.devnull  # noqa: SLF001


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


def dispatcher(
    function: Callable[..., Any],
    *,
    inline: bool = False,
    reassociate: bool = False,
    internal: bool = False,
    put_in: bool = False,
) -> Any:
    """Numba's dispatcher of a function.

    Parameters
    ----------
    function, inline, reassociate, internal
        As in `heavylift.numerics.jit.kernel`.
    put_in
        As by `heavylift.numerics.jit.view`.
    """
    if put_in:
        inlined = numba.njit(inline="always", error_model="numpy")(function)
        update_wrapper(inlined, function)
        return inlined
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
        )(function)

    compiled = compiled_by(InternalCompiler if internal else None)
    update_wrapper(compiled, function)
    if internal:
        _call_from_kernels(compiled, compiled)
    else:
        _cache_when_compiled(compiled)
        _call_from_kernels(compiled, compiled_by(PartCompiler))
    return compiled


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
    resolve, unliteral = called.get_call_template, types.misc.unliteral

    def get_call_template(args: Any, kws: Any) -> Any:
        return resolve(
            tuple(unliteral(one) for one in args),
            {name: unliteral(one) for name, one in kws.items()},
        )

    dispatcher.get_call_template = get_call_template
    if called is not dispatcher:
        dispatcher.get_overload = called.get_overload
        dispatcher.part = called


def settings() -> tuple[Any, ...]:
    """What Numba is told of how to compile, by variables or a file; the rest follows from the processor."""
    config: Any = numba.config
    level = getattr(config.OPT, "_raw_value", config.OPT)
    asked = os.environ.get("NUMBA_ENABLE_AVX")
    return level, config.BOUNDSCHECK, config.USING_SVML, config.CPU_NAME, config.CPU_FEATURES, asked


def give_helpers() -> None:
    """Make known what compiled code calls of Numba."""
    context = cpu_target.target_context
    if numba.config.BOUNDSCHECK:
        rtsys.initialize(context)


@typeof_impl.register(Kernel)
def _type_of_kernel(value: Kernel, context: Any) -> Any:
    del context
    return types.Dispatcher(value.compiled)


@cache
def _type_of_function(value: Intrinsic) -> Any:
    made = intrinsic(value.function)
    cpu_target.typing_context.refresh()
    return cpu_target.typing_context.resolve_value_type(made)


@typeof_impl.register(Intrinsic)
def _type_of_intrinsic(value: Intrinsic, context: Any) -> Any:
    del context
    return _type_of_function(value)


class _Bell(event.Listener):
    """Tells all clocks when compiling begins and ends."""

    def on_start(self, event: Any) -> None:
        """Of a compilation."""
        del event
        for clock in CLOCKS:
            clock.start()

    def on_end(self, event: Any) -> None:
        """Of a compilation."""
        del event
        for clock in CLOCKS:
            clock.end()


event.register(COMPILER_EVENT, _Bell())
