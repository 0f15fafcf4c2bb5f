"""Instants at which something in a scene changes its slope: adaptive steps end there, or they lose their order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.scene.meshes import MeshBody
from heavylift.solver.scene.scene import Driven, Profile, Scene

__all__ = ["scene_corners"]


def scene_corners(scene: Scene) -> NDArray[np.float64]:
    """Positive times [s], increasing: rows of load, motor and winch tables, ends of the tables of drives."""
    times: list[float] = []
    for force in scene.forces:
        times += list(np.ravel(getattr(force, "times", ())))
    for rope in scene.ropes:
        winch = getattr(rope, "winch", None)
        times += [] if winch is None else list(winch.times)
    for body in scene.bodies:
        if isinstance(body, MeshBody):
            times += [time for load in body.loads for time in np.ravel(load.times)]
    if scene.sea is not None:
        times += [time for tank in scene.sea.tanks for time in np.ravel(tank.times)]
        turns = [np.asarray(field.direction) for field in scene.sea.fields]
        times += [time for turn in turns if turn.ndim == 2 for time in turn[:, 0]]
        times.append(scene.sea.ramp)
    profiles: list[Profile | None] = [getattr(joint, "drive", None) for joint in scene.joints]
    for body in scene.bodies:
        if isinstance(body.motion, Driven):
            profiles += [*body.motion.translation, body.motion.angle]
    for profile in profiles:
        if profile is not None and len(profile.times):
            times += [profile.times[0], profile.times[-1]]
    return np.unique([time for time in times if time > 0.0])
