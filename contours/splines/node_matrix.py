"""Nodes of a contour as numbers in a file: ``[1,2,3;4,5,6]``, counted from 1, one row of nodes after the other.

The format of "Deformable bodies ... sliding contacts" (2014), eq. 3.24. A curve is one row or one column.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["node_matrix", "node_row", "read_node_matrix", "read_node_row"]

EXPECTED = "rows of node numbers such as [1,2,3;4,5,6]"


def read_node_matrix(path: Path | str, node_count: int, name: str = "") -> NDArray[np.int64]:
    """Node matrix of a surface from a file.

    Parameters
    ----------
    path
        Text: numbers from 1, commas or blanks between them, semicolons or line ends between rows, brackets around all
        if wanted; ``%`` and ``#`` begin a comment.
    node_count
        Nodes of the body.
    name
        Of the file in messages; the path if absent.

    Returns
    -------
    NDArray
        Indices from 0, shape (a, b).

    Raises
    ------
    InputError
        A file that cannot be read, an entry that is no number or missing, rows of different lengths, a node that the
        body has not, a node that stands twice.
    """
    source = name or str(path)
    return node_matrix(_rows(path, source), node_count, source)


def read_node_row(path: Path | str, node_count: int, name: str = "") -> NDArray[np.int64]:
    """Nodes of a curve from a file; see `read_node_matrix`.

    Returns
    -------
    NDArray
        Indices from 0, shape (k,).

    Raises
    ------
    InputError
        As of `read_node_matrix`, and more than one row and one column.
    """
    source = name or str(path)
    return node_row(_rows(path, source), node_count, source)


def _rows(path: Path | str, source: str) -> list[list[int]]:
    """Numbers in a file, as they stand."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise InputError(f"cannot be read: {reason}", source=source, expected=EXPECTED) from None
    text = re.sub(r"[%#].*", "", text).strip()
    if text.startswith("[") != text.endswith("]"):
        raise InputError("has one bracket", source=source, expected=EXPECTED)
    text = text.removeprefix("[").removesuffix("]").strip()
    # a row continues after a comma at the end of a line; a semicolon there ends it once
    text = re.sub(r",\s*\n\s*", ",", text)
    text = re.sub(r"\s*;?\s*\n\s*", ";", text).removesuffix(";")
    if not text.strip():
        raise InputError("holds no node", source=source, expected=EXPECTED)
    return [_numbers(row, index, source) for index, row in enumerate(text.split(";"))]


def _numbers(row: str, index: int, source: str) -> list[int]:
    """Numbers of one row."""
    words = re.split(r"\s*,\s*|\s+", row.strip())
    for column, word in enumerate(words):
        if not re.fullmatch(r"[+-]?[0-9]+", word):
            problem = "a node is missing" if not word else f"{word!r} is not the number of a node"
            raise InputError(problem, source=source, key=_place(index, column), expected=EXPECTED)
    return [int(word) for word in words]


def _place(row: int, column: int) -> str:
    return f"row {row + 1}, column {column + 1}"


def node_matrix(
    rows: Sequence[Sequence[int]] | NDArray[np.int64], node_count: int, source: str = "contour"
) -> NDArray[np.int64]:
    """Checked node matrix.

    Parameters
    ----------
    rows
        Numbers of nodes from 1.
    node_count
        Nodes of the body.
    source
        Where they stand, for messages.

    Returns
    -------
    NDArray
        Indices from 0, shape (a, b).

    Raises
    ------
    InputError
        Rows of different lengths, a node that the body has not, a node that stands twice.
    """
    if len(rows) == 0 or len(rows[0]) == 0:
        raise InputError("holds no node", source=source, expected=EXPECTED)
    for index, row in enumerate(rows):
        if len(row) != len(rows[0]):
            raise InputError(
                f"{len(row)} nodes",
                source=source,
                key=f"row {index + 1}",
                expected=f"{len(rows[0])} nodes as in the first row",
            )
        for column, number in enumerate(row):
            if not 1 <= number <= node_count:
                raise InputError(
                    f"node {number}",
                    source=source,
                    key=_place(index, column),
                    expected=f"a node of the body, 1 to {node_count}",
                )
    numbers = np.asarray(rows, dtype=np.int64)
    flat = numbers.ravel()
    _, first, inverse = np.unique(flat, return_index=True, return_inverse=True)
    again = np.flatnonzero(first[inverse] != np.arange(flat.size))
    if again.size:
        second = divmod(int(again[0]), numbers.shape[1])
        before = divmod(int(first[inverse[again[0]]]), numbers.shape[1])
        raise InputError(
            f"node {flat[again[0]]} stands here again, first in {_place(*before)}",
            source=source,
            key=_place(*second),
            expected="every node once, of a closed contour too",
        )
    return numbers - 1


def node_row(
    rows: Sequence[Sequence[int]] | NDArray[np.int64], node_count: int, source: str = "contour"
) -> NDArray[np.int64]:
    """Checked nodes of a curve: one row or one column; see `node_matrix`.

    Returns
    -------
    NDArray
        Indices from 0, shape (k,).
    """
    indices = node_matrix(rows, node_count, source)
    if 1 not in indices.shape:
        raise InputError(
            f"{indices.shape[0]} rows of {indices.shape[1]} nodes",
            source=source,
            expected="one row or one column of nodes along a curve",
        )
    return indices.ravel()
