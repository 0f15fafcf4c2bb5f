"""What joints on frames and along edges of shells become: rows on points and slopes, for the registry."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.solver.scene.connections import Joint

__all__ = ["EdgeSeam", "FrameWeld", "Square", "SquareJoint"]


@dataclass(frozen=True, eq=False)
class Square:
    """A row ``factor c . e``: two vectors at the points of a joint that stay perpendicular to each other.

    Attributes
    ----------
    a, b
        Of either side: a unit direction in the frame of the body, or the number of a slope of a mesh.
    factor
        Makes the row an angle [rad].
    """

    a: NDArray[np.float64] | int
    b: NDArray[np.float64] | int
    factor: float = 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class SquareJoint(Joint):
    """The points coincide, and up to four pairs of vectors are perpendicular to each other.

    Attributes
    ----------
    squares
        The pairs.
    """

    WORD: ClassVar = "edge"
    """What it is in words: no joint of a case file, but one of those that an edge is made of."""

    squares: tuple[Square, ...]

    @property
    def kind_module(self) -> str:
        """See `heavylift.solver.scene.connections.Joint`."""
        return "heavylift.solver.joints.perpendicular"

    @property
    def rotational(self) -> tuple[bool, ...]:
        """Whether each row is an angle."""
        return (False,) * 3 + (True,) * len(self.squares)


@dataclass(frozen=True, eq=False, kw_only=True)
class FrameWeld(Joint):
    """Two frames: the points coincide and the tangents are parallel.

    Attributes
    ----------
    normal
        A direction across the tangents at the start, world axes, shape (3,).
    """

    WORD: ClassVar = "weld"
    """What it is in words."""
    ROTATIONAL: ClassVar = (False, False, False, True, True)

    normal: NDArray[np.float64]

    @property
    def kind_module(self) -> str:
        """See `heavylift.solver.scene.connections.Joint`."""
        return "heavylift.solver.joints.frame_weld"


@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeSeam(Joint):
    """A node on each of two edges of shells that coincide: points, slopes along the edge, angle of the surfaces.

    Attributes
    ----------
    along, across
        Number of the slope along the edge and of that across it on a, then on b.
    stretch
        What makes both slopes along the edge one unit vector, on a and on b.
    normal
        Unit normal of b in the frame of a, shape (3,); none for a hinge.
    upright
        Unit normal of a in its frame.
    twist
        Factors of the twists on a and on b which make their parts along the normals the same turn of the surface
        along an element of the edge [rad]; none if only the nodes are clamped.
    """

    WORD: ClassVar = "seam"
    """What it is in words."""

    along: tuple[int, int]
    across: tuple[int, int]
    stretch: tuple[float, float]
    normal: NDArray[np.float64] | None = None
    upright: NDArray[np.float64] | None = None
    twist: tuple[float, float] | None = None

    @property
    def kind_module(self) -> str:
        """See `heavylift.solver.scene.connections.Joint`."""
        return "heavylift.solver.joints.edge_seam"

    @property
    def rotational(self) -> tuple[bool, ...]:
        """Whether each row is an angle."""
        return (False,) * 3 + (True,) * (3 + (self.normal is not None) + (self.twist is not None))
