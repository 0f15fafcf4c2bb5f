"""Every installed factorisation solves the same equations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, random_array

from heavylift.modal.factor import BACKENDS, NotPositiveDefiniteError, available_backends, factorise
from heavylift.modal.flexibility import Flexibility
from heavylift.numerics.outcome import InputError

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

backends = pytest.mark.parametrize("backend", available_backends())


def random_spd(size):
    """Irregular graph without any geometry; strictly diagonally dominant."""
    A = random_array((size, size), density=min(1.0, 3.0 / size), rng=np.random.default_rng(size))
    A = A + A.T
    return csr_array(A + csr_array(np.diag(A.sum(axis=1) + 0.1)))


@backends
@pytest.mark.parametrize("size", [1, 7, 200, 601])
def test_solution_of_irregular_matrix(backend, size):
    A = random_spd(size)
    rhs = np.random.default_rng(1).standard_normal((size, 5))
    factor = factorise(A, backend=backend)
    assert factor.backend == backend
    expected = np.linalg.solve(A.toarray(), rhs)
    np.testing.assert_allclose(factor.solve(rhs), expected, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(factor.solve(rhs[:, 2]), expected[:, 2], rtol=1e-10, atol=1e-12)


@backends
def test_solution_of_a_body(backend, tet_beam, dense):
    fixed = tet_beam.node_groups["clamp"]
    matrices = dense(tet_beam, fixed)
    rhs = np.random.default_rng(2).standard_normal((len(matrices.rows), 3))
    free = np.setdiff1d(np.arange(tet_beam.node_count), fixed)
    K = tet_beam.stiffness[matrices.rows][:, matrices.rows]
    for coordinates in (None, tet_beam.nodes[free]):
        x = factorise(K, backend=backend, coordinates=coordinates).solve(rhs)
        np.testing.assert_allclose(matrices.K_free @ x, rhs, atol=1e-9)


@backends
def test_right_hand_side_is_left_alone_and_empty_is_fine(backend):
    A = random_spd(30)
    rhs = np.ones((30, 2))
    factor = factorise(A, backend=backend)
    factor.solve(rhs)
    assert np.all(rhs == 1.0)
    with pytest.raises(InputError, match=r"shape \(29,\)"):
        factor.solve(np.ones(29))


def test_indefinite_and_singular_matrices_are_refused():
    A = random_spd(60)
    with pytest.raises(NotPositiveDefiniteError):
        factorise(csr_array(A - csr_array(5.0 * np.eye(60))))
    line = csr_array(np.diag([1.0] + [2.0] * 58 + [1.0]) - np.eye(60, k=1) - np.eye(60, k=-1))  # a free chain
    with pytest.raises(NotPositiveDefiniteError):
        factorise(line)


def test_bad_arguments_are_named():
    A = random_spd(9)
    with pytest.raises(InputError, match=r"'mumps' is unknown.*multifrontal"):
        factorise(A, backend="mumps")
    with pytest.raises(InputError, match=r"9.*with 2 positions"):
        factorise(A, coordinates=np.zeros((2, 3)))
    for missing in set(BACKENDS) - set(available_backends()):
        with pytest.raises(InputError, match=f"{missing}.*not installed"):
            factorise(A, backend=missing)


def test_entries_of_a_dense_matrix():
    A = np.ones((12, 12)) + 12.0 * np.eye(12)
    assert factorise(csr_array(A)).entries == 12 * 13 // 2


def test_flexibility_names_a_mechanism(brick_beam):
    # the stiffness of two bodies that are not joined has twelve rigid motions
    from scipy.sparse import block_diag

    from heavylift.preprocess.finite_elements.model import FEModel

    twice = FEModel(
        nodes=np.vstack([brick_beam.nodes, brick_beam.nodes + np.array([0.0, 1.0, 0.0])]),
        stiffness=csr_array(block_diag([brick_beam.stiffness] * 2, format="csr")),
        mass=csr_array(block_diag([brick_beam.mass] * 2, format="csr")),
        name="two beams",
    )
    with pytest.raises(InputError, match=r"two beams: stiffness.*not positive definite.*mechanisms"):
        Flexibility(twice)
