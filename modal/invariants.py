"""Inertia shape integrals of a floating-frame body, as bilinear forms in the scalar mass matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import sparray, spmatrix

__all__ = ["ShapeIntegrals", "shape_integrals"]

_BLOCK_MODES = 16  # modes multiplied by the mass matrix at once: bounds the memory, keeps BLAS busy
_BLOCK_NODES = 8192


class ShapeIntegrals(NamedTuple):
    """Constants from which the mass matrix and all velocity forces of a flexible body are made.

    With ``M_s`` the scalar mass matrix (n, n), ``x_k`` the k-th coordinates of the undeformed
    nodes and ``Phi_k`` the k-th components of the shapes, both in the body frame:

    Attributes
    ----------
    mass
        ``1^T M_s 1`` [kg].
    first_moment
        ``1^T M_s x_k`` [kg m], shape (3,).
    modal_translation
        ``S_k = 1^T M_s Phi_k`` [kg^1/2], shape (3, nf).
    inertia_kl
        ``I_kl = x_k^T M_s x_l`` [kg m2], shape (3, 3): second moments, not the inertia tensor.
    position_mode
        ``Ibar_kl = x_k^T M_s Phi_l`` [kg^1/2 m], shape (3, 3, nf), element ``[k, l, :]``.
    mode_mode
        ``S_kl = Phi_k^T M_s Phi_l`` [1], shape (3, 3, nf, nf), element ``[k, l, :, :]``.
    """

    mass: float
    first_moment: NDArray[np.float64]
    modal_translation: NDArray[np.float64]
    inertia_kl: NDArray[np.float64]
    position_mode: NDArray[np.float64]
    mode_mode: NDArray[np.float64]


def shape_integrals(
    nodes: NDArray[np.float64],
    mode_shapes: NDArray[np.float64],
    mass: sparray | spmatrix,
) -> ShapeIntegrals:
    """Evaluate all shape integrals of a body, for a consistent or a lumped mass matrix.

    Parameters
    ----------
    nodes
        Undeformed nodes in the body frame [m], shape (n, 3).
    mode_shapes
        Shapes in the body frame, mass-normalised [kg^-1/2], shape (nf, n, 3); ``nf = 0`` is a rigid body.
    mass
        Scalar mass matrix [kg], sparse (n, n); the mass matrix of all 3n degrees of freedom is
        ``kron(mass, I3)``. Diagonal when lumped.

    Returns
    -------
    ShapeIntegrals
        Exact for isoparametric elements: then positions, like displacements, are combinations of
        the shape functions from which ``mass`` was integrated.

    Raises
    ------
    InputError
        If the shapes of the arrays do not fit.

    Notes
    -----
    With the position field as one more "shape" all second-order integrals are blocks of a single
    Gram matrix. It costs O(nf^2 n) and needs, besides its arguments and itself, only a block of 16
    shapes and of 8192 nodes. Definitions: "Deformable bodies ... sliding contacts" (2014),
    eqs. 2.58-2.68, written with the scalar mass matrix instead of sums over lumped nodes.
    """
    nodes = np.asarray(nodes, dtype=np.float64)
    shapes = np.asarray(mode_shapes, dtype=np.float64)
    count, n = shapes.shape[0], nodes.shape[0]
    if nodes.shape != (n, 3) or shapes.shape != (count, n, 3) or mass.shape != (n, n):
        raise InputError(
            f"nodes {nodes.shape}, mode shapes {shapes.shape} and mass {mass.shape} do not fit",
            source="shape integrals",
            expected="shapes (n, 3), (nf, n, 3) and (n, n)",
        )
    row_sum = np.asarray(mass.sum(axis=0), dtype=np.float64).ravel()  # 1^T M_s
    gram = _gram(nodes, shapes, mass).reshape(count + 1, 3, count + 1, 3).transpose(1, 3, 0, 2)
    return ShapeIntegrals(
        mass=float(row_sum.sum()),
        first_moment=row_sum @ nodes,
        modal_translation=np.ascontiguousarray(np.einsum("j,ijk->ki", row_sum, shapes)),
        inertia_kl=np.ascontiguousarray(gram[:, :, 0, 0]),
        position_mode=np.ascontiguousarray(gram[:, :, 0, 1:]),
        mode_mode=np.ascontiguousarray(gram[:, :, 1:, 1:]),
    )


def _gram(
    nodes: NDArray[np.float64], shapes: NDArray[np.float64], mass: sparray | spmatrix
) -> NDArray[np.float64]:
    """Gram matrix of the components of (positions, shape 1, shape 2, ...), (3 (nf+1), 3 (nf+1))."""
    fields = [nodes, *shapes]
    size, n = len(fields), nodes.shape[0]
    gram = np.zeros((3 * size, 3 * size))
    for first in range(0, size, _BLOCK_MODES):
        block = np.concatenate(fields[first : first + _BLOCK_MODES], axis=1)  # (n, 3 block)
        inertial = mass @ block
        columns = slice(3 * first, 3 * first + block.shape[1])
        for start in range(0, n, _BLOCK_NODES):
            rows = slice(start, start + _BLOCK_NODES)
            # the Gram matrix is symmetric: only fields from this block on
            left = np.concatenate([field[rows] for field in fields[first:]], axis=1)
            gram[3 * first :, columns] += left.T @ inertial[rows]
    lower = np.tril(gram)
    return lower + np.tril(gram, -1).T
