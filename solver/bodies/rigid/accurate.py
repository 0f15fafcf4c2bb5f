"""Rigid bodies as ordinary differential equations, for the accurate integrator.

State of a body: position of the centre of mass ``x``, quaternion ``q``, velocity ``v`` and body-axis spin
``w``, all about principal axes::

    x' = v,    q' = q o (0, w)/2,    v' = g + F/m,    I w' = t - w x I w

The quaternion of a stage is normalised where it is used. Joints add their accelerations afterwards.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross
from heavylift.solver.bodies.rigid.kind import RigidBodies
from heavylift.solver.bodies.rigid.step import gather_marker_forces, prescribe, start_rigid_bodies
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import (
    RECORD,
    Workspace,
    begin_stage,
    free_acceleration,
    store_state,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(begin_stage, RigidBodies)
@kernel(inline=True, internal=True)
def begin_rigid_stage(
    kind: RigidBodies, time: float, values: NDArray[np.float64], at: int, work: Workspace
) -> None:
    """Rotation matrices and gyroscopic accelerations, then markers by the spin W in world axes: ``W x (W x r)``."""
    for body in range(kind.table.shape[0]):
        dof, frame = kind.table[body].dof, kind.frame[body]
        speed, configuration = at + dof, at + kind.table[body].state_place
        if kind.table[body].motion == DRIVEN:
            prescribe(kind, body, time, frame)
            for k in range(6):
                values[speed + k] = frame.twist[k]
            for k in range(7):
                values[configuration + k] = frame.pose[k]
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
        c1, c2, c3 = cross((w1, w2, w3), (p1, p2, p3))
        b1, b2, b3 = cross((w1, w2, w3), (c1, c2, c3))
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


@implement(store_state, RigidBodies)
@kernel(internal=True)
def store_rigid_state(
    kind: RigidBodies, time: float, values: NDArray[np.float64], at: int, work: Workspace
) -> None:
    """Momenta follow; driven bodies move as prescribed."""
    for body in range(kind.table.shape[0]):
        frame, speed, place = kind.frame[body], at + kind.table[body].dof, at + kind.table[body].state_place
        for k in range(6):
            frame.twist[k] = values[speed + k]
        for k in range(7):
            frame.pose[k] = values[place + k]
    start_rigid_bodies(kind, time, work)
