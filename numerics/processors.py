"""How many processors a process may use, those it was given or as many as the environment says; and of what type."""

from __future__ import annotations

import os
import platform
from functools import cache
from pathlib import Path

from heavylift.numerics.outcome import InputError

__all__ = ["PROCESSES", "processor_type", "processors"]

PROCESSES = "HEAVYLIFT_PROCESSES"
"""Variable of the environment: how many processes at once make what is independent."""


def processors() -> int:
    """Processors that this process may use, or the number in the environment.

    Raises
    ------
    InputError
        If that is no number of processes.
    """
    given = os.environ.get(PROCESSES, "").strip()
    if given:
        if not given.isdecimal() or int(given) == 0:
            raise InputError(
                f"{given!r}", source="environment", key=PROCESSES, expected="1 or more processes"
            )
        return int(given)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def processor_type() -> str:
    """What the first processor can do: compiled code and libraries choose their instructions by that."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").partition("\n\n")[0].splitlines()
    except OSError:
        return f"{platform.machine()} {platform.processor()}"
    known = (line for line in lines if line.startswith(("model name", "flags", "Features")))
    return "\n".join([platform.machine(), *known])
