"""Processes that this one starts: none takes code from the folder in which the program happens to stand.

``python -c`` and ``python -m`` look for modules in the current folder first. It may be the folder of a case that came
from someone else, where a file ``numpy.py`` would run.
"""

from __future__ import annotations

import os
import sys

__all__ = ["NEUTRAL_FOLDER", "module_folders", "python_command"]

NEUTRAL_FOLDER = os.sep
"""Current folder of a process that needs none: libraries also read settings from it, as Matplotlib and Numba do."""


def python_command(*arguments: str) -> list[str]:
    """Command of another Python that sees installed modules, as this one does, and not those of the current folder."""
    return [sys.executable, "-P", *arguments]


def module_folders() -> list[str]:
    """Where this process finds modules, for another one; an empty entry would mean its current folder."""
    return [os.path.abspath(path) for path in sys.path if path]  # noqa: PTH100  a zip file may be one
