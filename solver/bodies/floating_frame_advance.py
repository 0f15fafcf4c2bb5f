"""End of the second-order step of floating-frame bodies: checks, (F5) and (F6) of `floating_frame_step`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.small import cross, rotate, rotate_back
from heavylift.solver.bodies.floating_frame import (
    ACCELERATION,
    ANGULAR_MOMENTUM,
    AT_Q,
    AT_RATE,
    AT_RATE2,
    DAMPING,
    DOF,
    DRIVE,
    DRIVEN,
    END_ROTATION,
    FIRST_MOMENT,
    FORCE,
    FREE,
    LAG,
    LOAD,
    MID_POSITION,
    MODAL,
    MODES,
    MOMENT,
    MOMENTUM,
    MOTION,
    NUMBER,
    ORIENTATION,
    POSITION,
    PRESCRIBED,
    RATE,
    RATE2,
    SHAPE_MASS,
    SPIN,
    SPIN_RATE,
    START_VELOCITY,
    TF1,
    TRANSPORTED,
    VELOCITY,
    WORK,
    FloatingFrameBodies,
    Q,
)
from heavylift.solver.bodies.floating_frame_inertia import (
    body_momenta,
    deformed_inertia,
    frame_velocity_from_momenta,
)
from heavylift.solver.bodies.floating_frame_shape import shape_of, stage_rotation
from heavylift.solver.bodies.floating_frame_stage import update_products
from heavylift.solver.drive import drive_pose
from heavylift.solver.interface import (
    FIELD,
    STATUS_BODY,
    STATUS_OUTCOME,
    Workspace,
    advance,
    check,
    finish,
)
from heavylift.solver.kinds import implement

__all__ = ["LARGEST_TURN"]

LARGEST_TURN = 0.25
"""Turn of a frame in one step [rad] above which errors are of order one (thin bodies first)."""

NOT_FINITE, STEP_TOO_LARGE = int(Outcome.NOT_FINITE), int(Outcome.STEP_TOO_LARGE)


@implement(check, FloatingFrameBodies)
@kernel(internal=True)
def check_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Refuse what is not finite, and turns of more than `LARGEST_TURN` in a step."""
    for body in range(kind.table.shape[0]):
        n, dof = kind.table[body, MODES], kind.table[body, DOF]
        total = 0.0
        for i in range(dof, dof + 6 + n):
            total += abs(work.velocity[i])
        w1, w2, w3 = work.velocity[dof + 3], work.velocity[dof + 4], work.velocity[dof + 5]
        turn = step * math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
        if not math.isfinite(total):
            work.status[STATUS_OUTCOME] = NOT_FINITE
            work.status[STATUS_BODY] = kind.table[body, NUMBER]
        elif turn > LARGEST_TURN and kind.table[body, MOTION] == FREE:
            work.status[STATUS_OUTCOME] = STEP_TOO_LARGE
            work.status[STATUS_BODY] = kind.table[body, NUMBER]


@implement(advance, FloatingFrameBodies)
@kernel(reassociate=True, internal=True)
def advance_floating_frames(kind: FloatingFrameBodies, time: float, step: float, work: Workspace) -> None:
    """(F5): configuration and momenta to the end of the step, and the work of forces and dampers."""
    h = step
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        motion = kind.table[body, MOTION]
        frame = stage = kind.frame[body]
        velocity = work.velocity[dof : dof + 6 + n]
        external = dissipated = 0.0
        for j in range(6):
            external += stage[FORCE + j] * velocity[j]
        for i in range(n):
            rate = velocity[6 + i]
            external += kind.modal[LOAD, first + i] * rate
            dissipated += kind.modal[DAMPING, first + i] * rate * rate
        frame[WORK] += h * external
        frame[WORK + 2] += h * dissipated
        if motion == FREE:
            R = stage_rotation(kind, body)
            v = rotate_back(R, velocity[0], velocity[1], velocity[2])
            w = (velocity[3], velocity[4], velocity[5])
            p, l = body_momenta(
                shape_of(kind, body), stage, kind.modal[TF1:, first : first + n], v, w, velocity[6:]
            )
            p1, p2, p3 = rotate(R, p[0], p[1], p[2])
            l1, l2, l3 = rotate(R, l[0], l[1], l[2])
            for k in range(3):
                frame[POSITION + k] += h * velocity[k]
            frame[MOMENTUM] = 2.0 * p1 - frame[MOMENTUM]
            frame[MOMENTUM + 1] = 2.0 * p2 - frame[MOMENTUM + 1]
            frame[MOMENTUM + 2] = 2.0 * p3 - frame[MOMENTUM + 2]
            moved = cross(
                stage[MID_POSITION] - frame[POSITION],
                stage[MID_POSITION + 1] - frame[POSITION + 1],
                stage[MID_POSITION + 2] - frame[POSITION + 2],
                frame[MOMENTUM],
                frame[MOMENTUM + 1],
                frame[MOMENTUM + 2],
            )
            frame[ANGULAR_MOMENTUM] = 2.0 * l1 - stage[TRANSPORTED] + moved[0]
            frame[ANGULAR_MOMENTUM + 1] = 2.0 * l2 - stage[TRANSPORTED + 1] + moved[1]
            frame[ANGULAR_MOMENTUM + 2] = 2.0 * l3 - stage[TRANSPORTED + 2] + moved[2]
            quaternion = rotate_by_exponential(
                (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3]),
                h * w[0],
                h * w[1],
                h * w[2],
            )
            for k in range(4):
                frame[ORIENTATION + k] = quaternion[k]
        elif motion == DRIVEN:
            drive_pose(kind.constants[kind.table[body, DRIVE] :], time + h, frame[POSITION : POSITION + 7])
            for k in range(3):
                frame[VELOCITY + k] = stage[PRESCRIBED + k]
                frame[SPIN + k] = stage[PRESCRIBED + 3 + k]
        for i in range(n):
            rate = 2.0 * velocity[6 + i] - kind.modal[RATE, first + i]
            kind.modal[Q, first + i] += h * velocity[6 + i]
            kind.modal[RATE2, first + i] = (rate - kind.modal[RATE, first + i]) / h
            kind.modal[RATE, first + i] = rate


