"""Nested dissection: separators separate, and are as small as possible on grids."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, kron
from scipy.sparse.csgraph import connected_components

from heavylift.modal.dissection import dissect, distance_coordinates


def grid(nx, ny):
    """Adjacency of a grid of nx x ny nodes, and the coordinates of the nodes."""
    line = [diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(m, m)) for m in (nx, ny)]
    x, y = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    return csr_array(kron(*line)), np.column_stack([x.ravel(), y.ravel()]).astype(float)


@pytest.mark.parametrize("known", [True, False])
def test_last_group_is_a_shortest_line_that_cuts_the_grid(known):
    graph, coordinates = grid(41, 15)
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
    graph, coordinates = grid(m, m)
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
