"""What follows from the coordinates of bodies alone, for the accurate integrator: rates, displacements, errors.

With position ``x``, quaternion ``q``, velocity ``v`` and spin ``w`` of a pose, and nodal vectors ``e``::

    x' = v,    q' = q o (0, w)/2,    q'' = ( q' o (0, w) + q o (0, w') )/2,    e' = v

The rate of a quaternion is that of the quaternion as it is, so its length is constant along the exact solution.
"""

from __future__ import annotations

import math

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Records
from heavylift.numerics.rotation import quaternion_product, rotate_by_exponential
from heavylift.solver.combination import copy_parts
from heavylift.solver.drive import FREE
from heavylift.solver.interface import Coordinates, Workspace

__all__ = [
    "add_to_nodes",
    "displace_poses",
    "fastest_spin",
    "measure_error",
    "squared_error",
    "write_rates",
    "write_second_rates",
    "write_velocities",
]


@kernel(internal=True)
def write_rates(coordinates: Records[Coordinates], values: Floats1, at: int, rate: int) -> None:
    """Rates of all coordinates of the state vector at `at` into the vector at `rate`."""
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        place, speed, out = at + one.place, at + one.velocity, rate + one.place
        if one.count > 0:
            copy_parts(values, speed, values, out, one.count)
            continue
        q0, q1, q2, q3 = values[place + 3], values[place + 4], values[place + 5], values[place + 6]
        v1, v2, v3 = values[speed], values[speed + 1], values[speed + 2]
        w1, w2, w3 = values[speed + 3], values[speed + 4], values[speed + 5]
        values[out], values[out + 1], values[out + 2] = v1, v2, v3
        values[out + 3] = -0.5 * (q1 * w1 + q2 * w2 + q3 * w3)
        values[out + 4] = 0.5 * (q0 * w1 + q2 * w3 - q3 * w2)
        values[out + 5] = 0.5 * (q0 * w2 + q3 * w1 - q1 * w3)
        values[out + 6] = 0.5 * (q0 * w3 + q1 * w2 - q2 * w1)


@kernel(internal=True)
def write_second_rates(
    coordinates: Records[Coordinates], values: Floats1, at: int, rate: int, second: int
) -> None:
    """Second rates of all coordinates, from state, rates and accelerations.

    Velocities of nodal vectors are interpolated as rates of the coordinates only.
    """
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        place, speed = one.place, one.velocity
        if one.count > 0:
            copy_parts(values, rate + speed, values, second + place, one.count)
            continue
        q, turn = values[at + place + 3 : at + place + 7], values[rate + place + 3 : rate + place + 7]
        w, a = values[at + speed + 3 : at + speed + 6], values[rate + speed + 3 : rate + speed + 6]
        bend = quaternion_product((turn[0], turn[1], turn[2], turn[3]), (0.0, w[0], w[1], w[2]))
        drift = quaternion_product((q[0], q[1], q[2], q[3]), (0.0, a[0], a[1], a[2]))
        for k in range(3):
            values[second + place + k] = values[rate + speed + k]
        for k in range(4):
            values[second + place + 3 + k] = 0.5 * (bend[k] + drift[k])


@kernel(internal=True)
def write_velocities(coordinates: Records[Coordinates], values: Floats1, at: int, rate: int) -> None:
    """Velocities from the rates of the coordinates, ``w = 2 q* o q'`` of a quaternion, which gets unit length."""
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        place, speed = one.place, at + one.velocity
        if one.count > 0:
            copy_parts(values, rate + place, values, speed, one.count)
            continue
        p, r = values[at + place : at + place + 7], values[rate + place : rate + place + 7]
        size = 1.0 / math.sqrt(p[3] * p[3] + p[4] * p[4] + p[5] * p[5] + p[6] * p[6])
        q = (size * p[3], size * p[4], size * p[5], size * p[6])
        back = (2.0 * size * q[0], -2.0 * size * q[1], -2.0 * size * q[2], -2.0 * size * q[3])
        w = quaternion_product(back, (r[3], r[4], r[5], r[6]))
        for k in range(3):
            values[speed + k], values[speed + 3 + k] = r[k], w[1 + k]
        for k in range(4):
            p[3 + k] = q[k]


