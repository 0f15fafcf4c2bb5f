"""The kind of flexible bodies whose frame stands still: modal oscillators, reactions, nothing else.

A clamped body has no inertia coupling, no velocity forces and a diagonal step matrix. It would run
through the code of a floating frame too, but a scene should execute only what it needs.
The trapezoidal rule of the second-order step is, per mode::

    ( 1 + h^2/4 k + h/2 d ) qd_b = qd + h/2 ( Q - k q ),   q += h qd_b,   qd := 2 qd_b - qd
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import write_rotation_matrix
from heavylift.numerics.small import cross, rotate, rotate_back
from heavylift.solver.bodies.floating_frame import (
    AT_Q,
    AT_RATE,
    COLUMN,
    DAMPING,
    DOF,
    FIRST_MOMENT,
    FORCE,
    INVERSE,
    JOINT_LOAD,
    LOAD,
    MID_POSITION,
    MID_Q,
    MID_RATE,
    MID_ROTATION,
    MODAL,
    MODES,
    MOMENT,
    NUMBER,
    ORIENTATION,
    POSITION,
    RATE,
    RATE2,
    ROW,
    S1,
    SHAPE_HEAD,
    SHAPE_MASS,
    STIFFNESS,
    TF1,
    WORK,
    FixedFrameBodies,
    Q,
    pack_floating_frames,
)
from heavylift.solver.bodies.floating_frame_inertia import deformed_inertia, stacked_products
from heavylift.solver.bodies.floating_frame_markers import (
    add_joint_forces,
    gather_marker_forces,
    write_markers,
    write_sensor,
)
from heavylift.solver.bodies.floating_frame_shape import product_columns, shape_of, stage_rotation
from heavylift.solver.interface import (
    Workspace,
    add_totals,
    advance,
    check,
    factor,
    fill_markers,
    finish,
    predict,
    record,
    start,
    thesis_advance,
    thesis_velocity,
)
from heavylift.solver.kinds import implement
from heavylift.solver.markers import BodyMarkers
from heavylift.solver.scene_bodies import FlexibleBody

__all__ = ["FixedFrameBodies", "pack_fixed_frames"]

NOT_FINITE = int(Outcome.NOT_FINITE)


def pack_fixed_frames(
    bodies: Sequence[FlexibleBody],
    first_number: int,
    first_dof: int,
    first_column: int,
    markers: Sequence[BodyMarkers],
    sensors: Sequence[BodyMarkers],
) -> FixedFrameBodies:
    """Make the kind; arguments as of `pack_floating_frames`."""
    return FixedFrameBodies(
        *pack_floating_frames(bodies, first_number, first_dof, first_column, markers, sensors)
    )


@implement(start, FixedFrameBodies)
@kernel(internal=True)
def start_fixed_frames(kind: FixedFrameBodies, time: float, work: Workspace) -> None:
    """The pose of the stage is that of the frame, once and for all."""
    for body in range(kind.table.shape[0]):
        frame = kind.frame[body]
        q = (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3])
        write_rotation_matrix(q, frame[MID_ROTATION : MID_ROTATION + 9])
        for k in range(3):
            frame[MID_POSITION + k] = frame[POSITION + k]


@implement(predict, FixedFrameBodies)
@kernel(internal=True)
def predict_fixed_frames(kind: FixedFrameBodies, time: float, step: float) -> None:
    """Modal coordinates at the midpoint, for markers and contours only."""
    for i in range(kind.modal.shape[1]):
        kind.modal[MID_Q, i] = kind.modal[Q, i] + 0.5 * step * kind.modal[RATE, i]
        kind.modal[MID_RATE, i] = kind.modal[RATE, i]


@implement(fill_markers, FixedFrameBodies)
@kernel(internal=True)
def fill_fixed_frame_markers(kind: FixedFrameBodies, at_midpoint: bool, level: int, work: Workspace) -> None:
    """Markers on the fixed frame."""
    if kind.markers.shape[0] > 0:
        if not at_midpoint:
            for i in range(kind.modal.shape[1]):
                kind.modal[MID_Q, i] = kind.modal[Q, i]
                kind.modal[MID_RATE, i] = kind.modal[RATE, i]
        write_markers(kind, level, work)


@kernel(internal=True)
def gather_loads(kind: FixedFrameBodies, work: Workspace) -> None:
    """Modal loads: of the markers into row `LOAD`, with gravity into row `ROW`."""
    gather_marker_forces(kind, work)
    g1, g2, g3 = work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2]
    weightless = g1 == 0.0 and g2 == 0.0 and g3 == 0.0
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        modal = kind.modal[:, first : first + n]
        for i in range(n):
            modal[ROW, i] = modal[LOAD, i]
        if not weightless:
            g = rotate_back(stage_rotation(kind, body), g1, g2, g3)
            for i in range(n):
                modal[ROW, i] += modal[S1, i] * g[0] + modal[S1 + 1, i] * g[1] + modal[S1 + 2, i] * g[2]


@implement(factor, FixedFrameBodies)
@kernel(internal=True)
def factor_fixed_frames(kind: FixedFrameBodies, step: float, work: Workspace) -> None:
    """Midpoint rates of all modes."""
    gather_loads(kind, work)
    half = 0.5 * step
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        modal, rates = kind.modal[:, first : first + n], work.velocity[dof + 6 : dof + 6 + n]
        for k in range(6):
            work.velocity[dof + k] = 0.0
        for i in range(n):
            stiffness = modal[STIFFNESS, i]
            modal[INVERSE, i] = 1.0 / (1.0 + half * (half * stiffness + modal[DAMPING, i]))
            rates[i] = modal[INVERSE, i] * (modal[RATE, i] + half * (modal[ROW, i] - stiffness * modal[Q, i]))


@implement(check, FixedFrameBodies)
@kernel(internal=True, reassociate=True)
def check_fixed_frames(kind: FixedFrameBodies, step: float, work: Workspace) -> None:
    """Refuse what is not finite."""
    for body in range(kind.table.shape[0]):
        n, dof = kind.table[body, MODES], kind.table[body, DOF]
        total = 0.0
        for i in range(dof + 6, dof + 6 + n):
            total += abs(work.velocity[i])
        if not math.isfinite(total):
            work.status.outcome = NOT_FINITE
            work.status.body = kind.table[body, NUMBER]


@kernel(internal=True, reassociate=True)
def add_work(kind: FixedFrameBodies, body: int, step: float, rates: NDArray[np.float64]) -> None:
    """Work of the marker forces and loss in the dampers, with the rates of the stage, shape (n,)."""
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
    modal = kind.modal[:, first : first + n]
    external = dissipated = 0.0
    for i in range(n):
        external += modal[LOAD, i] * rates[i]
        dissipated += modal[DAMPING, i] * rates[i] * rates[i]
    kind.frame[body, WORK] += step * external
    kind.frame[body, WORK + 2] += step * dissipated


@implement(advance, FixedFrameBodies)
@kernel(internal=True)
def advance_fixed_frames(kind: FixedFrameBodies, time: float, step: float, work: Workspace) -> None:
    """Modal coordinates and rates to the end of the step."""
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        modal, rates = kind.modal[:, first : first + n], work.velocity[dof + 6 : dof + 6 + n]
        add_work(kind, body, step, rates)
        for i in range(n):
            modal[Q, i] += step * rates[i]
            modal[RATE2, i] = 2.0 * (rates[i] - modal[RATE, i]) / step
            modal[RATE, i] = 2.0 * rates[i] - modal[RATE, i]


@implement(finish, FixedFrameBodies)
@kernel(internal=True)
def finish_fixed_frames(kind: FixedFrameBodies, step: float, work: Workspace) -> None:
    """Nothing is left to do."""


@implement(thesis_velocity, FixedFrameBodies)
@kernel(internal=True)
def thesis_velocity_fixed_frames(kind: FixedFrameBodies, time: float, step: float, work: Workspace) -> None:
    """``( 1 + h^2/4 k + h d ) qd+ = ( 1 + h^2/4 k ) qd + h ( Q - k q )``, as for floating frames."""
    h = step
    gather_loads(kind, work)
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        for k in range(6):
            work.velocity[dof + k] = 0.0
        modal, rates = kind.modal[:, first : first + n], work.velocity[dof + 6 : dof + 6 + n]
        for i in range(n):
            elastic = 1.0 + 0.25 * h * h * modal[STIFFNESS, i]
            load = modal[ROW, i] - modal[STIFFNESS, i] * modal[Q, i]
            rates[i] = (elastic * modal[RATE, i] + h * load) / (elastic + h * modal[DAMPING, i])


@implement(thesis_advance, FixedFrameBodies)
@kernel(internal=True)
def thesis_advance_fixed_frames(kind: FixedFrameBodies, time: float, step: float, work: Workspace) -> None:
    """Modal coordinates by the end rates."""
    for body in range(kind.table.shape[0]):
        n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
        modal, rates = kind.modal[:, first : first + n], work.velocity[dof + 6 : dof + 6 + n]
        add_work(kind, body, step, rates)
        for i in range(n):
            modal[Q, i] += step * rates[i]
            modal[RATE, i] = rates[i]


@kernel(internal=True)
def deform(kind: FixedFrameBodies, body: int) -> None:
    """Products, ``S_t`` and ``I_tf`` of the carried state: needed for records only."""
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
    products = kind.products[:, 8 * first : 8 * (first + n)]
    q, rates = kind.modal[Q, first : first + n], kind.modal[RATE, first : first + n]
    stacked_products(product_columns(kind, body), q, rates, products[AT_Q], products[AT_RATE])
    deformed_inertia(
        shape_of(kind, body), q, products[AT_Q], kind.frame[body], kind.modal[TF1:, first : first + n]
    )


@implement(record, FixedFrameBodies)
@kernel(internal=True, reassociate=True)
def record_fixed_frames(
    kind: FixedFrameBodies, time: float, work: Workspace, row: NDArray[np.float64]
) -> None:
    """Position, quaternion, velocity, spin, q, qd, and the reaction of the frame.

    Notes
    -----
    The reaction balances ``dp/dt = S qdd`` and ``dL/dt = I_tf(q) qdd``, gravity and the marker forces;
    ``(d I_tf/dt) qd`` vanishes because the matrices A_k are antisymmetric.
    """
    gather_loads(kind, work)
    for body in range(kind.table.shape[0]):
        n, first, column = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, COLUMN]
        frame, shape, R = kind.frame[body], shape_of(kind, body), stage_rotation(kind, body)
        deform(kind, body)
        add_joint_forces(kind, body)
        for i in range(first, first + n):
            kind.modal[ROW, i] += kind.modal[JOINT_LOAD, i]
        for k in range(13):
            row[column + k] = frame[POSITION + k]
        p1 = p2 = p3 = 0.0
        l1 = l2 = l3 = 0.0
        for i in range(n):
            m = first + i
            row[column + 13 + i] = kind.modal[Q, m]
            row[column + 13 + n + i] = kind.modal[RATE, m]
            a = (
                kind.modal[ROW, m]
                - kind.modal[STIFFNESS, m] * kind.modal[Q, m]
                - kind.modal[DAMPING, m] * kind.modal[RATE, m]
            )
            p1 += shape[SHAPE_HEAD + i] * a
            p2 += shape[SHAPE_HEAD + n + i] * a
            p3 += shape[SHAPE_HEAD + 2 * n + i] * a
            l1 += kind.modal[TF1, m] * a
            l2 += kind.modal[TF1 + 1, m] * a
            l3 += kind.modal[TF1 + 2, m] * a
        g = rotate_back(R, work.sums.gravity[0], work.sums.gravity[1], work.sums.gravity[2])
        mass = shape[SHAPE_MASS]
        t = cross(frame[FIRST_MOMENT], frame[FIRST_MOMENT + 1], frame[FIRST_MOMENT + 2], g[0], g[1], g[2])
        force = rotate(R, p1 - mass * g[0], p2 - mass * g[1], p3 - mass * g[2])
        moment = rotate(
            R,
            l1 - t[0] - frame[MOMENT],
            l2 - t[1] - frame[MOMENT + 1],
            l3 - t[2] - frame[MOMENT + 2],
        )
        for k in range(3):
            row[column + 13 + 2 * n + k] = force[k] - frame[FORCE + k]
            row[column + 16 + 2 * n + k] = moment[k]
    for sensor in range(kind.sensors.shape[0]):
        write_sensor(kind, sensor, row)


@implement(add_totals, FixedFrameBodies)
@kernel(internal=True, reassociate=True)
def add_fixed_frame_totals(kind: FixedFrameBodies, work: Workspace) -> None:
    """Energies and momenta; the products and the coupling are those of the record just written."""
    sums = work.sums
    for body in range(kind.table.shape[0]):
        n, first = kind.table[body, MODES], kind.table[body, MODAL]
        frame, shape, R = kind.frame[body], shape_of(kind, body), stage_rotation(kind, body)
        p1 = p2 = p3 = 0.0
        l1 = l2 = l3 = 0.0
        kinetic = elastic = 0.0
        for i in range(n):
            m = first + i
            rate = kind.modal[RATE, m]
            kinetic += rate * rate
            elastic += kind.modal[STIFFNESS, m] * kind.modal[Q, m] * kind.modal[Q, m]
            p1 += shape[SHAPE_HEAD + i] * rate
            p2 += shape[SHAPE_HEAD + n + i] * rate
            p3 += shape[SHAPE_HEAD + 2 * n + i] * rate
            l1 += kind.modal[TF1, m] * rate
            l2 += kind.modal[TF1 + 1, m] * rate
            l3 += kind.modal[TF1 + 2, m] * rate
        sums.kinetic += 0.5 * kinetic
        sums.elastic += 0.5 * elastic
        s = rotate(R, frame[FIRST_MOMENT], frame[FIRST_MOMENT + 1], frame[FIRST_MOMENT + 2])
        p = rotate(R, p1, p2, p3)
        l = rotate(R, l1, l2, l3)
        x = cross(frame[POSITION], frame[POSITION + 1], frame[POSITION + 2], p[0], p[1], p[2])
        for k in range(3):
            sums.potential -= sums.gravity[k] * (shape[SHAPE_MASS] * frame[POSITION + k] + s[k])
            sums.linear_momentum[k] += p[k]
            sums.angular_momentum[k] += l[k] + x[k]
        sums.external_work += frame[WORK]
        sums.dissipated += frame[WORK + 2]
