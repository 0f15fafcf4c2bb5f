"""Nested dissection of a finite-element graph: the elimination order that keeps a factor sparse."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

__all__ = ["Dissection", "dissect", "distance_coordinates"]

LEAF_NODES = 24
"""Domains of at most this many nodes are not cut any more; they become one dense front."""

_QUANTILES = (0.5, 0.42, 0.58)
_DEEPEST = 60  # levels of the tree; heap numbers stay within int64


class Dissection(NamedTuple):
    """Elimination order and its groups.

    Attributes
    ----------
    order
        Old index of the node eliminated at each place, shape (n,).
    starts
        Group g is eliminated at places ``starts[g]:starts[g+1]``; groups are the separators and the
        leaves of the tree in post-order, so every group follows all groups it separates.
    """

    order: NDArray[np.int64]
    starts: NDArray[np.int64]


def dissect(graph: csr_array, coordinates: NDArray[np.float64] | None = None) -> Dissection:
    """Order a graph by recursive coordinate bisection with smallest vertex separators.

    Parameters
    ----------
    graph
        Symmetric adjacency of the nodes, sparse (n, n); values do not matter.
    coordinates
        Positions of the nodes, shape (n, d). Without them graph distances from a few far nodes serve.

    Notes
    -----
    George, "Nested dissection of a regular finite element mesh", SIAM J. Numer. Anal. 10 (1973). All
    domains of a level are cut at once. Each one is halved by the plane (one of the axes, near the
    median) with the fewest nodes next to it. The edges across form a bipartite graph; its smallest
    vertex cover, by Koenig's theorem from a maximum matching, is the separator.
    """
    n = graph.shape[0]
    if coordinates is None:
        coordinates = distance_coordinates(graph)
    coo = graph.tocoo()
    once = coo.row < coo.col
    edges = np.stack([coo.row[once], coo.col[once]]).astype(np.int64)
    domain = np.ones(n, dtype=np.int64)  # heap numbers: the halves of domain d are 2 d and 2 d + 1
    active = np.ones(n, dtype=bool)  # neither in a separator nor in a leaf yet
    for _ in range(_DEEPEST):
        active &= np.bincount(_dense(domain), minlength=1)[_dense(domain)] > LEAF_NODES
        if not active.any():
            break
        inside = active[edges[0]] & active[edges[1]] & (domain[edges[0]] == domain[edges[1]])
        edges = edges[:, inside]
        left, cut = _best_halves(coordinates, domain, active, edges)
        separator = _smallest_cover(left, cut, edges)
        moving = active & cut & ~separator
        domain[moving] = 2 * domain[moving] + ~left[moving]
        active = moving
    return _in_postorder(domain)


def distance_coordinates(graph: csr_array, count: int = 3) -> NDArray[np.float64]:
    """Distances, in edges, of all nodes from a few mutually far nodes, shape (n, count)."""
    from scipy.sparse.csgraph import dijkstra

    n = graph.shape[0]
    result = np.zeros((n, count))
    nearest = np.full(n, np.inf)
    start = 0
    for k in range(-1, count):  # the first pass only finds an end of the graph
        distance = dijkstra(graph, directed=False, indices=start, unweighted=True)
        reached = np.isfinite(distance)
        distance[~reached] = distance[reached].max() + 1.0 if reached.any() else 0.0
        if k >= 0:
            result[:, k] = distance
            nearest = np.minimum(nearest, distance)
            start = int(np.argmax(nearest))
        else:
            start = int(np.argmax(distance))
    return result


def _dense(labels: NDArray[np.int64]) -> NDArray[np.int64]:
    """Labels renumbered 0, 1, 2, ..."""
    return np.unique(labels, return_inverse=True)[1]


def _best_halves(
    coordinates: NDArray[np.float64],
    domain: NDArray[np.int64],
    active: NDArray[np.bool_],
    edges: NDArray[np.int64],
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Halve every active domain by a coordinate plane.

    Returns which nodes lie on the left side, and which belong to a domain that could be cut.
    """
    n = len(domain)
    nodes = np.flatnonzero(active)
    label = _dense(domain[nodes])
    sizes = np.bincount(label)
    firsts = np.cumsum(sizes) - sizes
    node_label = np.full(n, -1, dtype=np.int64)
    node_label[nodes] = label
    best_cost = np.full(len(sizes), np.inf)
    best = np.zeros(n, dtype=bool)
    for axis in range(coordinates.shape[1]):
        values = coordinates[:, axis]
        ranked = values[nodes][np.lexsort((values[nodes], label))]
        for quantile in _QUANTILES:
            plane = ranked[firsts + (quantile * sizes).astype(np.int64)]
            left = np.zeros(n, dtype=bool)
            left[nodes] = values[nodes] < plane[label]
            on_left = np.bincount(label[left[nodes]], minlength=len(sizes))
            smaller = np.minimum(on_left, sizes - on_left)
            crossing = left[edges[0]] != left[edges[1]]
            ends = edges[:, crossing]
            touched = [
                np.bincount(node_label[np.unique(side)], minlength=len(sizes))
                for side in (
                    np.where(left[ends[0]], ends[0], ends[1]),
                    np.where(left[ends[0]], ends[1], ends[0]),
                )
            ]
            # small separators, but no slivers: work grows with the larger part
            balance = 2.0 * np.maximum(smaller, 0.5) / sizes
            cost = np.minimum(*touched) / balance**2 + 1e-6 * (sizes - 2 * smaller)
            cost[smaller == 0] = np.inf
            better = cost < best_cost
            best_cost[better] = cost[better]
            take = nodes[better[label]]
            best[take] = left[take]
    cut = np.zeros(n, dtype=bool)
    cut[nodes] = np.isfinite(best_cost)[label]
    return best, cut


