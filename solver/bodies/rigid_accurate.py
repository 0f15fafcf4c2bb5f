"""Rigid bodies as ordinary differential equations, for the accurate integrator.

State of a body: position of the centre of mass ``x``, quaternion ``q``, velocity ``v`` and body-axis spin
``w``, all about principal axes::

    x' = v,    q' = q o (0, w)/2,    v' = g + F/m,    I w' = t - w x I w

The quaternion of a stage is normalised where it is used; its rate is that of the quaternion as it is, so
its length is constant along the exact solution. Joints add their accelerations afterwards.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import quaternion_product, rotate_by_exponential, rotate_by_quaternion
from heavylift.numerics.small import cross
from heavylift.solver.bodies.rigid import (
    RigidBodies,
)
from heavylift.solver.bodies.rigid_stage import gather_marker_forces, prescribe
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import (
    RECORD,
    Workspace,
    begin_stage,
    complete_rates,
    displace,
    free_acceleration,
    load_state,
    measure_error,
    store_state,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@kernel(inline=True, internal=True)
def _place(dof: int, work: Workspace) -> int:
    """Place of position and quaternion in a state vector: seven numbers a body, after all velocities."""
    return work.velocity.shape[0] + dof // 6 * 7


@implement(load_state, RigidBodies)
@kernel(internal=True)
def load_rigid_state(kind: RigidBodies, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """Columns of the carried state, in the order of the vector."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame, place = kind.frame[body], at + _place(dof, work)
        for k in range(3):
            values[at + dof + k] = frame.velocity[k]
            values[at + dof + 3 + k] = frame.spin[k]
        for k in range(7):
            values[place + k] = frame.pose[k]


@kernel(internal=True)
def _write_prescribed(
    kind: RigidBodies, body: int, time: float, values: NDArray[np.float64], at: int, work: Workspace
) -> None:
    """Prescribed motion at a time into the carried columns and the state vector."""
    dof = kind.table[body].dof
    frame, place = kind.frame[body], at + _place(dof, work)
    prescribe(kind, body, time, frame)
    for k in range(3):
        values[at + dof + k] = frame.velocity[k]
        values[at + dof + 3 + k] = frame.spin[k]
    for k in range(7):
        values[place + k] = frame.pose[k]


