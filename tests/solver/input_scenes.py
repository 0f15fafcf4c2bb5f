"""Scenes with inputs, and runs in which these are set."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.scene.connections import RopePoint, Winch
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

GRAVITY = Gravity(np.array([0.0, 0.0, -9.81]))
MASS = 2.0
LOAD = RigidBody("load", mass=MASS, inertia=np.diag([0.3, 0.4, 0.5]))


def column(simulation: Simulation, name: str, records: NDArray[np.float64]) -> NDArray[np.float64]:
    """Columns of a channel: one number a record, or several."""
    channel = next(one for one in simulation.channels if one.name == name)
    found = records[:, channel.column : channel.column + len(channel.components)]
    return found[:, 0] if found.shape[1] == 1 else found


def driven(simulation: Simulation, settings: dict[int, tuple[Any, ...]], steps: int) -> NDArray[np.float64]:
    """Records of all steps, with inputs that are set before some of them."""
    records = []
    for index in range(steps):
        if index in settings:
            simulation.set_input(*settings[index])
        records.append(simulation.advance(1)[1])
    return np.concatenate(records)


def hoist(winch: Winch | None = None, **more: Any) -> Scene:
    """A mass on a rope below the ground."""
    path = (RopePoint("ground", np.array([0.0, 0.0, 10.0])), RopePoint("load", np.zeros(3)))
    rope = Rope(name="hoist", path=path, axial_stiffness=2e4, damping=50.0, length=10.0, winch=winch)
    return Scene((LOAD,), (GRAVITY,), ropes=(rope,), **more)
