"""A torque about the axis of a hinge, or a force along a slider: a motor that is commanded from outside."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import ByCoordinate, Quantity
from heavylift.solver.scene.connections import AlongJoint
from heavylift.solver.scene.inputs import (
    INPUTS,
    ForceInputOutputs,
    Input,
    Interpolation,
    MomentInputOutputs,
    check_limits,
)

__all__ = ["JointLoadInput"]

LOAD = ByCoordinate(Quantity("moment or energy"), Quantity("force"))


@INPUTS.describe("joint_load")
@dataclass(frozen=True, eq=False, kw_only=True)
class JointLoadInput(AlongJoint, Input):
    """A torque or force of side a of a joint on its side b."""

    ACTS: ClassVar[str] = "load"
    CHANNEL_BY_COORDINATE: ClassVar = {
        "angle": MomentInputOutputs.CHANNELS[0],
        "travel": ForceInputOutputs.CHANNELS[0],
    }

    coordinate: Literal["angle", "travel"] | None = None
    """Of a joint that both turns and slides: what of it counts."""
    value: Annotated[float, LOAD] = 0.0
    """At the start [N m] or [N]; held until it is set."""
    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""
    smallest: Annotated[float | None, LOAD] = None
    """Smallest value that it may be set to."""
    largest: Annotated[float | None, LOAD] = None
    """Largest value that it may be set to."""

    @staticmethod
    def check(spec: Any) -> None:
        """Its limits leave a range."""
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"load of side a of {self.joint!r} on its side b"