@implement(begin_stage, RigidBodies)
@kernel(inline=True, internal=True)
def begin_rigid_stage(
    kind: RigidBodies, time: float, values: NDArray[np.float64], at: int, rate: int, work: Workspace
) -> None:
    """Rotation matrices and gyroscopic accelerations, then markers by the spin W in world axes: ``W x (W x r)``."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        if kind.table[body].motion == DRIVEN:
            _write_prescribed(kind, body, time, values, at, work)
        frame, place = kind.frame[body], _place(dof, work)
        speed, configuration, out = at + dof, at + place, rate + place
        v1, v2, v3 = values[speed], values[speed + 1], values[speed + 2]
        w1, w2, w3 = values[speed + 3], values[speed + 4], values[speed + 5]
        x1, x2, x3 = values[configuration], values[configuration + 1], values[configuration + 2]
        q0, q1, q2, q3 = (
            values[configuration + 3],
            values[configuration + 4],
            values[configuration + 5],
            values[configuration + 6],
        )
        i1, i2, i3 = frame.principal_inertia[0], frame.principal_inertia[1], frame.principal_inertia[2]
        s = 2.0 / (q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
        r11, r12, r13 = 1.0 - s * (q2 * q2 + q3 * q3), s * (q1 * q2 - q0 * q3), s * (q1 * q3 + q0 * q2)
        r21, r22, r23 = s * (q1 * q2 + q0 * q3), 1.0 - s * (q1 * q1 + q3 * q3), s * (q2 * q3 - q0 * q1)
        r31, r32, r33 = s * (q1 * q3 - q0 * q2), s * (q2 * q3 + q0 * q1), 1.0 - s * (q1 * q1 + q2 * q2)
        values[out], values[out + 1], values[out + 2] = v1, v2, v3
        values[out + 3] = -0.5 * (q1 * w1 + q2 * w2 + q3 * w3)
        values[out + 4] = 0.5 * (q0 * w1 + q2 * w3 - q3 * w2)
        values[out + 5] = 0.5 * (q0 * w2 + q3 * w1 - q1 * w3)
        values[out + 6] = 0.5 * (q0 * w3 + q1 * w2 - q2 * w1)
        work.velocity[dof] = work.velocity[dof + 1] = work.velocity[dof + 2] = 0.0
        work.velocity[dof + 3] = (i2 - i3) / i1 * w2 * w3
        work.velocity[dof + 4] = (i3 - i1) / i2 * w3 * w1
        work.velocity[dof + 5] = (i1 - i2) / i3 * w1 * w2
        R = frame.mid_rotation
        R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8] = r11, r12, r13, r21, r22, r23, r31, r32, r33
        frame.mid_position[0], frame.mid_position[1], frame.mid_position[2] = x1, x2, x3
        frame.mid_velocity[0], frame.mid_velocity[1], frame.mid_velocity[2] = v1, v2, v3
        frame.mid_spin[0] = r11 * w1 + r12 * w2 + r13 * w3
        frame.mid_spin[1] = r21 * w1 + r22 * w2 + r23 * w3
        frame.mid_spin[2] = r31 * w1 + r32 * w2 + r33 * w3
    for i in range(kind.markers.shape[0]):
        marker = kind.markers[i]
        if marker.level == RECORD:
            continue
        number, begin = marker.number, marker.data
        frame, translation = kind.frame[marker.body], 0.0 if marker.direction else 1.0
        # everything is read before anything is written: the compiler must assume that the arrays overlap
        u1, u2, u3 = kind.constants[begin], kind.constants[begin + 1], kind.constants[begin + 2]
        R = frame.mid_rotation
        r11, r12, r13, r21, r22, r23, r31, r32, r33 = R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]
        x1 = translation * frame.mid_position[0]
        x2 = translation * frame.mid_position[1]
        x3 = translation * frame.mid_position[2]
        v1 = translation * frame.mid_velocity[0]
        v2 = translation * frame.mid_velocity[1]
        v3 = translation * frame.mid_velocity[2]
        w1, w2, w3 = frame.mid_spin[0], frame.mid_spin[1], frame.mid_spin[2]
        p1 = r11 * u1 + r12 * u2 + r13 * u3
        p2 = r21 * u1 + r22 * u2 + r23 * u3
        p3 = r31 * u1 + r32 * u2 + r33 * u3
        c1, c2, c3 = cross(w1, w2, w3, p1, p2, p3)
        b1, b2, b3 = cross(w1, w2, w3, c1, c2, c3)
        seen, jacobian = work.markers[number], work.jacobian[number]
        seen.point[0], seen.point[1], seen.point[2] = x1 + p1, x2 + p2, x3 + p3
        seen.velocity[0], seen.velocity[1] = v1 + c1, v2 + c2
        seen.velocity[2] = v3 + c3
        seen.bias[0], seen.bias[1], seen.bias[2] = b1, b2, b3
        jacobian[0, 3] = r13 * u2 - r12 * u3
        jacobian[0, 4] = r11 * u3 - r13 * u1
        jacobian[0, 5] = r12 * u1 - r11 * u2
        jacobian[1, 3] = r23 * u2 - r22 * u3
        jacobian[1, 4] = r21 * u3 - r23 * u1
        jacobian[1, 5] = r22 * u1 - r21 * u2
        jacobian[2, 3] = r33 * u2 - r32 * u3
        jacobian[2, 4] = r31 * u3 - r33 * u1
        jacobian[2, 5] = r32 * u1 - r31 * u2


@implement(free_acceleration, RigidBodies)
@kernel(inline=True, internal=True)
def rigid_free_acceleration(kind: RigidBodies, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """Gravity and marker forces on top of the gyroscopic part; of prescribed bodies their own accelerations."""
    g1, g2, g3 = work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2]
    held = False
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        if kind.table[body].motion == FREE:
            work.velocity[dof] += g1
            work.velocity[dof + 1] += g2
            work.velocity[dof + 2] += g3
        else:
            held = True
    loaded = kind.markers.shape[0] > 0 and kind.markers[kind.markers.shape[0] - 1].level > 0
    if held or loaded:
        _add_loads(kind, values, at, work)


@kernel(internal=True)
def _add_loads(kind: RigidBodies, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """Marker forces and their power; accelerations of prescribed bodies and the power of their drives."""
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof, motion = kind.table[body].dof, kind.table[body].motion
        frame = kind.frame[body]
        speed = at + dof
        power = weight = 0.0
        for k in range(3):
            power += frame.force[k] * values[speed + k] + frame.moment[k] * values[speed + 3 + k]
            weight += frame.mass * work.sums.gravity[k] * values[speed + k]
        work.sums.external_work += power
        if motion == FREE:
            for k in range(3):
                work.velocity[dof + k] += frame.force[k] / frame.mass
                work.velocity[dof + 3 + k] += frame.moment[k] / frame.principal_inertia[k]
            continue
        for k in range(3):
            driven = motion == DRIVEN
            work.velocity[dof + k] = frame.acceleration[k] if driven else 0.0
            work.velocity[dof + 3 + k] = frame.spin_rate[k] if driven else 0.0
            work.sums.drive_work += frame.mass * work.velocity[dof + k] * values[speed + k]
            work.sums.drive_work += (
                frame.principal_inertia[k] * work.velocity[dof + 3 + k] * values[speed + 3 + k]
            )
        work.sums.drive_work -= power + weight


@implement(displace, RigidBodies)
@kernel(internal=True)
def displace_rigid_bodies(kind: RigidBodies, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """Along the exponential map; the quaternion comes back to unit length."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        dof = kind.table[body].dof
        move, place = work.velocity[dof : dof + 6], at + _place(dof, work)
        p = values[place + 3 : place + 7]
        length = math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])
        q = rotate_by_exponential(
            (p[0] / length, p[1] / length, p[2] / length, p[3] / length), move[3], move[4], move[5]
        )
        for k in range(3):
            values[place + k] += move[k]
        for k in range(4):
            values[place + 3 + k] = q[k]


