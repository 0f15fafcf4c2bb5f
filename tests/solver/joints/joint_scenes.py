"""One joint of each type between two bodies, and what each type is in plain matrices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from heavylift.solver.joints.ball import Ball
from heavylift.solver.joints.distance import Distance
from heavylift.solver.joints.fixed import FixedJoint
from heavylift.solver.joints.guide import Guide
from heavylift.solver.joints.hinge import Hinge
from heavylift.solver.joints.planar import Planar
from heavylift.solver.joints.screw import Screw
from heavylift.solver.joints.slider import Slider
from heavylift.solver.joints.slider_hinge import Cylindrical, SliderHinge
from heavylift.solver.joints.universal import Universal
from heavylift.solver.scene.connections import Joint, JointFrame
from heavylift.solver.scene.scene import Harmonic, Profile

TURNS = 4.0 * np.pi  # a drive may go round more than once
PROFILE = Profile(np.array([0.0, 2.0]), TURNS + np.array([0.3, 1.1]), (Harmonic(0.2, 0.7, 0.4),))
LENGTH = 0.8
LEAD = -0.8
SPEED = 0.7
SLIDE_AXIS = np.array([2.0, 0.5, -1.0])


@dataclass(frozen=True)
class Pose:
    """A frame: point [m] and axes as columns."""

    point: np.ndarray
    axes: np.ndarray


Residual = Callable[[Pose, Pose, float], list[float]]


def profile(time: float) -> float:
    """Value of `PROFILE`: a cubic from rest to rest, and the harmonic."""
    s = time / 2.0
    return TURNS + 0.3 + 0.8 * (3 * s**2 - 2 * s**3) + 0.2 * np.sin(2 * np.pi * 0.7 * time + 0.4)


def across(direction: np.ndarray) -> np.ndarray:
    """Two unit directions square to one and to each other, as rows; which ones is part of the convention."""
    e = direction / np.linalg.norm(direction)
    first = np.eye(3)[np.argmin(np.abs(e))]
    m = first - (first @ e) * e
    m /= np.linalg.norm(m)
    return np.array([m, np.cross(e, m)])


def _point(a: Pose, b: Pose) -> list[float]:
    return list(b.point - a.point)


def _axis(a: Pose, b: Pose) -> list[float]:
    return [a.axes[:, 2] @ b.axes[:, 0], a.axes[:, 2] @ b.axes[:, 1]]


def angle(a: Pose, b: Pose) -> float:
    """Angle about the common z axis."""
    return float(np.arctan2(-b.axes[:, 1] @ a.axes[:, 0], b.axes[:, 0] @ a.axes[:, 0]))


def travel(a: Pose, b: Pose, direction: np.ndarray) -> float:
    """Travel along a direction given in the frame of a."""
    return float((a.axes @ direction) @ (b.point - a.point))


def _turned(off: float) -> float:
    return (off + np.pi) % (2 * np.pi) - np.pi


def _hinge(a: Pose, b: Pose, _: float) -> list[float]:
    return _point(a, b) + _axis(a, b)


def _slider(a: Pose, b: Pose, _: float) -> list[float]:
    x, y, _z = np.eye(3)
    return [travel(a, b, x), travel(a, b, y), *_axis(a, b), a.axes[:, 0] @ b.axes[:, 1]]


def _slider_hinge(a: Pose, b: Pose, direction: np.ndarray) -> list[float]:
    m, n = across(direction)
    return [travel(a, b, m), travel(a, b, n), *_axis(a, b)]


def _thread(a: Pose, b: Pose) -> float:
    """Travel less the pitch times the angle, of the turn that is nearest."""
    pitch = LEAD / (2.0 * np.pi)
    along = travel(a, b, np.eye(3)[2])
    return -pitch * _turned(angle(a, b) - along / pitch)


RESIDUALS: dict[str, Residual] = {
    "ball": lambda a, b, _: _point(a, b),
    "cylindrical": lambda a, b, _: _slider_hinge(a, b, np.array([0.0, 0.0, 1.0])),
    "distance": lambda a, b, _: [float(np.linalg.norm(b.point - a.point)) - LENGTH],
    "driven_hinge": lambda a, b, t: [*_hinge(a, b, t), _turned(angle(a, b) - profile(t))],
    "driven_slider": lambda a, b, t: [*_slider(a, b, t), travel(a, b, np.eye(3)[2]) - profile(t)],
    "fixed": lambda a, b, t: [*_hinge(a, b, t), a.axes[:, 0] @ b.axes[:, 1]],
    "guide": lambda a, b, t: [
        travel(a, b, np.eye(3)[0]) - profile(t) - SPEED * t,
        travel(a, b, np.eye(3)[1]),
        a.axes[:, 1] @ b.axes[:, 0],
    ],
    "hinge": _hinge,
    "planar": lambda a, b, _: [travel(a, b, np.eye(3)[2]), *_axis(a, b)],
    "screw": lambda a, b, t: [*_slider(a, b, t)[:2], *_axis(a, b), _thread(a, b)],
    "slider": _slider,
    "slider_hinge": lambda a, b, _: _slider_hinge(a, b, SLIDE_AXIS),
    "universal": lambda a, b, _: [*_point(a, b), a.axes[:, 2] @ b.axes[:, 2]],
}
"""What vanishes when a joint is closed, from the two joint frames in the world and the time."""

CLOSED: dict[str, tuple[np.ndarray, np.ndarray]] = {
    "ball": (np.zeros(3), np.array([0.5, -0.8, 0.3])),
    "cylindrical": (np.array([0.0, 0.0, 0.7]), np.array([0.0, 0.0, 1.2])),
    "distance": (LENGTH * np.array([0.6, 0.0, -0.8]), np.array([0.5, -0.8, 0.3])),
    "driven_hinge": (np.zeros(3), np.array([0.0, 0.0, profile(0.0)])),
    "driven_slider": (np.array([0.0, 0.0, profile(0.0)]), np.zeros(3)),
    "fixed": (np.zeros(3), np.zeros(3)),
    "guide": (np.array([profile(0.0), 0.0, 0.3]), np.array([0.0, 0.4, 0.0])),
    "hinge": (np.zeros(3), np.array([0.0, 0.0, -0.9])),
    "planar": (np.array([0.4, -0.6, 0.0]), np.array([0.0, 0.0, 0.5])),
    "screw": (np.array([0.0, 0.0, 0.9 * LEAD / (2.0 * np.pi)]), np.array([0.0, 0.0, 0.9])),
    "slider": (np.array([0.0, 0.0, -0.4]), np.zeros(3)),
    "slider_hinge": (SLIDE_AXIS * 0.3, np.array([0.0, 0.0, 0.8])),
    "universal": (np.zeros(3), np.array([np.pi / 2, 0.0, 0.0])),
}
"""A closed pose of each: point [m] and rotation vector of frame b in frame a."""


def make_joint(name: str, body_a: str, body_b: str, frame_a: JointFrame, frame_b: JointFrame) -> Joint:
    """The joint of a name in `RESIDUALS`, called by it."""
    made: dict[str, Callable[..., Joint]] = {
        "ball": Ball,
        "cylindrical": Cylindrical,
        "distance": lambda **k: Distance(length=LENGTH, **k),
        "driven_hinge": lambda **k: Hinge(drive=PROFILE, **k),
        "driven_slider": lambda **k: Slider(drive=PROFILE, **k),
        "fixed": FixedJoint,
        "guide": lambda **k: Guide(speed=SPEED, drive=PROFILE, **k),
        "hinge": Hinge,
        "planar": Planar,
        "screw": lambda **k: Screw(lead=LEAD, **k),
        "slider": Slider,
        "slider_hinge": lambda **k: SliderHinge(slide_axis=SLIDE_AXIS, **k),
        "universal": Universal,
    }
    return made[name](name=name, body_a=body_a, body_b=body_b, frame_a=frame_a, frame_b=frame_b)


def turn(vector: np.ndarray) -> np.ndarray:
    """Rotation matrix of a rotation vector."""
    return Rotation.from_rotvec(vector).as_matrix()
