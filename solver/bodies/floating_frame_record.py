"""State, reactions, sensors, energies and momenta of floating-frame bodies, at the ends of steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cross, rotate, rotate_back
from heavylift.solver.bodies.floating_frame import (
    ANGULAR_MOMENTUM,
    AT_Q,
    AT_RATE,
    COLUMN,
    DAMPING,
    DRIVE,
    FIRST_MOMENT,
    FORCE,
    LOAD,
    MODAL,
    MODES,
    MOMENT,
    MOMENTUM,
    MOTION,
    POSITION,
    PRESCRIBED,
    QUADRATIC,
    RATE,
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
    inertia_product,
    quadratic_modal_force,
)
from heavylift.solver.bodies.floating_frame_markers import (
    add_joint_forces,
    gather_marker_forces,
    write_sensor,
)
from heavylift.solver.bodies.floating_frame_shape import shape_of, stage_rotation
from heavylift.solver.bodies.floating_frame_stage import stage_at_state
from heavylift.solver.drive import DRIVEN, FREE, drive_pose, drive_velocity
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    record,
    start,
)
from heavylift.solver.kinds import implement

__all__: list[str] = []


@implement(start, FloatingFrameBodies)
@kernel(internal=True)
def start_floating_frames(kind: FloatingFrameBodies, time: float, work: Workspace) -> None:
    """Place driven frames, evaluate products and momenta of the start state."""
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        frame = stage = kind.frame[body]
        if kind.table[body, MOTION] == DRIVEN:
            drive = kind.constants[kind.table[body, DRIVE] :]
            drive_pose(drive, time, frame[POSITION : POSITION + 7])
            drive_velocity(drive, time, stage[PRESCRIBED : PRESCRIBED + 12])
            for k in range(3):
                frame[VELOCITY + k] = stage[PRESCRIBED + k]
                frame[SPIN + k] = stage[PRESCRIBED + 3 + k]
        stage_at_state(kind, body, True)
        R = stage_rotation(kind, body)
        v = rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2])
        w = (frame[SPIN], frame[SPIN + 1], frame[SPIN + 2])
        modes = slice(first, first + n)
        p, l = body_momenta(
            shape_of(kind, body), stage, kind.modal[TF1:, modes], v, w, kind.modal[RATE, modes]
        )
        p = rotate(R, p[0], p[1], p[2])
        l = rotate(R, l[0], l[1], l[2])
        for k in range(3):
            frame[MOMENTUM + k] = p[k]
            frame[ANGULAR_MOMENTUM + k] = l[k]


@implement(record, FloatingFrameBodies)
@kernel(internal=True)
def record_floating_frames(
    kind: FloatingFrameBodies, time: float, work: Workspace, row: NDArray[np.float64]
) -> None:
    """Columns of a body: position, quaternion, velocity, spin, q, qd, and the reaction of a held frame."""
    gather_marker_forces(kind, work)
    for body in range(kind.table.shape[0]):
        n, first, column = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, COLUMN]
        frame = kind.frame[body]
        for k in range(13):
            row[column + k] = frame[POSITION + k]
        for i in range(n):
            row[column + 13 + i] = kind.modal[Q, first + i]
            row[column + 13 + n + i] = kind.modal[RATE, first + i]
        if kind.table[body, MOTION] != FREE:
            add_joint_forces(kind, body)
            reaction = row[column + 13 + 2 * n : column + 19 + 2 * n]
            _write_reaction(kind, body, time, work, reaction)
        elif kind.sensors.shape[0] > 0:
            stage_at_state(kind, body, False)
    for sensor in range(kind.sensors.shape[0]):
        write_sensor(kind, sensor, row)


@kernel(reassociate=True, internal=True)
def _write_reaction(
    kind: FloatingFrameBodies, body: int, time: float, work: Workspace, reaction: NDArray[np.float64]
) -> None:
    """Force and moment about the frame origin, world axes, that hold a driven frame on its course.

    Notes
    -----
    The modal accelerations follow from the modal rows at this instant; the frame rows of the equations
    of motion, quadratic velocity forces included, then give what is missing to balance them.
    """
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
    stage = kind.frame[body]
    modes = slice(first, first + n)
    modal = kind.modal[:, modes]
    shape = shape_of(kind, body)
    stage_at_state(kind, body, True)
    products = kind.products[:, 8 * first : 8 * (first + n)]
    R = stage_rotation(kind, body)
    motion = stage[PRESCRIBED : PRESCRIBED + 12]
    drive_velocity(kind.constants[kind.table[body, DRIVE] :], time, motion)
    w1, w2, w3 = motion[3], motion[4], motion[5]
    b1, b2, b3 = motion[9], motion[10], motion[11]
    # gravity acts like an acceleration of the frame in the other direction
    a1, a2, a3 = rotate_back(
        R,
        motion[6] - work.sums.gravity[0],
        motion[7] - work.sums.gravity[1],
        motion[8] - work.sums.gravity[2],
    )
    quadratic_modal_force(
        shape, kind.modal[Q, modes], products[AT_Q], products[AT_RATE], w1, w2, w3, modal[QUADRATIC]
    )
    f, m = frame_velocity_forces(
        shape, kind.modal[Q, modes], products[AT_Q], stage, w1, w2, w3, kind.modal[RATE, modes]
    )
    p1 = p2 = p3 = 0.0
    l1 = l2 = l3 = 0.0
    for i in range(n):
        acceleration = (
            modal[LOAD, i]
            + modal[QUADRATIC, i]
            - kind.modal[STIFFNESS, first + i] * kind.modal[Q, first + i]
            - kind.modal[DAMPING, first + i] * kind.modal[RATE, first + i]
            - shape[SHAPE_HEAD + i] * a1
            - shape[SHAPE_HEAD + n + i] * a2
            - shape[SHAPE_HEAD + 2 * n + i] * a3
            - modal[TF1, i] * b1
            - modal[TF1 + 1, i] * b2
            - modal[TF1 + 2, i] * b3
        )
        p1 += shape[SHAPE_HEAD + i] * acceleration
        p2 += shape[SHAPE_HEAD + n + i] * acceleration
        p3 += shape[SHAPE_HEAD + 2 * n + i] * acceleration
        l1 += modal[TF1, i] * acceleration
        l2 += modal[TF1 + 1, i] * acceleration
        l3 += modal[TF1 + 2, i] * acceleration
    s1, s2, s3 = stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2]
    mass = shape[SHAPE_MASS]
    c1, c2, c3 = cross(b1, b2, b3, s1, s2, s3)
    d1, d2, d3 = cross(s1, s2, s3, a1, a2, a3)
    e1, e2, e3 = inertia_product(stage, b1, b2, b3)
    force = rotate(R, mass * a1 + c1 + p1 - f[0], mass * a2 + c2 + p2 - f[1], mass * a3 + c3 + p3 - f[2])
    moment = rotate(
        R,
        d1 + e1 + l1 - m[0] - stage[MOMENT],
        d2 + e2 + l2 - m[1] - stage[MOMENT + 1],
        d3 + e3 + l3 - m[2] - stage[MOMENT + 2],
    )
    for k in range(3):
        reaction[k] = force[k] - stage[FORCE + k]
        reaction[3 + k] = moment[k]


@implement(add_totals, FloatingFrameBodies)
@kernel(reassociate=True, internal=True)
def add_floating_frame_totals(kind: FloatingFrameBodies, work: Workspace) -> None:
    """Energies and momenta from the carried velocities."""
    totals = work.sums
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        modes = slice(first, first + n)
        frame = stage = kind.frame[body]
        shape = shape_of(kind, body)
        stage_at_state(kind, body, True)
        R = stage_rotation(kind, body)
        rates = kind.modal[RATE, modes]
        I_tf = kind.modal[TF1:, modes]
        v = rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2])
        w = (frame[SPIN], frame[SPIN + 1], frame[SPIN + 2])
        p, l = body_momenta(shape, stage, I_tf, v, w, rates)
        kinetic = p[0] * v[0] + p[1] * v[1] + p[2] * v[2] + l[0] * w[0] + l[1] * w[1] + l[2] * w[2]
        elastic = 0.0
        for i in range(n):
            modal_momentum = (
                rates[i]
                + shape[SHAPE_HEAD + i] * v[0]
                + shape[SHAPE_HEAD + n + i] * v[1]
                + shape[SHAPE_HEAD + 2 * n + i] * v[2]
                + I_tf[0, i] * w[0]
                + I_tf[1, i] * w[1]
                + I_tf[2, i] * w[2]
            )
            kinetic += modal_momentum * rates[i]
            elastic += kind.modal[STIFFNESS, first + i] * kind.modal[Q, first + i] ** 2
        totals.kinetic += 0.5 * kinetic
        totals.elastic += 0.5 * elastic
        m = shape[SHAPE_MASS]
        s = rotate(R, stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2])
        for k in range(3):
            totals.potential -= work.sums.gravity[k] * (m * frame[POSITION + k] + s[k])
        totals.external_work += frame[WORK]
        totals.drive_work += frame[WORK + 1]
        totals.dissipated += frame[WORK + 2]
        p = rotate(R, p[0], p[1], p[2])
        l = rotate(R, l[0], l[1], l[2])
        x = cross(frame[POSITION], frame[POSITION + 1], frame[POSITION + 2], p[0], p[1], p[2])
        for k in range(3):
            totals.linear_momentum[k] += p[k]
            totals.angular_momentum[k] += l[k] + x[k]
