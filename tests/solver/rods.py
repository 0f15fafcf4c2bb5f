"""Rods on hinges for tests of the accurate integrator: all scenes are of the same kinds, and compile once."""

from __future__ import annotations

import numpy as np

from heavylift.solver.forces.point import PointForce
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, JointFrame
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene, Sensor
from heavylift.solver.simulation import Simulation

G = 9.81
HALF = np.array([0.5, 0.0, 0.0])


def channel(simulation: Simulation, records: np.ndarray, name: str) -> np.ndarray:
    found = next(c for c in simulation.channels if c.name == name)
    return records[:, found.column : found.column + len(found.components)]


def hinge(name: str, a: str, b: str, at_a: tuple[float, ...], at_b: tuple[float, ...]) -> Hinge:
    frames = {"frame_a": JointFrame(np.array(at_a)), "frame_b": JointFrame(np.array(at_b))}
    return Hinge(name=name, body_a=a, body_b=b, **frames)


def rod(name: str, a: tuple[float, ...], b: tuple[float, ...], **motion: object) -> RigidBody:
    """Rod of 1 kg from a to b, upright or level."""
    d = np.abs(np.subtract(b, a))
    inertia = np.diag([1e-3 if d[0] > 0 else 1 / 12, 1e-3 if d[1] > 0 else 1 / 12, 1 / 12])
    return RigidBody(name, 1.0, inertia, position=np.add(a, b) / 2.0, **motion)  # type: ignore[arg-type]


def loads(
    gravity: tuple[float, float, float],
    body: str,
    times: np.ndarray | None = None,
    forces: np.ndarray | None = None,
) -> tuple[Gravity, PointForce]:
    """Gravity and a force on the centre of mass, so that all scenes here are of the same kinds and compile once."""
    times, forces = (np.zeros(1), np.zeros((1, 3))) if times is None else (times, forces)
    return Gravity(np.array(gravity)), PointForce("load", body, np.zeros(3), times, forces)


def parallelogram(loops: int, level: bool = False) -> Scene:
    """Square loops in a row, cranks upright or level with tips at 1 m/s: singular when all is level."""
    tip = np.array([1.0, 0.0, 0.0] if level else [0.0, 1.0, 0.0])
    speed = np.array([0.0, -1.0, 0.0] if level else [1.0, 0.0, 0.0])
    spin = np.array([0.0, 0.0, -1.0])
    feet = [np.array([float(k), 0.0, 0.0]) for k in range(loops + 1)]
    cranks = [
        rod(f"c{k}", tuple(foot), tuple(foot + tip), velocity=0.5 * speed, angular_velocity=spin)
        for k, foot in enumerate(feet)
    ]
    couplers = [
        rod(f"k{k}", tuple(foot + tip), tuple(foot + tip + 2.0 * HALF), velocity=speed)
        for k, foot in enumerate(feet[:-1])
    ]
    up, down = tuple(0.5 * tip), tuple(-0.5 * tip)
    joints = [hinge(f"g{k}", GROUND, f"c{k}", (k, 0.0, 0.0), down) for k in range(loops + 1)]
    joints += [hinge(f"p{k}", f"c{k}", f"k{k}", up, tuple(-HALF)) for k in range(loops)]
    joints += [hinge(f"q{k}", f"c{k + 1}", f"k{k}", up, tuple(HALF)) for k in range(loops)]
    sensor = Sensor("tip", "c0", 0.5 * tip)
    return Scene((*cranks, *couplers), loads((0.0, -G, 0.0), "c0"), (sensor,), tuple(joints))
