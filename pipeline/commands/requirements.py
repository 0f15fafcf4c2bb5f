"""Whether the packages that heavylift needs are installed in versions that it knows.

The ranges are those of the package's own metadata, which ``pyproject.toml`` gives. Versions are read off the names of
the folders that `pip` makes beside a package: that takes a millisecond at each start, the library for metadata fifty.
"""

from __future__ import annotations

import contextlib
import re
from typing import NamedTuple

from heavylift.numerics.packages import Installed, installed, plain_name, version_of

__all__ = ["Requirement", "remedy", "requirements", "troubles"]


class Requirement(NamedTuple):
    """A package that heavylift needs.

    Attributes
    ----------
    name
        As `pip` knows it.
    range
        Versions as ``">=0.62,<0.69"``; empty for any.
    version
        That is installed; None if there is none.
    """

    name: str
    range: str
    version: str | None

    @property
    def fits(self) -> bool:
        """Whether it is installed in the range."""
        return self.version is not None and all(
            _within(self.version, bound) for bound in filter(None, self.range.split(","))
        )

    def __str__(self) -> str:
        """As a person reads it, e.g. ``"numba 0.61.0, expected >=0.62,<0.69"``."""
        found = f"{self.name} {self.version}" if self.version else f"{self.name} is not installed"
        return f"{found}, expected {self.range or 'any version'}"


def requirements(lines: list[str] | None = None) -> list[Requirement]:
    """Packages without which heavylift does not run; none where it is not installed as a package.

    Parameters
    ----------
    lines
        What to look at in place of the metadata, e.g. ``["numba<0.69,>=0.62"]``.
    """
    known = installed()
    found = []
    for line in _own_lines(known.get("heavylift")) if lines is None else lines:
        spec = re.fullmatch(r"\s*([\w.-]+)\s*\(?([^;\[\]()]*)\)?\s*", line)
        if spec is None:  # of an extra, or of another system
            continue
        name, bounds = spec[1], sorted((part.strip() for part in spec[2].split(",")), reverse=True)
        place = known.get(plain_name(name))
        found.append(Requirement(name, ",".join(bounds), place.version if place else version_of(name)))
    return found


def troubles(found: list[Requirement] | None = None) -> list[Requirement]:
    """Packages that are missing or outside of their range."""
    return [one for one in (requirements() if found is None else found) if not one.fits]


def remedy(found: list[Requirement]) -> str:
    """What to type to get packages in their ranges."""
    return "pip install " + " ".join(f"'{one.name}{one.range}'" for one in found)


def _own_lines(own: Installed | None) -> list[str]:
    """What the metadata of heavylift say that it needs."""
    if own is None:
        return []
    with contextlib.suppress(OSError), open(f"{own.folder}/METADATA", encoding="utf-8") as file:  # noqa: PTH123
        head = file.read().partition("\n\n")[0]
        return re.findall(r"^Requires-Dist: (.*)$", head, re.MULTILINE)
    return []


def _within(version: str, bound: str) -> bool:
    """Whether a version is on the right side of a bound, by the numbers of its release.

    A release candidate counts as the release before which it came; a bound that is no comparison holds.
    """
    spec = re.fullmatch(r"(>=|<=|==|!=|<|>)\s*([\d.]+)", bound)
    if spec is None:
        return True
    own, other = _release(version), _release(spec[2])
    return {
        ">=": own >= other,
        "<=": own <= other,
        "==": own == other,
        "!=": own != other,
        "<": own < other,
        ">": own > other,
    }[spec[1]]


def _release(version: str) -> tuple[int, ...]:
    """Numbers of a release, without zeros at the end."""
    spec = re.match(r"(?:\d+!)?(\d+(?:\.\d+)*)", version)
    numbers = [int(part) for part in spec[1].split(".")] if spec else []
    while numbers and numbers[-1] == 0:
        numbers.pop()
    return tuple(numbers)
