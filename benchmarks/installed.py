"""Environment of processes that are measured: modules have their bytecode, as in a program that is installed."""

from __future__ import annotations

import os
import tempfile

__all__ = ["environment"]

BYTECODE = tempfile.TemporaryDirectory(prefix="heavylift-bytecode-")
"""Where all processes that this one starts find the bytecode of modules."""


def environment(**variables: str) -> dict[str, str]:
    """That of this process, with bytecode written and found, and more variables.

    A process that may not write bytecode compiles all its sources, 0.3 to 0.8 s each time.
    """
    every = os.environ | {"PYTHONPYCACHEPREFIX": BYTECODE.name} | variables
    every.pop("PYTHONDONTWRITEBYTECODE", None)
    return every
