"""Steps of rigid bodies: the second-order step in momentum form, and the first-order scheme for comparison."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotate_by_exponential, rotate_by_quaternion, write_rotation_matrix
from heavylift.numerics.small import cross, rotate, rotate_back
from heavylift.solver.bodies.rigid import (
    ACCELERATION,
    ANGULAR_MOMENTUM,
    ARC,
    DOF,
    FORCE,
    INVERSE_MASS,
    INVERSE_PRINCIPAL,
    MEAN,
    MID_POSITION,
    MID_SPIN,
    MID_VELOCITY,
    MOMENT,
    MOTION,
    NUMBER,
    ORIENTATION,
    POSITION,
    PRINCIPAL,
    REACH,
    SPIN,
    SPIN_RATE,
    VELOCITY,
    WORK,
    RigidBodies,
)
from heavylift.solver.bodies.rigid_stage import (
    gather_marker_forces,
    mean_velocity,
    move_driven,
    orientation_of,
    stage_at_state,
    stage_rotation,
)
from heavylift.solver.drive import DRIVEN, FIXED, FREE
from heavylift.solver.interface import (
    Workspace,
    advance,
    check,
    end_velocity,
    estimate_error,
    factor,
    finish,
    predict,
    set_velocity,
    thesis_advance,
    thesis_velocity,
    write_velocity,
)
from heavylift.solver.kinds import implement

__all__ = ["LARGEST_TURN"]

LARGEST_TURN = 1.0
"""Turn of a body in one step [rad] above which a run stops."""

NOT_FINITE, STEP_TOO_LARGE = int(Outcome.NOT_FINITE), int(Outcome.STEP_TOO_LARGE)


@implement(predict, RigidBodies)
@kernel(internal=True)
def predict_rigid_bodies(kind: RigidBodies, time: float, step: float) -> None:
    """Arc midpoint and predicted midpoint velocities."""
    h = step
    for body in range(kind.table.shape[0]):
        frame = stage = kind.frame[body]
        a = frame[ARC] * h * h
        for k in range(3):
            stage[MID_POSITION + k] = (
                frame[POSITION + k] + 0.5 * h * frame[VELOCITY + k] + a * frame[ACCELERATION + k]
            )
            stage[MID_VELOCITY + k] = frame[VELOCITY + k] + 0.5 * h * frame[ACCELERATION + k]
            stage[MID_SPIN + k] = frame[SPIN + k] + 0.5 * h * frame[SPIN_RATE + k]
        quaternion = rotate_by_exponential(
            orientation_of(kind, body),
            0.5 * h * frame[SPIN] + a * frame[SPIN_RATE],
            0.5 * h * frame[SPIN + 1] + a * frame[SPIN_RATE + 1],
            0.5 * h * frame[SPIN + 2] + a * frame[SPIN_RATE + 2],
        )
        write_rotation_matrix(quaternion, stage_rotation(kind, body))
        if kind.table[body, MOTION] == DRIVEN:
            mean_velocity(kind, body, time + h, h)


@implement(factor, RigidBodies)
@kernel(internal=True)
def factor_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Midpoint velocity; the mass matrix is diagonal, so there is nothing to factor."""
    h = step
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body, DOF]
        frame = stage = inertia = kind.frame[body]
        if kind.table[body, MOTION] == FREE:
            L = rotate_back(
                stage_rotation(kind, body),
                frame[ANGULAR_MOMENTUM],
                frame[ANGULAR_MOMENTUM + 1],
                frame[ANGULAR_MOMENTUM + 2],
            )
            for k in range(3):
                work.velocity[dof + k] = frame[VELOCITY + k] + 0.5 * h * (
                    stage[FORCE + k] * inertia[INVERSE_MASS] + work.sums.gravity[k]
                )
                work.velocity[dof + 3 + k] = (L[k] + 0.5 * h * stage[MOMENT + k]) * inertia[
                    INVERSE_PRINCIPAL + k
                ]
        else:
            for k in range(6):  # rows see how a driven body moves over the step
                work.velocity[dof + k] = frame[MEAN + k]


