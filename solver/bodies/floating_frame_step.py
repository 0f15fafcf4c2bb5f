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

What joints add stands in `floating_frame_joints`; their impulses are part of Ub, hence of p1 and L1.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.small import cross, rotate_back
from heavylift.solver.bodies.floating_frame import (
    ACCELERATION,
    ANGULAR_MOMENTUM,
    AT_END,
    AT_MIDPOINT,
    AT_Q,
    AT_RATE,
    AT_RATE2,
    AT_VELOCITY,
    DAMPING,
    DOF,
    DRIVE,
    DRIVEN_VELOCITY,
    FACTOR,
    FIRST_MOMENT,
    FORCE,
    FRAME_RHS,
    INVERSE,
    LAG,
    LOAD,
    MID_POSE,
    MID_POSITION,
    MID_Q,
    MID_RATE,
    MID_SPIN,
    MID_VELOCITY,
    MODAL,
    MODES,
    MOMENT,
    MOMENTUM,
    MOTION,
    ORIENTATION,
    POSITION,
    PRESCRIBED,
    QUADRATIC,
    RATE,
    RATE2,
    ROW,
    SHAPE_HEAD,
    SHAPE_MASS,
    SPIN,
    SPIN_RATE,
    START_VELOCITY,
    STIFFNESS,
    TF1,
    TRANSPORTED,
    VELOCITY,
    FloatingFrameBodies,
    Q,
)
from heavylift.solver.bodies.floating_frame_inertia import (
    antisymmetric_products,
    deformed_inertia,
    quadratic_modal_force,
)
from heavylift.solver.bodies.floating_frame_markers import gather_marker_forces
from heavylift.solver.bodies.floating_frame_shape import lag_scale, product_columns, shape_of, stage_rotation
from heavylift.solver.bodies.floating_frame_stage import clear_velocity, factor_frame, solve_stage
from heavylift.solver.drive import DRIVEN, FREE, drive_pose, drive_velocity
from heavylift.solver.interface import (
    Workspace,
    correct,
    factor,
    predict,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(predict, FloatingFrameBodies)
@kernel(internal=True)
def predict_floating_frames(kind: FloatingFrameBodies, time: float, step: float) -> None:
    """(F1), (F2): midpoint configuration, its inertia, and the angular momentum about the new origin."""
    h = step
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        motion = kind.table[body, MOTION]
        frame = stage = kind.frame[body]
        stage[AT_END] = 0.0
        for i in range(first, first + n):
            kind.modal[MID_Q, i] = kind.modal[Q, i] + 0.5 * h * kind.modal[RATE, i]
            kind.modal[MID_RATE, i] = kind.modal[RATE, i] + 0.5 * h * kind.modal[RATE2, i]
        R = stage_rotation(kind, body)
        if motion == DRIVEN:
            pose = stage[MID_POSE : MID_POSE + 7]
            drive_pose(kind.constants[kind.table[body, DRIVE] :], time + 0.5 * h, pose)
            for k in range(3):
                stage[MID_POSITION + k] = pose[k]
            write_rotation_matrix((pose[3], pose[4], pose[5], pose[6]), R)
            drive_velocity(
                kind.constants[kind.table[body, DRIVE] :], time + h, stage[PRESCRIBED : PRESCRIBED + 12]
            )
            for k in range(3):  # the mean of both ends makes the momentum balance of the modes second order
                stage[DRIVEN_VELOCITY + k] = 0.5 * (frame[VELOCITY + k] + stage[PRESCRIBED + k])
                stage[DRIVEN_VELOCITY + 3 + k] = 0.5 * (frame[SPIN + k] + stage[PRESCRIBED + 3 + k])
        else:
            a = 0.125 * h * h
            for k in range(3):
                stage[MID_POSITION + k] = (
                    frame[POSITION + k] + 0.5 * h * frame[VELOCITY + k] + a * frame[ACCELERATION + k]
                )
            quaternion = rotate_by_exponential(
                (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3]),
                0.5 * h * frame[SPIN] + a * frame[SPIN_RATE],
                0.5 * h * frame[SPIN + 1] + a * frame[SPIN_RATE + 1],
                0.5 * h * frame[SPIN + 2] + a * frame[SPIN_RATE + 2],
            )
            write_rotation_matrix(quaternion, R)
        v = rotate_back(
            R,
            frame[VELOCITY] + 0.5 * h * frame[ACCELERATION],
            frame[VELOCITY + 1] + 0.5 * h * frame[ACCELERATION + 1],
            frame[VELOCITY + 2] + 0.5 * h * frame[ACCELERATION + 2],
        )
        for k in range(3):
            stage[MID_VELOCITY + k] = v[k]
            stage[MID_SPIN + k] = frame[SPIN + k] + 0.5 * h * frame[SPIN_RATE + k]
            stage[START_VELOCITY + k] = frame[VELOCITY + k]
            stage[START_VELOCITY + 3 + k] = frame[SPIN + k]
        products = kind.products[:, 8 * first : 8 * (first + n)]
        for r in range(8 * n):
            products[AT_MIDPOINT, r] = products[AT_Q, r] + 0.5 * h * products[AT_RATE, r]
        deformed_inertia(
            shape_of(kind, body),
            kind.modal[MID_Q, first : first + n],
            products[AT_MIDPOINT],
            stage,
            kind.modal[TF1:, first : first + n],
        )
        moved = cross(
            frame[POSITION] - stage[MID_POSITION],
            frame[POSITION + 1] - stage[MID_POSITION + 1],
            frame[POSITION + 2] - stage[MID_POSITION + 2],
            frame[MOMENTUM],
            frame[MOMENTUM + 1],
            frame[MOMENTUM + 2],
        )
        for k in range(3):
            stage[TRANSPORTED + k] = frame[ANGULAR_MOMENTUM + k] + moved[k]


