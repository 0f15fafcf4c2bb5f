"""Records of packed triangle surfaces, of relative motions and of pair lists: what collision kernels read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np

from heavylift.numerics.records import Record, Vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "IS_FACE",
    "OWNS_A",
    "OWNS_AB",
    "OWNS_B",
    "OWNS_BC",
    "OWNS_C",
    "OWNS_CA",
    "BoundingBox",
    "Edge",
    "PackedSurface",
    "PairList",
    "RelativeMotion",
    "RelativePose",
    "TreeNode",
    "Triangle",
    "pose_of",
]

# every point and every edge belongs to one triangle only, so that it is tested once; a lone point or segment is no face
OWNS_A, OWNS_B, OWNS_C, OWNS_AB, OWNS_BC, OWNS_CA, IS_FACE = (1 << bit for bit in range(7))
"""Bits of the flags of a triangle."""


class Triangle(Record):
    """A triangle with corners A, B, C.

    Attributes
    ----------
    corners
        Rows of its points.
    edges
        Rows of its edges AB, BC, CA; -1: none.
    flags
        What it owns, and whether it is a face.
    surface
        Its surface.
    """

    corners: Annotated[NDArray[np.int64], (3,)]
    edges: Annotated[NDArray[np.int64], (3,)]
    flags: int
    surface: int


class Edge(Record):
    """An edge.

    Attributes
    ----------
    ends
        Rows of its points.
    triangle
        Row of one triangle that has it.
    """

    ends: Annotated[NDArray[np.int64], (2,)]
    triangle: int


class TreeNode(Record):
    """A node of the tree of a surface.

    Attributes
    ----------
    left
        Its left child, which the right one follows; -1: a leaf.
    first, count
        Its triangles.
    """

    left: int
    first: int
    count: int


class BoundingBox(Record):
    """A box along the axes of the body.

    Attributes
    ----------
    centre, half
        Centre and half lengths [m].
    """

    centre: Vector
    half: Vector


class PackedSurface(Record):
    """Where the rows of a surface are.

    Attributes
    ----------
    first_point, first_triangle, first_edge, root
        First point, triangle and edge, and the root of its tree.
    triangle_count, point_count
        How many triangles and points it has.
    """

    first_point: int
    first_triangle: int
    first_edge: int
    root: int
    triangle_count: int
    point_count: int


class RelativePose(Record):
    """Pose of surface B in the axes of A: ``x_A = R x_B + p``.

    Attributes
    ----------
    rotation
        R, row by row.
    origin
        p, of B [m].
    """

    rotation: Annotated[NDArray[np.float64], (9,)]
    origin: Vector


def pose_of(R: ArrayLike, p: ArrayLike) -> RelativePose:
    """Pose from a rotation matrix, shape (3, 3), and a position [m], shape (3,)."""
    pose = RelativePose.one()
    pose.rotation[:] = np.ravel(np.asarray(R, dtype=np.float64))
    pose.origin[:] = p
    return pose


class RelativeMotion(Record):
    """Motion of surface B in the axes of A over an interval; points move straight from its start to its end."""

    start: RelativePose
    end: RelativePose


class PairList(Record):
    """The list of a pair of surfaces.

    Attributes
    ----------
    surface_a, surface_b
        The surfaces.
    first, capacity
        Place of the list among all, and how long it may be.
    count
        How long it is; -1: none is made yet.
    traversals
        How many times it was made.
    """

    surface_a: int
    surface_b: int
    first: int
    capacity: int
    count: int
    traversals: int
