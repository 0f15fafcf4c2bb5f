"""Geometric stiffness of structures: what tension and compression along plates and beams do to motions across them.

Stress of a small displacement stores, besides the elastic energy, its work on the second-order part of the strain. Of a
plate with membrane forces N = t sigma [N/m], moved by u over its mid-surface and turned by theta,

    U = 1/2 int (N_kl u,k . u,l + t^2/12 N_kl theta,k . theta,l) dA

with theta the rotations that bend it; of a beam with the axial force N, moved by v and w and turned by theta_1,

    U = 1/2 int N (v'^2 + w'^2 + (I_1 + I_2)/A theta_1'^2) dx

(J. S. Przemieniecki, *Theory of Matrix Structural Analysis*, 1968, chapter 15). Moments and shear in plates and beams
are left out, so that a deep beam does not tip over; plates that stand for its web and flanges do. Solids are those of
`heavylift.preprocess.finite_elements.geometric`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements import geometric
from heavylift.preprocess.finite_elements.elasticity import BlockMatrix, NodePattern
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.structures.assemble import blocks_of, element_motion, shell_chunks, shell_groups
from heavylift.preprocess.structures.beam import beam_operators, skew
from heavylift.preprocess.structures.shell_operators import MEMBRANE, plane_stress

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.model import FEModel
    from heavylift.preprocess.structures.beam import BeamOperators
    from heavylift.preprocess.structures.shell_operators import ShellOperators
    from heavylift.preprocess.structures.structure import Beams, Shells, Structure

__all__ = ["geometric_stiffness"]


def geometric_stiffness(
    structure: Structure, model: FEModel, displacements: NDArray[np.float64]
) -> csr_array:
    """K_g of all degrees of freedom of a model [N/m, N, N m], sparse (N, N), symmetric.

    Parameters
    ----------
    structure
        That the model was assembled from.
    model
        Of it; its degrees of freedom number those of K_g.
    displacements
        Displacements and rotations that make the stress, shape (N,).

    Returns
    -------
    csr_array
        To be added to the stiffness; buckling is ``K phi = -lambda K_g phi``.

    Raises
    ------
    InputError
        Displacements that do not fit the model or are not finite.
    """
    from scipy.sparse import csr_array, identity, kron

    u = np.asarray(displacements, dtype=np.float64)
    if u.shape != (model.dof_count,) or not np.all(np.isfinite(u)):
        raise InputError(
            f"displacements of shape {u.shape}",
            source=structure.name or "structure",
            expected=f"{model.dof_count} finite numbers, those of the degrees of freedom",
        )
    total = csr_array((model.dof_count, model.dof_count))
    blocks = model.dof_count // 3
    for group in shell_groups(structure):
        elements = np.concatenate([part.elements for part in group])
        matrix = BlockMatrix(NodePattern(blocks_of(model, elements, group[0].bends), blocks))
        first = 0
        for shells in group:
            for part, nodes, operators, thickness, offset in shell_chunks(structure, shells):
                moved = element_motion(model, nodes, u)
                own = _shell_matrices(shells, operators, thickness, offset, moved)
                matrix.add(first + part.start, own)
            first += len(shells.elements)
        total = csr_array(total + matrix.tocsr())
    beams = [part for part in structure.beams if len(part.elements)]
    if beams:
        elements = np.concatenate([part.elements for part in beams])
        matrix = BlockMatrix(NodePattern(blocks_of(model, elements), blocks))
        first = 0
        for one in beams:
            lines = beam_operators(structure.nodes, one, source=structure.name or "structure")
            matrix.add(first, _beam_matrices(one, lines, element_motion(model, one.elements, u)))
            first += len(one.elements)
        total = csr_array(total + matrix.tocsr())
    moved_nodes = u[: 3 * model.node_count].reshape(-1, 3)
    for solids in structure.solids:
        mesh = Mesh(structure.nodes, solids.elements, solids.element_type, name=structure.name)
        scalar = geometric.geometric_stiffness(mesh, solids.material, moved_nodes)
        whole = csr_array(kron(scalar, identity(3, format="csr"), format="csr"))
        whole.resize(total.shape)
        total = csr_array(total + whole)
    return total


def _shell_matrices(
    shells: Shells,
    operators: ShellOperators,
    thickness: NDArray[np.float64],
    offset: NDArray[np.float64],
    moved: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Matrices of plates (ne, 6 nodes, 6 nodes), or of their displacements alone if they do not bend."""
    ne, nodes, _ = operators.local.shape
    strain = np.matmul(operators.strain[:, :, MEMBRANE], moved[:, None, :, None])[..., 0]
    force = np.matmul(strain, plane_stress(shells.material)) * thickness[:, None, None]
    N = force[..., [0, 2, 2, 1]].reshape(ne, -1, 2, 2)
    G = operators.gradient
    weighted = np.matmul(G, N) * operators.area[..., None, None]
    S = np.matmul(weighted, G.transpose(0, 1, 3, 2)).sum(axis=1)  # (ne, nodes, nodes)
    if not shells.bends:
        K = S[:, :, None, :, None] * np.eye(3)[:, None, :]
        return np.ascontiguousarray(K).reshape(ne, 3 * nodes, 3 * nodes)
    normal = operators.axes[:, 2]
    r = offset[:, None] - operators.local[..., 2]
    L = np.zeros((ne, nodes, 3, 6))
    L[..., :3] = np.eye(3)
    L[..., 3:] = -skew(r[..., None] * normal[:, None])
    turned = np.zeros((ne, 1, 3, 6))
    turned[..., 3:] = (np.eye(3) - normal[:, :, None] * normal[:, None])[:, None]
    turned *= (thickness / np.sqrt(12.0))[:, None, None, None]
    both = np.concatenate([L, np.broadcast_to(turned, L.shape)], axis=2)  # (ne, nodes, 6, 6)
    K = np.einsum("eab,eaki,ebkj->eaibj", S, both, both, optimize=True)
    return K.reshape(ne, 6 * nodes, 6 * nodes)


def _beam_matrices(beams: Beams, operators: BeamOperators, moved: NDArray[np.float64]) -> NDArray[np.float64]:
    """Matrices of beams, shape (ne, 12, 12)."""
    section, L = beams.section, operators.length
    ends = np.matmul(operators.ends_from_nodes, moved[..., None])[..., 0]
    N = beams.material.young_modulus * section.area / L * (ends[:, 6] - ends[:, 0])
    K = np.zeros((len(L), 12, 12))
    one = np.ones_like(L)
    for deflection, rotation, sign in ((1, 5, 1.0), (2, 4, -1.0)):
        index = np.array([deflection, rotation, deflection + 6, rotation + 6])
        block = np.array(
            [
                [36.0 * one, sign * 3.0 * L, -36.0 * one, sign * 3.0 * L],
                [sign * 3.0 * L, 4.0 * L**2, -sign * 3.0 * L, -(L**2)],
                [-36.0 * one, -sign * 3.0 * L, 36.0 * one, -sign * 3.0 * L],
                [sign * 3.0 * L, -(L**2), -sign * 3.0 * L, 4.0 * L**2],
            ]
        )
        K[:, index[:, None], index] = (N / (30.0 * L) * block).transpose(2, 0, 1)
    twist = N / L * (section.second_moment_1 + section.second_moment_2) / section.area
    K[:, 3, 3], K[:, 9, 9], K[:, 3, 9], K[:, 9, 3] = twist, twist, -twist, -twist
    return np.matmul(operators.ends_from_nodes.transpose(0, 2, 1), np.matmul(K, operators.ends_from_nodes))