@implement(factor, FloatingFrameBodies)
@kernel(internal=True)
def factor_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """(F3), (F4) with the quadratic forces at the predicted midpoint velocity."""
    h = step
    gather_marker_forces(kind, work)
    lag = lag_scale(step, work)
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        motion = kind.table[body, MOTION]
        stage = kind.frame[body]
        modal = kind.modal[:, first : first + n]
        shape = shape_of(kind, body)
        R = stage_rotation(kind, body)
        g1, g2, g3 = rotate_back(R, work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2])
        for i in range(n):
            stiffness, damping = kind.modal[STIFFNESS, first + i], kind.modal[DAMPING, first + i]
            modal[INVERSE, i] = 1.0 / (1.0 + 0.25 * h * h * stiffness + 0.5 * h * damping)
            gravity = (
                shape[SHAPE_HEAD + i] * g1
                + shape[SHAPE_HEAD + n + i] * g2
                + shape[SHAPE_HEAD + 2 * n + i] * g3
            )
            modal[ROW, i] = kind.modal[RATE, first + i] + 0.5 * h * (
                modal[LOAD, i] + gravity - stiffness * kind.modal[Q, first + i]
            )
        v1, v2, v3 = rotate_back(
            R,
            stage[START_VELOCITY] + lag * stage[LAG],
            stage[START_VELOCITY + 1] + lag * stage[LAG + 1],
            stage[START_VELOCITY + 2] + lag * stage[LAG + 2],
        )
        w1 = stage[START_VELOCITY + 3] + lag * stage[LAG + 3]
        w2 = stage[START_VELOCITY + 4] + lag * stage[LAG + 4]
        w3 = stage[START_VELOCITY + 5] + lag * stage[LAG + 5]
        for i in range(n):
            modal[ROW, i] += (
                shape[SHAPE_HEAD + i] * v1
                + shape[SHAPE_HEAD + n + i] * v2
                + shape[SHAPE_HEAD + 2 * n + i] * v3
                + modal[TF1, i] * w1
                + modal[TF1 + 1, i] * w2
                + modal[TF1 + 2, i] * w3
            )
        products = kind.products[:, 8 * first : 8 * (first + n)]
        # the matrices times the predicted rates are a combination of carried products
        rates = products[AT_VELOCITY]
        for r in range(3 * n):
            rates[r] = products[AT_RATE, r] + 0.5 * h * products[AT_RATE2, r]
        quadratic_modal_force(
            shape,
            modal[MID_Q],
            products[AT_MIDPOINT],
            rates,
            stage[MID_SPIN],
            stage[MID_SPIN + 1],
            stage[MID_SPIN + 2],
            modal[QUADRATIC],
        )
        if motion == FREE:
            m = shape[SHAPE_MASS]
            frame = kind.frame[body]
            p = rotate_back(
                R,
                frame[MOMENTUM] + 0.5 * h * (stage[FORCE] + m * work.sums.gravity[0]),
                frame[MOMENTUM + 1] + 0.5 * h * (stage[FORCE + 1] + m * work.sums.gravity[1]),
                frame[MOMENTUM + 2] + 0.5 * h * (stage[FORCE + 2] + m * work.sums.gravity[2]),
            )
            l = rotate_back(R, stage[TRANSPORTED], stage[TRANSPORTED + 1], stage[TRANSPORTED + 2])
            t = cross(stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2], g1, g2, g3)
            for k in range(3):
                stage[FRAME_RHS + k] = p[k]
                stage[FRAME_RHS + 3 + k] = l[k] + 0.5 * h * (stage[MOMENT + k] + t[k])
            factor_frame(shape, stage, modal, stage[FACTOR : FACTOR + 36])
        elif motion == DRIVEN:
            v1, v2, v3 = rotate_back(
                R, stage[DRIVEN_VELOCITY], stage[DRIVEN_VELOCITY + 1], stage[DRIVEN_VELOCITY + 2]
            )
            stage[FRAME_RHS], stage[FRAME_RHS + 1], stage[FRAME_RHS + 2] = v1, v2, v3
            for k in range(3):
                stage[FRAME_RHS + 3 + k] = stage[DRIVEN_VELOCITY + 3 + k]
        clear_velocity(kind, body, work)
        solve_stage(kind, body, 0.5 * h, work)


@implement(correct, FloatingFrameBodies)
@kernel(internal=True)
def correct_floating_frames(kind: FloatingFrameBodies, step: float, work: Workspace) -> None:
    """Second pass of (F4): quadratic forces at the velocity that the first pass found.

    Only what their change does to the free velocity is added, so impulses of joints that are in the velocity stay.
    """
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        products = kind.products[:, 8 * first : 8 * (first + n)]
        velocity = work.velocity[dof : dof + 6 + n]
        for i in range(first, first + n):
            kind.modal[ROW, i] = -0.5 * step * kind.modal[QUADRATIC, i]
        for k in range(6):
            kind.frame[body, FRAME_RHS + k] = 0.0
        antisymmetric_products(product_columns(kind, body), velocity[6:], products[AT_VELOCITY])
        quadratic_modal_force(
            shape_of(kind, body),
            kind.modal[MID_Q, first : first + n],
            products[AT_MIDPOINT],
            products[AT_VELOCITY],
            velocity[3],
            velocity[4],
            velocity[5],
            kind.modal[QUADRATIC, first : first + n],
        )
        solve_stage(kind, body, 0.5 * step, work)
