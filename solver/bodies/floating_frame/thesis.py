"""First-order step of floating-frame bodies: discrete Euler-Lagrange equation with the stiffness as compliant rows.

"Integrated simulation ... ships and offshore structures" (2018), eq. 49, has for compliant rows
``G v = rate of the spring``, multiplier eliminated::

    ( M + h^2/4 K + h D ) U+ = ( M + h^2/4 K ) U + h ( Q + Q_v - K q )

with all matrices and forces at the start of the step. For a linear oscillator this is the trapezoidal
rule between velocities at half steps; everything else is first order. For comparison, not for use.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import cross, rotate_back, vector, vector_at
from heavylift.solver.bodies.floating_frame.fixed_frame import thesis_advance_fixed, thesis_velocity_fixed
from heavylift.solver.bodies.floating_frame.inertia import (
    body_momenta,
    frame_velocity_forces,
    quadratic_modal_force,
)
from heavylift.solver.bodies.floating_frame.kind import (
    FloatingFrameBodies,
    shape_of,
)
from heavylift.solver.bodies.floating_frame.stage import (
    clear_velocity,
    drive_frame,
    factor_frame,
    gather_marker_forces,
    solve_stage,
    stage_at_state,
)
from heavylift.solver.bodies.floating_frame.stiffening import (
    add_quadratic_forces,
    add_step_forces,
    with_shortening,
)
from heavylift.solver.bodies.frames.motion import advance_pose
from heavylift.solver.drive import DRIVEN, FIXED, FREE, drive_velocity
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
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        motion = kind.table[body].motion
        if motion == DRIVEN:
            drive_velocity(kind.constants[kind.table[body].drive :], time + h, kind.frame[body].drive_rates)
        modal_position = kind.modal_position[first : first + n]
        if motion == FIXED:
            add_step_forces(kind, body, h, work.sums.gravity, modal_position)
            thesis_velocity_fixed(kind, body, h, work)
            continue
        modes = slice(first, first + n)
        frame = kind.frame[body]
        quadratic_force = kind.quadratic_force[modes]
        inverse_diagonal = kind.inverse_diagonal[modes]
        modal_right_hand_side = kind.modal_right_hand_side[modes]
        coupling = kind.coupling[:, modes]
        modal_load = kind.modal_load[modes]
        rates = kind.modal_velocity[modes]
        shape = shape_of(kind, body)
        stage_at_state(kind, body, True)
        add_step_forces(kind, body, h, work.sums.gravity, modal_position)
        R = frame.mid_rotation
        g = rotate_back(R, work.sums.gravity)
        v = rotate_back(R, frame.velocity)
        w = vector(frame.spin)
        rows = slice(8 * first, 8 * (first + n))
        position_products = kind.position_products[rows]
        velocity_products = kind.velocity_products[rows]
        quadratic_modal_force(
            shape,
            kind.modal_position[modes],
            position_products,
            velocity_products,
            w,
            quadratic_force,
        )
        add_quadratic_forces(kind, body, w)
        for i in range(n):
            stiffness, damping = kind.stiffness[first + i], kind.damping[first + i]
            elastic = 1.0 + 0.25 * h * h * stiffness
            inverse_diagonal[i] = 1.0 / (elastic + h * damping)
            S1, S2, S3 = shape[i], shape[n + i], shape[2 * n + i]
            modal_right_hand_side[i] = elastic * rates[i] + h * (
                modal_load[i] + S1 * g[0] + S2 * g[1] + S3 * g[2] - stiffness * kind.modal_position[first + i]
            )
            modal_right_hand_side[i] += (
                S1 * v[0]
                + S2 * v[1]
                + S3 * v[2]
                + coupling[0, i] * w[0]
                + coupling[1, i] * w[1]
                + coupling[2, i] * w[2]
            )
        if motion == FREE:
            m = frame.mass
            p, l = body_momenta(shape, frame, coupling, v, w, rates)
            f, t = frame_velocity_forces(
                shape, kind.modal_position[modes], position_products, frame, w, rates
            )
            t = with_shortening(kind, body, w, rates, t)
            force = rotate_back(R, frame.force)
            moment = cross(frame.first_moment, g)
            for k in range(3):
                frame.right_hand_side[k] = p[k] + h * (force[k] + m * g[k] + f[k])
                frame.right_hand_side[3 + k] = l[k] + h * (frame.moment[k] + moment[k] + t[k])
            factor_frame(frame, inverse_diagonal, kind.translation[:, modes], coupling)
        elif motion == DRIVEN:
            prescribed = frame.drive_rates
            a = rotate_back(R, prescribed)
            for k in range(3):
                frame.right_hand_side[k] = a[k]
                frame.right_hand_side[3 + k] = prescribed[3 + k]
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
        n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
        frame = kind.frame[body]
        velocity = work.velocity[dof : dof + 6 + n]
        if kind.table[body].motion == FIXED:
            thesis_advance_fixed(kind, body, h, work)
            continue
        if kind.table[body].motion == DRIVEN:
            _add_drive_work(kind, body, h, work)
        external = dissipated = 0.0
        for j in range(3):
            external += frame.force[j] * velocity[j]
        for j in range(3):
            external += frame.moment[j] * velocity[3 + j]
        for i in range(n):
            rate = velocity[6 + i]
            external += kind.modal_load[first + i] * rate
            dissipated += kind.damping[first + i] * rate * rate
            kind.modal_position[first + i] += h * rate
            kind.modal_velocity[first + i] = rate
        frame.external_work += h * external
        frame.dissipated_work += h * dissipated
        for k in range(3):
            frame.acceleration[k] = frame.spin_rate[k] = 0.0
            frame.velocity[k] = velocity[k]
            frame.spin[k] = velocity[3 + k]
        if kind.table[body].motion == FREE:
            advance_pose(frame, velocity, h)
        elif kind.table[body].motion == DRIVEN:
            drive_frame(kind, body, time + h)


@kernel(internal=True)
def _add_drive_work(kind: FloatingFrameBodies, body: int, step: float, work: Workspace) -> None:
    """Work of a drive: its impulse is the change of momentum, matrices of the start, less the other impulses."""
    h = step
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    modes = slice(first, first + n)
    frame = kind.frame[body]
    shape, R, m = shape_of(kind, body), frame.mid_rotation, frame.mass
    rows = slice(8 * first, 8 * (first + n))
    position_products = kind.position_products[rows]
    I_tf = kind.coupling[:, modes]
    velocity = work.velocity[dof : dof + 6 + n]
    rates = kind.modal_velocity[modes]
    w = vector(frame.spin)
    v = rotate_back(R, frame.velocity)
    v1 = rotate_back(R, velocity)
    w1 = vector_at(velocity, 3)
    p, l = body_momenta(shape, frame, I_tf, v, w, rates)
    p1, l1 = body_momenta(shape, frame, I_tf, v1, w1, velocity[6:])
    f, t = frame_velocity_forces(shape, kind.modal_position[modes], position_products, frame, w, rates)
    t = with_shortening(kind, body, w, rates, t)
    g = rotate_back(R, work.sums.gravity)
    force = rotate_back(R, frame.force)
    weight = cross(frame.first_moment, g)
    for k in range(3):
        impulse = p1[k] - p[k] - h * (force[k] + m * g[k] + f[k])
        twist = l1[k] - l[k] - h * (frame.moment[k] + weight[k] + t[k])
        frame.drive_work += impulse * v1[k] + twist * w1[k]
