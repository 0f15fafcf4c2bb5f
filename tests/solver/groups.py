"""Groups of arrays for tests that need some of their fields only."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from heavylift.numerics.arrays import Arrays, ArrayType, NumberType, Reference, layout
from heavylift.numerics.records import RecordsType, records

G = TypeVar("G", bound=Arrays)


def partly(group: type[G], **given: Any) -> G:
    """A group with some fields as given, and nothing in the others."""
    fields: dict[str, Any] = {}
    for name, (of_type, _) in layout(group).items():
        if isinstance(of_type, ArrayType):
            fields[name] = np.zeros((0,) * of_type.ndim, dtype=of_type.dtype)
        elif isinstance(of_type, Reference):
            fields[name] = partly(of_type.group)
        elif isinstance(of_type, RecordsType):
            fields[name] = records(of_type.record, 0)
        else:
            fields[name] = () if not isinstance(of_type, NumberType) else 0
    return group(**(fields | given))
