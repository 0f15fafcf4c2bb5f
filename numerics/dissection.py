"""Orders of elimination for meshes: nested dissection with minimum degree at its leaves.

A separator splits the graph into two halves that do not touch, is eliminated after both, and so on within
them (A. George, SIAM J. Numer. Anal. 10, 1973): the factor of a plane mesh of n nodes then has O(n log n)
entries and takes O(n^1.5) operations. Halves are found along the principal axes of the coordinates and
along distances in the graph, and every place of the cut is tried. Chains and strips are better off with
minimum degree from the start, which fills nothing there, so both orders are found and counted.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["FactorStructure", "dissect", "factor_structure", "order_nodes"]

LEAF = 16
"""Nodes below which a part is not split further."""

EVEN = 0.3
"""Smallest share of the nodes on one side of a cut."""

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
    order, structure, work = _factor_work(_minimum_degree(inner.tolist(), neighbours), ends, neighbours)
    fills = sum(map(len, structure)) > sum(map(len, neighbours)) // 2
    if fills and inner.size > LEAF:
        other = _factor_work(dissect(inner, neighbours, coordinates).tolist(), ends, neighbours)
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


def dissect(
    nodes: NDArray[np.int64],
    neighbours: list[set[int]],
    coordinates: NDArray[np.float64] | None = None,
) -> NDArray[np.int64]:
    """Nested dissection of some nodes of a graph.

    Parameters
    ----------
    nodes
        Those to be ordered, shape (k,).
    neighbours
        Of all nodes of the graph.
    coordinates
        As in `order_nodes`.
    """
    order: list[int] = []
    _dissect(nodes, neighbours, coordinates, order)
    return np.array(order, dtype=np.int64)


def _dissect(
    nodes: NDArray[np.int64],
    neighbours: list[set[int]],
    coordinates: NDArray[np.float64] | None,
    order: list[int],
) -> None:
    """Append the nodes to the order."""
    if nodes.size <= LEAF:
        order += _minimum_degree(nodes.tolist(), neighbours)
        return
    place = {node: i for i, node in enumerate(nodes.tolist())}
    around = [[place[other] for other in neighbours[node] if other in place] for node in place]
    piece = _pieces(around)
    if piece.any():
        for i in range(int(piece.max()) + 1):
            _dissect(nodes[piece == i], neighbours, coordinates, order)
        return
    rows = np.repeat(np.arange(nodes.size), [len(others) for others in around])
    columns = np.array([other for others in around for other in others], dtype=np.int64)
    best: tuple[float, NDArray[np.int64]] | None = None
    for direction in _directions(around, None if coordinates is None else coordinates[nodes]):
        found = _cut(rows, columns, direction)
        if found is not None and (best is None or found[0] < best[0]):
            best = found
    if best is None:  # too dense to be split
        order += _minimum_degree(nodes.tolist(), neighbours)
        return
    side = best[1]
    for i in (0, 1):
        _dissect(nodes[side == i], neighbours, coordinates, order)
    order += _minimum_degree(nodes[side == 2].tolist(), neighbours)


def _pieces(around: list[list[int]]) -> NDArray[np.int64]:
    """Number of the connected piece of each node, from 0 in the order of their first nodes."""
    piece = [-1] * len(around)
    count = 0
    for first in range(len(around)):
        if piece[first] < 0:
            piece[first] = count
            waiting = [first]
            while waiting:
                for other in around[waiting.pop()]:
                    if piece[other] < 0:
                        piece[other] = count
                        waiting.append(other)
            count += 1
    return np.array(piece)


def _steps_from(first: int, around: list[list[int]]) -> NDArray[np.float64]:
    """Least number of steps from a node to each that it is connected with; `around` are the neighbours of each."""
    steps = [-1.0] * len(around)
    steps[first] = 0.0
    front, count = [first], 0.0
    while front:
        count += 1.0
        reached = []
        for node in front:
            for other in around[node]:
                if steps[other] < 0.0:
                    steps[other] = count
                    reached.append(other)
        front = reached
    return np.array(steps)


def _directions(around: list[list[int]], points: NDArray[np.float64] | None) -> Iterator[NDArray[np.float64]]:
    """Numbers of the nodes that grow from one end of the part to the other."""
    if points is not None:
        centred = points - points.mean(axis=0)
        spread, axes = np.linalg.eigh(centred.T @ centred)
        for i in np.flatnonzero(spread > 1e-6 * spread[-1])[::-1]:
            along = centred @ axes[:, i]
            # nodes of one mesh line must not be torn apart by rounding
            yield np.round(along / np.abs(along).max(), 9)
    far = 0
    for _ in range(2):
        distance = _steps_from(far, around)
        far = int(np.argmax(distance))
    yield distance - _steps_from(far, around)
    yield distance


def _cut(
    rows: NDArray[np.int64], columns: NDArray[np.int64], direction: NDArray[np.float64]
) -> tuple[float, NDArray[np.int64]] | None:
    """Cost of the best cut along a direction, and 0, 1 or 2 for nodes before, beyond and in the separator."""
    count = direction.size
    order = np.argsort(direction, kind="stable")
    rank = np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)
    best: tuple[float, NDArray[np.int64]] | None = None
    for backward in (False, True):
        if backward:
            rank = count - 1 - rank
        lowest = rank.copy()  # neighbour that comes first
        np.minimum.at(lowest, rows, rank[columns])
        # the separator of a cut before rank k: nodes from k on with a neighbour before it
        change = np.zeros(count + 1, dtype=np.int64)
        np.add.at(change, lowest + 1, 1)
        np.add.at(change, rank + 1, -1)
        width = np.cumsum(change)[:count]
        before = np.arange(count)
        beyond = count - before - width
        allowed = np.minimum(before, beyond) >= EVEN * (count - width)
        if not allowed.any():
            continue
        # work of the separator, which also stands below both halves, and of the halves, by the law n^1.5
        cost = np.where(allowed, 10.0 * width**3.0 + 10.0 * (before**1.5 + beyond**1.5), np.inf)
        k = int(np.argmin(cost))
        if best is None or cost[k] < best[0]:
            side = np.where(rank < k, 0, np.where(lowest < k, 2, 1))
            best = float(cost[k]), side
    return best


def _minimum_degree(nodes: Sequence[int], neighbours: list[set[int]]) -> list[int]:
    """Minimum degree order of some nodes, counting couplings with all others, which stay.

    Notes
    -----
    W. F. Tinney and J. W. Walker, Proc. IEEE 55 (1967). Ties go to the lowest number.
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
