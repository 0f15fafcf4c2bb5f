"""Building blocks of a step of one floating-frame body, shared by the integrators and the record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import write_rotation_matrix
from heavylift.numerics.small import cholesky_factor, cholesky_solve, cross, rotate, rotate_back
from heavylift.solver.bodies.floating_frame import (
    AT_Q,
    AT_RATE,
    DOF,
    FACTOR,
    FIRST_MOMENT,
    FIXED,
    FORCE,
    FRAME_RHS,
    FREE,
    INERTIA,
    INVERSE,
    LOAD,
    MID_POSITION,
    MID_Q,
    MID_RATE,
    MID_ROTATION,
    MID_SPIN,
    MID_VELOCITY,
    MODAL,
    MODES,
    MOTION,
    ORIENTATION,
    POSITION,
    QUADRATIC,
    RATE,
    ROW,
    SHAPE,
    SHAPE_HEAD,
    SHAPE_MASS,
    SPIN,
    TF1,
    VELOCITY,
    FloatingFrameBodies,
    Q,
)
from heavylift.solver.bodies.floating_frame_inertia import deformed_inertia, stacked_products
from heavylift.solver.interface import (
    POINT,
    POINT_FORCE,
    POINT_VELOCITY,
    Workspace,
    fill_markers,
)
from heavylift.solver.kinds import implement

__all__ = [
    "factor_frame",
    "gather_marker_forces",
    "product_columns",
    "shape_of",
    "solve_stage",
    "stage_at_state",
    "stage_rotation",
    "update_products",
]


@kernel(inline=True, internal=True)
def shape_of(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Packed shape of a body."""
    n = kind.index[body, MODES]
    start = kind.index[body, SHAPE]
    return kind.constants[start : start + SHAPE_HEAD + 12 * n + 9 * n * n]


