"""A rectangle."""

from __future__ import annotations

from typing import Annotated, ClassVar

from annotated_types import Interval

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive
from heavylift.solver.scene.mesh_shapes import SHELL_SHAPES, ShellMesh, ShellShape, rectangle

__all__ = ["RectangleShape"]


@SHELL_SHAPES.describe("rectangle")
@dataclass(frozen=True, eq=False, kw_only=True)
class RectangleShape(ShellShape):
    """A rectangle in the x-y plane of the body, its corner ``x_min y_min`` at the origin, cut into equal elements."""

    ORDER: ClassVar = 1

    size: Annotated[tuple[float, float], Positive("length")]
    """Along x and y [m]."""
    elements: Annotated[int | tuple[int, int], Interval(ge=1)]
    """Elements along x and y; one number is both."""

    def mesh(self) -> ShellMesh:
        """Equal elements."""
        return rectangle(*self.size, *self.counts(self))
