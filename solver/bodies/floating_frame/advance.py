"""End of the second-order step of floating-frame bodies: checks, (F5) and (F6) of `floating_frame_step`."""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import write_rotation_matrix
from heavylift.numerics.vectors import cross, rotate, rotate_back, subtract, vector_at
from heavylift.solver.bodies.floating_frame.inertia import (
    body_momenta,
    deformed_inertia,
    frame_velocity_from_momenta,
    leading_products,
)
from heavylift.solver.bodies.floating_frame.kind import (
    FloatingFrameBodies,
)
from heavylift.solver.bodies.floating_frame.shape import lag_scale, product_columns, shape_of
from heavylift.solver.bodies.floating_frame.stage import drive_frame, update_products
from heavylift.solver.bodies.frames.fixed_frame import advance_fixed
from heavylift.solver.bodies.frames.motion import advance_pose, check_frames, orientation_of
from heavylift.solver.drive import DRIVEN, FIXED, FREE
from heavylift.solver.interface import (
    Workspace,
    advance,
    check,
    finish,
)
from heavylift.solver.kinds import implement

__all__ = ["evaluate_end"]

NOT_FINITE = int(Outcome.NOT_FINITE)


@implement(check, FloatingFrameBodies)
@kernel(internal=True, reassociate=True)
def check_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Frames; and modal rates that are not finite."""
    check_frames(kind, step, work)
    for body in range(kind.table.shape[0]):
        dof = kind.table[body].dof
        total = 0.0
        for i in range(dof + 6, dof + 6 + kind.table[body].mode_count):
            total += abs(work.velocity[i])
        if not math.isfinite(total):
            work.status.outcome = NOT_FINITE
            work.status.body = kind.table[body].number


@implement(advance, FloatingFrameBodies)
@kernel(reassociate=True, internal=True)
def advance_floating_frames(kind: FloatingFrameBodies, time: float, step: float, work: Workspace) -> None:
    """(F5): configuration and momenta to the end of the step, and the work of forces and dampers."""
    h = step
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        motion = kind.table[body].motion
        if motion == FIXED:
            advance_fixed(kind, body, h, work)
            continue
        frame = kind.frame[body]
        modes = slice(first, first + n)
        modal_position = kind.modal_position[modes]
        modal_velocity = kind.modal_velocity[modes]
        modal_acceleration = kind.modal_acceleration[modes]
        damping = kind.damping[modes]
        modal_load = kind.modal_load[modes]
        velocity = work.velocity[dof : dof + 6 + n]
        external = dissipated = 0.0
        for j in range(3):
            external += frame.force[j] * velocity[j]
        for j in range(3):
            external += frame.moment[j] * velocity[3 + j]
        for i in range(n):
            rate = velocity[6 + i]
            external += modal_load[i] * rate
            dissipated += damping[i] * rate * rate
        frame.external_work += h * external
        frame.dissipated_work += h * dissipated
        for j in range(6):
            frame.stage_velocity[j] = velocity[j]
        if motion == FREE:
            R = frame.mid_rotation
            v = rotate_back(R, velocity)
            w = (velocity[3], velocity[4], velocity[5])
            p, l = body_momenta(
                shape_of(kind, body), frame, kind.coupling[:, first : first + n], v, w, velocity[6:]
            )
            p1, p2, p3 = rotate(R, p)
            l1, l2, l3 = rotate(R, l)
            advance_pose(frame, velocity, h)
            frame.linear_momentum[0] = 2.0 * p1 - frame.linear_momentum[0]
            frame.linear_momentum[1] = 2.0 * p2 - frame.linear_momentum[1]
            frame.linear_momentum[2] = 2.0 * p3 - frame.linear_momentum[2]
            moved = cross(
                subtract(frame.mid_position, frame.position),
                frame.linear_momentum,
            )
            frame.angular_momentum[0] = 2.0 * l1 - frame.transported_momentum[0] + moved[0]
            frame.angular_momentum[1] = 2.0 * l2 - frame.transported_momentum[1] + moved[1]
            frame.angular_momentum[2] = 2.0 * l3 - frame.transported_momentum[2] + moved[2]
        elif motion == DRIVEN:
            _begin_drive_work(kind, body, h, work)
            drive_frame(kind, body, time + h)
            for k in range(3):
                frame.velocity[k] = frame.drive_rates[k]
                frame.spin[k] = frame.drive_rates[3 + k]
        for i in range(n):
            rate = 2.0 * velocity[6 + i] - modal_velocity[i]
            modal_position[i] += h * velocity[6 + i]
            modal_acceleration[i] = (rate - modal_velocity[i]) / h
            modal_velocity[i] = rate


@kernel(internal=True)
def evaluate_end(kind: FloatingFrameBodies, body: int) -> None:
    """Inertia and rotation at the end of the step from the products there; (F6): frame velocities from momenta."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    frame = kind.frame[body]
    modes = slice(first, first + n)
    shape = shape_of(kind, body)
    deformed_inertia(
        shape,
        kind.modal_position[modes],
        kind.position_products[8 * first : 8 * (first + n)],
        frame,
        kind.coupling[:, modes],
    )
    R = frame.end_rotation
    write_rotation_matrix(orientation_of(frame), R)
    if kind.table[body].motion == FREE:
        p = rotate_back(R, frame.linear_momentum)
        l = rotate_back(R, frame.angular_momentum)
        v, w = frame_velocity_from_momenta(
            shape, frame, kind.coupling[:, modes], p, l, kind.modal_velocity[modes]
        )
        v1, v2, v3 = rotate(R, v)
        frame.velocity[0], frame.velocity[1], frame.velocity[2] = v1, v2, v3
        frame.spin[0], frame.spin[1], frame.spin[2] = w


