"""Versions of installed packages, without the library for metadata.

They are read off the names of the folders that `pip` makes beside a package: that takes a millisecond at each start,
the library fifty. It is asked where there is no such folder.
"""

from __future__ import annotations

import os
import re
import sys
from functools import cache
from typing import NamedTuple

__all__ = ["Installed", "installed", "plain_name", "version_of"]


class Installed(NamedTuple):
    """Version of a package, and the folder of its metadata."""

    version: str
    folder: str


def plain_name(name: str) -> str:
    """A name as all its spellings have it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def installed() -> dict[str, Installed]:
    """Packages that `pip` has installed, by name; the first folder of the path counts."""
    found: dict[str, Installed] = {}
    for folder in sys.path:
        try:
            names = os.listdir(folder)  # noqa: PTH208  of strings, many of them
        except OSError:  # a zip file, or nothing
            continue
        for name in names:
            if name.endswith(".dist-info"):
                package, _, version = name.removesuffix(".dist-info").rpartition("-")
                found.setdefault(plain_name(package), Installed(version, f"{folder}/{name}"))
    return found


@cache
def _first_found() -> dict[str, Installed]:
    """What was installed when it was first asked for."""
    return installed()


def version_of(name: str) -> str | None:
    """Version of a package, whoever has installed it; None if nobody has."""
    place = _first_found().get(plain_name(name))
    if place is not None:
        return place.version
    from importlib import metadata

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None
