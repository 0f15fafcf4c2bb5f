"""Linkages of hinged rods for the tests of the start; most share their kinds, and so their compiled code."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from heavylift.numerics.rotation import rotation_matrix
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.layout import pack_scene
from heavylift.solver.scene.connections import GROUND, Joint, JointFrame, axes_about
from heavylift.solver.scene.scene import Gravity, RigidBody, Scene
from heavylift.solver.start.rows import StartRows

if TYPE_CHECKING:
    from collections.abc import Sequence

G = 9.81
DOWN = Gravity(np.array([0.0, -G, 0.0]))


def frame_in_body(point: Any, axes: np.ndarray, position: np.ndarray, orientation: np.ndarray) -> JointFrame:
    """Joint frame of a body from a point [m] and axes in the world and the pose of the body."""
    R = rotation_matrix(orientation)
    return JointFrame(R.T @ (np.asarray(point, dtype=np.float64) - position), R.T @ axes)


def quaternion(rotation: Rotation) -> np.ndarray:
    return rotation.as_quat()[[3, 0, 1, 2]]


def rod(name: str, start: Any, end: Any, mass: float = 1.0, **more: Any) -> RigidBody:
    """A rod of slenderness 10 whose x axis runs from start to end; its frame is in the middle."""
    a, b = np.array(start, dtype=float), np.array(end, dtype=float)
    length = float(np.linalg.norm(b - a))
    across = mass * length**2 / 12.0
    turn, _ = Rotation.align_vectors([(b - a) / length], [[1.0, 0.0, 0.0]])
    inertia = np.diag([0.01 * across, across, across])
    return RigidBody(name, mass, inertia, position=(a + b) / 2.0, orientation=quaternion(turn), **more)


def joint(
    kind: Any, name: str, a: RigidBody | None, b: RigidBody | None, at: Any, axis: Any = (0, 0, 1)
) -> Joint:
    """A joint at a world point; the ground where there is no body."""
    axes = axes_about(np.array(axis, dtype=float))

    def frame(body: RigidBody | None) -> Any:
        place = (
            (np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
            if body is None
            else (body.position, body.orientation)
        )
        return frame_in_body(np.array(at, dtype=float), axes, *place)

    return kind(
        name=name,
        body_a=a.name if a else GROUND,
        body_b=b.name if b else GROUND,
        frame_a=frame(a),
        frame_b=frame(b),
    )


def linkage(points: Sequence[Any], axes: Sequence[Any] | None = None, closed: bool = True) -> Scene:
    """Hinged rods from point to point; the first and, if closed, the last end are hinged to the ground."""
    count = len(points) - 1
    rods = [rod(f"r{i}", points[i], points[i + 1]) for i in range(count)]
    sides: list[Any] = [None, *rods, None]
    joints = [
        joint(Hinge, f"h{i}", sides[i], sides[i + 1], points[i], (0, 0, 1) if axes is None else axes[i])
        for i in range(count + int(closed))
    ]
    return Scene(tuple(rods), (DOWN,), (), tuple(joints))


def parallelograms(loops: int) -> Scene:
    """Cranks of 1 m on the ground, coupled one to the next: the N-four-bar benchmark of IFToMM (A02)."""
    cranks = [rod(f"crank{k}", (k, 0, 0), (k, 1, 0)) for k in range(loops + 1)]
    bars = [rod(f"bar{k}", (k, 1, 0), (k + 1, 1, 0)) for k in range(loops)]
    joints = [joint(Hinge, f"foot{k}", None, crank, (k, 0, 0)) for k, crank in enumerate(cranks)]
    for k, bar in enumerate(bars):
        joints.append(joint(Hinge, f"left{k}", cranks[k], bar, (k, 1, 0)))
        joints.append(joint(Hinge, f"right{k}", cranks[k + 1], bar, (k + 1, 1, 0)))
    return Scene((*cranks, *bars), (DOWN,), (), tuple(joints))


def bricard() -> Scene:
    """Six hinges along the edges of a cube: Bricard's mechanism (A04)."""
    points = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)]
    axes = [(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)]
    return linkage(points, axes)


def shaken(scene: Scene, amount: float, seed: int = 0) -> Scene:
    """Bodies out of place and turned at random, with random velocities."""
    random = np.random.default_rng(seed)
    bodies = []
    for body in scene.bodies:
        turn = Rotation.from_rotvec(amount * random.normal(size=3)) * Rotation.from_quat(
            body.orientation[[1, 2, 3, 0]]
        )
        bodies.append(
            replace(
                body,
                position=body.position + amount * random.normal(size=3),
                orientation=quaternion(turn),
                velocity=random.normal(size=3),
                angular_velocity=random.normal(size=3),
            )
        )
    return replace(scene, bodies=tuple(bodies))


def rows_of(scene: Scene) -> StartRows:
    return StartRows(pack_scene(scene))


def place(rows: StartRows, name: str) -> np.ndarray:
    """Centre of mass of a body [m]."""
    return rows.survey()[0][rows.layout.body_names.index(name), 1:4]


def velocity(rows: StartRows, name: str) -> np.ndarray:
    """Velocity of the centre of mass [m/s] and spin in principal axes [rad/s] of a rigid body."""
    places, _, found = rows.survey()
    first = int(places[rows.layout.body_names.index(name), 0])
    return found[first : first + 6]
