"""How joints write their rows: inner products of constant or marker vectors with marker Jacobians.

A row is the rate of a scalar built from markers. Its part on one side is a sum of terms ``c . J[m]``, so
the same few lines serve all joints and all bodies. Three scalars serve nearly all joints; each comes with
its row and, for the accurate integrator, its second derivative without accelerations of the bodies::

    c . e                                   of two directions: zero if they are perpendicular to each other
    e . (p_b - p_a)                         travel along a direction e of a
    atan2( -y_b . x_a, x_b . x_a )          angle that turns x of a into x of b about the common z
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel, view
from heavylift.solver.interface import Workspace
from heavylift.solver.rows.structure import RowArrays

__all__ = [
    "Vector",
    "add_direction_row",
    "angle_bias",
    "angle_row",
    "bias",
    "difference",
    "dot",
    "hinge_angle",
    "hinge_rate",
    "minus",
    "near_angle",
    "put_direction_row",
    "put_point_rows",
    "rate",
    "residuals",
    "square_bias",
    "square_row",
    "targets",
    "travel",
    "travel_bias",
    "travel_rate",
    "travel_row",
    "vector",
    "write_point_bias",
]

Vector = tuple[float, float, float]


@kernel(inline=True, internal=True)
def vector(work: Workspace, marker: int) -> Vector:
    """The vector of a marker."""
    m = work.markers[marker]
    return m.point[0], m.point[1], m.point[2]


@kernel(inline=True, internal=True)
def rate(work: Workspace, marker: int) -> Vector:
    """The rate of the vector of a marker, where its level is filled with rates."""
    m = work.markers[marker]
    return m.velocity[0], m.velocity[1], m.velocity[2]


@kernel(inline=True, internal=True)
def bias(work: Workspace, marker: int) -> Vector:
    """The second rate of the vector of a marker without accelerations of its body."""
    m = work.markers[marker]
    return m.bias[0], m.bias[1], m.bias[2]


@kernel(inline=True, internal=True)
def minus(a: Vector, b: Vector) -> Vector:
    """``a - b``."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel(inline=True, internal=True)
def difference(work: Workspace, a: int, b: int) -> Vector:
    """``p_b - p_a`` of two point markers."""
    return minus(vector(work, b), vector(work, a))


@kernel(inline=True, internal=True)
def dot(a: Vector, b: Vector) -> float:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@view
def residuals(system: RowArrays, block: int) -> NDArray[np.float64]:
    """Residuals of the rows of a block, a view."""
    return system.rows[block].residual


@view
def targets(system: RowArrays, block: int) -> NDArray[np.float64]:
    """Targets of the rows of a block, a view."""
    return system.rows[block].target


@kernel(inline=True, internal=True)
def put_point_rows(
    system: RowArrays, attachment: int, first: int, work: Workspace, marker: int, sign: float
) -> None:
    """Write ``sign J[m]`` as three rows: the components of a point along the world axes."""
    lanes = system.lanes
    width = system.attachments[attachment].width
    begin = system.attachments[attachment].panel + first
    J = work.jacobian[marker]
    if width == 6:
        for k in range(6):
            for r in range(3):
                system.panels[begin + k * lanes + r] = sign * J[r, k]
    else:
        for k in range(width):
            for r in range(3):
                system.panels[begin + k * lanes + r] = sign * J[r, k]


@kernel(internal=True)
def _put_product(
    panels: NDArray[np.float64], begin: int, lanes: int, width: int, J: NDArray[np.float64], c: Vector
) -> None:
    for k in range(width):
        panels[begin + k * lanes] = c[0] * J[0, k] + c[1] * J[1, k] + c[2] * J[2, k]


@kernel(inline=True, internal=True)
def put_direction_row(
    system: RowArrays, attachment: int, row: int, work: Workspace, marker: int, c: Vector
) -> None:
    """Write ``c . J[m]`` as one row."""
    begin = system.attachments[attachment].panel + row
    width, lanes = system.attachments[attachment].width, system.lanes
    _put_product(system.panels, begin, lanes, width, work.jacobian[marker], c)


@kernel(internal=True)
def _add_product(
    panels: NDArray[np.float64], begin: int, lanes: int, width: int, J: NDArray[np.float64], c: Vector
) -> None:
    for k in range(width):
        panels[begin + k * lanes] += c[0] * J[0, k] + c[1] * J[1, k] + c[2] * J[2, k]


@kernel(inline=True, internal=True)
def add_direction_row(
    system: RowArrays, attachment: int, row: int, work: Workspace, marker: int, c: Vector
) -> None:
    """Add ``c . J[m]`` to one row."""
    begin = system.attachments[attachment].panel + row
    width, lanes = system.attachments[attachment].width, system.lanes
    _add_product(system.panels, begin, lanes, width, work.jacobian[marker], c)


@kernel(internal=True)
def write_point_bias(system: RowArrays, block: int, work: Workspace, point_a: int, point_b: int) -> None:
    """First three targets of `fill_bias`: minus the second rate of ``p_b - p_a``."""
    target, gamma = targets(system, block), minus(bias(work, point_b), bias(work, point_a))
    for k in range(3):
        target[k] = -gamma[k]


@kernel(inline=True, internal=True)
def square_row(system: RowArrays, block: int, row: int, work: Workspace, a: int, b: int) -> float:
    """Row and value of ``c . e``: direction markers c on side a, e on side b."""
    c, e = vector(work, a), vector(work, b)
    put_direction_row(system, 2 * block, row, work, a, e)
    put_direction_row(system, 2 * block + 1, row, work, b, c)
    return dot(c, e)


