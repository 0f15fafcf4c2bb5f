"""The copy of the start of a step that contacts go back to: what is carried, but only of contacts that there are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.carried import LINE
from heavylift.solver.contact.kind import ContactRows, ContactState, Slept, StoodPair
from heavylift.solver.rows.structure import ROW_VECTORS

__all__ = ["copy_carried"]

STATE_WORDS = ContactState.layout.itemsize // 8
STOOD_WORDS = StoodPair.layout.itemsize // 8
SLEPT_WORDS = Slept.layout.itemsize // 8


@kernel(internal=True)
def copy_carried(contacts: ContactRows, source: NDArray[np.float64], target: NDArray[np.float64]) -> None:
    """All that a step changes; of contacts that come and go those that were there when it began.

    Rows, states, `placed`, `stood` and `slept` of the contacts are the last parts of the carried numbers, each in whole
    cache lines. What a pair has stood like need not be taken back: it tells a pose and contacts, and holds for those.
    What has been woken stays awake when the step is repeated.
    """
    known = contacts.control.known
    whole = source.shape[0] - _lines(contacts.slept.size * SLEPT_WORDS)
    whole -= _lines(contacts.stood.size * STOOD_WORDS)
    placed = whole - _lines(contacts.placed.size)
    states = placed - _lines(contacts.state.size * STATE_WORDS)
    width = ROW_VECTORS * len(contacts.shape[1])
    rows = states - _lines(len(contacts.rows) * width)
    for i in range(rows + known * width):
        target[i] = source[i]
    for i in range(states, states + known * STATE_WORDS):
        target[i] = source[i]
    for i in range(placed, whole):
        target[i] = source[i]


@kernel(inline=True, internal=True)
def _lines(count: int) -> int:
    """So many numbers in whole cache lines."""
    return -(-count // LINE) * LINE
