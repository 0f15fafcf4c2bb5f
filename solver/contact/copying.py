"""The copy of the start of a step that contacts go back to: what is carried, but only of contacts that there are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.solver.carried import LINE
from heavylift.solver.contact.counts import contact_count
from heavylift.solver.contact.kind import ContactRows, ContactState, Slept, StoodPair
from heavylift.solver.contact.solve.asleep import rests
from heavylift.solver.rows.structure import ROW_VECTORS

__all__ = ["put_back", "save"]

STATE_WORDS = ContactState.layout.itemsize // 8
STOOD_WORDS = StoodPair.layout.itemsize // 8
SLEPT_WORDS = Slept.layout.itemsize // 8


@kernel(internal=True)
def save(contacts: ContactRows) -> None:
    """Copy what is carried; of contacts at rest, whose sum of impulses alone a step changes, only that."""
    contacts.control.known = contact_count(contacts)
    for c in range(contacts.control.known):
        contacts.held[c].rests = rests(contacts, c)
        contacts.held[c].impulse = contacts.state[c].impulse
    _copy(contacts, contacts.carried, contacts.saved)


@kernel(internal=True)
def put_back(contacts: ContactRows) -> None:
    """The copy; also where a contact has been at rest that no longer is."""
    _copy(contacts, contacts.saved, contacts.carried)
    for c in range(contacts.control.known):
        if contacts.held[c].rests:
            contacts.state[c].impulse = contacts.held[c].impulse


@kernel(internal=True)
def _copy(contacts: ContactRows, source: NDArray[np.float64], target: NDArray[np.float64]) -> None:
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
    for i in range(rows):
        target[i] = source[i]
    first = 0
    while first < known:  # those in a row that are copied
        if contacts.held[first].rests:
            first += 1
            continue
        last = first
        while last < known and not contacts.held[last].rests:
            last += 1
        for i in range(rows + first * width, rows + last * width):
            target[i] = source[i]
        for i in range(states + first * STATE_WORDS, states + last * STATE_WORDS):
            target[i] = source[i]
        first = last
    for i in range(placed, whole):
        target[i] = source[i]


@kernel(inline=True, internal=True)
def _lines(count: int) -> int:
    """So many numbers in whole cache lines."""
    return -(-count // LINE) * LINE