@kernel(internal=True)
def square_bias(work: Workspace, a: int, b: int) -> float:
    """Second rate of ``c . e`` of two markers without accelerations of the bodies."""
    return (
        dot(vector(work, a), bias(work, b))
        + dot(vector(work, b), bias(work, a))
        + 2.0 * dot(rate(work, a), rate(work, b))
    )


@kernel(inline=True, internal=True)
def travel(work: Workspace, point_a: int, point_b: int, axis: int) -> float:
    """``e . (p_b - p_a)`` with a direction marker e on side a [m]."""
    return dot(vector(work, axis), difference(work, point_a, point_b))


@kernel(inline=True, internal=True)
def travel_row(
    system: RowArrays, block: int, row: int, work: Workspace, point_a: int, point_b: int, axis: int
) -> float:
    """Row and value of the travel."""
    e, r = vector(work, axis), difference(work, point_a, point_b)
    put_direction_row(system, 2 * block, row, work, axis, r)
    add_direction_row(system, 2 * block, row, work, point_a, (-e[0], -e[1], -e[2]))
    put_direction_row(system, 2 * block + 1, row, work, point_b, e)
    return dot(e, r)


@kernel(inline=True, internal=True)
def travel_rate(work: Workspace, point_a: int, point_b: int, axis: int) -> float:
    """Rate of the travel [m/s] from the rates of the markers."""
    return dot(rate(work, axis), difference(work, point_a, point_b)) + dot(
        vector(work, axis), minus(rate(work, point_b), rate(work, point_a))
    )


@kernel(internal=True)
def travel_bias(work: Workspace, point_a: int, point_b: int, axis: int) -> float:
    """Second rate of the travel without accelerations of the bodies."""
    return (
        dot(bias(work, axis), difference(work, point_a, point_b))
        + dot(vector(work, axis), minus(bias(work, point_b), bias(work, point_a)))
        + 2.0 * dot(rate(work, axis), minus(rate(work, point_b), rate(work, point_a)))
    )


@kernel(inline=True, internal=True)
def hinge_angle(work: Workspace, x_a: int, x_b: int, y_b: int) -> float:
    """Angle from x of a to x of b about the common z [rad], in (-pi, pi]; direction markers."""
    x = vector(work, x_a)
    return math.atan2(-dot(vector(work, y_b), x), dot(vector(work, x_b), x))


@kernel(inline=True, internal=True)
def near_angle(angle: float, expected: float) -> float:
    """The angle plus the whole turns that bring it nearest to an expected one [rad]."""
    turn = 2.0 * math.pi
    return angle + turn * math.floor((expected - angle) / turn + 0.5)


@kernel(inline=True, internal=True)
def angle_row(
    system: RowArrays, block: int, row: int, work: Workspace, x_a: int, x_b: int, y_b: int
) -> float:
    """Row and value of `hinge_angle`; exact also where the z axes differ.

    Notes
    -----
    With ``s = -y_b . x_a``, ``c = x_b . x_a``: ``phi' = (c s' - s c') / (s^2 + c^2)``.
    """
    x, x2, y2 = vector(work, x_a), vector(work, x_b), vector(work, y_b)
    s, c = -dot(y2, x), dot(x2, x)
    size = 1.0 / (s * s + c * c)
    p, q = -c * size, -s * size
    put_direction_row(
        system,
        2 * block,
        row,
        work,
        x_a,
        (p * y2[0] + q * x2[0], p * y2[1] + q * x2[1], p * y2[2] + q * x2[2]),
    )
    put_direction_row(system, 2 * block + 1, row, work, y_b, (p * x[0], p * x[1], p * x[2]))
    add_direction_row(system, 2 * block + 1, row, work, x_b, (q * x[0], q * x[1], q * x[2]))
    return math.atan2(s, c)


@kernel(inline=True, internal=True)
def hinge_rate(work: Workspace, x_a: int, x_b: int, y_b: int) -> float:
    """Rate of `hinge_angle` [rad/s] from the rates of the markers."""
    x, x2, y2 = vector(work, x_a), vector(work, x_b), vector(work, y_b)
    s, c = -dot(y2, x), dot(x2, x)
    turning = rate(work, x_a)
    s_rate = -dot(rate(work, y_b), x) - dot(y2, turning)
    c_rate = dot(rate(work, x_b), x) + dot(x2, turning)
    return (c * s_rate - s * c_rate) / (s * s + c * c)


@kernel(internal=True)
def angle_bias(work: Workspace, x_a: int, x_b: int, y_b: int) -> float:
    """Second rate of `hinge_angle` without accelerations of the bodies."""
    x, x2, y2 = vector(work, x_a), vector(work, x_b), vector(work, y_b)
    s, c = -dot(y2, x), dot(x2, x)
    turning = rate(work, x_a)
    s_rate = -dot(rate(work, y_b), x) - dot(y2, turning)
    c_rate = dot(rate(work, x_b), x) + dot(x2, turning)
    size = s * s + c * c
    angle_rate = (c * s_rate - s * c_rate) / size
    s_bias, c_bias = -square_bias(work, x_a, y_b), square_bias(work, x_a, x_b)
    return (c * s_bias - s * c_bias - 2.0 * (s * s_rate + c * c_rate) * angle_rate) / size
