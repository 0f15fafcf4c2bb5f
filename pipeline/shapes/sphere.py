"""A ball: a lone point with a rounding."""

from __future__ import annotations

from typing import Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.pipeline.shapes.shape import SHAPES, SurfaceShape
from heavylift.preprocess.surfaces.primitives import sphere_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["SphereShape"]


@SHAPES.describe("sphere")
@dataclass(frozen=True, eq=False, kw_only=True)
class SphereShape(SurfaceShape):
    """A ball about the origin, exactly round."""

    ORDER: ClassVar = 3
    ROUND: ClassVar = True

    radius: Annotated[float, Positive("length")]
    """[m]."""

    def surface(self, rounding: float, name: str) -> TriangleSurface:
        """Its centre with its radius."""
        return sphere_surface(self.radius, name=name)
