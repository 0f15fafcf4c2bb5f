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
        self._columns = np.array(
            [c.column + i for c in found for i in range(len(c.components))], dtype=np.int64
        )
        n = len(self._columns)
        self._count = 0
        self._rows = np.zeros((2, n))
        self._largest, self._at = np.zeros((KEPT, n)), np.full((KEPT, n), -1.0)
        self._value, self._beside, self._most = np.zeros(n), np.zeros(n), np.zeros(n)

    @property
    def state(self) -> NDArray[np.float64]:
        """What a continuation needs."""
        parts = (self._rows, self._largest, self._at, self._value, self._beside, self._most)
        return np.concatenate([[float(self._count)], *(part.ravel() for part in parts)])

    @state.setter
    def state(self, values: NDArray[np.float64]) -> None:
        self._count, first = int(values[0]), 1
        for part in (self._rows, self._largest, self._at, self._value, self._beside, self._most):
            part[...] = values[first : first + part.size].reshape(part.shape)
            first += part.size

    def add(self, records: NDArray[np.float64]) -> None:
        """Look at more records behind the one of the start, shape (rows, columns)."""
        if not len(self._columns):
            return
        for row in records[:, self._columns]:
            if self._count >= 2:
                self._compare(self._rows[0], self._rows[1], row)
            self._rows[0], self._rows[1] = self._rows[1], row
            self._most = np.fmax(self._most, np.abs(row))
            self._count += 1

    def _compare(
        self, before: NDArray[np.float64], x: NDArray[np.float64], after: NDArray[np.float64]
    ) -> None:
        """Take the distances of the row in the middle."""
        a, b = x - before, x - after
        with np.errstate(invalid="ignore"):
            lone = np.where(a * b > 0.0, np.minimum(np.abs(a), np.abs(b)), 0.0)
        if not (lone > self._largest[-1]).any():
            return
        distances = np.vstack((self._largest, lone))
        order = np.argsort(-distances, axis=0, kind="stable")[:KEPT]
        places = np.vstack((self._at, np.full(len(lone), self._count - 1.0)))
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
