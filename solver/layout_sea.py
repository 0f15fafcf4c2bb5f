"""What water and air bring to a packed scene: hulls among the bodies, loads and lines among the forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.markers import MarkerBook
from heavylift.solver.scene.bodies import Free
from heavylift.solver.scene.channels import ChannelBook
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.scene import AnyBody, Gravity, Scene
from heavylift.solver.scene.sea import FloatingBody, Hull, Sea, Tank
from heavylift.solver.scene.sliding_joints import joint_friction, joint_stops
from heavylift.solver.scene.wind_loads import CurrentProfile
from heavylift.solver.water.hulls.checks import check_sea

__all__ = ["PackedSea", "float_bodies", "floating_hulls", "pack_sea"]

LARGE_SPEEDS = {"WindField": 32.7, "CurrentField": 3.0}
"""Hurricane force by Beaufort's scale, and the fastest tidal streams [m/s]: above them the unit is asked for."""

KNOT = 1852.0 / 3600.0

GRAVITIES_DIFFER = 2e-3
"""Relative, between the weight of bodies and that of water: 9.81 and 9.80665 are the same."""


@dataclass
class PackedSea:
    """Forces of the sea, before their record columns are known.

    Attributes
    ----------
    forces
        Kinds.
    tangents, rate_tangents
        Stiffness and damping that lines and fenders leave for the step of hulls, shapes (n, 9).
    line_ends
        Body, marker and row of `tangents` of each of their ends on a hull.
    line_names, notes
        For messages; what the user should know.
    """

    forces: list[Any] = field(default_factory=list)
    tangents: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 9)))
    rate_tangents: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 9)))
    line_ends: list[tuple[str, int, int]] = field(default_factory=list)
    line_names: tuple[str, ...] = ()
    notes: list[str] = field(default_factory=list)


def float_bodies(scene: Scene) -> Scene:
    """The scene with hulls in place of the rigid bodies that float, interacting ones one after another.

    Raises
    ------
    InputError
        If hulls, databases or tanks do not fit the bodies, or the weight of the water is not that of the bodies.
    """
    sea = scene.sea
    if sea is None:
        return scene
    check_sea(sea)
    _check_direct(scene, sea)
    hulls = _floating_bodies(scene.bodies, sea)
    for tank in sea.tanks:
        if tank.hull not in hulls:
            raise InputError(
                f"there is no hull {tank.hull!r}",
                source=tank.name,
                key="hull",
                expected=f"one of {', '.join(hulls)}" if hulls else "a hull in the scene",
            )
        _refuse_outside(tank, hulls[tank.hull].hull.restoring)
    if hulls:
        _check_gravity(scene, sea)
    others = tuple(body for body in scene.bodies if body.name not in hulls)
    return replace(scene, bodies=(*others, *hulls.values()))


def floating_hulls(scene: Scene) -> list[FloatingBody]:
    """Hulls of a scene as they start, see `float_bodies`."""
    found: list[Any] = [body for body in float_bodies(scene).bodies if body.FLOATS]
    return found


def _refuse_outside(tank: Tank, surface: Any) -> None:
    """Refuse a rectangular tank that is beside its hull."""
    points = getattr(surface, "points", None)
    if points is None or tank.floor is None or tank.size is None:
        return
    for axis, word in enumerate(("before or behind", "beside")):
        low, high = points[:, axis].min(), points[:, axis].max()
        if not low <= tank.floor[axis] <= high:
            raise InputError(
                f"the middle of its floor is {word} the hull: {'xy'[axis]} of that is {low:.6g} to {high:.6g} m",
                source=tank.name,
                key="floor",
                expected="a place in the hull, in the coordinates of its geometry (are the units right?)",
            )


def _floating_bodies(bodies: tuple[AnyBody, ...], sea: Sea) -> dict[str, FloatingBody]:
    """Bodies that float, by name; those that interact follow each other.

    Raises
    ------
    InputError
        If a hull names a body that cannot float, twice, or a database one that is not a hull.
    """
    by_name = {body.name: body for body in bodies}
    hulls: dict[str, Hull] = {}
    for hull in sea.hulls:
        body = by_name.get(hull.body)
        if body is None or body.DEFORMS or hull.body in hulls:
            problem = "floats already" if hull.body in hulls else "is no rigid body"
            raise InputError(
                f"{hull.body!r} {problem}", source="hulls", key="body", expected="a rigid body, once"
            )
        if not isinstance(body.motion, Free):
            raise InputError(
                f"the motion of {hull.body!r} is prescribed",
                source="hulls",
                key="body",
                expected="a free body; a fixed joint to the ground holds it",
            )
        hulls[hull.body] = hull
    groups: list[tuple[str, ...]] = []
    taken: set[str] = set()
    for radiation in sea.radiation:
        names = radiation.bodies
        wrong = [name for name in names if name not in hulls or name in taken]
        if wrong or len(set(names)) != len(names):
            raise InputError(
                f"{(wrong or names)[0]!r} is no hull, or has a database already",
                source="radiation",
                key="bodies",
                expected=f"each of {', '.join(hulls)} at most once",
            )
        if len(names) != radiation.database.body_count:
            raise InputError(
                f"{len(names)} bodies for a database of {radiation.database.body_count}",
                source=radiation.database.source,
                key="bodies",
                expected=f"one a body of the database: {', '.join(radiation.database.bodies)}",
            )
        taken |= set(names)
        groups.append(names)
    groups += [(name,) for name in hulls if name not in taken]
    return {
        name: FloatingBody(**vars(by_name[name]), hull=hulls[name], group=names)
        for names in groups
        for name in names
    }


