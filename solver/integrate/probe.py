"""What a tiny first step tells: accelerations of bodies and reactions of rows at the start.

Without them the first prediction has no acceleration, and the first record no reactions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.bodies.rigid import ACCELERATION, FREE, MOTION, SPIN_RATE, RigidBodies
from heavylift.solver.rows import LAST_REACTION, REACTION, ROW_COLUMNS

if TYPE_CHECKING:
    from heavylift.solver.layout import Layout

__all__ = ["take_rates"]


def take_rates(layout: Layout, name: str, array: NDArray[np.float64], found: NDArray[np.float64]) -> None:
    """Copy accelerations or reactions of a carried array from its state after a tiny step.

    Parameters
    ----------
    layout
        Packed scene.
    name
        ``"RigidBodies.frame"``, or the rows of a system.
    array, found
        The array, in place, and its copy after the step.
    """
    if name == "RigidBodies.frame":
        kind = next(kind for kind in layout.bodies if isinstance(kind, RigidBodies))
        free = kind.table[:, MOTION] == FREE
        columns = slice(ACCELERATION, SPIN_RATE + 3)
        array[free, columns] = found[free, columns]
        return
    lanes = len(layout.systems[0].shape[1])
    both = [REACTION, LAST_REACTION]
    array.reshape(-1, ROW_COLUMNS, lanes)[:, both] = found.reshape(-1, ROW_COLUMNS, lanes)[:, both]
