"""State, reactions, sensors, energies and momenta of rigid bodies, in the frame of the user."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import quaternion_product, rotate_by_quaternion
from heavylift.numerics.small import cross, rotate
from heavylift.solver.bodies.rigid import (
    RigidBodies,
)
from heavylift.solver.bodies.rigid_stage import (
    gather_marker_forces,
    orientation_of,
    stage_at_state,
    stage_rotation,
)
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    record,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(record, RigidBodies)
@kernel(internal=True)
def record_rigid_bodies(kind: RigidBodies, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Columns of a body: position, quaternion, velocity, spin of the body frame, reaction of a held body."""
    gather_marker_forces(kind, work)
    stage_at_state(kind)
    for body in range(kind.table.shape[0]):
        column = kind.table[body].column
        frame = kind.frame[body]
        axes = (frame.axes[0], frame.axes[1], frame.axes[2], frame.axes[3])
        q = quaternion_product(orientation_of(kind, body), (axes[0], -axes[1], -axes[2], -axes[3]))
        arm = rotate_by_quaternion(q, frame.centre[0], frame.centre[1], frame.centre[2])
        w = rotate_by_quaternion(axes, frame.spin[0], frame.spin[1], frame.spin[2])
        spin = rotate_by_quaternion(q, w[0], w[1], w[2])
        side = cross(spin[0], spin[1], spin[2], arm[0], arm[1], arm[2])
        for k in range(4):
            row[column + 3 + k] = q[k]
        for k in range(3):
            row[column + k] = frame.position[k] - arm[k]
            row[column + 7 + k] = frame.velocity[k] - side[k]
            row[column + 10 + k] = w[k]
        if kind.table[body].motion != FREE:
            _write_reaction(kind, body, work, arm, row[column + 13 : column + 19])
    for sensor in range(kind.sensors.shape[0]):
        column, body, begin = (
            kind.sensors[sensor].number,
            kind.sensors[sensor].body,
            kind.sensors[sensor].data,
        )
        frame, data = kind.frame[body], kind.constants[begin:]
        R = stage_rotation(kind, body)
        c = cross(frame.spin[0], frame.spin[1], frame.spin[2], data[0], data[1], data[2])
        point, rate = rotate(R, data[0], data[1], data[2]), rotate(R, c[0], c[1], c[2])
        for k in range(3):
            row[column + k] = frame.position[k] + point[k]
            row[column + 3 + k] = frame.velocity[k] + rate[k]


@kernel(internal=True)
def _write_reaction(
    kind: RigidBodies,
    body: int,
    work: Workspace,
    arm: tuple[float, float, float],
    reaction: NDArray[np.float64],
) -> None:
    """Force, and moment about the origin of the body frame, world axes, that keep a body on its course."""
    frame = kind.frame[body]
    driven = 1.0 if kind.table[body].motion == DRIVEN else 0.0
    w1, w2, w3 = frame.spin[0], frame.spin[1], frame.spin[2]
    l1, l2, l3 = (
        frame.principal_inertia[0] * w1,
        frame.principal_inertia[1] * w2,
        frame.principal_inertia[2] * w3,
    )
    gyroscopic = cross(w1, w2, w3, l1, l2, l3)
    moment = rotate(
        stage_rotation(kind, body),
        driven * (frame.principal_inertia[0] * frame.spin_rate[0] + gyroscopic[0])
        - frame.moment[0]
        - frame.joint_force[3],
        driven * (frame.principal_inertia[1] * frame.spin_rate[1] + gyroscopic[1])
        - frame.moment[1]
        - frame.joint_force[4],
        driven * (frame.principal_inertia[2] * frame.spin_rate[2] + gyroscopic[2])
        - frame.moment[2]
        - frame.joint_force[5],
    )
    for k in range(3):
        reaction[k] = (
            frame.mass * (driven * frame.acceleration[k] - work.sums.gravity[k])
            - frame.force[k]
            - frame.joint_force[k]
        )
    about_origin = cross(arm[0], arm[1], arm[2], reaction[0], reaction[1], reaction[2])
    for k in range(3):
        reaction[3 + k] = moment[k] + about_origin[k]


@implement(add_totals, RigidBodies)
@kernel(internal=True)
def add_rigid_totals(kind: RigidBodies, work: Workspace) -> None:
    """Energies and momenta from the carried velocities."""
    totals = work.sums
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        m = frame.mass
        L = rotate_by_quaternion(
            orientation_of(kind, body),
            frame.principal_inertia[0] * frame.spin[0],
            frame.principal_inertia[1] * frame.spin[1],
            frame.principal_inertia[2] * frame.spin[2],
        )
        x = cross(
            frame.position[0],
            frame.position[1],
            frame.position[2],
            m * frame.velocity[0],
            m * frame.velocity[1],
            m * frame.velocity[2],
        )
        for k in range(3):
            totals.kinetic += 0.5 * (
                m * frame.velocity[k] ** 2 + frame.principal_inertia[k] * frame.spin[k] ** 2
            )
            totals.potential -= m * work.sums.gravity[k] * frame.position[k]
            totals.linear_momentum[k] += m * frame.velocity[k]
            totals.angular_momentum[k] += L[k] + x[k]
        totals.external_work += frame.external_work
        totals.drive_work += frame.drive_work
