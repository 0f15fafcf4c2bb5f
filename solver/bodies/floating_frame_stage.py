"""Building blocks of a step of one floating-frame body, shared by the integrators and the record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import write_rotation_matrix
from heavylift.numerics.small import cholesky_factor, cholesky_solve, rotate, rotate_back
from heavylift.solver.bodies.floating_frame import (
    AT_Q,
    AT_RATE,
    DOF,
    FACTOR,
    FIRST_MOMENT,
    FRAME_RHS,
    INERTIA,
    INVERSE,
    MID_POSITION,
    MID_Q,
    MID_RATE,
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
    S1,
    SHAPE_HEAD,
    SHAPE_MASS,
    SPIN,
    TF1,
    VELOCITY,
    FloatingFrameBodies,
    Q,
)
from heavylift.solver.bodies.floating_frame_inertia import deformed_inertia, stacked_products
from heavylift.solver.bodies.floating_frame_markers import write_markers
from heavylift.solver.bodies.floating_frame_shape import product_columns, shape_of, stage_rotation
from heavylift.solver.drive import FREE
from heavylift.solver.interface import (
    Workspace,
    fill_markers,
)
from heavylift.solver.kinds import implement

__all__ = [
    "clear_velocity",
    "factor_frame",
    "fill_floating_frame_markers",
    "solve_stage",
    "stage_at_state",
    "update_products",
]


@kernel(internal=True)
def update_products(kind: FloatingFrameBodies, body: int) -> None:
    """Stacked matrices times the carried modal coordinates and rates."""
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
    rows = slice(8 * first, 8 * (first + n))
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
    n, first = kind.table[body, MODES], kind.table[body, MODAL]
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
            kind.products[AT_Q, 8 * first : 8 * (first + n)],
            stage,
            kind.modal[TF1:, modes],
        )


@implement(fill_markers, FloatingFrameBodies)
@kernel(internal=True)
def fill_floating_frame_markers(
    kind: FloatingFrameBodies, at_midpoint: bool, level: int, work: Workspace
) -> None:
    """Markers at the midpoint, which `predict` has set, or at the carried state."""
    if kind.markers.shape[0] > 0:
        if not at_midpoint:
            for body in range(kind.table.shape[0]):
                stage_at_state(kind, body, False)
        write_markers(kind, level, work)


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
    ``K = M_rr - C D^-1 C^T`` with ``C = [S; I_tf]`` and diagonal D: O(21 n) instead of a dense solve.
    """
    k00 = k10 = k11 = k20 = k21 = k22 = k30 = k31 = k32 = k33 = 0.0
    k40 = k41 = k42 = k43 = k44 = k50 = k51 = k52 = k53 = k54 = k55 = 0.0
    for i in range(modal.shape[1]):  # all 21 sums in registers, one pass over the couplings
        w = -modal[INVERSE, i]
        c0, c1, c2 = modal[S1, i], modal[S1 + 1, i], modal[S1 + 2, i]
        c3, c4, c5 = modal[TF1, i], modal[TF1 + 1, i], modal[TF1 + 2, i]
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
    m = shape[SHAPE_MASS]
    s1, s2, s3 = stage[FIRST_MOMENT], stage[FIRST_MOMENT + 1], stage[FIRST_MOMENT + 2]
    K[0], K[7], K[14] = m + k00, m + k11, m + k22
    K[6], K[12], K[13] = k10, k20, k21
    K[18], K[19], K[20] = k30, k31 - s3, k32 + s2
    K[24], K[25], K[26] = k40 + s3, k41, k42 - s1
    K[30], K[31], K[32] = k50 - s2, k51 + s1, k52
    K[21], K[28], K[35] = stage[INERTIA] + k33, stage[INERTIA + 1] + k44, stage[INERTIA + 2] + k55
    K[27], K[33], K[34] = stage[INERTIA + 3] + k43, stage[INERTIA + 4] + k53, stage[INERTIA + 5] + k54
    cholesky_factor(K, 6)


@kernel(internal=True)
def clear_velocity(kind: FloatingFrameBodies, body: int, work: Workspace) -> None:
    """Begin the velocity of the stage of a body with zeros."""
    dof = kind.table[body, DOF]
    for i in range(dof, dof + 6 + kind.table[body, MODES]):
        work.velocity[i] = 0.0


@kernel(reassociate=True, internal=True)
def solve_stage(kind: FloatingFrameBodies, body: int, weight: float, work: Workspace) -> None:
    """Add the solution for the right-hand sides to the velocity of the stage, with the factor that is there.

    Parameters
    ----------
    kind, body
        The body; `FRAME_RHS`, which is used up, `ROW` and `QUADRATIC` hold the right-hand sides. Of a frame that
        is not free `FRAME_RHS` holds its prescribed body-axis velocities instead.
    weight
        Time [s] by which the quadratic forces act.
    work
        World velocity, body-axis spin and modal rates grow.
    """
    n, first, dof = kind.table[body, MODES], kind.table[body, MODAL], kind.table[body, DOF]
    stage = kind.frame[body]
    modal = kind.modal[:, first : first + n]
    shape = shape_of(kind, body)
    velocity = work.velocity[dof : dof + 6 + n]
    motion = kind.table[body, MOTION]
    y = stage[FRAME_RHS : FRAME_RHS + 6]
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
        velocity[6 + i] += modal[INVERSE, i] * (modal[ROW, i] + weight * modal[QUADRATIC, i] - coupling)
    v = rotate(stage_rotation(kind, body), y[0], y[1], y[2])
    for k in range(3):
        velocity[k] += v[k]
        velocity[3 + k] += y[3 + k]
