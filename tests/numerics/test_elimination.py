"""Orders of elimination: the structure is that of the numerical factor, and work grows as theory says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, kron
from scipy.sparse.csgraph import connected_components

from heavylift.numerics.elimination import (
    dissect,
    distance_coordinates,
    factor_structure,
    order_nodes,
)


def grid(nx: int, ny: int) -> tuple[int, np.ndarray, np.ndarray]:
    """Number of nodes, couplings of all nodes of each cell, and positions."""
    number = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    edges = [
        np.stack([a.ravel(), b.ravel()], axis=1) for i, a in enumerate(corners) for b in corners[i + 1 :]
    ]
    points = np.stack(np.divmod(number.ravel(), ny + 1), axis=1).astype(float)
    return number.size, np.unique(np.sort(np.concatenate(edges), axis=1), axis=0), points


def neighbours_of(count: int, edges: np.ndarray) -> list[set[int]]:
    neighbours: list[set[int]] = [set() for _ in range(count)]
    for a, b in edges.tolist():
        neighbours[a].add(b)
        neighbours[b].add(a)
    return neighbours


def adjacency(count: int, edges: np.ndarray) -> csr_array:
    both = np.concatenate([edges, edges[:, ::-1]])
    return csr_array((np.ones(len(both)), both.T), shape=(count, count))


def work_of(structure: list[np.ndarray]) -> int:
    """Multiplications of a scalar factorisation."""
    return sum(below.size * (below.size + 3) // 2 for below in structure)


@pytest.mark.parametrize("last", [(), (3, 17, 40)], ids=["all", "base nodes"])
def test_structure_is_that_of_a_numerical_cholesky_factor(last):
    rng = np.random.default_rng(2)
    count = 60
    edges = rng.integers(0, count, size=(110, 2))
    edges = edges[edges[:, 0] != edges[:, 1]]
    matrix = np.eye(count) * 100.0
    pairs = [*edges.tolist(), *((a, b) for a in last for b in last if a < b)]
    for a, b in pairs:
        matrix[a, b] = matrix[b, a] = rng.uniform(0.5, 1.0)
    order, structure = order_nodes(count, edges, last=last)
    assert sorted(order.tolist()) == list(range(count))
    assert order[count - len(last) :].tolist() == sorted(last)
    factor = np.linalg.cholesky(matrix[np.ix_(order, order)])
    for column, below in enumerate(structure):
        rows = np.flatnonzero(np.abs(factor[column + 1 :, column]) > 1e-14) + column + 1
        assert set(rows) <= set(below.tolist())
        assert np.all(np.diff(below) > 0)
    # random entries cancel nowhere, so the symbolic factor has no superfluous entry in its first columns
    assert sum(map(len, structure)) <= 1.05 * np.count_nonzero(np.abs(np.tril(factor, -1)) > 1e-14)


@pytest.mark.parametrize("with_points", [True, False])
def test_work_of_square_grids_stays_below_that_of_regular_dissection(with_points):
    """A. George (1973): 829/84 k^3 multiplications for k x k nodes coupled with all of their cells."""
    for k in (20, 40):
        count, edges, points = grid(k - 1, k - 1)
        _, structure = order_nodes(count, edges, coordinates=points if with_points else None)
        assert work_of(structure) < 829.0 / 84.0 * k**3


def test_dissection_helps_where_minimum_degree_does_not():
    count, edges, points = grid(40, 40)
    neighbours = neighbours_of(count, edges)
    found = dissect(adjacency(count, edges), points).order
    by_rows = work_of(factor_structure(np.arange(count), neighbours))
    assert work_of(factor_structure(found, neighbours)) < 0.45 * by_rows


@pytest.mark.parametrize("count", [100, 1000])
def test_chains_fill_nothing_and_loops_one_entry_a_node(count):
    chain = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    assert sum(map(len, order_nodes(count, chain)[1])) == count - 1
    loop = np.concatenate([chain, [[count - 1, 0]]])
    assert sum(map(len, order_nodes(count, loop)[1])) == 2 * count - 3


def test_chain_held_at_both_ends_fills_one_entry_a_node():
    count = 200
    chain = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    held = np.concatenate([chain, [[0, count], [count - 1, count + 1]]])
    _, structure = order_nodes(count + 2, held, last=(count, count + 1))
    assert sum(map(len, structure)) <= 2 * count + 1


def test_strips_fill_nothing():
    count, edges, points = grid(300, 1)
    _, structure = order_nodes(count, edges, coordinates=points)
    assert sum(map(len, structure)) == len(edges)


def test_children_stand_before_their_parents_and_subtrees_together():
    count, edges, points = grid(13, 9)
    _, structure = order_nodes(count, edges, coordinates=points)
    size = np.ones(count, dtype=int)
    lowest = np.arange(count)
    for column, below in enumerate(structure):
        if below.size:
            parent = below[0]
            size[parent] += size[column]
            lowest[parent] = min(lowest[parent], lowest[column])
    np.testing.assert_array_equal(np.arange(count) - lowest + 1, size)


def test_equal_graphs_get_equal_orders():
    count, edges, points = grid(9, 7)
    shuffled = np.random.default_rng(3).permutation(edges)[:, ::-1]
    first, _ = order_nodes(count, edges, coordinates=points)
    second, _ = order_nodes(count, shuffled, coordinates=points)
    np.testing.assert_array_equal(first, second)


def test_several_pieces_and_single_nodes():
    count, edges, _ = grid(8, 8)
    both = np.concatenate([edges, edges + count])
    order, structure = order_nodes(2 * count + 1, both)
    assert sorted(order.tolist()) == list(range(2 * count + 1))
    assert work_of(structure) <= 2 * work_of(order_nodes(count, edges)[1]) * 1.1
    assert order_nodes(0, np.zeros((0, 2), dtype=np.int64))[0].size == 0


def test_a_clique_cannot_be_split():
    count = 40
    edges = np.stack(np.triu_indices(count, 1), axis=1)
    _, structure = order_nodes(count, edges)
    assert sum(map(len, structure)) == len(edges)


def test_a_star_is_eliminated_from_its_tips():
    order, structure = order_nodes(50, np.array([(0, i) for i in range(1, 50)]))
    assert sum(map(len, structure)) == 49
    assert order.tolist().index(0) >= 48


def mesh(nx, ny):
    """Adjacency of a grid of nx x ny nodes, and the coordinates of the nodes."""
    line = [diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(m, m)) for m in (nx, ny)]
    x, y = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    return csr_array(kron(*line)), np.column_stack([x.ravel(), y.ravel()]).astype(float)


@pytest.mark.parametrize("known", [True, False])
def test_last_group_is_a_shortest_line_that_cuts_the_grid(known):
    graph, coordinates = mesh(41, 15)
    result = dissect(graph, coordinates if known else None)
    assert np.array_equal(np.sort(result.order), np.arange(41 * 15))
    last = result.order[result.starts[-2] :]
    assert len(last) == 15
    rest = np.setdiff1d(np.arange(41 * 15), last)
    parts, labels = connected_components(graph[rest][:, rest])
    assert parts == 2
    assert np.bincount(labels).min() > 0.35 * 41 * 15


def test_fill_of_a_grid_is_far_below_its_band():
    m = 40
    graph, coordinates = mesh(m, m)
    place = np.empty(m * m, dtype=int)
    place[dissect(graph, coordinates).order] = np.arange(m * m)
    A = np.zeros((m * m, m * m), dtype=bool)
    coo = graph.tocoo()
    A[place[coo.row], place[coo.col]] = True
    for j in range(m * m):  # symbolic elimination
        later = np.flatnonzero(A[j, j + 1 :]) + j + 1
        A[np.ix_(later, later)] = True
    # about 31/4 n log2 n in the limit of large grids (George and Liu, 1981), m^3 with a band
    assert np.tril(A).sum() < 0.65 * m**3


def test_distances_are_coordinates_along_a_chain():
    chain = diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(30, 30)).tocsr()
    distance = distance_coordinates(csr_array(chain))[:, 0]
    assert np.array_equal(np.sort(distance), np.arange(30))


@pytest.mark.parametrize("size", [1, 2, 25, 200])
def test_complete_and_edgeless_graphs(size):
    for graph in (csr_array(np.ones((size, size))), csr_array(np.eye(size))):
        result = dissect(graph)
        assert np.array_equal(np.sort(result.order), np.arange(size))
        assert result.starts[0] == 0
        assert result.starts[-1] == size
        assert np.all(np.diff(result.starts) > 0)
