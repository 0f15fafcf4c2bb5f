"""Records of a run, as kernels write them: outputs of a thing are a record that lies in its columns.

``rope_outputs = outputs_at(RopeOutputs)`` is a function for kernels: ``rope_outputs(row, column).tension = tension``.
It is the place in the row that is written; nothing is copied, and columns follow from the fields, see
`heavylift.solver.scene.outputs`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from typing import Annotated, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import view
from heavylift.numerics.records import WORD_BYTES, Record, record_at, records
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.outputs import Columns, Outputs, Parts, PlacedPart

__all__ = [
    "ColumnRange",
    "check_written",
    "outputs_at",
    "part",
    "placed",
    "record_of",
    "unwritten",
    "width_of",
]

P = TypeVar("P", bound=Parts)
O = TypeVar("O", bound=Outputs)

UNWRITTEN = np.uint64(0x7FF8_0000_0000_0B5E)
"""Bits of a number that no kernel writes: a NaN with a message."""


class ColumnRange(Record):
    """Where the components of a channel of parts are: first column and how many."""

    first: int
    size: int


def _record_of(outputs: type[Outputs]) -> type[Record]:
    fields: dict[str, Any] = {}
    base: Any = outputs.__mro__[1]
    inherited = getattr(base, "OUTPUTS", {})
    parent: Any = record_of(base) if inherited else Record
    for name, one in outputs.OUTPUTS.items():
        if name in inherited:
            continue
        if isinstance(one, type):
            fields[name] = record_of(one)
        elif issubclass(outputs, Parts):
            fields[name] = ColumnRange
        else:
            count = len(one.components or ())
            fields[name] = Annotated[NDArray[np.float64], (count,)] if count else float
    made: Any = type(
        outputs.__qualname__, (parent,), {"__annotations__": fields, "__module__": outputs.__module__}
    )
    return made


record_of: Any = cache(_record_of)
"""The record of a class of outputs: a field a channel, or a record within."""


def width_of(outputs: type[Outputs]) -> int:
    """Number of columns of a class of outputs."""
    return record_of(outputs).layout.itemsize // WORD_BYTES


def placed(declared: type[P], columns: Columns) -> P:
    """Where the channels of a class of parts are, as the record that a kind keeps."""
    made: Any = records(record_of(declared), [columns.parts(declared)])[0]
    return made


def outputs_at(outputs: type[O]) -> Callable[[NDArray[np.float64], int], O]:
    """Function for kernels that sees the outputs of a thing in a row, from its column on."""
    made: Any = record_at(record_of(outputs))
    return made


def unwritten(count: int) -> NDArray[np.float64]:
    """A row that nobody has written yet, shape (count,)."""
    return np.full(count, UNWRITTEN).view(np.float64)


def check_written(row: NDArray[np.float64], channels: Iterable[Channel]) -> None:
    """Refuse a record of which kernels left out a part.

    Parameters
    ----------
    row
        One that was `unwritten` before they wrote it.
    channels
        What is in it.

    Raises
    ------
    TypeError
        If there is a channel that no kernel writes; a mistake of a kind, not of a case.
    """
    left = row.view(np.uint64) == UNWRITTEN
    names = [c.name for c in channels if left[c.column : c.column + len(c.components)].any()]
    if names:
        raise TypeError(f"no kernel writes {', '.join(map(repr, names))}")


@view
def part(row: Floats1, where: PlacedPart) -> NDArray[np.float64]:
    """Components of a channel of parts in a row, a view."""
    return row[where.first : where.first + where.size]
