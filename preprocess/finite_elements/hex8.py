"""Stiffness of 8-node bricks: with incompatible modes, and with one point and hourglass stiffness."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.reference_elements import (
    REFERENCE_NODES,
    jacobians,
    shape_gradients,
    volume_rule,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.finite_elements.model import Material

__all__ = ["HOURGLASS_COEFFICIENT", "HOURGLASS_VECTORS", "brick_stiffness"]

HOURGLASS_COEFFICIENT = 5.8925e-4
"""kappa of the hourglass stiffness, identified from the published matrix of the complex beam."""

_SIGNS = REFERENCE_NODES["hex8"]
HOURGLASS_VECTORS: NDArray[np.float64] = np.array(
    [
        _SIGNS[:, 1] * _SIGNS[:, 2],
        _SIGNS[:, 2] * _SIGNS[:, 0],
        _SIGNS[:, 0] * _SIGNS[:, 1],
        _SIGNS[:, 0] * _SIGNS[:, 1] * _SIGNS[:, 2],
    ]
)
"""The four +-1 vectors of a brick that are orthogonal to constant and linear fields, shape (4, 8)."""


def brick_stiffness(
    corners: NDArray[np.float64], material: Material, *, formulation: str
) -> NDArray[np.float64]:
    """Return the stiffness matrices of many 8-node bricks.

    Parameters
    ----------
    corners
        Node positions [m], shape (ne, 8, 3).
    material
        Linear, isotropic material.
    formulation
        ``"incompatible"`` or ``"reduced"``.

    Returns
    -------
    NDArray
        Shape (ne, 24, 24) [N/m], node-major.

    Raises
    ------
    InputError
        An inverted brick.

    Notes
    -----
    *Incompatible modes* (Wilson et al. 1973; Taylor, Beresford, Wilson, *Int. J. Numer. Meth. Engng* 10
    (1976) 1211): the displacement is enriched by (1 - xi_k^2) alpha_k, k = 1..3, nine parameters, condensed
    statically. Their gradients are taken as (det J0 / det J) J0^-T d(1 - xi_k^2)/dxi with J0 at the centre,
    so that they integrate to zero and the patch test holds on distorted bricks.

    *Reduced*: with the mean gradients b_I = (1/V) int grad N_I dV (Flanagan, Belytschko, *Int. J. Numer.
    Meth. Engng* 17 (1981) 679), which are the gradients at the centre for a parallelepiped,

        K_e = V B^T D B + kappa G V sum_{a=1..4} gamma_a gamma_a^T (x) T,    T = 2 sum_I b_I b_I^T,
        gamma_a = Gamma_a - sum_j (Gamma_a . x_j) b_j,

    Gamma_a being the +-1 vectors. For a rectangular brick gamma_a = Gamma_a and T = diag(1/h_d^2), h_d the
    edge in direction d: the published element. T is the form of 1/h_d^2 that turns with the brick (it is
    J^-T J^-1 / 4 for any parallelepiped), and gamma_a is blind to linear fields, so distorted bricks pass
    the patch test.
    """
    chosen = {"incompatible": _incompatible, "reduced": _reduced}
    if formulation not in chosen:
        raise InputError(
            f"{formulation!r} is not a formulation of bricks",
            key="formulation",
            expected="one of " + ", ".join(repr(name) for name in chosen),
        )
    points, weights = volume_rule("hex8")
    gradients = shape_gradients("hex8", points)
    J = jacobians(corners, gradients)
    detJ = np.linalg.det(J)
    wrong = np.flatnonzero((detJ <= 0.0).any(axis=1))
    if wrong.size:
        centre = corners[wrong[0]].mean(axis=0)
        raise InputError(
            "the Jacobian determinant is not positive",
            source="brick",
            key=f"at ({centre[0]:.6g}, {centre[1]:.6g}, {centre[2]:.6g}) m",
            expected="an element that is not inverted, nodes in the order of VTK",
        )
    G = np.matmul(gradients, np.linalg.inv(J))  # dN/dx at the points, (ne, 8, 8, 3)
    return chosen[formulation](corners, material, G, weights * detJ)


def _strain_operator(gradients: NDArray[np.float64]) -> NDArray[np.float64]:
    """B (..., 6, 3 m) from gradients (..., m, 3); strains xx, yy, zz, xy, yz, zx (engineering shear)."""
    *lead, m, _ = gradients.shape
    B = np.zeros((*lead, 6, m, 3))
    x, y, z = (gradients[..., k] for k in range(3))
    B[..., 0, :, 0], B[..., 1, :, 1], B[..., 2, :, 2] = x, y, z
    B[..., 3, :, 0], B[..., 3, :, 1] = y, x
    B[..., 4, :, 1], B[..., 4, :, 2] = z, y
    B[..., 5, :, 0], B[..., 5, :, 2] = z, x
    return B.reshape(*lead, 6, 3 * m)


def _incompatible(
    corners: NDArray[np.float64],
    material: Material,
    G: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> NDArray[np.float64]:
    points, weights = volume_rule("hex8")
    J0 = jacobians(corners, shape_gradients("hex8", np.zeros((1, 3))))[:, 0]
    # dxi_k/dx_j at the centre; row k times -2 xi_k is the gradient of mode k
    inverse = np.linalg.inv(J0)
    scale = np.linalg.det(J0)[:, None] * weights / weight  # det J0 / det J, (ne, nq)
    modes = -2.0 * points[None, :, :, None] * inverse[:, None] * scale[:, :, None, None]  # (ne, nq, 3, 3)
    # all 24 + 9 columns at once, points stacked under each other
    B = _strain_operator(np.concatenate([G, modes], axis=2))
    ne, nq, _, columns = B.shape
    DB = np.matmul(material.elasticity_matrix(), B) * weight[:, :, None, None]
    K = np.matmul(B.reshape(ne, nq * 6, columns).transpose(0, 2, 1), DB.reshape(ne, nq * 6, columns))
    Kuu, Kua, Kaa = K[:, :24, :24], K[:, :24, 24:], K[:, 24:, 24:]
    K = Kuu - np.matmul(Kua, np.linalg.solve(Kaa, Kua.transpose(0, 2, 1)))
    return 0.5 * (K + K.transpose(0, 2, 1))


def _reduced(
    corners: NDArray[np.float64],
    material: Material,
    G: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> NDArray[np.float64]:
    V = weight.sum(axis=1)
    b = np.einsum("eq,eqIj->eIj", weight, G) / V[:, None, None]  # mean gradients, (ne, 8, 3)
    B = _strain_operator(b)
    DB = np.matmul(material.elasticity_matrix(), B) * V[:, None, None]
    K = np.matmul(B.transpose(0, 2, 1), DB)

    moments = np.matmul(HOURGLASS_VECTORS, corners)  # Gamma_a . x_j, (ne, 4, 3)
    gamma = HOURGLASS_VECTORS - np.matmul(moments, b.transpose(0, 2, 1))  # (ne, 4, 8)
    T = 2.0 * np.matmul(b.transpose(0, 2, 1), b)
    factor = HOURGLASS_COEFFICIENT * material.shear_modulus * V
    hourglass = np.matmul(gamma.transpose(0, 2, 1), gamma) * factor[:, None, None]
    K += (hourglass[:, :, None, :, None] * T[:, None, :, None, :]).reshape(K.shape)
    return 0.5 * (K + K.transpose(0, 2, 1))
