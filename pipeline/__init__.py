"""The outside world: case files, stages, results on disk, pictures, the command line.

Attributes
----------
load_case, run_case, load_results
    The three functions of the Python interface; imported on first use, so that
    importing the package stays cheap.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from heavylift.pipeline.case.case_file import load_case
    from heavylift.pipeline.results.histories import load_results
    from heavylift.pipeline.stages.stages import run_case

__all__ = ["load_case", "load_results", "run_case"]

_HOMES = {"load_case": "case.case_file", "load_results": "results.histories", "run_case": "stages.stages"}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
