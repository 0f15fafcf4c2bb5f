"""Small scenes with contacts, and their runs by the names of channels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.contours.splines.neutral import neutral_curve, neutral_surface
from heavylift.solver.scene.contacts import Contact, Contour, RigidLaw, SphereShape
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

Array = Any
G = 9.81
RADIUS, MASS = 0.1, 2.0
DOWN = np.array([0.0, 0.0, -G])


@dataclass(frozen=True, eq=False)
class Run:
    """Records of a run that went to its end."""

    times: NDArray[np.float64]
    records: NDArray[np.float64]
    simulation: Simulation

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Channel over time, shape (n,) or (n, components)."""
        for channel in self.simulation.channels:
            if channel.name == name:
                first = channel.column
                found = self.records[:, first : first + len(channel.components)]
                return found[:, 0] if found.shape[1] == 1 else found
        names = ", ".join(channel.name for channel in self.simulation.channels)
        raise KeyError(f"{name}: one of {names}")

    @property
    def drift(self) -> float:
        """Largest change of the energy balance [J]."""
        balance = self["energy.balance"]
        return float(np.abs(balance - balance[0]).max())


def run(scene: Scene, step: float, duration: float, **options: Any) -> Run:
    """Simulate from the start; the first record is that of the start."""
    simulation = Simulation(scene, step, **options)
    first = simulation.record()
    times, records = simulation.advance(round(duration / step))
    assert not simulation.outcome, simulation.message
    return Run(np.append(0.0, times), np.vstack([first, records]), simulation)


def surface(
    height: Callable[[Array, Array], Array] | None = None,
    *,
    name: str = "floor",
    body: str = "ground",
    half: float = 1.0,
    count: int = 6,
) -> Contour:
    """Spline through heights [m] over a square of given half length [m]; flat without."""
    x, y = np.meshgrid(np.linspace(-half, half, count), np.linspace(-half, half, count), indexing="ij")
    z = np.zeros_like(x) if height is None else height(x, y)
    return Contour(name=name, body=body, neutral=neutral_surface(np.stack([x, y, z], -1)))


def ring(radius: float = 1.0, count: int = 40, start: float = 0.0, **options: Any) -> Contour:
    """Closed spline through points of a circle in the plane of x and z, about y; it begins at an angle [rad] to x."""
    angle = start + np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    points = radius * np.stack([np.cos(angle), np.zeros(count), np.sin(angle)], axis=1)
    return Contour(name="ring", body="ground", neutral=neutral_curve(points, closed=True), **options)


def ball(
    position: Any,
    velocity: Any = (0.0, 0.0, 0.0),
    *,
    name: str = "ball",
    mass: float = MASS,
    radius: float = RADIUS,
) -> RigidBody:
    """A solid ball."""
    return RigidBody(
        name=name,
        mass=mass,
        inertia=0.4 * mass * radius**2 * np.eye(3),
        position=np.array(position, dtype=float),
        velocity=np.array(velocity, dtype=float),
    )


def touch(contour: str = "floor", body: str = "ball", *, radius: float = RADIUS, **options: Any) -> Contact:
    """A ball that touches a contour."""
    return Contact(
        **{"name": "touch", "contour": contour, "body": body, "shape": SphereShape(radius), **options}
    )


def ball_on_floor(
    start: RigidBody, law: Any = None, *, gravity: Any = DOWN, floor: Contour | None = None, **options: Any
) -> Scene:
    """A ball above a surface of the ground."""
    return Scene(
        bodies=(start,),
        forces=(Gravity(np.asarray(gravity, dtype=float)),),
        contours=(floor or surface(),),
        contacts=(touch(law=law or RigidLaw(), **options),),
    )


def tilted(angle: float) -> NDArray[np.float64]:
    """Gravity of a plane that falls along x."""
    return G * np.array([np.sin(angle), 0.0, -np.cos(angle)])
