"""Symbolic elimination: the structure it finds is that of the numerical factor, and it grows as it should."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics.elimination import eliminate


def fill(count: int, edges: list[tuple[int, int]]) -> int:
    return sum(map(len, eliminate(count, edges).below))


def test_structure_is_that_of_a_numerical_cholesky_factor():
    rng = np.random.default_rng(2)
    count = 30
    edges = [(int(a), int(b)) for a, b in rng.integers(0, count, size=(45, 2)) if a != b]
    matrix = np.eye(count) * 100.0
    for a, b in edges:
        matrix[a, b] = matrix[b, a] = rng.uniform(0.5, 1.0)
    found = eliminate(count, edges)
    order = np.array(found.order)
    factor = np.linalg.cholesky(matrix[np.ix_(order, order)])
    place = {node: i for i, node in enumerate(found.order)}
    for column, below in enumerate(found.below):
        rows = np.flatnonzero(np.abs(factor[column + 1 :, column]) > 1e-14) + column + 1
        assert set(rows) <= {place[node] for node in below}
        assert [place[node] for node in below] == sorted(place[node] for node in below)


@pytest.mark.parametrize("count", [100, 1000])
def test_chains_fill_nothing_and_loops_one_edge_a_node(count):
    chain = [(i, i + 1) for i in range(count - 1)]
    assert fill(count, chain) == count - 1
    assert fill(count, [*chain, (count - 1, 0)]) == 2 * count - 3


def test_a_star_is_eliminated_from_its_tips():
    found = eliminate(50, [(0, i) for i in range(1, 50)])
    assert sum(map(len, found.below)) == 49
    assert found.order.index(0) >= 48


def test_equal_graphs_get_equal_orders():
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (1, 3)]
    assert eliminate(4, edges) == eliminate(4, [(b, a) for a, b in reversed(edges)])
