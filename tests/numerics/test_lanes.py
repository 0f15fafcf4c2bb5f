"""Vector-register blocks against plain NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics import lanes
from heavylift.numerics.jit import kernel

RNG = np.random.default_rng(5)
OFFSET = 3


def padded(matrix: np.ndarray, lane_count: int) -> np.ndarray:
    """Flat array of a matrix whose rows are filled up with numbers that must not matter."""
    rows, columns = matrix.shape
    full = RNG.normal(size=(rows, lane_count))
    full[:, :columns] = matrix
    return full.ravel()


@pytest.fixture(params=[1, 2, 3, 4, 5, 6])
def size(request):
    return request.param


@kernel
def factor_two(shape, A, B, C, scratch):
    lanes.factor_pivot(shape, A, 0)
    lanes.solve_off_diagonal(shape, B, 0, A, 0)
    lanes.scale_block(shape, scratch, 0, B, 0, A, 0)
    lanes.subtract_products(shape, C, 0, scratch, 0, B, 0, 1)
    lanes.factor_pivot(shape, C, 0)


@kernel
def solve_two(shape, A, B, C, x, y):
    lanes.forward_pivot(shape, x, 0, A, 0)
    lanes.subtract_forward(shape, y, 0, B, 0, x, 0)
    lanes.forward_pivot(shape, y, 0, C, 0)
    lanes.backward_pivot(shape, y, 0, C, 0)
    lanes.subtract_backward(shape, x, 0, B, 0, A, 0, y, 0)
    lanes.backward_pivot(shape, x, 0, A, 0)


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["definite", "quasi-definite"])
def test_two_blocks_solve_like_numpy(size, sign):
    """A block L D L^T, with a negative definite second pivot as that of a hub as well."""
    shape = lanes.block_shape(size)
    lane_count = len(shape[1])
    root = RNG.normal(size=(size, size))
    first = root @ root.T + np.eye(size)
    root = RNG.normal(size=(size, size))
    second = sign * (root @ root.T + 40.0 * size * np.eye(size))
    coupling = RNG.normal(size=(size, size))  # rows of the second node, columns of the first
    matrix = np.block([[first, coupling.T], [coupling, second]])
    right = RNG.normal(size=2 * size)

    A, B, C = padded(first, lane_count), padded(coupling.T, lane_count), padded(second, lane_count)
    x = padded(right[None, :size], lane_count)
    y = padded(right[None, size:], lane_count)
    factor_two(shape, A, B, C, np.empty(size * lane_count))
    solve_two(shape, A, B, C, x, y)

    expected = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(np.r_[x[:size], y[:size]], expected, rtol=1e-11, atol=1e-12)


@kernel
def products(shape, T, F, G, D, u, P, r):
    lanes.put_rigid_product(shape, T, 0, F, 0, G, 0, D, 0)
    lanes.add_rigid_product(shape, T, 0, F, 0, G, 0, D, 0)
    lanes.add_outer_product(shape, T, 0, F, 0, G, 0)
    lanes.add_rigid_dots(shape, u, 0, G, 0, P, 0, D, 0)
    lanes.subtract_rigid_rows(shape, r, 0, G, 0, u, 0)


def test_products_over_the_coordinates_of_a_body(size):
    shape = lanes.block_shape(size)
    lane_count = len(shape[1])
    F, G = RNG.normal(size=(2, 6, size))
    D, u, P, r = RNG.normal(size=6), RNG.normal(size=6), RNG.normal(size=size), RNG.normal(size=size)
    T = padded(np.zeros((size, size)), lane_count)
    moved, rates = u.copy(), padded(r[None], lane_count)

    products(
        shape, T, padded(F, lane_count), padded(G, lane_count), D, moved, padded(P[None], lane_count), rates
    )

    expected = 2.0 * F.T @ np.diag(D) @ G + np.outer(F[0], G[0])
    np.testing.assert_allclose(T.reshape(size, lane_count)[:, :size], expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(moved, u + D * (G @ P), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(rates[:size], r - G.T @ moved, rtol=1e-12, atol=1e-12)


@kernel
def six_rows(shape, X, B, at, G, size):
    lanes.put_six_rows(shape, X, 0, B, at, G, 0, size)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("shape", [lanes.LANES_1, lanes.LANES_2, lanes.LANES_4, lanes.LANES_8])
def test_rows_of_bodies_that_move_together(shape, count):
    """A symmetric matrix of one or two bodies times a panel, six rows at a time."""
    lane_count, n = len(shape[1]), 6 * count
    root, G = RNG.normal(size=(n, n)), RNG.normal(size=(n, lane_count))
    B, X = root + root.T, np.full((n, lane_count), np.nan)
    for first in range(0, n, 6):
        part = np.empty(6 * lane_count)
        six_rows(shape, part, B.ravel(), first, G.ravel(), n)
        X[first : first + 6] = part.reshape(6, lane_count)
    np.testing.assert_allclose(X, B @ G, atol=1e-13)


def test_shape_has_a_power_of_two_lanes():
    assert [len(shape[1]) for shape in (lanes.LANES_1, lanes.LANES_2, lanes.LANES_4, lanes.LANES_8)] == [
        1,
        2,
        4,
        8,
    ]
    assert [len(lanes.block_shape(rows)[1]) for rows in range(1, 7)] == [1, 2, 4, 4, 8, 8]


@kernel
def multiples(shape, y, G, c, at, spacing, count):
    lanes.subtract_multiples(shape, y, at, G, at, c, at, spacing, count)


@pytest.mark.parametrize("count", [0, 1, 7])
def test_rows_times_factors_at_a_spacing(size, count):
    shape = lanes.block_shape(size)
    lane_count = len(shape[1])
    G, c, y = RNG.normal(size=(7, size)), RNG.normal(size=7), RNG.normal(size=(1, size))
    factors = np.full((7, 5), np.nan)
    factors[:, 0] = c
    before = np.zeros(OFFSET)
    out = np.r_[before, padded(y, lane_count)]
    multiples(
        shape, out, np.r_[before, padded(G, lane_count)], np.r_[before, factors.ravel()], OFFSET, 5, count
    )
    expected = y[0] - c[:count] @ G[:count]
    np.testing.assert_allclose(out[OFFSET:][:size], expected, rtol=1e-12, atol=1e-12)


@kernel
def many_products(shape, T, W, Y, at, count):
    lanes.subtract_products(shape, T, at, W, at, Y, at, count)


@kernel
def backward_sum(shape, x, at, node, blocks, pivot, lower, first, count):
    lanes.subtract_backward_sum(shape, x, at, node, blocks, at, pivot, lower, first, count)


def flat(columns: np.ndarray, lane_count: int) -> np.ndarray:
    """Vectors (n, rows) in lanes with NaN behind them, at an offset."""
    full = np.full((len(columns), lane_count), np.nan)
    full[:, : columns.shape[1]] = columns
    return np.concatenate([np.full(OFFSET, np.nan), full.ravel()])


def used(array: np.ndarray, lane_count: int, rows: int) -> np.ndarray:
    return array[OFFSET:].reshape(-1, lane_count)[:, :rows]


@pytest.mark.parametrize("rows", [1, 3, 6, 7, 12, 16])
@pytest.mark.parametrize("count", [0, 1, 5])
def test_products_over_many_blocks(rows, count):
    shape = lanes.block_shape(rows)
    lane_count = len(shape[1])
    T = RNG.normal(size=(rows, rows))
    W, Y = RNG.normal(size=(2, count * rows, rows))
    target = flat(T, lane_count)
    many_products(shape, target, flat(W, lane_count), flat(Y, lane_count), OFFSET, count)
    # a column of T^T, W^T, Y^T is a vector: T -= Y W^T
    np.testing.assert_allclose(used(target, lane_count, rows), T - W.T @ Y, atol=1e-13)


@pytest.mark.parametrize("rows", [1, 3, 6, 7, 12, 16])
@pytest.mark.parametrize("count", [0, 1, 4])
def test_backward_sums_over_later_nodes(rows, count):
    shape = lanes.block_shape(rows)
    lane_count = len(shape[1])
    vectors = RNG.normal(size=(8, rows))
    matrices = RNG.normal(size=(6, rows, rows))  # the last one is the pivot
    lower = np.stack([[0, 5, 2, 7, 1], np.array([3, 0, 4, 1, 2]) * rows * lane_count], axis=1)
    x = flat(vectors, lane_count)
    blocks = flat(matrices.reshape(-1, rows), lane_count)
    backward_sum(shape, x, OFFSET, 4, blocks, 5 * rows * lane_count, lower, 1, count)
    expected = vectors.copy()
    for node, place in lower[1 : 1 + count]:
        Y = matrices[place // (rows * lane_count)].T
        expected[4] -= np.diag(matrices[5]) * (Y.T @ vectors[node])
    np.testing.assert_allclose(used(x, lane_count, rows), expected, atol=1e-13)
