"""Compile several units at once, each process some of them.

The processes are Python programs of their own, so nothing of the calling program is run twice. Each gets one
unit a line, and answers with one line.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import pkgutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence

import heavylift.contours
import heavylift.modal
import heavylift.numerics
import heavylift.solver
from heavylift.numerics.children import NEUTRAL_FOLDER, module_folders, python_command
from heavylift.numerics.jit import runs_in_python
from heavylift.numerics.objects import (
    ENTRIES,
    CompileError,
    Entry,
    Unit,
    build_unit,
    is_compiled,
    writable_root,
)
from heavylift.numerics.processors import processors
from heavylift.numerics.sources import edited_since_start
from heavylift.solver.kinds import kind_units, kinds_with_operations

__all__ = ["WaitingUnits", "all_units", "compile_units", "missing_units", "unit_of"]

ALONE = 2
"""Units up to which no process is started: each needs about a second before it can begin."""

DONE, FAILED = "done", "failed"


def all_units() -> dict[str, list[Unit]]:
    """Units by the kind or loop that they belong to; imports all modules with kernels that Python calls."""
    for package in (heavylift.numerics, heavylift.contours, heavylift.modal, heavylift.solver):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            importlib.import_module(module.name)
    found: dict[str, list[Unit]] = {}
    for kind in kinds_with_operations():
        units = list(kind_units(kind).values())
        if units:
            found[kind.__name__] = units
    for entry in ENTRIES:
        if entry.__module__.startswith("heavylift."):
            found[entry.unit.name] = [entry.unit]
    return dict(sorted(found.items()))


def missing_units(units: Sequence[Unit]) -> list[Unit]:
    """Those of some units that have no whole object file; none where kernels run as plain Python."""
    if runs_in_python():
        return []
    return [unit for unit in units if not is_compiled(unit)]


def unit_of(module: str, name: str, group: str) -> Unit:
    """A unit by its owner."""
    owner = getattr(importlib.import_module(module), name)
    if isinstance(owner, Entry):
        return owner.unit
    return kind_units(owner)[group]


def compile_units(
    units: Sequence[Unit], tell: Callable[[str, float], None], processes: int | None = None
) -> None:
    """Make the object files of some units, the largest first, those of one kind in one process if it can be.

    Parameters
    ----------
    units
        All of them are compiled.
    tell
        Called with the name of a unit and its CPU time [s] when it is done, in any thread.
    processes
        One for each processor that may be used if None, see `heavylift.numerics.processors`.

    Raises
    ------
    CompileError
        Of the first unit that does not compile; the others are done.
    """
    waiting = WaitingUnits(units)
    troubles: list[str] = []
    if len(units) <= ALONE:
        for unit in units:
            tell(unit.name, build_unit(unit))
        return
    # the folder that this process found writable, and the modules that it sees, whatever the current folder holds
    environment = os.environ | {
        "HEAVYLIFT_CACHE_DIR": str(writable_root().absolute()),
        "PYTHONPATH": os.pathsep.join(module_folders()),
    }

    def work(number: int) -> None:
        if hasattr(
            signal, "pthread_sigmask"
        ):  # libraries such as gmsh let a write to a dead process end ours
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
        command = python_command("-m", "heavylift.solver.compiling")
        process = subprocess.Popen(  # noqa: S603
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
            cwd=NEUTRAL_FOLDER,
        )
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(OSError):  # a process that dies leaves its unit to the caller's own
            while (unit := waiting.take(number)) is not None:
                print(*unit.owner, sep="\t", file=process.stdin, flush=True)
                kind, _, answer = process.stdout.readline().rstrip("\n").partition("\t")
                if kind == DONE:
                    tell(unit.name, float(answer))
                elif kind == FAILED:
                    troubles.append(answer)
                else:
                    break
        with contextlib.suppress(OSError):
            process.stdin.close()
        process.stdout.close()
        process.wait()

    count = min(len(units), processes or processors())
    threads = [threading.Thread(target=work, args=(number,), daemon=True) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        while thread.is_alive():
            thread.join(0.2)  # lets Ctrl-C through
    if troubles:
        raise CompileError(troubles[0])
    for unit in missing_units(units):  # of processes that died; an edited source is compiled where it is used
        if not edited_since_start(unit.modules):
            tell(unit.name, build_unit(unit))


class WaitingUnits:
    """Units that wait for a process.

    What units of one kind call is much the same, and a process knows the types of what it has compiled. So it takes
    next what belongs to a kind that it has begun; then the largest of a kind that nobody has begun; and before it has
    nothing to do, the largest of another process.
    """

    def __init__(self, units: Iterable[Unit]) -> None:
        self._left = sorted(units, key=lambda one: len(one.entries), reverse=True)
        self._begun: dict[tuple[str, str], int] = {}
        self._lock = threading.Lock()

    def take(self, process: int) -> Unit | None:
        """The next unit for a process, by its number; None if all are taken."""
        with self._lock:
            if not self._left:
                return None
            by = [self._begun.get(unit.owner[:2]) for unit in self._left]
            place = by.index(process) if process in by else by.index(None) if None in by else 0
            unit = self._left.pop(place)
            self._begun.setdefault(unit.owner[:2], process)
            return unit


def _serve() -> None:
    """What a process does; it ends with its input, so Ctrl-C is for those who feed it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for line in sys.stdin:
        begin = time.process_time()
        try:
            build_unit(unit_of(*line.rstrip("\n").split("\t")))
        except Exception as error:  # noqa: BLE001  reported in one line by the caller
            print(FAILED, str(error).replace("\n", " "), sep="\t", flush=True)  # noqa: T201
        else:
            print(DONE, f"{time.process_time() - begin:.3f}", sep="\t", flush=True)  # noqa: T201
        gc.collect()
        gc.freeze()  # what is still in use will be to the end: the next search is for what the next unit leaves


if __name__ == "__main__":
    _serve()
