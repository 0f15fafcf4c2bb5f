"""Stiffness and mass matrices of a solid of linear, isotropic material.

scikit-fem supplies the shape functions and quadrature rules of the quadratic tetrahedron and of the fully
integrated brick; the element matrices are formed for many elements at once and scattered in bounded memory.
The other bricks are in `heavylift.preprocess.finite_elements.hex8`.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.model import FEModel
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES, TET_EDGES, jacobians
from heavylift.preprocess.finite_elements.scatter import BlockMatrix, NodePattern, ScalarMatrix

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import Material

__all__ = ["FORMULATIONS", "MASS_KINDS", "assemble", "mass_matrix", "stiffness_matrix"]

FORMULATIONS = {"hex8": ("full", "incompatible", "reduced"), "tet10": ("full",)}
"""Stiffness formulations of each element type."""
DEFAULT_FORMULATION = {"hex8": "incompatible", "tet10": "full"}
MASS_KINDS = ("consistent", "lumped", "row_sum")
"""How mass is put on nodes; see `mass_matrix`."""

_CHUNK = 2048  # elements at once: 15 MB of element matrices for tet10
# degree of the quadrature: exact for straight-sided tetrahedra and for parallelepipeds
_STIFFNESS_ORDER = {"hex8": 3, "tet10": 2}
_MASS_ORDER = {"hex8": 3, "tet10": 4}
# cofactors of J times dN/dxi are cubic on a curved tetrahedron; below that degree the patch test fails
_CURVED_ORDER = 5
_CURVED = 1e-6  # distance of a middle node from the middle of its edge, in edge lengths


class _Quadrature(NamedTuple):
    shape: NDArray[np.float64]  # N, (nq, nodes per element)
    gradients: NDArray[np.float64]  # dN/dxi, (nq, nodes per element, 3)
    weights: NDArray[np.float64]  # (nq,)


def assemble(
    mesh: Mesh, material: Material, *, formulation: str | None = None, mass: str = "consistent"
) -> FEModel:
    """Assemble the finite element model of a body.

    Parameters
    ----------
    mesh
        A mesh of ``hex8`` or ``tet10`` elements.
    material
        Its material.
    formulation
        ``"full"`` (tet10, hex8), ``"incompatible"`` or ``"reduced"`` (hex8); default ``"full"`` for tet10 and
        ``"incompatible"`` for hex8, whose full integration locks in bending.
    mass
        ``"consistent"``, ``"lumped"`` or ``"row_sum"``, see `mass_matrix`.

    Raises
    ------
    InputError
        An unknown formulation or kind of mass, an inverted element, row sums asked of quadratic tetrahedra.
    """
    pattern = NodePattern(mesh.elements, mesh.node_count)
    return FEModel(
        nodes=mesh.nodes,
        stiffness=stiffness_matrix(mesh, material, formulation=formulation, pattern=pattern),
        mass=mass_matrix(mesh, material.density, kind=mass, pattern=pattern),
        mesh=mesh,
        material=material,
        node_groups=mesh.node_groups,
        name=mesh.name,
    )


def stiffness_matrix(
    mesh: Mesh, material: Material, *, formulation: str | None = None, pattern: NodePattern | None = None
) -> csr_array:
    """Assemble K [N/m], sparse (3n, 3n), node-major; parameters and errors as `assemble`.

    Notes
    -----
    K_IJ = int lambda grad N_I (x) grad N_J + mu grad N_J (x) grad N_I + mu (grad N_I . grad N_J) 1 dV, the
    weak form of isotropic elasticity; four points for straight tetrahedra, 2 x 2 x 2 for bricks.
    """
    kind = formulation or DEFAULT_FORMULATION[mesh.element_type]
    if kind not in FORMULATIONS[mesh.element_type]:
        allowed = ", ".join(repr(name) for name in FORMULATIONS[mesh.element_type])
        raise InputError(
            f"{kind!r} is not a formulation of {mesh.element_type}",
            source=mesh.name or "mesh",
            key="formulation",
            expected=f"one of {allowed}",
        )
    matrix = BlockMatrix(pattern or NodePattern(mesh.elements, mesh.node_count))
    for start, corners in _chunks(mesh):
        if kind == "full":
            matrix.add(start, _full_stiffness(mesh, start, corners, material))
        else:
            from heavylift.preprocess.finite_elements.hex8 import brick_stiffness

            try:
                matrix.add(start, brick_stiffness(corners, material, formulation=kind))
            except InputError:
                mesh.check()  # names the element
                raise
    return matrix.tocsr()


def mass_matrix(
    mesh: Mesh, density: float, *, kind: str = "consistent", pattern: NodePattern | None = None
) -> csr_array:
    """Assemble the scalar mass matrix M_s [kg], sparse (n, n).

    Parameters
    ----------
    mesh
        A mesh of ``hex8`` or ``tet10`` elements.
    density
        rho [kg/m3].
    kind
        ``"consistent"``: int rho N_I N_J dV. ``"lumped"``: V/8 a node for bricks; for tetrahedra the
        diagonal of the consistent matrix scaled to the element's mass (1/36 of it a vertex, 4/27 a middle
        node when straight-sided): Hinton, Rock, Zienkiewicz, *Earthquake Engng Struct. Dyn.* 4 (1976) 245.
        ``"row_sum"``: int rho N_I dV, bricks only.

    Raises
    ------
    InputError
        An unknown kind, an inverted element, or row sums of quadratic tetrahedra: these are negative at the
        vertices (-1/20 of the element's mass).
    """
    if kind not in MASS_KINDS:
        raise InputError(
            f"{kind!r} is not a kind of mass matrix",
            source=mesh.name or "mesh",
            key="mass",
            expected="one of " + ", ".join(repr(name) for name in MASS_KINDS),
        )
    if kind == "row_sum" and mesh.element_type == "tet10":
        raise InputError(
            "row sums of quadratic tetrahedra are negative at the vertices",
            source=mesh.name or "mesh",
            key="mass",
            expected="'lumped' (scaled diagonal) or 'consistent'",
        )
    if kind == "consistent":
        matrix = ScalarMatrix(pattern or NodePattern(mesh.elements, mesh.node_count))
        for start, corners in _chunks(mesh):
            matrix.add(start, _consistent_mass(mesh, start, corners, density))
        return matrix.tocsr()

    from scipy.sparse import csr_array, diags_array

    lumps = np.zeros(mesh.node_count)
    for start, corners in _chunks(mesh):
        Me = _consistent_mass(mesh, start, corners, density)
        if kind == "row_sum":
            nodal = Me.sum(axis=2)
        elif mesh.element_type == "tet10":
            diagonal = np.diagonal(Me, axis1=1, axis2=2)
            nodal = diagonal * (Me.sum(axis=(1, 2)) / diagonal.sum(axis=1))[:, None]
        else:
            nodal = np.repeat(Me.sum(axis=(1, 2))[:, None] / 8.0, 8, axis=1)
        np.add.at(lumps, mesh.elements[start : start + len(Me)].ravel(), nodal.ravel())
    return csr_array(diags_array(lumps, format="csr"))


def _chunks(mesh: Mesh) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Yield the first element of each chunk and the node positions of its elements."""
    for start in range(0, mesh.element_count, _CHUNK):
        yield start, mesh.nodes[mesh.elements[start : start + _CHUNK]]


@cache
def _quadrature(element_type: str, order: int) -> _Quadrature:
    """Shape functions of scikit-fem at its quadrature points, in our node order."""
    from skfem import ElementHex1, ElementTetP2
    from skfem.quadrature import get_quadrature

    element = ElementHex1() if element_type == "hex8" else ElementTetP2()
    points, weights = get_quadrature(element.refdom, order)
    basis = [element.lbasis(points, i) for i in range(len(element.doflocs))]
    # scikit-fem numbers bricks differently and lives on [0, 1]^3: nodes are matched by their place
    places = REFERENCE_NODES[element_type]
    if element_type == "hex8":
        places = 0.5 * (places + 1.0)
    order_of = [int(np.argmin(np.abs(element.doflocs - place).sum(axis=1))) for place in places]
    shape = np.array([np.broadcast_to(basis[i][0], weights.shape) for i in order_of]).T
    gradients = np.array([basis[i][1] for i in order_of]).transpose(2, 0, 1)
    return _Quadrature(shape, np.ascontiguousarray(gradients), weights)


def _is_curved(corners: NDArray[np.float64]) -> bool:
    """Whether any of the quadratic tetrahedra (ne, 10, 3) has a bent edge."""
    first, second = corners[:, TET_EDGES[:, 0]], corners[:, TET_EDGES[:, 1]]
    bend = np.linalg.norm(corners[:, 4:] - 0.5 * (first + second), axis=2)
    return bool((bend > _CURVED * np.linalg.norm(second - first, axis=2)).any())


def _determinants(mesh: Mesh, start: int, J: NDArray[np.float64]) -> NDArray[np.float64]:
    """Det J (ne, nq) [m3 per reference volume]; refuses inverted elements."""
    # cofactor expansion: np.linalg.det spends most of its time in LAPACK calls on 3 x 3 matrices
    detJ = np.einsum("eqi,eqi->eq", J[..., 0], np.cross(J[..., 1], J[..., 2]))
    wrong = np.flatnonzero((detJ <= 0.0).any(axis=1))
    if wrong.size:
        mesh.check()  # names the element
        raise InputError(
            "the Jacobian determinant is not positive at a quadrature point",
            source=mesh.name or "mesh",
            key=f"element {start + wrong[0] + 1}",
            expected="an element that is not inverted",
        )
    return detJ


def _full_stiffness(
    mesh: Mesh, start: int, corners: NDArray[np.float64], material: Material
) -> NDArray[np.float64]:
    """Element stiffness matrices (ne, 3 nodes, 3 nodes) by full quadrature."""
    order = _STIFFNESS_ORDER[mesh.element_type]
    if mesh.element_type == "tet10" and _is_curved(corners):
        order = _CURVED_ORDER
    rule = _quadrature(mesh.element_type, order)
    J = jacobians(corners, rule.gradients)
    weight = rule.weights * _determinants(mesh, start, J)
    G = np.matmul(rule.gradients, np.linalg.inv(J))  # dN/dx, (ne, nq, nodes, 3)
    ne, nq, nn, _ = G.shape
    # rows sqrt(w) dN_I/dx_a, one column a point: H_IaJb = sum_q w G_Ia G_Jb is one product
    G *= np.sqrt(weight)[:, :, None, None]
    columns = G.reshape(ne, nq, 3 * nn).transpose(0, 2, 1)
    H = np.matmul(columns, columns.transpose(0, 2, 1)).reshape(ne, nn, 3, nn, 3)
    mu = material.shear_modulus
    K = material.lame_lambda * H
    K += mu * H.transpose(0, 1, 4, 3, 2)
    trace = mu * (H[:, :, 0, :, 0] + H[:, :, 1, :, 1] + H[:, :, 2, :, 2])
    for a in range(3):
        K[:, :, a, :, a] += trace
    return K.reshape(ne, 3 * nn, 3 * nn)


def _consistent_mass(
    mesh: Mesh, start: int, corners: NDArray[np.float64], density: float
) -> NDArray[np.float64]:
    """Element mass matrices (ne, nodes, nodes) [kg]."""
    rule = _quadrature(mesh.element_type, _MASS_ORDER[mesh.element_type])
    weight = density * rule.weights * _determinants(mesh, start, jacobians(corners, rule.gradients))
    products = rule.shape[:, :, None] * rule.shape[:, None, :]
    return np.tensordot(weight, products, axes=1)
