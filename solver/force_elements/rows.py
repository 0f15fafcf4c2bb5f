"""Rows with a law: their force depends on their own rate, and the row is fitted to it by iteration.

A law says the force ``F(u)`` against the rate u of a row in the middle of the step, growing with u. About
a rate u it is the row of a spring and a damper::

    F(u) + F'(u) (G v - u) = -(2/h) P     so    Z = 2/(h F'),    target = u - F/F'

and where the force does not change, a softness beyond all others makes P independent of the velocity.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.solver.interface import Workspace
from heavylift.solver.rows.structure import (
    REGULARISATION,
    RowArrays,
)

__all__ = [
    "FREE_SOFTNESS",
    "ROWS_A_BLOCK",
    "check_drift",
    "fit_law",
    "fit_row_law",
    "law_impulse",
    "put_law",
    "put_residual",
    "put_row_law",
    "put_stick",
    "rate_of_row",
    "row_rate",
]

FREE_SOFTNESS = 1e20
"""Softness relative to the characteristic inverse mass of a row whose force is given."""

ROWS_A_BLOCK = 8
"""Rows of one rope in a block of the system at most, as many as the largest has; more go on in the next one."""

RETURN = 0.001
"""Part of the drift of a carried elongation that goes back each step, where that takes energy and gives none.

Elongations are carried by the rate of the row, because only then their energy is that of the step; they
leave the geometry with the third power of the step. Without a return a rope that swings for hours and is
never slack would creep.
"""

NOT_CLOSED = int(Outcome.NOT_CLOSED)

FITTED = 1e-13
"""Relative miss of a force or a row that counts as fitted."""


@kernel(inline=True, internal=True)
def rate_of_row(system: RowArrays, first: int, last: int, row: int, velocity: NDArray[np.float64]) -> float:
    """``G v`` of a row of the attachments first ... last - 1."""
    lanes = system.lanes
    u = 0.0
    for i in range(first, last):
        dof, panel = system.attachments[i].dof, system.attachments[i].panel + row
        for k in range(system.attachments[i].width):
            u += system.panels[panel + k * lanes] * velocity[dof + k]
    return u


@kernel(inline=True, internal=True)
def row_rate(system: RowArrays, first: int, last: int, velocity: NDArray[np.float64]) -> float:
    """``G v`` of the first row of the attachments first ... last - 1."""
    return rate_of_row(system, first, last, 0, velocity)


@kernel(inline=True, internal=True)
def put_residual(system: RowArrays, block: int, value: float) -> None:
    """Residual of the first row of a block."""
    system.rows[block].residual[0] = value


@kernel(inline=True, internal=True)
def law_impulse(system: RowArrays, block: int) -> float:
    """Impulse of the first row of a block in the stage."""
    return system.rows[block].impulse[0]


@kernel(inline=True, internal=True)
def check_drift(block: int, drift: float, largest: float, work: Workspace) -> None:
    """Refuse a step after which a carried elongation has nothing to do with the geometry any more.

    Energies and forces are those of what is carried, so nothing else would tell.
    """
    if not abs(drift) <= largest:
        work.status.outcome = NOT_CLOSED
        work.status.block = block


@kernel(internal=True)
def put_row_law(
    system: RowArrays, block: int, row: int, h: float, u: float, force: float, slope: float
) -> None:
    """Fit a row of a block to a force and its derivative at a rate u."""
    softest = FREE_SOFTNESS * system.rows[block].scale[row]
    softness, target = softest, -0.5 * h * force * softest
    if 0.5 * h * slope * softest > 1.0:
        softness, target = 2.0 / (h * slope), u - force / slope
    system.rows[block].softness[row] = softness
    system.rows[block].target[row] = target


@kernel(inline=True, internal=True)
def put_law(system: RowArrays, block: int, h: float, u: float, force: float, slope: float) -> None:
    """`put_row_law` of the first row."""
    put_row_law(system, block, 0, h, u, force, slope)


@kernel(internal=True)
def put_stick(system: RowArrays, block: int) -> None:
    """Make the first row of a block a rigid one whose rate is zero."""
    system.rows[block].softness[0] = REGULARISATION * system.rows[block].scale[0]
    system.rows[block].target[0] = 0.0


@kernel(internal=True)
def fit_row_law(
    system: RowArrays, block: int, row: int, h: float, u: float, force: float, slope: float, work: Workspace
) -> None:
    """As `put_row_law`, if impulse and row do not fit the law yet; counts it."""
    rows = system.rows[block]
    miss = abs(rows.impulse[row] + 0.5 * h * force)
    if miss <= FITTED * 0.5 * h * (abs(force) + slope * abs(u)):
        return
    old_softness, old_target = rows.softness[row], rows.target[row]
    put_row_law(system, block, row, h, u, force, slope)
    moved = abs(rows.softness[row] - old_softness) > FITTED * old_softness
    if moved or abs(rows.target[row] - old_target) > FITTED * (abs(old_target) + abs(u)):
        work.control.changed += 1
        work.status.block = block  # named if the iteration does not end


@kernel(inline=True, internal=True)
def fit_law(
    system: RowArrays, block: int, h: float, u: float, force: float, slope: float, work: Workspace
) -> None:
    """`fit_row_law` of the first row."""
    fit_row_law(system, block, 0, h, u, force, slope, work)