@implement(check, RigidBodies)
@kernel(internal=True)
def check_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Refuse what is not finite, and turns of more than `LARGEST_TURN` in a step."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body, DOF]
        total = 0.0
        for i in range(dof, dof + 6):
            total += abs(work.velocity[i])
        w1, w2, w3 = work.velocity[dof + 3], work.velocity[dof + 4], work.velocity[dof + 5]
        if not math.isfinite(total):
            work.status.outcome = NOT_FINITE
            work.status.body = kind.table[body, NUMBER]
        elif (
            kind.table[body, MOTION] == FREE and step * math.sqrt(w1 * w1 + w2 * w2 + w3 * w3) > LARGEST_TURN
        ):
            work.status.outcome = STEP_TOO_LARGE
            work.status.body = kind.table[body, NUMBER]


@implement(advance, RigidBodies)
@kernel(internal=True)
def advance_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Configuration and momenta to the end of the step, and the work of the marker forces."""
    h = step
    for body in range(kind.table.shape[0]):
        dof = kind.table[body, DOF]
        frame = stage = inertia = kind.frame[body]
        if kind.table[body, MOTION] == DRIVEN:
            move_driven(kind, body, time + h, h, work)
            continue
        if kind.table[body, MOTION] == FIXED:
            continue
        velocity = work.velocity[dof : dof + 6]
        w1, w2, w3 = velocity[3], velocity[4], velocity[5]
        L = rotate(
            stage_rotation(kind, body),
            inertia[PRINCIPAL] * w1,
            inertia[PRINCIPAL + 1] * w2,
            inertia[PRINCIPAL + 2] * w3,
        )
        external = 0.0
        for k in range(3):
            external += stage[FORCE + k] * velocity[k] + stage[MOMENT + k] * velocity[3 + k]
            frame[POSITION + k] += h * velocity[k]
            end = 2.0 * velocity[k] - frame[VELOCITY + k]
            frame[ACCELERATION + k] = (end - frame[VELOCITY + k]) / h
            frame[VELOCITY + k] = end
            frame[ANGULAR_MOMENTUM + k] = 2.0 * L[k] - frame[ANGULAR_MOMENTUM + k]
        frame[WORK] += h * external
        quaternion = rotate_by_exponential(orientation_of(kind, body), h * w1, h * w2, h * w3)
        for k in range(4):
            frame[ORIENTATION + k] = quaternion[k]


@implement(end_velocity, RigidBodies)
@kernel(internal=True)
def end_velocity_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """End velocities from the momenta; prescribed ones as they are."""
    for body in range(kind.table.shape[0]):
        frame = inertia = kind.frame[body]
        dof = kind.table[body, DOF]
        free = kind.table[body, MOTION] == FREE
        q = orientation_of(kind, body)
        w = rotate_by_quaternion(
            (q[0], -q[1], -q[2], -q[3]),
            frame[ANGULAR_MOMENTUM],
            frame[ANGULAR_MOMENTUM + 1],
            frame[ANGULAR_MOMENTUM + 2],
        )
        for k in range(3):
            work.velocity[dof + k] = frame[VELOCITY + k]
            work.velocity[dof + 3 + k] = w[k] * inertia[INVERSE_PRINCIPAL + k] if free else frame[SPIN + k]


@implement(write_velocity, RigidBodies)
@kernel(internal=True)
def write_rigid_velocities(kind: RigidBodies, work: Workspace) -> None:
    """Velocities of the centres of mass, spins in principal axes."""
    for body in range(kind.table.shape[0]):
        dof = kind.table[body, DOF]
        for k in range(6):  # the spin follows the velocity
            work.velocity[dof + k] = kind.frame[body, VELOCITY + k]


@implement(set_velocity, RigidBodies)
@kernel(internal=True)
def set_velocity_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Projected velocities, ``L = R I w``."""
    for body in range(kind.table.shape[0]):
        if kind.table[body, MOTION] != FREE:
            continue
        frame = inertia = kind.frame[body]
        dof = kind.table[body, DOF]
        L = rotate_by_quaternion(
            orientation_of(kind, body),
            inertia[PRINCIPAL] * work.velocity[dof + 3],
            inertia[PRINCIPAL + 1] * work.velocity[dof + 4],
            inertia[PRINCIPAL + 2] * work.velocity[dof + 5],
        )
        for k in range(3):
            frame[ACCELERATION + k] += (work.velocity[dof + k] - frame[VELOCITY + k]) / step
            frame[VELOCITY + k] = work.velocity[dof + k]
            frame[ANGULAR_MOMENTUM + k] = L[k]


