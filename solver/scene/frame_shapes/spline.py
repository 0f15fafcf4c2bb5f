"""A smooth curve through points."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Interval
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import PointsFile, Quantity, Shape
from heavylift.solver.scene.descriptions import no_rows
from heavylift.solver.scene.mesh_shapes import FRAME_SHAPES, FrameMesh, FrameShape, check_source, spline

__all__ = ["SplineShape"]


@FRAME_SHAPES.describe("spline")
@dataclass(frozen=True, eq=False, kw_only=True)
class SplineShape(FrameShape):
    """A smooth curve through points, cut into elements of equal length, or at the points."""

    ORDER: ClassVar = 3

    points: Annotated[NDArray[np.float64], Quantity("length"), Shape((None, 3))] = field(
        default_factory=no_rows
    )
    """Points on the curve, in the frame of the body [m]; two and more."""
    file: Annotated[str | None, PointsFile()] = None
    """In place of `points`, a file in the case folder: lines ``x,y,z`` [m]; ``#`` begins a comment."""
    elements: Annotated[int | None, Interval(ge=1)] = None
    """Number of elements; the points are the nodes if absent."""

    @staticmethod
    def check(spec: Any) -> None:
        """Points, here or in a file."""
        check_source(spec)
        if spec.file is None and len(spec.points) < 2:
            raise InputError(f"{len(spec.points)} points", key="points", expected="two and more points")

    def mesh(self) -> FrameMesh:
        """Elements through the points."""
        return spline(self.points, self.elements)
