"""What a scene must fulfil before it is packed: names, references between its parts, start values."""

from __future__ import annotations

from typing import Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.bodies import Body
from heavylift.solver.scene.connections import (
    GROUND,
    AlongJoint,
    ForceElement,
    Joint,
)
from heavylift.solver.scene.descriptions import check_object
from heavylift.solver.scene.inputs import Input
from heavylift.solver.scene.scene import AnyBody, Gravity, Scene

__all__ = ["check_scene"]

RESERVED = ("energy", "momentum", "monitor", "scenario", "time", GROUND)
"""First parts of channel names that nothing in a scene may take."""


def check_scene(scene: Scene) -> None:
    """Names, references and start values.

    Raises
    ------
    InputError
        The first inconsistency.
    """
    if not scene.bodies:
        raise InputError("no body", source="scene", expected="at least one")
    kinds = (
        (scene.bodies, Body, "bodies"),
        (scene.forces, (ForceElement,), "forces"),
        (scene.joints, (Joint,), "joints"),
        (scene.inputs, (Input,), "inputs"),
    )
    for parts, types, what in kinds:
        for part in parts:
            if not isinstance(part, types):
                raise InputError(f"a {type(part).__name__}", source="scene", key=what, expected=what)
    _check_names(scene)
    for body in scene.bodies:
        _check_body(body)
    for joint in scene.joints:
        _check_joint(joint)
    _check_stiffened(scene)
    described: list[Any] = [*scene.bodies, *scene.forces, *scene.joints, *scene.ropes]
    described += [*scene.decks, *scene.transporters, *scene.inputs]
    if scene.sea is not None:
        described += [
            *scene.sea.fields,
            *scene.sea.loads,
            *scene.sea.lines,
            *scene.sea.fenders,
            *scene.sea.hulls,
            *scene.sea.tanks,
            *scene.sea.pumps,
            *scene.sea.controllers,
        ]
        described += [] if scene.sea.water.tide is None else [scene.sea.water.tide]
    coordinates = {joint.name: joint.COORDINATE for joint in scene.joints}
    for thing in described:
        named = "" if hasattr(thing, "name") else "sea"
        own = getattr(thing, "coordinate", None)
        check_object(thing, own or coordinates.get(getattr(thing, "joint", ""), ""), named)


def _check_names(scene: Scene) -> None:
    """Every name of a channel once, and every reference to something that is there."""
    named: list[Any] = [force for force in scene.forces if not isinstance(force, Gravity)]
    named += scene.inputs
    seen: set[str] = set()
    recorded = [
        force for force in named if getattr(force, "CHANNELS", True)
    ]  # the others need no name of their own
    touching: tuple[Any, ...] = (*scene.contacts, *scene.collisions)
    at_sea = _named_at_sea(scene)
    connecting = (*scene.joints, *scene.ropes, *scene.transporters)
    for thing in (*scene.bodies, *scene.sensors, *connecting, *recorded, *touching, *at_sea):
        if thing.name in seen or thing.name in RESERVED:
            raise InputError(
                f"the name {thing.name!r} is taken", source="scene", expected="a name of its own for each"
            )
        seen.add(thing.name)
    names = {body.name for body in scene.bodies}
    joints = {joint.name for joint in scene.joints}
    users: list[Any] = [*scene.sensors, *connecting, *scene.decks, *named]
    if scene.sea is not None:
        users += [*scene.sea.loads, *scene.sea.lines, *scene.sea.fenders]
    for user in users:
        for body, may_be_ground in _bodies_of(user):
            if body not in names and not (may_be_ground and body == GROUND):
                ground = f" or {GROUND}" if may_be_ground else ""
                raise InputError(
                    f"there is no body {body!r}",
                    source="scene",
                    key=user.name,
                    expected=f"one of {', '.join(sorted(names))}{ground}",
                )
        if isinstance(user, AlongJoint) and user.joint not in joints:
            raise InputError(
                f"there is no joint {user.joint!r}",
                source="scene",
                key=user.name,
                expected=f"one of {', '.join(sorted(joints))}",
            )


def _named_at_sea(scene: Scene) -> list[Any]:
    """What has channels of its own; loads of one name are added up, so the name counts once."""
    if scene.sea is None:
        return []
    loads = {load.name: load for load in scene.sea.loads}
    ballast = (*scene.sea.tanks, *scene.sea.pumps, *scene.sea.controllers)
    return [*scene.sea.fields, *loads.values(), *scene.sea.lines, *scene.sea.fenders, *ballast]


def _bodies_of(thing: Any) -> list[tuple[str, bool]]:
    """Names of the bodies that something refers to, and whether each may be the ground."""
    if hasattr(thing, "path"):
        return [(point.body, True) for point in thing.path]
    if hasattr(thing, "body_a"):
        return [(thing.body_a, True), (thing.body_b, True)]
    return [(thing.body, getattr(thing, "MAY_BE_GROUND", False))] if hasattr(thing, "body") else []


def _check_joint(joint: Joint) -> None:
    """Two different sides, proper joint frames, compliance and relaxation that are not negative."""
    if joint.body_a == joint.body_b:
        raise InputError(
            f"both sides are {joint.body_a!r}",
            source=joint.name,
            key="between",
            expected="two different bodies",
        )
    for key, frame in (("frame_a", joint.frame_a), ("frame_b", joint.frame_b)):
        point = np.asarray(frame.point, dtype=np.float64)
        axes = np.asarray(frame.axes, dtype=np.float64)
        good = point.shape == (3,) and axes.shape == (3, 3) and np.all(np.isfinite(point))
        if not (good and np.allclose(axes.T @ axes, np.eye(3), atol=1e-9) and np.linalg.det(axes) > 0.0):
            raise InputError(
                f"point {point.tolist()}, axes {axes.tolist()}",
                source=joint.name,
                key=key,
                expected="a finite point and three unit axes at right angles, right-handed",
            )
    for key in ("compliance", "relaxation"):
        value = getattr(joint, key)
        if not 0.0 <= value < np.inf:
            raise InputError(f"{value}", source=joint.name, key=key, expected="0 or more")


def _check_stiffened(scene: Scene) -> None:
    """Refuse contacts of bodies with modes that stiffen: their forces move, and the stress of each is not known."""
    stiffened = {
        body.name for body in scene.bodies if getattr(getattr(body, "reduced", None), "stiffening", None)
    }
    if not stiffened:
        return
    carriers: tuple[Any, ...] = (*scene.contours, *scene.surfaces)
    touchings: tuple[Any, ...] = (*scene.contacts, *scene.collisions)
    owners = {one.name: one.body for one in carriers}
    for touching in touchings:
        names = touching.surfaces if hasattr(touching, "surfaces") else (touching.contour,)
        for name in sorted({owners.get(one, "") for one in names} & stiffened):
            raise InputError(
                f"it touches the flexible body {name!r}, whose stiffening does not follow a force that moves over it",
                source=touching.name,
                expected="'modes.stiffening' = false of this body, or no contact on it",
            )


def _check_body(body: AnyBody) -> None:
    """Refuse start values of the wrong length or not finite: no later check would see a lost position."""
    for key, shape in body.start_shapes().items():
        value = np.asarray(getattr(body, key), dtype=np.float64)
        if value.shape != shape or not np.all(np.isfinite(value)):
            raise InputError(
                f"{value.tolist()}", source=body.name, key=key, expected=f"finite numbers, shape {shape}"
            )
    check_object(body.motion, source=body.name)
    if not np.any(body.orientation):
        raise InputError("length zero", source=body.name, key="orientation", expected="a quaternion")
