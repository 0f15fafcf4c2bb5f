"""What every shape of a surface has, and the boxes that leave out some of its triangles."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.quantity import Positive, Quantity, Shape
from heavylift.preprocess.surfaces.exclusion import ExclusionBox
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.scene.contacts import Turn
from heavylift.solver.scene.descriptions import Family

__all__ = ["SHAPES", "Exclusion", "SurfaceShape"]

SHAPES: Family[Any] = Family("shape", "heavylift.pipeline.shapes")
"""Simple shapes, by their types in a case file."""


class SurfaceShape(ABC):
    """Base of the description of a shape about its own origin."""

    ORDER: ClassVar[float] = math.inf
    """Place in lists; those without one follow by the alphabet."""
    ROUND: ClassVar = False
    """Whether it is exactly round: it has a rounding of its own, and no triangles that could be left out."""

    @staticmethod
    def smallest(spec: Any) -> float:  # noqa: ARG004
        """Smallest size [m], within which its edges are rounded; infinite for a rounding that is added to it."""
        return math.inf

    @abstractmethod
    def surface(self, rounding: float, name: str) -> TriangleSurface:
        """Its triangles.

        Parameters
        ----------
        rounding
            Radius of its edges, or half its thickness [m].
        name
            Of the surface, for messages.
        """


@SHAPES.part
@dataclass(frozen=True, eq=False, kw_only=True)
class Exclusion:
    """A box that moves with the body: triangles completely on one side of it are excluded from collisions."""

    centre: Annotated[NDArray[np.float64], Quantity("length"), Shape((3,))]
    """In the coordinates of the geometry; of the ground in the world [m]."""
    size: Annotated[tuple[float, float, float], Positive("length")]
    """From face to face [m]."""
    turned: Turn | None = None
    """How its axes are turned from those of the body; not at all if absent."""
    keep: Literal["outside", "inside"] = "outside"
    """``outside``: triangles that lie wholly in the box take no part; ``inside``: triangles that lie wholly outside of
    all such boxes are excluded. Triangles cut by the sides of a box are kept."""

    @property
    def box(self) -> ExclusionBox:
        """The box, and the side on which triangles are excluded."""
        axes = np.eye(3) if self.turned is None else self.turned.matrix
        return ExclusionBox(self.centre, np.array(self.size), axes, self.keep == "outside")
