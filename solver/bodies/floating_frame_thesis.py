"""First-order step of floating-frame bodies: discrete Euler-Lagrange equation with the stiffness as compliant rows.

"Integrated simulation ... ships and offshore structures" (2018), eq. 49, has for compliant rows
``G v = rate of the spring``, multiplier eliminated::

    ( M + h^2/4 K + h D ) U+ = ( M + h^2/4 K ) U + h ( Q + Q_v - K q )

with all matrices and forces at the start of the step. For a linear oscillator this is the trapezoidal
rule between velocities at half steps; everything else is first order. For comparison, not for use.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import rotate_by_exponential
from heavylift.numerics.small import cross, rotate_back
from heavylift.solver.bodies.floating_frame import (
    ACCELERATION,
    AT_Q,
    AT_RATE,
    DAMPING,
    DOF,
    DRIVE,
    FACTOR,
    FIRST_MOMENT,
    FORCE,
    FRAME_RHS,
    INVERSE,
    LOAD,
    MODAL,
    MODES,
    MOMENT,
    MOTION,
    ORIENTATION,
    POSITION,
    PRESCRIBED,
    QUADRATIC,
    RATE,
    ROW,
    SHAPE_HEAD,
    SHAPE_MASS,
    SPIN,
    STIFFNESS,
    TF1,
    VELOCITY,
    WORK,
    FloatingFrameBodies,
    Q,
)
from heavylift.solver.bodies.floating_frame_inertia import (
    body_momenta,
    frame_velocity_forces,
    quadratic_modal_force,
)
from heavylift.solver.bodies.floating_frame_markers import gather_marker_forces
from heavylift.solver.bodies.floating_frame_shape import shape_of, stage_rotation
from heavylift.solver.bodies.floating_frame_stage import (
    clear_velocity,
    factor_frame,
    solve_stage,
    stage_at_state,
)
from heavylift.solver.drive import DRIVEN, FREE, drive_pose, drive_velocity
from heavylift.solver.interface import (
    Workspace,
    thesis_advance,
    thesis_velocity,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(thesis_velocity, FloatingFrameBodies)
@kernel(internal=True)
def thesis_velocity_floating_frames(
    kind: FloatingFrameBodies, time: float, step: float, work: Workspace
) -> None:
    """End velocities; of driven frames, those of the drive at the end of the step."""
    h = step
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        motion = kind.table[body, MOTION]
        modes = slice(first, first + n)
        frame = stage = kind.frame[body]
        modal = kind.modal[:, modes]
        rates = kind.modal[RATE, modes]
        shape = shape_of(kind, body)
        stage_at_state(kind, body, True)
        R = stage_rotation(kind, body)
        g = rotate_back(R, work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2])
        v = rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2])
        w = (frame[SPIN], frame[SPIN + 1], frame[SPIN + 2])
        products = kind.products[:, 8 * first : 8 * (first + n)]
        quadratic_modal_force(
            shape, kind.modal[Q, modes], products[AT_Q], products[AT_RATE], w[0], w[1], w[2], modal[QUADRATIC]
        )
        for i in range(n):
            stiffness, damping = kind.modal[STIFFNESS, first + i], kind.modal[DAMPING, first + i]
            elastic = 1.0 + 0.25 * h * h * stiffness
            modal[INVERSE, i] = 1.0 / (elastic + h * damping)
            S1, S2, S3 = shape[SHAPE_HEAD + i], shape[SHAPE_HEAD + n + i], shape[SHAPE_HEAD + 2 * n + i]
            modal[ROW, i] = elastic * rates[i] + h * (
                modal[LOAD, i] + S1 * g[0] + S2 * g[1] + S3 * g[2] - stiffness * kind.modal[Q, first + i]
            )
            modal[ROW, i] += (
                S1 * v[0]
                + S2 * v[1]
                + S3 * v[2]
                + modal[TF1, i] * w[0]
                + modal[TF1 + 1, i] * w[1]
                + modal[TF1 + 2, i] * w[2]
            )
        if motion == FREE:
            m = shape[SHAPE_MASS]
            p, l = body_momenta(shape, stage, kind.modal[TF1:, modes], v, w, rates)
            f, t = frame_velocity_forces(
                shape, kind.modal[Q, modes], products[AT_Q], stage, w[0], w[1], w[2], rates
            )
            force = rotate_back(R, stage[FORCE], stage[FORCE + 1], stage[FORCE + 2])
            moment = cross(
                stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2], g[0], g[1], g[2]
            )
            for k in range(3):
                stage[FRAME_RHS + k] = p[k] + h * (force[k] + m * g[k] + f[k])
                stage[FRAME_RHS + 3 + k] = l[k] + h * (stage[MOMENT + k] + moment[k] + t[k])
            factor_frame(shape, stage, modal, stage[FACTOR : FACTOR + 36])
        elif motion == DRIVEN:
            prescribed = stage[PRESCRIBED : PRESCRIBED + 12]
            drive_velocity(kind.constants[kind.table[body, DRIVE] :], time + h, prescribed)
            a = rotate_back(R, prescribed[0], prescribed[1], prescribed[2])
            for k in range(3):
                stage[FRAME_RHS + k] = a[k]
                stage[FRAME_RHS + 3 + k] = prescribed[3 + k]
        clear_velocity(kind, body, work)
        solve_stage(kind, body, h, work)


@implement(thesis_advance, FloatingFrameBodies)
@kernel(internal=True)
def thesis_advance_floating_frames(
    kind: FloatingFrameBodies, time: float, step: float, work: Workspace
) -> None:
    """Configuration by the end velocity; works to first order, like everything else."""
    h = step
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        frame = stage = kind.frame[body]
        velocity = work.velocity[dof : dof + 6 + n]
        if kind.table[body, MOTION] == DRIVEN:
            _add_drive_work(kind, body, h, work)
        external = dissipated = 0.0
        for j in range(6):
            external += stage[FORCE + j] * velocity[j]
        for i in range(n):
            rate = velocity[6 + i]
            external += kind.modal[LOAD, first + i] * rate
            dissipated += kind.modal[DAMPING, first + i] * rate * rate
            kind.modal[Q, first + i] += h * rate
            kind.modal[RATE, first + i] = rate
        frame[WORK] += h * external
        frame[WORK + 2] += h * dissipated
        for k in range(6):
            frame[ACCELERATION + k] = 0.0
            frame[VELOCITY + k] = velocity[k]
        if kind.table[body, MOTION] == FREE:
            quaternion = rotate_by_exponential(
                (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3]),
                h * velocity[3],
                h * velocity[4],
                h * velocity[5],
            )
            for k in range(3):
                frame[POSITION + k] += h * velocity[k]
            for k in range(4):
                frame[ORIENTATION + k] = quaternion[k]
        elif kind.table[body, MOTION] == DRIVEN:
            drive_pose(kind.constants[kind.table[body, DRIVE] :], time + h, frame[POSITION : POSITION + 7])


@kernel(internal=True)
def _add_drive_work(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Work of a drive: its impulse is the change of momentum, matrices of the start, less the other impulses."""
    h = step
    n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
    modes = slice(first, first + n)
    frame = stage = kind.frame[body]
    shape, R = shape_of(kind, body), stage_rotation(kind, body)
    m = shape[SHAPE_MASS]
    products = kind.products[:, 8 * first : 8 * (first + n)]
    I_tf = kind.modal[TF1:, modes]
    velocity = work.velocity[dof : dof + 6 + n]
    rates = kind.modal[RATE, modes]
    w = (frame[SPIN], frame[SPIN + 1], frame[SPIN + 2])
    v = rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2])
    v1 = rotate_back(R, velocity[0], velocity[1], velocity[2])
    w1 = (velocity[3], velocity[4], velocity[5])
    p, l = body_momenta(shape, stage, I_tf, v, w, rates)
    p1, l1 = body_momenta(shape, stage, I_tf, v1, w1, velocity[6:])
    f, t = frame_velocity_forces(shape, kind.modal[Q, modes], products[AT_Q], stage, w[0], w[1], w[2], rates)
    g = rotate_back(R, work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2])
    force = rotate_back(R, stage[FORCE], stage[FORCE + 1], stage[FORCE + 2])
    weight = cross(stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2], g[0], g[1], g[2])
    for k in range(3):
        impulse = p1[k] - p[k] - h * (force[k] + m * g[k] + f[k])
        twist = l1[k] - l[k] - h * (stage[MOMENT + k] + weight[k] + t[k])
        frame[WORK + 1] += impulse * v1[k] + twist * w1[k]
