"""Drives of joints and of frames that are commanded from outside: by a speed, or by a place."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import ByCoordinate, Quantity
from heavylift.solver.scene.inputs import (
    INPUTS,
    AboutFrame,
    AlongFrame,
    AngleInputOutputs,
    Interpolation,
    LengthInputOutputs,
    OnJoint,
    SpeedInputOutputs,
    SpeedLimits,
    TurnRateInputOutputs,
    check_limits,
)

__all__ = [
    "DrivePositionInput",
    "DriveSpeedInput",
    "FrameAngleInput",
    "FramePositionInput",
    "FrameSpeedInput",
    "FrameTurnRateInput",
]

SPEED = ByCoordinate(Quantity("angular velocity"), Quantity("velocity"))
PLACE = ByCoordinate(Quantity("angle"), Quantity("length"))


@INPUTS.describe("drive_speed")
@dataclass(frozen=True, eq=False, kw_only=True)
class DriveSpeedInput(OnJoint):
    """Speed of the drive of a hinge or a slider, which stands without it."""

    CHANNEL_BY_COORDINATE: ClassVar = {
        "angle": TurnRateInputOutputs.CHANNELS[0],
        "travel": SpeedInputOutputs.CHANNELS[0],
    }

    value: Annotated[float, SPEED] = 0.0
    """At the start [rad/s] or [m/s]; held until it is set."""
    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""
    smallest: Annotated[float | None, SPEED] = None
    """Smallest value that it may be set to."""
    largest: Annotated[float | None, SPEED] = None
    """Largest value that it may be set to."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"speed of the drive of {self.joint!r}"


@INPUTS.describe("drive_position")
@dataclass(frozen=True, eq=False, kw_only=True)
class DrivePositionInput(OnJoint):
    """Angle or travel to which a drive of a hinge or a slider moves; begins with that at the start."""

    CHANNEL_BY_COORDINATE: ClassVar = {
        "angle": AngleInputOutputs.CHANNELS[0],
        "travel": LengthInputOutputs.CHANNELS[0],
    }
    MOVES: ClassVar[bool] = True
    interpolation: ClassVar[Interpolation] = "linear"

    smallest: Annotated[float | None, PLACE] = None
    """Smallest value that it may be set to [rad] or [m]."""
    largest: Annotated[float | None, PLACE] = None
    """Largest value that it may be set to [rad] or [m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"angle or travel of the drive of {self.joint!r}"


@INPUTS.describe("frame_speed")
@dataclass(frozen=True, eq=False, kw_only=True)
class FrameSpeedInput(SpeedLimits, AlongFrame):
    """Speed of a frame along an axis of the world, in which it stands without it."""

    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"speed of the frame of {self.body!r} along {self.axis}"


@INPUTS.describe("frame_position")
@dataclass(frozen=True, eq=False, kw_only=True)
class FramePositionInput(AlongFrame):
    """Displacement of a frame along an axis of the world; begins with that at the start."""

    CHANNELS: ClassVar = LengthInputOutputs.CHANNELS
    MOVES: ClassVar[bool] = True
    interpolation: ClassVar[Interpolation] = "linear"

    smallest: Annotated[float | None, Quantity("length")] = None
    """Smallest value that it may be set to [m]."""
    largest: Annotated[float | None, Quantity("length")] = None
    """Largest value that it may be set to [m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"displacement of the frame of {self.body!r} along {self.axis}"


@INPUTS.describe("frame_turn_rate")
@dataclass(frozen=True, eq=False, kw_only=True)
class FrameTurnRateInput(AboutFrame):
    """Rate at which a frame turns about the axis of its drive."""

    CHANNELS: ClassVar = TurnRateInputOutputs.CHANNELS

    value: Annotated[float, Quantity("angular velocity")] = 0.0
    """At the start [rad/s]; held until it is set."""
    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""
    smallest: Annotated[float | None, Quantity("angular velocity")] = None
    """Smallest value that it may be set to [rad/s]."""
    largest: Annotated[float | None, Quantity("angular velocity")] = None
    """Largest value that it may be set to [rad/s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"rate at which the frame of {self.body!r} turns"


@INPUTS.describe("frame_angle")
@dataclass(frozen=True, eq=False, kw_only=True)
class FrameAngleInput(AboutFrame):
    """Angle of a frame about the axis of its drive; begins with that at the start."""

    CHANNELS: ClassVar = AngleInputOutputs.CHANNELS
    MOVES: ClassVar[bool] = True
    interpolation: ClassVar[Interpolation] = "linear"

    smallest: Annotated[float | None, Quantity("angle")] = None
    """Smallest value that it may be set to [rad]."""
    largest: Annotated[float | None, Quantity("angle")] = None
    """Largest value that it may be set to [rad]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"angle of the frame of {self.body!r}"
