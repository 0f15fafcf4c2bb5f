"""A moment on a body about a direction."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.solver.scene.connections import OnBody
from heavylift.solver.scene.descriptions import upwards
from heavylift.solver.scene.inputs import INPUTS, Input, Interpolation, MomentInputOutputs, check_limits

__all__ = ["MomentInput"]


@INPUTS.describe("moment")
@dataclass(frozen=True, eq=False, kw_only=True)
class MomentInput(OnBody, Input):
    """A moment on a body, about a direction in the axes of the world or of the body."""

    ACTS: ClassVar[str] = "moment"
    CHANNELS: ClassVar = MomentInputOutputs.CHANNELS
    SENTENCES: ClassVar = {
        "name": "Its name; its channel is ``NAME.value``.",
        "body": "Body that is loaded.",
        "point": "Where it acts, in the coordinates of the geometry [m]; of a rigid body any point.",
    }

    direction: Annotated[NDArray[np.float64], Quantity("number"), Shape((3,))] = field(
        default_factory=upwards
    )
    """About which it acts, of any length."""
    frame: Literal["world", "body"] = "world"
    """Axes of the direction: of the world, or of the body frame."""
    value: Annotated[float, Quantity("moment or energy")] = 0.0
    """At the start [N m]; held until it is set."""
    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""
    smallest: Annotated[float | None, Quantity("moment or energy")] = None
    """Smallest value that it may be set to [N m]."""
    largest: Annotated[float | None, Quantity("moment or energy")] = None
    """Largest value that it may be set to [N m]."""

    @staticmethod
    def check(spec: Any) -> None:
        """It has a direction, and its limits leave a range."""
        if not np.any(spec.direction):
            raise InputError(
                f"{list(spec.direction)}", key="direction", expected="a direction that is not zero"
            )
        check_limits(spec)

    @property
    def sentence(self) -> str:
        """What it is, in words."""
        return f"moment on {self.body!r} about {self.direction.tolist()}, axes of the {self.frame}"
