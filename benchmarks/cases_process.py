"""A process that `cases.py` measures: the command ``heavylift``, and where its CPU time goes.

A finder at the head of `sys.meta_path` takes the time of modules that are executed, and wraps the few functions of
`WATCHED` when their module has been. Little is imported here, since it counts.
"""

from __future__ import annotations

import atexit
import functools
import importlib.abc
import json
import os
import sys
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

PARTS = ("Python", "read", "scene", "start", "steps", "files")
WATCHED = {
    "heavylift.pipeline.stages.stages": {
        "load_changed_case": "read",
        "_check_scene": "read",
        "mesh_stage": "read",
        "modes_stage": "read",
    },
    "heavylift.pipeline.results.provenance": {"simulate_digest": "read", "source_digest": "read"},
    "heavylift.pipeline.stages.simulate": {"simulate_stage": "files"},
    "heavylift.pipeline.assemble.scene": {"assemble_scene": "scene"},
    "heavylift.solver.simulation": {
        "Simulation.__init__": "scene",
        "Simulation.warm_up": "start",
        "Simulation.restore": "start",
        "Simulation.advance": "steps",
    },
}
"""Functions whose time counts for a part, by their modules."""

REPORT = "HEAVYLIFT_BENCHMARK_PARTS"
"""Variable of the environment with the file that the process writes."""
LISTED = 45
"""Functions in a profile."""


class Parts:
    """CPU time of the process by part; that of the innermost part that has begun and not ended runs."""

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PARTS, 0.0)
        self._open = ["Python"]
        self._since = 0.0

    def begin(self, part: str) -> None:
        """From here on time counts for `part`."""
        self._charge()
        self._open.append(part)

    def end(self) -> None:
        """From here on time counts for what ran before."""
        self._charge()
        self._open.pop()

    def _charge(self) -> None:
        now = time.process_time()
        self.seconds[self._open[-1]] += now - self._since
        self._since = now

    def watched(self, function: Callable[..., Any], part: str) -> Callable[..., Any]:
        """The same function, whose time counts for `part`."""

        @functools.wraps(function)
        def call(*arguments: Any, **keys: Any) -> Any:
            self.begin(part)
            try:
                return function(*arguments, **keys)
            finally:
                self.end()

        return call

    def write(self, file: str) -> None:
        """Write all parts."""
        self._charge()
        with open(file, "w", encoding="utf-8") as stream:  # noqa: PTH123  pathlib is not imported for it
            json.dump(self.seconds, stream)


class Finder(importlib.abc.MetaPathFinder):
    """Takes the time of modules while they are executed, and watches functions of some."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts

    def find_spec(self, name: str, path: Sequence[str] | None, target: Any = None) -> ModuleSpec | None:
        """The module as the finders behind this one have it."""
        for finder in sys.meta_path:
            if finder is self or not hasattr(finder, "find_spec"):
                continue
            spec = finder.find_spec(name, path, target)
            if spec is not None:
                if spec.loader is not None and hasattr(spec.loader, "exec_module"):
                    self._watch(spec.loader, name)
                return spec
        return None

    def _watch(self, loader: Any, name: str) -> None:
        run = loader.exec_module

        def exec_module(module: ModuleType) -> None:
            self._parts.begin("Python")
            try:
                run(module)
            finally:
                self._parts.end()
            for path, part in WATCHED.get(name, {}).items():
                owner, _, attribute = path.rpartition(".")
                holder = getattr(module, owner) if owner else module
                setattr(holder, attribute, self._parts.watched(getattr(holder, attribute), part))

        if not isinstance(loader, type):  # of built-in and frozen modules the class itself is the loader
            loader.exec_module = exec_module


def measured() -> None:
    """Be the command ``heavylift`` and write the parts of its time."""
    parts = Parts()
    sys.meta_path.insert(0, Finder(parts))
    atexit.register(parts.write, os.environ[REPORT])
    from heavylift.pipeline.commands.start import main

    sys.argv = ["heavylift", *sys.argv[2:]]
    main()


def profiled() -> None:
    """Be the command ``heavylift`` and print where its time goes."""
    import cProfile
    import pstats

    profile = cProfile.Profile(time.process_time)
    sys.argv = ["heavylift", *sys.argv[2:]]
    try:
        profile.enable()
        from heavylift.pipeline.commands.start import main

        main()
    finally:
        profile.disable()
        for order in ("cumulative", "tottime"):
            pstats.Stats(profile).strip_dirs().sort_stats(order).print_stats(LISTED)


if __name__ == "__main__":
    if sys.argv[1] == "--measured":
        measured()
    else:
        profiled()
