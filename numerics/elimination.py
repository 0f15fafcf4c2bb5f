"""Symbolic elimination of a graph: a minimum-degree order and the fill it causes, found once.

The order follows W. F. Tinney and J. W. Walker, Proc. IEEE 55 (1967): eliminate a node of least degree,
join its neighbours, repeat. Ties go to the lowest number, so that the same graph gives the same order.
Chains and loops of joints fill O(n).
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["Elimination", "eliminate"]


@dataclass(frozen=True)
class Elimination:
    """Order of elimination and the structure of the factor.

    Attributes
    ----------
    order
        Nodes in the order of their elimination.
    below
        For each of them the later neighbours at that time, in their own order of elimination.
    """

    order: tuple[int, ...]
    below: tuple[tuple[int, ...], ...]


def eliminate(node_count: int, edges: Iterable[tuple[int, int]]) -> Elimination:
    """Order the nodes of an undirected graph and find the structure of its factor.

    Parameters
    ----------
    node_count
        Nodes are 0 ... node_count - 1.
    edges
        Pairs of different nodes; repetitions do not matter.
    """
    neighbours: list[set[int]] = [set() for _ in range(node_count)]
    for a, b in edges:
        neighbours[a].add(b)
        neighbours[b].add(a)
    queue = [(len(neighbours[node]), node) for node in range(node_count)]
    heapq.heapify(queue)
    place = [-1] * node_count
    order: list[int] = []
    below: list[set[int]] = []
    while queue:
        degree, node = heapq.heappop(queue)
        if place[node] >= 0 or degree != len(neighbours[node]):
            continue  # an older entry of a node whose degree has changed since
        place[node] = len(order)
        order.append(node)
        around = neighbours[node]
        below.append(around)
        for other in around:
            neighbours[other] |= around
            neighbours[other] -= {node, other}
            heapq.heappush(queue, (len(neighbours[other]), other))
    later = tuple(tuple(sorted(nodes, key=place.__getitem__)) for nodes in below)
    return Elimination(tuple(order), later)
