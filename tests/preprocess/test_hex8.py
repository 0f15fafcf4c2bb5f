"""Bricks: the published element entry by entry, exact bending, invariance."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.finite_elements import elasticity
from heavylift.preprocess.finite_elements.elasticity import (
    HOURGLASS_COEFFICIENT,
    HOURGLASS_VECTORS,
    brick_stiffness,
)
from heavylift.preprocess.finite_elements.mesh import Mesh
from heavylift.preprocess.finite_elements.reference_elements import REFERENCE_NODES

EDGES = np.array([0.7, 1.3, 0.4])


def _brick(edges=EDGES):
    return 0.5 * REFERENCE_NODES["hex8"] * edges


def test_reduced_brick_is_the_published_one_entry_by_entry(mbsim_data, complex_beam, thesis_mesh, steel):
    """The stored matrix of the complex beam was made by ABAQUS with C3D8R bricks."""
    folder = mbsim_data / "complex_beam"
    stored_nodes = 1e-3 * np.loadtxt(folder / "u0.dat")
    # connectivity is not stored; nodes are matched by their places, which carry single-precision noise
    distance = np.abs(stored_nodes[:, None] - thesis_mesh.nodes[None]).max(axis=2)
    ours_of = distance.argmin(axis=1)
    assert distance.min(axis=1).max() < 1e-8
    assert len(set(ours_of)) == 374
    # the stored positions, rounded as they are, in place of the exact ones
    nodes = np.empty_like(stored_nodes)
    nodes[ours_of] = stored_nodes
    mesh = Mesh(nodes, thesis_mesh.elements, "hex8")

    text = (folder / "stiffnessMatrix.dat").read_text().replace(",", " ")
    i, a, j, b, value = np.array(text.split(), dtype=float).reshape(-1, 5).T
    rows = 3 * ours_of[i.astype(int) - 1] + a.astype(int) - 1
    columns = 3 * ours_of[j.astype(int) - 1] + b.astype(int) - 1
    free = value < 1e30
    assert (~free).sum() == 45
    K = elasticity.stiffness_matrix(mesh, steel, formulation="reduced").toarray()
    difference = np.abs(K[rows, columns][free] - 1e-3 * value[free])
    assert difference.max() <= 1e-13 * np.abs(K).max()
    # nothing of ours is missing in the file either
    listed = np.zeros(K.shape, dtype=bool)
    listed[rows, columns] = listed[columns, rows] = True
    assert np.abs(K[~listed]).max(initial=0.0) <= 1e-10 * np.abs(K).max()

    masses = elasticity.mass_matrix(mesh, steel.density, kind="lumped").diagonal()
    np.testing.assert_allclose(masses[ours_of], 1e-9 * np.loadtxt(folder / "mij.dat"), rtol=1e-7)


def test_hourglass_energy_of_a_rectangular_brick(steel):
    """Each +-1 pattern in direction d costs kappa G V / h_d^2 * 64, and nothing else does (per pattern)."""
    (K,) = brick_stiffness(_brick()[None], steel, formulation="reduced")
    for direction in range(3):
        for gamma in HOURGLASS_VECTORS:
            u = np.zeros((8, 3))
            u[:, direction] = gamma
            energy = u.ravel() @ K @ u.ravel()
            scale = HOURGLASS_COEFFICIENT * steel.shear_modulus * EDGES.prod() / EDGES[direction] ** 2
            assert energy == pytest.approx(64 * scale, rel=1e-9)


def test_pure_bending_of_one_incompatible_brick_is_exact(steel):
    """Energy E I kappa^2 L of a rectangular bar in pure bending, anticlastic curvature included."""
    (K,) = brick_stiffness(_brick()[None], steel, formulation="incompatible")
    nu, curvature = steel.poisson_ratio, 0.01
    x, y, z = _brick().T
    # Timoshenko, Goodier, Theory of Elasticity, art. 102
    u = curvature * np.column_stack([x * y, -0.5 * (x**2 + nu * (y**2 - z**2)), -nu * y * z])
    length, height, width = EDGES
    exact = steel.young_modulus * width * height**3 / 12 * curvature**2 * length
    assert u.ravel() @ K @ u.ravel() == pytest.approx(exact, rel=1e-12)


def test_one_point_is_nearly_limp_in_bending_and_full_integration_locks(steel):
    """The three energies of u_x = kappa x y: hourglass stiffness only, exact, and with parasitic shear."""
    curvature = 0.01
    x, y, _ = _brick().T
    u = np.zeros((8, 3))
    u[:, 0] = curvature * x * y
    (exact,) = brick_stiffness(_brick()[None], steel, formulation="incompatible")
    (reduced,) = brick_stiffness(_brick()[None], steel, formulation="reduced")
    mesh = Mesh(_brick(), np.arange(8)[None], "hex8")
    full = elasticity.stiffness_matrix(mesh, steel, formulation="full").toarray()
    limp, right, locked = (u.ravel() @ K @ u.ravel() for K in (reduced, exact, full))
    assert limp < 0.01 * right
    assert locked > 1.1 * right


@pytest.mark.parametrize("formulation", ["incompatible", "reduced"])
def test_stiffness_turns_with_a_distorted_brick(formulation, steel):
    corners = _brick() + np.random.default_rng(4).uniform(-0.05, 0.05, (8, 3))
    R = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    (K,) = brick_stiffness(corners[None], steel, formulation=formulation)
    (turned,) = brick_stiffness((corners @ R.T)[None], steel, formulation=formulation)
    T = np.kron(np.eye(8), R)
    np.testing.assert_allclose(turned, T @ K @ T.T, atol=1e-12 * np.abs(K).max())


@pytest.mark.parametrize("formulation", ["incompatible", "reduced"])
def test_numbering_of_the_corners_does_not_matter(formulation, steel):
    corners = _brick() + np.random.default_rng(5).uniform(-0.05, 0.05, (8, 3))
    # turned by 120 degrees about the diagonal through corners 0 and 6
    order = [0, 3, 7, 4, 1, 2, 6, 5]
    (K,) = brick_stiffness(corners[None], steel, formulation=formulation)
    (other,) = brick_stiffness(corners[order][None], steel, formulation=formulation)
    back = np.argsort(order)
    permuted = other.reshape(8, 3, 8, 3)[back][:, :, back].reshape(24, 24)
    np.testing.assert_allclose(permuted, K, atol=1e-12 * np.abs(K).max())


def test_bad_bricks_are_refused(steel):
    with pytest.raises(InputError, match="'full' is not a formulation of bricks"):
        brick_stiffness(_brick()[None], steel, formulation="full")
    with pytest.raises(InputError, match="determinant is not positive"):
        brick_stiffness(_brick()[None, [4, 5, 6, 7, 0, 1, 2, 3]], steel, formulation="reduced")
