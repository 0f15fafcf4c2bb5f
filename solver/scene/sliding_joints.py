"""Joints that slide or turn and slide, and what acts on the angle and travel of any joint: stops and friction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.connections import (
    AngleOutputs,
    ForceElement,
    Joint,
    Limits,
    Place,
    ReactionOutputs,
    TravelOutputs,
)
from heavylift.solver.scene.outputs import Outputs, nested, outputs

__all__ = [
    "JointFriction",
    "JointStop",
    "SlidesAndTurns",
    "SlidesAndTurnsOutputs",
    "SlidingOutputs",
    "joint_friction",
    "joint_stops",
]

SCALAR_LAWS = "heavylift.solver.force_elements.scalar_packing"
"""Packs what has a corner on a distance, angle or travel."""


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


@dataclass(frozen=True, eq=False)
class _OnCoordinate(ForceElement):
    """What acts on the angle or travel of a joint and stands in the joint: its key, ``"angle"`` or ``"travel"``."""

    joint: Joint
    key: str
    coordinate: str

    def packed_by(self, integrator: str) -> str:
        """A law of a scalar."""
        del integrator
        return SCALAR_LAWS


@dataclass(frozen=True, eq=False)
class JointStop(_OnCoordinate):
    """Stops of a joint."""

    limits: Limits


@dataclass(frozen=True, eq=False)
class JointFriction(_OnCoordinate):
    """Dry friction of a joint, its largest load [N m] or [N]."""

    largest: float


def joint_stops(joint: Joint) -> Iterator[JointStop]:
    """Stops of a joint."""
    for key, coordinate in (
        ("limits", joint.COORDINATE),
        ("angle_limits", "angle"),
        ("travel_limits", "travel"),
    ):
        limits = getattr(joint, key, None)
        if limits is not None:
            yield JointStop(joint, key, coordinate, limits)


def joint_friction(joint: Joint) -> Iterator[JointFriction]:
    """Dry friction of a joint."""
    for key, coordinate in (
        ("friction", joint.COORDINATE),
        ("angle_friction", "angle"),
        ("travel_friction", "travel"),
    ):
        friction = float(getattr(joint, key, 0.0))
        if friction != 0.0:
            yield JointFriction(joint, key, coordinate, friction)
