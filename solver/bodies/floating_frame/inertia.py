"""Mass matrix and velocity forces of one deformed floating-frame body, in body axes.

Notation of "Deformable bodies ... sliding contacts" (2014), chapter 2, frame velocities in body
axes: with ``S_t = I1 + S q`` the mass matrix of ``(v, w, qd)`` is::

    [ m I    -S_t~    S    ]
    [ S_t~    I_tt    I_tf ]
    [ S^T     I_tf^T  1    ]

Unit modal mass means ``S_11 + S_22 + S_33 = 1``, so products with ``H_33 = S_33`` need no matrix.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.small import solve_symmetric_3
from heavylift.numerics.vectors import Vector, add, add_scaled, cross, dot, scaled, vector
from heavylift.solver.bodies.floating_frame.kind import FloatingFrame

__all__ = [
    "antisymmetric_products",
    "body_momenta",
    "deformed_inertia",
    "frame_velocity_forces",
    "frame_velocity_from_momenta",
    "leading_products",
    "quadratic_modal_force",
    "stacked_products",
]


@kernel
def stacked_products(
    columns: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    out_x: NDArray[np.float64],
    out_y: NDArray[np.float64],
) -> None:
    """Multiply the stacked matrices with two vectors in one pass over the memory.

    Parameters
    ----------
    columns
        ``T[j, r]`` with r running fastest, shape (n 8 n,).
    x, y
        Shape (n,).
    out_x, out_y
        ``sum_j T[j, r] x_j`` and the same for y, shape (8 n,).
    """
    n = x.shape[0]
    rows = 8 * n
    for r in range(rows):
        out_x[r] = 0.0
        out_y[r] = 0.0
    paired = n - n % 4
    for j in range(0, paired, 4):  # four columns at a time: one load and store of the sums serves four
        x0, x1, x2, x3 = x[j], x[j + 1], x[j + 2], x[j + 3]
        y0, y1, y2, y3 = y[j], y[j + 1], y[j + 2], y[j + 3]
        c0, c1 = columns[j * rows : (j + 1) * rows], columns[(j + 1) * rows : (j + 2) * rows]
        c2, c3 = columns[(j + 2) * rows : (j + 3) * rows], columns[(j + 3) * rows : (j + 4) * rows]
        for r in range(rows):
            t0, t1, t2, t3 = c0[r], c1[r], c2[r], c3[r]
            out_x[r] += x0 * t0 + x1 * t1 + x2 * t2 + x3 * t3
            out_y[r] += y0 * t0 + y1 * t1 + y2 * t2 + y3 * t3
    for j in range(paired, n):
        for r in range(rows):
            out_x[r] += x[j] * columns[j * rows + r]
            out_y[r] += y[j] * columns[j * rows + r]


@kernel
def leading_products(
    columns: NDArray[np.float64], x: NDArray[np.float64], rows: int, out: NDArray[np.float64]
) -> None:
    """Multiply the first rows of the stack with one vector."""
    n = x.shape[0]
    stride = 8 * n
    for r in range(rows):
        out[r] = 0.0
    paired = n - n % 4
    for j in range(0, paired, 4):
        x0, x1, x2, x3 = x[j], x[j + 1], x[j + 2], x[j + 3]
        c0, c1 = columns[j * stride : j * stride + rows], columns[(j + 1) * stride : (j + 1) * stride + rows]
        c2 = columns[(j + 2) * stride : (j + 2) * stride + rows]
        c3 = columns[(j + 3) * stride : (j + 3) * stride + rows]
        for r in range(rows):
            out[r] += x0 * c0[r] + x1 * c1[r] + x2 * c2[r] + x3 * c3[r]
    for j in range(paired, n):
        for r in range(rows):
            out[r] += x[j] * columns[j * stride + r]


@kernel
def antisymmetric_products(
    columns: NDArray[np.float64], x: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """Multiply the three antisymmetric matrices, the first 3 n rows of the stack, with one vector."""
    leading_products(columns, x, 3 * x.shape[0], out)


@kernel(reassociate=True)
def deformed_inertia(
    shape: NDArray[np.float64],
    q: NDArray[np.float64],
    products: NDArray[np.float64],
    frame: FloatingFrame,
    I_tf: NDArray[np.float64],
) -> None:
    """First moment ``S_t``, inertia ``I_tt`` and coupling ``I_tf`` of the deformed body.

    Parameters
    ----------
    shape
        Packed shape (`pack_shape`).
    q
        Modal coordinates, shape (n,).
    products
        Stacked matrices times q, shape (8 n,).
    frame
        Receives ``S_t`` and ``I_tt``.
    I_tf
        Receives the coupling, shape (3, n).
    """
    n = q.shape[0]
    antisymmetric = 3 * n
    symmetric = antisymmetric + 3 * n
    for k in range(3):
        total = frame.undeformed_first_moment[k]
        for i in range(n):
            total += shape[k * n + i] * q[i]
            I_tf[k, i] = shape[antisymmetric + k * n + i] - products[k * n + i]
        frame.first_moment[k] = total
    second = frame.undeformed_second_moments
    u11, u22, u33, u12, u13, u23 = second[0], second[1], second[2], second[3], second[4], second[5]
    for i in range(n):
        u11 += q[i] * (2.0 * shape[symmetric + i] + products[3 * n + i])
        u22 += q[i] * (2.0 * shape[symmetric + n + i] + products[4 * n + i])
        H33 = q[i] - products[3 * n + i] - products[4 * n + i]
        u33 += q[i] * (2.0 * shape[symmetric + 2 * n + i] + H33)
        u12 += q[i] * (shape[symmetric + 3 * n + i] + 0.5 * products[5 * n + i])
        u13 += q[i] * (shape[symmetric + 4 * n + i] + 0.5 * products[6 * n + i])
        u23 += q[i] * (shape[symmetric + 5 * n + i] + 0.5 * products[7 * n + i])
    frame.inertia[0] = u22 + u33
    frame.inertia[1] = u11 + u33
    frame.inertia[2] = u11 + u22
    frame.inertia[3] = -u12
    frame.inertia[4] = -u13
    frame.inertia[5] = -u23


@kernel
def quadratic_modal_force(
    shape: NDArray[np.float64],
    q: NDArray[np.float64],
    products: NDArray[np.float64],
    rate_products: NDArray[np.float64],
    w: Vector,
    out: NDArray[np.float64],
) -> None:
    """Centrifugal and Coriolis part of the modal row, ``1/2 d(w I_tt w)/dq + 2 w_k A_k qd``, shape (n,).

    Parameters
    ----------
    shape
        Packed shape.
    q
        Modal coordinates, shape (n,).
    products
        Stacked matrices times q, shape (8 n,).
    rate_products
        Antisymmetric matrices times the modal rates, shape (3 n,) at least.
    w
        Angular velocity, body axes [rad/s].
    """
    n = out.shape[0]
    w1, w2, w3 = w
    symmetric = 6 * n
    c11, c22, c33 = w2 * w2 + w3 * w3, w1 * w1 + w3 * w3, w1 * w1 + w2 * w2
    c12, c13, c23 = w1 * w2, w1 * w3, w2 * w3
    for i in range(n):
        out[i] = (
            c11 * (shape[symmetric + i] + products[3 * n + i])
            + c22 * (shape[symmetric + n + i] + products[4 * n + i])
            + c33 * (shape[symmetric + 2 * n + i] + q[i] - products[3 * n + i] - products[4 * n + i])
            - c12 * (shape[symmetric + 3 * n + i] + products[5 * n + i])
            - c13 * (shape[symmetric + 4 * n + i] + products[6 * n + i])
            - c23 * (shape[symmetric + 5 * n + i] + products[7 * n + i])
            + 2.0 * (w1 * rate_products[i] + w2 * rate_products[n + i] + w3 * rate_products[2 * n + i])
        )


@kernel(reassociate=True)
def frame_velocity_forces(
    shape: NDArray[np.float64],
    q: NDArray[np.float64],
    products: NDArray[np.float64],
    frame: FloatingFrame,
    w: Vector,
    qd: NDArray[np.float64],
) -> tuple[Vector, Vector]:
    """Velocity forces of the frame rows: resultant and moment about the frame origin, body axes.

    Notes
    -----
    ``h_R = -( w x (w x S_t) + 2 w x S qd )`` and ``h_w = -w x I_tt w - 2 (w tr U - U^T w)`` with
    ``U_kl = Ibar_kl qd + q^T S_kl qd``, of which only symmetric and antisymmetric parts are stored:
    ``U_kl = (sym_kl + anti_kl)/2``, the antisymmetric part being ``-I_tf qd`` up to order.
    """
    n = qd.shape[0]
    antisymmetric = 3 * n
    symmetric = antisymmetric + 3 * n
    s1 = s2 = s3 = 0.0
    u11 = u22 = u33 = 0.0
    y12 = y13 = y23 = 0.0  # symmetric sums U_12 + U_21 ...
    a1 = a2 = a3 = 0.0  # differences U_23 - U_32, U_31 - U_13, U_12 - U_21
    for i in range(n):
        s1 += shape[i] * qd[i]
        s2 += shape[n + i] * qd[i]
        s3 += shape[2 * n + i] * qd[i]
        u11 += (shape[symmetric + i] + products[3 * n + i]) * qd[i]
        u22 += (shape[symmetric + n + i] + products[4 * n + i]) * qd[i]
        H33 = q[i] - products[3 * n + i] - products[4 * n + i]
        u33 += (shape[symmetric + 2 * n + i] + H33) * qd[i]
        y12 += (shape[symmetric + 3 * n + i] + products[5 * n + i]) * qd[i]
        y13 += (shape[symmetric + 4 * n + i] + products[6 * n + i]) * qd[i]
        y23 += (shape[symmetric + 5 * n + i] + products[7 * n + i]) * qd[i]
        # q^T A_k qd = -(A_k q) . qd
        a1 += (shape[antisymmetric + i] - products[i]) * qd[i]
        a2 += (shape[antisymmetric + n + i] - products[n + i]) * qd[i]
        a3 += (shape[antisymmetric + 2 * n + i] - products[2 * n + i]) * qd[i]
    w1, w2, w3 = w
    f = cross(w, add_scaled(cross(w, frame.first_moment), 2.0, (s1, s2, s3)))
    g = cross(w, inertia_product(frame, w))
    trace = u11 + u22 + u33
    u12, u21 = 0.5 * (y12 + a3), 0.5 * (y12 - a3)
    u31, u13 = 0.5 * (y13 + a2), 0.5 * (y13 - a2)
    u23, u32 = 0.5 * (y23 + a1), 0.5 * (y23 - a1)
    m1 = -g[0] - 2.0 * (w1 * trace - (u11 * w1 + u21 * w2 + u31 * w3))
    m2 = -g[1] - 2.0 * (w2 * trace - (u12 * w1 + u22 * w2 + u32 * w3))
    m3 = -g[2] - 2.0 * (w3 * trace - (u13 * w1 + u23 * w2 + u33 * w3))
    return (-f[0], -f[1], -f[2]), (m1, m2, m3)


@kernel(inline=True)
def inertia_product(frame: FloatingFrame, w: Vector) -> Vector:
    """``I_tt w``, body axes."""
    I = frame.inertia
    return dot((I[0], I[3], I[4]), w), dot((I[3], I[1], I[5]), w), dot((I[4], I[5], I[2]), w)


@kernel(reassociate=True)
def body_momenta(
    shape: NDArray[np.float64],
    frame: FloatingFrame,
    I_tf: NDArray[np.float64],
    v: Vector,
    w: Vector,
    qd: NDArray[np.float64],
) -> tuple[Vector, Vector]:
    """Linear and angular momentum about the frame origin in body axes, from body-axis velocities."""
    n = qd.shape[0]
    p1 = p2 = p3 = 0.0
    l1 = l2 = l3 = 0.0
    for i in range(n):
        p1 += shape[i] * qd[i]
        p2 += shape[n + i] * qd[i]
        p3 += shape[2 * n + i] * qd[i]
        l1 += I_tf[0, i] * qd[i]
        l2 += I_tf[1, i] * qd[i]
        l3 += I_tf[2, i] * qd[i]
    m = frame.mass
    s = vector(frame.first_moment)
    return (
        add(add(scaled(m, v), cross(w, s)), (p1, p2, p3)),
        add(add(cross(s, v), inertia_product(frame, w)), (l1, l2, l3)),
    )


@kernel(reassociate=True)
def frame_velocity_from_momenta(
    shape: NDArray[np.float64],
    frame: FloatingFrame,
    I_tf: NDArray[np.float64],
    p: Vector,
    l: Vector,
    qd: NDArray[np.float64],
) -> tuple[Vector, Vector]:
    """Frame velocities, body axes, that carry given momenta while the modes move with rates ``qd``.

    Notes
    -----
    Translation is eliminated, which leaves the 3x3 system of the inertia about the centre of mass
    of the deformed body.
    """
    n = qd.shape[0]
    p1, p2, p3 = p
    l1, l2, l3 = l
    for i in range(n):
        p1 -= shape[i] * qd[i]
        p2 -= shape[n + i] * qd[i]
        p3 -= shape[2 * n + i] * qd[i]
        l1 -= I_tf[0, i] * qd[i]
        l2 -= I_tf[1, i] * qd[i]
        l3 -= I_tf[2, i] * qd[i]
    inverse_mass = 1.0 / frame.mass
    s1, s2, s3 = s = vector(frame.first_moment)
    a = cross(s, (p1, p2, p3))
    w = solve_symmetric_3(
        frame.inertia[0] - (s2 * s2 + s3 * s3) * inverse_mass,
        frame.inertia[1] - (s1 * s1 + s3 * s3) * inverse_mass,
        frame.inertia[2] - (s1 * s1 + s2 * s2) * inverse_mass,
        frame.inertia[3] + s1 * s2 * inverse_mass,
        frame.inertia[4] + s1 * s3 * inverse_mass,
        frame.inertia[5] + s2 * s3 * inverse_mass,
        l1 - a[0] * inverse_mass,
        l2 - a[1] * inverse_mass,
        l3 - a[2] * inverse_mass,
    )
    return scaled(inverse_mass, add((p1, p2, p3), cross(s, w))), w
