"""Where the data of one body lie in the arrays of its kind: views, no copies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import view
from heavylift.solver.bodies.floating_frame import (
    MID_ROTATION,
    MODES,
    SHAPE,
    SHAPE_HEAD,
    FlexibleBodies,
)

__all__ = ["product_columns", "shape_of", "stage_rotation"]


@view
def shape_of(kind: FlexibleBodies, body: int) -> NDArray[np.float64]:
    """Packed shape of a body, without the stacked matrices."""
    n = kind.table[body, MODES]
    start = kind.table[body, SHAPE] + 8 * n * n
    return kind.constants[start : start + SHAPE_HEAD + 12 * n]


@view
def product_columns(kind: FlexibleBodies, body: int) -> NDArray[np.float64]:
    """Stacked product matrices of a body, column after column, shape (n 8 n,)."""
    n = kind.table[body, MODES]
    start = kind.table[body, SHAPE]
    return kind.constants[start : start + 8 * n * n]


@view
def stage_rotation(kind: FlexibleBodies, body: int) -> NDArray[np.float64]:
    """Rotation matrix of the stage, row by row, a view of shape (9,)."""
    return kind.frame[body, MID_ROTATION : MID_ROTATION + 9]
