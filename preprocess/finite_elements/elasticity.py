"""Stiffness and mass matrices of a solid of linear, isotropic material.

scikit-fem supplies the shape functions and quadrature rules of the quadratic tetrahedron and of fully
integrated bricks of 8 and 20 nodes; bricks with incompatible modes, and with one point and hourglass stiffness, are
written here. The element matrices are formed for many elements at once and scattered in bounded memory: the pattern of
node pairs is found once, element matrices are then added chunk by chunk straight into the value array of the result. A
list of 900 triplets an element (10 nodes) would take several times the memory of the matrix.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.model import FEModel
from heavylift.preprocess.finite_elements.reference_elements import (
    REFERENCE_NODES,
    TET_EDGES,
    jacobians,
    shape_gradients,
    volume_rule,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from heavylift.preprocess.finite_elements.mesh import Mesh
    from heavylift.preprocess.finite_elements.model import Material

__all__ = [
    "FORMULATIONS",
    "HOURGLASS_COEFFICIENT",
    "HOURGLASS_VECTORS",
    "MASS_KINDS",
    "BlockMatrix",
    "NodePattern",
    "ScalarMatrix",
    "assemble",
    "assemble_several",
    "brick_alphas",
    "brick_stiffness",
    "consistent_mass_rule",
    "mass_matrix",
    "stiffness_matrix",
]


# ---- scattering ----


class NodePattern:
    """Which pairs of nodes share an element.

    Parameters
    ----------
    elements
        Node indices, shape (ne, nodes per element).
    node_count
        Number of nodes n.

    Attributes
    ----------
    indptr, indices
        Compressed rows of the symmetric pattern, n rows, sorted.
    slots
        Position in `indices` of every node pair of every element, shape (ne, nodes per element squared).
    """

    def __init__(self, elements: NDArray[np.int64], node_count: int) -> None:
        keys = (elements[:, :, None] * node_count + elements[:, None, :]).reshape(len(elements), -1)
        pairs, slots = np.unique(keys, return_inverse=True)
        self.node_count = node_count
        # 32-bit indices: half the memory, and what the sparse solvers take
        self.slots = slots.reshape(keys.shape).astype(np.int32)
        self.indices = (pairs % node_count).astype(np.int32)
        counts = np.bincount(pairs // node_count, minlength=node_count)
        self.indptr = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)


class BlockMatrix:
    """A (3n, 3n) matrix under assembly, made of 3 x 3 blocks on a `NodePattern`."""

    def __init__(self, pattern: NodePattern) -> None:
        self.pattern = pattern
        # one contiguous array a component, because np.add.at is fast on those only
        self._values = np.zeros((3, 3, len(pattern.indices)))

    def add(self, start: int, matrices: NDArray[np.float64]) -> None:
        """Add element matrices (m, 3 nodes, 3 nodes), node-major, of elements start, start + 1, ..."""
        m, size, _ = matrices.shape
        nn = size // 3
        slots = self.pattern.slots[start : start + m].ravel()
        blocks = matrices.reshape(m, nn, 3, nn, 3)
        for a in range(3):
            for b in range(3):
                np.add.at(self._values[a, b], slots, blocks[:, :, a, :, b].ravel())

    def tocsr(self) -> csr_array:
        """Return the matrix, node-major x, y, z."""
        from scipy.sparse import bsr_array

        p = self.pattern
        size = 3 * p.node_count
        data = np.ascontiguousarray(self._values.transpose(2, 0, 1))
        matrix = bsr_array((data, p.indices, p.indptr), shape=(size, size)).tocsr()
        matrix.sort_indices()
        return matrix


class ScalarMatrix:
    """An (n, n) matrix under assembly on a `NodePattern`."""

    def __init__(self, pattern: NodePattern) -> None:
        self.pattern = pattern
        self._values = np.zeros(len(pattern.indices))

    def add(self, start: int, matrices: NDArray[np.float64]) -> None:
        """Add the element matrices (m, nodes, nodes) of elements start, start + 1, ..."""
        slots = self.pattern.slots[start : start + len(matrices)].ravel()
        np.add.at(self._values, slots, matrices.ravel())

    def tocsr(self) -> csr_array:
        """Return the matrix."""
        from scipy.sparse import csr_array

        p = self.pattern
        return csr_array((self._values, p.indices, p.indptr), shape=(p.node_count, p.node_count))


# ---- bricks ----


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
    K = _uncondensed(corners, material, G, weight)[0]
    Kuu, Kua, Kaa = K[:, :24, :24], K[:, :24, 24:], K[:, 24:, 24:]
    K = Kuu - np.matmul(Kua, np.linalg.solve(Kaa, Kua.transpose(0, 2, 1)))
    return 0.5 * (K + K.transpose(0, 2, 1))


def _uncondensed(
    corners: NDArray[np.float64],
    material: Material,
    G: NDArray[np.float64],
    weight: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Stiffness with nine parameters of incompatible modes, (ne, 33, 33), and gradients of these, (ne, nq, 3, 3)."""
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
    return K, modes


