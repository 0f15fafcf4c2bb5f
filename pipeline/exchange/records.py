"""Results that have fields and arrays, as maps that a message can carry, and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

__all__ = ["as_map", "of_map"]


def as_map(value: Any) -> Any:
    r"""A dataclass, an array, or a mapping of them, as maps, lists, numbers, text and bytes.

    >>> as_map(np.array([1.0]))
    {'shape': [1], 'complex': False, 'data': b'\x00\x00\x00\x00\x00\x00\xf0?'}
    """
    if isinstance(value, np.ndarray):
        is_complex = np.iscomplexobj(value)
        data = np.ascontiguousarray(value, dtype="<c16" if is_complex else "<f8")
        return {"shape": list(value.shape), "complex": is_complex, "data": data.tobytes()}
    if is_dataclass(value):
        return {field.name: as_map(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {name: as_map(each) for name, each in value.items()}
    if isinstance(value, (tuple, list)):
        return [as_map(each) for each in value]
    return value.item() if isinstance(value, np.generic) else value


def of_map(value: Any) -> Any:
    """Arrays, mappings and tuples of what `as_map` has made.

    >>> of_map(as_map({"a": np.eye(2), "b": (1, "x")}))
    {'a': array([[1., 0.],
           [0., 1.]]), 'b': (1, 'x')}
    """
    if isinstance(value, dict):
        if value.keys() == {"shape", "complex", "data"}:
            found = np.frombuffer(value["data"], dtype="<c16" if value["complex"] else "<f8")
            return found.reshape(value["shape"]).astype(found.dtype.newbyteorder("="))
        return {name: of_map(each) for name, each in value.items()}
    if isinstance(value, list):
        return tuple(map(of_map, value))
    return value
