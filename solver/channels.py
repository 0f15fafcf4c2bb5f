"""Named columns of a record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from heavylift.solver.descriptions import ChannelKind

__all__ = ["XYZ", "Channel", "add_channels", "add_described"]

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
    sentence
        What it is, in words.
    """

    name: str
    unit: str
    components: tuple[str, ...]
    column: int
    sentence: str = ""


def add_channels(
    owner: str, entries: Sequence[tuple[str, str, tuple[str, ...]]], channels: list[Channel], column: int
) -> int:
    """Append channels of an owner: name, unit and components of each; returns the next free column."""
    for name, unit, components in entries:
        channels.append(Channel(f"{owner}.{name}", unit, components, column))
        column += len(components)
    return column


def add_described(owner: str, kinds: Sequence[ChannelKind], channels: list[Channel], column: int) -> int:
    """Append channels of an owner from their descriptions; returns the next free column."""
    for kind in kinds:
        channels.append(Channel(f"{owner}.{kind.name}", kind.unit, kind.columns, column, kind.sentence))
        column += len(kind.columns)
    return column
