"""Joints that slide or turn and slide, and what acts on the angle and travel of any joint: stops and friction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.connections import (
    AngleOutputs,
    Joint,
    Limits,
    Place,
    ReactionOutputs,
    TravelOutputs,
)
from heavylift.solver.scene.outputs import Outputs, nested, outputs

__all__ = ["SlidesAndTurns", "SlidesAndTurnsOutputs", "SlidingOutputs", "joint_friction", "joint_stops"]


@outputs
class SlidingOutputs(Outputs):
    """What a joint records that slides."""

    reaction: ReactionOutputs = nested(ReactionOutputs)
    slide: TravelOutputs = nested(TravelOutputs)


@outputs
class SlidesAndTurnsOutputs(Outputs):
    """What a joint records that turns and slides."""

    reaction: ReactionOutputs = nested(ReactionOutputs)
    turn: AngleOutputs = nested(AngleOutputs)
    slide: TravelOutputs = nested(TravelOutputs)


@dataclass(frozen=True, eq=False, kw_only=True)
class SlidesAndTurns(Joint):
    """What joints have whose b turns about one axis of a and slides along one."""

    PLACE: ClassVar = Place.AXIS
    ROWS: ClassVar = (("travel", "m"), ("travel", "n"), ("parallel", "z"))
    CHANNELS: ClassVar = SlidesAndTurnsOutputs.CHANNELS

    angle_limits: Annotated[Limits | None, Quantity("angle")] = None
    """Stops of the angle."""
    travel_limits: Annotated[Limits | None, Quantity("length")] = None
    """Stops of the travel."""
    angle_friction: Annotated[float, Quantity("moment or energy", minimum=0.0, closed=True)] = 0.0
    """Dry friction against the turn [N m]."""
    travel_friction: Annotated[float, Quantity("force", minimum=0.0, closed=True)] = 0.0
    """Dry friction against the travel [N]."""


def joint_stops(joint: Joint) -> Iterator[tuple[str, str, Limits]]:
    """Key, coordinate (``"angle"`` or ``"travel"``) and limits of each stop of a joint."""
    for key, coordinate in (
        ("limits", joint.COORDINATE),
        ("angle_limits", "angle"),
        ("travel_limits", "travel"),
    ):
        limits = getattr(joint, key, None)
        if limits is not None:
            yield key, coordinate, limits


def joint_friction(joint: Joint) -> Iterator[tuple[str, str, float]]:
    """Key, coordinate and dry friction [N m] or [N] of each that a joint has."""
    for key, coordinate in (
        ("friction", joint.COORDINATE),
        ("angle_friction", "angle"),
        ("travel_friction", "travel"),
    ):
        friction = float(getattr(joint, key, 0.0))
        if friction != 0.0:
            yield key, coordinate, friction
