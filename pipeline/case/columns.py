"""Small tables of numbers in the case folder: comma-separated columns under a header that says what they are."""

from __future__ import annotations

import csv
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from heavylift.numerics.quantity import TableFile

__all__ = ["Columns", "finite_rows", "read_columns", "read_lines", "read_points", "read_table"]


class Columns(NamedTuple):
    """Content of a file.

    Attributes
    ----------
    header
        Names of the columns, one of those that were allowed.
    values
        One tuple a column.
    """

    header: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]


def read_lines(file: Path) -> tuple[tuple[str, ...], list[tuple[int, str]]]:
    """Names in the header of a table, and the lines below it with their numbers, without empty ones and comments.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    try:
        text = file.read_text(encoding="utf-8-sig")  # as spreadsheets save it
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(error), source=file, expected="a readable text file") from None
    lines = [(n, line) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]
    lines = [(n, line) for n, line in lines if not line.lstrip().startswith("#")]
    return tuple(name.strip() for name in lines[0][1].split(",")) if lines else (), lines[1:]


def finite_rows(
    lines: Sequence[tuple[int, str]], width: int, file: Path
) -> Iterator[tuple[int, list[float]]]:
    """Numbers of each line, and its own number.

    Raises
    ------
    InputError
        If a line is not as many finite numbers as the width.
    """
    for number, line in lines:
        try:
            row = [float(entry) for entry in next(csv.reader([line]))]
        except (ValueError, csv.Error):  # the latter of a field that is longer than its reader takes
            row = []
        if len(row) != width or not all(map(math.isfinite, row)):
            raise InputError(
                f"{line!r}", source=file, key=f"line {number}", expected=f"{width} finite numbers"
            )
        yield number, row


def read_table(file: Path, wanted: TableFile) -> Columns:
    """Read the table that a key of a description names, and run the check that its annotation has.

    Raises
    ------
    InputError
        As `read_columns`, or if the table is not what is wanted.
    """
    columns = read_columns(file, wanted.headers, may_repeat=getattr(wanted, "may_repeat", False))
    check = getattr(wanted, "check", None)
    if check is not None:
        try:
            check(columns.values)
        except InputError as error:
            raise InputError(error.problem, source=file, expected=error.expected) from None
    return columns


def read_columns(
    file: Path, headers: Sequence[tuple[str, ...]], *, fewest: int = 2, may_repeat: bool = False
) -> Columns:
    """Read a table whose first column increases; lines that begin with ``#`` are comments.

    Parameters
    ----------
    file
        Comma-separated, with a header.
    headers
        Those that are allowed.
    fewest
        Rows.
    may_repeat
        Whether the first column may keep its value from row to row.

    Raises
    ------
    InputError
        If the header is another one, a row is not one finite number a column, the first column does not increase, or
        there are too few rows.
    """
    header, lines = read_lines(file)
    if header not in headers:
        raise InputError(
            f"header {','.join(header)!r}",
            source=file,
            expected=" or ".join(repr(",".join(known)) for known in headers),
        )
    rows: list[list[float]] = []
    for number, row in finite_rows(lines, len(header), file):
        if rows and (row[0] < rows[-1][0] or (row[0] == rows[-1][0] and not may_repeat)):
            raise InputError(
                f"{row[0]:g} after {rows[-1][0]:g}",
                source=file,
                key=f"line {number}",
                expected=f"{header[0]} that {'does not fall' if may_repeat else 'increases'}",
            )
        rows.append(row)
    if len(rows) < fewest:
        raise InputError(f"{len(rows)} rows", source=file, expected=f"at least {fewest}")
    return Columns(header, tuple(zip(*rows, strict=True)))


def read_points(file: Path) -> NDArray[np.float64]:
    """Points of a file of lines ``x,y,z`` [m], shape (n, 3); ``#`` begins a comment.

    Raises
    ------
    InputError
        If the file cannot be read, or a line is not three finite numbers.
    """
    rows = []
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(str(error), source=file, expected="a readable text file") from None
    for number, line in enumerate(lines, start=1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        try:
            row = [float(entry) for entry in text.split(",")]
        except ValueError:
            row = []
        if len(row) != 3 or not np.all(np.isfinite(row)):
            raise InputError(f"{line!r}", source=file, key=f"line {number}", expected="x,y,z in m")
        rows.append(row)
    return np.array(rows).reshape(-1, 3)
