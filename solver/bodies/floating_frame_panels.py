"""Panels of the rows on flexible bodies: what floating and fixed frames share."""

from __future__ import annotations

from typing import Any

from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import add_multiple, block_shape
from heavylift.solver.bodies.floating_frame import (
    FloatingFrameBodies,
)
from heavylift.solver.drive import FREE
from heavylift.solver.rows import (
    FACTORED,
    RowArrays,
)

__all__ = [
    "LANES_1",
    "LANES_2",
    "LANES_4",
    "LANES_8",
    "attached_body",
    "gather_row_forces",
    "scale_modal_panel",
]


@kernel(inline=True, internal=True)
def attached_body(kind: FloatingFrameBodies, system: RowArrays, attachment: int) -> int:
    """Row of the body that an attachment is on, -1 if that is not of this kind. Velocities grow with the rows."""
    if system.attachments[attachment].holder != FACTORED:
        return -1
    dof = system.attachments[attachment].dof
    low, high = 0, kind.table.shape[0] - 1
    while low < high:
        middle = (low + high + 1) // 2
        if kind.table[middle].dof <= dof:
            low = middle
        else:
            high = middle - 1
    return low if kind.table[low].dof == dof else -1


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


@kernel(internal=True)
def gather_row_forces(kind: FloatingFrameBodies, fresh: bool, system: RowArrays) -> None:
    """Generalised forces ``G^T reaction`` of the rows on held bodies at the carried state."""
    lanes = system.lanes
    if fresh:
        for body in range(kind.table.shape[0]):
            for k in range(6):
                kind.frame[body].joint_force[k] = 0.0
        for i in range(kind.modal_position.shape[0]):
            kind.joint_load[i] = 0.0
    for attachment in range(system.attachments.shape[0]):
        body = attached_body(kind, system, attachment)
        if body < 0 or kind.table[body].motion == FREE:
            continue
        first, panel = kind.table[body].first_mode, system.attachments[attachment].panel
        reaction = system.rows[system.attachments[attachment].owner].reaction
        for k in range(system.attachments[attachment].width):
            force = 0.0
            for r in range(lanes):
                force += system.panels[panel + k * lanes + r] * reaction[r]
            if k < 6:
                kind.frame[body].joint_force[k] += force
            else:
                kind.joint_load[first + k - 6] += force
