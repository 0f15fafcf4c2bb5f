"""Orders of elimination of symmetric sparse matrices and the structure of their factors, found once.

*Minimum degree* eliminates a node of least degree, joins its neighbours, and repeats (W. F. Tinney and J. W. Walker,
Proc. IEEE 55, 1967): chains and strips fill nothing, loops of joints O(n). *Nested dissection* takes a separator that
splits the graph into two halves that do not touch, eliminates it after both, and so on within them (A. George, SIAM
J. Numer. Anal. 10, 1973): the factor of a plane mesh of n nodes then has O(n log n) entries and takes O(n^1.5)
operations. Of few nodes both orders are found and counted (`order_nodes`, for joints and meshes in time); matrices
of large finite element models, whose groups are dense fronts, take the dissection as it is (`heavylift.modal`).
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = [
    "Dissection",
    "FactorStructure",
    "dissect",
    "distance_coordinates",
    "factor_structure",
    "minimum_degree",
    "order_nodes",
]

LEAF = 16
"""Nodes below which a part is not split further."""

EVEN = 0.3
"""Smallest share of the nodes on one side of a cut, where a cut that is more even can be had."""

QUANTILES = (0.5, 0.46, 0.54, 0.42, 0.58, 0.38, 0.62)
"""Shares of the nodes before the planes that are tried."""

DEEPEST = 60
"""Levels of the tree: heap numbers stay within int64."""

FactorStructure = list[NDArray[np.int64]]
"""Of each column of the factor the later columns in which it has blocks, in ascending order."""


def order_nodes(
    node_count: int,
    edges: NDArray[np.int64],
    *,
    last: Sequence[int] = (),
    coordinates: NDArray[np.float64] | None = None,
) -> tuple[NDArray[np.int64], FactorStructure]:
    """Order of elimination that makes little fill, and the structure of the factor.

    Parameters
    ----------
    node_count
        Nodes are 0 ... node_count - 1.
    edges
        Pairs of different nodes, shape (m, 2); repetitions do not matter.
    last
        Nodes that come at the end, in ascending order, as if all of them were coupled.
    coordinates
        Positions of the nodes in any unit, shape (n, d); they help to find short cuts.

    Returns
    -------
    All nodes, children of the elimination tree just before their parents, shape (n,); and the columns of the
    factor in terms of places in this order.
    """
    ends = np.unique(np.sort(np.asarray(last, dtype=np.int64)))
    neighbours: list[set[int]] = [set() for _ in range(node_count)]
    for a, b in edges.tolist():
        neighbours[a].add(b)
        neighbours[b].add(a)
    for a in ends.tolist():
        neighbours[a] |= set(ends.tolist()) - {a}
    inner = np.setdiff1d(np.arange(node_count), ends)
    order, structure, work = _factor_work(minimum_degree(inner.tolist(), neighbours), ends, neighbours)
    fills = sum(map(len, structure)) > sum(map(len, neighbours)) // 2
    if fills and inner.size > LEAF:
        points = None if coordinates is None else coordinates[inner]
        other = _factor_work(_dissected(inner, neighbours, points), ends, neighbours)
        if other[2] < work:
            order, structure, work = other
    order = _follow_tree(order, structure, inner.size)
    return order, factor_structure(order, neighbours)


def _factor_work(
    inner: list[int], ends: NDArray[np.int64], neighbours: list[set[int]]
) -> tuple[NDArray[np.int64], FactorStructure, int]:
    """Full order, structure, and number of products of blocks in the factorisation."""
    order = np.concatenate([np.array(inner, dtype=np.int64), ends])
    structure = factor_structure(order, neighbours)
    return order, structure, sum(len(below) * (len(below) + 1) // 2 for below in structure)


def _dissected(
    nodes: NDArray[np.int64], neighbours: list[set[int]], coordinates: NDArray[np.float64] | None
) -> list[int]:
    """Some nodes by nested dissection of each connected piece, those of each of its groups by minimum degree."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    place = {node: i for i, node in enumerate(nodes.tolist())}
    around = [[place[other] for other in neighbours[node] if other in place] for node in place]
    starts = np.cumsum([0, *map(len, around)])
    ends = np.array([other for others in around for other in others], dtype=np.int64)
    graph = csr_array((np.ones(ends.size), ends, starts), shape=(nodes.size, nodes.size))
    order: list[int] = []
    count, piece_of = connected_components(graph, directed=False)
    for piece in range(count):
        own = np.flatnonzero(piece_of == piece)
        if own.size <= LEAF:
            order += minimum_degree(nodes[own].tolist(), neighbours)
            continue
        found = dissect(graph[own][:, own], None if coordinates is None else coordinates[own])
        for group in np.split(nodes[own[found.order]], found.starts[1:-1]):
            order += minimum_degree(group.tolist(), neighbours)
    return order


