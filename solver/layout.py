"""Where everything lives: a scene of user objects becomes a tuple of kinds, a workspace and named channels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.solver.coordinates import (
    attachments,
    first_dofs,
    inverse_masses,
    inverse_scales,
    mode_count,
)
from heavylift.solver.corners import scene_corners
from heavylift.solver.interface import (
    CONTROL_COUNT,
    ENERGY_NAMES,
    FORCES,
    MARKER_WIDTH,
    POINT,
    SUM_COUNT,
    Workspace,
)
from heavylift.solver.joints.packing import MarkerBook
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.rows import Rows, classify_rows
from heavylift.solver.scene import Fixed, FlexibleBody, Free, Gravity, PointForce, RigidBody, Scene
from heavylift.solver.scene_checks import check_scene

if TYPE_CHECKING:
    from heavylift.solver.joints.laws import PackedLaws

__all__ = ["Channel", "Layout", "pack_scene"]


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


@dataclass(frozen=True, eq=False)
class Layout:
    """A packed scene.

    Attributes
    ----------
    bodies, forces, joints, systems
        Tuples of kinds; only kinds that have members. The system of the rows is there if there are joints.
    work
        Shared arrays.
    channels
        Meaning of the columns of a record.
    column_count
        Length of a record.
    body_names, block_names
        Names by number of the body and of the block of rows, for messages.
    """

    bodies: tuple[Any, ...]
    forces: tuple[Any, ...]
    joints: tuple[Any, ...]
    systems: tuple[Any, ...]
    work: Workspace
    channels: tuple[Channel, ...]
    column_count: int
    body_names: tuple[str, ...]
    block_names: tuple[str, ...]


_XYZ = ("x", "y", "z")


def pack_scene(scene: Scene, integrator: str = "dele2") -> Layout:
    """Turn a scene into kinds. A kind without members is not imported, not compiled and not run.

    Parameters
    ----------
    scene
        What the user said.
    integrator
        Name of the integrator: only the default one takes springs as rows of its step.

    Raises
    ------
    InputError
        If names repeat, a force or sensor names a body that is not there, or a value does not fit.
    """
    check_scene(scene)
    ordered = [body for group, _ in _groups(scene) for body in group]
    gravity = [force for force in scene.forces if isinstance(force, Gravity)]
    points = [force for force in scene.forces if isinstance(force, PointForce)]

    channels: list[Channel] = []
    column = 0
    for body in ordered:
        column = _add_channels(body.name, _body_channels(body), channels, column)
    sensors: dict[str, list[tuple[int, Any]]] = {body.name: [] for body in ordered}
    for sensor in scene.sensors:
        sensors[sensor.body].append((column, np.asarray(sensor.point, dtype=np.float64)))
        entries = [("position", "m", _XYZ), ("velocity", "m/s", _XYZ)]
        column = _add_channels(sensor.name, entries, channels, column)
    book = MarkerBook()
    first_markers: list[int] = []
    for force in points:
        first_markers.append(book.point(force.body, force.point, FORCES))
        if force.frame == "body":
            for axis in np.eye(3):
                book.direction(force.body, axis, FORCES)
    joints: tuple[Any, ...] = ()
    systems: tuple[Any, ...] = ()
    block_names: tuple[str, ...] = ()
    dofs = first_dofs(ordered)
    if scene.joints:
        from heavylift.solver.joints.registry import joint_channels, pack_joints

        columns = []
        for joint in scene.joints:
            columns.append(column)
            column = _add_channels(joint.name, joint_channels(joint), channels, column)
        joints, make_system, block_names = pack_joints(
            scene.joints, columns, book, attachments(ordered, dofs), inverse_scales(ordered), ordered
        )
    laws: PackedLaws | None = None
    if _has_laws(scene):
        from heavylift.solver.joints.laws import law_channels, law_owners, pack_laws

        by_name = {joint.name: joint for joint in scene.joints}
        places = {}
        for owner in law_owners(scene):
            places[owner.name] = column
            column = _add_channels(owner.name, law_channels(owner, by_name), channels, column)
        laws = pack_laws(
            scene,
            places,
            book,
            attachments(ordered, dofs),
            inverse_scales(ordered),
            first_block=len(scene.joints),
            integrator=integrator,
        )
        joints += tuple(laws.joints)
        block_names += laws.block_names
    if scene.joints or laws is not None:
        held = make_system(inverse_masses(ordered), column) if scene.joints else None
        made: Rows | None = held
        if laws is not None:
            from heavylift.solver.joints.law_system import extend_system

            made = extend_system(held, laws.blocks, inverse_masses(ordered), column, laws=laws.fitted)
        assert made is not None  # one of the two made it
        classify_rows(made)
        systems = (made,)
        for name in ("violation", "pivot"):
            column = _add_channels("monitor", [(name, "1", (name,))], channels, column)
    for name in (*ENERGY_NAMES, "balance"):
        column = _add_channels("energy", [(name, "J", (name,))], channels, column)
    entries = [("linear", "kg m/s", _XYZ), ("angular", "kg m^2/s", _XYZ)]
    column = _add_channels("momentum", entries, channels, column)

    bodies: list[Any] = []
    number = start = 0
    for group, pack in _groups(scene):
        names = [body.name for body in group]
        bodies.append(pack(group, number, dofs[names[0]], start, book.of(names), _of_sensors(sensors, group)))
        number += len(group)
        start += sum(_width(body) for body in group)
    forces: list[Any] = []
    if gravity:
        from heavylift.solver.forces.gravity import pack_gravity

        forces.append(pack_gravity(gravity))
    if points:
        from heavylift.solver.forces.point import pack_point_forces

        forces.append(pack_point_forces(points, first_markers))
    if laws is not None:
        forces += laws.forces
    work = Workspace(
        velocity=np.zeros(sum(6 + mode_count(body) for body in ordered)),
        markers=np.zeros((book.count, MARKER_WIDTH)),
        jacobian=np.zeros((book.count, 3, 6 + max(map(mode_count, ordered)))),
        sums=np.zeros(SUM_COUNT),
        control=np.zeros(CONTROL_COUNT),
        corners=scene_corners(scene),
        status=np.zeros(3, dtype=np.int64),
    )
    for marker, vector in book.fixed:
        work.markers[marker, POINT : POINT + 3] = vector
    return Layout(
        bodies=tuple(bodies),
        forces=tuple(forces),
        joints=joints,
        systems=systems,
        work=work,
        channels=tuple(channels),
        column_count=column,
        body_names=tuple(body.name for body in ordered),
        block_names=block_names,
    )


def _has_laws(scene: Scene) -> bool:
    """Whether there is anything beside joints, gravity and point forces."""
    plain = all(isinstance(force, (Gravity, PointForce)) for force in scene.forces)
    cornered = any(
        getattr(joint, "limits", None) is not None or getattr(joint, "friction", 0.0) != 0.0
        for joint in scene.joints
    )
    return bool(scene.ropes) or not plain or cornered


def _add_channels(
    owner: str, entries: Sequence[tuple[str, str, tuple[str, ...]]], channels: list[Channel], column: int
) -> int:
    """Append channels; returns the next free column."""
    for name, unit, components in entries:
        channels.append(Channel(f"{owner}.{name}", unit, components, column))
        column += len(components)
    return column


def _groups(scene: Scene) -> list[tuple[list[Any], Callable[..., Any]]]:
    """Bodies by kind with the function that packs them; only kinds with members are imported."""
    flexible = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    floating = [body for body in flexible if not isinstance(body.motion, Fixed)]
    fixed = [body for body in flexible if isinstance(body.motion, Fixed)]
    rigid = [body for body in scene.bodies if isinstance(body, RigidBody)]
    groups: list[tuple[list[Any], Callable[..., Any]]] = []
    if floating:
        from heavylift.solver.bodies.floating_frame_kind import pack

        groups.append((floating, pack))
    if fixed:
        from heavylift.solver.bodies.fixed_frame_kind import pack_fixed_frames

        groups.append((fixed, pack_fixed_frames))
    if rigid:
        from heavylift.solver.bodies.rigid_kind import pack_rigid_bodies

        groups.append((rigid, pack_rigid_bodies))
    return groups


def _width(body: FlexibleBody | RigidBody) -> int:
    """Record columns of a body: pose 7, velocities 6, modal 2 nf, reaction 6 unless it is free."""
    return 13 + 2 * mode_count(body) + (0 if isinstance(body.motion, Free) else 6)


def _body_channels(body: FlexibleBody | RigidBody) -> list[tuple[str, str, tuple[str, ...]]]:
    """Name, unit and components of the channels of a body."""
    entries: list[tuple[str, str, tuple[str, ...]]] = [
        ("position", "m", _XYZ),
        ("orientation", "1", ("q0", "q1", "q2", "q3")),
        ("velocity", "m/s", _XYZ),
        ("angular_velocity", "rad/s", _XYZ),
    ]
    if isinstance(body, FlexibleBody):
        modes = tuple(str(i + 1) for i in range(body.reduced.mode_count))
        entries += [
            ("modal_position", "m kg^0.5", modes),
            ("modal_velocity", "m kg^0.5/s", modes),
        ]
    if not isinstance(body.motion, Free):
        entries += [("reaction_force", "N", _XYZ), ("reaction_moment", "N m", _XYZ)]
    return entries


def _of_sensors(sensors: dict[str, list[tuple[int, Any]]], bodies: list[Any]) -> list[BodyMarkers]:
    return [
        BodyMarkers(
            tuple(column for column, _ in sensors[body.name]),
            tuple(point for _, point in sensors[body.name]),
            (False,) * len(sensors[body.name]),
        )
        for body in bodies
    ]
