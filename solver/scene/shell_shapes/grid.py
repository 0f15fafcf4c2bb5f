"""A plane mesh through given points."""

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
from heavylift.solver.scene.mesh_shapes import SHELL_SHAPES, ShellMesh, ShellShape, check_source, grid

__all__ = ["GridShape"]


@SHELL_SHAPES.describe("grid")
@dataclass(frozen=True, eq=False, kw_only=True)
class GridShape(ShellShape):
    """A plane mesh of quadrilaterals through given points."""

    ORDER: ClassVar = 3

    points: Annotated[NDArray[np.float64], Quantity("length"), Shape((None, 3))] = field(
        default_factory=no_rows
    )
    """Nodes row after row, x running first, in the frame of the body [m]."""
    file: Annotated[str | None, PointsFile()] = None
    """In place of `points`, a file in the case folder: lines ``x,y,z`` [m]; ``#`` begins a comment."""
    elements: Annotated[int | tuple[int, int], Interval(ge=1)]
    """Elements along x and y; one more point than this in each direction."""

    @staticmethod
    def check(spec: Any) -> None:
        """Points, here or in a file, one more than elements."""
        check_source(spec)
        if spec.file is None:
            _check_number(len(spec.points), *ShellShape.counts(spec))

    def mesh(self) -> ShellMesh:
        """Elements between the points."""
        nx, ny = self.counts(self)
        _check_number(len(self.points), nx, ny)
        return grid(self.points.reshape(ny + 1, nx + 1, 3).swapaxes(0, 1))


def _check_number(points: int, nx: int, ny: int) -> None:
    if points != (nx + 1) * (ny + 1):
        raise InputError(
            f"{points} points for {nx} x {ny} elements",
            key="points",
            expected=f"{(nx + 1) * (ny + 1)}, one more than elements in each direction",
        )
