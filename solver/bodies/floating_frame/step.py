"""The second-order step of floating-frame bodies: momentum rows for the frame, velocity rows for the modes.

With ``p`` and ``L`` the linear momentum and the angular momentum about the frame origin, there is no
quadratic velocity force in the frame rows, and both momenta of a free body are kept to rounding,
whatever its modes do. Only the modal row has centrifugal and Coriolis forces; they are evaluated at a
predicted midpoint velocity and once more at the velocity found, with the same factor, without which
the scheme is second order but unstable. Bars mark the midpoint of the step::

    (F1)  xb, Rb from half a step along an arc,  qb = q + h/2 qd,  Mb = M(Rb, qb)
    (F2)  Lb = L + (x - xb) x p
    (F3)  r  = [ p + h/2 F ;  Rb^T (Lb + h/2 T) ;  (Mb U_n)_f + h/2 (h_f - k q + Q_f) ]
    (F4)  ( Mb + diag(0, h^2/4 k + h/2 d) ) Ub = r
    (F5)  x, R, q advance with Ub;  qd := 2 qd_b - qd;  p1 = 2 (Mb Ub)_v - p;
          L1 = 2 Rb (Mb Ub)_w - Lb + (xb - x1) x p1
    (F6)  frame velocities at the end from p1, L1 and the new q, qd

Modal row: "Deformable bodies ... sliding contacts" (2014), eqs. 2.66-2.79, with the quadratic forces
corrected; momentum rows: Newton and Euler about the moving frame origin. The scheme is this project's
discrete Euler-Lagrange equation ("Integrated simulation ... (2018)", eq. 49) at the midpoint.

The frame velocities of Ub belong to the middle of the step, but the modal rates of Ub are the mean of
both ends. In the modal row ``Ub - U_n`` must be half the change of U over the step, or the scheme is of
first order, with a small constant: U_n of the frame in (F3) is therefore shifted by the distance of the
midpoint velocity from the mean of both ends, as the last steps found it, in proportion to the square of the
step. Half of the news a step: all of it would feed a step-to-step alternation.

Impulses of joints (`heavylift.solver.bodies.floating_frame.joints`) are part of Ub, hence of p1 and L1.

Of a slender body the momentum about its axis a through the centre of mass c is not the part of Lb along the predicted
axis: where that is off by an angle, the momentum across it has a part along it that is far too large for the spin. It
is found from the orientation at the start and carried by its own equation, in body axes with ``l_c = l - c x p``::

    a.l_c(middle) = a.l_c(start) - h/2 a.(w x l_c) + h/2 a.T_c,   a.l_c(end) = 2 a.l_c(middle) - a.l_c(start)
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotate_by_quaternion, write_rotation_matrix
from heavylift.numerics.vectors import (
    Vector,
    add_scaled,
    cross,
    dot,
    rotate,
    rotate_back,
    subtract,
    vector,
    vector_at,
)
from heavylift.solver.bodies.floating_frame.fixed_frame import advance_fixed, factor_fixed, predict_fixed
from heavylift.solver.bodies.floating_frame.inertia import (
    antisymmetric_products,
    body_momenta,
    deformed_inertia,
    frame_velocity_from_momenta,
    leading_products,
    quadratic_modal_force,
)
from heavylift.solver.bodies.floating_frame.kind import (
    FloatingFrame,
    FloatingFrameBodies,
    lag_scale,
    product_columns,
    shape_of,
)
from heavylift.solver.bodies.floating_frame.stage import (
    clear_velocity,
    drive_frame,
    factor_frame,
    gather_marker_forces,
    solve_stage,
    update_products,
)
from heavylift.solver.bodies.floating_frame.stiffening import (
    add_quadratic_forces,
    add_step_forces,
    correct_inertia,
    keep_unforced,
    take_row_loads,
)
from heavylift.solver.bodies.frames.motion import advance_pose, check_frames, orientation_of, predict_pose
from heavylift.solver.drive import DRIVEN, FIXED, FREE, drive_pose, drive_velocity
from heavylift.solver.interface import STIFFENED, Workspace, advance, check, correct, factor, finish, predict
from heavylift.solver.kinds import implement

__all__ = [
    "evaluate_end",
    "momentum_about_axis",
]


@kernel(inline=True, internal=True)
def momentum_about_axis(frame: FloatingFrame, p: Vector, l: Vector) -> float:
    """Momentum about the axis of a slender body, through its centre of mass, from those of the frame in body axes."""
    moved = cross(vector(frame.first_moment), p)
    return dot(vector(frame.axis), add_scaled(l, -1.0 / frame.mass, moved))


@kernel(internal=True)
def _correct_axial_momentum(kind: FloatingFrameBodies, body: int, step: float) -> None:
    """Put the momentum about the axis in the middle of a step without moments into the right-hand side.

    The turning of the axes is that of the predicted velocities.
    """
    frame = kind.frame[body]
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    modes = slice(first, first + n)
    R, w = frame.mid_rotation, vector(frame.mid_spin)
    p, l = body_momenta(
        shape_of(kind, body),
        frame,
        kind.coupling[:, modes],
        vector(frame.mid_velocity),
        w,
        kind.mid_modal_velocity[modes],
    )
    l = add_scaled(l, -1.0 / frame.mass, cross(vector(frame.first_moment), p))
    wanted = frame.axial_momentum - 0.5 * step * dot(vector(frame.axis), cross(w, l))
    p = rotate_back(R, vector(frame.linear_momentum))
    l = rotate_back(R, vector(frame.transported_momentum))
    change = wanted - momentum_about_axis(frame, p, l)
    for k in range(3):
        frame.right_hand_side[3 + k] += change * frame.axis[k]


@implement(predict, FloatingFrameBodies)
@kernel(internal=True)
def predict_floating_frames(kind: FloatingFrameBodies, time: float, step: float) -> None:
    """(F1), (F2): midpoint configuration, its inertia, and the angular momentum about the new origin."""
    h = step
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        motion = kind.table[body].motion
        frame = kind.frame[body]
        if motion == FIXED:
            predict_fixed(kind, body, h)
            continue
        frame.at_end = False
        modes = slice(first, first + n)
        modal_position = kind.modal_position[modes]
        modal_velocity = kind.modal_velocity[modes]
        modal_acceleration = kind.modal_acceleration[modes]
        mid_modal_position = kind.mid_modal_position[modes]
        mid_modal_velocity = kind.mid_modal_velocity[modes]
        for i in range(n):
            mid_modal_position[i] = modal_position[i] + 0.5 * h * modal_velocity[i]
            mid_modal_velocity[i] = modal_velocity[i] + 0.5 * h * modal_acceleration[i]
        R = frame.mid_rotation
        if motion == DRIVEN:
            pose = frame.mid_pose
            drive_pose(kind.constants[kind.table[body].drive :], time + 0.5 * h, pose)
            for k in range(3):
                frame.mid_position[k] = pose[k]
            write_rotation_matrix((pose[3], pose[4], pose[5], pose[6]), R)
            drive_velocity(kind.constants[kind.table[body].drive :], time + h, frame.drive_rates)
            for k in range(3):  # the mean of both ends makes the momentum balance of the modes second order
                frame.mean_twist[k] = 0.5 * (frame.velocity[k] + frame.drive_rates[k])
                frame.mean_twist[3 + k] = 0.5 * (frame.spin[k] + frame.drive_rates[3 + k])
        else:
            predict_pose(frame, h, 0.125 * h * h)
        v = rotate_back(R, add_scaled(frame.velocity, 0.5 * h, frame.acceleration))
        for k in range(3):
            frame.mid_velocity[k] = v[k]
            frame.mid_spin[k] = frame.spin[k] + 0.5 * h * frame.spin_rate[k]
            frame.start_velocity[k] = frame.velocity[k]
            frame.start_velocity[3 + k] = frame.spin[k]
        rows = slice(8 * first, 8 * (first + n))
        if frame.slender:  # the first moment is still that of the start
            q = orientation_of(frame)
            back = (q[0], -q[1], -q[2], -q[3])
            p = rotate_by_quaternion(
                back, frame.linear_momentum[0], frame.linear_momentum[1], frame.linear_momentum[2]
            )
            l = rotate_by_quaternion(
                back, frame.angular_momentum[0], frame.angular_momentum[1], frame.angular_momentum[2]
            )
            frame.axial_momentum = momentum_about_axis(frame, p, l)
        midpoint_products = kind.midpoint_products[rows]
        position_products = kind.position_products[rows]
        velocity_products = kind.velocity_products[rows]
        for r in range(8 * n):
            midpoint_products[r] = position_products[r] + 0.5 * h * velocity_products[r]
        deformed_inertia(
            shape_of(kind, body),
            mid_modal_position,
            midpoint_products,
            frame,
            kind.coupling[:, modes],
        )
        correct_inertia(kind, body, mid_modal_position)
        moved = cross(
            subtract(frame.position, frame.mid_position),
            frame.linear_momentum,
        )
        for k in range(3):
            frame.transported_momentum[k] = frame.angular_momentum[k] + moved[k]


@implement(factor, FloatingFrameBodies)
@kernel(internal=True)
def factor_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """(F3), (F4) with the quadratic forces at the predicted midpoint velocity."""
    h = step
    gather_marker_forces(kind, work)
    lag = lag_scale(step, work)
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        motion = kind.table[body].motion
        dof = kind.table[body].dof
        velocity = work.velocity[dof : dof + 6 + n]
        middle = kind.mid_modal_position[first : first + n]
        add_step_forces(kind, body, h, work.sums.gravity, middle)
        if motion == FIXED:
            factor_fixed(kind, body, h, work)
            keep_unforced(kind, body, velocity, 0.0)
            continue
        frame = kind.frame[body]
        modes = slice(first, first + n)
        modal_position = kind.modal_position[modes]
        modal_velocity = kind.modal_velocity[modes]
        stiffness = kind.stiffness[modes]
        damping = kind.damping[modes]
        inverse_diagonal = kind.inverse_diagonal[modes]
        modal_right_hand_side = kind.modal_right_hand_side[modes]
        mid_modal_position = kind.mid_modal_position[modes]
        quadratic_force = kind.quadratic_force[modes]
        coupling = kind.coupling[:, modes]
        modal_load = kind.modal_load[modes]
        shape = shape_of(kind, body)
        R = frame.mid_rotation
        g = rotate_back(R, work.sums.gravity)
        for i in range(n):
            inverse_diagonal[i] = 1.0 / (1.0 + 0.25 * h * h * stiffness[i] + 0.5 * h * damping[i])
            gravity = shape[i] * g[0] + shape[n + i] * g[1] + shape[2 * n + i] * g[2]
            modal_right_hand_side[i] = modal_velocity[i] + 0.5 * h * (
                modal_load[i] + gravity - stiffness[i] * modal_position[i]
            )
        v = rotate_back(R, add_scaled(frame.start_velocity, lag, frame.lag))
        w = add_scaled(vector_at(frame.start_velocity, 3), lag, vector_at(frame.lag, 3))
        for i in range(n):
            modal_right_hand_side[i] += (
                shape[i] * v[0]
                + shape[n + i] * v[1]
                + shape[2 * n + i] * v[2]
                + coupling[0, i] * w[0]
                + coupling[1, i] * w[1]
                + coupling[2, i] * w[2]
            )
        rows = slice(8 * first, 8 * (first + n))
        mid_velocity_products = kind.mid_velocity_products[rows]
        midpoint_products = kind.midpoint_products[rows]
        velocity_products = kind.velocity_products[rows]
        acceleration_products = kind.acceleration_products[rows]
        # the matrices times the predicted rates are a combination of carried products
        rates = mid_velocity_products
        for r in range(3 * n):
            rates[r] = velocity_products[r] + 0.5 * h * acceleration_products[r]
        quadratic_modal_force(
            shape,
            mid_modal_position,
            midpoint_products,
            rates,
            vector(frame.mid_spin),
            quadratic_force,
        )
        add_quadratic_forces(kind, body, vector(frame.mid_spin))
        if motion == FREE:
            force = add_scaled(frame.force, frame.mass, work.sums.gravity)
            p = rotate_back(R, add_scaled(frame.linear_momentum, 0.5 * h, force))
            l = rotate_back(R, frame.transported_momentum)
            t = cross(frame.first_moment, g)
            for k in range(3):
                frame.right_hand_side[k] = p[k]
                frame.right_hand_side[3 + k] = l[k] + 0.5 * h * (frame.moment[k] + t[k])
            if frame.slender:
                _correct_axial_momentum(kind, body, h)
            factor_frame(frame, inverse_diagonal, kind.translation[:, modes], coupling)
        elif motion == DRIVEN:
            v = rotate_back(R, frame.mean_twist)
            for k in range(3):
                frame.right_hand_side[k] = v[k]
                frame.right_hand_side[3 + k] = frame.mean_twist[3 + k]
        clear_velocity(kind, body, work)
        solve_stage(kind, body, 0.5 * h, work)
        keep_unforced(kind, body, velocity, 0.0)


@implement(correct, FloatingFrameBodies)
@kernel(internal=True)
def correct_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Second pass of (F4): quadratic forces at the velocity that the first pass found.

    Only what their change does to the free velocity is added, so impulses of joints that are in the velocity stay.
    """
    for body in range(kind.table.shape[0]):
        if kind.table[body].motion == FIXED:
            continue
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        rows = slice(8 * first, 8 * (first + n))
        mid_velocity_products = kind.mid_velocity_products[rows]
        midpoint_products = kind.midpoint_products[rows]
        velocity = work.velocity[dof : dof + 6 + n]
        for i in range(first, first + n):
            kind.modal_right_hand_side[i] = -0.5 * step * kind.quadratic_force[i]
        for k in range(6):
            kind.frame[body].right_hand_side[k] = 0.0
        antisymmetric_products(product_columns(kind, body), velocity[6:], mid_velocity_products)
        work.control.changed += 1
        quadratic_modal_force(
            shape_of(kind, body),
            kind.mid_modal_position[first : first + n],
            midpoint_products,
            mid_velocity_products,
            vector_at(velocity, 3),
            kind.quadratic_force[first : first + n],
        )
        add_quadratic_forces(kind, body, vector_at(velocity, 3))
        keep_unforced(kind, body, velocity, -1.0)
        solve_stage(kind, body, 0.5 * step, work)
        keep_unforced(kind, body, velocity, 1.0)


