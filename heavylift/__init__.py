"""Is this lift safe? FEM to flexible multibody dynamics, from Python.

What a case file describes has a class here: `RigidBody`, `Rope`, `Hinge`, `Simulate`, ... They are added to a `Model`,
which is run, saved as a case and loaded from one; see docs/python.md. Names are imported when they are first used, so
that importing the package stays cheap. The folders beside this file are links to the sources.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "Case": "pipeline.case.case_file",
    "Component": "pipeline.model.components",
    "InputError": "numerics.outcome",
    "Model": "pipeline.model.model",
    "Outcome": "numerics.outcome",
    "Results": "pipeline.results.histories",
    "Run": "pipeline.model.results",
    "StopError": "pipeline.results.storage",
    "load": "pipeline.model.model",
    "load_case": "pipeline.case.case_file",
    "load_results": "pipeline.results.histories",
    "run_case": "pipeline.stages.stages",
}
"""Modules of the names that are no components."""


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"heavylift.{_HOMES[name]}"), name)
    if name[:1].isupper():
        found = import_module("heavylift.pipeline.model.components").component_class(name)
        if found is not None:
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(
        {*globals(), *_HOMES, *import_module("heavylift.pipeline.model.components").component_names()}
    )
