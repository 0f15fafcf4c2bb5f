"""Winches that are commanded from outside: by a speed, or by the unstretched length of the rope."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.solver.scene.inputs import (
    INPUTS,
    Interpolation,
    LengthInputOutputs,
    OnRope,
    SpeedLimits,
    check_limits,
)

__all__ = ["WinchLengthInput", "WinchSpeedInput"]


@INPUTS.describe("winch_speed")
@dataclass(frozen=True, eq=False, kw_only=True)
class WinchSpeedInput(SpeedLimits, OnRope):
    """Speed of the winch of a wire rope; hauls in if positive."""

    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"speed at which the winch of {self.rope!r} hauls in"


@INPUTS.describe("winch_length")
@dataclass(frozen=True, eq=False, kw_only=True)
class WinchLengthInput(OnRope):
    """Unstretched length of a wire rope, which its winch changes; begins with that at the start."""

    CHANNELS: ClassVar = LengthInputOutputs.CHANNELS
    MOVES: ClassVar[bool] = True
    interpolation: ClassVar[Interpolation] = "linear"

    smallest: Annotated[float | None, Positive("length")] = None
    """Smallest value that it may be set to [m]."""
    largest: Annotated[float | None, Positive("length")] = None
    """Largest value that it may be set to [m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"unstretched length of {self.rope!r}"
