"""Frames on joints: parts of scenes that all share one compiled step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation
from start_scenes import frame_in_body

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.scene.connections import GROUND, JointFrame, axes_about
from heavylift.solver.scene.mesh_shapes import line
from heavylift.solver.scene.meshes import FrameBody, FrameSection, Support
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.simulation import Simulation

DOWN = Gravity(np.array([0.0, 0.0, -9.81]))
TURN = Rotation.from_euler("xyz", [0.3, 0.5, -0.2])
SHIFT = np.array([0.0, 3.0, 0.0])
HOLD = {"position": "xyz", "tangent": "yz"}
"""What a fixed joint keeps of a frame along x."""

Part = tuple[list[Any], list[Any]]
"""Bodies and joints."""


def bar(name: str, start: Any, end: Any, count: int, modulus: float, **more: Any) -> FrameBody:
    """A frame of 20 x 20 mm section."""
    mesh = line(start, end, count)
    return FrameBody(
        name=name,
        nodes=mesh.nodes,
        tangents=mesh.tangents,
        elements=mesh.elements,
        sections=(FrameSection(7850.0, modulus, 4e-4, 0.02**4 / 12),),
        **more,
    )


def rod(name: str, start: Any, end: Any, mass: float) -> RigidBody:
    """A slender rod whose x axis runs from start to end."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    turn, _ = Rotation.align_vectors([(b - a) / np.linalg.norm(b - a)], [[1.0, 0.0, 0.0]])
    across = mass * float((b - a) @ (b - a)) / 12.0
    inertia = np.diag([0.01 * across, across, across])
    return RigidBody(name, mass, inertia, position=(a + b) / 2, orientation=turn.as_quat(scalar_first=True))


def on(body: RigidBody, point: Any, axes: np.ndarray) -> JointFrame:
    """World point and axes in the frame of a body."""
    return frame_in_body(np.array(point, dtype=float), axes, body.position, body.orientation)


def four_bar(modulus: float, **more: Any) -> Part:
    """Hinge, rod, ball, frame, ball, rod, hinge with a skewed axis."""
    p = [np.zeros(3), np.array([0.2, 0.1, -0.9]), np.array([2.0, 0.4, -0.6]), np.array([2.1, 0.2, 0.1])]
    p[2] = p[1] + 1.9 * (p[2] - p[1]) / np.linalg.norm(p[2] - p[1])
    rods = rod("left", p[0], p[1], 5.0), rod("right", p[2], p[3], 7.0)
    beam = bar("beam", p[1], p[2], 8, modulus, **more)
    joints: list[Any] = []
    for body, at, near, axis in zip(
        rods, (p[0], p[3]), (p[1], p[2]), ([0.0, 1.0, 0.0], [0.2, 1.0, 0.1]), strict=True
    ):
        axes = axes_about(np.array(axis))
        joints.append(
            Hinge(
                name=f"{body.name} hinge",
                body_a=GROUND,
                body_b=body.name,
                frame_a=JointFrame(at, axes),
                frame_b=on(body, at, axes),
            )
        )
        joints.append(
            Ball(
                name=f"{body.name} ball",
                body_a=body.name,
                body_b="beam",
                frame_a=on(body, near, np.eye(3)),
                frame_b=JointFrame(near),
            )
        )
    return [*rods, beam], joints


def clamp(name: str, body: str, at: np.ndarray) -> FixedJoint:
    """To the ground, at the start of a frame that is placed there."""
    return FixedJoint(
        name=name, body_a=GROUND, body_b=body, frame_a=JointFrame(at, TURN.as_matrix()), frame_b=JointFrame()
    )


