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
    "ExchangeError": "pipeline.exchange.client",
    "InputError": "numerics.outcome",
    "Linearisation": "solver.linearise.result",
    "Model": "pipeline.model.model",
    "Outcome": "numerics.outcome",
    "RemoteSimulation": "pipeline.exchange.client",
    "Results": "pipeline.results.histories",
    "Run": "pipeline.model.results",
    "Simulation": "pipeline.stepping.simulation",
    "SimulationStopped": "pipeline.stepping.simulation",
    "State": "pipeline.stepping.state",
    "StopError": "pipeline.results.storage",
    "connect": "pipeline.exchange.client",
    "load": "pipeline.model.model",
    "load_case": "pipeline.case.case_file",
    "load_results": "pipeline.results.histories",
    "open_child": "pipeline.exchange.client",
    "run_case": "pipeline.stages.stages",
}
"""Modules of the names that are no components. `__init__.pyi` has them too: `heavylift schema --python` writes it."""


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    if name == "__all__":
        return sorted({*_HOMES, *import_module("heavylift.pipeline.model.components").component_names()})
    if name[:1].isupper():
        found = import_module("heavylift.pipeline.model.components").component_class(name)
        if found is not None:
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__getattr__("__all__")})
