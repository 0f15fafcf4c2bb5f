"""What impulses of rows do to the velocities of bodies, and the power they have on them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.rows.structure import (
    DIAGONAL,
    FACTORED,
    PRESCRIBED,
    RowArrays,
)

__all__ = ["add_impulses", "add_reactions", "row_power"]


@kernel(internal=True)
def add_impulses(system: RowArrays, velocity: NDArray[np.float64], factor: float) -> None:
    """``U += factor A^-1 G^T P`` with the impulses of all rows; bodies that are nodes of the system are left out."""
    lanes = len(system.shape[1])
    half = system.panels.shape[0] // 2
    for i in range(system.attachments.shape[0]):
        holder = system.attachments[i].holder
        if holder != DIAGONAL and holder != FACTORED:  # noqa: PLR1714  a set costs time here
            continue
        dof, panel = system.attachments[i].dof, system.attachments[i].panel
        impulse = system.rows[system.attachments[i].owner].impulse
        for k in range(system.attachments[i].width):
            at = panel + k * lanes + (half if holder == FACTORED else 0)
            total = 0.0
            for r in range(lanes):
                total += system.panels[at + r] * impulse[r]
            if holder == DIAGONAL:
                total *= system.inverse_mass[dof + k]
            velocity[dof + k] += factor * total


@kernel(internal=True)
def add_reactions(system: RowArrays, force: NDArray[np.float64]) -> None:
    """``F += G^T reaction``, by velocity, shape (dof_count,), but on free rigid bodies, which nobody asks for it."""
    lanes = system.lanes
    for i in range(system.attachments.shape[0]):
        holder = system.attachments[i].holder
        if holder != PRESCRIBED and holder != FACTORED:  # noqa: PLR1714  a set costs time here
            continue
        dof, panel = system.attachments[i].dof, system.attachments[i].panel
        reaction = system.rows[system.attachments[i].owner].reaction
        for k in range(system.attachments[i].width):
            total = 0.0
            for r in range(lanes):
                total += system.panels[panel + k * lanes + r] * reaction[r]
            force[dof + k] += total


@kernel(internal=True)
def row_power(system: RowArrays, attachment: int, velocity: NDArray[np.float64]) -> float:
    """``P . G u`` of one attachment over the six velocities of its frame."""
    lanes = system.lanes
    panel, dof = system.attachments[attachment].panel, system.attachments[attachment].dof
    impulse = system.rows[system.attachments[attachment].owner].impulse
    power = 0.0
    for k in range(6):
        for r in range(lanes):
            power += system.panels[panel + k * lanes + r] * impulse[r] * velocity[dof + k]
    return power