def minimum_degree(nodes: Sequence[int], neighbours: list[set[int]]) -> list[int]:
    """Minimum degree order of some nodes, counting couplings with all others, which stay.

    Ties go to the lowest number, so that the same graph gives the same order.
    """
    around = {node: set(neighbours[node]) for node in nodes}
    queue = [(len(around[node]), node) for node in nodes]
    heapq.heapify(queue)
    order: list[int] = []
    while queue:
        degree, node = heapq.heappop(queue)
        if node not in around or degree != len(around[node]):
            continue  # an older entry of a node whose degree has changed since
        clique = around.pop(node)
        order.append(node)
        for other in clique:
            if other in around:
                around[other] |= clique
                around[other] -= {node, other}
                heapq.heappush(queue, (len(around[other]), other))
    return order


def factor_structure(order: NDArray[np.int64], neighbours: list[set[int]]) -> FactorStructure:
    """Structure of the factor for an order of elimination.

    Notes
    -----
    Below a column stand its own later neighbours and all that stands below its children in the elimination
    tree: J. W. H. Liu, SIAM J. Matrix Anal. Appl. 11 (1990).
    """
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    children: list[list[int]] = [[] for _ in order]
    structure: FactorStructure = []
    rank = place.tolist()
    for column, node in enumerate(order.tolist()):
        below = {rank[other] for other in neighbours[node]}
        below.update(*(structure[child].tolist() for child in children[column]))
        rows = np.array(sorted(r for r in below if r > column), dtype=np.int64)
        structure.append(rows)
        if rows.size:
            children[rows[0]].append(column)
    return structure


def _follow_tree(order: NDArray[np.int64], structure: FactorStructure, count: int) -> NDArray[np.int64]:
    """Equivalent order, with the same fill, in which each subtree of the first `count` columns is contiguous."""
    children: list[list[int]] = [[] for _ in order]
    roots = []
    for column in range(count):
        below = structure[column]
        if below.size and below[0] < count:
            children[below[0]].append(column)
        else:
            roots.append(column)
    found: list[int] = []
    stack = roots[:]
    while stack:  # parents first, then the whole is turned round
        column = stack.pop()
        found.append(column)
        stack += children[column]
    return np.concatenate([order[found[::-1]], order[count:]]).astype(np.int64)


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
    All domains of a level are cut at once. Each one is halved by the plane (one of the axes, near the
    median) after which least work is expected. The edges across form a bipartite graph; its smallest
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
    for _ in range(DEEPEST):
        active &= np.bincount(_dense(domain), minlength=1)[_dense(domain)] > LEAF
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
        for quantile in QUANTILES:
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
            # work of the separator, which also stands below both halves, and of the halves, by the law n^1.5
            width = np.minimum(*touched)
            larger = np.maximum(sizes - smaller - width, 0)
            cost = 10.0 * width**3.0 + 10.0 * (smaller**1.5 + larger**1.5)
            cost[smaller < EVEN * sizes] *= 1e3
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
