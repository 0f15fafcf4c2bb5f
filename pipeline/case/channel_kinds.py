"""Recorded channels by what owns them: the last parts of their names, their kinds and components."""

from __future__ import annotations

from collections import Counter
from dataclasses import field
from typing import TYPE_CHECKING

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.channels import (
    EnergyOutputs,
    MomentumOutputs,
    MonitorOutputs,
    PhaseOutputs,
    TrackOutputs,
)
from heavylift.solver.scene.collisions import Collision
from heavylift.solver.scene.connections import JOINTS, Place
from heavylift.solver.scene.descriptions import known_channels

if TYPE_CHECKING:
    from collections.abc import Mapping


__all__ = [
    "COLLISION_CONTACT",
    "CONTOUR_TYPES",
    "MESH_TYPES",
    "OF_THE_SCENE",
    "RESERVED_NAMES",
    "SCENE_CHANNELS",
    "Declared",
    "all_channels",
    "channel_components",
    "has_both",
    "joint_coordinate",
    "lies_along_edge",
]

OF_THE_SCENE = {
    "energy": EnergyOutputs.CHANNELS,
    "momentum": MomentumOutputs.CHANNELS,
    "monitor": MonitorOutputs.CHANNELS,
    "scenario": (*PhaseOutputs.CHANNELS, *TrackOutputs.CHANNELS),
}
"""Channels of the whole scene by the first part of their names."""
SCENE_CHANNELS = {
    f"{owner}.{channel.name}": channel.quantity
    for owner, channels in OF_THE_SCENE.items()
    for channel in channels
}
"""The same, name to kind."""
RESERVED_NAMES = frozenset({"energy", "momentum", "time", "monitor", "scenario", "ground"})
"""Names that nothing in a case may take: first parts of channels of the scene, and the world."""

COLLISION_CONTACT = {channel.name: channel.quantity for channel in Collision.CONTACT_CHANNELS}
"""Last parts of the channels of each recorded contact of a collision, ``NAME.contact_1.point``: name to kind."""
_ELSEWHERE = frozenset(
    id(channel) for own in (Collision.CONTACT_CHANNELS, *OF_THE_SCENE.values()) for channel in own
)
"""Channels that are no last part of the name of a thing, by identity: others of the same name may be."""
MESH_TYPES = frozenset({"frame", "rod", "shell"})
"""Types of bodies made of elements, whose channels have a component for every node or element."""

CONTOUR_TYPES = frozenset({"surface", "curve", "cylinder", "band"})
"""Types of contours."""


def all_channels() -> dict[str, str]:
    """Every last part of a channel that anything in the cases read so far may have: name to kind."""
    found = {}
    for name, channels in known_channels().items():
        own = next((channel for channel in channels if id(channel) not in _ELSEWHERE), None)
        if own is not None:
            found[name] = own.quantity
    return found


def channel_components(kind: str) -> tuple[str, ...] | None:
    """Components of a channel by the last part of its name; of numbers that part; None if the scene decides."""
    channels = known_channels().get(kind, ())
    found = {channel.columns() for channel in channels if channel.components is not None}
    return found.pop() if len(found) == 1 else (kind,) if not channels else None


def joint_coordinate(joint_type: str, spec: object = None) -> str:
    """The scalar on which springs and motors of a type of joints act, ``"angle"`` or ``"travel"``; empty if none.

    For joints that have both, the `spec` decides.
    """
    described = JOINTS.get(joint_type)
    if described is None:
        return ""
    if has_both(joint_type):
        return str(spec) if spec in {"angle", "travel"} else ""
    return described.COORDINATE


def has_both(joint_type: str) -> bool:
    """Whether joints of a type turn and slide independently."""
    described = JOINTS.get(joint_type)
    names = {channel.name for channel in described.CHANNELS} if described is not None else set()
    return described is not None and not described.COORDINATE and {"angle", "travel"} <= names


def lies_along_edge(joint_type: str) -> bool:
    """Whether the channels of a type of joints are those of each node along an edge: ``NAME.0.reaction_force``."""
    described = JOINTS.get(joint_type)
    return described is not None and described.PLACE is Place.EDGE


@dataclass(frozen=True)
class Declared:
    """Names that a document declares, whatever else may be wrong with it.

    Attributes
    ----------
    names
        Everything with a name but databases, checks and references, with how often each occurs.
    bodies
        Names of the bodies.
    body_types
        Types of the bodies by name.
    contours
        By name of a contour: its type and its body.
    surfaces
        By name of a surface: its body.
    yielding
        Names of the bodies that give way to forces.
    collisions
        By first part of the channels of a collision: contacts that it records one by one.
    meshes
        Names of the frames and shells among them.
    shells
        Names of the shells alone.
    joints
        Types of the joints by name.
    hulls, fluids, lines, transporters
        Names of the bodies that float, of winds and currents, of mooring lines, and of transporters.
    sensors
        Names of the material points, and of the bodies that carry them.
    channels
        By owner: last parts of its channels, and their kinds.
    references
        Reference histories by name: the channel, and whether the deviation is scaled.
    checks
        Quantities of the checks with a reference, by id.
    reference_names, check_ids
        How often each occurs.
    """

    names: Counter[str] = field(default_factory=Counter)
    bodies: frozenset[str] = frozenset()
    body_types: Mapping[str, str] = field(default_factory=dict)
    contours: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    surfaces: Mapping[str, str] = field(default_factory=dict)
    yielding: frozenset[str] = frozenset()
    collisions: Mapping[str, int] = field(default_factory=dict)
    meshes: frozenset[str] = frozenset()
    shells: frozenset[str] = frozenset()
    joints: Mapping[str, str] = field(default_factory=dict)
    hulls: frozenset[str] = frozenset()
    fluids: frozenset[str] = frozenset()
    lines: frozenset[str] = frozenset()
    transporters: frozenset[str] = frozenset()
    sensors: Mapping[str, str] = field(default_factory=dict)
    channels: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    references: Mapping[str, tuple[str, bool]] = field(default_factory=dict)
    checks: Mapping[str, str] = field(default_factory=dict)
    reference_names: Counter[str] = field(default_factory=Counter)
    check_ids: Counter[str] = field(default_factory=Counter)
