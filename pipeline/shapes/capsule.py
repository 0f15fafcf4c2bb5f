"""A capsule: a lone segment with a rounding."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import BodyDirection, Positive
from heavylift.pipeline.shapes.shape import SHAPES, SurfaceShape
from heavylift.preprocess.surfaces.primitives import capsule_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.descriptions import upwards

__all__ = ["CapsuleShape"]


@SHAPES.describe("capsule")
@dataclass(frozen=True, eq=False, kw_only=True)
class CapsuleShape(SurfaceShape):
    """A round bar with half balls as ends about the origin, exactly round."""

    ORDER: ClassVar = 4
    ROUND: ClassVar = True

    radius: Annotated[float, Positive("length")]
    """[m]."""
    length: Annotated[float, Positive("length")]
    """Of its straight part: from centre to centre of its ends [m]."""
    axis: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=upwards)
    """Direction, any length."""

    def surface(self, rounding: float, name: str) -> TriangleSurface:
        """Its segment with its radius."""
        return capsule_surface(self.radius, self.length, self.axis, name=name)