def brick_alphas(
    corners: NDArray[np.float64], material: Material, displacements: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What displacements of their nodes do to the incompatible modes of bricks.

    Parameters
    ----------
    corners, material
        As of `brick_stiffness`.
    displacements
        Of the nodes [m], shape (ne, 8, 3).

    Returns
    -------
    tuple
        Gradients of the modes at the 2 x 2 x 2 points [1/m], shape (ne, 8, 3, 3), and their parameters [m], shape
        (ne, 3, 3): the displacement gradient gains ``sum_k alpha_ki (grad mode_k)_j``.
    """
    points, weights = volume_rule("hex8")
    reference = shape_gradients("hex8", points)
    J = jacobians(corners, reference)
    K, modes = _uncondensed(
        corners, material, np.matmul(reference, np.linalg.inv(J)), weights * np.linalg.det(J)
    )
    load = np.matmul(K[:, 24:, :24], displacements.reshape(len(corners), 24, 1))
    alphas = np.linalg.solve(K[:, 24:, 24:], -load).reshape(-1, 3, 3)
    return modes, np.asarray(alphas, dtype=np.float64)


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


# ---- matrices of a mesh ----


FORMULATIONS = {"hex8": ("full", "incompatible", "reduced"), "tet10": ("full",), "hex20": ("full", "reduced")}
"""Stiffness formulations of each element type."""
DEFAULT_FORMULATION = {"hex8": "incompatible", "tet10": "full", "hex20": "full"}
MASS_KINDS = ("consistent", "lumped", "row_sum")
"""How mass is put on nodes; see `mass_matrix`."""

_CHUNK = 2048  # elements at once: 15 MB of element matrices for tet10
# degree of the quadrature: exact for straight-sided tetrahedra and for parallelepipeds
_STIFFNESS_ORDER = {"hex8": 3, "tet10": 2, "hex20": 5}
_MASS_ORDER = {"hex8": 3, "tet10": 4, "hex20": 5}
# 20-node bricks: 2 x 2 x 2 points; their idle motions spread through a single row of bricks, but through no wider mesh
_REDUCED_ORDER = 3
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
        A mesh of ``hex8``, ``hex20`` or ``tet10`` elements.
    material
        Its material.
    formulation
        ``"full"``, ``"incompatible"`` (hex8) or ``"reduced"`` (hex8 with hourglass stiffness, hex20 with 2 x 2 x 2
        points); default ``"full"``, but ``"incompatible"`` for hex8, whose full integration locks in bending.
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


def assemble_several(
    mesh: Mesh,
    materials: Sequence[Material],
    index: NDArray[np.int64],
    *,
    formulation: str | None = None,
    mass: str = "consistent",
) -> FEModel:
    """Assemble the finite element model of a body of several materials.

    Parameters
    ----------
    mesh, formulation, mass
        As of `assemble`.
    materials
        Its materials.
    index
        Entry of `materials` of every element, shape (ne,).

    Returns
    -------
    FEModel
        Without a material, which is what the stress of a body follows from, if there is more than one.

    Raises
    ------
    InputError
        As `assemble`.
    """
    if len(materials) == 1:
        return assemble(mesh, materials[0], formulation=formulation, mass=mass)
    parts = [
        assemble(replace(mesh, elements=mesh.elements[index == k]), one, formulation=formulation, mass=mass)
        for k, one in enumerate(materials)
    ]
    return FEModel(
        nodes=mesh.nodes,
        stiffness=_sum([part.stiffness for part in parts]),
        mass=_sum([part.mass for part in parts]),
        mesh=mesh,
        node_groups=mesh.node_groups,
        name=mesh.name,
    )


def _sum(matrices: Sequence[csr_array]) -> csr_array:
    """Sum of sparse matrices of one shape."""
    from scipy.sparse import csr_array

    total = csr_array(matrices[0].shape)
    for matrix in matrices:
        total = csr_array(total + matrix)
    return total


def stiffness_matrix(
    mesh: Mesh, material: Material, *, formulation: str | None = None, pattern: NodePattern | None = None
) -> csr_array:
    """Assemble K [N/m], sparse (3n, 3n), node-major; parameters and errors as `assemble`.

    Notes
    -----
    K_IJ = int lambda grad N_I (x) grad N_J + mu grad N_J (x) grad N_I + mu (grad N_I . grad N_J) 1 dV, the
    weak form of isotropic elasticity; four points for straight tetrahedra, 2 x 2 x 2 for bricks, 3 x 3 x 3 for those
    of 20 nodes.
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
        if kind == "full" or mesh.element_type == "hex20":
            matrix.add(start, _full_stiffness(mesh, start, corners, material, reduced=kind == "reduced"))
        else:
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
        A mesh of ``hex8``, ``hex20`` or ``tet10`` elements.
    density
        rho [kg/m3].
    kind
        ``"consistent"``: int rho N_I N_J dV. ``"lumped"``: V/8 a node for 8-node bricks; for quadratic elements the
        diagonal of the consistent matrix scaled to the element's mass (1/36 of it a vertex, 4/27 a middle
        node when straight-sided): Hinton, Rock, Zienkiewicz, *Earthquake Engng Struct. Dyn.* 4 (1976) 245.
        ``"row_sum"``: int rho N_I dV, 8-node bricks only.

    Raises
    ------
    InputError
        An unknown kind, an inverted element, or row sums of quadratic elements: these are negative at the
        vertices (-1/20 of the mass of a tetrahedron, -1/8 of that of a brick).
    """
    if kind not in MASS_KINDS:
        raise InputError(
            f"{kind!r} is not a kind of mass matrix",
            source=mesh.name or "mesh",
            key="mass",
            expected="one of " + ", ".join(repr(name) for name in MASS_KINDS),
        )
    if kind == "row_sum" and mesh.element_type != "hex8":
        shape = "tetrahedra" if mesh.element_type == "tet10" else "bricks"
        raise InputError(
            f"row sums of quadratic {shape} are negative at the vertices",
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
        elif mesh.element_type != "hex8":
            diagonal = np.diagonal(Me, axis1=1, axis2=2)
            nodal = diagonal * (Me.sum(axis=(1, 2)) / diagonal.sum(axis=1))[:, None]
        else:
            nodal = np.repeat(Me.sum(axis=(1, 2))[:, None] / 8.0, 8, axis=1)
        np.add.at(lumps, mesh.elements[start : start + len(Me)].ravel(), nodal.ravel())
    return csr_array(diags_array(lumps, format="csr"))


def consistent_mass_rule(
    mesh: Mesh,
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]]:
    """Yield nodes (m, k), shape functions (points, k), volumes (m, points) [m3] that consistent masses are sums of."""
    rule = _quadrature(mesh.element_type, _MASS_ORDER[mesh.element_type])
    for start, corners in _chunks(mesh):
        volumes = rule.weights * _determinants(mesh, start, jacobians(corners, rule.gradients))
        yield mesh.elements[start : start + len(corners)], rule.shape, volumes


def _chunks(mesh: Mesh) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Yield the first element of each chunk and the node positions of its elements."""
    for start in range(0, mesh.element_count, _CHUNK):
        yield start, mesh.nodes[mesh.elements[start : start + _CHUNK]]


@cache
def _quadrature(element_type: str, order: int) -> _Quadrature:
    """Shape functions of scikit-fem at its quadrature points, in our node order."""
    from skfem import ElementHex1, ElementHexS2, ElementTetP2
    from skfem.quadrature import get_quadrature

    element = {"hex8": ElementHex1, "hex20": ElementHexS2, "tet10": ElementTetP2}[element_type]()
    points, weights = get_quadrature(element.refdom, order)
    basis = [element.lbasis(points, i) for i in range(len(element.doflocs))]
    # scikit-fem numbers bricks differently and lives on [0, 1]^3: nodes are matched by their place
    places = REFERENCE_NODES[element_type]
    if element_type != "tet10":
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
    mesh: Mesh, start: int, corners: NDArray[np.float64], material: Material, *, reduced: bool = False
) -> NDArray[np.float64]:
    """Element stiffness matrices (ne, 3 nodes, 3 nodes) by quadrature, full or of one order less."""
    order = _REDUCED_ORDER if reduced else _STIFFNESS_ORDER[mesh.element_type]
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
