"""All that acts on bodies and between them, packed: markers, joints, force elements, the system of rows, channels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.solver.coordinates import attachments, first_dofs, inverse_masses, inverse_scales
from heavylift.solver.force_elements.packing import PackingContext
from heavylift.solver.force_elements.registry import elements_of, pack_elements
from heavylift.solver.force_elements.system import extend_system
from heavylift.solver.force_elements.watched import watch_ropes_of
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import RowSystem, classify_rows, pack_rows
from heavylift.solver.scene.channels import ChannelBook, MonitorOutputs
from heavylift.solver.scene.connections import Stage
from heavylift.solver.scene.scene import AnyBody, Scene

if TYPE_CHECKING:
    from heavylift.solver.layout_sea import PackedSea

__all__ = ["PackedConnections", "pack_connections"]

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
        The scene, and its bodies in the order of their kinds.
    record
        Channels of bodies and sensors.
    integrator
        Name of the integrator, for which springs are rows, or forces.
    moving
        Number of moving points of frames and shells, by name.

    Notes
    -----
    The velocities by which a mesh is seen are those of the material points that are in use, so with meshes all
    is packed twice: first to count these points.
    """
    meshes = [body for body in ordered if body.SEEN_AT_POINTS]
    if not meshes:
        return _pack(scene, ordered, record, integrator, {})
    from heavylift.solver.joints.mesh_joints import expand_joints

    scene = expand_joints(scene)
    packed = _pack(scene, ordered, record, integrator, {}, counting=True)

    markers = packed.book.of([body.name for body in meshes])
    counts = {
        body.name: body.kind_module.point_count(body, on_body) + moving.get(body.name, 0)
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
    packed = PackedConnections(MarkerBook(), bases, record)
    book = packed.book
    attachment = attachments(ordered, first_dofs(ordered, bases), bases)
    scales = inverse_scales(ordered)
    context = PackingContext(
        scene, integrator, book, attachment, scales, watch_ropes_of(scene, integrator), len(scene.joints)
    )
    loads, acting, elements = (elements_of(scene, stage) for stage in Stage)
    pack_elements(loads, context, record)
    if scene.sea is not None:
        from heavylift.solver.layout_sea import pack_sea

        packed.sea = pack_sea(scene, book, record)
    pack_elements(acting, context, record)
    flexible: list[Any] = [body for body in ordered if body.mode_count]
    if flexible:
        from heavylift.solver.bodies.floating_frame.held_chords import (
            tell_few_modes,
            tell_held_chords,
            tell_lines,
        )

        packed.notes = (
            *tell_held_chords(flexible, scene.joints),
            *tell_few_modes(flexible, scene.joints),
            *tell_lines(flexible, scene.joints),
        )
    make_system: Any = None
    if scene.joints:
        from heavylift.solver.joints.registry import pack_joints

        columns = [record.add(joint.name, joint.CHANNELS) for joint in scene.joints]
        packed.joints, make_system, packed.block_names = pack_joints(
            scene.joints, columns, book, attachment, scales, ordered
        )
    pack_elements(elements, context, record)
    packed.joints += tuple(context.row_kinds)
    packed.block_names += context.block_names
    packed.forces = context.force_kinds
    packed.notes += tuple(context.notes)
    markers = _contact_markers(scene, book)
    if counting:
        return packed
    if scene.joints or elements or scene.touches:
        inverse_mass = inverse_masses(ordered, bases)
        held: RowSystem | None = make_system(inverse_mass, record.width) if scene.joints else None
        made = held
        if elements:
            made = extend_system(held, context.blocks, inverse_mass, record.width)
        if made is None:  # contacts alone have no rows of joints beside them
            made = pack_rows([], [], [], inverse_mass, -1)
        classify_rows(made)
        packed.systems = (made,)
        if made.monitor >= 0:
            record.add("monitor", MonitorOutputs.CHANNELS)
        if scene.touches:
            _add_contacts(scene, ordered, packed, markers, attachment, inverse_mass)
    return packed


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
