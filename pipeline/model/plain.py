"""Values that a program gives, as a case file has them: numbers, texts, lists and tables."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from heavylift.numerics.outcome import InputError

__all__ = ["plain"]


def plain(value: Any, key: str = "") -> Any:
    """A value as it is read from TOML: arrays and tuples are lists, numbers of NumPy are those of Python.

    Parameters
    ----------
    value
        A number, text, list, table or array of such; keys of a table that are None are left out.
    key
        Dotted key for the message.

    Raises
    ------
    InputError
        If it is something else.
    """
    if isinstance(value, (bool, int, float, str)):
        return str(value) if isinstance(value, str) else value
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist(), key)
    if isinstance(value, Mapping):
        found = {}
        for name, entry in value.items():
            if not isinstance(name, str):
                raise InputError(f"key {name!r} is no text", key=key, expected="a table with texts as keys")
            if entry is not None:
                found[name] = plain(entry, f"{key}.{name}" if key else name)
        return found
    if isinstance(value, (list, tuple)):
        return [plain(entry, f"{key}.{index}" if key else str(index)) for index, entry in enumerate(value)]
    if isinstance(value, os.PathLike):
        return Path(value).as_posix()
    raise InputError(
        f"{value!r} is a {type(value).__name__}",
        key=key,
        expected="a number, a text, a list, or a table (dict)",
    )
