"""Natural frequencies against theory, rigid modes, accuracy, bad requests."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array

import heavylift.modal.eigen as eigen_module
from heavylift.modal.eigen import Modes, ModesNotConvergedError, eigenmodes, signed
from heavylift.modal.factor import available_backends
from heavylift.modal.flexibility import Flexibility, apply_mass, rigid_motions
from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements.blocks import Box, mesh_blocks
from heavylift.preprocess.finite_elements.elasticity import assemble
from heavylift.preprocess.finite_elements.groups import OnPlane
from heavylift.preprocess.finite_elements.model import FEModel, Material


@pytest.fixture(scope="module")
def slender():
    """Rod 2 m x 40 mm x 20 mm without lateral contraction, one brick across, consistent mass."""
    mesh = mesh_blocks(
        [Box("rod", (0, 0, 0), (2.0, 0.04, 0.02))],
        element_type="hex8",
        divisions={"x": (80,), "y": (2,), "z": (2,)},
        groups=(OnPlane("clamp", "x", 0.0),),
    )
    return assemble(mesh, Material(2.1e11, 0.0, 7850.0), mass="consistent")


def axial(model, modes: Modes):
    """Frequencies of the modes that move along x more than across."""
    share = np.sum(modes.shapes.reshape(model.node_count, 3, -1) ** 2, axis=0)
    return modes.frequencies[share[0] > share[1] + share[2]]


def test_axial_modes_of_a_rod(slender):
    c = np.sqrt(2.1e11 / 7850.0)
    clamped = axial(slender, eigenmodes(slender, 30, fixed_nodes=slender.node_groups["clamp"]))
    free = axial(slender, eigenmodes(slender, 30))
    # linear elements with consistent mass overestimate by (k h)^2 / 24
    np.testing.assert_allclose(clamped[:2], c / 2.0 * np.array([0.25, 0.75]), rtol=4e-4)
    np.testing.assert_allclose(free[0], c / 4.0, rtol=2e-4)
    assert clamped[0] > c / 8.0


def test_bending_modes_of_a_slender_beam(slender):
    # Euler-Bernoulli; shear and rotary inertia lower these by less than (h k)^2
    for fixed, roots, count in (
        (slender.node_groups["clamp"], [1.875104069, 4.694091133], 3),
        ((), [4.730040745, 7.853204624], 3),
    ):
        modes = eigenmodes(slender, count, fixed_nodes=fixed)
        expected = []
        for h in (0.04, 0.02):
            EI_per_mass = 2.1e11 * h**2 / 12.0 / 7850.0
            expected += [(root / 2.0) ** 2 * np.sqrt(EI_per_mass) / (2 * np.pi) for root in roots]
        np.testing.assert_allclose(modes.frequencies, np.sort(expected)[:count], rtol=0.004)


def test_modes_agree_with_the_dense_solution(any_beam, dense):
    for fixed in (any_beam.node_groups["clamp"], np.array([], dtype=int)):
        matrices = dense(any_beam, fixed)
        reference = eigh(matrices.K_free, matrices.M_free, eigvals_only=True, driver="gv")
        rigid = 0 if len(fixed) else 6
        modes = eigenmodes(any_beam, 12, fixed_nodes=fixed)
        assert modes.rigid_count == rigid
        np.testing.assert_allclose(modes.eigenvalues, reference[rigid : rigid + 12], rtol=1e-8)
        M, K = matrices.M, matrices.K
        np.testing.assert_allclose(modes.shapes.T @ M @ modes.shapes, np.eye(12), atol=1e-12)
        energy = modes.shapes.T @ K @ modes.shapes
        np.testing.assert_allclose(energy, np.diag(modes.eigenvalues), atol=1e-8 * modes.eigenvalues[-1])
        assert modes.orthogonality < 1e-12
        assert np.all(modes.residuals < 1e-5)
        held = (3 * fixed[:, None] + np.arange(3)).ravel()
        assert np.all(modes.shapes[held] == 0.0)


def test_free_modes_carry_no_momentum(any_beam):
    modes = eigenmodes(any_beam, 8)
    motions = rigid_motions(any_beam.nodes)
    momentum = motions.T @ apply_mass(any_beam.mass, modes.shapes)
    assert modes.rigid_count == 6
    assert np.abs(momentum).max() < 1e-12 * np.sqrt(any_beam.total_mass)


@pytest.mark.parametrize(("nodes_held", "expected"), [(0, 6), (1, 3), (2, 1), (3, 0)])
def test_supports_leave_the_rigid_motions_of_mechanics(brick_beam, nodes_held, expected):
    corners = [
        int(np.argmin(np.sum((brick_beam.nodes - corner) ** 2, axis=1)))
        for corner in ([0, 0, 0], [1, 0, 0], [0.5, 0.1, 0.06])
    ]
    body = Flexibility(brick_beam, corners[:nodes_held])
    assert body.rigid_count == expected
    modes = eigenmodes(brick_beam, 3, flexibility=body)
    assert modes.eigenvalues[0] > 1e3
    assert modes.residuals.max() < 1e-5


def test_an_elastic_support_is_no_rigid_motion(brick_beam):
    n = brick_beam.node_count
    springs = np.zeros(3 * n)
    springs[1::3] = 1e6 * brick_beam.mass.diagonal()  # an elastic foundation with 1000 rad/s along y
    model = FEModel(
        brick_beam.nodes,
        csr_array(brick_beam.stiffness + csr_array((springs, (range(3 * n),) * 2))),
        brick_beam.mass,
    )
    modes = eigenmodes(model, 3)
    # left free: translations along x and z, rotation about y; translation along y is an exact mode
    assert modes.rigid_count == 3
    assert np.abs(np.sqrt(modes.eigenvalues) - 1000.0).min() < 1e-4


def test_dense_and_iterative_paths_agree(brick_beam, monkeypatch):
    first = eigenmodes(brick_beam, 9)
    monkeypatch.setattr(eigen_module, "_DENSE_UNKNOWNS", 10_000)
    second = eigenmodes(brick_beam, 9)
    assert second.backend == "dense"
    assert first.backend != "dense"
    np.testing.assert_allclose(first.eigenvalues, second.eigenvalues, rtol=1e-10)
    np.testing.assert_allclose(
        np.abs(np.sum(first.shapes * apply_mass(brick_beam.mass, second.shapes), axis=0)), 1.0
    )


@pytest.mark.parametrize("backend", available_backends())
def test_all_backends_find_the_same_modes(tet_beam, backend):
    fixed = tet_beam.node_groups["clamp"]
    reference = eigenmodes(tet_beam, 10, fixed_nodes=fixed, backend="superlu")
    modes = eigenmodes(tet_beam, 10, fixed_nodes=fixed, backend=backend)
    assert modes.backend == backend
    np.testing.assert_allclose(modes.eigenvalues, reference.eigenvalues, rtol=1e-9)
    np.testing.assert_allclose(modes.shapes, reference.shapes, atol=1e-6 * np.abs(reference.shapes).max())


def test_double_eigenvalues_of_a_square_beam():
    mesh = mesh_blocks([Box("b", (0, 0, 0), (1, 0.1, 0.1))], element_type="hex8", size=0.05)
    model = assemble(mesh, Material(2.1e11, 0.3, 7850.0), mass="lumped")
    modes = eigenmodes(model, 4)
    assert modes.eigenvalues[0] == pytest.approx(modes.eigenvalues[1], rel=1e-11)
    assert modes.eigenvalues[2] > 1.5 * modes.eigenvalues[1]


def test_the_same_request_gives_the_same_bits_and_signs(tet_beam):
    modes = [eigenmodes(tet_beam, 5) for _ in range(2)]
    assert np.array_equal(modes[0].shapes, modes[1].shapes)
    shapes = modes[0].shapes
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(5)]
    assert np.all(largest > 0.0) or np.all(
        np.abs(shapes.max(axis=0)) > (1 - 1e-6) * np.abs(shapes).max(axis=0)
    )


def test_sign_is_that_of_the_first_of_equal_components():
    shape = np.array([[0.1], [-2.0], [2.0 * (1 + 1e-9)]])
    np.testing.assert_array_equal(signed(shape), -shape)


def test_massless_nodes_have_no_modes():
    # chain of three axial springs; the middle masses are zero: static condensation gives k/3
    n, k, m = 4, 9.0, 2.0
    K = np.zeros((12, 12))
    for j in range(3):
        for axis in range(3):
            a, b = 3 * j + axis, 3 * j + 3 + axis
            K[np.ix_([a, b], [a, b])] += k * np.array([[1, -1], [-1, 1]])
    mass = np.diag([0.0, 0.0, 0.0, m])
    model = FEModel(np.arange(12.0).reshape(n, 3) ** 2, csr_array(K), csr_array(mass), name="chain")
    modes = eigenmodes(model, 3, fixed_nodes=[0])
    np.testing.assert_allclose(modes.eigenvalues, k / 3 / m, rtol=1e-12)
    with pytest.raises(InputError, match=r"4 modes requested; expected at most 3.*have mass"):
        eigenmodes(model, 4, fixed_nodes=[0])


def test_requests_beyond_the_model_are_refused(brick_beam):
    free = 3 * (brick_beam.node_count - len(brick_beam.node_groups["clamp"]))
    with pytest.raises(InputError, match=f"100000 modes requested; expected 1 to {free}"):
        eigenmodes(brick_beam, 100_000, fixed_nodes=brick_beam.node_groups["clamp"])
    with pytest.raises(InputError, match=f"0 modes requested; expected 1 to {3 * brick_beam.node_count - 6}"):
        eigenmodes(brick_beam, 0)
    with pytest.raises(InputError, match="node 99999 does not exist"):
        eigenmodes(brick_beam, 3, fixed_nodes=[99999])
    with pytest.raises(InputError, match="nodes are clamped; expected at least one free node"):
        eigenmodes(brick_beam, 3, fixed_nodes=np.arange(brick_beam.node_count))


def test_inaccurate_modes_are_not_returned(brick_beam, monkeypatch):
    monkeypatch.setattr(eigen_module, "RESIDUAL_LIMIT", 1e-20)
    with pytest.raises(ModesNotConvergedError, match="largest relative residual") as caught:
        eigenmodes(brick_beam, 3)
    assert caught.value.residuals.shape == (3,)
    assert caught.value.orthogonality < 1e-12


def test_a_krylov_space_that_is_too_small_is_reported(brick_beam, monkeypatch):
    monkeypatch.setattr(eigen_module, "_KRYLOV_TOLERANCE", 0.0)
    with pytest.raises(ModesNotConvergedError, match="did not converge in a Krylov space"):
        eigenmodes(brick_beam, 2)


def test_few_modes_of_a_thin_strip_of_plates_converge_as_shapes():
    """Eigenvalues converge twice as fast as shapes, so that a small count may end with shapes that are not accurate."""
    from heavylift.preprocess.finite_elements.model import Material
    from heavylift.preprocess.structures.assemble import assemble_structure
    from heavylift.preprocess.structures.panels import Plate, mesh_panels, repeated

    steel = Material(210e9, 0.0, 7850.0)
    strip = Plate("strip", steel, 0.01, repeated([[0, 0, 0], [2, 0, 0], [2, 0.1, 0], [0, 0.1, 0]]))
    model = assemble_structure(mesh_panels([strip], size=0.05))
    root = np.flatnonzero(model.nodes[:, 0] < 1e-9)
    first, second = np.array([1.87510407, 4.69409113]) ** 2 * np.sqrt(210e9 * 0.01**2 / 12 / 7850.0 / 2.0**4)
    for count in (1, 2, 3):
        modes = eigenmodes(model, count, fixed_nodes=root)
        assert modes.residuals.max() < 1e-5
        # two of bending across the plate, and one in its plane
        wanted = np.array([first, second, 10.0 * first])[:count]
        np.testing.assert_allclose(np.sqrt(modes.eigenvalues), wanted, rtol=5e-3)