def cantilevers(modulus: float, **more: Any) -> Part:
    """Supported, on a fixed joint, and on a fixed joint in two halves that are welded together."""
    turn = TURN.as_quat(scalar_first=True)
    places = {"supported": SHIFT, "jointed": 2 * SHIFT, "near": 3 * SHIFT}
    end, middle = np.array([1.5, 0.0, 0.0]), np.array([0.75, 0.0, 0.0])
    support = (Support(np.array([0]), HOLD),)
    bodies = [
        bar(
            "supported",
            np.zeros(3),
            end,
            6,
            modulus,
            position=SHIFT,
            orientation=turn,
            supports=support,
            **more,
        ),
        bar("jointed", np.zeros(3), end, 6, modulus, position=2 * SHIFT, orientation=turn, **more),
        bar("near", np.zeros(3), middle, 3, modulus, position=3 * SHIFT, orientation=turn, **more),
        bar("far", end, middle, 3, modulus, position=3 * SHIFT, orientation=turn, **more),
    ]
    weld = FixedJoint(
        name="weld",
        body_a="near",
        body_b="far",
        frame_a=JointFrame(middle, axes_about(np.array([1.0, 0.0, 0.0]))),
        frame_b=JointFrame(middle, axes_about(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 1.0]))),
    )
    return bodies, [
        clamp("wall", "jointed", places["jointed"]),
        clamp("other wall", "near", places["near"]),
        weld,
    ]


def plumb_weld(**more: Any) -> Part:
    """Two frames welded to one that hangs straight down: its rows never turn."""
    place, low = np.array([0.0, 12.0, 0.0]), np.array([0.0, 0.0, -0.5])
    axes = axes_about(low)
    bodies: list[Any] = [
        bar("above", np.zeros(3), low, 2, 2.1e9, position=place, **more),
        bar("below", low, 2 * low, 2, 2.1e9, position=place, **more),
    ]
    joints: list[Any] = [
        FixedJoint(
            name="ceiling",
            body_a=GROUND,
            body_b="above",
            frame_a=JointFrame(place, axes),
            frame_b=JointFrame(np.zeros(3), axes),
        ),
        FixedJoint(
            name="plumb",
            body_a="above",
            body_b="below",
            frame_a=JointFrame(low, axes),
            frame_b=JointFrame(low, axes),
        ),
    ]
    return bodies, joints


def bridge(**more: Any) -> Part:
    """Three soft frames on balls from bank to bank, released level, and what keeps the kinds of a scene the same."""
    places = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.8, 0.1, 0.0], [2.4, 0.0, 0.0]])
    names = (GROUND, "first", "second", "third", GROUND)
    bodies: list[Any] = [bar(names[i + 1], places[i], places[i + 1], 3, 1e7, **more) for i in range(3)]
    joints: list[Any] = []
    for i, place in enumerate(places):
        frame = JointFrame(place)
        joints.append(
            Ball(name=f"ball{i}", body_a=names[i], body_b=names[i + 1], frame_a=frame, frame_b=frame)
        )
    wheel = rod("wheel", [-1.0, 5.0, 0.0], [1.0, 5.0, 0.0], 1.0)
    axes = axes_about(np.array([0.0, 1.0, 0.0]))
    at = np.array([0.0, 5.0, 0.0])
    joints.append(
        Hinge(
            name="axle",
            body_a=GROUND,
            body_b="wheel",
            frame_a=JointFrame(at, axes),
            frame_b=on(wheel, at, axes),
        )
    )
    return [*bodies, wheel], joints


def scene(*parts: Part) -> Scene:
    """All together, under gravity."""
    return Scene(
        tuple(body for part in parts for body in part[0]),
        (DOWN,),
        joints=tuple(joint for part in parts for joint in part[1]),
    )


@dataclass
class Run:
    """Records of a simulation by channel."""

    simulation: Simulation
    times: np.ndarray
    records: np.ndarray

    def __getitem__(self, name: str) -> np.ndarray:
        channel = next(c for c in self.simulation.channels if c.name == name)
        found = self.records[:, channel.column : channel.column + len(channel.components)]
        return found[:, 0] if found.shape[1] == 1 else found

    def nodes(self, body: str) -> np.ndarray:
        """Positions of the nodes, shape (records, n, 3)."""
        return self[f"{body}.position"].reshape(len(self.times), -1, 3)

    def energy_change(self) -> float:
        """Largest change of the balance [J]."""
        return float(np.abs(self["energy.balance"] - self["energy.balance"][0]).max())


def run(what: Scene, step: float, duration: float, interval: float = 1e-2) -> Run:
    """Records about every interval; fails if the simulation does."""
    simulation = Simulation(what, step, record_every=max(1, round(interval / step)))
    times, records = simulation.advance(round(duration / step))
    assert not simulation.message, simulation.message
    return Run(simulation, times, records)
