"""Small fixed-size blocks: 3-vectors as scalars, 3x3 products and 6x6 Cholesky, written in place."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel

__all__ = [
    "aligned",
    "cholesky_factor",
    "cholesky_invert",
    "cholesky_solve",
    "cross",
    "nonnegative",
    "rotate",
    "rotate_back",
    "solve_symmetric_3",
]

Vector = tuple[float, float, float]


def aligned(shape: int | tuple[int, ...]) -> NDArray[np.float64]:
    """Zeros that begin at a cache line (64 bytes): from odd ones long products take a fifth more time."""
    count = int(np.prod(shape))
    buffer = np.zeros(8 * count + 64, dtype=np.uint8)
    start = -buffer.ctypes.data % 64
    return buffer[start : start + 8 * count].view(np.float64).reshape(shape)


@kernel(inline=True, internal=True)
def nonnegative(index: int) -> int:
    """An index, below 2^31, that the compiler knows not to count from the end of an array.

    Otherwise it looks at the sign of each index for each array that has a length of its own.
    """
    return index & 0x7FFFFFFF


@kernel(inline=True)
def cross(a1: float, a2: float, a3: float, b1: float, b2: float, b3: float) -> Vector:
    """Vector product ``a x b``."""
    return a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1


@kernel(inline=True)
def rotate(R: NDArray[np.float64], v1: float, v2: float, v3: float) -> Vector:
    """``R v`` of a 3x3 matrix, row by row in an array of 9, and a vector."""
    return (
        R[0] * v1 + R[1] * v2 + R[2] * v3,
        R[3] * v1 + R[4] * v2 + R[5] * v3,
        R[6] * v1 + R[7] * v2 + R[8] * v3,
    )


@kernel(inline=True)
def rotate_back(R: NDArray[np.float64], v1: float, v2: float, v3: float) -> Vector:
    """``R^T v`` of a 3x3 matrix, row by row in an array of 9, and a vector."""
    return (
        R[0] * v1 + R[3] * v2 + R[6] * v3,
        R[1] * v1 + R[4] * v2 + R[7] * v3,
        R[2] * v1 + R[5] * v2 + R[8] * v3,
    )


@kernel(inline=True)
def solve_symmetric_3(
    a11: float, a22: float, a33: float, a12: float, a13: float, a23: float, b1: float, b2: float, b3: float
) -> Vector:
    """Solve a symmetric positive definite 3x3 system by ``L D L^T``; NaN if it is singular."""
    l21 = a12 / a11
    l31 = a13 / a11
    d2 = a22 - l21 * a12
    u32 = a23 - l31 * a12
    l32 = u32 / d2
    d3 = a33 - l31 * a13 - l32 * u32
    y2 = b2 - l21 * b1
    y3 = b3 - l31 * b1 - l32 * y2
    x3 = y3 / d3
    x2 = y2 / d2 - l32 * x3
    x1 = b1 / a11 - l21 * x2 - l31 * x3
    return x1, x2, x3


@kernel
def cholesky_factor(a: NDArray[np.float64], n: int) -> None:
    """Overwrite the lower triangle of a symmetric positive definite matrix by ``L``, ``a = L L^T``.

    Parameters
    ----------
    a
        Matrix, row by row, shape (n n,).
    n
        Size.

    Notes
    -----
    The reciprocal of the diagonal of L is stored on the diagonal, because `cholesky_solve` divides
    by it twice. A matrix that is not positive definite leaves NaN, which callers check for.
    """
    for j in range(n):
        d = a[j * n + j]
        for k in range(j):
            d -= a[j * n + k] * a[j * n + k]
        inverse = 1.0 / math.sqrt(d)
        a[j * n + j] = inverse
        for i in range(j + 1, n):
            s = a[i * n + j]
            for k in range(j):
                s -= a[i * n + k] * a[j * n + k]
            a[i * n + j] = s * inverse


@kernel
def cholesky_solve(factor: NDArray[np.float64], x: NDArray[np.float64], n: int) -> None:
    """Overwrite the right-hand side ``x``, shape (n,), by the solution, with the result of `cholesky_factor`."""
    for i in range(n):
        s = x[i]
        for k in range(i):
            s -= factor[i * n + k] * x[k]
        x[i] = s * factor[i * n + i]
    for i in range(n - 1, -1, -1):
        s = x[i]
        for k in range(i + 1, n):
            s -= factor[k * n + i] * x[k]
        x[i] = s * factor[i * n + i]


@kernel
def cholesky_invert(factor: NDArray[np.float64], n: int) -> None:
    """Overwrite the result of `cholesky_factor` by the whole inverse of the matrix, ``L^-T L^-1``."""
    for j in range(n):
        for i in range(j + 1, n):
            s = 0.0
            for k in range(j, i):
                s -= factor[i * n + k] * factor[k * n + j]
            factor[i * n + j] = s * factor[i * n + i]
    for i in range(n):
        for j in range(i + 1):
            s = 0.0
            for k in range(i, n):
                s += factor[k * n + i] * factor[k * n + j]
            factor[i * n + j] = factor[j * n + i] = s
