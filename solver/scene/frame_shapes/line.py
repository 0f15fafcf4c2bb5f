"""A straight line."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.solver.scene.mesh_shapes import FRAME_SHAPES, FrameMesh, FrameShape, line

__all__ = ["LineShape"]


@FRAME_SHAPES.describe("line")
@dataclass(frozen=True, eq=False, kw_only=True)
class LineShape(FrameShape):
    """A straight line, cut into equal elements."""

    ORDER: ClassVar = 1

    start: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))]
    """First end, in the frame of the body [m]."""
    end: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))]
    """Second end [m]."""
    elements: Annotated[int, Interval(ge=1)]
    """Number of elements."""

    @staticmethod
    def check(spec: Any) -> None:
        """It has a length."""
        if list(spec.start) == list(spec.end):
            problem = f"'start' and 'end' are both {list(spec.start)} m"
            raise InputError(problem, key="end", expected="two different points")

    def mesh(self) -> FrameMesh:
        """Equal elements from end to end."""
        return line(self.start, self.end, self.elements)
