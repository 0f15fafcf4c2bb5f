"""Named columns of a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["XYZ", "Channel", "add_channels"]

XYZ = ("x", "y", "z")


@dataclass(frozen=True)
class Channel:
    """Named columns of a record.

    Attributes
    ----------
    name
        E.g. ``"beam.position"``.
    unit
        E.g. ``"m"``; ``"1"`` for quaternions.
    components
        Name of each column.
    column
        Index of the first column.
    """

    name: str
    unit: str
    components: tuple[str, ...]
    column: int


def add_channels(
    owner: str, entries: Sequence[tuple[str, str, tuple[str, ...]]], channels: list[Channel], column: int
) -> int:
    """Append channels of an owner: name, unit and components of each; returns the next free column."""
    for name, unit, components in entries:
        channels.append(Channel(f"{owner}.{name}", unit, components, column))
        column += len(components)
    return column
