"""Sparse matrices of a few hundred rows that are looked at, not multiplied."""

from __future__ import annotations

from typing import Self

import numpy as np
from numpy.typing import NDArray

__all__ = ["SparseRows"]


class SparseRows:
    """A matrix by its rows, as `scipy.sparse.csr_array` holds one: its import takes longer than a small scene.

    Parameters
    ----------
    values, rows, columns
        Entries in any order, shape (n,); those of one place are added.
    shape
        Of the matrix.

    Attributes
    ----------
    data, indices, indptr
        Entries and their columns by rows, columns ascending; where the entries of each row begin.
    """

    def __init__(
        self,
        values: NDArray[np.float64],
        rows: NDArray[np.int64],
        columns: NDArray[np.int64],
        shape: tuple[int, int],
    ) -> None:
        key = np.asarray(rows, dtype=np.int64) * shape[1] + columns
        places, entry = np.unique(key, return_inverse=True)
        self.shape = shape
        self.data = np.bincount(entry.reshape(-1), weights=values, minlength=len(places)).astype(np.float64)
        self.indices = places % max(shape[1], 1)
        self.indptr = np.searchsorted(places, np.arange(shape[0] + 1) * shape[1]).astype(np.int64)

    @property
    def rows(self) -> NDArray[np.int64]:
        """Row of each entry."""
        return np.repeat(np.arange(self.shape[0]), np.diff(self.indptr))

    def part(self, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Self:
        """Some rows and columns, each once, in the given order."""
        at_row, at_column = np.full(self.shape[0], -1), np.full(self.shape[1], -1)
        at_row[rows], at_column[columns] = np.arange(len(rows)), np.arange(len(columns))
        row, column = at_row[self.rows], at_column[self.indices]
        kept = (row >= 0) & (column >= 0)
        return type(self)(self.data[kept], row[kept], column[kept], (len(rows), len(columns)))

    def unit_rows(self) -> Self:
        """Rows divided by their lengths, without entries that are 0."""
        rows = self.rows
        norm = np.sqrt(np.bincount(rows, weights=self.data * self.data, minlength=self.shape[0]))
        norm[norm == 0.0] = 1.0
        found = self.data != 0.0
        return type(self)(
            (1.0 / norm)[rows[found]] * self.data[found], rows[found], self.indices[found], self.shape
        )

    def toarray(self) -> NDArray[np.float64]:
        """All of it."""
        dense = np.zeros(self.shape)
        dense[self.rows, self.indices] = self.data
        return dense
