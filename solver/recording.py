"""Records of a run, as kernels write them: outputs of a component are a record in its columns.

``rope_outputs = outputs_at(RopeOutputs)`` is a function for kernels: ``rope_outputs(row, column).tension = tension``.
It is the place in the row that is written; nothing is copied, and columns follow from the fields, see
`heavylift.solver.scene.outputs`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import view
from heavylift.numerics.records import WORD_BYTES, record_at
from heavylift.solver.scene.channels import Channel
from heavylift.solver.scene.outputs import Columns, Outputs, Parts, PlacedPart

__all__ = [
    "check_written",
    "outputs_at",
    "part",
    "placed",
    "unwritten",
    "width_of",
    "zeros_of",
]

P = TypeVar("P", bound=Parts)
O = TypeVar("O", bound=Outputs)

UNWRITTEN = np.uint64(0x7FF8_0000_0000_0B5E)
"""Bits of a number that no kernel writes: a NaN with a message."""


def width_of(outputs: type[Outputs]) -> int:
    """Number of columns of a class of outputs."""
    return outputs.record().layout.itemsize // WORD_BYTES


def placed(declared: type[P], columns: Columns) -> P:
    """Where the channels of a class of parts are, as the record that a kind keeps."""
    made: Any = declared.record().one()
    _place(made, declared, columns)
    return made


def _place(made: Any, declared: type[Outputs], columns: Columns) -> None:
    """Fill the record of a class of parts, and those within it."""
    for name, one in declared.OUTPUTS.items():
        at = getattr(made, name)
        if isinstance(one, type):
            _place(at, one, columns)
        else:
            at.first, at.size = columns.of(one.name)


def zeros_of(declared: type[O]) -> O:
    """Outputs in no row, all 0: for what is seen between two records."""
    made: Any = declared.record().one()
    return made


def outputs_at(outputs: type[O]) -> Callable[[NDArray[np.float64], int], O]:
    """Function for kernels that accesses the outputs of a component in a row, from its column on."""
    made: Any = record_at(outputs.record())
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
