"""Steps of rigid bodies: the second-order step in momentum form, and the first-order scheme for comparison."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import rotate_by_quaternion
from heavylift.numerics.vectors import cross, rotate, rotate_back
from heavylift.solver.bodies.frames.motion import advance_pose, orientation_of, predict_pose
from heavylift.solver.bodies.rigid.kind import RigidBodies, RigidFrame, RigidFrames
from heavylift.solver.bodies.rigid.stage import (
    gather_marker_forces,
    mean_velocity,
    move_driven,
    spatial_momentum,
    stage_at_state,
)
from heavylift.solver.drive import DRIVEN, FIXED, FREE
from heavylift.solver.interface import (
    Workspace,
    advance,
    end_velocity,
    estimate_error,
    factor,
    finish,
    predict,
    set_velocity,
    thesis_advance,
    thesis_velocity,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(predict, RigidFrames)
@kernel(internal=True)
def predict_rigid_bodies(kind: RigidFrames, time: float, step: float) -> None:
    """Arc midpoint and predicted midpoint velocities."""
    h = step
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        predict_pose(frame, h, frame.arc * h * h)
        for k in range(3):
            frame.mid_velocity[k] = frame.velocity[k] + 0.5 * h * frame.acceleration[k]
            frame.mid_spin[k] = frame.spin[k] + 0.5 * h * frame.spin_rate[k]
        if kind.table[body].motion == DRIVEN:
            mean_velocity(kind, body, time + h, h)


@kernel(inline=True, internal=True)
def _axial_momentum_at_middle(frame: RigidFrame, step: float) -> float:
    """Momentum of a slender body about its axis, in the middle of a step without moments.

    The part of the spatial momentum along the axis is not it: where the predicted axis is off by an angle, the momentum
    across it has a part along it that is that angle times the ratio of the moments of inertia too large for the spin.
    """
    I, w = frame.principal_inertia, frame.mid_spin
    return I[0] * frame.spin[0] + 0.5 * step * (I[1] - I[2]) * w[1] * w[2]


@implement(factor, RigidBodies)
@kernel(internal=True)
def factor_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Midpoint velocity; the mass matrix is diagonal, so there is nothing to factor."""
    h = step
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion == FREE:
            L = rotate_back(frame.mid_rotation, frame.angular_momentum)
            if frame.slender:
                L = _axial_momentum_at_middle(frame, h), L[1], L[2]
            for k in range(3):
                work.velocity[dof + k] = frame.velocity[k] + 0.5 * h * (
                    frame.force[k] * frame.inverse_mass + work.sums.gravity[k]
                )
                work.velocity[dof + 3 + k] = (L[k] + 0.5 * h * frame.moment[k]) * frame.inverse_inertia[k]
        else:
            for k in range(6):  # rows see how a driven body moves over the step
                work.velocity[dof + k] = frame.mean_twist[k]


@kernel(internal=True)
def _put_axial_momentum(frame: RigidFrame, axial: float) -> None:
    """Replace the part of the angular momentum along the axis of a slender body."""
    q = orientation_of(frame)
    L = frame.angular_momentum
    across = rotate_by_quaternion((q[0], -q[1], -q[2], -q[3]), L[0], L[1], L[2])
    turned = rotate_by_quaternion(q, axial, across[1], across[2])
    for k in range(3):
        L[k] = turned[k]


@implement(advance, RigidFrames)
@kernel(internal=True)
def advance_rigid_bodies(kind: RigidFrames, time: float, step: float, work: Workspace) -> None:
    """Configuration and momenta to the end of the step, and the work of the marker forces."""
    h = step
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion == DRIVEN:
            move_driven(kind, body, time + h, h, work)
            continue
        if kind.table[body].motion == FIXED:
            continue
        velocity = work.velocity[dof : dof + 6]
        w1, w2, w3 = velocity[3], velocity[4], velocity[5]
        L = rotate(
            frame.mid_rotation,
            (
                frame.principal_inertia[0] * w1,
                frame.principal_inertia[1] * w2,
                frame.principal_inertia[2] * w3,
            ),
        )
        external = 0.0
        for k in range(3):
            external += frame.force[k] * velocity[k] + frame.moment[k] * velocity[3 + k]
            end = 2.0 * velocity[k] - frame.velocity[k]
            frame.acceleration[k] = (end - frame.velocity[k]) / h
            frame.velocity[k] = end
            frame.angular_momentum[k] = 2.0 * L[k] - frame.angular_momentum[k]
        frame.external_work += h * external
        advance_pose(frame, velocity, h)
        if frame.slender:
            _put_axial_momentum(frame, frame.principal_inertia[0] * (2.0 * w1 - frame.spin[0]))