@implement(finish, FloatingFrameBodies)
@kernel(internal=True)
def finish_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Velocities at the end, unless the joints have set them; difference quotients for the next prediction."""
    h = step
    lag = lag_scale(step, work)
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        frame = kind.frame[body]
        if kind.table[body].motion == FIXED:
            continue
        rows = slice(8 * first, 8 * (first + n))
        acceleration_products = kind.acceleration_products[rows]
        velocity_products = kind.velocity_products[rows]
        for r in range(3 * n):
            acceleration_products[r] = velocity_products[r]
        if not frame.at_end:
            update_products(kind, body)
            evaluate_end(kind, body)
        else:  # the rates were projected meanwhile
            rates = kind.modal_velocity[first : first + n]
            leading_products(product_columns(kind, body), rates, 8 * n, velocity_products)
        for r in range(3 * n):
            acceleration_products[r] = (velocity_products[r] - acceleration_products[r]) / h
        if kind.table[body].motion == FREE:
            for k in range(3):
                middle = frame.stage_velocity[k] - 0.5 * (frame.start_velocity[k] + frame.velocity[k])
                frame.lag[k] = 0.5 * (lag * frame.lag[k] + middle)
                middle = frame.stage_velocity[3 + k] - 0.5 * (frame.start_velocity[3 + k] + frame.spin[k])
                frame.lag[3 + k] = 0.5 * (lag * frame.lag[3 + k] + middle)
        else:
            _finish_drive_work(kind, body)
        for k in range(3):
            frame.acceleration[k] = (frame.velocity[k] - frame.start_velocity[k]) / h
            frame.spin_rate[k] = (frame.spin[k] - frame.start_velocity[3 + k]) / h


@kernel(internal=True)
def _begin_drive_work(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Momenta that a driven frame would have without its drive, and the velocities of the stage, world axes."""
    h = step
    frame = kind.frame[body]
    m, R = frame.mass, frame.mid_rotation
    moment = rotate(R, frame.moment)
    spin = rotate(R, vector_at(frame.stage_velocity, 3))
    s = rotate(R, frame.first_moment)
    t = cross(s, work.sums.gravity)
    for k in range(3):
        frame.stage_velocity[3 + k] = spin[k]
        frame.right_hand_side[k] = frame.linear_momentum[k] + h * (frame.force[k] + m * work.sums.gravity[k])
        frame.right_hand_side[3 + k] = frame.transported_momentum[k] + h * (moment[k] + t[k])


@kernel(internal=True)
def _finish_drive_work(kind: FloatingFrameBodies, body: int) -> None:
    """Momenta at the end; work of a drive: its impulse is their change less the impulse of the other forces."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    modes = slice(first, first + n)
    frame = kind.frame[body]
    R = frame.end_rotation
    p, l = body_momenta(
        shape_of(kind, body),
        frame,
        kind.coupling[:, modes],
        rotate_back(R, frame.velocity),
        (frame.spin[0], frame.spin[1], frame.spin[2]),
        kind.modal_velocity[modes],
    )
    p = rotate(R, p)
    l = rotate(R, l)
    moved = cross(
        subtract(frame.position, frame.mid_pose),
        p,
    )
    done = 0.0
    for k in range(3):
        done += (p[k] - frame.right_hand_side[k]) * frame.stage_velocity[k]
        done += (l[k] + moved[k] - frame.right_hand_side[3 + k]) * frame.stage_velocity[3 + k]
        frame.linear_momentum[k] = p[k]
        frame.angular_momentum[k] = l[k]
    frame.drive_work += done
