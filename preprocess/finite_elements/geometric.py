"""Geometric stiffness of solids: what stress along a body does to the motion across it.

With the Cauchy stress s of a small displacement, a virtual motion u stores besides the elastic energy the work of this
stress on the second-order part of the strain of Green and Lagrange,

    U = 1/2 int s_kl (du_i/dx_k) (du_i/dx_l) dV = 1/2 u^T (S (x) 1) u,    S_IJ = int grad N_I . s grad N_J dV

so the matrix is scalar, as the mass matrix of a solid is: tension stiffens, compression softens, and
``K phi = -lambda K_g phi`` is the problem of linear buckling (O. C. Zienkiewicz and R. L. Taylor, *The Finite Element
Method*).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.elasticity import (
    DEFAULT_FORMULATION,
    NodePattern,
    ScalarMatrix,
    brick_alphas,
)
from heavylift.preprocess.finite_elements.reference_elements import (
    jacobians,
    shape_gradients,
    volume_rule,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import Material

__all__ = ["geometric_stiffness", "point_stress"]

_CHUNK = 2048  # elements at once


def geometric_stiffness(
    mesh: Mesh,
    material: Material,
    displacements: NDArray[np.float64],
    *,
    formulation: str | None = None,
    pattern: NodePattern | None = None,
) -> csr_array:
    """Scalar geometric stiffness S [N/m], sparse (n, n): that of all degrees of freedom is ``kron(S, I3)``.

    Parameters
    ----------
    mesh
        A mesh of ``hex8``, ``hex20`` or ``tet10`` elements.
    material
        Its material.
    displacements
        Small displacements that make the stress [m], shape (n, 3).
    formulation
        Of the elements, as of `assemble` in `heavylift.preprocess.finite_elements.elasticity`: bricks with incompatible
        modes have a stress of these too, those with one point the one of their centre.
    pattern
        Of the mesh, if it is there already.

    Raises
    ------
    InputError
        Displacements that do not fit the mesh or are not finite.
    """
    matrix = ScalarMatrix(pattern or NodePattern(mesh.elements, mesh.node_count))
    for start in range(0, mesh.element_count, _CHUNK):
        stress, G, weight = point_stress(mesh, material, displacements, start, formulation=formulation)
        matrix.add(start, np.einsum("eq,eqIk,eqkl,eqJl->eIJ", weight, G, stress, G, optimize=True))
    return matrix.tocsr()


def point_stress(
    mesh: Mesh,
    material: Material,
    displacements: NDArray[np.float64],
    start: int = 0,
    *,
    formulation: str | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Stress [Pa] at the quadrature points of a chunk of elements from `start`, gradients and weights there.

    Returns
    -------
    tuple
        Stress (m, nq, 3, 3), ``dN/dx`` [1/m] (m, nq, nodes per element, 3), and weights times det J [m3] (m, nq).
    """
    u = np.asarray(displacements, dtype=np.float64)
    if u.shape != (mesh.node_count, 3) or not np.isfinite(u).all():
        raise InputError(
            f"displacements of shape {u.shape}",
            source=mesh.name or "geometric stiffness",
            key="displacements",
            expected=f"finite numbers of shape ({mesh.node_count}, 3)",
        )
    kind = formulation or DEFAULT_FORMULATION[mesh.element_type]
    elements = mesh.elements[start : start + _CHUNK]
    corners, moved = mesh.nodes[elements], u[elements]
    points, weights = volume_rule(mesh.element_type)
    reference = shape_gradients(mesh.element_type, points)
    J = jacobians(corners, reference)
    weight = weights * np.linalg.det(J)
    G = np.matmul(reference, np.linalg.inv(J))
    gradient = np.matmul(moved.transpose(0, 2, 1)[:, None], G)  # du_i/dx_k
    if mesh.element_type == "hex8" and kind == "incompatible":
        modes, alphas = brick_alphas(corners, material, moved)
        gradient += np.matmul(alphas.transpose(0, 2, 1)[:, None], modes)
    elif mesh.element_type == "hex8" and kind == "reduced":
        mean = np.einsum("eq,eqik->eik", weight, gradient) / weight.sum(axis=1)[:, None, None]
        gradient = np.broadcast_to(mean[:, None], gradient.shape)
    mu = material.shear_modulus
    stress = mu * (gradient + gradient.transpose(0, 1, 3, 2))
    trace = material.lame_lambda * np.trace(gradient, axis1=2, axis2=3)
    return stress + trace[..., None, None] * np.eye(3), G, weight
