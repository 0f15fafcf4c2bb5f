"""What a user says: bodies, forces and sensors of a scene, as frozen dataclasses in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias

import numpy as np

from heavylift.solver.scene.bodies import (
    POINT_CHANNELS,
    Driven,
    Fixed,
    FlexibleBody,
    Free,
    Harmonic,
    Motion,
    Profile,
    RigidBody,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.collisions import Collision, CollisionSurface
    from heavylift.solver.scene.connections import (
        Joint,
        JointMotor,
        JointSpring,
        PairForce,
        Rope,
        Spring,
        SpringRope,
    )
    from heavylift.solver.scene.contacts import Contact, Contour
    from heavylift.solver.scene.meshes import MeshBody
    from heavylift.solver.scene.sea import Sea

__all__ = [
    "AnyBody",
    "Driven",
    "Fixed",
    "FlexibleBody",
    "Free",
    "Gravity",
    "Harmonic",
    "Motion",
    "PointForce",
    "Profile",
    "RigidBody",
    "Scene",
    "Sensor",
]


@dataclass(frozen=True, eq=False)
class Gravity:
    """Uniform gravity: acceleration [m/s2], world axes, shape (3,)."""

    acceleration: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointForce:
    """A force on a material point, from a table over time with linear interpolation.

    Attributes
    ----------
    name, body
        Its own name and the name of the body.
    point
        In the body frame [m], shape (3,); of a flexible body the nearest node is loaded.
    times, forces
        [s], shape (nt,), increasing; [N], shape (nt, 3). Constant before the first and after the last time.
    frame
        Axes of the force: ``"world"`` or ``"body"`` (follows the frame of the body).
    """

    name: str
    body: str
    point: NDArray[np.float64]
    times: NDArray[np.float64]
    forces: NDArray[np.float64]
    frame: Literal["world", "body"] = "world"


@dataclass(frozen=True, eq=False)
class Sensor:
    """A material point whose position and velocity are recorded: body name and point [m] in its frame."""

    CHANNELS: ClassVar = POINT_CHANNELS
    """What it records, in the order of its columns."""

    name: str
    body: str
    point: NDArray[np.float64]


AnyBody: TypeAlias = "FlexibleBody | RigidBody | MeshBody"


@dataclass(frozen=True)
class Scene:
    """Everything that is simulated together."""

    bodies: tuple[AnyBody, ...]
    forces: tuple[Gravity | PointForce | PairForce | Spring | JointSpring | JointMotor, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    joints: tuple[Joint, ...] = ()
    ropes: tuple[Rope | SpringRope, ...] = ()
    contours: tuple[Contour, ...] = ()
    contacts: tuple[Contact, ...] = ()
    surfaces: tuple[CollisionSurface, ...] = ()
    collisions: tuple[Collision, ...] = ()
    sea: Sea | None = None

    @property
    def touches(self) -> bool:
        """Whether there is anything that opens and closes."""
        return bool(self.contacts or self.collisions)
