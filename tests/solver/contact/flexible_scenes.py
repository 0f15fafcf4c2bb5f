"""A square plate of point masses with smooth shapes, its contour, and what hits it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from contact_scenes import ball
from point_masses import Cloud

from heavylift.contours.splines.neutral import neutral_surface
from heavylift.solver.scene.contacts import Contact, Contour, PointShape
from heavylift.solver.scene.scene import Fixed, FlexibleBody, Free, Gravity, Scene

SIDE, COUNT = 1.0, 7
CENTRE = COUNT // 2 * COUNT + COUNT // 2
PLATE_MASS = 2.0


@dataclass(frozen=True, eq=False)
class Plate:
    """Point masses, and the vector of their shapes along z in the centre, shape (nf,)."""

    cloud: Cloud

    @property
    def centre(self) -> Any:
        return self.cloud.shapes[:, CENTRE, 2]

    def contour(self) -> Contour:
        grid = self.cloud.nodes.reshape(COUNT, COUNT, 3)
        shapes = self.cloud.shapes.reshape(-1, COUNT, COUNT, 3)
        return Contour(name="skin", body="plate", neutral=neutral_surface(grid, mode_shapes=shapes))


def plate(frequencies: tuple[float, ...] = (4.0, 9.0, 15.0), *, free: bool = False) -> Plate:
    """Shapes along z that are even in x and y; of a free plate without rigid parts."""
    place = np.linspace(-0.5 * SIDE, 0.5 * SIDE, COUNT)
    x, y = (axis.ravel() for axis in np.meshgrid(place, place, indexing="ij"))
    nodes = np.stack([x, y, np.zeros_like(x)], axis=1)
    masses = PLATE_MASS * np.full(len(x), 1.0 / len(x))
    raw = [np.cos(2.0 * x) * np.cos(2.0 * y), np.cos(5.0 * x), np.cos(5.0 * y) + 0.3 * x * x][
        : len(frequencies)
    ]
    shapes = np.array(raw)
    if free:  # even functions have no moment about x and y; the mean goes
        shapes -= (shapes @ masses / masses.sum())[:, None]
    L = np.linalg.cholesky(shapes * masses @ shapes.T)
    along_z = np.zeros((len(shapes), len(x), 3))
    along_z[:, :, 2] = np.linalg.solve(L, shapes)
    stiffness = (2.0 * np.pi * np.array(frequencies)) ** 2
    return Plate(Cloud(masses, nodes, along_z, stiffness))


def hit(
    body: Plate,
    height: float,
    speed: float,
    law: Any,
    *,
    mass: float = 0.7,
    gravity: float = 0.0,
    motion: Any = None,
    damping: float = 0.0,
    friction: float = 0.0,
    place: tuple[float, float] = (0.0, 0.0),
    sideways: tuple[float, float] = (0.0, 0.0),
) -> Scene:
    """A point mass that falls onto the plate, which is held by its frame or free."""
    held = Fixed() if motion is None else motion
    modes = body.cloud.mode_count
    flexible = FlexibleBody("plate", body.cloud.reduced(), motion=held, damping_ratio=np.full(modes, damping))
    actuator = ball([*place, height], [*sideways, -speed], mass=mass)
    return Scene(
        bodies=(flexible, actuator),
        forces=(Gravity(np.array([0.0, 0.0, -gravity])),),
        contours=(body.contour(),),
        contacts=(
            Contact(
                name="touch", contour="skin", body="ball", shape=PointShape(), law=law, friction=friction
            ),
        ),
    )


FREE = Free()
