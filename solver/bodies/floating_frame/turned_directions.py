"""Directions that the modes of a body turn: the vector, its rate, and its columns of the marker.

A place P turns relative to the frame by the rotation vector ``theta = Psi q`` of its rotations Psi, shape (3, nf). A
direction d0 there is, with the rotation matrix R of the frame, its spin w in body axes, and S = skew theta::

    e = R d,   d = E d0,   E = exp S = I + sin t / t S + (1 - cos t) / t^2 S^2,   t = |theta|
    e' = R ( (w + J Psi q') x d ),   J = I + (1 - cos t) / t^2 S + (t - sin t) / t^3 S^2

J maps the rate of a rotation vector to the angular velocity (Shabana, "Dynamics of Multibody Systems", chapter 2).
Rows of joints and generalised forces are both made of these columns, so a row is the rate of its residual, and a moment
M does the work ``M . (w + J Psi q')``. Modes themselves are linear: what they leave out is of second order in theta.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, cross, dot, vector

__all__ = ["exponential_factors", "write_turned_direction"]

SERIES_ANGLE_SQUARED = 0.04
"""Below 0.2 rad the series are exact to rounding and avoid 0/0."""


@kernel(inline=True)
def exponential_factors(x: float) -> tuple[float, float]:
    """``(1 - cos t) / t^2`` and ``(t - sin t) / t^3`` of an angle with the square x [rad^2]."""
    if x < SERIES_ANGLE_SQUARED:
        a = 0.5 * (1.0 - x / 12.0 * (1.0 - x / 30.0 * (1.0 - x / 56.0 * (1.0 - x / 90.0))))
        b = (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0 * (1.0 - x / 110.0)))) / 6.0
    else:
        t = math.sqrt(x)
        a = (1.0 - math.cos(t)) / x
        b = (t - math.sin(t)) / (x * t)
    return a, b


@kernel(internal=True)
def write_turned_direction(
    data: NDArray[np.float64],
    R: NDArray[np.float64],
    q: NDArray[np.float64],
    rates: NDArray[np.float64],
    window: NDArray[np.float64],
) -> tuple[Vector, Vector]:
    """The direction in body axes, and the part of its rate that modes make, in world axes; columns of the modes.

    Parameters
    ----------
    data
        The undeformed direction, then the rotations of the place, component by component, shape (3 + 3 n,).
    R
        Rotation matrix of the frame, row by row, shape (9,).
    q, rates
        Modal coordinates and rates, shape (n,).
    window
        Columns of the marker, shape (3, 6 + n or more): receives those of the modes.
    """
    n = q.shape[0]
    t1 = t2 = t3 = 0.0
    for i in range(n):
        t1 += data[3 + i] * q[i]
        t2 += data[3 + n + i] * q[i]
        t3 += data[3 + 2 * n + i] * q[i]
    theta = (t1, t2, t3)
    x = dot(theta, theta)
    a, b = exponential_factors(x)
    start = vector(data)
    once = cross(theta, start)
    d = add_scaled(add_scaled(start, 1.0 - x * b, once), a, cross(theta, once))
    x1, y1, z1 = _turned_row(theta, a, b, d, (R[0], R[1], R[2]))
    x2, y2, z2 = _turned_row(theta, a, b, d, (R[3], R[4], R[5]))
    x3, y3, z3 = _turned_row(theta, a, b, d, (R[6], R[7], R[8]))
    r1 = r2 = r3 = 0.0
    for i in range(n):
        p1, p2, p3 = data[3 + i], data[3 + n + i], data[3 + 2 * n + i]
        c1 = x1 * p1 + y1 * p2 + z1 * p3
        c2 = x2 * p1 + y2 * p2 + z2 * p3
        c3 = x3 * p1 + y3 * p2 + z3 * p3
        window[0, 6 + i], window[1, 6 + i], window[2, 6 + i] = c1, c2, c3
        r1 += c1 * rates[i]
        r2 += c2 * rates[i]
        r3 += c3 * rates[i]
    return d, (r1, r2, r3)


@kernel(inline=True, internal=True)
def _turned_row(theta: Vector, a: float, b: float, d: Vector, row: Vector) -> Vector:
    """``J^T (d x row)``: what a rate of theta does to the direction along a world axis, a row of R."""
    arm = cross(d, row)
    once = cross(theta, arm)
    return add_scaled(add_scaled(arm, -a, once), b, cross(theta, once))
