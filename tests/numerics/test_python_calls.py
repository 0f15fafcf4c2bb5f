"""In a run nothing is compiled: Python calls entries, operations, plain functions, and no kernel without declared
types.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from heavylift.numerics.sources import PACKAGE

COMPILED = {"entry", "kernel", "view"}
"""Decorators whose functions are code of kernels."""


def decorators(function: ast.FunctionDef) -> dict[str, set[str]]:
    """Names of the decorators, each with those of its keywords."""
    calls = [
        (one.func, one.keywords) if isinstance(one, ast.Call) else (one, [])
        for one in function.decorator_list
    ]
    return {ast.unparse(name): {str(word.arg) for word in words} for name, words in calls}


def sources() -> Iterator[tuple[str, ast.Module]]:
    for package in ("numerics", "contours", "modal", "preprocess", "solver", "pipeline"):
        for file in sorted((PACKAGE / package).rglob("*.py")):
            parts = file.relative_to(PACKAGE).with_suffix("").parts
            yield ".".join(("heavylift", *parts)), ast.parse(file.read_text())


def plain_kernels(tree: ast.Module) -> set[str]:
    """Kernels of a module that Numba would compile when Python calls them."""
    return {
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        and "internal" not in decorators(node).get("kernel", {"internal"})
    }


def names_in_python(node: ast.AST) -> Iterator[ast.Name]:
    """Names that are read outside of kernels, but for those that `in_python` gets."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef) and COMPILED & set(decorators(child)):
            continue
        if isinstance(child, ast.Call) and isinstance(child.func, ast.Name) and child.func.id == "in_python":
            continue
        if isinstance(child, ast.Name) and isinstance(child.ctx, ast.Load):
            yield child
        yield from names_in_python(child)


@pytest.mark.slow
def test_python_calls_no_kernel_that_would_be_compiled_then() -> None:
    trees = dict(sources())
    kernels = {module: plain_kernels(tree) for module, tree in trees.items()}
    known = {name for names in kernels.values() for name in names}
    assert known  # else this looks at nothing
    found = []
    for module, tree in trees.items():
        imported = {
            alias.asname or alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("heavylift.")
            for alias in node.names
            if alias.name in known and alias.name in kernels.get(str(node.module), known)
        }
        watched = kernels[module] | imported
        names = names_in_python(tree) if watched else ()
        found += [f"{module}, line {name.lineno}: {name.id}" for name in names if name.id in watched]
    assert found == []


def test_what_is_looked_for_would_be_found() -> None:
    tree = ast.parse(
        "@kernel\ndef f(x: float) -> float:\n    return x\n\n"
        "@kernel(internal=True)\ndef g(x: float) -> float:\n    return f(x)\n\n"
        "def h() -> float:\n    return f(1.0) + in_python(f)(2.0)\n"
    )
    assert plain_kernels(tree) == {"f"}
    assert [name.lineno for name in names_in_python(tree) if name.id == "f"] == [10]
    assert Path(PACKAGE, "numerics").is_dir()
