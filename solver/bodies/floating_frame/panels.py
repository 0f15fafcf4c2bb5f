"""Panels of the rows on flexible bodies: modal rows of ``A^-1 G^T``."""

from __future__ import annotations

from typing import Any

from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import add_multiple, block_shape
from heavylift.solver.bodies.floating_frame.kind import FloatingFrameBodies
from heavylift.solver.rows.structure import RowArrays

__all__ = [
    "LANES_1",
    "LANES_2",
    "LANES_4",
    "LANES_8",
    "scale_modal_panel",
]


LANES_1, LANES_2, LANES_4, LANES_8 = (block_shape(lanes) for lanes in (1, 2, 4, 8))
"""Block shapes by their lanes: what bodies do with panels is compiled for each of them."""


@kernel(internal=True)
def scale_modal_panel(kind: FloatingFrameBodies, body: int, system: RowArrays, attachment: int) -> None:
    """Modal rows of X: those of G times the inverse diagonal of the modes; frame rows zero."""
    if system.lanes == 1:
        _scale_modal_panel(LANES_1, kind, body, system, attachment)
    elif system.lanes == 2:
        _scale_modal_panel(LANES_2, kind, body, system, attachment)
    elif system.lanes == 4:
        _scale_modal_panel(LANES_4, kind, body, system, attachment)
    else:
        _scale_modal_panel(LANES_8, kind, body, system, attachment)


@kernel(internal=True)
def _scale_modal_panel(
    shape: Any, kind: FloatingFrameBodies, body: int, system: RowArrays, attachment: int
) -> None:
    G = system.panels
    lanes = len(shape[1])
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    panel = system.attachments[attachment].panel
    out = G.shape[0] // 2 + panel
    for r in range((6 + n) * lanes):
        G[out + r] = 0.0
    for i in range(n):
        at = (6 + i) * lanes
        add_multiple(shape, G, out + at, G, panel + at, kind.inverse_diagonal, first + i)
