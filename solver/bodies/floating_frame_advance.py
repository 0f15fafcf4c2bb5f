"""End of the second-order step of floating-frame bodies: checks, (F5) and (F6) of `floating_frame_step`."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.small import cross, rotate, rotate_back
from heavylift.solver.bodies.floating_frame import (
    ACCELERATION,
    ANGULAR_MOMENTUM,
    AT_END,
    AT_Q,
    AT_RATE,
    AT_RATE2,
    DAMPING,
    DOF,
    DRIVE,
    END_ROTATION,
    FIRST_MOMENT,
    FORCE,
    FOUND,
    FRAME_RHS,
    LAG,
    LOAD,
    MID_POSE,
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
    leading_products,
)
from heavylift.solver.bodies.floating_frame_shape import lag_scale, product_columns, shape_of, stage_rotation
from heavylift.solver.bodies.floating_frame_stage import update_products
from heavylift.solver.drive import DRIVEN, FREE, drive_pose
from heavylift.solver.interface import (
    Workspace,
    advance,
    check,
    finish,
)
from heavylift.solver.kinds import implement

__all__ = ["LARGEST_TURN", "evaluate_end"]

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
            work.status.outcome = NOT_FINITE
            work.status.body = kind.table[body, NUMBER]
        elif turn > LARGEST_TURN and kind.table[body, MOTION] == FREE:
            work.status.outcome = STEP_TOO_LARGE
            work.status.body = kind.table[body, NUMBER]


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
        for j in range(6):
            stage[FOUND + j] = velocity[j]
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
            _begin_drive_work(kind, body, h, work)
            drive_pose(kind.constants[kind.table[body, DRIVE] :], time + h, frame[POSITION : POSITION + 7])
            for k in range(3):
                frame[VELOCITY + k] = stage[PRESCRIBED + k]
                frame[SPIN + k] = stage[PRESCRIBED + 3 + k]
        for i in range(n):
            rate = 2.0 * velocity[6 + i] - kind.modal[RATE, first + i]
            kind.modal[Q, first + i] += h * velocity[6 + i]
            kind.modal[RATE2, first + i] = (rate - kind.modal[RATE, first + i]) / h
            kind.modal[RATE, first + i] = rate


@kernel(internal=True)
def evaluate_end(kind: FloatingFrameBodies, body: int) -> None:
    """Inertia and rotation at the end of the step from the products there; (F6): frame velocities from momenta."""
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
    frame = stage = kind.frame[body]
    modes = slice(first, first + n)
    shape = shape_of(kind, body)
    deformed_inertia(
        shape,
        kind.modal[Q, modes],
        kind.products[AT_Q, 8 * first : 8 * (first + n)],
        stage,
        kind.modal[TF1:, modes],
    )
    R = kind.frame[body, END_ROTATION : END_ROTATION + 9]
    write_rotation_matrix(
        (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3]), R
    )
    if kind.table[body, MOTION] == FREE:
        p = rotate_back(R, frame[MOMENTUM], frame[MOMENTUM + 1], frame[MOMENTUM + 2])
        l = rotate_back(R, frame[ANGULAR_MOMENTUM], frame[ANGULAR_MOMENTUM + 1], frame[ANGULAR_MOMENTUM + 2])
        v, w = frame_velocity_from_momenta(
            shape, stage, kind.modal[TF1:, modes], p, l, kind.modal[RATE, modes]
        )
        v1, v2, v3 = rotate(R, v[0], v[1], v[2])
        frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2] = v1, v2, v3
        frame[SPIN], frame[SPIN + 1], frame[SPIN + 2] = w


@implement(finish, FloatingFrameBodies)
@kernel(internal=True)
def finish_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Velocities at the end, unless the joints have set them; difference quotients for the next prediction."""
    h = step
    lag = lag_scale(step, work)
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        frame = stage = kind.frame[body]
        products = kind.products[:, 8 * first : 8 * (first + n)]
        for r in range(3 * n):
            products[AT_RATE2, r] = products[AT_RATE, r]
        if stage[AT_END] == 0.0:
            update_products(kind, body)
            evaluate_end(kind, body)
        else:  # the rates were projected meanwhile
            rates = kind.modal[RATE, first : first + n]
            leading_products(product_columns(kind, body), rates, 8 * n, products[AT_RATE])
        for r in range(3 * n):
            products[AT_RATE2, r] = (products[AT_RATE, r] - products[AT_RATE2, r]) / h
        if kind.table[body, MOTION] == FREE:
            for k in range(6):
                end = frame[VELOCITY + k]  # the spin follows the velocity
                middle = stage[FOUND + k] - 0.5 * (stage[START_VELOCITY + k] + end)
                frame[LAG + k] = 0.5 * (lag * frame[LAG + k] + middle)
        else:
            _finish_drive_work(kind, body)
        for k in range(3):
            frame[ACCELERATION + k] = (frame[VELOCITY + k] - stage[START_VELOCITY + k]) / h
            frame[SPIN_RATE + k] = (frame[SPIN + k] - stage[START_VELOCITY + 3 + k]) / h


@kernel(internal=True)
def _begin_drive_work(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Momenta that a driven frame would have without its drive, and the velocities of the stage, world axes."""
    h = step
    frame = stage = kind.frame[body]
    m = shape_of(kind, body)[SHAPE_MASS]
    R = stage_rotation(kind, body)
    moment = rotate(R, stage[MOMENT], stage[MOMENT + 1], stage[MOMENT + 2])
    spin = rotate(R, stage[FOUND + 3], stage[FOUND + 4], stage[FOUND + 5])
    s = rotate(R, stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2])
    t = cross(s[0], s[1], s[2], work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2])
    for k in range(3):
        stage[FOUND + 3 + k] = spin[k]
        stage[FRAME_RHS + k] = frame[MOMENTUM + k] + h * (stage[FORCE + k] + m * work.sums.gravity[k])
        stage[FRAME_RHS + 3 + k] = stage[TRANSPORTED + k] + h * (moment[k] + t[k])


@kernel(internal=True)
def _finish_drive_work(kind: FloatingFrameBodies, body: int) -> None:
    """Momenta at the end; work of a drive: its impulse is their change less the impulse of the other forces."""
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
    modes = slice(first, first + n)
    frame = stage = kind.frame[body]
    R = kind.frame[body, END_ROTATION : END_ROTATION + 9]
    p, l = body_momenta(
        shape_of(kind, body),
        stage,
        kind.modal[TF1:, modes],
        rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2]),
        (frame[SPIN], frame[SPIN + 1], frame[SPIN + 2]),
        kind.modal[RATE, modes],
    )
    p = rotate(R, p[0], p[1], p[2])
    l = rotate(R, l[0], l[1], l[2])
    moved = cross(
        frame[POSITION] - stage[MID_POSE],
        frame[POSITION + 1] - stage[MID_POSE + 1],
        frame[POSITION + 2] - stage[MID_POSE + 2],
        p[0],
        p[1],
        p[2],
    )
    done = 0.0
    for k in range(3):
        done += (p[k] - stage[FRAME_RHS + k]) * stage[FOUND + k]
        done += (l[k] + moved[k] - stage[FRAME_RHS + 3 + k]) * stage[FOUND + 3 + k]
        frame[MOMENTUM + k] = p[k]
        frame[ANGULAR_MOMENTUM + k] = l[k]
    frame[WORK + 1] += done
