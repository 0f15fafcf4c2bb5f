"""Joints of a scene become kinds, one after the other; a type without members in a scene is not imported."""

from __future__ import annotations

import importlib
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.joints.packing import JointPlace, start_frames
from heavylift.solver.markers import MarkerBook
from heavylift.solver.rows.structure import MOVES, TURNS, Attachment, RowSystem, pack_rows
from heavylift.solver.scene.connections import GROUND, JOINTS, ROW_JOINTS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from heavylift.solver.scene.connections import Joint
    from heavylift.solver.scene.outputs import Columns
    from heavylift.solver.scene.scene import AnyBody

__all__ = ["block_order", "joint_module", "largest_opening", "pack_joints"]

OPEN = 3.0
"""Distance of the points of a joint, in radii of gyration of the larger body, at which a run has failed."""


def joint_module(joint: Joint) -> Any:
    """The module that makes the kind of a joint.

    Raises
    ------
    InputError
        If its type is unknown.
    """
    module = importlib.import_module(joint.kind_module)
    if not hasattr(module, "pack"):
        raise InputError(
            f"a {type(joint).__name__}",
            source=joint.name,
            key="type",
            expected="one of " + ", ".join(JOINTS.words),
        )
    return module


def block_order(joint: Joint) -> str:
    """Blocks of joints are in the order of this: the file that describes them, or that of the kind with a drive."""
    return type(joint).__module__ if joint.kind_module == ROW_JOINTS else joint.kind_module


def pack_joints(
    joints: Sequence[Joint],
    columns: Sequence[Columns],
    book: MarkerBook,
    attachment: Callable[[str], Attachment],
    scales: Callable[[str], tuple[float, float]],
    bodies: Sequence[AnyBody],
) -> tuple[tuple[Any, ...], Callable[[Any, int], RowSystem], tuple[str, ...]]:
    """Make the kinds of all joints, a function that makes their system, and the names of their blocks.

    Parameters
    ----------
    joints, columns
        Joints, and where the outputs of each are in a record.
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
    groups: dict[Any, tuple[list[Joint], list[JointPlace]]] = {}
    ordered: list[tuple[Joint, tuple[bool, ...]]] = []
    # in an order of their own, whatever that of the scene
    for joint, column in sorted(zip(joints, columns, strict=True), key=lambda pair: block_order(pair[0])):
        members, places = groups.setdefault(joint_module(joint), ([], []))
        members.append(joint)
        places.append(JointPlace(len(ordered), column, start_frames(joint, bodies)))
        ordered.append((joint, joint.rotational))
    kinds = [module.pack(*group, book) for module, group in groups.items()]

    def system(inverse_mass: Any, monitor: int) -> RowSystem:
        sides = [(attachment(joint.body_a), attachment(joint.body_b)) for joint, _ in ordered]
        scale = [_scale(joint, rotational, scales) for joint, rotational in ordered]
        made = pack_rows([len(r) for _, r in ordered], sides, scale, inverse_mass, monitor)
        for block, (joint, rotational) in enumerate(ordered):
            made.rows[block].compliance[: len(rotational)] = joint.compliance
            if joint.compliance > 0.0:
                made.rows[block].stiffness[: len(rotational)] = 1.0 / joint.compliance
            made.rows[block].relaxation[: len(rotational)] = joint.relaxation
            made.rows[block].rigid[: len(rotational)] = _openness(joint, rotational, scales)
            made.rows[block].vector[: len(rotational)] = [TURNS if turns else MOVES for turns in rotational]
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
    distance = largest_opening(joint, scales, turns=False)
    return np.array([1.0 if turns else 1.0 / distance for turns in rotational])


def largest_opening(joint: Joint, scales: Callable[[str], tuple[float, float]], *, turns: bool) -> float:
    """Violation of a row at which a run has failed: a radian, or a distance like the larger body [m]."""
    if turns:
        return 1.0
    sides = [scales(name) for name in (joint.body_a, joint.body_b) if name != GROUND]
    return OPEN * max(math.sqrt(mass / inertia) for mass, inertia in sides if inertia > 0.0)
