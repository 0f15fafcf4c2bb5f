"""The kind of surfaces whose triangles deform with a frame or shell."""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.arrays import Arrays, Floats1, Ints1
from heavylift.numerics.records import Record, Records

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
        Row of its pose.
    own_point, points
        Its first point in `first`, and how many it has.
    first_slot, last_slot
        The moving points of its body that contacts between triangles may take.
    """

    surface: int
    dof: int
    pose: int
    own_point: int
    points: int
    first_slot: int
    last_slot: int


class FacetSurfaces(Arrays):
    """Surfaces on frames and shells.

    Attributes
    ----------
    rows
        The surfaces.
    row_of
        Row of each surface of the scene, -1 of those that are rigid.
    first
        Of each point its place in `entries`, and the end of the last; shape (points + 1,).
    entries, factors
        A point is a sum of nodal vectors: their places behind the first node of the body, and factors.
    corners, shares
        Points that the touched point of a contact lies between, counted within its surface, and their shares; shape
        (3,).
    """

    kernel_modules: ClassVar[tuple[str, ...]] = ("heavylift.solver.contact.mesh_facets",)

    rows: Records[FacetSurface]
    row_of: Ints1
    first: Ints1
    entries: Ints1
    factors: Floats1
    corners: Ints1
    shares: Floats1
