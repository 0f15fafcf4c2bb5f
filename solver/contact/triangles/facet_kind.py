"""Surfaces whose triangles deform with a frame or shell: where their points are, and what these are made of."""

from __future__ import annotations

import numpy as np

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints1
from heavylift.numerics.records import Record, Records, records

__all__ = ["FacetSurface", "FacetSurfaces"]


class FacetSurface(Record):
    """A surface.

    Attributes
    ----------
    surface
        Its number.
    dof
        First velocity of its body.
    pose
        Row of its pose, and of its contour.
    own_point, points
        Its first point in `first`, and how many it has.
    first_point
        Its first row in `points` of all surfaces.
    first_slot, last_slot
        The moving points of its body that contacts between triangles may take.
    """

    surface: int
    dof: int
    pose: int
    own_point: int
    points: int
    first_point: int
    first_slot: int
    last_slot: int


class FacetSurfaces(Arrays):
    """Surfaces on frames and shells; none, in most scenes.

    Attributes
    ----------
    rows
        The surfaces.
    row_of
        Row by contour, -1 of those that are none of these.
    points
        Of all surfaces of triangles in their axes [m], which the bodies of these write; shape (n, 3).
    first
        Of each point its place in `entries`, and the end of the last; shape (points + 1,).
    entries, factors
        A point is a sum of nodal vectors: their places behind the first node of the body, and factors.
    corners, shares
        Points that the touched point of a contact lies between, counted within its surface, and their shares; shape
        (3,).
    """

    rows: Records[FacetSurface]
    row_of: Ints1
    points: Floats2
    first: Ints1
    entries: Ints1
    factors: Floats1
    corners: Ints1
    shares: Floats1

    @classmethod
    def none(cls) -> FacetSurfaces:
        """Of scenes without."""
        return cls(
            rows=records(FacetSurface, 0),
            row_of=np.zeros(0, dtype=np.int64),
            points=np.zeros((0, 3)),
            first=np.zeros(1, dtype=np.int64),
            entries=np.zeros(0, dtype=np.int64),
            factors=np.zeros(0),
            corners=np.zeros(3, dtype=np.int64),
            shares=np.zeros(3),
        )
