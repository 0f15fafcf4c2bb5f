"""Stress recovery at nodes: from displacements to Cauchy stress and von Mises stress."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.reference_elements import (
    REFERENCE_NODES,
    jacobians,
    shape_gradients,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import Material

__all__ = ["VOIGT", "nodal_gradients", "stress_component", "stress_modes", "von_mises"]

VOIGT = ("xx", "yy", "zz", "xy", "yz", "zx")
"""Order of the six stress components."""

_CHUNK = 4096  # elements handled at once
_FLAT = 1e-6  # a direction in which the centres of a patch spread less has no gradient


def stress_modes(mesh: Mesh, material: Material, shapes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nodal stresses per unit modal coordinate.

    Parameters
    ----------
    mesh
        Mesh of the undeformed body.
    material
        Its material.
    shapes
        Mode shapes [kg^-1/2] (or displacements [m], which gives stresses in Pa), shape (nf, n, 3).

    Returns
    -------
    NDArray
        Stress [Pa per unit modal coordinate], shape (nf, n, 6), order `VOIGT`. The stress of a state q
        is the sum over q_i times the i-th row: small strains in the body frame.

    Raises
    ------
    InputError
        Shapes that do not fit the mesh.
    """
    shapes = np.asarray(shapes, dtype=np.float64)
    if shapes.ndim != 3 or shapes.shape[1:] != (mesh.node_count, 3):
        raise InputError(
            f"shapes {shapes.shape}",
            source=mesh.name or "stress",
            expected=f"shape (nf, {mesh.node_count}, 3)",
        )
    gradients = nodal_gradients(mesh)
    D = material.elasticity_matrix()
    stress = np.empty((len(shapes), mesh.node_count, 6))
    for mode, displacement in enumerate(shapes):
        # H[j] holds du_i/dx_j in column i
        H = [gradient @ displacement for gradient in gradients]
        strain = np.column_stack(
            [
                H[0][:, 0],
                H[1][:, 1],
                H[2][:, 2],
                H[1][:, 0] + H[0][:, 1],
                H[2][:, 1] + H[1][:, 2],
                H[0][:, 2] + H[2][:, 0],
            ]
        )
        stress[mode] = strain @ D
    return stress


