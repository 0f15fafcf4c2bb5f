"""Block Lanczos on operators with known eigenvalues."""

from __future__ import annotations

import numpy as np

from heavylift.modal.lanczos import block_lanczos


def run(eigenvalues, weights, count, width=4, limit=200):
    """Iterate on A = M^-1/2 diag M^1/2-like operators, self-adjoint in diag(weights)."""
    n = len(eigenvalues)
    rng = np.random.default_rng(3)
    Q = np.linalg.qr(rng.standard_normal((n, n)))[0]
    root = np.sqrt(weights)
    A = (Q * eigenvalues) @ Q.T / root[:, None] * root
    return A, block_lanczos(
        lambda x: A @ x,
        lambda x: weights[:, None] * x,
        rng.standard_normal((n, width)),
        count,
        tolerance=1e-9,
        limit=limit,
    )


def test_finds_multiple_eigenvalues_and_their_vectors():
    eigenvalues = np.concatenate([[9.0, 9.0, 9.0, 5.0, 5.0, 2.0], 1.0 / np.arange(1, 195)])
    weights = np.random.default_rng(4).uniform(0.1, 10.0, 200)
    A, pairs = run(eigenvalues, weights, 7)
    assert pairs.converged
    np.testing.assert_allclose(pairs.values, [9, 9, 9, 5, 5, 2, 1], rtol=1e-13)
    np.testing.assert_allclose(A @ pairs.vectors, pairs.vectors * pairs.values, atol=1e-7)
    np.testing.assert_allclose(pairs.vectors.T @ (weights[:, None] * pairs.vectors), np.eye(7), atol=1e-12)


def test_stops_in_an_invariant_subspace():
    _, pairs = run(np.concatenate([[3.0, 2.0, 1.0], np.zeros(57)]), np.ones(60), 3)
    assert pairs.converged
    np.testing.assert_allclose(pairs.values, [3, 2, 1], rtol=1e-13)
    assert pairs.dimension < 20


def test_says_when_the_space_is_too_small():
    _, pairs = run(np.linspace(1.0, 1.1, 150), np.ones(150), 20, limit=30)
    assert not pairs.converged
    assert pairs.errors.max() > 1e-9
