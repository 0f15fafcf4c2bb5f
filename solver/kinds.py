"""Generic functions that kinds implement, resolved on the types of the kinds when a scene is compiled.

A *kind* is a ``NamedTuple`` of arrays that holds all things of one sort in a scene. A scene is a tuple
of kinds. A generic function is declared once with `generic`; every kind brings its own kernel for it
(`implement`); the integrators call it on the whole tuple without knowing which kinds exist.

In compiled code such a call becomes one direct call a kind, written into the caller before it is
compiled: no loop, no branch, no wrapper. That matters for compile time as well, because LLVM
optimises the whole of a function again in each of its callers.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import update_wrapper
from typing import Any

from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering
from numba.extending import overload

__all__ = ["generic", "implement", "optional"]

_IMPLEMENTATIONS: dict[Callable[..., None], dict[type, Callable[..., Any]]] = {}


def optional(contract: Callable[..., None]) -> Callable[..., None]:
    """As `generic`, but kinds that do not implement the function are passed over."""
    return _serving(contract, needed=False)


def generic(contract: Callable[..., None]) -> Callable[..., None]:
    """Turn a documented signature into a function that serves every kind of a tuple, in order.

    Parameters
    ----------
    contract
        A function whose first parameter is the tuple of kinds, and whose docstring says what
        implementations, which take one kind in its place, have to do. Its body is not used.

    Returns
    -------
    callable
        Usable in kernels (resolved when they are compiled) and in plain Python.

    Raises
    ------
    TypeError
        When a kind has no implementation; a kernel that meets one does not compile.
    """
    return _serving(contract, needed=True)


def _serving(contract: Callable[..., None], *, needed: bool) -> Callable[..., None]:
    implementations: dict[type, Callable[..., Any]] = {}

    def serve(kinds: tuple[Any, ...], *arguments: Any) -> None:
        for kind in kinds:
            if needed or type(kind) in implementations:
                _chosen(contract, implementations, type(kind))(kind, *arguments)

    update_wrapper(serve, contract)
    _IMPLEMENTATIONS[serve] = implementations

    names = list(inspect.signature(contract).parameters)

    def resolve(kinds: Any) -> Callable[..., None]:
        kernels = {
            f"kernel_{i}": _chosen(contract, implementations, kind.instance_class)
            for i, kind in enumerate(kinds)
            if needed or kind.instance_class in implementations
        }
        calls = [f"{name}({names[0]}[{name[7:]}], {', '.join(names[1:])})" for name in kernels]
        return _function(names, calls, kernels)

    # Numba wants the very parameter names in the resolver too
    resolver = _function(names, [f"return resolve({names[0]})"], {"resolve": resolve})
    overload(serve, inline="always", jit_options={"pipeline_class": _TypingCompiler})(resolver)
    return serve


@register_pass(mutates_CFG=True, analysis_only=False)
class _TypesOnly(NativeLowering):
    """Ends the compilation of a call whose body is written into the caller: nothing ever runs what would follow."""

    _name = "types_only"

    def run_pass(self, state: Any) -> bool:
        """Without linking and optimisation; a dispatcher wants some entry point all the same."""
        state.flags.no_compile = True
        changed = bool(super().run_pass(state))
        state["cr"] = state["cr"]._replace(cfunc=len)
        return changed


class _TypingCompiler(CompilerBase):
    """Numba's passes with `_TypesOnly` as the last but one: a fifth less time for a scene."""

    def define_pipelines(self) -> list[Any]:
        """Of the usual ones only that without Python objects."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [
            (_TypesOnly, text) if pass_class is NativeLowering else (pass_class, text)
            for pass_class, text in passes.passes
        ]
        passes.finalize()
        return [passes]


def implement(
    function: Callable[..., None], kind: type
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Register a kernel as the implementation of a generic function for one kind.

    Parameters
    ----------
    function
        Made by `generic`.
    kind
        The ``NamedTuple`` class.
    """

    def register(kernel_function: Callable[..., Any]) -> Callable[..., Any]:
        _IMPLEMENTATIONS[function][kind] = kernel_function
        return kernel_function

    return register


def _chosen(
    contract: Callable[..., None], implementations: dict[type, Callable[..., Any]], kind: type
) -> Callable[..., Any]:
    try:
        return implementations[kind]
    except KeyError:
        raise TypeError(f"{contract.__name__} is not implemented for {kind.__name__}") from None


def _function(parameters: list[str], lines: list[str], names: dict[str, Any]) -> Callable[..., Any]:
    """A function with given parameters and body: Numba cannot inline one with starred arguments."""
    body = "\n    ".join(lines) or "pass"
    namespace = dict(names)
    exec(f"def generated({', '.join(parameters)}):\n    {body}\n", namespace)  # noqa: S102  text from above only
    return namespace["generated"]
