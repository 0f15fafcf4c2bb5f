"""Where the bodies of a case are at the start: between coordinates of geometries, the world and frames of bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.rotation import quaternion_from_rotation_vector, rotation_matrix
from heavylift.pipeline.case.fields import GROUND
from heavylift.solver.scene import scene as s
from heavylift.solver.scene.speed_profiles import profile_cubics

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = ["Side", "start_sides"]


@dataclass(frozen=True, eq=False)
class Side:
    """A body, or the world, where it is at the start.

    Attributes
    ----------
    position
        Of the frame, world [m], shape (3,).
    rotation
        From frame to world axes, shape (3, 3).
    origin
        Of the frame in coordinates of the geometry [m], shape (3,).
    """

    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    origin: NDArray[np.float64]

    def local(self, point: ArrayLike) -> NDArray[np.float64]:
        """Point in the frame of a point in coordinates of the geometry [m]."""
        return np.asarray(point, dtype=np.float64) - self.origin

    def from_world(self, point: ArrayLike) -> NDArray[np.float64]:
        """Point in the frame of a point in the world [m]."""
        inner: NDArray[np.float64] = self.rotation.T @ (np.asarray(point, dtype=np.float64) - self.position)
        return inner

    def to_world(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Point in the world of a point in the frame [m]."""
        return self.position + self.rotation @ point


def start_sides(bodies: Sequence[s.AnyBody], origins: Mapping[str, NDArray[np.float64]]) -> dict[str, Side]:
    """The bodies and the world where they are at time 0, by name; driven frames as far as they are driven then."""
    sides = {GROUND: Side(np.zeros(3), np.eye(3), np.zeros(3))}
    for body in bodies:
        position, rotation = body.position, rotation_matrix(body.orientation)
        if isinstance(body.motion, s.Driven):
            motion, pivot = body.motion, np.asarray(body.motion.pivot, dtype=np.float64)
            angle, axis = _start_value(motion.angle), np.asarray(motion.axis, dtype=np.float64)
            if angle:
                turn = rotation_matrix(quaternion_from_rotation_vector(angle * axis / np.linalg.norm(axis)))
                position, rotation = pivot + turn @ (position - pivot), turn @ rotation
            position = position + np.array([_start_value(profile) for profile in motion.profiles[:3]])
        sides[body.name] = Side(position, rotation, origins[body.name])
    return sides


def _start_value(profile: s.Profile | None) -> float:
    """Value of a profile at time 0."""
    if profile is None:
        return 0.0
    value = sum(h.amplitude * float(np.sin(h.phase)) for h in profile.harmonics)
    if len(profile.values):
        breaks, cubics = profile_cubics(profile)
        time = float(np.clip(0.0, breaks[0], breaks[-1]))
        piece = min(int(np.searchsorted(breaks, time, side="right")), len(cubics)) - 1
        value += float(np.polyval(cubics[piece], time - breaks[piece]))
    return value
