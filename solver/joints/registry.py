"""Which file serves which joint; a type without members in a scene is not imported."""

from __future__ import annotations

import importlib
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.connections import (
    GROUND,
    Ball,
    Cylindrical,
    Distance,
    FixedJoint,
    Hinge,
    Planar,
    Slider,
    SliderHinge,
    Universal,
)
from heavylift.solver.joints.mesh_rows import EdgeSeam, FrameWeld, SquareJoint
from heavylift.solver.joints.packing import JointPlace, start_frames
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows import Attachment, RowSystem, pack_rows

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from heavylift.solver.connections import Joint
    from heavylift.solver.scene import AnyBody

__all__ = ["DRIVEN_MODULES", "JOINT_MODULES", "joint_channels", "joint_module", "pack_joints"]

JOINT_MODULES: dict[type, str] = {
    Ball: "ball",
    Universal: "universal",
    Hinge: "hinge",
    Cylindrical: "slider_hinge",
    Slider: "slider",
    SliderHinge: "slider_hinge",
    FixedJoint: "fixed",
    Planar: "planar",
    Distance: "distance",
}
"""Modules of `heavylift.solver.joints` by type of joint."""

OPEN = 3.0
"""Distance of the points of a joint, in radii of gyration of the larger body, at which a run has failed."""

DRIVEN_MODULES: dict[type, str] = {
    Hinge: "driven_hinge",
    Slider: "driven_slider",
}
"""Those for joints with a `drive`: a row more."""

MESH_MODULES: dict[type, str] = {
    SquareJoint: "squares",
    FrameWeld: "frame_weld",
    EdgeSeam: "edge_seam",
}
"""Those for what joints on frames and edges of shells become."""


def joint_module(joint: Joint) -> Any:
    """The module that serves a joint.

    Raises
    ------
    InputError
        If there is none for its type.
    """
    driven = getattr(joint, "drive", None) is not None
    name = (DRIVEN_MODULES if driven else JOINT_MODULES | MESH_MODULES).get(type(joint))
    if name is None:
        raise InputError(
            f"a {type(joint).__name__}",
            source=joint.name,
            key="type",
            expected="one of " + ", ".join(kind.__name__ for kind in JOINT_MODULES),
        )
    return importlib.import_module(f"heavylift.solver.joints.{name}")


def joint_channels(joint: Joint) -> list[tuple[str, str, tuple[str, ...]]]:
    """Name, unit and components of the channels of a joint, in the order of its columns."""
    xyz = ("x", "y", "z")
    extra = getattr(joint_module(joint), "CHANNELS", ())
    return [("reaction_force", "N", xyz), ("reaction_moment", "N m", xyz), *extra]


def pack_joints(
    joints: Sequence[Joint],
    columns: Sequence[int],
    book: MarkerBook,
    attachment: Callable[[str], Attachment],
    scales: Callable[[str], tuple[float, float]],
    bodies: Sequence[AnyBody],
) -> tuple[tuple[Any, ...], Callable[[Any, int], RowSystem], tuple[str, ...]]:
    """Make the kinds of all joints, a function that makes their system, and the names of their blocks.

    Parameters
    ----------
    joints, columns
        Joints and the first record column of each.
    book
        Receives the markers.
    attachment
        Where the rows of a body go; known once all bodies are counted.
    scales
        Inverse mass [1/kg] and smallest inverse inertia [1/(kg m2)] of a body, 0 if its motion is prescribed.
    bodies
        Whose start poses tell the branch of a joint.

    Raises
    ------
    InputError
        If a joint names a body that is not there, holds nothing that can move, or starts on the wrong branch.
    """
    groups: dict[Any, list[tuple[Joint, int]]] = {}
    for joint, column in zip(joints, columns, strict=True):
        groups.setdefault(joint_module(joint), []).append((joint, column))
    kinds: list[Any] = []
    ordered: list[tuple[Joint, tuple[bool, ...]]] = []
    # in an order of their own, whatever that of the scene
    for module in sorted(groups, key=lambda module: module.__name__):
        members = groups[module]
        places = [
            JointPlace(len(ordered) + i, column, start_frames(joint, bodies))
            for i, (joint, column) in enumerate(members)
        ]
        ordered += [
            (joint, joint.rotational if isinstance(joint, (SquareJoint, EdgeSeam)) else module.ROTATIONAL)
            for joint, _ in members
        ]
        kinds.append(module.pack([joint for joint, _ in members], places, book))

    def system(inverse_mass: Any, monitor: int) -> RowSystem:
        sides = [(attachment(joint.body_a), attachment(joint.body_b)) for joint, _ in ordered]
        scale = [_scale(joint, rotational, scales) for joint, rotational in ordered]
        made = pack_rows([len(r) for _, r in ordered], sides, scale, inverse_mass, monitor)
        for block, (joint, rotational) in enumerate(ordered):
            made.rows[block].compliance[: len(rotational)] = joint.compliance
            made.rows[block].relaxation[: len(rotational)] = joint.relaxation
            made.rows[block].rigid[: len(rotational)] = _openness(joint, rotational, scales)
        return made

    return tuple(kinds), system, tuple(joint.name for joint, _ in ordered)


def _scale(joint: Joint, rotational: tuple[bool, ...], scales: Callable[[str], tuple[float, float]]) -> Any:
    """Characteristic inverse mass of each row."""
    none = (0.0, 0.0)
    a = none if joint.body_a == GROUND else scales(joint.body_a)
    b = none if joint.body_b == GROUND else scales(joint.body_b)
    if a[0] + b[0] == 0.0:
        raise InputError(
            f"neither {joint.body_a!r} nor {joint.body_b!r} can move",
            source=joint.name,
            key="between",
            expected="at least one free body",
        )
    return np.array([a[1] + b[1] if turns else a[0] + b[0] for turns in rotational])


def _openness(
    joint: Joint, rotational: tuple[bool, ...], scales: Callable[[str], tuple[float, float]]
) -> Any:
    """Factor that makes a violation 1 where a run has failed, of each row: a distance like the larger body."""
    sides = [scales(name) for name in (joint.body_a, joint.body_b) if name != GROUND]
    largest = max(math.sqrt(mass / inertia) for mass, inertia in sides if inertia > 0.0)
    return np.array([1.0 if turns else 1.0 / (OPEN * largest) for turns in rotational])
