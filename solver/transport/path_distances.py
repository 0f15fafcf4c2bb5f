"""How far along a path a vehicle is at a time: pieces of constant acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = ["way_on_pieces"]


@kernel(internal=True)
def way_on_pieces(
    pieces: NDArray[np.float64], first: int, count: int, time: float
) -> tuple[float, float, float]:
    """Way, speed and acceleration at a time.

    Parameters
    ----------
    pieces
        Time [s], way [m], speed [m/s] and acceleration [m/s2] from which on each holds, shape (n, 4); before the first
        one the vehicle stands where that begins.
    first, count
        Pieces of this path.
    time
        [s].

    Returns
    -------
    way, speed, acceleration
        [m], [m/s], [m/s2].
    """
    i = first
    while i + 1 < first + count and pieces[i + 1, 0] <= time:
        i += 1
    t = max(time - pieces[i, 0], 0.0)
    way, speed, acceleration = pieces[i, 1], pieces[i, 2], pieces[i, 3]
    return way + t * (speed + 0.5 * t * acceleration), speed + t * acceleration, acceleration
