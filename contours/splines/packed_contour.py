"""Records of packed contours: what evaluation and search kernels read."""

from __future__ import annotations

from heavylift.numerics.records import Record

__all__ = ["PackedContour", "PackedDirection"]


class PackedDirection(Record):
    """One direction of a contour.

    Attributes
    ----------
    degree
        0 across a curve.
    count
        Number of distinct control points; 1 across a curve.
    closed
        Whether its end is its start.
    first_knot
        First place in the knots.
    """

    degree: int
    count: int
    closed: bool
    first_knot: int


class PackedContour(Record):
    """A contour in flat arrays of knots, rational weights and control points.

    Attributes
    ----------
    u, v
        Its directions. A curve has one control point of degree 0 in v.
    first_control
        First row of the control points, row-major with v running fastest.
    first_weight
        First place of the rational weights, -1 without.
    """

    u: PackedDirection
    v: PackedDirection
    first_control: int
    first_weight: int
