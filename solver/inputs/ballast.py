"""Water of tanks, and set points of controllers of ballast, that are commanded from outside."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import NameOf, Quantity
from heavylift.solver.scene.ballast import MASS_FLOW
from heavylift.solver.scene.inputs import (
    INPUTS,
    WHAT,
    AngleInputOutputs,
    Input,
    Interpolation,
    LengthInputOutputs,
    OnController,
    check_limits,
)
from heavylift.solver.scene.outputs import Outputs, channel, outputs

__all__ = ["HeightTargetInput", "TankRateInput", "TiltTargetInput"]


@outputs
class FlowInputOutputs(Outputs):
    """Of inputs that are flows of mass."""

    value: float = channel(MASS_FLOW, WHAT, by_owner=True)


@INPUTS.describe("tank_rate")
@dataclass(frozen=True, eq=False, kw_only=True)
class TankRateInput(Input):
    """Water that is pumped into a tank, out of it if negative, until it is empty."""

    DRIVES: ClassVar[str] = "tank"
    TARGET: ClassVar[str] = "tank"
    CHANNELS: ClassVar = FlowInputOutputs.CHANNELS
    interpolation: ClassVar[Interpolation] = "held"

    tank: Annotated[str, NameOf("tank")]
    """Tank with a mass at the start, and without [[pumps]]."""
    value: Annotated[float, Quantity(MASS_FLOW)] = 0.0
    """At the start [kg/s]; held until it is set."""
    smallest: Annotated[float | None, Quantity(MASS_FLOW)] = None
    """Smallest value that it may be set to [kg/s]."""
    largest: Annotated[float | None, Quantity(MASS_FLOW)] = None
    """Largest value that it may be set to [kg/s]."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def target(self) -> str:
        """The tank."""
        return self.tank

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"water that flows into {self.tank!r}"


@INPUTS.describe("tilt_target")
@dataclass(frozen=True, eq=False, kw_only=True)
class TiltTargetInput(OnController):
    """Heel or trim that a controller of ballast keeps; begins with that of the controller."""

    CHANNELS: ClassVar = AngleInputOutputs.CHANNELS

    keeps: Literal["heel", "trim"]
    """Which of them."""
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
        return f"{self.keeps} that {self.controller!r} keeps"


@INPUTS.describe("height_target")
@dataclass(frozen=True, eq=False, kw_only=True)
class HeightTargetInput(OnController):
    """Draft, or height of a point, that a controller of ballast keeps; begins with that of the controller."""

    CHANNELS: ClassVar = LengthInputOutputs.CHANNELS

    keeps: Literal["draft", "level_1", "level_2", "level_3"]
    """The draft, or the height of which of its `levels`."""
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
        return f"{self.keeps} that {self.controller!r} keeps"
