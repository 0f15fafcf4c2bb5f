"""Joints that hold of bodies with modes what these do not have: lengths of chords that they turn, twists about lines.

Linear modes lengthen the chords that they turn, and nodes without rotations that lie on a line have none about it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.modal.reduced import TURNED
from heavylift.solver.scene.bodies import Free

if TYPE_CHECKING:
    from heavylift.modal.reduced import ReducedBody
    from heavylift.solver.scene.bodies import FlexibleBody

__all__ = ["tell_few_modes", "tell_held_chords", "tell_lines"]

_POINT = (False, False, False)  # rows of a joint that holds a point come first, and none of them is an angle


def tell_held_chords(bodies: Sequence[FlexibleBody], joints: Sequence[Any]) -> tuple[str, ...]:
    """Sentences on joints that together hold chords of bodies with modes where the modes turn these.

    Linear modes lengthen what they turn by an angle a by a^2 / 2 of its length. Two points that another body holds at
    their distance resist that, as no solid would: a triangle of three, where one point and three rods would do.
    """
    sentences = []
    for body in bodies:
        if not body.reduced.continuum:
            continue
        held: dict[str, list[tuple[str, NDArray[np.float64]]]] = {}
        for joint in joints:
            if tuple(joint.rotational[:3]) == _POINT and body.name in {joint.body_a, joint.body_b}:
                first = joint.body_a == body.name
                frame, other = (joint.frame_a, joint.body_b) if first else (joint.frame_b, joint.body_a)
                held.setdefault(other, []).append((joint.name, np.asarray(frame.point, dtype=np.float64)))
        for other, points in held.items():
            names = {
                name
                for (a, p), (b, q) in combinations(points, 2)
                if _turns_chord(body.reduced, p, q)
                for name in (a, b)
            }
            if names:
                named = ", ".join(repr(name) for name, _ in points if name in names)
                sentences.append(
                    f"joints {named} hold points of the flexible body {body.name!r} at fixed distances on {other!r}: "
                    "where they turn by an angle a, its modes lengthen what is between them by a^2 / 2 of it, which "
                    "they resist; take one of them, and rods (type 'distance') that hold no more than it needs"
                )
    return tuple(sentences)


def tell_few_modes(bodies: Sequence[FlexibleBody], joints: Sequence[Any]) -> tuple[str, ...]:
    """Sentences on bodies whose modes are held by as many rows of joints, so that none of them is left to deform."""
    sentences = []
    flexible = {body.name for body in bodies}
    for body in bodies:
        reduced = body.reduced
        if not reduced.continuum or not reduced.mode_count:
            continue
        largest = np.linalg.norm(reduced.mode_shapes, axis=2).max()
        rows = 0
        for joint in joints:
            if {joint.body_a, joint.body_b} & flexible != {body.name} or joint.body_a == joint.body_b:
                continue
            frame = joint.frame_a if joint.body_a == body.name else joint.frame_b
            moved = reduced.motion_at(frame.point, source=body.name).displacement
            if np.linalg.norm(moved, axis=1).max() > TURNED * largest:
                rows += list(joint.rotational).count(False)
        free = 6 if isinstance(body.motion, Free) else 0
        if rows >= reduced.mode_count + free:
            sentences.append(
                f"joints hold {rows} displacements of places of the flexible body {body.name!r}, which has "
                f"{reduced.mode_count} modes: they leave it no deformation; give it more modes, static points or "
                "interfaces there"
            )
    return tuple(sentences)


def tell_lines(bodies: Sequence[FlexibleBody], joints: Sequence[Any]) -> tuple[str, ...]:
    """Sentences on joints that hold directions where all nodes of a body without elements lie on a line."""
    return tuple(
        f"joint {joint.name!r} holds directions of the flexible body {body.name!r} where the nodes around lie on a "
        "line: its modes have no rotation about that, and no moment about it reaches them; take an interface of nodes "
        "that do not"
        for body in bodies
        for joint in joints
        for name, frame in ((joint.body_a, joint.frame_a), (joint.body_b, joint.frame_b))
        if name == body.name and any(joint.rotational) and body.reduced.lies_on_a_line(frame.point)
    )


def _turns_chord(reduced: ReducedBody, p: NDArray[np.float64], q: NDArray[np.float64]) -> bool:
    """Whether modes turn the chord of two points that are nearer than half of the size of the body."""
    length = float(np.linalg.norm(q - p))
    if not 0.0 < length < 0.5 * reduced.size:
        return False
    moved = reduced.point_at(q)[1] - reduced.point_at(p)[1]
    return reduced.turns(moved / length, (q - p) / length)