@implement(finish, FloatingFrameBodies)
@kernel(internal=True)
def finish_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """(F6): frame velocities from momenta; difference quotients for the next prediction."""
    h = step
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        motion = kind.table[body, MOTION]
        frame = stage = kind.frame[body]
        modes = slice(first, first + n)
        shape = shape_of(kind, body)
        products = kind.products[:, 8 * first : 8 * (first + n)]
        for r in range(3 * n):
            products[AT_RATE2, r] = products[AT_RATE, r]
        update_products(kind, body)
        for r in range(3 * n):
            products[AT_RATE2, r] = (products[AT_RATE, r] - products[AT_RATE2, r]) / h
        deformed_at_midpoint = deformed_moment(stage, work.sums, stage_rotation(kind, body))
        deformed_inertia(shape, kind.modal[Q, modes], products[AT_Q], stage, kind.modal[TF1:, modes])
        R = kind.frame[body, END_ROTATION : END_ROTATION + 9]
        write_rotation_matrix(
            (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3]), R
        )
        if motion == FREE:
            p = rotate_back(R, frame[MOMENTUM], frame[MOMENTUM + 1], frame[MOMENTUM + 2])
            l = rotate_back(
                R, frame[ANGULAR_MOMENTUM], frame[ANGULAR_MOMENTUM + 1], frame[ANGULAR_MOMENTUM + 2]
            )
            v, w = frame_velocity_from_momenta(
                shape, stage, kind.modal[TF1:, modes], p, l, kind.modal[RATE, modes]
            )
            v1, v2, v3 = rotate(R, v[0], v[1], v[2])
            frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2] = v1, v2, v3
            frame[SPIN], frame[SPIN + 1], frame[SPIN + 2] = w
        else:
            v = rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2])
            p, l = body_momenta(
                shape,
                stage,
                kind.modal[TF1:, modes],
                v,
                (frame[SPIN], frame[SPIN + 1], frame[SPIN + 2]),
                kind.modal[RATE, modes],
            )
            _add_drive_work(
                kind,
                body,
                h,
                work,
                rotate(R, p[0], p[1], p[2]),
                rotate(R, l[0], l[1], l[2]),
                deformed_at_midpoint,
            )
        if motion == FREE:
            dof = kind.table[body, DOF]
            for k in range(6):
                end = frame[VELOCITY + k]  # the spin follows the velocity
                middle = work.velocity[dof + k] - 0.5 * (stage[START_VELOCITY + k] + end)
                frame[LAG + k] = 0.5 * (frame[LAG + k] + middle)
        for k in range(3):
            frame[ACCELERATION + k] = (frame[VELOCITY + k] - stage[START_VELOCITY + k]) / h
            frame[SPIN_RATE + k] = (frame[SPIN + k] - stage[START_VELOCITY + 3 + k]) / h


@kernel(inline=True)
def deformed_moment(
    stage: NDArray[np.float64], field: NDArray[np.float64], R: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Moment of gravity about the frame origin at the midpoint, world axes: ``R S_t x g``."""
    s = rotate(R, stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2])
    return cross(s[0], s[1], s[2], field[0], field[1], field[2])


@kernel(internal=True)
def _add_drive_work(
    kind: FloatingFrameBodies,
    body: int,
    step: float,
    work: Workspace,
    p: tuple[float, float, float],
    l: tuple[float, float, float],
    gravity_moment: tuple[float, float, float],
) -> None:
    """Work of a drive: its impulse is the change of momentum less the impulse of the other forces."""
    h = step
    frame = stage = kind.frame[body]
    dof = kind.table[body, DOF]
    m = shape_of(kind, body)[SHAPE_MASS]
    R = stage_rotation(kind, body)
    moment = rotate(R, stage[MOMENT], stage[MOMENT + 1], stage[MOMENT + 2])
    spin = rotate(R, work.velocity[dof + 3], work.velocity[dof + 4], work.velocity[dof + 5])
    moved = cross(
        frame[POSITION] - stage[MID_POSITION],
        frame[POSITION + 1] - stage[MID_POSITION + 1],
        frame[POSITION + 2] - stage[MID_POSITION + 2],
        p[0],
        p[1],
        p[2],
    )
    done = 0.0
    for k in range(3):
        impulse = p[k] - frame[MOMENTUM + k] - h * (stage[FORCE + k] + m * work.sums[FIELD + k])
        twist = l[k] + moved[k] - stage[TRANSPORTED + k] - h * (moment[k] + gravity_moment[k])
        done += impulse * work.velocity[dof + k] + twist * spin[k]
        frame[MOMENTUM + k] = p[k]
        frame[ANGULAR_MOMENTUM + k] = l[k]
    frame[WORK + 1] += done
