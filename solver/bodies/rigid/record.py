"""State, reactions, sensors, energies and momenta of rigid bodies, in the frame of the user."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import quaternion_product, rotate_by_quaternion
from heavylift.numerics.vectors import Vector, cross, rotate
from heavylift.solver.bodies.frames.base import FrameMotion
from heavylift.solver.bodies.frames.motion import (
    add_momenta,
    frame_outputs,
    held_outputs,
    orientation_of,
    point_outputs,
    write_motion,
    write_point,
)
from heavylift.solver.bodies.rigid.kind import RigidFrame, RigidFrames
from heavylift.solver.bodies.rigid.step import (
    gather_marker_forces,
    principal_momentum,
    spatial_momentum,
    stage_at_state,
)
from heavylift.solver.drive import DRIVEN, FREE
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    record,
)
from heavylift.solver.kinds import implement
from heavylift.solver.scene.bodies import HeldOutputs

__all__: list[str] = []


@implement(record, RigidFrames)
@kernel(internal=True)
def record_rigid_bodies(kind: RigidFrames, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Motion of the frames of the user, reactions of those that are held, sensors."""
    gather_marker_forces(kind, work)
    stage_at_state(kind)
    for body in range(kind.table.shape[0]):
        entry, frame = kind.table[body], kind.frame[body]
        arm = _put_user_motion(frame, frame.end)
        write_motion(frame.end, frame_outputs(row, entry.column))
        if entry.motion != FREE:
            _write_reaction(kind, body, work, arm, held_outputs(row, entry.held))
    for i in range(kind.sensors.shape[0]):
        sensor = kind.sensors[i]
        u = kind.constants[sensor.data :]
        out = point_outputs(row, sensor.number)
        write_point(kind.frame[sensor.body], (u[0], u[1], u[2]), (0.0, 0.0, 0.0), out)


@kernel(internal=True)
def _put_user_motion(frame: RigidFrame, out: FrameMotion) -> Vector:
    """Write pose and velocities of the frame of the user; returns the centre of mass from there, world axes [m]."""
    axes = (frame.axes[0], frame.axes[1], frame.axes[2], frame.axes[3])
    q = quaternion_product(orientation_of(frame), (axes[0], -axes[1], -axes[2], -axes[3]))
    arm = rotate_by_quaternion(q, frame.centre[0], frame.centre[1], frame.centre[2])
    w = rotate_by_quaternion(axes, frame.spin[0], frame.spin[1], frame.spin[2])
    spin = rotate_by_quaternion(q, w[0], w[1], w[2])
    side = cross(spin, arm)
    for k in range(4):
        out.orientation[k] = q[k]
    for k in range(3):
        out.position[k] = frame.position[k] - arm[k]
        out.velocity[k] = frame.velocity[k] - side[k]
        out.spin[k] = w[k]
    return arm


@kernel(internal=True)
def _write_reaction(
    kind: RigidFrames,
    body: int,
    work: Workspace,
    arm: Vector,
    out: HeldOutputs,
) -> None:
    """Force, and moment about the origin of the body frame, world axes, that keep a body on its course."""
    frame, dof = kind.frame[body], kind.table[body].dof
    driven = 1.0 if kind.table[body].motion == DRIVEN else 0.0
    gyroscopic = cross(frame.spin, principal_momentum(frame, frame.spin))
    moment = rotate(
        frame.mid_rotation,
        (
            driven * (frame.principal_inertia[0] * frame.spin_rate[0] + gyroscopic[0])
            - frame.moment[0]
            - work.row_force[dof + 3],
            driven * (frame.principal_inertia[1] * frame.spin_rate[1] + gyroscopic[1])
            - frame.moment[1]
            - work.row_force[dof + 4],
            driven * (frame.principal_inertia[2] * frame.spin_rate[2] + gyroscopic[2])
            - frame.moment[2]
            - work.row_force[dof + 5],
        ),
    )
    for k in range(3):
        out.reaction_force[k] = (
            frame.mass * (driven * frame.acceleration[k] - work.sums.gravity[k])
            - frame.force[k]
            - work.row_force[dof + k]
        )
    about_origin = cross(arm, out.reaction_force)
    for k in range(3):
        out.reaction_moment[k] = moment[k] + about_origin[k]


@implement(add_totals, RigidFrames)
@kernel(internal=True)
def add_rigid_totals(kind: RigidFrames, work: Workspace) -> None:
    """Energies and momenta from the carried velocities."""
    totals = work.sums
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        m = frame.mass
        for k in range(3):
            totals.kinetic += 0.5 * (
                m * frame.velocity[k] ** 2 + frame.principal_inertia[k] * frame.spin[k] ** 2
            )
            totals.potential -= m * work.sums.gravity[k] * frame.position[k]
        p = (m * frame.velocity[0], m * frame.velocity[1], m * frame.velocity[2])
        add_momenta(frame, p, spatial_momentum(frame, frame.spin), totals)
