"""What a tiny first step tells: accelerations of bodies and reactions of rows at the start.

Without them the first prediction has no acceleration, and the first record no reactions.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.rows import LAST_REACTION, REACTION, ROW_COLUMNS

if TYPE_CHECKING:
    from heavylift.solver.layout import Layout

__all__ = ["FRAMES", "take_rates"]

FRAMES = {"RigidBodies.frame": "rigid", "FloatingFrameBodies.frame": "floating_frame"}
"""Arrays with the frames of bodies, and the module of `heavylift.solver.bodies` that names their columns."""


def take_rates(layout: Layout, name: str, array: NDArray[np.float64], found: NDArray[np.float64]) -> None:
    """Copy accelerations of frames or reactions from a carried array after a tiny step; modes start without.

    Parameters
    ----------
    layout
        Packed scene.
    name
        ``"RigidBodies.frame"``, ``"FloatingFrameBodies.frame"``, or the rows of a system.
    array, found
        The array, in place, and its copy after the step.
    """
    if name in FRAMES:
        kind = next(kind for kind in layout.bodies if f"{type(kind).__name__}.frame" == name)
        places = importlib.import_module(f"heavylift.solver.bodies.{FRAMES[name]}")
        free = kind.table[:, places.MOTION] == places.FREE
        columns = slice(places.ACCELERATION, places.SPIN_RATE + 3)
        array[free, columns] = found[free, columns]
        return
    lanes = len(layout.systems[0].shape[1])
    reactions = found.reshape(-1, ROW_COLUMNS, lanes)[:, LAST_REACTION]  # the other is extrapolated from nothing
    for column in (REACTION, LAST_REACTION):
        array.reshape(-1, ROW_COLUMNS, lanes)[:, column] = reactions
