"""The text of the four-file interface: number tables with every fault named by file and line."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["EntryTable", "NumberTable", "read_entries", "read_table", "write_entries", "write_table"]


class NumberTable(NamedTuple):
    """Rows of numbers and the line each stands on."""

    values: NDArray[np.float64]  # (rows, columns)
    lines: NDArray[np.int64]  # (rows,), one-based


class EntryTable(NamedTuple):
    """Entries of a sparse matrix, one a line."""

    rows: NDArray[np.int64]  # zero-based degree of freedom
    columns: NDArray[np.int64]
    values: NDArray[np.float64]
    lines: NDArray[np.int64]


def read_table(path: Path, columns: int | None = None) -> NumberTable:
    """Read white-space or comma separated numbers, the same count on every line.

    Parameters
    ----------
    path
        The file; blank lines are skipped.
    columns
        Numbers a line; None takes the count of the first line.

    Raises
    ------
    InputError
        A missing, empty or binary file, a line with another count, a word that is not a finite number.
    """
    try:
        text = path.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError) as error:
        problem = "cannot be read as text" if isinstance(error, UnicodeDecodeError) else _reason(error)
        raise InputError(problem, source=path, expected="a text file of numbers") from error
    rows = [line.split() for line in text.replace(",", " ").splitlines()]
    lines = np.array([number for number, row in enumerate(rows, start=1) if row], dtype=np.int64)
    rows = [row for row in rows if row]
    if not rows:
        raise InputError("is empty", source=path, expected="rows of numbers")
    width = columns or len(rows[0])
    for row, line in zip(rows, lines, strict=True):
        if len(row) != width:
            raise InputError(
                f"{len(row)} numbers: {' '.join(row[:8])!r}",
                source=path,
                key=f"line {line}",
                expected=f"{width} numbers on every line",
            )
    try:
        flat = np.fromiter(map(float, chain.from_iterable(rows)), dtype=np.float64, count=len(rows) * width)
    except ValueError:
        _refuse_word(path, rows, lines)
        raise
    if not np.isfinite(flat).all():
        _refuse_word(path, rows, lines)
    return NumberTable(flat.reshape(-1, width), lines)


def _reason(error: OSError) -> str:
    return "does not exist" if isinstance(error, FileNotFoundError) else f"cannot be read: {error.strerror}"


def _refuse_word(path: Path, rows: Sequence[Sequence[str]], lines: NDArray[np.int64]) -> None:
    """Raise for the first word that is not a finite number."""
    for row, line in zip(rows, lines, strict=True):
        for word in row:
            try:
                good = bool(np.isfinite(float(word)))
            except ValueError:
                good = False
            if not good:
                raise InputError(f"{word!r}", source=path, key=f"line {line}", expected="a finite number")


def read_entries(path: Path, node_count: int) -> EntryTable:
    """Read lines ``i,a, j,b, value``: the entry between direction a of node i and direction b of node j.

    Raises
    ------
    InputError
        Besides the errors of `read_table`: a node that is not a whole number from 1 to `node_count`, a
        direction other than 1, 2, 3, an entry given twice.
    """
    table = read_table(path, 5)
    labels = table.values[:, :4]
    for column, what, highest in ((0, "node", node_count), (1, "direction", 3)):
        for k in (column, column + 2):
            wrong = np.flatnonzero((labels[:, k] < 1) | (labels[:, k] > highest) | (labels[:, k] % 1 != 0))
            if wrong.size:
                raise InputError(
                    f"{what} {labels[wrong[0], k]:g}",
                    source=path,
                    key=f"line {table.lines[wrong[0]]}",
                    expected=f"a whole number from 1 to {highest}"
                    + (" (the rows of the node file)" if what == "node" else ""),
                )
    index = labels.astype(np.int64) - 1
    rows, columns = 3 * index[:, 0] + index[:, 1], 3 * index[:, 2] + index[:, 3]
    keys = rows * (3 * node_count) + columns
    order = np.argsort(keys, kind="stable")
    twice = np.flatnonzero(np.diff(keys[order]) == 0)
    if twice.size:
        first, second = table.lines[order[twice[0]]], table.lines[order[twice[0] + 1]]
        raise InputError(
            f"repeats the entry of line {first}",
            source=path,
            key=f"line {second}",
            expected="every entry once",
        )
    return EntryTable(rows, columns, table.values[:, 4], table.lines)


def write_table(path: Path, values: NDArray[np.float64]) -> None:
    """Write rows of numbers with 17 digits, so that reading gives the same bits."""
    template = " ".join(["%24.16e"] * values.shape[1])
    path.write_text("".join(template % tuple(row) + "\n" for row in values.tolist()), encoding="ascii")


def write_entries(
    path: Path, rows: NDArray[np.int64], columns: NDArray[np.int64], values: NDArray[np.float64]
) -> None:
    """Write entries by zero-based degrees of freedom as lines ``i,a, j,b, value``, with 17 digits."""
    row_node, row_direction = np.divmod(rows, 3)
    column_node, column_direction = np.divmod(columns, 3)
    entries = zip(
        (row_node + 1).tolist(),
        (row_direction + 1).tolist(),
        (column_node + 1).tolist(),
        (column_direction + 1).tolist(),
        values.tolist(),
        strict=True,
    )
    text = "".join(f"{i},{a}, {j},{b}, {value:24.16e}\n" for i, a, j, b, value in entries)
    path.write_text(text, encoding="ascii")
