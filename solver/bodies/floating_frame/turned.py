"""Joints that hold a direction of a body with modes, where the modes turn it, are refused.

A direction of a floating frame turns with the frame. A joint that holds one at a place P sees the frame, and its moment
acts on the frame, so no moment reaches the modes. That is exact where the modes do not turn the direction d at P:

    | theta_i(P) x d | L <= 1e-3 max | phi_i |    for all modes i

with the rotation theta_i of the nodes around P (`heavylift.modal.reduced.ReducedBody.turn_at`), the largest
displacement of the mode and the largest extent L of the body: the place of a clamp of the frame, or modes that by their
symmetry leave the direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.modal.reduced import TURNED
from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from heavylift.modal.reduced import ReducedBody
    from heavylift.solver.markers import MarkerBook
    from heavylift.solver.scene.bodies import FlexibleBody

__all__ = ["refuse_turned", "tell_held_chords", "tell_turned"]


def refuse_turned(
    bodies: Sequence[FlexibleBody], book: MarkerBook, first: int, things: Sequence[Any]
) -> None:
    """Refuse things that hold directions of bodies with modes.

    Parameters
    ----------
    bodies
        With modes.
    book
        Markers of the scene.
    first
        Number of the first marker that was made for these things.
    things
        Joints, contacts or line bearings. Other markers, as axes of sheaves, are passed over: a rope pulls at the
        centre of its sheave.

    Raises
    ------
    InputError
        If modes turn a direction: the thing, the place and the ways out.
    """
    for body in bodies:
        for place in _turned(body, book, first):
            for thing in things:
                if _is_at(thing, body.name, place):
                    _refuse(thing, body, place)


def tell_turned(bodies: Sequence[FlexibleBody], book: MarkerBook, things: Sequence[Any]) -> tuple[str, ...]:
    """Sentences on forces and measures that take directions of bodies with modes where these turn.

    They act at points and need a direction only to know where to: it is off by the angle by which the place turns.
    """
    sentences = []
    for body in bodies:
        places = _turned(body, book, 0)
        names = [thing.name for thing in things if any(_is_at(thing, body.name, place) for place in places)]
        if names:
            named = ", ".join(repr(name) for name in dict.fromkeys(names))
            sentences.append(
                f"directions of {named} on the flexible body {body.name!r} are those of its frame: how far its modes "
                "turn the place is left out"
            )
    return tuple(sentences)


def tell_held_chords(bodies: Sequence[FlexibleBody], joints: Sequence[Any]) -> tuple[str, ...]:
    """Sentences on joints of points that together hold chords of bodies with modes where the modes turn these.

    Linear modes lengthen what they turn by an angle a by a^2 / 2 of its length. Two points that another body holds at
    their distance resist that, as no solid would: a triangle of three, where one point and three rods would do.
    """
    sentences = []
    for body in bodies:
        if not body.reduced.continuum:
            continue
        held: dict[str, list[tuple[str, NDArray[np.float64]]]] = {}
        for joint in joints:
            if tuple(joint.rotational) == (False, False, False) and body.name in {joint.body_a, joint.body_b}:
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
                    "they resist; take one 'ball' joint, and rods (type 'distance') that hold no more than it needs"
                )
    return tuple(sentences)


def _turns_chord(reduced: ReducedBody, p: NDArray[np.float64], q: NDArray[np.float64]) -> bool:
    """Whether modes turn the chord of two points that are nearer than half of the size of the body."""
    length = float(np.linalg.norm(q - p))
    if not 0.0 < length < 0.5 * reduced.size:
        return False
    moved = reduced.shapes_at(*reduced.locate(q)) - reduced.shapes_at(*reduced.locate(p))
    turned = np.linalg.norm(np.cross(moved, (q - p) / length), axis=1) / length
    largest = np.linalg.norm(reduced.mode_shapes, axis=2).max(axis=1)
    return bool(np.any(turned * reduced.size > TURNED * largest))


def _turned(body: FlexibleBody, book: MarkerBook, first: int) -> list[NDArray[np.float64]]:
    """Places of a body [m] with a direction that its modes turn, each once."""
    found: dict[bytes, NDArray[np.float64]] = {}
    (markers,) = book.of([body.name])
    for number, vector, direction, place in zip(
        markers.numbers, markers.vectors, markers.directions, markers.places, strict=True
    ):
        if direction and number >= first and place.tobytes() not in found:
            nodes, weights = body.reduced.locate(place, source=body.name)
            if body.reduced.turns(nodes, weights, vector):
                found[place.tobytes()] = place
    return list(found.values())


def _refuse(thing: Any, body: FlexibleBody, place: NDArray[np.float64]) -> None:
    at = ", ".join(f"{1e3 * x:.6g}" for x in place)
    raise InputError(
        f"it holds a direction of the flexible body {body.name!r} at ({at}) mm in its frame, where its modes turn it; "
        "such a body has the directions of its frame only, and no moment would bend it",
        source=thing.name,
        expected="joints of points there that hold no more than it takes: one 'ball' joint and three rods (type "
        "'distance') hold as 'fixed' does, one and two rods across its axis as 'hinge'; or a place where a body with a "
        "fixed or driven frame is clamped; or a body of type 'frame' or 'shell', whose joints pass moments",
    )


def _is_at(thing: Any, body: str, place: NDArray[np.float64]) -> bool:
    """Whether something stands at a place of a body; a lug does where its rope ends."""
    if hasattr(thing, "rope") and hasattr(thing, "body"):
        return bool(thing.body == body)
    ends = [(getattr(thing, "body", None), getattr(thing, "point", None))]
    for side in "ab":
        frame = getattr(thing, f"frame_{side}", None)
        point = getattr(thing, f"point_{side}", None) if frame is None else frame.point
        ends.append((getattr(thing, f"body_{side}", None), point))
    return any(
        name == body and point is not None and np.allclose(point, place, rtol=0.0, atol=1e-12)
        for name, point in ends
    )
