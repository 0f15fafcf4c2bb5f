"""Is this lift safe? FEM to flexible multibody dynamics; the folders beside this file are links to the sources.

Public names are imported at their first use, so that importing the package stays cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from heavylift.numerics.outcome import InputError, Outcome
    from heavylift.pipeline.exchange.client import ExchangeError, RemoteSimulation, connect, open_child
    from heavylift.pipeline.stepping.simulation import Simulation, SimulationStopped
    from heavylift.pipeline.stepping.state import State

__all__ = [
    "ExchangeError",
    "InputError",
    "Outcome",
    "RemoteSimulation",
    "Simulation",
    "SimulationStopped",
    "State",
    "connect",
    "open_child",
]

_HOMES = {
    "ExchangeError": "pipeline.exchange.client",
    "InputError": "numerics.outcome",
    "Outcome": "numerics.outcome",
    "RemoteSimulation": "pipeline.exchange.client",
    "Simulation": "pipeline.stepping.simulation",
    "SimulationStopped": "pipeline.stepping.simulation",
    "State": "pipeline.stepping.state",
    "connect": "pipeline.exchange.client",
    "open_child": "pipeline.exchange.client",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
