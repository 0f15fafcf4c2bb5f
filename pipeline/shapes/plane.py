"""A rectangle, for floors and walls; both sides of it can be touched."""

from __future__ import annotations

from typing import Annotated, ClassVar

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.pipeline.shapes.shape import SHAPES, SurfaceShape
from heavylift.preprocess.surfaces.primitives import plane_surface
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["PlaneShape"]


@SHAPES.describe("plane")
@dataclass(frozen=True, eq=False, kw_only=True)
class PlaneShape(SurfaceShape):
    """A rectangle about the origin, in the plane of x and y."""

    ORDER: ClassVar = 1

    size: Annotated[tuple[float, float], Positive("length")]
    """Along x and y [m]."""

    def surface(self, rounding: float, name: str) -> TriangleSurface:
        """Two triangles with a rounding."""
        plane = plane_surface(self.size, name=name)
        return TriangleSurface(plane.points, plane.triangles, rounding, name)