@implement(complete_rates, RigidBodies)
@kernel(internal=True)
def complete_rigid_rates(
    kind: RigidBodies, values: NDArray[np.float64], at: int, rate: int, second: int, work: Workspace
) -> None:
    """``x' = v``, ``x'' = v'``, ``q' = q o w/2``, ``q'' = (q' o w + q o w')/2``."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        place = _place(dof, work)
        q = values[at + place + 3 : at + place + 7]
        w = values[at + dof + 3 : at + dof + 6]
        a = values[rate + dof + 3 : rate + dof + 6]
        spin, spin_rate = (0.0, w[0], w[1], w[2]), (0.0, a[0], a[1], a[2])
        quaternion = (q[0], q[1], q[2], q[3])
        turn = quaternion_product(quaternion, spin)
        half = (0.5 * turn[0], 0.5 * turn[1], 0.5 * turn[2], 0.5 * turn[3])
        bend, drift = quaternion_product(half, spin), quaternion_product(quaternion, spin_rate)
        for k in range(3):
            values[rate + place + k] = values[at + dof + k]
            values[second + place + k] = values[rate + dof + k]
        for k in range(4):
            values[rate + place + 3 + k] = half[k]
            values[second + place + 3 + k] = 0.5 * (bend[k] + drift[k])


@implement(measure_error, RigidBodies)
@kernel(internal=True)
def measure_rigid_error(
    kind: RigidBodies,
    values: NDArray[np.float64],
    fifth: int,
    third: int,
    work: Workspace,
) -> None:
    """Of the point at the reach of the body: ``e5^2 / sqrt(e5^2 + e3^2/100)``, as of DOP853.

    The orientation has an estimate of its own: of a steady spin the velocities have no error at all.
    """
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        dof, reach = kind.table[body].dof, kind.frame[body].reach
        a, b = fifth + dof, third + dof
        e5 = e3 = t5 = t3 = 0.0
        for k in range(3):
            e5 += values[a + k] ** 2
            e3 += values[b + k] ** 2
            t5 += values[a + 3 + k] ** 2
            t3 += values[b + 3 + k] ** 2
        e5 += reach * reach * t5
        e3 += reach * reach * t3
        error = e5 / math.sqrt(e5 + 0.01 * e3) if e5 > 0.0 else e5
        if error > work.control.error or math.isnan(error):  # which stays
            work.control.error = error
            work.status.body = kind.table[body].number
        place = _place(dof, work) + 3
        q5 = q3 = 0.0
        for k in range(4):
            q5 += values[fifth + place + k] ** 2
            q3 += values[third + place + k] ** 2
        if q5 > 0.0:  # half the angle
            turn = 2.0 * reach * q5 / math.sqrt(q5 + 0.01 * q3)
            work.control.pose_error = max(work.control.pose_error, turn)


@implement(store_state, RigidBodies)
@kernel(internal=True)
def store_rigid_state(
    kind: RigidBodies, time: float, values: NDArray[np.float64], at: int, rate: int, work: Workspace
) -> None:
    """``w = 2 q* o q'`` of the normalised quaternion; prescribed bodies as prescribed."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        place = _place(dof, work)
        if kind.table[body].motion == DRIVEN:
            _write_prescribed(kind, body, time, values, at, work)
        else:
            p, r = values[at + place : at + place + 7], values[rate + place : rate + place + 7]
            size = 1.0 / math.sqrt(p[3] * p[3] + p[4] * p[4] + p[5] * p[5] + p[6] * p[6])
            q = (size * p[3], size * p[4], size * p[5], size * p[6])
            back = (2.0 * size * q[0], -2.0 * size * q[1], -2.0 * size * q[2], -2.0 * size * q[3])
            w = quaternion_product(back, (r[3], r[4], r[5], r[6]))
            for k in range(3):
                frame.position[k] = p[k]
                frame.velocity[k] = values[at + dof + k] = r[k]
                frame.spin[k] = values[at + dof + 3 + k] = w[1 + k]
            for k in range(4):
                frame.orientation[k] = values[at + place + 3 + k] = q[k]
        orientation = (
            frame.orientation[0],
            frame.orientation[1],
            frame.orientation[2],
            frame.orientation[3],
        )
        L = rotate_by_quaternion(
            orientation,
            frame.principal_inertia[0] * frame.spin[0],
            frame.principal_inertia[1] * frame.spin[1],
            frame.principal_inertia[2] * frame.spin[2],
        )
        for k in range(3):
            frame.angular_momentum[k] = L[k]
