"""Extremes that stand alone: each is compared with those of the adjacent intervals, and reported after a cut step.

Where a phase of an operation ends within a step, the step is cut, perhaps to a millionth of what it would be. What is a
difference over a step is then rounding over next to nothing, and an extreme keeps it. So of each extreme over the steps
of an interval between two records its distance from those of the intervals before and behind is taken, the smaller of
both; nothing where it lies between them. One that is many times any other of its channel, in an interval with such a
step, is no motion.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.integrate.kept_columns import KeptColumns
from heavylift.solver.scene.channels import Channel

__all__ = ["LoneExtremes"]

MANY = 30.0
"""Times the next distance of its channel, and a hundredth of that the value beside it."""

SLIVER, WHOLE = 1e-2, 1e-9
"""Part of a step, below which what an event leaves of it is a sliver, and below which it leaves nothing."""

NOTHING = 1e-9
"""Of the largest value in the unit of a channel: distances below are rounding of what stands still."""

KEPT, FEWEST = 4, 8
"""Largest distances of a channel that are kept: of the largest, of the intervals beside it, and one more; and intervals
from which on it is reported."""

NAMED = 3
"""Channels that a sentence names."""


class LoneExtremes:
    """Distances of extremes from those beside them, of all channels with the extremes of the steps of an interval.

    Parameters
    ----------
    channels
        Of the records.
    """

    def __init__(self, channels: Sequence[Channel]) -> None:
        ends = ("_max", "_min")
        found = [c for c in channels if c.name.endswith(ends)]
        self._names = [
            f"{c.name} {part}".strip() if len(c.components) > 1 else c.name
            for c in found
            for part in c.components
        ]
        self._units = [c.unit for c in found for _ in c.components]
        columns = np.array([c.column + i for c in found for i in range(len(c.components))], dtype=np.int64)
        self._waiting = KeptColumns(columns)
        n = len(columns)
        self._count = 0
        self._rows = np.zeros((2, n))
        self._largest, self._at = np.zeros((KEPT, n)), np.full((KEPT, n), -1.0)
        self._value, self._beside, self._most = np.zeros(n), np.zeros(n), np.zeros(n)

    @property
    def state(self) -> NDArray[np.float64]:
        """What a continuation needs."""
        self._look()
        parts = (self._rows, self._largest, self._at, self._value, self._beside, self._most)
        return np.concatenate([[float(self._count)], *(part.ravel() for part in parts)])

    @state.setter
    def state(self, values: NDArray[np.float64]) -> None:
        self._waiting.forget()
        self._count, first = int(values[0]), 1
        for part in (self._rows, self._largest, self._at, self._value, self._beside, self._most):
            part[...] = values[first : first + part.size].reshape(part.shape)
            first += part.size

    def add(self, records: NDArray[np.float64]) -> None:
        """Take more records behind the one of the start, shape (rows, columns): for when someone asks."""
        self._waiting.add(records)
        if self._waiting.full:
            self._look()

    def _look(self) -> None:
        found = self._waiting.take()
        if not len(found):
            return
        rows = np.vstack((self._rows, found))
        before, x, after = rows[:-2], rows[1:-1], rows[2:]
        with np.errstate(invalid="ignore", over="ignore"):
            a, b = x - before, x - after
            lone = np.where(a * b > 0.0, np.minimum(np.abs(a), np.abs(b)), 0.0)
        lone[: max(2 - self._count, 0)] = 0.0  # there is no row before
        for i in np.flatnonzero((lone > self._largest[-1]).any(axis=1)):
            self._keep(lone[i], self._count + int(i) - 1, before[i], x[i], after[i])
        self._rows[...] = rows[-2:]
        self._most = np.fmax(self._most, np.fmax.reduce(np.abs(found), axis=0))
        self._count += len(found)

    def _keep(
        self,
        lone: NDArray[np.float64],
        place: int,
        before: NDArray[np.float64],
        x: NDArray[np.float64],
        after: NDArray[np.float64],
    ) -> None:
        """Keep the distances of a row from those beside it, where they are among the largest."""
        if not (lone > self._largest[-1]).any():  # others have come before it
            return
        distances = np.vstack((self._largest, lone))
        order = np.argsort(-distances, axis=0, kind="stable")[:KEPT]
        places = np.vstack((self._at, np.full(len(lone), float(place))))
        self._largest = np.take_along_axis(distances, order, axis=0)
        self._at = np.take_along_axis(places, order, axis=0)
        new = order[0] == KEPT
        self._value[new] = x[new]
        self._beside[new] = np.maximum(np.abs(before), np.abs(after))[new]

    def warning(self, events: Iterable[float], step: float, every: int, *, steps_vary: bool = False) -> str:
        """A sentence on what stands alone where an event left a sliver of a step; empty if nothing does.

        Parameters
        ----------
        events
            Times of events [s].
        step, every
            Length of a step [s], and steps in an interval.
        steps_vary
            Whether steps are of any length: then nobody knows what an event leaves of one.
        """
        self._look()
        cut = {}
        for time in events:
            index = int(np.floor(time / step + WHOLE))
            part = time / step - index
            if steps_vary or WHOLE < part < SLIVER or part > 1.0 - SLIVER:
                cut[index // every] = time
        if self._count < FEWEST or not cut:
            return ""
        words = []
        scales = {unit: self._most[[one == unit for one in self._units]].max() for unit in set(self._units)}
        for i, name in enumerate(self._names):
            place, lone = int(self._at[0, i]), self._largest[0, i]
            others = np.abs(self._at[1:, i] - place) > 1.0
            following = float(self._largest[1:, i][others].max(initial=0.0))
            when = cut.get(place)
            # zero is what something without a load shows, and no difference over a sliver
            if (
                when is None
                or self._value[i] == 0.0
                or lone <= max(MANY * following, NOTHING * scales[self._units[i]])
                or lone <= 0.01 * MANY * self._beside[i]
            ):
                continue
            words.append(
                f"{name} is {self._value[i]:.6g} {self._units[i]} at {when:.9g} s, beside {self._beside[i]:.6g} before"
                " and behind"
            )
        if not words:
            return ""
        more = f" and {len(words) - NAMED} more" if len(words) > NAMED else ""
        return (
            f"extremes stand alone where a phase ended within a step: {'; '.join(words[:NAMED])}{more}: their"
            " values may be those of a very short step; let the phase end at a whole step, or compare with another step"
        )
