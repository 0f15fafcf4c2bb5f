"""A plane quadrilateral."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Quantity, Shape
from heavylift.solver.scene.mesh_shapes import SHELL_SHAPES, ShellMesh, ShellShape, quadrilateral

__all__ = ["QuadrilateralShape"]


@SHELL_SHAPES.describe("quadrilateral")
@dataclass(frozen=True, eq=False, kw_only=True)
class QuadrilateralShape(ShellShape):
    """A plane quadrilateral with straight edges, cut into as many parts on opposite edges."""

    ORDER: ClassVar = 2

    corners: Annotated[NDArray[np.float64], Quantity("length"), Shape((4, 3))]
    """Corners ``x_min y_min``, ``x_max y_min``, ``x_max y_max``, ``x_min y_max``, in the frame of the body [m]."""
    elements: Annotated[int | tuple[int, int], Interval(ge=1)]
    """Elements along x and y; one number is both."""

    def mesh(self) -> ShellMesh:
        """Elements between lines that divide its edges equally."""
        try:
            return quadrilateral(self.corners, *self.counts(self))
        except InputError as error:
            key = "corners" if error.key == "points" else error.key
            raise InputError(error.problem, source=error.source, key=key, expected=error.expected) from None
