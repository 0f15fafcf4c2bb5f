"""Where everything lives: a scene of user objects becomes a tuple of kinds, a workspace and named channels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.connections import GROUND
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
from heavylift.solver.rows import DIAGONAL, FACTORED, PRESCRIBED, Attachment
from heavylift.solver.scene import Fixed, FlexibleBody, Free, Gravity, PointForce, RigidBody, Scene, Sensor

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
    body_names
        Names by body number, for messages.
    """

    bodies: tuple[Any, ...]
    forces: tuple[Any, ...]
    joints: tuple[Any, ...]
    systems: tuple[Any, ...]
    work: Workspace
    channels: tuple[Channel, ...]
    column_count: int
    body_names: tuple[str, ...]


_XYZ = ("x", "y", "z")


def pack_scene(scene: Scene) -> Layout:
    """Turn a scene into kinds. A kind without members is not imported, not compiled and not run.

    Raises
    ------
    InputError
        If names repeat, a force or sensor names a body that is not there, or a value does not fit.
    """
    _check_names(scene)
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
    dofs = _first_dofs(ordered)
    if scene.joints:
        from heavylift.solver.joints.registry import joint_channels, pack_joints

        columns = []
        for joint in scene.joints:
            columns.append(column)
            column = _add_channels(joint.name, joint_channels(joint), channels, column)
        joints, make_system = pack_joints(
            scene.joints, columns, book, _attachments(ordered, dofs), _scales(ordered)
        )
        systems = (make_system(_inverse_mass(ordered), column),)
        entries = [("violation", "1", ("violation",)), ("pivot", "1", ("pivot",))]
        column = _add_channels("monitor", entries, channels, column)
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
    work = Workspace(
        velocity=np.zeros(sum(6 + _mode_count(body) for body in ordered)),
        markers=np.zeros((book.count, MARKER_WIDTH)),
        jacobian=np.zeros((book.count, 3, 6 + max(map(_mode_count, ordered)))),
        sums=np.zeros(SUM_COUNT),
        control=np.zeros(CONTROL_COUNT),
        status=np.zeros(3, dtype=np.int64),
    )
    for marker, vector in book.fixed:
        work.markers[marker, POINT : POINT + 3] = vector
    names = [body.name for body in ordered]
    return Layout(tuple(bodies), tuple(forces), joints, systems, work, tuple(channels), column, tuple(names))


def _add_channels(
    owner: str, entries: Sequence[tuple[str, str, tuple[str, ...]]], channels: list[Channel], column: int
) -> int:
    """Append channels; returns the next free column."""
    for name, unit, components in entries:
        channels.append(Channel(f"{owner}.{name}", unit, components, column))
        column += len(components)
    return column


def _first_dofs(bodies: Sequence[FlexibleBody | RigidBody]) -> dict[str, int]:
    """Place of the velocities of each body."""
    widths = [6 + _mode_count(body) for body in bodies]
    starts = np.concatenate([[0], np.cumsum(widths)])
    return {body.name: int(start) for body, start in zip(bodies, starts[:-1], strict=True)}


def _attachments(
    bodies: Sequence[FlexibleBody | RigidBody], dofs: dict[str, int]
) -> Callable[[str], Attachment]:
    """Where the rows on a body go, by its name."""
    found = {GROUND: Attachment(-1, -1, 0, PRESCRIBED)}
    for number, body in enumerate(bodies):
        holder = PRESCRIBED if not isinstance(body.motion, Free) else DIAGONAL
        if isinstance(body, FlexibleBody):
            holder = FACTORED
        found[body.name] = Attachment(number, dofs[body.name], 6 + _mode_count(body), holder)
    return found.__getitem__


def _inverse_mass(bodies: Sequence[FlexibleBody | RigidBody]) -> NDArray[np.float64]:
    """Of the velocities of free rigid bodies in their principal axes; zero elsewhere."""
    blocks: list[NDArray[np.float64]] = []
    for body in bodies:
        block = np.zeros(6 + _mode_count(body))
        if isinstance(body, RigidBody) and isinstance(body.motion, Free):
            block[:3] = 1.0 / body.mass
            block[3:] = 1.0 / np.linalg.eigvalsh(body.inertia)
        blocks.append(block)
    return np.concatenate(blocks)


