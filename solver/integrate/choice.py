"""Which integrator suits a scene: the accurate one for what is smooth and not stiff, the default for the rest."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.coordinates import inverse_scales
from heavylift.solver.scene.connections import GROUND, Between, controlled, rubbing_places
from heavylift.solver.scene.scene import Scene
from heavylift.solver.scene.sliding_joints import joint_friction, joint_stops

__all__ = ["check_integrator", "choose_integrator", "stiff_mesh", "stiff_part"]

LARGEST_RATE = 60.0
"""Fastest spring, damper or element, times the output interval, that an explicit integrator still follows cheaply."""


def choose_integrator(scene: Scene, interval: float) -> tuple[str, str]:
    """Name of the integrator for a scene and a sentence that says why.

    Parameters
    ----------
    scene
        What is simulated.
    interval
        Time between outputs [s]: what takes many steps an output is stiff.
    """
    reason = (
        _phases(scene)
        or _not_smooth(scene)
        or _rope(scene)
        or stiff_part(scene, interval)
        or stiff_mesh(scene, interval)
    )
    if reason:
        return "dele2", f"dele2, because {reason}"
    return "accurate", "accurate, because everything in the scene is smooth and nothing is stiff"


def check_integrator(scene: Scene, name: str) -> None:
    """Refuse a scene that an integrator cannot serve.

    Raises
    ------
    InputError
        Names the integrator, what stands in its way, and what to choose instead.
    """
    reason = ""
    if name == "accurate":
        reason = _phases(scene) or _not_smooth(scene)
    elif name == "thesis":
        reason = _phases(scene) or _rope(scene) or _law(scene, name) or _floating(scene)
        driven = [
            joint.name
            for joint in scene.joints
            if getattr(joint, "drive", None) is not None or getattr(joint, "speed", 0.0) != 0.0
        ]
        if not reason and driven:
            reason = f"joint {driven[0]!r} is driven"
        reason = reason or _refused_by_body(scene, name)
    if reason:
        raise InputError(
            f"{name!r}, but {reason}",
            source="simulation",
            key="integrator",
            expected="'dele2' for such a scene",
        )


def _phases(scene: Scene) -> str:
    """That there is a scenario, as words; empty if there is none. Its events are met by steps that are taken back."""
    return "" if scene.scenario is None else "it has a scenario"


def _rope(scene: Scene) -> str:
    """The first rope, as words; empty if none. The accurate integrator takes small steps where one goes slack."""
    return f"rope {scene.ropes[0].name!r} can go slack" if scene.ropes else ""


def _rubbing(scene: Scene) -> str:
    """The first rope with sheave friction or a winch controlled by its tension, in words; empty if none."""
    for rope in scene.ropes:
        if rubbing_places(rope):
            return f"rope {rope.name!r} sticks and slides on its sheaves"
        if controlled(rope):
            return f"the winch of rope {rope.name!r} is controlled by its tension"
    return ""


def _obstacle(things: Iterable[Any], integrator: str) -> str:
    """The first force element that an integrator cannot serve by what it says itself, as words; empty if none."""
    for thing in things:
        words = thing.obstacle(integrator) if hasattr(thing, "obstacle") else ""
        if words:
            return f"{type(thing).WORD.replace('_', ' ')} {thing.name!r} {words}"
    return ""


def _law(scene: Scene, integrator: str) -> str:
    """The first thing whose force jumps, as words; empty if none."""
    if scene.touches:
        first: Any = (*scene.contacts, *scene.collisions)[0]
        return f"contact {first.name!r} opens and closes"
    if scene.transporters:
        return f"transporter {scene.transporters[0].name!r} rides on bogies without mass"
    if reason := _obstacle((*scene.ropes, *scene.forces, *scene.inputs), integrator):
        return reason
    for joint in scene.joints:
        if any(joint_stops(joint)):
            return f"joint {joint.name!r} has stops"
        if any(joint_friction(joint)):
            return f"joint {joint.name!r} has dry friction"
    return ""


def _refused_by_body(scene: Scene, integrator: str) -> str:
    """Why an integrator cannot serve the first body of those that it cannot serve, as words; empty if none."""
    reasons = (body.refusal(integrator, jointed=bool(scene.joints)) for body in scene.bodies)
    return next(filter(None, reasons), "")


def _not_smooth(scene: Scene) -> str:
    """The first thing that an explicit integrator of high order cannot serve, as words; empty if none."""
    reason = (
        _refused_by_body(scene, "accurate") or _law(scene, "accurate") or _rubbing(scene) or _floating(scene)
    )
    if reason:
        return reason
    compliant = [joint.name for joint in scene.joints if joint.compliance > 0.0]
    return f"joint {compliant[0]!r} is compliant" if compliant else ""


def _floating(scene: Scene) -> str:
    """The first hull or line, as words; empty if none."""
    if scene.sea is None:
        return ""
    if scene.sea.hulls:
        return f"{scene.sea.hulls[0].body!r} floats"
    names = [line.name for line in scene.sea.lines] + [fender.name for fender in scene.sea.fenders]
    return f"line {names[0]!r} is alternately soft and stiff" if names else ""


def stiff_part(scene: Scene, interval: float) -> str:
    """The first spring or damper that is too fast, as words; empty if none."""
    scales = inverse_scales(scene.bodies)

    def of(name: str, turns: bool) -> float:
        return 0.0 if name == GROUND else scales(name)[1 if turns else 0]

    joints = {joint.name: joint for joint in scene.joints}
    force: Any
    for force in scene.forces:
        if not hasattr(force, "curve"):  # no spring
            continue
        if isinstance(force, Between):
            inverse = of(force.body_a, False) + of(force.body_b, False)
        else:
            joint = joints[force.joint]
            turns = (force.coordinate or joint.COORDINATE) == "angle"
            inverse = of(joint.body_a, turns) + of(joint.body_b, turns)
        stiffness = max([force.stiffness, *_slopes(*force.curve)])
        rate = max(math.sqrt(stiffness * inverse), force.damping * inverse)
        if rate * interval > LARGEST_RATE:
            return (
                f"{force.name!r} has a rate of {rate:.3g} 1/s, {rate * interval:.0f} times that of the output"
            )
    return ""


def stiff_mesh(scene: Scene, interval: float) -> str:
    """The first frame or shell that vibrates too fast, as words; empty if none."""
    for body in scene.bodies:
        rate = body.highest_rate
        if rate * interval > LARGEST_RATE:
            times = f"{rate * interval:.0f} times that of the output"
            return f"elements of {body.name!r} vibrate at {rate:.3g} 1/s, {times}"
    return ""


def _slopes(x: NDArray[np.float64], y: NDArray[np.float64]) -> list[float]:
    """Slopes of the table of a spring."""
    return [float(value) for value in np.diff(y) / np.diff(x)] if len(x) > 1 else []
