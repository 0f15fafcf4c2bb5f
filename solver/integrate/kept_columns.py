"""Columns of records that are kept until someone looks: many rows at once cost about as much as one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["KeptColumns"]

MOST = 100_000
"""Numbers that are kept before they have to be looked at."""


class KeptColumns:
    """Some columns of the records of a run, in order.

    Parameters
    ----------
    columns
        Of the records.

    Attributes
    ----------
    full
        Whether it is time to look.
    """

    def __init__(self, columns: NDArray[np.int64]) -> None:
        self._columns = columns
        self._kept: list[NDArray[np.float64]] = []
        self._rows = self._seen = 0

    def add(self, records: NDArray[np.float64]) -> None:
        """Keep a copy of more records, shape (rows, columns)."""
        if len(records) and len(self._columns):
            self._kept.append(records.take(self._columns, axis=1))
            self._rows += len(records)

    @property
    def full(self) -> bool:
        """Whether it is time to look."""
        return self._rows * len(self._columns) >= MOST

    def news(self) -> list[NDArray[np.float64]]:
        """What was added since the last call of this; it is kept all the same."""
        found, self._seen = self._kept[self._seen :], len(self._kept)
        return found

    def take(self) -> NDArray[np.float64]:
        """What is kept, which is forgotten, shape (rows, columns)."""
        kept = self._kept
        if not kept:
            return np.empty((0, len(self._columns)))
        self.forget()
        return kept[0] if len(kept) == 1 else np.concatenate(kept)

    def forget(self) -> None:
        """Keep nothing of what was added."""
        self._kept, self._rows, self._seen = [], 0, 0
