"""A cylinder: a prism of many sides."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import BodyDirection, Positive
from heavylift.pipeline.shapes.shape import SHAPES, SurfaceShape
from heavylift.preprocess.surfaces.primitives import cylinder_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.descriptions import upwards

__all__ = ["CylinderShape"]


@SHAPES.describe("cylinder")
@dataclass(frozen=True, eq=False, kw_only=True)
class CylinderShape(SurfaceShape):
    """A cylinder about the origin: a prism of many sides."""

    ORDER: ClassVar = 5

    radius: Annotated[float, Positive("length")]
    """[m]."""
    length: Annotated[float, Positive("length")]
    """From face to face [m]."""
    axis: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=upwards)
    """Direction, any length."""
    sides: Annotated[int, Interval(ge=3, le=10_000)] = 64
    """Flat sides round it, inside of the cylinder by up to 5 / sides^2 of its radius; what rolls is better a
    capsule."""

    @staticmethod
    def smallest(spec: Any) -> float:
        """Its diameter or its length."""
        return float(min(2.0 * spec.radius, spec.length))

    def surface(self, rounding: float, name: str) -> TriangleSurface:
        """The prism within the rounding."""
        return cylinder_surface(
            self.radius, self.length, self.axis, sides=self.sides, rounding=rounding, name=name
        )
