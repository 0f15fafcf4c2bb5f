"""Boxes around the paths of features, as tuples: lowest coordinates [m], then highest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.surface_layout import BOX_CENTRE, BOX_HALF
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["apart", "box_around", "box_of", "stored_box"]

Vector = tuple[float, float, float]
Box = tuple[float, float, float, float, float, float]


@kernel(inline=True, internal=True)
def box_of(p: Vector, q: Vector, margin: float) -> Box:
    """Lowest and highest coordinates [m] of two points, grown by a margin."""
    return (
        min(p[0], q[0]) - margin,
        min(p[1], q[1]) - margin,
        min(p[2], q[2]) - margin,
        max(p[0], q[0]) + margin,
        max(p[1], q[1]) + margin,
        max(p[2], q[2]) + margin,
    )


@kernel(inline=True, internal=True)
def box_around(a: Box, b: Box) -> Box:
    """Box around two boxes."""
    return (
        min(a[0], b[0]),
        min(a[1], b[1]),
        min(a[2], b[2]),
        max(a[3], b[3]),
        max(a[4], b[4]),
        max(a[5], b[5]),
    )


@kernel(inline=True, internal=True)
def apart(a: Box, b: Box) -> bool:
    """Whether two boxes have no point in common."""
    # no short cuts: six comparisons cost less than a branch that is guessed wrong
    return (a[0] > b[3]) | (a[3] < b[0]) | (a[1] > b[4]) | (a[4] < b[1]) | (a[2] > b[5]) | (a[5] < b[2])


@kernel(inline=True, internal=True)
def stored_box(boxes: NDArray[np.float64], row: int) -> Box:
    """Box from centre and half lengths."""
    x, y, z = boxes[row, BOX_CENTRE], boxes[row, BOX_CENTRE + 1], boxes[row, BOX_CENTRE + 2]
    u, v, w = boxes[row, BOX_HALF], boxes[row, BOX_HALF + 1], boxes[row, BOX_HALF + 2]
    return x - u, y - v, z - w, x + u, y + v, z + w
