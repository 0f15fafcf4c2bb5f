"""Vectors of space as tuples of three numbers: nothing allocated, and the compiler keeps them in registers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = [
    "Three",
    "Vector",
    "add",
    "add_scaled",
    "between",
    "cross",
    "dot",
    "rotate",
    "rotate_back",
    "scaled",
    "subtract",
    "vector",
    "vector_at",
]

Vector = tuple[float, float, float]
Three = Vector | NDArray[np.float64]
"""What functions take for a vector: also an array, or a vector field of a record."""


@kernel(inline=True, internal=True)
def vector(a: Any) -> Vector:
    """The three numbers of an array or of a field of a record."""
    return a[0], a[1], a[2]


@kernel(inline=True, internal=True)
def vector_at(a: Any, first: int) -> Vector:
    """Three numbers of an array that follow each other."""
    return a[first], a[first + 1], a[first + 2]


@kernel(inline=True, internal=True)
def add(a: Three, b: Three) -> Vector:
    """``a + b``."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel(inline=True, internal=True)
def subtract(a: Three, b: Three) -> Vector:
    """``a - b``."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel(inline=True, internal=True)
def scaled(f: float, a: Three) -> Vector:
    """``f a``."""
    return f * a[0], f * a[1], f * a[2]


@kernel(inline=True, internal=True)
def add_scaled(a: Three, f: float, b: Three) -> Vector:
    """``a + f b``."""
    return a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]


@kernel(inline=True, internal=True)
def between(a: Three, b: Three, t: float) -> Vector:
    """``a + t (b - a)``."""
    return a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])


@kernel(inline=True, internal=True)
def dot(a: Three, b: Three) -> float:
    """Inner product ``a . b``."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel(inline=True)
def cross(a: Three, b: Three) -> Vector:
    """Vector product ``a x b``."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel(inline=True)
def rotate(R: Any, v: Three) -> Vector:
    """``R v`` of a 3x3 matrix, row by row in an array of 9, and a vector."""
    return (
        R[0] * v[0] + R[1] * v[1] + R[2] * v[2],
        R[3] * v[0] + R[4] * v[1] + R[5] * v[2],
        R[6] * v[0] + R[7] * v[1] + R[8] * v[2],
    )


@kernel(inline=True)
def rotate_back(R: Any, v: Three) -> Vector:
    """``R^T v`` of a 3x3 matrix, row by row in an array of 9, and a vector."""
    return (
        R[0] * v[0] + R[3] * v[1] + R[6] * v[2],
        R[1] * v[0] + R[4] * v[1] + R[7] * v[2],
        R[2] * v[0] + R[5] * v[1] + R[8] * v[2],
    )
