"""Named columns of a record."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.descriptions import XYZ, ChannelKind
from heavylift.solver.scene.outputs import Columns, Components, Outputs, Part, Parts, channel, nested, outputs

__all__ = [
    "Channel",
    "ChannelBook",
    "EnergyOutputs",
    "MomentumOutputs",
    "MonitorOutputs",
    "PhaseOutputs",
    "TotalOutputs",
    "TrackOutputs",
]

ENERGY = "moment or energy"


@outputs
class EnergyOutputs(Outputs):
    """Of the whole scene, ``energy.kinetic`` ..."""

    kinetic: float = channel(ENERGY, "kinetic energy", unit="J")
    elastic: float = channel(ENERGY, "elastic energy of bodies, springs and ropes", unit="J")
    potential: float = channel(ENERGY, "potential energy of gravity", unit="J")
    external_work: float = channel(ENERGY, "work of applied forces", unit="J")
    drive_work: float = channel(ENERGY, "work of driven frames and joints, winches and motors", unit="J")
    dissipated: float = channel(ENERGY, "energy lost to damping and friction", unit="J")
    balance: float = channel(
        ENERGY, "kinetic + elastic + potential - works + dissipated; constant in exact arithmetic", unit="J"
    )


@outputs
class MomentumOutputs(Outputs):
    """Of the whole scene."""

    linear: Components = channel("momentum", "linear momentum, world axes", XYZ)
    angular: Components = channel(
        "angular momentum", "angular momentum about the world origin, world axes", XYZ
    )


@outputs
class TotalOutputs(Outputs):
    """The end of a record."""

    energy: EnergyOutputs = nested(EnergyOutputs)
    momentum: MomentumOutputs = nested(MomentumOutputs)


@outputs
class MonitorOutputs(Outputs):
    """Of the rows of joints."""

    violation: float = channel("number", "largest violation of a rigid row of a joint, m or rad")
    pivot: float = channel(
        "number", "smallest pivot of the joint equations, relative to the characteristic inverse mass"
    )
    carried_drift: float = channel(
        "number",
        "largest distance of an elongation that a rope, tabulated spring or stop carries from the geometry, m or rad",
    )


@outputs
class PhaseOutputs(Outputs):
    """Of a track of the scenario, the first one."""

    phase: float = channel(
        "number", "number of the phase of the scenario, from 1; one more than there are once all are done"
    )


@outputs
class TrackOutputs(Parts):
    """Of the tracks beside the first one."""

    track_phase: Part = channel("number", "the same of each sequence beside the first one", None)


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


class ChannelBook:
    """Channels of a record in the order of their columns, and where those of each component are.

    Parameters
    ----------
    channels
        Those that are there already.
    """

    def __init__(self, channels: Iterable[Channel] = ()) -> None:
        self.channels = list(channels)
        self.width = sum(len(channel.components) for channel in self.channels)

    def add(
        self, owner: str, kinds: Iterable[ChannelKind], chosen: Mapping[str, tuple[str, ...]] | None = None
    ) -> Columns:
        """Columns of the channels of an owner, with the components that the scene decides."""
        first, widths = self.width, []
        for kind in kinds:
            columns = kind.columns(chosen)
            name = f"{owner}.{kind.name}"
            self.channels.append(Channel(name, kind.unit, columns, self.width, kind.sentence))
            self.width += len(columns)
            widths.append((kind.name, len(columns)))
        return Columns(first, widths)
