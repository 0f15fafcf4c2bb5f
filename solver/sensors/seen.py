"""Extremes of all that a sensor observes of a component, over all steps.

What it sees is a class of `heavylift.solver.scene.outputs.Outputs`. It records that, then the largest and the smallest
values of all of it (``largest: LugSeen = largest_of_all(LugSeen)``). Each number has its `Extremes`, in order.
"""

from __future__ import annotations

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records, records
from heavylift.solver.extremes import Extremes, largest_of, note_value, smallest_of
from heavylift.solver.recording import width_of
from heavylift.solver.scene.outputs import Outputs

__all__ = ["extremes_of", "note_seen", "put_seen"]


def extremes_of(seen: type[Outputs], count: int) -> Records[Extremes]:
    """Extremes of the observations of a number of components."""
    return records(Extremes, width_of(seen) * count)


@kernel(internal=True)
def note_seen(extremes: Records[Extremes], i: int, interval: int, seen: Floats1) -> None:
    """Take the observation of component `i` at the end of a step of an interval."""
    first = i * seen.shape[0]
    for k in range(seen.shape[0]):
        note_value(extremes[first + k], interval, seen[k])


@kernel(internal=True)
def put_seen(
    extremes: Records[Extremes],
    i: int,
    interval: int,
    seen: Floats1,
    shown: Floats1,
    largest: Floats1,
    smallest: Floats1,
) -> None:
    """Record the observation of component `i`, and the extremes of the interval."""
    first = i * seen.shape[0]
    for k in range(seen.shape[0]):
        shown[k] = seen[k]
        largest[k] = largest_of(extremes[first + k], interval, seen[k])
        smallest[k] = smallest_of(extremes[first + k], interval, seen[k])
