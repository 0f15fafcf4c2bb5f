"""Named columns of a record."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from heavylift.solver.scene.descriptions import XYZ, ChannelKind

__all__ = [
    "ENERGY_CHANNELS",
    "MOMENTUM_CHANNELS",
    "MONITOR_CHANNELS",
    "SCENARIO_CHANNELS",
    "Channel",
    "add_channels",
    "channel_width",
]

ENERGY = "moment or energy"
ENERGY_CHANNELS = (
    ChannelKind("kinetic", ENERGY, "kinetic energy", unit="J"),
    ChannelKind("elastic", ENERGY, "elastic energy of bodies, springs and ropes", unit="J"),
    ChannelKind("potential", ENERGY, "potential energy of gravity", unit="J"),
    ChannelKind("external_work", ENERGY, "work of applied forces", unit="J"),
    ChannelKind("drive_work", ENERGY, "work of driven frames and joints, winches and motors", unit="J"),
    ChannelKind("dissipated", ENERGY, "energy lost to damping and friction", unit="J"),
    ChannelKind(
        "balance",
        ENERGY,
        "kinetic + elastic + potential - works + dissipated; constant in exact arithmetic",
        unit="J",
    ),
)
"""Of the whole scene, ``energy.kinetic`` ..."""
MOMENTUM_CHANNELS = (
    ChannelKind("linear", "momentum", "linear momentum, world axes", XYZ),
    ChannelKind("angular", "angular momentum", "angular momentum about the world origin, world axes", XYZ),
)
"""Of the whole scene."""
MONITOR_CHANNELS = (
    ChannelKind("violation", "number", "largest violation of a rigid row of a joint, m or rad"),
    ChannelKind(
        "pivot",
        "number",
        "smallest pivot of the joint equations, relative to the characteristic inverse mass",
    ),
    ChannelKind(
        "carried_drift",
        "number",
        "largest distance of an elongation that a rope, tabulated spring or stop carries from the geometry, m or rad",
    ),
)
"""Of the rows of joints."""
SCENARIO_CHANNELS = (
    ChannelKind(
        "phase",
        "number",
        "number of the phase of the scenario, from 1; one more than there are once all are done",
    ),
    ChannelKind("track_phase", "number", "the same of each track beside the first one", None),
)
"""Of the scenario."""


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
    sentence: str


def add_channels(
    owner: str,
    kinds: Iterable[ChannelKind],
    channels: list[Channel],
    column: int,
    chosen: Mapping[str, tuple[str, ...]] | None = None,
) -> int:
    """Append channels of an owner, with the components that the scene decides; returns the next free column."""
    for kind in kinds:
        columns = kind.columns(chosen)
        channels.append(Channel(f"{owner}.{kind.name}", kind.unit, columns, column, kind.sentence))
        column += len(columns)
    return column


def channel_width(kinds: Iterable[ChannelKind], chosen: Mapping[str, tuple[str, ...]] | None = None) -> int:
    """Number of columns of channels."""
    return sum(len(kind.columns(chosen)) for kind in kinds)