def _smallest_cover(
    left: NDArray[np.bool_], cut: NDArray[np.bool_], edges: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Fewest nodes that touch every edge between the halves (Koenig's theorem), as a mask."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    cover = np.zeros(len(left), dtype=bool)
    crossing = (left[edges[0]] != left[edges[1]]) & cut[edges[0]]
    ends = edges[:, crossing]
    if not ends.size:
        return cover
    a = np.where(left[ends[0]], ends[0], ends[1])
    b = np.where(left[ends[0]], ends[1], ends[0])
    rows, a = np.unique(a, return_inverse=True)
    columns, b = np.unique(b, return_inverse=True)
    across = csr_array((np.ones(len(a), dtype=np.int8), (a, b)), shape=(len(rows), len(columns)))
    mate_of_row = maximum_bipartite_matching(across, perm_type="column").astype(np.int64)
    mate_of_column = np.full(len(columns), -1, dtype=np.int64)
    matched = mate_of_row >= 0
    mate_of_column[mate_of_row[matched]] = np.flatnonzero(matched)
    # what alternating paths from unmatched left nodes reach
    row_reached = ~matched
    column_reached = np.zeros(len(columns), dtype=bool)
    front = row_reached
    while front.any():
        hit = np.zeros(len(columns), dtype=bool)
        hit[b[front[a]]] = True
        hit &= ~column_reached
        column_reached |= hit
        front = np.zeros(len(rows), dtype=bool)
        mates = mate_of_column[hit]
        front[mates[mates >= 0]] = True
        front &= ~row_reached
        row_reached |= front
    cover[rows[~row_reached]] = True
    cover[columns[column_reached]] = True
    return cover


def _in_postorder(domain: NDArray[np.int64]) -> Dissection:
    """Sort nodes by domain, domains in post-order of the binary tree."""
    names, label = np.unique(domain, return_inverse=True)
    # post-order: the path from the root as binary digits, closed by a digit after both children
    depth = np.floor(np.log2(names)).astype(np.int64)
    deepest = int(depth.max())
    path = names - (np.int64(1) << depth)
    key = np.zeros(len(names))
    for level in range(deepest + 1):
        digit = np.where(level < depth, (path >> np.maximum(depth - 1 - level, 0)) & 1, 2)
        digit = np.where(level > depth, 0, digit)
        key = key * 3.0 + digit
    rank = np.empty(len(names), dtype=np.int64)
    rank[np.argsort(key, kind="stable")] = np.arange(len(names))
    group = rank[label]
    order = np.argsort(group, kind="stable").astype(np.int64)
    starts = np.concatenate([[0], np.cumsum(np.bincount(group))]).astype(np.int64)
    return Dissection(order, starts)
