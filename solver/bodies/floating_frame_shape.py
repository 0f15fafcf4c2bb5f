"""Small things that all of the kind share: where the data of one body lie (views, no copies), and the step ratio."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel, view
from heavylift.solver.bodies.floating_frame import (
    MID_ROTATION,
    MODES,
    SHAPE,
    SHAPE_HEAD,
    FlexibleBodies,
)
from heavylift.solver.interface import Workspace

__all__ = ["lag_scale", "product_columns", "shape_of", "stage_rotation"]


@kernel(inline=True, internal=True)
def lag_scale(step: float, work: Workspace) -> float:
    """Square of this step relative to the last one, which the distance `LAG` goes with; 1 in the first step."""
    last = work.control.last_step
    return (step / last) ** 2 if last > 0.0 else 1.0


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
