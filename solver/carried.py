"""What outlives a step: fields that kinds name as carried, which a checkpoint keeps, and one array that holds all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.records import Record
from heavylift.numerics.small import aligned

__all__ = ["LINE", "carried_words", "share_state"]

LINE = 8
"""Numbers in a cache line, which each array fills to its end."""


def share_state(
    groups: tuple[tuple[Any, ...], ...],
) -> tuple[tuple[tuple[Any, ...], ...], NDArray[np.float64]]:
    """Put all carried arrays of some tuples of kinds into one, so that a step can be taken back by one copy.

    Parameters
    ----------
    groups
        Tuples of kinds.

    Returns
    -------
    groups
        The same kinds, their carried arrays views of one array.
    carried
        That array.
    """
    sizes = [
        _lines(getattr(kind, field)) for kinds in groups for kind in kinds for field in kind.carried_fields
    ]
    whole = aligned(max(1, sum(sizes)))
    start = 0
    made: list[list[Any]] = []
    moved: dict[int, NDArray[Any]] = {}
    for kinds in groups:
        changed = []
        for kind in kinds:
            views: dict[str, NDArray[Any]] = {}
            for field in kind.carried_fields:
                old = getattr(kind, field)
                memory = whole[start : start + old.nbytes // whole.itemsize]
                views[field] = memory.view(old.dtype).reshape(old.shape)
                views[field][...] = old
                moved[id(old)] = views[field]
                start += _lines(old)
            replaced = kind._replace(**views)
            # parts of a kind that have a state of their own keep it in that of the kind
            changed.append(replaced.sharing_state() if hasattr(replaced, "sharing_state") else replaced)
        made.append(changed)
    return tuple(tuple(_following(kind, moved) for kind in kinds) for kinds in made), whole


def _following(kind: Any, moved: dict[int, NDArray[Any]]) -> Any:
    """A kind that looks at what others carry where that has gone; so do the groups of arrays in it."""
    views = {}
    for field in kind._fields:
        value = getattr(kind, field)
        if id(value) in moved:
            views[field] = moved[id(value)]
        elif isinstance(value, Arrays):
            views[field] = _following(value, moved)
    changed = {field: value for field, value in views.items() if value is not getattr(kind, field)}
    return kind._replace(**changed) if changed else kind


def carried_words(kind: Arrays) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Fields of a kind that outlive a step, with all that is in them as numbers; views."""
    for field in kind.carried_fields:
        value = getattr(kind, field)
        if isinstance(value, Record):
            yield field, value.words
        else:
            yield field, value if value.dtype.names is None else value.view(np.float64)


def _lines(array: NDArray[Any]) -> int:
    """Words of an array of numbers or records, to the end of its last cache line."""
    return -(-(array.nbytes // 8) // LINE) * LINE