@implement(end_velocity, RigidFrames)
@kernel(internal=True)
def end_velocity_rigid_bodies(kind: RigidFrames, step: float, work: Workspace) -> None:
    """End velocities from the momenta; prescribed ones as they are."""
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        dof = kind.table[body].dof
        free = kind.table[body].motion == FREE
        q = orientation_of(frame)
        w = rotate_by_quaternion(
            (q[0], -q[1], -q[2], -q[3]),
            frame.angular_momentum[0],
            frame.angular_momentum[1],
            frame.angular_momentum[2],
        )
        for k in range(3):
            work.velocity[dof + k] = frame.velocity[k]
            work.velocity[dof + 3 + k] = w[k] * frame.inverse_inertia[k] if free else frame.spin[k]


@implement(set_velocity, RigidFrames)
@kernel(internal=True)
def set_velocity_rigid_bodies(kind: RigidFrames, step: float, work: Workspace) -> None:
    """Projected velocities, ``L = R I w``."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        dof = kind.table[body].dof
        L = spatial_momentum(frame, work.velocity[dof + 3], work.velocity[dof + 4], work.velocity[dof + 5])
        for k in range(3):
            frame.acceleration[k] += (work.velocity[dof + k] - frame.velocity[k]) / step
            frame.velocity[k] = work.velocity[dof + k]
            frame.angular_momentum[k] = L[k]


@implement(estimate_error, RigidFrames)
@kernel(internal=True)
def estimate_rigid_error(kind: RigidFrames, step: float, work: Workspace) -> None:
    """Distance of the midpoint velocity from its prediction, as a displacement [m] over the step."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        dof = kind.table[body].dof
        moved = turned = 0.0
        for k in range(3):
            moved += (work.velocity[dof + k] - frame.mid_velocity[k]) ** 2
            turned += (work.velocity[dof + 3 + k] - frame.mid_spin[k]) ** 2
        error = step * max(math.sqrt(moved), frame.reach * math.sqrt(turned))
        if not error <= work.control.error:
            work.control.error = error
            work.status.body = kind.table[body].number


@implement(finish, RigidFrames)
@kernel(internal=True)
def finish_rigid_bodies(kind: RigidFrames, step: float, work: Workspace) -> None:
    """Spin from the angular momentum at the new orientation."""
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion != FREE:
            continue
        frame = kind.frame[body]
        q = orientation_of(frame)
        back = (q[0], -q[1], -q[2], -q[3])
        L = rotate_by_quaternion(
            back, frame.angular_momentum[0], frame.angular_momentum[1], frame.angular_momentum[2]
        )
        for k in range(3):
            w = L[k] * frame.inverse_inertia[k]
            frame.spin_rate[k] = (w - frame.spin[k]) / step
            frame.spin[k] = w


@implement(thesis_velocity, RigidBodies)
@kernel(internal=True)
def thesis_velocity_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Eq. 49 of the 2018 thesis without joints: ``U+ = U + h M^-1 Q``, gyroscopic torque at the start."""
    h = step
    stage_at_state(kind)
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion != FREE:
            for k in range(6):
                work.velocity[dof + k] = 0.0
            continue
        w1, w2, w3 = frame.spin[0], frame.spin[1], frame.spin[2]
        gyroscopic = cross(
            (w1, w2, w3),
            (
                frame.principal_inertia[0] * w1,
                frame.principal_inertia[1] * w2,
                frame.principal_inertia[2] * w3,
            ),
        )
        for k in range(3):
            work.velocity[dof + k] = frame.velocity[k] + h * (
                frame.force[k] * frame.inverse_mass + work.sums.gravity[k]
            )
            work.velocity[dof + 3 + k] = (
                frame.spin[k] + h * (frame.moment[k] - gyroscopic[k]) / frame.principal_inertia[k]
            )


@implement(thesis_advance, RigidBodies)
@kernel(internal=True)
def thesis_advance_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Configuration by the end velocity."""
    h = step
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        frame = kind.frame[body]
        if kind.table[body].motion == DRIVEN:
            move_driven(kind, body, time + h, h, work)
        if kind.table[body].motion != FREE:
            continue
        velocity = work.velocity[dof : dof + 6]
        external = 0.0
        for k in range(3):
            external += frame.force[k] * velocity[k] + frame.moment[k] * velocity[3 + k]
            frame.velocity[k] = velocity[k]
            frame.spin[k] = velocity[3 + k]
        frame.external_work += h * external
        advance_pose(frame, velocity, h)