def _check_direct(scene: Scene, sea: Sea) -> None:
    """Convolution has weights for one step: nothing may halve it."""
    direct = [radiation for radiation in sea.radiation if radiation.memory == "direct"]
    iterated = scene.touches or scene.ropes or any(body.ITERATES for body in scene.bodies)
    stops = [joint.name for joint in scene.joints if any(joint_stops(joint)) or any(joint_friction(joint))]
    if direct and (iterated or stops):
        raise InputError(
            "direct convolution with ropes, stops, friction, contacts, frames or shells, which may halve a step",
            source=direct[0].database.source,
            key="memory",
            expected="'exponentials'",
        )


def _check_gravity(scene: Scene, sea: Sea) -> None:
    """Bodies and water have one weight, which points down."""
    total = np.sum([force.acceleration for force in scene.forces if isinstance(force, Gravity)], axis=0)
    wanted = np.array([0.0, 0.0, -sea.water.gravity])
    if np.size(total) != 3 or np.abs(total - wanted).max() > GRAVITIES_DIFFER * sea.water.gravity:
        given = np.asarray(total).tolist() if np.size(total) == 3 else "none"
        raise InputError(
            f"gravity of the scene is {given}, that of the water {sea.water.gravity:g} m/s2",
            source="sea",
            key="water",
            expected="the same, downwards",
        )


def pack_sea(scene: Scene, book: MarkerBook, record: ChannelBook) -> PackedSea:
    """Kinds of forces with their markers and channels."""
    packed = PackedSea()
    sea = scene.sea
    if sea is None:
        return packed
    if sea.fields or sea.loads:
        _pack_fluids(sea, packed, book, record)
    afloat = {body.name for body in scene.bodies if body.FLOATS}
    packed.tangents = np.zeros((len(sea.lines) + len(sea.fenders), 9))
    packed.rate_tangents = np.zeros_like(packed.tangents)
    if sea.lines:
        from heavylift.solver.water.lines.packing import line_markers, pack_mooring_lines

        markers = line_markers(book, sea.lines)
        columns = [record.add(line.name, line.CHANNELS) for line in sea.lines]
        places = [
            (_place(scene.bodies, line.body_a, line.point_a), _place(scene.bodies, line.body_b, line.point_b))
            for line in sea.lines
        ]
        kind = pack_mooring_lines(sea.lines, markers, columns, places)
        packed.forces.append(kind._replace(tangents=packed.tangents[: len(sea.lines)]))
        packed.line_names = tuple(line.name for line in sea.lines)
        for row, (line, (a, b)) in enumerate(zip(sea.lines, markers, strict=True)):
            packed.line_ends += [
                (body, marker, row) for body, marker in ((line.body_a, a), (line.body_b, b)) if body in afloat
            ]
    if sea.fenders:
        from heavylift.solver.water.lines.fenders import fender_markers, pack_fenders

        of_fenders = fender_markers(book, sea.fenders)
        columns = [record.add(fender.name, fender.CHANNELS) for fender in sea.fenders]
        fenders = pack_fenders(sea.fenders, of_fenders, columns)
        after = slice(len(sea.lines), None)
        packed.forces.append(
            fenders._replace(tangents=packed.tangents[after], rate_tangents=packed.rate_tangents[after])
        )
        for row, (fender, (a, _, b)) in enumerate(zip(sea.fenders, of_fenders, strict=True)):
            packed.line_ends += [
                (body, marker, len(sea.lines) + row)
                for body, marker in ((fender.body_a, a), (fender.body_b, b))
                if body in afloat
            ]
    return packed


def _pack_fluids(sea: Sea, packed: PackedSea, book: MarkerBook, record: ChannelBook) -> None:
    from heavylift.solver.water.wind.packing import (
        add_fluid_channels,
        fluid_markers,
        fluid_pieces,
        pack_fluid_loads,
    )

    for one in sea.fields:
        speeds = one.speed.speeds if isinstance(one.speed, CurrentProfile) else one.speed
        speed = float(np.max(speeds))
        limit = LARGE_SPEEDS[type(one).__name__]
        if speed > limit:
            knots = speed / KNOT
            packed.notes.append(
                f"{one.name!r} of {speed:g} m/s is {knots:.3g} knots: was a speed in knots meant?"
            )
    loads = fluid_pieces(sea.loads)
    columns = add_fluid_channels(record, sea.fields, loads)
    packed.forces.append(
        pack_fluid_loads(
            sea.fields,
            loads,
            fluid_markers(book, loads),
            columns,
            level=sea.water.level,
            ramp=0.0 if sea.at_rest else sea.ramp,
            water_density=sea.water.density,
        )
    )


def _place(bodies: Sequence[AnyBody], name: str, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Point of a body, or of the ground, in the world at the start [m]."""
    if name == GROUND:
        return np.asarray(point, dtype=np.float64)
    for body in bodies:
        if body.name == name:
            return np.asarray(body.position + rotation_matrix(body.orientation) @ np.asarray(point))
    known = ", ".join([GROUND, *(body.name for body in bodies)])
    raise InputError(f"there is no body {name!r}", source="lines", key="between", expected=f"one of {known}")
