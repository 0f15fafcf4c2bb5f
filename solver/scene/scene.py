"""Descriptions: bodies, forces and sensors of a scene, as frozen dataclasses in SI units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.bodies import (
    Body,
    Driven,
    Fixed,
    FlexibleBody,
    Free,
    Harmonic,
    Motion,
    PointOutputs,
    Profile,
    RigidBody,
)
from heavylift.solver.scene.connections import ForceElement, OnBody, Stage
from heavylift.solver.scene.descriptions import Family
from heavylift.solver.scene.drawn import At, Text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from heavylift.solver.scene.collisions import Collision, CollisionSurface
    from heavylift.solver.scene.connections import Joint
    from heavylift.solver.scene.contacts import Contact, Contour
    from heavylift.solver.scene.drawn import Element
    from heavylift.solver.scene.scenario import Scenario
    from heavylift.solver.scene.sea import Sea

__all__ = [
    "SENSORS",
    "AnyBody",
    "Driven",
    "Fixed",
    "FlexibleBody",
    "Free",
    "Gravity",
    "Harmonic",
    "Motion",
    "Profile",
    "RigidBody",
    "Scene",
    "Sensor",
    "Start",
]

Start = Literal["check", "project", "equilibrium", "relax"]
"""What is done with a start before time runs."""


@dataclass(frozen=True, eq=False)
class Gravity(ForceElement):
    """Uniform gravity: acceleration [m/s2], world axes, shape (3,)."""

    STAGE: ClassVar[Stage] = Stage.LOADS

    acceleration: NDArray[np.float64]

    def packed_by(self, integrator: str) -> str:
        """Its kind is a field."""
        del integrator
        return "heavylift.solver.forces.gravity"


SENSORS: Family[Any] = Family("table", "heavylift.solver.scene", typed=False)
"""What only watches, by the list of a case file in which it stands."""


@SENSORS.describe("sensors")
@dataclass(frozen=True, eq=False)
class Sensor(OnBody):
    """A material point whose position and velocity are recorded."""

    CHANNELS: ClassVar = PointOutputs.CHANNELS
    """What it records, in the order of its columns."""
    SENTENCES: ClassVar = {
        "name": "Name; its channels are ``NAME.position`` and ``NAME.velocity``; checks may ask for the stress at it.",
        "body": "Body that carries it.",
        "point": "Point in the coordinates of the geometry [m]; of a flexible body, frame or shell any point of "
        "its mesh, or the name of an interface.",
    }

    def drawn(self) -> Iterable[Element]:
        """Its name."""
        yield Text(name=self.name, role="body", at=At(self.body, self.point), text=f"{self.name} (sensor)")


AnyBody: TypeAlias = Body
"""A body of any class."""


@dataclass(frozen=True)
class Scene:
    """Everything that is simulated together."""

    bodies: tuple[AnyBody, ...]
    forces: tuple[ForceElement, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    joints: tuple[Joint, ...] = ()
    ropes: tuple[Any, ...] = ()
    decks: tuple[Any, ...] = ()
    transporters: tuple[Any, ...] = ()
    contours: tuple[Contour, ...] = ()
    contacts: tuple[Contact, ...] = ()
    surfaces: tuple[CollisionSurface, ...] = ()
    collisions: tuple[Collision, ...] = ()
    sea: Sea | None = None
    scenario: Scenario | None = None
    at_rest: bool = False
    """It begins where it comes to rest: how far ropes stretch is not known before."""
    inputs: tuple[Any, ...] = ()
    """What may be driven from outside, see `heavylift.solver.scene.inputs`."""

    @property
    def gravity(self) -> NDArray[np.float64]:
        """Acceleration of gravity [m/s2], world axes, shape (3,)."""
        fields = [np.asarray(one.acceleration) for one in self.forces if isinstance(one, Gravity)]
        total: NDArray[np.float64] = np.sum([np.zeros(3), *fields], axis=0)
        return total

    @property
    def touches(self) -> bool:
        """Whether there is anything that opens and closes."""
        return bool(self.contacts or self.collisions)
