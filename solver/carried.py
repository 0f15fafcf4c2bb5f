"""What outlives a step: the arrays of the kinds that a checkpoint keeps, and one array that holds all of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.small import aligned

__all__ = ["CARRIED", "LINE", "share_state"]

CARRIED = (
    "frame",
    "modal_position",
    "modal_velocity",
    "modal_acceleration",
    "joint_load",
    "position_products",
    "velocity_products",
    "acceleration_products",
    "rows",
    "state",
    "progress",
    "nodes",
    "body",
    "position",
    "velocity",
    "mean_acceleration",
    "trial_position",
    "strain",
    "placed",
    "tanks",
    "memory_state",
    "wraps",
)
"""Fields of kinds that outlive a step."""

LINE = 8
"""Numbers in a cache line, which each array fills to its end."""


def share_state(
    groups: tuple[tuple[Any, ...], ...],
) -> tuple[tuple[tuple[Any, ...], ...], NDArray[np.float64]]:
    """Put all carried arrays of some tuples of kinds into one, so that a step can be taken back by one copy.

    Parameters
    ----------
    groups
        Tuples of kinds.

    Returns
    -------
    groups
        The same kinds, their carried arrays views of one array.
    carried
        That array.
    """
    sizes = [
        _lines(getattr(kind, field))
        for kinds in groups
        for kind in kinds
        for field in CARRIED
        if field in kind._fields
    ]
    whole = aligned(max(1, sum(sizes)))
    start = 0
    made = []
    for kinds in groups:
        changed = []
        for kind in kinds:
            views: dict[str, NDArray[Any]] = {}
            for field in CARRIED:
                if field in kind._fields:
                    old = getattr(kind, field)
                    memory = whole[start : start + old.nbytes // whole.itemsize]
                    views[field] = memory.view(old.dtype).reshape(old.shape)
                    views[field][...] = old
                    start += _lines(old)
            replaced = kind._replace(**views)
            # parts of a kind that have a state of their own keep it in that of the kind
            changed.append(replaced.sharing_state() if hasattr(replaced, "sharing_state") else replaced)
        made.append(tuple(changed))
    return tuple(made), whole


def _lines(array: NDArray[Any]) -> int:
    """Words of an array of numbers or records, to the end of its last cache line."""
    return -(-(array.nbytes // 8) // LINE) * LINE
