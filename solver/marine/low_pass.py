"""Low-passed position and heading of hulls: where the waves meet them, without their motion in these waves."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = ["advance_low_pass", "fill_place", "start_low_pass"]


@kernel(internal=True)
def start_low_pass(state: NDArray[np.float64], targets: NDArray[np.float64]) -> None:
    """Begin at rest at the targets; see `advance_low_pass`."""
    for k in range(targets.shape[0]):
        state[k, 0] = targets[k]
        state[k, 1] = 0.0
        state[k, 2] = targets[k]


@kernel(internal=True)
def advance_low_pass(
    state: NDArray[np.float64], targets: NDArray[np.float64], h: float, cutoff: float
) -> None:
    """Advance the low-passed position and heading of hulls by one step.

    Parameters
    ----------
    state
        Filtered value, its rate and the last target of each coordinate, shape (3 N, 3). The targets are carried
        without jumps, so that the yaw may pass any number of turns.
    targets
        x, y [m] and yaw [rad] of the hulls at the end of the step, shape (3 N,).
    h
        Step [s]; steps may vary.
    cutoff
        Circular frequency w [rad/s], well below the waves and above the natural frequencies of the mooring.

    Notes
    -----
    ``y'' + 2 w y' + w^2 y = w^2 u``, critically damped: it passes 1 / (1 + (omega / w)^2) of an oscillation. Exact
    for targets u that change linearly within the step, whatever its size: with ``e = y - (u - 2 u' / w)``,
    ``e(h) = (e + (e' + w e) h) exp(-w h)``.
    """
    if not h > 0.0:
        return
    turn = 6.283185307179586
    decay = math.exp(-cutoff * h)
    for k in range(targets.shape[0]):
        before = state[k, 2]
        change = targets[k] - before
        if k % 3 == 2:
            change -= turn * np.floor(change / turn + 0.5)
        slope = change / h
        error = state[k, 0] - before + 2.0 * slope / cutoff
        sum_of_both = state[k, 1] - slope + cutoff * error
        state[k, 0] = before + change - 2.0 * slope / cutoff + (error + sum_of_both * h) * decay
        state[k, 1] = slope + (sum_of_both * (1.0 - cutoff * h) - cutoff * error) * decay
        state[k, 2] = before + change


@kernel(internal=True)
def fill_place(state: NDArray[np.float64], place: NDArray[np.float64]) -> None:
    """Low-passed x, y and yaw of the hulls, shape (N, 3), from the state of the filter, shape (3 N, 3)."""
    for hull in range(place.shape[0]):
        for k in range(3):
            place[hull, k] = state[3 * hull + k, 0]
