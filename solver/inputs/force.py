"""A force on a material point along a direction."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.solver.scene.connections import OnBody
from heavylift.solver.scene.descriptions import forward
from heavylift.solver.scene.inputs import INPUTS, ForceLimits, Input, Interpolation, check_limits

__all__ = ["ForceInput"]


@INPUTS.describe("force")
@dataclass(frozen=True, eq=False, kw_only=True)
class ForceInput(ForceLimits, OnBody, Input):
    """A force on a point of a body, along a direction in the axes of the world or of the body."""

    ACTS: ClassVar[str] = "force"
    SENTENCES: ClassVar = {
        "name": "Its name; its channel is ``NAME.value``.",
        "body": "Body that is loaded.",
        "point": "Loaded point in the coordinates of the geometry [m]; of a flexible body, frame or shell any point of "
        "its mesh, or the name of an interface.",
    }

    direction: Annotated[NDArray[np.float64], Quantity("number"), Shape((3,))] = field(
        default_factory=forward
    )
    """Along which it acts, of any length."""
    frame: Literal["world", "body"] = "world"
    """Axes of the direction: of the world, or of the body frame."""
    interpolation: Interpolation = "held"
    """Whether it jumps when it is set, or moves to what it is set to during the next exchange."""

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
        return f"force on {self.body!r} along {self.direction.tolist()}, axes of the {self.frame}"
