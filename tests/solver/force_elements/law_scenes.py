"""Small scenes with ropes, springs and laws, and a way to run them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from heavylift.numerics.outcome import Outcome
from heavylift.solver.force_elements.wire_rope import Rope
from heavylift.solver.joints.slider import Slider
from heavylift.solver.scene.connections import GROUND, JointFrame, RopePoint, axes_about
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

G = 9.81
DOWN = Gravity(np.array([0.0, 0.0, -G]))
NONE = Gravity(np.zeros(3))


@dataclass
class Run:
    """Records of a run, the start included."""

    times: Any
    records: Any
    columns: dict[str, Any]
    simulation: Simulation

    def __getitem__(self, name: str) -> Any:
        channel = self.columns[name]
        values = self.records[:, channel.column : channel.column + len(channel.components)]
        return values[:, 0] if values.shape[1] == 1 else values

    @property
    def balance(self) -> float:
        """Largest change of the energy balance [J]."""
        return float(np.ptp(self["energy.balance"]))


def run(scene: Scene, step: float, duration: float, integrator: str = "dele2", **options: Any) -> Run:
    simulation = Simulation(scene, step, integrator, **options)
    start = simulation.record()
    steps = round(duration / step)
    times, records = simulation.advance(steps)
    assert simulation.outcome is Outcome.COMPLETED, simulation.message
    return Run(
        np.append(0.0, times),
        np.vstack([start, records]),
        {channel.name: channel for channel in simulation.channels},
        simulation,
    )


def body(name: str, mass: float, position: Any, velocity: Any = (0.0, 0.0, 0.0), **more: Any) -> RigidBody:
    return RigidBody(
        name,
        mass,
        np.eye(3) * 0.1 * mass,
        position=np.array(position, dtype=float),
        velocity=np.array(velocity, dtype=float),
        **more,
    )


def scene(bodies: Any, forces: Any = (), joints: Any = (), ropes: Any = (), field: Gravity = DOWN) -> Scene:
    return Scene(tuple(bodies), (field, *forces), (), tuple(joints), tuple(ropes))


def eye(name: str, point: Any = (0.0, 0.0, 0.0)) -> RopePoint:
    return RopePoint(name, np.array(point, dtype=float))


def pulley(name: str, point: Any, radius: float, sense: float = 1.0) -> RopePoint:
    return RopePoint(name, np.array(point, dtype=float), radius, np.array([0.0, sense, 0.0]))


def wire(*path: RopePoint, name: str = "rope", stiffness: float = 1e8, **more: Any) -> Rope:
    return Rope(name=name, path=path, axial_stiffness=stiffness, **more)


def slider(axis: Any = (1.0, 0.0, 0.0), **more: Any) -> Slider:
    frame = JointFrame(np.zeros(3), axes_about(np.array(axis, dtype=float)))
    return Slider(name="slide", body_a=GROUND, body_b="block", frame_a=frame, frame_b=frame, **more)
