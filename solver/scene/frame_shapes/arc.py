"""An arc of a circle."""

from __future__ import annotations

import math
from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection, Key, Positive, Quantity, Shape
from heavylift.solver.scene.descriptions import forward, is_parallel, upwards, zero_point
from heavylift.solver.scene.mesh_shapes import FRAME_SHAPES, FrameMesh, FrameShape, arc

__all__ = ["ArcShape"]


@FRAME_SHAPES.describe("arc")
@dataclass(frozen=True, eq=False, kw_only=True)
class ArcShape(FrameShape):
    """An arc of a circle, cut into equal elements."""

    ORDER: ClassVar = 2
    CURVED: ClassVar = True

    centre: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))] = field(
        default_factory=zero_point
    )
    """Centre of the circle, in the frame of the body [m]."""
    radius: Annotated[float, Positive("length")]
    """[m]."""
    first: Annotated[float, Quantity("angle"), Key("from")] = 0.0
    """Angle of the first end from `reference` on, about `normal` [rad]."""
    last: Annotated[float, Quantity("angle"), Key("to")]
    """Angle of the second end [rad]."""
    normal: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=upwards)
    """Normal of its plane, any length."""
    reference: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=forward)
    """Direction from the centre where the angle is zero; its part in the plane counts."""
    elements: Annotated[int, Interval(ge=1)]
    """Number of elements."""

    @staticmethod
    def check(spec: Any) -> None:
        """It has a length, no more than that of a circle, and a direction in its plane."""
        if spec.first == spec.last:
            problem = f"'from' and 'to' are both {spec.first:g} rad"
            raise InputError(problem, key="to", expected="two different angles")
        if abs(spec.last - spec.first) > 2.0 * math.pi * (1.0 + 1e-12):
            problem = f"{spec.last - spec.first:g} rad from end to end"
            raise InputError(problem, key="to", expected="a circle at most")
        if is_parallel(spec.normal, spec.reference):
            raise InputError("is parallel to 'normal'", key="reference", expected="a direction across it")

    def mesh(self) -> FrameMesh:
        """Equal elements from angle to angle."""
        normal = self.normal / np.linalg.norm(self.normal)
        first = self.reference - (normal @ self.reference) * normal
        axes = (first, np.cross(normal, first))
        return arc(self.centre, self.radius, self.first, self.last, self.elements, axes=axes)
