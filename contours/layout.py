"""Columns of the packed row of a contour: what evaluation and search kernels read."""

from __future__ import annotations

__all__ = [
    "CLOSED_U",
    "CLOSED_V",
    "CONTOUR_WIDTH",
    "COUNT_U",
    "COUNT_V",
    "DEGREE_U",
    "DEGREE_V",
    "KNOTS_U",
    "KNOTS_V",
    "LARGEST_DEGREE",
    "NET",
    "WEIGHTS",
]

DEGREE_U, COUNT_U, CLOSED_U, KNOTS_U, DEGREE_V, COUNT_V, CLOSED_V, KNOTS_V, NET, WEIGHTS = range(10)
"""Degree, number of distinct control points, 1 if closed, and first place in the knots, of both directions; first
row of the control points, row-major with v running fastest; first place of the rational weights, -1 without. A curve
has one control point of degree 0 in v."""

CONTOUR_WIDTH = 10

LARGEST_DEGREE = 7
"""Of a contour: scratch arrays of the kernels are made for it."""