@implement(estimate_error, RigidBodies)
@kernel(internal=True)
def estimate_rigid_error(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Distance of the midpoint velocity from its prediction, as a displacement [m] over the step."""
    for body in range(kind.table.shape[0]):
        if kind.table[body, MOTION] != FREE:
            continue
        frame = stage = kind.frame[body]
        dof = kind.table[body, DOF]
        moved = turned = 0.0
        for k in range(3):
            moved += (work.velocity[dof + k] - stage[MID_VELOCITY + k]) ** 2
            turned += (work.velocity[dof + 3 + k] - stage[MID_SPIN + k]) ** 2
        error = step * max(math.sqrt(moved), frame[REACH] * math.sqrt(turned))
        if not error <= work.control.error:
            work.control.error = error
            work.status.body = kind.table[body, NUMBER]


@implement(finish, RigidBodies)
@kernel(internal=True)
def finish_rigid_bodies(kind: RigidBodies, step: float, work: Workspace) -> None:
    """Spin from the angular momentum at the new orientation."""
    for body in range(kind.table.shape[0]):
        if kind.table[body, MOTION] != FREE:
            continue
        frame = inertia = kind.frame[body]
        q = orientation_of(kind, body)
        back = (q[0], -q[1], -q[2], -q[3])
        L = rotate_by_quaternion(
            back, frame[ANGULAR_MOMENTUM], frame[ANGULAR_MOMENTUM + 1], frame[ANGULAR_MOMENTUM + 2]
        )
        for k in range(3):
            w = L[k] * inertia[INVERSE_PRINCIPAL + k]
            frame[SPIN_RATE + k] = (w - frame[SPIN + k]) / step
            frame[SPIN + k] = w


@implement(thesis_velocity, RigidBodies)
@kernel(internal=True)
def thesis_velocity_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Eq. 49 of the 2018 thesis without joints: ``U+ = U + h M^-1 Q``, gyroscopic torque at the start."""
    h = step
    stage_at_state(kind)
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body, DOF]
        frame = stage = inertia = kind.frame[body]
        if kind.table[body, MOTION] != FREE:
            for k in range(6):
                work.velocity[dof + k] = 0.0
            continue
        w1, w2, w3 = frame[SPIN], frame[SPIN + 1], frame[SPIN + 2]
        gyroscopic = cross(
            w1, w2, w3, inertia[PRINCIPAL] * w1, inertia[PRINCIPAL + 1] * w2, inertia[PRINCIPAL + 2] * w3
        )
        for k in range(3):
            work.velocity[dof + k] = frame[VELOCITY + k] + h * (
                stage[FORCE + k] * inertia[INVERSE_MASS] + work.sums.gravity[k]
            )
            work.velocity[dof + 3 + k] = (
                frame[SPIN + k] + h * (stage[MOMENT + k] - gyroscopic[k]) / inertia[PRINCIPAL + k]
            )


@implement(thesis_advance, RigidBodies)
@kernel(internal=True)
def thesis_advance_rigid_bodies(kind: RigidBodies, time: float, step: float, work: Workspace) -> None:
    """Configuration by the end velocity."""
    h = step
    for body in range(kind.table.shape[0]):
        dof = kind.table[body, DOF]
        frame = stage = kind.frame[body]
        if kind.table[body, MOTION] == DRIVEN:
            move_driven(kind, body, time + h, h, work)
        if kind.table[body, MOTION] != FREE:
            continue
        velocity = work.velocity[dof : dof + 6]
        external = 0.0
        for k in range(3):
            external += stage[FORCE + k] * velocity[k] + stage[MOMENT + k] * velocity[3 + k]
            frame[POSITION + k] += h * velocity[k]
            frame[VELOCITY + k] = velocity[k]
            frame[SPIN + k] = velocity[3 + k]
        frame[WORK] += h * external
        quaternion = rotate_by_exponential(
            orientation_of(kind, body), h * velocity[3], h * velocity[4], h * velocity[5]
        )
        for k in range(4):
            frame[ORIENTATION + k] = quaternion[k]