@kernel(inline=True, internal=True)
def product_columns(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Stacked product matrices of a body, column after column, shape (n 9 n,)."""
    n = kind.index[body, MODES]
    start = kind.index[body, SHAPE] + SHAPE_HEAD + 12 * n
    return kind.constants[start : start + 9 * n * n]


@kernel(inline=True, internal=True)
def stage_rotation(kind: FloatingFrameBodies, body: int) -> NDArray[np.float64]:
    """Rotation matrix of the stage, row by row, a view of shape (9,)."""
    return kind.frame[body, MID_ROTATION : MID_ROTATION + 9]


@kernel(internal=True)
def update_products(kind: FloatingFrameBodies, body: int) -> None:
    """Stacked matrices times the carried modal coordinates and rates."""
    n, first = kind.index[body, MODES], kind.index[body, MODAL]
    rows = slice(9 * first, 9 * (first + n))
    stacked_products(
        product_columns(kind, body),
        kind.modal[Q, first : first + n],
        kind.modal[RATE, first : first + n],
        kind.products[AT_Q, rows],
        kind.products[AT_RATE, rows],
    )


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
    n, first = kind.index[body, MODES], kind.index[body, MODAL]
    modes = slice(first, first + n)
    frame = stage = kind.frame[body]
    R = stage_rotation(kind, body)
    write_rotation_matrix(
        (frame[ORIENTATION], frame[ORIENTATION + 1], frame[ORIENTATION + 2], frame[ORIENTATION + 3]), R
    )
    v = rotate_back(R, frame[VELOCITY], frame[VELOCITY + 1], frame[VELOCITY + 2])
    for k in range(3):
        stage[MID_POSITION + k] = frame[POSITION + k]
        stage[MID_VELOCITY + k] = v[k]
        stage[MID_SPIN + k] = frame[SPIN + k]
    for i in range(first, first + n):
        kind.modal[MID_Q, i] = kind.modal[Q, i]
        kind.modal[MID_RATE, i] = kind.modal[RATE, i]
    if with_inertia:
        update_products(kind, body)
        deformed_inertia(
            shape_of(kind, body),
            kind.modal[Q, modes],
            kind.products[AT_Q, 9 * first : 9 * (first + n)],
            stage,
            kind.modal[TF1:, modes],
        )


@implement(fill_markers, FloatingFrameBodies)
@kernel(internal=True)
def fill_floating_frame_markers(kind: FloatingFrameBodies, at_midpoint: bool, work: Workspace) -> None:
    """Write vectors, rates and Jacobian windows ``[1, -R u~, R Phi]`` of all markers."""
    if not at_midpoint and kind.markers.shape[0] > 0:
        for body in range(kind.index.shape[0]):
            stage_at_state(kind, body, False)
    for marker in range(kind.markers.shape[0]):
        number, body, start, direction = kind.markers[marker]
        n, first = kind.index[body, MODES], kind.index[body, MODAL]
        data = kind.constants[start:]
        R = stage_rotation(kind, body)
        stage = kind.frame[body]
        u1, u2, u3 = data[0], data[1], data[2]
        d1 = d2 = d3 = 0.0
        jacobian = work.jacobian[number]
        if direction == 0:
            for i in range(n):
                q, qd = kind.modal[MID_Q, first + i], kind.modal[MID_RATE, first + i]
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
        w1, w2, w3 = stage[MID_SPIN], stage[MID_SPIN + 1], stage[MID_SPIN + 2]
        c1, c2, c3 = cross(w1, w2, w3, u1, u2, u3)
        point = rotate(R, u1, u2, u3)
        if direction == 0:
            rate = rotate(
                R,
                stage[MID_VELOCITY] + c1 + d1,
                stage[MID_VELOCITY + 1] + c2 + d2,
                stage[MID_VELOCITY + 2] + c3 + d3,
            )
        else:
            rate = rotate(R, c1, c2, c3)
        for k in range(3):
            work.markers[number, POINT + k] = point[k] + (stage[MID_POSITION + k] if direction == 0 else 0.0)
            work.markers[number, POINT_VELOCITY + k] = rate[k]
            for j in range(3):
                jacobian[k, j] = 1.0 if (j == k and direction == 0) else 0.0
            jacobian[k, 3] = R[3 * k + 2] * u2 - R[3 * k + 1] * u3
            jacobian[k, 4] = R[3 * k] * u3 - R[3 * k + 2] * u1
            jacobian[k, 5] = R[3 * k + 1] * u1 - R[3 * k] * u2


@kernel(internal=True)
def gather_marker_forces(kind: FloatingFrameBodies, work: Workspace) -> None:
    """Generalised forces ``J^T f`` of all markers, into the stages of their bodies."""
    for body in range(kind.index.shape[0]):
        for j in range(6):
            kind.frame[body, FORCE + j] = 0.0
    for i in range(kind.modal.shape[1]):
        kind.modal[LOAD, i] = 0.0
    for marker in range(kind.markers.shape[0]):
        number, body = kind.markers[marker, 0], kind.markers[marker, 1]
        n, first = kind.index[body, MODES], kind.index[body, MODAL]
        f1, f2, f3 = (
            work.markers[number, POINT_FORCE],
            work.markers[number, POINT_FORCE + 1],
            work.markers[number, POINT_FORCE + 2],
        )
        jacobian = work.jacobian[number]
        for j in range(6):
            kind.frame[body, FORCE + j] += jacobian[0, j] * f1 + jacobian[1, j] * f2 + jacobian[2, j] * f3
        for i in range(n):
            kind.modal[LOAD, first + i] += (
                jacobian[0, 6 + i] * f1 + jacobian[1, 6 + i] * f2 + jacobian[2, 6 + i] * f3
            )


@kernel(reassociate=True)
def factor_frame(
    shape: NDArray[np.float64],
    stage: NDArray[np.float64],
    modal: NDArray[np.float64],
    K: NDArray[np.float64],
) -> None:
    """Cholesky factor of the frame block after elimination of the modes.

    Parameters
    ----------
    shape
        Packed shape.
    stage
        Row of scratch with ``S_t`` and ``I_tt``.
    modal
        Modal scratch of the body: inverse diagonal of the modal block and ``I_tf``, shape (rows, n).
    K
        Receives the factor, row by row, shape (36,).

    Notes
    -----
    ``K = M_rr - C D^-1 C^T`` with ``C = [S; I_tf]`` and diagonal D: O(36 n) instead of a dense solve.
    """
    n = modal.shape[1]
    for row in range(6):
        for column in range(row + 1):
            total = 0.0
            for i in range(n):
                left = shape[SHAPE_HEAD + row * n + i] if row < 3 else modal[TF1 + row - 3, i]
                right = shape[SHAPE_HEAD + column * n + i] if column < 3 else modal[TF1 + column - 3, i]
                total += left * right * modal[INVERSE, i]
            K[6 * row + column] = -total
    m = shape[SHAPE_MASS]
    s1, s2, s3 = stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2]
    for k in range(3):
        K[7 * k] += m
        K[7 * k + 21] += stage[INERTIA + k]
    K[19] -= s3
    K[20] += s2
    K[24] += s3
    K[26] -= s1
    K[30] -= s2
    K[31] += s1
    K[27] += stage[INERTIA + 3]
    K[33] += stage[INERTIA + 4]
    K[34] += stage[INERTIA + 5]
    cholesky_factor(K, 6)


@kernel(reassociate=True, internal=True)
def solve_stage(kind: FloatingFrameBodies, body: int, weight: float, work: Workspace) -> None:
    """Velocity of the stage from the right-hand sides, with the factor that is there.

    Parameters
    ----------
    kind, body
        The body; `FRAME_RHS`, `ROW` and `QUADRATIC` hold the right-hand sides. Of a frame that is not
        free `FRAME_RHS` holds its prescribed body-axis velocities instead.
    weight
        Time [s] by which the quadratic forces act.
    work
        Receives world velocity, body-axis spin and modal rates.
    """
    n, first, dof = kind.index[body, MODES], kind.index[body, MODAL], kind.index[body, DOF]
    stage = kind.frame[body]
    modal = kind.modal[:, first : first + n]
    shape = shape_of(kind, body)
    velocity = work.velocity[dof : dof + 6 + n]
    motion = kind.index[body, MOTION]
    if motion == FIXED:
        for k in range(6):
            velocity[k] = 0.0
        for i in range(n):
            velocity[6 + i] = modal[INVERSE, i] * modal[ROW, i]
        return
    y = velocity[:6]
    for k in range(6):
        y[k] = stage[FRAME_RHS + k]
    if motion == FREE:
        r1 = r2 = r3 = r4 = r5 = r6 = 0.0
        for i in range(n):
            t = modal[INVERSE, i] * (modal[ROW, i] + weight * modal[QUADRATIC, i])
            r1 += shape[SHAPE_HEAD + i] * t
            r2 += shape[SHAPE_HEAD + n + i] * t
            r3 += shape[SHAPE_HEAD + 2 * n + i] * t
            r4 += modal[TF1, i] * t
            r5 += modal[TF1 + 1, i] * t
            r6 += modal[TF1 + 2, i] * t
        y[0] -= r1
        y[1] -= r2
        y[2] -= r3
        y[3] -= r4
        y[4] -= r5
        y[5] -= r6
        cholesky_solve(stage[FACTOR : FACTOR + 36], y, 6)
    for i in range(n):
        coupling = (
            shape[SHAPE_HEAD + i] * y[0]
            + shape[SHAPE_HEAD + n + i] * y[1]
            + shape[SHAPE_HEAD + 2 * n + i] * y[2]
            + modal[TF1, i] * y[3]
            + modal[TF1 + 1, i] * y[4]
            + modal[TF1 + 2, i] * y[5]
        )
        velocity[6 + i] = modal[INVERSE, i] * (modal[ROW, i] + weight * modal[QUADRATIC, i] - coupling)
    v = rotate(stage_rotation(kind, body), y[0], y[1], y[2])
    for k in range(3):
        y[k] = v[k]
