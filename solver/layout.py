"""Where everything lives: a scene of user objects becomes a tuple of kinds, a workspace and named channels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.interface import ENERGY_NAMES, SUM_COUNT, Workspace
from heavylift.solver.markers import BodyMarkers
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
    bodies, forces
        Tuples of kinds; only kinds that have members.
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
        column = _body_channels(body, channels, column)
    sensors: dict[str, list[tuple[int, Any]]] = {body.name: [] for body in ordered}
    for sensor in scene.sensors:
        sensors[sensor.body].append((column, np.asarray(sensor.point, dtype=np.float64)))
        channels += [
            Channel(f"{sensor.name}.position", "m", _XYZ, column),
            Channel(f"{sensor.name}.velocity", "m/s", _XYZ, column + 3),
        ]
        column += 6
    for name in (*ENERGY_NAMES, "balance"):
        channels.append(Channel(f"energy.{name}", "J", (name,), column))
        column += 1
    channels += [
        Channel("momentum.linear", "kg m/s", _XYZ, column),
        Channel("momentum.angular", "kg m^2/s", _XYZ, column + 3),
    ]
    column += 6

    markers: dict[str, list[tuple[int, Any, bool]]] = {body.name: [] for body in ordered}
    first_markers: list[int] = []
    marker_total = 0
    for force in points:
        first_markers.append(marker_total)
        markers[force.body].append((marker_total, np.asarray(force.point, dtype=np.float64), False))
        if force.frame == "body":
            markers[force.body] += [(marker_total + 1 + k, np.eye(3)[k], True) for k in range(3)]
        marker_total += 4 if force.frame == "body" else 1

    bodies: list[Any] = []
    number = dof = start = 0
    for group, pack in _groups(scene):
        bodies.append(pack(group, number, dof, start, _of(markers, group), _of_sensors(sensors, group)))
        number += len(group)
        dof += sum(6 + _mode_count(body) for body in group)
        start += sum(_width(body) for body in group)
    window = 6 + max(map(_mode_count, ordered))
    forces: list[Any] = []
    if gravity:
        from heavylift.solver.forces.gravity import pack_gravity

        forces.append(pack_gravity(gravity))
    if points:
        from heavylift.solver.forces.point import pack_point_forces

        forces.append(pack_point_forces(points, first_markers))
    work = Workspace(
        velocity=np.zeros(dof),
        markers=np.zeros((marker_total, 9)),
        jacobian=np.zeros((marker_total, 3, window)),
        sums=np.zeros(SUM_COUNT),
        status=np.zeros(2, dtype=np.int64),
    )
    names = tuple(body.name for body in ordered)
    return Layout(tuple(bodies), tuple(forces), work, tuple(channels), column, names)


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


def _body_channels(body: FlexibleBody | RigidBody, channels: list[Channel], column: int) -> int:
    """Append the channels of a body; returns the next free column."""
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
    for name, unit, components in entries:
        channels.append(Channel(f"{body.name}.{name}", unit, components, column))
        column += len(components)
    return column


def _of(markers: dict[str, list[tuple[int, Any, bool]]], bodies: list[Any]) -> list[BodyMarkers]:
    return [
        BodyMarkers(
            tuple(number for number, _, _ in markers[body.name]),
            tuple(vector for _, vector, _ in markers[body.name]),
            tuple(direction for _, _, direction in markers[body.name]),
        )
        for body in bodies
    ]


def _of_sensors(sensors: dict[str, list[tuple[int, Any]]], bodies: list[Any]) -> list[BodyMarkers]:
    return [
        BodyMarkers(
            tuple(column for column, _ in sensors[body.name]),
            tuple(point for _, point in sensors[body.name]),
            (False,) * len(sensors[body.name]),
        )
        for body in bodies
    ]
