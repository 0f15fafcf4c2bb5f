"""Small blocks against numpy."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.small import (
    aligned,
    cholesky_factor,
    cholesky_invert,
    cholesky_solve,
    solve_symmetric_3,
)
from heavylift.numerics.vectors import cross, rotate, rotate_back

RNG = np.random.default_rng(7)


def positive_definite(n: int, condition: float = 100.0) -> np.ndarray:
    """Random matrix with a known condition number."""
    Q = np.linalg.qr(RNG.normal(size=(n, n)))[0]
    return Q * np.geomspace(1.0, condition, n) @ Q.T


def test_products_of_vectors_and_matrices() -> None:
    a, b, R = RNG.normal(size=3), RNG.normal(size=3), RNG.normal(size=(3, 3))
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), rtol=1e-14)
    np.testing.assert_allclose(rotate(R.ravel(), b), R @ b, rtol=1e-14)
    np.testing.assert_allclose(rotate_back(R.ravel(), b), R.T @ b, rtol=1e-14)


@pytest.mark.parametrize("condition", [1.0, 1e4, 1e8])
def test_symmetric_3x3(condition: float) -> None:
    for _ in range(10):
        A, b = positive_definite(3, condition), RNG.normal(size=3)
        x = solve_symmetric_3(A[0, 0], A[1, 1], A[2, 2], A[0, 1], A[0, 2], A[1, 2], *b)
        np.testing.assert_allclose(x, np.linalg.solve(A, b), rtol=1e-14 * condition)


@pytest.mark.parametrize(
    "matrix", [(0.0, 1.0, 1.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0, 0.0, 0.0)], ids=["pivot 1", "pivot 2"]
)
def test_singular_3x3_is_not_finite(matrix: tuple[float, ...]) -> None:
    with np.errstate(all="ignore"):
        x = solve_symmetric_3(*map(np.float64, (*matrix, 1.0, 2.0, 3.0)))
    assert not np.all(np.isfinite(x))


@pytest.mark.parametrize("n", [1, 2, 6, 13])
def test_cholesky(n: int) -> None:
    A, b = positive_definite(n), RNG.normal(size=n)
    factor = np.tril(A).ravel()  # only the lower triangle is read
    x = b.copy()
    cholesky_factor(factor, n)
    cholesky_solve(factor, x, n)
    L = np.tril(factor.reshape(n, n))
    np.fill_diagonal(L, 1.0 / np.diag(L))
    np.testing.assert_allclose(L, np.linalg.cholesky(A), rtol=1e-12)
    np.testing.assert_allclose(x, np.linalg.solve(A, b), rtol=1e-11)
    cholesky_invert(factor, n)
    np.testing.assert_allclose(factor.reshape(n, n), np.linalg.inv(A), rtol=1e-11, atol=1e-13)


def test_cholesky_of_an_indefinite_matrix_shows() -> None:
    A = np.diag([1.0, -1.0, 1.0])
    factor, x = A.ravel().copy(), np.ones(3)
    with np.errstate(invalid="ignore"):
        try:
            cholesky_factor(factor, 3)
            cholesky_solve(factor, x, 3)
        except ValueError:  # interpreted, math.sqrt raises
            return
    assert not np.all(np.isfinite(x))


@pytest.mark.parametrize("shape", [5, (3, 7), (600, 1000)])
def test_aligned_arrays_are_zeros_that_begin_at_a_cache_line(shape: int | tuple[int, ...]) -> None:
    arrays = [aligned(shape) for _ in range(3)]  # kept, so that they lie apart
    for array in arrays:
        assert array.shape == np.zeros(shape).shape
        assert array.dtype == np.float64
        assert array.flags.c_contiguous
        assert array.flags.writeable
        assert array.ctypes.data % 64 == 0
        assert not array.any()
        array[...] = 1.0
    del arrays[1:]  # gives their memory back, not that of the first
    assert np.all(arrays[0] == 1.0)
