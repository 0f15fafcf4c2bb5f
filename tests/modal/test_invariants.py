"""Shape integrals against sums over nodes and against dense bilinear forms."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.modal.invariants import shape_integrals
from heavylift.numerics.outcome import InputError


@pytest.fixture
def shapes(any_beam):
    # more shapes than one block holds
    return np.random.default_rng(5).standard_normal((19, any_beam.node_count, 3))


def test_lumped_mass_is_a_sum_over_nodes(brick_beam):
    m = brick_beam.mass.diagonal()
    r = brick_beam.nodes - [0.3, -0.2, 0.1]
    phi = np.random.default_rng(6).standard_normal((3, len(m), 3))
    first, S = np.zeros(3), np.zeros((3, 3))
    I_kl, Ibar, S_kl = np.zeros((3, 3)), np.zeros((3, 3, 3)), np.zeros((3, 3, 3, 3))
    for j in range(len(m)):  # "Deformable bodies ... sliding contacts" (2014), eqs. 2.58-2.68
        first += m[j] * r[j]
        S += m[j] * phi[:, j].T
        I_kl += m[j] * np.outer(r[j], r[j])
        for a in range(3):
            Ibar[:, :, a] += m[j] * np.outer(r[j], phi[a, j])
            for b in range(3):
                S_kl[:, :, a, b] += m[j] * np.outer(phi[a, j], phi[b, j])
    result = shape_integrals(r, phi, brick_beam.mass)
    assert result.mass == pytest.approx(m.sum(), rel=1e-14)
    for value, expected in zip(result[1:], (first, S, I_kl, Ibar, S_kl), strict=True):
        np.testing.assert_allclose(value, expected, rtol=1e-11, atol=1e-13 * np.abs(expected).max())


def test_dense_bilinear_forms(any_beam, shapes):
    M, x = any_beam.mass.toarray(), any_beam.nodes
    result = shape_integrals(x, shapes, any_beam.mass)
    one = np.ones(len(x))
    for k in range(3):
        assert result.first_moment[k] == pytest.approx(one @ M @ x[:, k], rel=1e-12)
        np.testing.assert_allclose(result.modal_translation[k], one @ M @ shapes[:, :, k].T, atol=1e-11)
        for l in range(3):
            assert result.inertia_kl[k, l] == pytest.approx(x[:, k] @ M @ x[:, l], rel=1e-12)
            np.testing.assert_allclose(
                result.position_mode[k, l], x[:, k] @ M @ shapes[:, :, l].T, atol=1e-11
            )
            np.testing.assert_allclose(
                result.mode_mode[k, l], shapes[:, :, k] @ M @ shapes[:, :, l].T, atol=1e-10
            )


def test_box_has_the_mass_moments_of_a_box(tet_beam):
    # consistent mass of straight elements: exact second moments, int rho x_k x_l dV
    result = shape_integrals(tet_beam.nodes, np.zeros((0, tet_beam.node_count, 3)), tet_beam.mass)
    a = np.array([1.0, 0.1, 0.06])
    m = 7850.0 * a.prod()
    assert result.mass == pytest.approx(m, rel=1e-12)
    np.testing.assert_allclose(result.first_moment, m * a / 2, rtol=1e-12)
    np.testing.assert_allclose(result.inertia_kl, m * (np.outer(a, a) / 4 + np.diag(a**2) / 12), rtol=1e-11)
    assert result.mode_mode.shape == (3, 3, 0, 0)


def test_arrays_must_fit(brick_beam):
    with pytest.raises(InputError, match="do not fit"):
        shape_integrals(brick_beam.nodes[1:], np.zeros((1, brick_beam.node_count, 3)), brick_beam.mass)
