"""Long products of blocks in vector registers against plain NumPy; padding, full of NaN, must not matter."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.lanes_wide import subtract_backward_sum, subtract_products

RNG = np.random.default_rng(11)
OFFSET = 3


@kernel
def products(shape, T, W, Y, at, count):
    subtract_products(shape, T, at, W, at, Y, at, count)


@kernel
def backward_sum(shape, x, at, node, blocks, pivot, lower, first, count):
    subtract_backward_sum(shape, x, at, node, blocks, at, pivot, lower, first, count)


def flat(columns: np.ndarray, lanes: int) -> np.ndarray:
    """Vectors (n, rows) in lanes with NaN behind them, at an offset."""
    full = np.full((len(columns), lanes), np.nan)
    full[:, : columns.shape[1]] = columns
    return np.concatenate([np.full(OFFSET, np.nan), full.ravel()])


def used(array: np.ndarray, lanes: int, rows: int) -> np.ndarray:
    return array[OFFSET:].reshape(-1, lanes)[:, :rows]


@pytest.mark.parametrize("rows", [1, 3, 6, 7, 12, 16])
@pytest.mark.parametrize("count", [0, 1, 5])
def test_products_over_many_blocks(rows, count):
    shape = block_shape(rows)
    lanes = len(shape[1])
    T = RNG.normal(size=(rows, rows))
    W, Y = RNG.normal(size=(2, count * rows, rows))
    target = flat(T, lanes)
    products(shape, target, flat(W, lanes), flat(Y, lanes), OFFSET, count)
    # a column of T^T, W^T, Y^T is a vector: T -= Y W^T
    np.testing.assert_allclose(used(target, lanes, rows), T - W.T @ Y, atol=1e-13)


@pytest.mark.parametrize("rows", [1, 3, 6, 7, 12, 16])
@pytest.mark.parametrize("count", [0, 1, 4])
def test_backward_sums_over_later_nodes(rows, count):
    shape = block_shape(rows)
    lanes = len(shape[1])
    vectors = RNG.normal(size=(8, rows))
    matrices = RNG.normal(size=(6, rows, rows))  # the last one is the pivot
    lower = np.stack([[0, 5, 2, 7, 1], np.array([3, 0, 4, 1, 2]) * rows * lanes], axis=1)
    x = flat(vectors, lanes)
    blocks = flat(matrices.reshape(-1, rows), lanes)
    backward_sum(shape, x, OFFSET, 4, blocks, 5 * rows * lanes, lower, 1, count)
    expected = vectors.copy()
    for node, place in lower[1 : 1 + count]:
        Y = matrices[place // (rows * lanes)].T
        expected[4] -= np.diag(matrices[5]) * (Y.T @ vectors[node])
    np.testing.assert_allclose(used(x, lanes, rows), expected, atol=1e-13)
