"""Limits of contours, for kernels and for case files that are read without them."""

from __future__ import annotations

__all__ = ["LARGEST_DEGREE"]

LARGEST_DEGREE = 7
"""Of a contour: scratch arrays of the kernels are made for it."""