# ---- the end of the step ----


NOT_CONVERGED, NOT_FINITE = int(Outcome.NOT_CONVERGED), int(Outcome.NOT_FINITE)


@implement(check, FloatingFrameBodies)
@kernel(internal=True, reassociate=True)
def check_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Frames; modal rates that are not finite; and steps too long for what loads do to the stiffness."""
    check_frames(kind, step, work)
    for body in range(kind.table.shape[0]):
        if kind.table[body].stiffening >= 0 and step * step * kind.frame[body].stiffening_rate > 4.0:
            work.status.outcome = NOT_CONVERGED
            work.status.body = kind.table[body].number
            work.status.block = STIFFENED
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
        take_row_loads(kind, body, h, work.velocity[dof : dof + 6 + n])
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
            w = vector_at(velocity, 3)
            p, l = body_momenta(
                shape_of(kind, body), frame, kind.coupling[:, first : first + n], v, w, velocity[6:]
            )
            if frame.slender:
                frame.axial_momentum = 2.0 * momentum_about_axis(frame, p, l) - frame.axial_momentum
            p, l = rotate(R, p), rotate(R, l)
            advance_pose(frame, velocity, h)
            for k in range(3):
                frame.linear_momentum[k] = 2.0 * p[k] - frame.linear_momentum[k]
            moved = cross(subtract(frame.mid_position, frame.position), frame.linear_momentum)
            for k in range(3):
                frame.angular_momentum[k] = 2.0 * l[k] - frame.transported_momentum[k] + moved[k]
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
    correct_inertia(kind, body, kind.modal_position[modes])
    R = frame.end_rotation
    write_rotation_matrix(orientation_of(frame), R)
    if kind.table[body].motion == FREE:
        p = rotate_back(R, frame.linear_momentum)
        l = rotate_back(R, frame.angular_momentum)
        if frame.slender:
            l = add_scaled(l, frame.axial_momentum - momentum_about_axis(frame, p, l), vector(frame.axis))
            turned = rotate(R, l)
            for k in range(3):
                frame.angular_momentum[k] = turned[k]
        v, w = frame_velocity_from_momenta(
            shape, frame, kind.coupling[:, modes], p, l, kind.modal_velocity[modes]
        )
        v = rotate(R, v)
        for k in range(3):
            frame.velocity[k], frame.spin[k] = v[k], w[k]


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
