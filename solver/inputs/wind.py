"""Speed and direction of a wind or a current that are set from outside."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Quantity
from heavylift.solver.scene.inputs import (
    INPUTS,
    AngleInputOutputs,
    OnFluid,
    SpeedInputOutputs,
    check_limits,
)

__all__ = ["FluidDirectionInput", "FluidSpeedInput"]


@INPUTS.describe("fluid_speed")
@dataclass(frozen=True, eq=False, kw_only=True)
class FluidSpeedInput(OnFluid):
    """Mean speed of a wind at 10 m, without fluctuation, or of a current with one at all depths; begins with theirs."""

    PART: ClassVar[str] = "speed"
    CHANNELS: ClassVar = SpeedInputOutputs.CHANNELS

    smallest: Annotated[float | None, Quantity("velocity", minimum=0.0, closed=True)] = None
    """Smallest value that it may be set to [m/s]."""
    largest: Annotated[float | None, Quantity("velocity", minimum=0.0, closed=True)] = None
    """Largest value that it may be set to [m/s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"mean speed of {self.fluid!r}"


@INPUTS.describe("fluid_direction")
@dataclass(frozen=True, eq=False, kw_only=True)
class FluidDirectionInput(OnFluid):
    """Direction in which a wind or a current flows, from world x, anticlockwise; begins with theirs, no table."""

    PART: ClassVar[str] = "direction"
    CHANNELS: ClassVar = AngleInputOutputs.CHANNELS

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
        return f"direction in which {self.fluid!r} flows, from world x, anticlockwise"
