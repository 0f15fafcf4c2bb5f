"""A box with twelve triangles; its edges may be rounded."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.pipeline.shapes.shape import SHAPES, SurfaceShape
from heavylift.preprocess.surfaces.primitives import box_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["BoxShape"]


@SHAPES.describe("box")
@dataclass(frozen=True, eq=False, kw_only=True)
class BoxShape(SurfaceShape):
    """A box about the origin."""

    ORDER: ClassVar = 2

    size: Annotated[tuple[float, float, float], Positive("length")]
    """From face to face [m]."""

    @staticmethod
    def smallest(spec: Any) -> float:
        """Its shortest side."""
        return float(min(spec.size))

    def surface(self, rounding: float, name: str) -> TriangleSurface:
        """Its faces within the rounding."""
        return box_surface(self.size, rounding, name=name)
