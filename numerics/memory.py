"""Whether there is room for what is asked for, before it is made.

A count that nobody can compute, a thousand million elements or edges of a nanometre, is most often a slip of units.
Made without asking it would fill the memory until the system ends the process, or others.
"""

from __future__ import annotations

import contextlib
import math
import os
from pathlib import Path

from heavylift.numerics.outcome import InputError

__all__ = ["amount_of_bytes", "available_memory", "refuse_beyond_memory", "span_of_time"]

CONTAINER = Path("/sys/fs/cgroup")


def available_memory() -> float:
    """Memory [bytes] that this process can still take: of the machine, or of the container if that is less."""
    found = [math.inf]
    with contextlib.suppress(OSError, ValueError, IndexError):
        lines = Path("/proc/meminfo").read_text().splitlines()
        found.append(
            1024.0 * sum(int(x.split()[1]) for x in lines if x.startswith(("MemAvailable:", "SwapFree:")))
        )
    with contextlib.suppress(OSError, ValueError):
        limit = int((CONTAINER / "memory.max").read_text())  # "max" if there is none
        found.append(float(limit - int((CONTAINER / "memory.current").read_text())))
    if len(found) == 1:
        with contextlib.suppress(OSError, ValueError):
            found.append(float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")))
    return min(found)


def refuse_beyond_memory(
    count: float, what: str, *, bytes_each: float, seconds_each: float, source: object, key: str, remedy: str
) -> None:
    """Refuse a number of items for which there is not enough memory.

    Parameters
    ----------
    count, what
        How many, in a word, e.g. "elements".
    bytes_each, seconds_each
        What each of them takes.
    source, key, remedy
        Of the error: where the number comes from, and what makes it smaller.

    Raises
    ------
    InputError
        They need more memory than is available. It says how much that is, and how long they would take.
    """
    needed, there = count * bytes_each, available_memory()
    if needed <= there:
        return
    raise InputError(
        f"about {count:.2g} {what}, which take {amount_of_bytes(needed)} of memory and "
        f"{span_of_time(count * seconds_each)} or more",
        source=source,
        key=key,
        expected=f"{remedy}: {amount_of_bytes(there)} are available, for {there / bytes_each:.2g} of them",
    )


def amount_of_bytes(count: float) -> str:
    """E.g. "12 GB"; beyond all prefixes a power of ten."""
    for unit in ("B", "kB", "MB", "GB", "TB", "PB"):
        if count < 1000.0:
            return f"{count:.2g} {unit}" if count < 100.0 else f"{count:.0f} {unit}"
        count /= 1000.0
    return f"{count * 1000.0:.1e} PB"


def span_of_time(seconds: float) -> str:
    """E.g. "3 min"; beyond all units a power of ten."""
    for unit, size in (("s", 60.0), ("min", 60.0), ("h", 24.0), ("days", 365.0)):
        if seconds < size:
            return f"{seconds:.2g} {unit}" if seconds < 10.0 else f"{seconds:.0f} {unit}"
        seconds /= size
    return f"{seconds:.0f} years" if seconds < 1e4 else f"{seconds:.0e} years"
