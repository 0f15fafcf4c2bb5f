"""Extremes over every step, and agreement of forces with what makes them: carried by what records a force.

A record shows an instant, and peaks lie between records. So what has a force keeps the largest and the smallest value
of the ends of all steps since the last record, and each record shows them beside the value of its instant: the extreme
of some records is that of all their steps, in any window. An interval begins with the first step behind a record; who
looks in between changes nothing.

A force that is recorded and what it follows from, say a tension and an elongation, are two expressions of one quantity.
How far they are from each other at most, and when, is kept likewise.

What stores energy elastically tells by its changes from step to step whether it takes up a motion within a few of them.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record

__all__ = [
    "Agreement",
    "Extremes",
    "Store",
    "compare_force",
    "largest_of",
    "note_stored",
    "note_value",
    "smallest_of",
]


class Extremes(Record):
    """Extremes of a value at the ends of the steps of an interval between two records.

    Attributes
    ----------
    interval
        Number of the interval that they belong to, `Control.interval`; 0 before the first step.
    highest, lowest
        Of the steps so far.
    """

    interval: int
    highest: float
    lowest: float


class Agreement(Record):
    """How far recorded forces [N, N m] were from what they should follow from.

    Attributes
    ----------
    largest
        Largest force of the records.
    miss, time, force, expected
        Largest difference, when it was [s], and both forces then.
    """

    largest: float
    miss: float
    time: float
    force: float
    expected: float


@kernel(inline=True, internal=True)
def note_value(extremes: Extremes, interval: int, value: float) -> None:
    """Take a value at the end of a step of an interval."""
    if extremes.interval != interval:
        extremes.interval = interval
        extremes.highest = extremes.lowest = value
        return
    extremes.highest = max(extremes.highest, value)
    extremes.lowest = min(extremes.lowest, value)


@kernel(inline=True, internal=True)
def largest_of(extremes: Extremes, interval: int, value: float) -> float:
    """Largest value of the interval, with that of the record itself."""
    if extremes.interval != interval or interval == 0:
        return value
    return max(extremes.highest, value)


@kernel(inline=True, internal=True)
def smallest_of(extremes: Extremes, interval: int, value: float) -> float:
    """Smallest value of the interval, with that of the record itself."""
    if extremes.interval != interval or interval == 0:
        return value
    return min(extremes.lowest, value)


@kernel(inline=True, internal=True)
def compare_force(agreement: Agreement, time: float, force: float, low: float, high: float) -> None:
    """Compare a recorded force with the range that its elongation and the mean rates of the last steps allow."""
    agreement.largest = max(agreement.largest, abs(force))
    miss = max(low - force, force - high)
    if miss > agreement.miss:
        agreement.miss, agreement.time, agreement.force = miss, time, force
        agreement.expected = low if force < low else high


class Store(Record):
    """Energy [J] that something stores, from step to step: whether steps resolve how it takes up a motion.

    Attributes
    ----------
    begun
        Whether a step has been made.
    energy
        At the end of the last step.
    largest, change
        Largest of all, and largest change within a step.
    """

    begun: bool
    energy: float
    largest: float
    change: float


@kernel(inline=True, internal=True)
def note_stored(store: Store, energy: float) -> None:
    """Take the energy at the end of a step."""
    if store.begun:
        store.change = max(store.change, abs(energy - store.energy))
    store.begun, store.energy = True, energy
    store.largest = max(store.largest, energy)