@kernel(internal=True)
def displace_poses(coordinates: Records[Coordinates], values: Floats1, at: int, move: Floats1) -> None:
    """Free ones, along the exponential map; quaternions come back to unit length."""
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        if one.count > 0 or one.motion != FREE:
            continue
        place, first = at + one.place, one.velocity
        p = values[place + 3 : place + 7]
        length = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
        q = rotate_by_exponential(
            (p[0] / length, p[1] / length, p[2] / length, p[3] / length),
            move[first + 3],
            move[first + 4],
            move[first + 5],
        )
        for k in range(3):
            values[place + k] += move[first + k]
        for k in range(4):
            p[k] = q[k]


@kernel(internal=True)
def add_to_nodes(
    coordinates: Records[Coordinates], values: Floats1, at: int, change: int, to_velocity: bool
) -> None:
    """Velocities of nodes in the vector at `change`, to the coordinates or to the velocities of the one at `at`."""
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        to, more = at + (one.velocity if to_velocity else one.place), change + one.velocity
        for k in range(one.count):
            values[to + k] += values[more + k]


@kernel(inline=True, internal=True)
def squared_error(fifth: float, third: float) -> float:
    """``( e5^2 / sqrt(e5^2 + e3^2/100) )^2``, as of DOP853, from squares."""
    return fifth * fifth / (fifth + 0.01 * third) if fifth > 0.0 else fifth


@kernel(internal=True)
def _nodal_error(one: Coordinates, values: Floats1, fifth: int, third: int) -> float:
    """Largest squared error of the velocity of a node."""
    largest = 0.0
    for node in range(one.velocity, one.velocity + one.count, one.stride):
        e5 = e3 = 0.0
        for k in range(node, node + 3):
            e5 += values[fifth + k] ** 2
            e3 += values[third + k] ** 2
        error = squared_error(e5, e3)
        if error > largest or math.isnan(error):  # which stays
            largest = error
    return largest


@kernel(internal=True)
def _pose_error(one: Coordinates, values: Floats1, fifth: int, third: int, work: Workspace) -> float:
    """Squared error of the velocity of the point at the reach of a body."""
    a, b, square = fifth + one.velocity, third + one.velocity, one.reach * one.reach
    e5 = e3 = t5 = t3 = q5 = q3 = 0.0
    for k in range(3):
        e5 += values[a + k] ** 2
        e3 += values[b + k] ** 2
        t5 += values[a + 3 + k] ** 2
        t3 += values[b + 3 + k] ** 2
    a, b = fifth + one.place + 3, third + one.place + 3
    for k in range(4):
        q5 += values[a + k] ** 2
        q3 += values[b + k] ** 2
    turn = 2.0 * math.sqrt(squared_error(q5, q3))
    work.control.pose_error = max(work.control.pose_error, one.reach * turn)
    return squared_error(e5 + square * t5, e3 + square * t3)


@kernel(internal=True)
def fastest_spin(coordinates: Records[Coordinates], values: Floats1, at: int) -> float:
    """Largest angular velocity of a free body [rad/s]."""
    largest = 0.0
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        if one.motion == FREE and one.count == 0:
            w = values[at + one.velocity + 3 : at + one.velocity + 6]
            largest = max(largest, w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    return math.sqrt(largest)


@kernel(internal=True)
def measure_error(
    coordinates: Records[Coordinates], values: Floats1, fifth: int, third: int, work: Workspace
) -> None:
    """Raise `work.control.error` to the largest error [m/s] of a point, and `pose_error` to that of orientations.

    The latter are looked at because of a steady spin the velocities have no error at all.
    """
    for i in range(coordinates.shape[0]):
        one = coordinates[i]
        if one.motion != FREE:
            continue
        if one.count > 0:
            error = math.sqrt(_nodal_error(one, values, fifth, third))
        else:
            error = math.sqrt(_pose_error(one, values, fifth, third, work))
        if error > work.control.error or math.isnan(error):  # which stays
            work.control.error = error
            work.status.body = one.number
