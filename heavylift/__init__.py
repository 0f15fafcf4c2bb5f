"""Is this lift safe? FEM to flexible multibody dynamics; the folders beside this file are links to the sources.

Public names are imported at their first use, so that importing the package stays cheap.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from heavylift.numerics.outcome import InputError, Outcome
    from heavylift.pipeline.stepping.simulation import Simulation, SimulationStopped
    from heavylift.pipeline.stepping.state import State

__all__ = ["InputError", "Outcome", "Simulation", "SimulationStopped", "State"]

_HOMES = {
    "InputError": "numerics.outcome",
    "Outcome": "numerics.outcome",
    "Simulation": "pipeline.stepping.simulation",
    "SimulationStopped": "pipeline.stepping.simulation",
    "State": "pipeline.stepping.state",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
