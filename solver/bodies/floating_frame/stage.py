"""Floating-frame bodies at a stage: markers, gathered forces, factor and solution, for integrators and the record.

Markers are points and directions. A point moves with the displacement of the finite-element model there, which the
shape functions of an element make from those of its nodes. A direction turns with the frame, and with its place where
modes turn that (`heavylift.solver.bodies.floating_frame.turned_directions`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import cholesky_factor, cholesky_solve
from heavylift.numerics.vectors import add, cross, rotate, rotate_back, vector
from heavylift.solver.bodies.floating_frame.inertia import deformed_inertia, stacked_products
from heavylift.solver.bodies.floating_frame.kind import (
    FloatingFrame,
    FloatingFrameBodies,
    product_columns,
    shape_of,
)
from heavylift.solver.bodies.floating_frame.stiffening import correct_inertia
from heavylift.solver.bodies.floating_frame.turned_directions import write_turned_direction
from heavylift.solver.bodies.frames.motion import (
    add_wrench,
    columns_of,
    point_outputs,
    pose_stage,
    write_point,
    write_turn,
)
from heavylift.solver.drive import FREE, drive_pose
from heavylift.solver.interface import ROWS, Workspace, fill_markers
from heavylift.solver.kinds import implement

__all__ = [
    "add_joint_forces",
    "clear_velocity",
    "drive_frame",
    "factor_frame",
    "fill_floating_frame_markers",
    "gather_marker_forces",
    "solve_stage",
    "stage_at_state",
    "update_products",
    "write_markers",
    "write_sensor",
]


# ---- markers ----


@kernel(internal=True)
def write_markers(kind: FloatingFrameBodies, level: int, work: Workspace) -> None:
    """Write vectors, rates and Jacobian windows ``[1, -R u~, R Phi]`` of all markers at the stage."""
    for marker in range(kind.markers.shape[0]):
        packed = kind.markers[marker]
        number, body, start, serves = packed.number, packed.body, packed.data, packed.level
        direction = packed.direction
        if serves > level:
            continue
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        data = kind.constants[start:]
        frame = kind.frame[body]
        R = frame.mid_rotation
        modes = slice(first, first + n)
        mid_modal_position = kind.mid_modal_position[modes]
        mid_modal_velocity = kind.mid_modal_velocity[modes]
        u1, u2, u3 = data[0], data[1], data[2]
        d1 = d2 = d3 = 0.0
        by_modes = (0.0, 0.0, 0.0)
        jacobian = work.jacobian[number]
        if packed.turned:
            (u1, u2, u3), by_modes = write_turned_direction(
                data, R, mid_modal_position, mid_modal_velocity, jacobian
            )
        elif not direction:
            for i in range(n):
                q, qd = mid_modal_position[i], mid_modal_velocity[i]
                phi1, phi2, phi3 = data[3 + i], data[3 + n + i], data[3 + 2 * n + i]
                u1 += phi1 * q
                u2 += phi2 * q
                u3 += phi3 * q
                d1 += phi1 * qd
                d2 += phi2 * qd
                d3 += phi3 * qd
                for k in range(3):
                    jacobian[k, 6 + i] = R[3 * k] * phi1 + R[3 * k + 1] * phi2 + R[3 * k + 2] * phi3
        else:
            for i in range(6, 6 + n):
                jacobian[0, i] = jacobian[1, i] = jacobian[2, i] = 0.0
        u = (u1, u2, u3)
        turned, axes = cross(frame.mid_spin, u), columns_of(R)
        point, rate = rotate(R, u), rotate(R, turned)
        if not direction:
            point = add(point, frame.mid_position)
            rate = rotate(R, add(add(vector(frame.mid_velocity), turned), (d1, d2, d3)))
        elif packed.turned:
            rate = add(rate, by_modes)
        for k in range(3):
            work.markers[number].point[k] = point[k]
            work.markers[number].velocity[k] = rate[k]
            for j in range(3):
                jacobian[k, j] = 1.0 if (j == k and not direction) else 0.0
        write_turn(axes, u, jacobian)


@kernel(internal=True)
def gather_marker_forces(kind: FloatingFrameBodies, work: Workspace) -> None:
    """Generalised forces ``J^T f`` of all markers, into the stages of their bodies."""
    for body in range(kind.table.shape[0]):
        for j in range(6):
            kind.frame[body].wrench[j] = 0.0
    for i in range(kind.modal_position.shape[0]):
        kind.modal_load[i] = 0.0
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level == ROWS:
            continue
        number, body = kind.markers[marker].number, kind.markers[marker].body
        n, first = kind.table[body].mode_count, kind.table[body].first_mode
        f1, f2, f3 = vector(work.markers[number].force)
        jacobian = work.jacobian[number]
        modes = slice(first, first + n)
        modal_load = kind.modal_load[modes]
        add_wrench(kind.frame[body], jacobian, 0, work.markers[number].force)
        for i in range(n):
            modal_load[i] += jacobian[0, 6 + i] * f1 + jacobian[1, 6 + i] * f2 + jacobian[2, 6 + i] * f3


@kernel(internal=True)
def add_joint_forces(kind: FloatingFrameBodies, body: int, work: Workspace) -> None:
    """Add to the gathered forces those of the rows at the carried state."""
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    for j in range(6):
        kind.frame[body].wrench[j] += work.row_force[dof + j]
    for i in range(n):
        kind.modal_load[first + i] += work.row_force[dof + 6 + i]


@kernel(reassociate=True, internal=True)
def write_sensor(kind: FloatingFrameBodies, sensor: int, row: NDArray[np.float64]) -> None:
    """World position and velocity of a sensor point; the stage holds the carried state."""
    column, body, start = kind.sensors[sensor].number, kind.sensors[sensor].body, kind.sensors[sensor].data
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    data = kind.constants[start:]
    frame = kind.frame[body]
    modes = slice(first, first + n)
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    u1, u2, u3 = data[0], data[1], data[2]
    d1 = d2 = d3 = 0.0
    for i in range(n):
        q, qd = modal_position[i], modal_velocity[i]
        u1 += data[3 + i] * q
        u2 += data[3 + n + i] * q
        u3 += data[3 + 2 * n + i] * q
        d1 += data[3 + i] * qd
        d2 += data[3 + n + i] * qd
        d3 += data[3 + 2 * n + i] * qd
    write_point(frame, (u1, u2, u3), (d1, d2, d3), point_outputs(row, column))


# ---- one body ----


@kernel(internal=True)
def update_products(kind: FloatingFrameBodies, body: int) -> None:
    """Stacked matrices times the carried modal coordinates and rates."""
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    rows = slice(8 * first, 8 * (first + n))
    stacked_products(
        product_columns(kind, body),
        kind.modal_position[first : first + n],
        kind.modal_velocity[first : first + n],
        kind.position_products[rows],
        kind.velocity_products[rows],
    )


@kernel(internal=True)
def drive_frame(kind: FloatingFrameBodies, body: int, time: float) -> None:
    """Pose of a driven frame at a time [s]."""
    frame = kind.frame[body]
    drive_pose(kind.constants[kind.table[body].drive :], time, frame.drive_pose)
    for k in range(3):
        frame.position[k] = frame.drive_pose[k]
    for k in range(4):
        frame.orientation[k] = frame.drive_pose[3 + k]


@kernel(internal=True)
def stage_at_state(kind: FloatingFrameBodies, body: int, with_inertia: bool) -> None:
    """Set the stage to the carried state, for forces and records at the ends of steps.

    Parameters
    ----------
    kind, body
        The body.
    with_inertia
        Also update the products and evaluate ``S_t``, ``I_tt``, ``I_tf``.
    """
    n, first = kind.table[body].mode_count, kind.table[body].first_mode
    modes = slice(first, first + n)
    frame = kind.frame[body]
    modal_position = kind.modal_position[modes]
    modal_velocity = kind.modal_velocity[modes]
    mid_modal_position = kind.mid_modal_position[modes]
    mid_modal_velocity = kind.mid_modal_velocity[modes]
    pose_stage(frame)
    v = rotate_back(frame.mid_rotation, frame.velocity)
    for k in range(3):
        frame.mid_velocity[k] = v[k]
        frame.mid_spin[k] = frame.spin[k]
    for i in range(n):
        mid_modal_position[i] = modal_position[i]
        mid_modal_velocity[i] = modal_velocity[i]
    if with_inertia:
        update_products(kind, body)
        deformed_inertia(
            shape_of(kind, body),
            kind.modal_position[modes],
            kind.position_products[8 * first : 8 * (first + n)],
            frame,
            kind.coupling[:, modes],
        )
        correct_inertia(kind, body, kind.modal_position[modes])


@implement(fill_markers, FloatingFrameBodies)
@kernel(internal=True)
def fill_floating_frame_markers(
    kind: FloatingFrameBodies, at_midpoint: bool, level: int, work: Workspace
) -> None:
    """Markers at the midpoint, which `predict` has set, or at the carried state."""
    if not at_midpoint:
        for body in range(kind.table.shape[0]):
            stage_at_state(kind, body, False)
    write_markers(kind, level, work)


@kernel(reassociate=True)
def factor_frame(
    frame: FloatingFrame,
    inverse_diagonal: NDArray[np.float64],
    translation: NDArray[np.float64],
    coupling: NDArray[np.float64],
) -> None:
    """Cholesky factor of the frame block after elimination of the modes.

    Parameters
    ----------
    frame
        Has mass, ``S_t`` and ``I_tt``; receives the factor.
    inverse_diagonal
        Of the modal block of the body, shape (n,).
    translation, coupling
        S and ``I_tf``, shape (3, n).

    Notes
    -----
    ``K = M_rr - C D^-1 C^T`` with ``C = [S; I_tf]`` and diagonal D: O(21 n) instead of a dense solve.
    """
    k00 = k10 = k11 = k20 = k21 = k22 = k30 = k31 = k32 = k33 = 0.0
    k40 = k41 = k42 = k43 = k44 = k50 = k51 = k52 = k53 = k54 = k55 = 0.0
    K = frame.factor
    for i in range(inverse_diagonal.shape[0]):  # all 21 sums in registers, one pass over the couplings
        w = -inverse_diagonal[i]
        c0, c1, c2 = translation[0, i], translation[1, i], translation[2, i]
        c3, c4, c5 = coupling[0, i], coupling[1, i], coupling[2, i]
        w0, w1, w2, w3, w4, w5 = w * c0, w * c1, w * c2, w * c3, w * c4, w * c5
        k00 += w0 * c0
        k10 += w1 * c0
        k11 += w1 * c1
        k20 += w2 * c0
        k21 += w2 * c1
        k22 += w2 * c2
        k30 += w3 * c0
        k31 += w3 * c1
        k32 += w3 * c2
        k33 += w3 * c3
        k40 += w4 * c0
        k41 += w4 * c1
        k42 += w4 * c2
        k43 += w4 * c3
        k44 += w4 * c4
        k50 += w5 * c0
        k51 += w5 * c1
        k52 += w5 * c2
        k53 += w5 * c3
        k54 += w5 * c4
        k55 += w5 * c5
    m = frame.mass
    s1, s2, s3 = vector(frame.first_moment)
    K[0], K[7], K[14] = m + k00, m + k11, m + k22
    K[6], K[12], K[13] = k10, k20, k21
    K[18], K[19], K[20] = k30, k31 - s3, k32 + s2
    K[24], K[25], K[26] = k40 + s3, k41, k42 - s1
    K[30], K[31], K[32] = k50 - s2, k51 + s1, k52
    K[21], K[28], K[35] = frame.inertia[0] + k33, frame.inertia[1] + k44, frame.inertia[2] + k55
    K[27], K[33], K[34] = frame.inertia[3] + k43, frame.inertia[4] + k53, frame.inertia[5] + k54
    cholesky_factor(K, 6)


@kernel(internal=True)
def clear_velocity(kind: FloatingFrameBodies, body: int, work: Workspace) -> None:
    """Begin the velocity of the stage of a body with zeros."""
    dof = kind.table[body].dof
    for i in range(dof, dof + 6 + kind.table[body].mode_count):
        work.velocity[i] = 0.0


@kernel(reassociate=True, internal=True)
def solve_stage(kind: FloatingFrameBodies, body: int, weight: float, work: Workspace) -> None:
    """Add the solution for the right-hand sides to the velocity of the stage, with the factor that is there.

    Parameters
    ----------
    kind, body
        The body; the right-hand sides of its frame, which are used up, those of its modes and the quadratic forces
        are set. Of a frame that is not free the first are its prescribed body-axis velocities instead.
    weight
        Time [s] by which the quadratic forces act.
    work
        World velocity, body-axis spin and modal rates grow.
    """
    n, first, dof = kind.table[body].mode_count, kind.table[body].first_mode, kind.table[body].dof
    frame = kind.frame[body]
    modes = slice(first, first + n)
    inverse_diagonal = kind.inverse_diagonal[modes]
    coupling = kind.coupling[:, modes]
    modal_right_hand_side = kind.modal_right_hand_side[modes]
    quadratic_force = kind.quadratic_force[modes]
    shape = shape_of(kind, body)
    velocity = work.velocity[dof : dof + 6 + n]
    motion = kind.table[body].motion
    y = frame.right_hand_side
    if motion == FREE:
        r1 = r2 = r3 = r4 = r5 = r6 = 0.0
        for i in range(n):
            t = inverse_diagonal[i] * (modal_right_hand_side[i] + weight * quadratic_force[i])
            r1 += shape[i] * t
            r2 += shape[n + i] * t
            r3 += shape[2 * n + i] * t
            r4 += coupling[0, i] * t
            r5 += coupling[1, i] * t
            r6 += coupling[2, i] * t
        y[0] -= r1
        y[1] -= r2
        y[2] -= r3
        y[3] -= r4
        y[4] -= r5
        y[5] -= r6
        cholesky_solve(frame.factor, y, 6)
    for i in range(n):
        coupled = (
            shape[i] * y[0]
            + shape[n + i] * y[1]
            + shape[2 * n + i] * y[2]
            + coupling[0, i] * y[3]
            + coupling[1, i] * y[4]
            + coupling[2, i] * y[5]
        )
        velocity[6 + i] += inverse_diagonal[i] * (
            modal_right_hand_side[i] + weight * quadratic_force[i] - coupled
        )
    v = rotate(kind.frame[body].mid_rotation, y)
    for k in range(3):
        velocity[k] += v[k]
        velocity[3 + k] += y[3 + k]
