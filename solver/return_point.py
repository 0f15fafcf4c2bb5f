"""The state from which a run is repeated where its end has to be undone: copied now and then, not in every call."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["ReturnPoint"]

TIMES = 100.0
"""What the steps since the last copy cost, in copies, before the next one: copies are a hundredth of a run, and
repeating takes no more than a hundred of them and the steps of one call."""


def _differ(copy: NDArray[np.float64], array: NDArray[np.float64]) -> bool:
    return copy.shape != array.shape


class ReturnPoint:
    """A copy of all that steps change.

    Attributes
    ----------
    index
        Steps or records that were done then.
    """

    def __init__(self) -> None:
        self.index = 0
        self._copies: list[NDArray[np.float64]] = []
        self._known = False
        self._spent = self._cost = 0.0

    def is_due(self, spent: float) -> bool:
        """Whether there is none, or the steps since were dear; `spent` is the CPU time of all steps so far [s]."""
        return not self._known or spent - self._spent > TIMES * self._cost

    def forget(self) -> None:
        """Something else than steps has changed the state."""
        self._known = False

    def take(self, arrays: Sequence[NDArray[np.float64]], index: int, spent: float) -> None:
        """Copy the state after some steps."""
        begin = time.thread_time()
        copies = self._copies
        if len(copies) != len(arrays) or any(map(_differ, copies, arrays)):
            self._copies = copies = [np.empty_like(array) for array in arrays]
        for copy, array in zip(copies, arrays, strict=True):
            copy[...] = array  # a third of the time of `copyto`
        self._cost = time.thread_time() - begin
        self.index, self._spent, self._known = index, spent, True

    def put_back(self, arrays: Sequence[NDArray[np.float64]]) -> None:
        """Make the state what it was; of what there were fewer rows these, from the first one on."""
        for copy, array in zip(self._copies, arrays, strict=True):
            np.copyto(array[: len(copy)], copy)
