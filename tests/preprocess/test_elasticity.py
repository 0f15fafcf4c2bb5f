"""Stiffness and mass: patch tests, rigid motions, independent assembly, lumping."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements import elasticity
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.model import FEModel, Material
from heavylift.preprocess.finite_elements.reference_elements import (
    REFERENCE_NODES,
    shape_functions,
    shape_gradients,
)

SOLIDS = [
    ("distorted_bricks", "full"),
    ("distorted_bricks", "incompatible"),
    ("distorted_bricks", "reduced"),
    ("straight_tetrahedra", "full"),
    ("curved_tetrahedra", "full"),
    ("quadratic_bricks", "full"),
]


@pytest.mark.parametrize(("name", "formulation"), SOLIDS)
def test_patch_of_constant_strain(name, formulation, request, steel):
    """A linear field on the surface gives the same field inside and the exact strain energy."""
    mesh = request.getfixturevalue(name)
    K = elasticity.stiffness_matrix(mesh, steel, formulation=formulation)
    gradient = np.array([[1.0, 0.4, -0.3], [0.2, -0.7, 0.5], [0.1, 0.6, 0.9]])
    exact = (mesh.nodes @ gradient.T).ravel()
    surface = ((mesh.nodes < 1e-9) | (mesh.nodes > 1 - 1e-9)).any(axis=1)
    fixed = np.repeat(surface, 3)
    assert (~fixed).sum() > 20
    free_K = K[~fixed]
    inside = spsolve(free_K[:, ~fixed].tocsc(), -free_K[:, fixed] @ exact[fixed])
    np.testing.assert_allclose(inside, exact[~fixed], rtol=0, atol=1e-11)

    strain = 0.5 * (gradient + gradient.T)
    stress = steel.lame_lambda * np.trace(strain) * np.eye(3) + 2 * steel.shear_modulus * strain
    assert exact @ K @ exact == pytest.approx(np.sum(stress * strain) * mesh.volume, rel=1e-11)


@pytest.mark.parametrize(("name", "formulation"), SOLIDS)
def test_exactly_six_rigid_motions_cost_no_energy(name, formulation, request, steel):
    mesh = request.getfixturevalue(name)
    K = elasticity.stiffness_matrix(mesh, steel, formulation=formulation)
    assert abs(K - K.T).max() == 0.0
    values = np.linalg.eigvalsh(K.toarray())
    assert values[:6] == pytest.approx(np.zeros(6), abs=1e-9 * values[-1])
    assert values[6] > 1e-6 * values[-1]


def _oracle(mesh, material, degree):
    """K and M_s by plain loops: B^T D B at each point of a tensor Gauss rule, one element after the other."""
    g, w = np.polynomial.legendre.leggauss(degree)
    u, wu = (g, w) if mesh.element_type != "tet10" else (0.5 * (g + 1), 0.5 * w)
    a, b, c = (v.ravel() for v in np.meshgrid(u, u, u, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", wu, wu, wu).ravel()
    points = np.column_stack([a, b, c])
    if mesh.element_type == "tet10":  # collapsed coordinates
        points = np.column_stack([a, b * (1 - a), c * (1 - a) * (1 - b)])
        weights = weights * (1 - a) ** 2 * (1 - b)
    N, dN = shape_functions(mesh.element_type, points), shape_gradients(mesh.element_type, points)
    D, n = material.elasticity_matrix(), mesh.node_count
    K, M = np.zeros((3 * n, 3 * n)), np.zeros((n, n))
    for element in mesh.elements:
        dofs = (3 * element[:, None] + np.arange(3)).ravel()
        for q, weight in enumerate(weights):
            J = mesh.nodes[element].T @ dN[q]
            G = dN[q] @ np.linalg.inv(J)
            B = np.zeros((6, 3 * len(element)))
            for i, (x, y, z) in enumerate(G):
                block = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
                B[:, 3 * i : 3 * i + 3] = block
            dV = weight * np.linalg.det(J)
            K[np.ix_(dofs, dofs)] += dV * B.T @ D @ B
            M[np.ix_(element, element)] += material.density * dV * np.outer(N[q], N[q])
    return K, M


@pytest.mark.parametrize(
    ("name", "degree"),
    [("distorted_bricks", 2), ("straight_tetrahedra", 4), ("quadratic_bricks", 3)],
    ids=["hex8", "tet10", "hex20"],
)
def test_matrices_agree_with_plain_loops(name, degree, request, steel):
    mesh = request.getfixturevalue(name)
    few = mesh.elements[:20]
    used, flat = np.unique(few, return_inverse=True)
    mesh = Mesh(mesh.nodes[used], flat.reshape(few.shape), mesh.element_type)
    K, M = _oracle(mesh, steel, degree)
    model = elasticity.assemble(mesh, steel, formulation="full")
    np.testing.assert_allclose(model.stiffness.toarray(), K, atol=1e-12 * np.abs(K).max())
    np.testing.assert_allclose(model.mass.toarray(), M, atol=1e-12 * np.abs(M).max())


@pytest.mark.slow
def test_reduced_bricks_of_20_nodes_have_eight_points_and_no_idle_motions_in_a_mesh(quadratic_bricks, steel):
    mesh = Mesh(quadratic_bricks.nodes, quadratic_bricks.elements, "hex20")
    K = elasticity.stiffness_matrix(mesh, steel, formulation="reduced").toarray()
    expected, _ = _oracle(mesh, steel, 2)
    np.testing.assert_allclose(K, expected, atol=1e-12 * np.abs(expected).max())
    values = np.linalg.eigvalsh(K)
    assert values[:6] == pytest.approx(np.zeros(6), abs=1e-9 * values[-1])
    assert values[6] > 1e-6 * values[-1]


def test_one_row_of_bricks_of_20_nodes_bends_like_a_beam(steel):
    length, height, width, count = 1.0, 0.1, 0.05, 5
    one = Mesh(0.5 * (REFERENCE_NODES["hex20"] + 1.0), np.arange(20)[None], "hex20")
    nodes = np.vstack(
        [(one.nodes + np.array([k, 0, 0])) * [length / count, height, width] for k in range(count)]
    )
    places, number = np.unique(nodes.round(9), axis=0, return_inverse=True)
    mesh = Mesh(places, number.reshape(count, 20), "hex20").check()
    soft = Material(steel.young_modulus, 0.0, steel.density)
    K = elasticity.stiffness_matrix(mesh, soft)
    end = np.flatnonzero(np.isclose(places[:, 0], length))
    y = places[end, 1] - 0.5 * height
    exact = np.zeros_like(places)
    curvature = 0.01
    exact[:, 0] = -curvature * places[:, 0] * (places[:, 1] - 0.5 * height)
    exact[:, 1] = 0.5 * curvature * places[:, 0] ** 2
    forces = (K @ exact.ravel()).reshape(-1, 3)
    # pure bending is a quadratic field and needs forces at both ends only, with the moment E I curvature
    inside = (places[:, 0] > 1e-9) & (places[:, 0] < length - 1e-9)
    assert np.abs(forces[inside]).max() < 1e-9 * np.abs(forces).max()
    moment = -(forces[end, 0] * y).sum()
    assert moment == pytest.approx(soft.young_modulus * width * height**3 / 12 * curvature, rel=1e-9)


def test_tetrahedra_agree_with_the_weak_form_of_scikit_fem(straight_tetrahedra, steel):
    skfem = pytest.importorskip("skfem")
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    mesh = straight_tetrahedra
    vertices, index = np.unique(mesh.elements[:, :4], return_inverse=True)
    other = skfem.MeshTet(mesh.nodes[vertices].T, index.reshape(-1, 4).T)
    basis = skfem.Basis(other, skfem.ElementVector(skfem.ElementTetP2()), intorder=2)
    weak_form = linear_elasticity(*lame_parameters(steel.young_modulus, steel.poisson_ratio))
    A = weak_form.assemble(basis)
    # energies of smooth fields do not depend on the numbering
    K = elasticity.stiffness_matrix(mesh, steel)

    def field(x):
        return np.array([x[0] * x[1], x[2] ** 2 - x[0], x[1] * x[2] + x[0] ** 2])

    ours = field(mesh.nodes.T).T.ravel()
    # doflocs: for each vector dof its place; the component follows from the order of the element's dofs
    theirs = np.zeros(basis.N)
    component = np.zeros(basis.N, dtype=int)
    component[basis.element_dofs] = np.tile(np.arange(3), 10)[:, None]
    theirs[:] = field(basis.doflocs)[component, np.arange(basis.N)]
    assert ours @ K @ ours == pytest.approx(theirs @ A @ theirs, rel=1e-12)


@pytest.mark.parametrize(
    "name", ["distorted_bricks", "straight_tetrahedra", "curved_tetrahedra", "quadratic_bricks"]
)
@pytest.mark.parametrize("kind", ["consistent", "lumped"])
def test_mass_of_the_body(name, kind, request, steel):
    M = elasticity.mass_matrix(request.getfixturevalue(name), steel.density, kind=kind)
    assert M.sum() == pytest.approx(steel.density, rel=1e-12)
    assert M.diagonal().min() > 0


@pytest.mark.parametrize("name", ["distorted_bricks", "straight_tetrahedra"])
def test_consistent_mass_gives_exact_moments_of_a_cube(name, request, steel):
    mesh = request.getfixturevalue(name)
    x = mesh.nodes
    moments = x.T @ (elasticity.mass_matrix(mesh, steel.density) @ x)
    # int x_k x_l over the unit cube: 1/3 on the diagonal, 1/4 off it
    exact = steel.density * (np.full((3, 3), 0.25) + np.eye(3) / 12)
    # tetrahedra are integrated exactly; distorted bricks only up to their 2 x 2 x 2 points
    rtol = 1e-12 if name == "straight_tetrahedra" else 1e-3
    np.testing.assert_allclose(moments, exact, rtol=rtol)


def test_scaled_diagonal_of_a_straight_tetrahedron_is_1_36_and_4_27():
    nodes = REFERENCE_NODES["tet10"] @ np.array([[2.0, 0.1, 0.0], [0.3, 1.0, 0.2], [0.0, -0.4, 3.0]])
    mesh = Mesh(nodes, np.arange(10)[None], "tet10").check()
    masses = elasticity.mass_matrix(mesh, 5.0, kind="lumped").diagonal()
    np.testing.assert_allclose(masses[:4], 5.0 * mesh.volume / 36, rtol=1e-13)
    np.testing.assert_allclose(masses[4:], 5.0 * mesh.volume * 4 / 27, rtol=1e-13)


def test_lumping_keeps_the_centre_of_gravity_of_tetrahedra(complex_beam, steel):
    mesh = mesh_blocks(complex_beam.add, complex_beam.cut, size=8e-3)
    lumps = elasticity.mass_matrix(mesh, steel.density, kind="lumped").diagonal()
    boxes = [(1, *complex_beam.add), (-1, *complex_beam.cut)]
    parts = [(s, np.array(b.lower), np.array(b.upper)) for s, *group in boxes for b in group]
    volume = sum(s * np.prod(u - l) for s, l, u in parts)
    centre = sum(s * np.prod(u - l) * (u + l) / 2 for s, l, u in parts) / volume
    np.testing.assert_allclose(lumps @ mesh.nodes / lumps.sum(), centre, rtol=1e-12)
    assert lumps.sum() == pytest.approx(steel.density * complex_beam.volume, rel=1e-12)


def test_row_sums_of_quadratic_tetrahedra_are_refused_because_negative(straight_tetrahedra):
    corner = straight_tetrahedra.elements[0, 0]
    assert elasticity.mass_matrix(straight_tetrahedra, 1.0).sum(axis=1)[corner] < 0
    with pytest.raises(InputError, match="row sums of quadratic tetrahedra are negative"):
        elasticity.mass_matrix(straight_tetrahedra, 1.0, kind="row_sum")


def test_row_sums_of_bricks_are_the_integrals_of_the_shape_functions(distorted_bricks):
    sums = elasticity.mass_matrix(distorted_bricks, 2.0, kind="row_sum")
    consistent = elasticity.mass_matrix(distorted_bricks, 2.0)
    np.testing.assert_allclose(sums.diagonal(), consistent.sum(axis=1), rtol=1e-13)


def test_full_mass_moves_every_direction_alike(distorted_bricks, steel):
    model = elasticity.assemble(distorted_bricks, steel)
    velocity = np.array([0.3, -1.0, 2.0])
    v = np.tile(velocity, model.node_count)
    assert v @ model.full_mass() @ v == pytest.approx(model.total_mass * velocity @ velocity, rel=1e-12)


def test_inverted_element_is_refused(distorted_bricks, straight_tetrahedra, steel):
    for mesh, swap in (
        (distorted_bricks, [4, 5, 6, 7, 0, 1, 2, 3]),
        (straight_tetrahedra, [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]),
    ):
        elements = mesh.elements.copy()
        elements[2] = elements[2, swap]
        bad = Mesh(mesh.nodes, elements, mesh.element_type)
        with pytest.raises(InputError, match=r"element 3 at .*inverted"):
            elasticity.assemble(bad, steel)


def test_unknown_options_are_refused(straight_tetrahedra, steel):
    with pytest.raises(InputError, match="'reduced' is not a formulation of tet10; expected one of 'full'"):
        elasticity.assemble(straight_tetrahedra, steel, formulation="reduced")
    with pytest.raises(InputError, match="'hrz' is not a kind of mass"):
        elasticity.assemble(straight_tetrahedra, steel, mass="hrz")


def test_chunks_do_not_change_the_matrices(straight_tetrahedra, steel, monkeypatch):
    whole = elasticity.assemble(straight_tetrahedra, steel)
    monkeypatch.setattr(elasticity, "_CHUNK", 7)
    parts = elasticity.assemble(straight_tetrahedra, steel)
    assert abs(whole.stiffness - parts.stiffness).max() <= 1e-14 * abs(whole.stiffness).max()
    assert abs(whole.mass - parts.mass).max() <= 1e-14 * abs(whole.mass).max()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((-1.0, 0.3, 7800.0), "young_modulus: -1.0"),
        ((2e11, 0.5, 7800.0), "poisson_ratio: 0.5"),
        ((2e11, 0.3, float("nan")), "density: nan"),
    ],
)
def test_impossible_material_is_refused(values, message):
    with pytest.raises(InputError, match=message):
        Material(*values)


def test_material_names_every_wrong_property_at_once():
    with pytest.raises(InputError, match=r"(?s)young_modulus.*density.*poisson_ratio"):
        Material(-1.0, 0.7, -1.0)


def test_matrices_that_do_not_fit_are_refused(distorted_bricks, steel):
    model = elasticity.assemble(distorted_bricks, steel)
    with pytest.raises(InputError, match="stiffness: matrix of shape"):
        FEModel(nodes=model.nodes[:-1], stiffness=model.stiffness, mass=model.mass)
    with pytest.raises(InputError, match="fixed_nodes"):
        FEModel(nodes=model.nodes, stiffness=model.stiffness, mass=model.mass, fixed_nodes=np.array([64]))


def test_thin_block_stretches_as_a_rod(steel):
    """Uniaxial stress on a free bar: end displacement F L / (E A), lateral contraction nu."""
    mesh = mesh_blocks([Box("rod", (0, 0, 0), (1, 0.1, 0.1))], size=0.1)
    K = elasticity.stiffness_matrix(mesh, steel)
    strain = 1e-3
    u = mesh.nodes * strain * np.array([1.0, -steel.poisson_ratio, -steel.poisson_ratio])
    forces = (K @ u.ravel()).reshape(-1, 3)
    ends = [forces[np.isclose(mesh.nodes[:, 0], x)].sum(axis=0) for x in (0.0, 1.0)]
    axial = steel.young_modulus * strain * 0.01
    np.testing.assert_allclose(ends, [[-axial, 0, 0], [axial, 0, 0]], atol=1e-9 * axial)
    interior = np.isclose(mesh.nodes[:, 0] * (1 - mesh.nodes[:, 0]), 0)
    np.testing.assert_allclose(forces[~interior], 0.0, atol=1e-9 * axial)


def test_two_materials_in_a_row_stretch_as_springs_in_series():
    """Two cubes of different materials, nu = 0, pulled along x: springs of E A / L one behind the other."""
    mesh = mesh_blocks(
        [Box("bar", (0, 0, 0), (2, 1, 1))], element_type="hex8", divisions={"x": [2], "y": [1], "z": [1]}
    )
    materials = [Material(2e11, 0.0, 7850.0), Material(7e10, 0.0, 2700.0)]
    first = mesh.nodes[mesh.elements].mean(axis=1)[:, 0] < 1.0
    model = elasticity.assemble_several(mesh, materials, np.where(first, 0, 1))
    assert model.total_mass == pytest.approx(7850.0 + 2700.0, rel=1e-12)
    assert model.material is None
    x = mesh.nodes[:, 0]
    held = np.repeat((x == 0.0) | (x == 2.0), 3)
    u = np.zeros(3 * len(x))
    u[0::3] = 1e-3 * (x == 2.0)
    K = model.stiffness.tocsc()
    u[~held] = spsolve(K[~held][:, ~held], -K[~held][:, held] @ u[held])
    force = (model.stiffness @ u)[0::3][x == 2.0].sum()
    assert force == pytest.approx(1e-3 / (1 / 2e11 + 1 / 7e10), rel=1e-10)
    alike = elasticity.assemble_several(mesh, [materials[0]] * 2, np.where(first, 0, 1))
    one = elasticity.assemble(mesh, materials[0])
    assert abs(alike.stiffness - one.stiffness).max() <= 1e-12 * abs(one.stiffness).max()