def von_mises(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Von Mises equivalent stress [Pa] of stresses (..., 6) in the order `VOIGT`; shape (...)."""
    xx, yy, zz, xy, yz, zx = np.moveaxis(np.asarray(stress, dtype=np.float64), -1, 0)
    deviatoric = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    return np.sqrt(deviatoric + 3.0 * (xy**2 + yz**2 + zx**2))


def stress_component(stress: NDArray[np.float64], component: str) -> NDArray[np.float64]:
    """One of `VOIGT`, or ``"von_mises"``, of stresses (..., 6); shape (...)."""
    return von_mises(stress) if component == "von_mises" else stress[..., VOIGT.index(component)]


def nodal_gradients(mesh: Mesh) -> tuple[csr_array, csr_array, csr_array]:
    """Sparse operators that take nodal values to averaged nodal derivatives d/dx, d/dy, d/dz [1/m].

    Returns
    -------
    tuple
        Three matrices (n, n). Exact for linear fields; for quadratic ones too with quadratic elements, and inside
        regular meshes of ``hex8``.

    Notes
    -----
    Quadratic elements: derivatives of the shape functions at all nodes of each element, averaged over the
    elements at a node with their volumes as weights. 8-node bricks: their derivatives are accurate at
    the centre only (Barlow, IJNME 10, 1976; elsewhere bending shows up as shear), so a linear
    polynomial is fitted to the centres around each node: superconvergent patch recovery, Zienkiewicz and
    Zhu, IJNME 33 (1992).
    """
    if mesh.element_type != "hex8":
        return _averaged(mesh)
    weights = _patch_weights(mesh)
    return tuple(weights @ centre for centre in _centre_gradients(mesh))


def _averaged(mesh: Mesh) -> tuple[csr_array, csr_array, csr_array]:
    """Volume-weighted averages of the derivatives at the nodes of each element."""
    from scipy.sparse import coo_array, csr_array, diags_array

    n = mesh.node_count
    volumes = mesh.element_volumes()
    total = np.bincount(mesh.elements.ravel(), np.repeat(volumes, mesh.elements.shape[1]), minlength=n)
    sums = [csr_array((n, n)) for _ in range(3)]
    for start in range(0, mesh.element_count, _CHUNK):
        elements = mesh.elements[start : start + _CHUNK]
        dN = _physical_gradients(mesh, start, REFERENCE_NODES[mesh.element_type])
        dN *= volumes[start : start + _CHUNK, None, None, None]
        width = elements.shape[1]
        rows = np.repeat(elements, width, axis=1).ravel()
        columns = np.tile(elements, (1, width)).ravel()
        for k in range(3):
            sums[k] = sums[k] + coo_array((dN[..., k].ravel(), (rows, columns)), shape=(n, n)).tocsr()
    scale = diags_array(1.0 / np.where(total > 0.0, total, 1.0))
    return tuple(csr_array(scale @ part) for part in sums)


def _centre_gradients(mesh: Mesh) -> list[csr_array]:
    """Derivatives at the centres of the elements, three sparse matrices (ne, n)."""
    from scipy.sparse import csr_array

    width = mesh.elements.shape[1]
    centre = REFERENCE_NODES[mesh.element_type].mean(axis=0, keepdims=True)
    dN = np.concatenate(
        [_physical_gradients(mesh, start, centre)[:, 0] for start in range(0, mesh.element_count, _CHUNK)]
    )
    starts = np.arange(0, mesh.elements.size + 1, width)
    shape = (mesh.element_count, mesh.node_count)
    return [csr_array((dN[..., k].ravel(), mesh.elements.ravel(), starts), shape=shape) for k in range(3)]


def _physical_gradients(mesh: Mesh, start: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """dN/dx of a chunk of elements at reference points, shape (chunk, points, nodes per element, 3)."""
    reference = shape_gradients(mesh.element_type, points)
    J = jacobians(mesh.nodes[mesh.elements[start : start + _CHUNK]], reference)
    return np.matmul(reference, np.linalg.inv(J))


def _patch_weights(mesh: Mesh) -> csr_array:
    """Values at element centres to values at nodes, by a linear fit over a patch; sparse (n, ne).

    The patch is the elements at the node; for nodes on the surface, where these do not determine a
    polynomial, it is enlarged by their neighbours. A direction with one layer of elements stays constant.
    """
    from scipy.sparse import csr_array

    n, ne, width = mesh.node_count, mesh.element_count, mesh.elements.shape[1]
    touches = csr_array(
        (np.ones(mesh.elements.size), mesh.elements.ravel(), np.arange(0, mesh.elements.size + 1, width)),
        shape=(ne, n),
    )
    own = csr_array(touches.T)
    inner = np.diff(own.indptr) >= width  # a brick mesh has eight elements at an inner node
    wide = csr_array(own @ (touches @ own))
    centres = mesh.nodes[mesh.elements].mean(axis=1)
    indptr = np.zeros(n + 1, dtype=np.int64)
    members: list[NDArray[np.int64]] = []
    weights: list[NDArray[np.float64]] = []
    for node in range(n):
        graph = own if inner[node] else wide
        patch = np.sort(graph.indices[graph.indptr[node] : graph.indptr[node + 1]])
        members.append(patch)
        weights.append(_fit(centres[patch], mesh.nodes[node]))
        indptr[node + 1] = indptr[node] + len(patch)
    return csr_array((np.concatenate(weights), np.concatenate(members), indptr), shape=(n, ne))


def _fit(points: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights w with ``sum w_i f(points_i) = f(target)`` for linear f, least squares."""
    mean = points.mean(axis=0)
    offsets = points - mean
    left, singular, right = np.linalg.svd(offsets, full_matrices=False)
    keep = singular > _FLAT * max(
        np.sqrt(np.sum((target - mean) ** 2)), singular[0] if len(singular) else 0.0
    )
    slope = left[:, keep] / singular[keep]
    return 1.0 / len(points) + slope @ (right[keep] @ (target - mean))
