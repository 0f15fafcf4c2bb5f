"""The kind of surfaces whose triangles deform with a frame or shell."""

from __future__ import annotations

from typing import ClassVar

from heavylift.numerics.arrays import Arrays, Floats1, Ints1, Ints2

__all__ = ["FacetSurfaces"]

# columns of `rows`: a row is a surface
OF_SURFACE, OF_DOF, OF_POSE, OWN_POINT, POINTS, FIRST_SLOT, LAST_SLOT, ROW_COLUMNS = range(8)
"""Its number; first velocity of its body; row of its pose; its first point in `first`, and how many it has; the moving
points of its body that contacts between triangles may take."""


class FacetSurfaces(Arrays):
    """Surfaces on frames and shells.

    Attributes
    ----------
    rows
        See the columns; shape (n, 7).
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

    rows: Ints2
    row_of: Ints1
    first: Ints1
    entries: Ints1
    factors: Floats1
    corners: Ints1
    shares: Floats1
