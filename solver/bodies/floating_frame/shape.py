"""Small things that all of the kind share: where the data of one body lie (views, no copies), and the step ratio."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel, view
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies
from heavylift.solver.interface import Workspace

__all__ = ["lag_scale", "product_columns", "shape_of"]


@kernel(inline=True, internal=True)
def lag_scale(step: float, work: Workspace) -> float:
    """Square of this step relative to the last one, which the lag of a frame goes with; 1 in the first step."""
    last = work.control.last_step
    return (step / last) ** 2 if last > 0.0 else 1.0


@view
def shape_of(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Packed shape of a body, without the stacked matrices, shape (12 n,)."""
    n = kind.table[body].mode_count
    start = kind.table[body].shape_start + 8 * n * n
    return kind.constants[start : start + 12 * n]


@view
def product_columns(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Stacked product matrices of a body, column after column, shape (n 8 n,)."""
    n = kind.table[body].mode_count
    start = kind.table[body].shape_start
    return kind.constants[start : start + 8 * n * n]