def _scales(bodies: Sequence[FlexibleBody | RigidBody]) -> Callable[[str], tuple[float, float]]:
    """Inverse mass and smallest inverse inertia by name; zero for prescribed motion."""
    by_name = {body.name: body for body in bodies}

    def scales(name: str) -> tuple[float, float]:
        body = by_name[name]
        if isinstance(body, FlexibleBody):
            integrals = body.reduced.integrals
            largest = float(np.linalg.eigvalsh(integrals.inertia_kl)[1:].sum())
            held = not isinstance(body.motion, Free) and body.reduced.mode_count == 0
            return (0.0, 0.0) if held else (1.0 / integrals.mass, 1.0 / largest)
        if not isinstance(body.motion, Free):
            return 0.0, 0.0
        return 1.0 / body.mass, 1.0 / float(np.linalg.eigvalsh(body.inertia)[2])

    return scales


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
        from heavylift.solver.bodies.fixed_frame import pack_fixed_frames

        groups.append((fixed, pack_fixed_frames))
    if rigid:
        from heavylift.solver.bodies.rigid_kind import pack_rigid_bodies

        groups.append((rigid, pack_rigid_bodies))
    return groups


def _mode_count(body: FlexibleBody | RigidBody) -> int:
    return body.reduced.mode_count if isinstance(body, FlexibleBody) else 0


def _width(body: FlexibleBody | RigidBody) -> int:
    """Record columns of a body: pose 7, velocities 6, modal 2 nf, reaction 6 unless it is free."""
    return 13 + 2 * _mode_count(body) + (0 if isinstance(body.motion, Free) else 6)


def _check_names(scene: Scene) -> None:
    seen: set[str] = set()
    for thing in (*scene.bodies, *scene.sensors):
        if thing.name in seen or thing.name in ("energy", "momentum", "time"):
            raise InputError(
                f"the name {thing.name!r} is taken", source="scene", expected="a name of its own for each"
            )
        seen.add(thing.name)
    if not scene.bodies:
        raise InputError("no body", source="scene", expected="at least one")
    for part in (*scene.bodies, *scene.forces):
        if not isinstance(part, (FlexibleBody, RigidBody, Gravity, PointForce)):
            raise InputError(
                f"a {type(part).__name__}", source="scene", expected="bodies and forces of `solver.scene`"
            )
    for body in scene.bodies:
        _check_body(body)
    names = {body.name for body in scene.bodies}
    users: list[Sensor | PointForce] = [*scene.sensors]
    users += [force for force in scene.forces if isinstance(force, PointForce)]
    for user in users:
        if user.body not in names:
            raise InputError(
                f"there is no body {user.body!r}",
                source="scene",
                key=user.name,
                expected=f"one of {', '.join(sorted(names))}",
            )


def _check_body(body: FlexibleBody | RigidBody) -> None:
    """Refuse start values of the wrong length or not finite: no later check would see a lost position."""
    shapes: dict[str, tuple[int, ...]] = {"position": (3,), "orientation": (4,)}
    shapes |= {"velocity": (3,), "angular_velocity": (3,)}
    if isinstance(body, RigidBody):
        shapes |= {"centre_of_mass": (3,), "inertia": (3, 3)}
    else:
        for key in ("modal_position", "modal_velocity", "damping_ratio"):
            if np.size(getattr(body, key)):
                shapes[key] = (body.reduced.mode_count,)
    for key, shape in shapes.items():
        value = np.asarray(getattr(body, key), dtype=np.float64)
        if value.shape != shape or not np.all(np.isfinite(value)):
            raise InputError(
                f"{value.tolist()}", source=body.name, key=key, expected=f"finite numbers, shape {shape}"
            )
    if not np.any(body.orientation):
        raise InputError("length zero", source=body.name, key="orientation", expected="a quaternion")


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
