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
from heavylift.numerics.vectors import add, cross, dot, scaled, vector, vector_at
from heavylift.solver.bodies.frames.motion import columns_of, combine_axes, write_turn
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
        w, q0 = vector_at(values, speed + 3), values[configuration + 3]
        q1, q2, q3 = vector_at(values, configuration + 4)
        i1, i2, i3 = vector(frame.principal_inertia)
        s = 2.0 / (q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3)
        a = (1.0 - s * (q2 * q2 + q3 * q3), s * (q1 * q2 - q0 * q3), s * (q1 * q3 + q0 * q2))
        b = (s * (q1 * q2 + q0 * q3), 1.0 - s * (q1 * q1 + q3 * q3), s * (q2 * q3 - q0 * q1))
        c = (s * (q1 * q3 - q0 * q2), s * (q2 * q3 + q0 * q1), 1.0 - s * (q1 * q1 + q2 * q2))
        work.velocity[dof] = work.velocity[dof + 1] = work.velocity[dof + 2] = 0.0
        work.velocity[dof + 3] = (i2 - i3) / i1 * w[1] * w[2]
        work.velocity[dof + 4] = (i3 - i1) / i2 * w[2] * w[0]
        work.velocity[dof + 5] = (i1 - i2) / i3 * w[0] * w[1]
        for k in range(3):
            frame.mid_rotation[k], frame.mid_rotation[3 + k], frame.mid_rotation[6 + k] = a[k], b[k], c[k]
            frame.mid_position[k] = values[configuration + k]
            frame.mid_velocity[k] = values[speed + k]
        frame.mid_spin[0], frame.mid_spin[1], frame.mid_spin[2] = dot(a, w), dot(b, w), dot(c, w)
    for i in range(kind.markers.shape[0]):
        marker = kind.markers[i]
        if marker.level == RECORD:
            continue
        frame, translation = kind.frame[marker.body], 0.0 if marker.direction else 1.0
        u, w = vector_at(kind.constants, marker.data), vector(frame.mid_spin)
        axes = columns_of(frame.mid_rotation)
        arm = combine_axes(axes, u)
        turned = cross(w, arm)
        point = add(scaled(translation, frame.mid_position), arm)
        rate = add(scaled(translation, frame.mid_velocity), turned)
        bias = cross(w, turned)
        seen = work.markers[marker.number]
        for k in range(3):
            seen.point[k], seen.velocity[k], seen.bias[k] = point[k], rate[k], bias[k]
        write_turn(axes, u, work.jacobian[marker.number])


@implement(free_acceleration, RigidBodies)
@kernel(inline=True, internal=True)
def rigid_free_acceleration(kind: RigidBodies, values: NDArray[np.float64], at: int, work: Workspace) -> None:
    """Gravity and marker forces on top of the gyroscopic part; of prescribed bodies their own accelerations."""
    gravity = vector(work.sums.gravity)
    held = False
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        if kind.table[body].motion == FREE:
            for k in range(3):
                work.velocity[dof + k] += gravity[k]
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
