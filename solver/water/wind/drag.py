"""Drag on the pieces of a body, each at its own height: ``rho C A |V| V / 2`` along the relative flow."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyPoint, Least, Quantity
from heavylift.solver.scene.wind_loads import FLUID_LOADS, DragElement, FluidLoad

__all__ = ["Drag", "DragPiece"]


@FLUID_LOADS.part
@dataclass(frozen=True, eq=False, kw_only=True)
class DragPiece:
    """A piece of a body at its own height."""

    point: Annotated[NDArray[np.float64], BodyPoint()]
    """Its centre, in the coordinates of the geometry [m]."""
    area: Annotated[float | None, Quantity("area", minimum=0.0, closed=True)] = None
    """Seen from all sides the same [m^2]."""
    areas: Annotated[tuple[float, float, float] | None, Quantity("area", minimum=0.0, closed=True)] = None
    """In place of `area`, those of a box seen along the heading, across it and from above [m^2]."""
    coefficient: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 1.0
    """Shape coefficient C: the force is ``rho C A |V| V / 2`` along the relative flow."""
    vertical: bool = False
    """Whether the vertical part of the relative velocity counts as well."""
    extent: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Height of the piece [m]: of one that the water cuts, the part on its own side counts."""

    @staticmethod
    def check(spec: Any) -> None:
        """One area, or three."""
        if (spec.area is None) == (spec.areas is None):
            problem = "neither 'area' nor 'areas'" if spec.area is None else "both 'area' and 'areas'"
            raise InputError(problem, expected="one of them")


@FLUID_LOADS.describe("drag")
@dataclass(frozen=True, eq=False, kw_only=True)
class Drag(FluidLoad):
    """Drag on the pieces of a body, each at its own height."""

    elements: Annotated[tuple[DragPiece, ...], Least(1)]
    """The pieces; their forces are recorded as a sum."""

    def pieces(self) -> tuple[DragElement, ...]:
        """One element a piece."""
        return tuple(
            DragElement(
                name=self.name,
                body=self.body,
                fluid=self.fluid,
                axis=self.axis,
                point=piece.point,
                area=piece.areas or piece.area or 0.0,
                coefficient=piece.coefficient,
                vertical=piece.vertical,
                extent=piece.extent,
            )
            for piece in self.elements
        )
