"""Everything between bodies, packed: markers, kinds of joints and laws, the system of their rows, their channels."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.coordinates import attachments, first_dofs, inverse_masses, inverse_scales
from heavylift.solver.force_elements.watched import WatchedRopes, WatchesRopes, watch_ropes_of
from heavylift.solver.interface import FORCES
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowSystem, classify_rows, pack_rows
from heavylift.solver.scene.channels import ChannelBook, MonitorOutputs
from heavylift.solver.scene.connections import OnBody, PackedForce
from heavylift.solver.scene.meshes import MeshBody
from heavylift.solver.scene.outputs import Columns
from heavylift.solver.scene.scene import AnyBody, FlexibleBody, Gravity, Scene
from heavylift.solver.scene.sliding_joints import joint_friction, joint_stops

if TYPE_CHECKING:
    from heavylift.solver.force_elements.packing import PackedLaws
    from heavylift.solver.layout_sea import PackedSea

__all__ = ["PackedConnections", "pack_connections", "point_forces"]

NOTHING_MOVES: Mapping[str, int] = {}


@dataclass
class PackedConnections:
    """What stands between the bodies of a scene.

    Attributes
    ----------
    book
        Markers of all bodies.
    bases
        Number of bases of each frame and shell, with its moving points, by name.
    moving
        Number of moving points of each frame and shell that contacts slide on, by name.
    first_markers
        Of each point force.
    joints, systems, forces
        Kinds.
    block_names
        Whom each block of rows belongs to.
    record
        All channels so far, theirs behind those of bodies and sensors.
    sea
        Forces of wind, current and lines.
    notes
        What the user should know.
    """

    book: MarkerBook
    bases: Mapping[str, int]
    first_markers: list[int]
    record: ChannelBook
    joints: tuple[Any, ...] = ()
    systems: tuple[Any, ...] = ()
    forces: list[Any] = field(default_factory=list)
    block_names: tuple[str, ...] = ()
    moving: Mapping[str, int] = field(default_factory=dict)
    sea: PackedSea | None = None
    notes: tuple[str, ...] = ()


def pack_connections(
    scene: Scene,
    ordered: Sequence[AnyBody],
    record: ChannelBook,
    integrator: str,
    moving: Mapping[str, int] = NOTHING_MOVES,
) -> PackedConnections:
    """Pack all connections of a scene.

    Parameters
    ----------
    scene, ordered
        What the user said, and its bodies in the order of their kinds.
    record
        Channels of bodies and sensors.
    integrator
        Name of the integrator: it decides which springs are rows.
    moving
        Number of moving points of frames and shells, by name.

    Notes
    -----
    The velocities by which a mesh is seen are those of the material points that are in use, so with meshes all
    is packed twice: first to count these points.
    """
    meshes = [body for body in ordered if isinstance(body, MeshBody)]
    if not meshes:
        return _pack(scene, ordered, record, integrator, {})
    from heavylift.solver.bodies.ancf.bases import plan_bases
    from heavylift.solver.joints.mesh_joints import expand_joints

    scene = expand_joints(scene)
    packed = _pack(scene, ordered, record, integrator, {}, counting=True)

    markers = packed.book.of([body.name for body in meshes])
    counts = {
        body.name: len(plan_bases(body, on_body).bases) + moving.get(body.name, 0)
        for body, on_body in zip(meshes, markers, strict=True)
    }
    packed = _pack(scene, ordered, record, integrator, counts)
    packed.moving = moving
    return packed


def _pack(
    scene: Scene,
    ordered: Sequence[AnyBody],
    before: ChannelBook,
    integrator: str,
    bases: Mapping[str, int],
    *,
    counting: bool = False,
) -> PackedConnections:
    """One pass with a given number of bases; one that only counts ends with the last marker."""
    record = ChannelBook(before.channels)
    packed = PackedConnections(MarkerBook(), bases, [], record)
    book = packed.book
    for force in point_forces(scene):
        packed.first_markers.append(book.point(force.body, force.point, FORCES))
        if force.frame == "body":
            for axis in np.eye(3):
                book.direction(force.body, axis, FORCES, at=force.point)
    if scene.sea is not None:
        from heavylift.solver.layout_sea import pack_sea

        packed.sea = pack_sea(scene, book, record)
    watched = _watched(scene, integrator)
    _pack_forces(scene, packed, watched)
    flexible = [body for body in ordered if isinstance(body, FlexibleBody)]
    packed.notes = _tell_turned(scene, flexible, book)
    attachment = attachments(ordered, first_dofs(ordered, bases), bases)
    make_system: Any = None
    if scene.joints:
        from heavylift.solver.joints.registry import pack_joints

        columns = [record.add(joint.name, joint.CHANNELS) for joint in scene.joints]
        first = book.count
        packed.joints, make_system, packed.block_names = pack_joints(
            scene.joints, columns, book, attachment, inverse_scales(ordered), ordered
        )
        _refuse_turned(flexible, book, first, scene.joints)
    laws, first = None, book.count
    if _has_laws(scene):
        laws = _pack_laws(scene, ordered, packed, attachment, watched, integrator)
        # of what laws hang on, line bearings hold a plane; ropes pull at the centres of their sheaves
        bearings = [force for force in scene.forces if hasattr(force, "inward")]
        _refuse_turned(flexible, book, first, bearings)
    if laws is not None:
        packed.joints += tuple(laws.joints)
        packed.block_names += laws.block_names
        packed.forces += laws.forces
    first = book.count
    markers = _contact_markers(scene, book)
    _refuse_turned(flexible, book, first, scene.contacts)
    if counting:
        return packed
    if scene.joints or laws is not None or scene.touches:
        inverse_mass = inverse_masses(ordered, bases)
        held: RowSystem | None = make_system(inverse_mass, record.width) if scene.joints else None
        made = held
        if laws is not None:
            from heavylift.solver.force_elements.system import extend_system

            made = extend_system(held, laws.blocks, inverse_mass, record.width, laws=laws.fitted)
        if made is None:  # contacts alone have no rows of joints beside them
            made = pack_rows([], [], [], inverse_mass, -1)
        classify_rows(made)
        packed.systems = (made,)
        if made.monitor >= 0:
            record.add("monitor", MonitorOutputs.CHANNELS)
        if scene.touches:
            _add_contacts(scene, ordered, packed, markers, attachment, inverse_mass)
    return packed


def point_forces(scene: Scene) -> list[Any]:
    """Tabulated forces on points, in their order; their module is imported only if there are any."""
    return [
        force for force in scene.forces if isinstance(force, OnBody) and not isinstance(force, PackedForce)
    ]


def _refuse_turned(
    flexible: Sequence[FlexibleBody], book: MarkerBook, first: int, things: Sequence[Any]
) -> None:
    """Refuse what holds directions of bodies with modes where these turn, of the markers from a number on."""
    if flexible and things:
        from heavylift.solver.bodies.floating_frame.turned import refuse_turned

        refuse_turned(flexible, book, first, things)


def _tell_turned(scene: Scene, flexible: Sequence[FlexibleBody], book: MarkerBook) -> tuple[str, ...]:
    """Sentences on forces and measures with directions of bodies with modes where these turn."""
    if not flexible:
        return ()
    from heavylift.solver.bodies.floating_frame.turned import tell_held_chords, tell_turned

    things: list[Any] = [
        force
        for force in scene.forces
        if isinstance(force, PackedForce) or getattr(force, "frame", "world") == "body"
    ]
    if scene.sea is not None:
        things += [*scene.sea.loads, *scene.sea.fenders]
    return (*tell_turned(flexible, book, things), *tell_held_chords(flexible, scene.joints))


def _watched(scene: Scene, integrator: str) -> WatchedRopes:
    """Ropes whose pulls something watches."""
    measures = [force for force in scene.forces if isinstance(force, WatchesRopes)]
    pulling = [np.asarray(force.acceleration) for force in scene.forces if isinstance(force, Gravity)]
    gravity: NDArray[np.float64] = np.sum([np.zeros(3), *pulling], axis=0)
    return watch_ropes_of(measures, scene.ropes, scene.bodies, gravity, integrator)


def _pack_forces(scene: Scene, packed: PackedConnections, watched: WatchedRopes) -> None:
    """Forces that their modules pack, one kind a sort, with their channels."""
    groups: dict[str, list[tuple[PackedForce, Columns]]] = {}
    for force in scene.forces:
        if isinstance(force, PackedForce):
            columns = packed.record.add(force.name, force.CHANNELS)
            groups.setdefault(type(force).__module__, []).append((force, columns))
    for module, members in groups.items():
        pack = importlib.import_module(module).pack
        more = (watched,) if isinstance(members[0][0], WatchesRopes) else ()
        forces, places = [force for force, _ in members], [at for _, at in members]
        packed.forces.append(pack(forces, places, packed.book, *more))


def _contact_markers(scene: Scene, book: MarkerBook) -> list[Any]:
    """Markers of what touches contours."""
    if not scene.contacts:
        return []
    from heavylift.solver.contact.packing import contact_markers

    return contact_markers(scene, book)


def _add_contacts(
    scene: Scene,
    ordered: Sequence[AnyBody],
    packed: PackedConnections,
    markers: list[Any],
    attachment: Any,
    inverse_mass: Any,
) -> None:
    """Their system beside that of the joints, and their channels."""
    from heavylift.solver.contact.packing import pack_contacts

    columns = [packed.record.add(contact.name, contact.CHANNELS) for contact in scene.contacts]
    of_collisions = [
        (
            packed.record.add(collision.name, collision.CHANNELS),
            [
                packed.record.add(f"{collision.name}.contact_{i + 1}", collision.CONTACT_CHANNELS)
                for i in range(collision.recorded)
            ],
        )
        for collision in scene.collisions
    ]
    contacts = pack_contacts(
        scene,
        ordered,
        columns,
        of_collisions,
        markers,
        attachment,
        first_dofs(ordered, packed.bases),
        inverse_mass,
        inverse_scales(ordered),
        len(packed.block_names),
        packed.systems[0].attachments,
    )
    packed.systems += (contacts,)
    packed.block_names += tuple(contact.name for contact in scene.contacts)
    packed.block_names += tuple(collision.name for collision in scene.collisions)


def _pack_laws(
    scene: Scene,
    ordered: Sequence[AnyBody],
    packed: PackedConnections,
    attachment: Any,
    watched: WatchedRopes,
    integrator: str,
) -> PackedLaws:
    """Ropes, springs, stops, friction, motors."""
    from heavylift.solver.force_elements.packing import add_law_channels, law_owners, pack_laws

    by_name = {joint.name: joint for joint in scene.joints}
    places = {owner.name: add_law_channels(owner, by_name, packed.record) for owner in law_owners(scene)}
    return pack_laws(
        scene,
        places,
        packed.book,
        attachment,
        inverse_scales(ordered),
        watched,
        first_block=len(scene.joints),
        integrator=integrator,
    )


def _has_laws(scene: Scene) -> bool:
    """Whether there is anything beside joints, gravity and point forces."""
    plain = all(isinstance(force, (Gravity, OnBody, PackedForce)) for force in scene.forces)
    cornered = any(any(joint_stops(joint)) or any(joint_friction(joint)) for joint in scene.joints)
    return bool(scene.ropes or scene.transporters) or not plain or cornered
