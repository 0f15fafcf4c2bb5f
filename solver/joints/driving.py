"""A row that follows a function of time: its targets, and the work of what drives it.

With the coordinate ``s`` of the joint, an angle or a travel, and its prescribed value ``l(t)``::

    s - l(t) = 0,    G v = (l(t+h) - l(t))/h - g/h  in the middle of a step,    G v = l'(t)  at its end
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import in_python, kernel
from heavylift.numerics.records import Record, Records, records
from heavylift.solver.drive import pack_profile, profile_value
from heavylift.solver.joints.row_writing import residuals, targets
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.scene.bodies import Profile

__all__ = ["DriveState", "aim", "drive_work", "pack_profiles"]


class DriveState(Record):
    """State of a drive.

    Attributes
    ----------
    prescribed
        Value at the end of the last step [rad] or [m].
    advance
        By how much it grew in that step.
    work
        Work before it [J].
    """

    prescribed: float
    advance: float
    work: float


def pack_profiles(
    profiles: Sequence[Profile | None],
) -> tuple[NDArray[np.float64], NDArray[np.int64], Records[DriveState]]:
    """Flat data of profiles, where each begins, and the states of their drives at time zero."""
    blocks = [pack_profile(profile) for profile in profiles]
    starts = np.concatenate([[0], np.cumsum([len(block) for block in blocks])[:-1]]).astype(np.int64)
    data = np.concatenate(blocks)
    state = records(DriveState, len(blocks))
    state["prescribed"] = [in_python(profile_value)(data, int(start), 0.0)[0] for start in starts]
    return data, starts, state


@kernel(internal=True)
def aim(
    system: RowArrays,
    block: int,
    row: int,
    profiles: NDArray[np.float64],
    start: int,
    state: DriveState,
    time: float,
    step: float,
    at_midpoint: bool,
) -> None:
    """Target of a driven row; its residual at the end of a step."""
    target = targets(system, block)
    if at_midpoint:
        # the force of a step is known after its projection, so its work is booked when the next one begins
        state.work += _last_reaction(system, block, row) * state.advance
        state.advance = 0.0
        target[row] += (profile_value(profiles, start, time + step)[0] - state.prescribed) / step
    else:
        now, speed, _ = profile_value(profiles, start, time)
        residuals(system, block)[row] += state.prescribed - now
        state.advance += now - state.prescribed
        state.prescribed = now
        target[row] = speed


@kernel(internal=True)
def drive_work(system: RowArrays, block: int, row: int, state: DriveState) -> float:
    """Work of the drive up to now [J]: in each step, force in the middle times advance."""
    return state.work + _last_reaction(system, block, row) * state.advance


@kernel(inline=True, internal=True)
def _last_reaction(system: RowArrays, block: int, row: int) -> float:
    """Reaction in the middle of the last step."""
    return system.rows[block].last_reaction[row]
