"""Recorded channels by what owns them: the last parts of their names, their kinds and components."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from heavylift.pipeline.case.collision_pairs import declared_collisions, yields
from heavylift.solver.scene.bodies import Fixed, FlexibleBody, Free, RigidBody
from heavylift.solver.scene.channels import ENERGY_CHANNELS, MOMENTUM_CHANNELS, MONITOR_CHANNELS
from heavylift.solver.scene.collisions import Collision
from heavylift.solver.scene.connections import FORCES, JOINTS, ROPES, Place
from heavylift.solver.scene.contacts import Contact
from heavylift.solver.scene.descriptions import known_channels, recorded_channels
from heavylift.solver.scene.meshes import FrameBody, MeshBody, ShellBody
from heavylift.solver.scene.moorings import MOORINGS
from heavylift.solver.scene.scene import Sensor
from heavylift.solver.scene.sea import Hull
from heavylift.solver.scene.wind_loads import FLUID_LOADS, WindField

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from heavylift.solver.scene.descriptions import ChannelKind, Family

__all__ = [
    "COLLISION_CONTACT",
    "CONTOUR_TYPES",
    "MESH_TYPES",
    "NAMED_LISTS",
    "OF_THE_SCENE",
    "RESERVED_NAMES",
    "SCENE_CHANNELS",
    "Declared",
    "all_channels",
    "channel_components",
    "declared",
    "joint_coordinate",
    "lies_along_edge",
]

OF_THE_SCENE = {"energy": ENERGY_CHANNELS, "momentum": MOMENTUM_CHANNELS, "monitor": MONITOR_CHANNELS}
"""Channels of the whole scene by the first part of their names."""
SCENE_CHANNELS = {
    f"{owner}.{channel.name}": channel.quantity
    for owner, channels in OF_THE_SCENE.items()
    for channel in channels
}
"""The same, name to kind."""
RESERVED_NAMES = frozenset({"energy", "momentum", "time", "monitor", "ground"})
"""Names that nothing in a case may take: first parts of channels of the scene, and the world."""

NAMED_LISTS = (
    "joints",
    "ropes",
    "forces",
    "sensors",
    "contacts",
    "surfaces",
    "collisions",
    "tanks",
    "fluid_loads",
    "lines",
    "fenders",
)
"""Lists of a case file whose tables have names."""


def _quantities(channels: Iterable[ChannelKind]) -> dict[str, str]:
    """Last parts of channels, and their quantities."""
    return {channel.name: channel.quantity for channel in channels}


COLLISION_CONTACT = _quantities(Collision.CONTACT_CHANNELS)
"""Last parts of the channels of each recorded contact of a collision, ``NAME.contact_1.point``: name to kind."""
MESHES: Mapping[str, type[MeshBody]] = {"frame": FrameBody, "shell": ShellBody}
BODIES: Mapping[str, Any] = {"flexible": FlexibleBody, "rigid": RigidBody, **MESHES}
LISTED: Mapping[str, Any] = {
    "sensors": Sensor,
    "contacts": Contact,
}
"""What the tables of some lists become, whatever they say: they record the same."""
FAMILIES: Mapping[str, tuple[Family[Any], str]] = {
    "joints": (JOINTS, ""),
    "forces": (FORCES, ""),
    "ropes": (ROPES, ""),
    "fluid_loads": (FLUID_LOADS, ""),
    "lines": (MOORINGS, "lines"),
    "fenders": (MOORINGS, "fenders"),
}
"""Descriptions of the tables of a list; and the word of the only one, where its tables say none."""

MESH_TYPES = frozenset(MESHES)
"""Types of bodies made of elements, whose channels have a component for every node or element."""

CONTOUR_TYPES = frozenset({"surface", "curve", "cylinder", "band"})
"""Types of contours."""


def all_channels() -> dict[str, str]:
    """Every last part of a channel that anything in the cases read so far may have: name to kind."""
    elsewhere = [*Collision.CONTACT_CHANNELS, *(channel for own in OF_THE_SCENE.values() for channel in own)]
    found = {}
    for name, channels in known_channels().items():
        own = [channel for channel in channels if all(channel is not other for other in elsewhere)]
        if own:
            found[name] = own[0].quantity
    return found


def channel_components(kind: str) -> tuple[str, ...] | None:
    """Components of a channel by the last part of its name; of numbers that part; None if the scene decides."""
    channels = known_channels().get(kind, ())
    found = {channel.columns() for channel in channels if channel.components is not None}
    return found.pop() if len(found) == 1 else (kind,) if not channels else None


def joint_coordinate(joint_type: str) -> str:
    """The scalar on which springs and motors of a sort of joints act, ``"angle"`` or ``"travel"``; empty if none."""
    described = JOINTS.get(joint_type)
    return "" if described is None else described.COORDINATE


def lies_along_edge(joint_type: str) -> bool:
    """Whether the channels of a sort of joints are those of each node along an edge: ``NAME.0.reaction_force``."""
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
    hulls, fluids, lines
        Names of the bodies that float, of winds and currents, and of mooring lines.
    channels
        By owner: last parts of its channels, and their kinds.
    references
        Reference histories by name: the channel, and whether the deviation is scaled.
    checks
        Quantities of the checks by id.
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
    channels: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    references: Mapping[str, tuple[str, bool]] = field(default_factory=dict)
    checks: Mapping[str, str] = field(default_factory=dict)
    reference_names: Counter[str] = field(default_factory=Counter)
    check_ids: Counter[str] = field(default_factory=Counter)


def declared(document: Mapping[str, Any]) -> Declared:
    """Collect the names of a document as read from TOML, blocks written out."""
    bodies = document.get("bodies", {})
    bodies = bodies if isinstance(bodies, dict) else {}
    types = {name: str(body.get("type")) for name, body in bodies.items() if isinstance(body, dict)}
    channels: dict[str, Mapping[str, str]] = {}
    for name, body in bodies.items():
        channels[name] = _body_channels(body if isinstance(body, dict) else {})
    joints: dict[str, str] = {}
    for name, row in _named(document, "joints"):
        joints.setdefault(name, str(row.get("type")))  # of a name that occurs again the first one counts
    for key, described in LISTED.items():
        channels |= dict.fromkeys(
            (name for name, _ in _named(document, key)), _quantities(described.CHANNELS)
        )
    for key, (family, word) in FAMILIES.items():
        channels |= {
            name: _described_channels(family, row, joints, word) for name, row in _named(document, key)
        }
    contours = document.get("contours", {})
    contours = contours if isinstance(contours, dict) else {}
    channels |= {name: {} for name in contours}
    surfaces = {name: str(row.get("body")) for name, row in _named(document, "surfaces")}
    yielding = frozenset(name for name, body in bodies.items() if yields(body))
    rows = list(_named(document, "collisions"))
    collided = declared_collisions(rows, surfaces, yielding)
    channels |= {name: {} for name in (*surfaces, *(name for name, _ in rows))}
    channels |= {pair: _quantities(Collision.CHANNELS) for _, pair, _ in collided}
    afloat = document.get("hulls", {})
    hulls = frozenset(name for name in afloat if name in bodies) if isinstance(afloat, dict) else frozenset()
    channels |= {name: {**channels[name], **_quantities(Hull.CHANNELS)} for name in hulls}
    fluids = _fluids(document)
    channels |= dict.fromkeys(fluids, _quantities(WindField.CHANNELS))  # a current has the same
    channels |= {name: {} for name, _ in _named(document, "tanks")}
    numbered = [pair for name, pair, _ in collided if pair != name]
    return Declared(
        names=Counter(
            [*bodies, *contours, *numbered, *fluids]
            + [name for key in NAMED_LISTS for name, _ in _named(document, key)]
        ),
        bodies=frozenset(bodies),
        body_types=types,
        contours={
            name: (str(row.get("type")), str(row.get("body"))) if isinstance(row, dict) else ("", "")
            for name, row in contours.items()
        },
        surfaces=surfaces,
        yielding=yielding,
        collisions={pair: recorded for _, pair, recorded in collided},
        meshes=frozenset(name for name, kind in types.items() if kind in MESH_TYPES),
        shells=frozenset(name for name, kind in types.items() if kind == "shell"),
        joints=joints,
        hulls=hulls,
        fluids=frozenset(fluids),
        lines=frozenset(name for name, _ in _named(document, "lines")),
        channels=channels,
        references={
            name: (str(row.get("channel")), row.get("scale") is not None)
            for name, row in _named(document, "reference")
        },
        checks={name: str(row.get("quantity", "")) for name, row in _named(document, "check", "id")},
        reference_names=Counter(name for name, _ in _named(document, "reference")),
        check_ids=Counter(name for name, _ in _named(document, "check", "id")),
    )


def _named(document: Mapping[str, Any], key: str, name: str = "name") -> Iterator[tuple[str, dict[str, Any]]]:
    """Entries of a list of tables that have a name."""
    rows: Iterable[Any] = document.get(key, [])
    for row in rows if isinstance(rows, list) else ():
        if isinstance(row, dict) and isinstance(row.get(name), str):
            yield row[name], row


def _body_channels(body: Mapping[str, Any]) -> Mapping[str, str]:
    described = BODIES.get(str(body.get("type")), RigidBody)
    frame = body.get("frame")
    free = described in MESHES.values() or (isinstance(frame, dict) and frame.get("motion") == "free")
    return _quantities((*described.CHANNELS, *(Free if free else Fixed).CHANNELS))


def _fluids(document: Mapping[str, Any]) -> list[str]:
    """Names of winds and currents, as often as they occur; a table alone may have none of its own."""
    sea = document.get("sea")
    found = []
    for kind in ("wind", "current"):
        rows = sea.get(kind, []) if isinstance(sea, dict) else []
        for row in [rows] if isinstance(rows, dict) else rows if isinstance(rows, list) else []:
            name = row.get("name", kind) if isinstance(row, dict) else None
            found += [name] if isinstance(name, str) else []
    return found


def _described_channels(
    family: Family[Any], row: Mapping[str, Any], joints: Mapping[str, str], word: str = ""
) -> Mapping[str, str]:
    """Of a sort that does not exist any channel, so that its type is all that is told."""
    described = family.get(word or str(row.get("type", family.default)))
    if described is None:
        return all_channels()
    along = joint_coordinate(joints.get(str(row.get("joint")), "")) or "angle"
    return _quantities(recorded_channels(described, along))
