"""Rotations: unit quaternions (scalar first), the exponential map, and their inverses.

A quaternion ``q = (q0, q1, q2, q3)`` turns body axes into world axes: ``r = R(q) rbar``.
A rotation by the body-axis vector ``v`` is appended on the right: ``q o exp(v)``. Formulae: A. A. Shabana,
"Dynamics of Multibody Systems", chapter 2 (Euler parameters, Rodrigues formula).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.jit import in_python, kernel

__all__ = [
    "exponential_quaternion",
    "quaternion_from_matrix",
    "quaternion_from_rotation_vector",
    "quaternion_product",
    "rotate_by_exponential",
    "rotate_by_quaternion",
    "rotation_matrix",
    "turned_by",
    "write_rotation_matrix",
]

Quaternion = tuple[float, float, float, float]

SERIES_ANGLE_SQUARED = 0.04
"""Below 0.2 rad the series is exact to rounding and avoids 0/0."""


@kernel(inline=True)
def exponential_quaternion(v1: float, v2: float, v3: float) -> Quaternion:
    """Unit quaternion ``(cos(a/2), sin(a/2)/a v)``, ``a = |v|``, of a rotation vector [rad]."""
    a2 = v1 * v1 + v2 * v2 + v3 * v3
    if a2 < SERIES_ANGLE_SQUARED:
        x = 0.25 * a2
        cosine = 1.0 - x / 2.0 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0)))
        scale = 0.5 * (1.0 - x / 6.0 * (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0))))
    else:
        a = math.sqrt(a2)
        cosine = math.cos(0.5 * a)
        scale = math.sin(0.5 * a) / a
    return cosine, scale * v1, scale * v2, scale * v3


@kernel(inline=True)
def quaternion_product(a: Quaternion, b: Quaternion) -> Quaternion:
    """Hamilton product: the rotation ``R(a) R(b)``."""
    a0, a1, a2, a3 = a
    b0, b1, b2, b3 = b
    return (
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    )


@kernel(inline=True)
def rotate_by_exponential(q: Quaternion, v1: float, v2: float, v3: float) -> Quaternion:
    """Return ``q o exp(v)``, brought back to unit length by one Newton step ``1.5 - 0.5 |q|^2``."""
    p0, p1, p2, p3 = quaternion_product(q, exponential_quaternion(v1, v2, v3))
    s = 1.5 - 0.5 * (p0 * p0 + p1 * p1 + p2 * p2 + p3 * p3)
    return s * p0, s * p1, s * p2, s * p3


@kernel(inline=True)
def write_rotation_matrix(q: Quaternion, out: NDArray[np.float64]) -> None:
    """Write the rotation matrix of a unit quaternion into ``out``, row by row, shape (9,)."""
    q0, q1, q2, q3 = q
    out[0] = 1.0 - 2.0 * (q2 * q2 + q3 * q3)
    out[1] = 2.0 * (q1 * q2 - q0 * q3)
    out[2] = 2.0 * (q1 * q3 + q0 * q2)
    out[3] = 2.0 * (q1 * q2 + q0 * q3)
    out[4] = 1.0 - 2.0 * (q1 * q1 + q3 * q3)
    out[5] = 2.0 * (q2 * q3 - q0 * q1)
    out[6] = 2.0 * (q1 * q3 - q0 * q2)
    out[7] = 2.0 * (q2 * q3 + q0 * q1)
    out[8] = 1.0 - 2.0 * (q1 * q1 + q2 * q2)


@kernel(inline=True)
def rotate_by_quaternion(q: Quaternion, v1: float, v2: float, v3: float) -> tuple[float, float, float]:
    """``R(q) v = v + 2 q0 (u x v) + 2 u x (u x v)`` with the vector part u of a unit quaternion."""
    q0, q1, q2, q3 = q
    t1 = 2.0 * (q2 * v3 - q3 * v2)
    t2 = 2.0 * (q3 * v1 - q1 * v3)
    t3 = 2.0 * (q1 * v2 - q2 * v1)
    return (
        v1 + q0 * t1 + q2 * t3 - q3 * t2,
        v2 + q0 * t2 + q3 * t1 - q1 * t3,
        v3 + q0 * t3 + q1 * t2 - q2 * t1,
    )


def rotation_matrix(quaternion: ArrayLike) -> NDArray[np.float64]:
    """Rotation matrix, shape (3, 3), of a quaternion, shape (4,), which is normalised first."""
    q = np.asarray(quaternion, dtype=np.float64)
    q = q / np.linalg.norm(q)
    matrix = np.empty(9)
    q0, q1, q2, q3 = q.tolist()
    in_python(write_rotation_matrix)((q0, q1, q2, q3), matrix)
    return matrix.reshape(3, 3)


def turned_by(quaternions: ArrayLike, vector: ArrayLike) -> NDArray[np.float64]:
    """A vector, shape (3,), turned by each of some quaternions, shape (n, 4), normalised first: shape (n, 3)."""
    q = np.asarray(quaternions, dtype=np.float64)
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    turn: Any = in_python(rotate_by_quaternion)  # of columns of numbers as of numbers
    return np.stack(turn(q.T, *np.asarray(vector, dtype=np.float64).tolist()), axis=1)


def quaternion_from_rotation_vector(vector: ArrayLike) -> NDArray[np.float64]:
    """Unit quaternion, shape (4,), of a rotation vector [rad], shape (3,)."""
    v1, v2, v3 = np.asarray(vector, dtype=np.float64).tolist()
    return np.array(in_python(exponential_quaternion)(v1, v2, v3))


def quaternion_from_matrix(matrix: ArrayLike) -> NDArray[np.float64]:
    """Unit quaternion with non-negative scalar part of a rotation matrix, shape (3, 3).

    Notes
    -----
    Divides by the largest of the four components (Shepperd, J. Guidance and Control 1, 1978),
    so no rotation is badly conditioned.
    """
    R = np.asarray(matrix, dtype=np.float64)
    squares = np.array(
        [
            1.0 + R[0, 0] + R[1, 1] + R[2, 2],
            1.0 + R[0, 0] - R[1, 1] - R[2, 2],
            1.0 - R[0, 0] + R[1, 1] - R[2, 2],
            1.0 - R[0, 0] - R[1, 1] + R[2, 2],
        ]
    )
    largest = int(np.argmax(squares))
    x, y, z = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    xy, xz, yz = R[0, 1] + R[1, 0], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1]
    rows = ((squares[0], x, y, z), (x, squares[1], xy, xz), (y, xy, squares[2], yz), (z, xz, yz, squares[3]))
    q = np.array(rows[largest])
    q /= np.linalg.norm(q)
    return -q if q[0] < 0.0 else q
