"""The graph of bodies and joints: what hangs on what, and which loops close.

A bridge is a pair of bodies whose joints, taken away, would leave one of them and all beyond it apart: its
joints act on the relative motion of two rigid groups and on nothing else, whatever happens inside these. What
is left when all bridges are cut are the *cores*, in which joints close loops.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["BodyGraph", "Core", "Pair", "body_graph"]


@dataclass(frozen=True)
class Pair:
    """Two bodies and the blocks between them; the ground has the number of bodies as its number.

    Attributes
    ----------
    bodies
        Of a bridge the one nearer to the root first.
    blocks
        All joints between them.
    beyond
        Of a bridge: the second body and all that hangs on it.
    """

    bodies: tuple[int, int]
    blocks: tuple[int, ...]
    beyond: tuple[int, ...] = ()


@dataclass(frozen=True)
class Core:
    """Bodies in loops, without the ground; whether the ground is one of the group; pairs; loops of pairs."""

    bodies: tuple[int, ...]
    grounded: bool
    pairs: tuple[Pair, ...]
    loops: tuple[tuple[Pair, ...], ...]


@dataclass(frozen=True)
class BodyGraph:
    """Bridges, cores, and groups of connected bodies that nothing ties to the ground."""

    bridges: tuple[Pair, ...]
    cores: tuple[Core, ...]
    floating: tuple[tuple[int, ...], ...]


def body_graph(count: int, sides: NDArray[np.int64], whole: NDArray[np.bool_]) -> BodyGraph:
    """Take a scene apart.

    Parameters
    ----------
    count
        Bodies.
    sides
        Bodies of each block that counts, -1 for the ground; shape (blocks, 2).
    whole
        Bodies that must not be cut off at a bridge, because they are not rigid and free; shape (count,).
    """
    between: dict[tuple[int, int], list[int]] = {}
    for block, (a, b) in enumerate(sides):
        u, v = sorted((count if a < 0 else int(a), count if b < 0 else int(b)))
        if u != v:
            between.setdefault((u, v), []).append(block)
    neighbours: list[list[int]] = [[] for _ in range(count + 1)]
    for u, v in between:
        neighbours[u].append(v)
        neighbours[v].append(u)

    def pair(u: int, v: int, beyond: tuple[int, ...] = ()) -> Pair:
        return Pair((u, v), tuple(between[min(u, v), max(u, v)]), beyond)

    bridges: list[Pair] = []
    cores: list[Core] = []
    floating: list[tuple[int, ...]] = []
    group = np.full(count + 1, -1)
    for root in (count, *range(count)):
        if group[root] >= 0:
            continue
        order, parent, size, low = _search(root, neighbours, group)
        place = {node: i for i, node in enumerate(order)}
        if root != count:
            floating.append(tuple(sorted(order)))
        cut = [False] * len(order)
        for i in range(1, len(order)):
            beyond = order[i : i + size[i]]
            inside = [node for node in order if node != count]
            if low[i] == i and not whole[inside].any():
                cut[i] = True
                bridges.append(pair(order[parent[i]], order[i], tuple(beyond)))
        head = list(range(len(order)))
        for i in range(1, len(order)):
            head[i] = i if cut[i] else head[parent[i]]
        members: dict[int, list[int]] = {}
        for i, node in enumerate(order):
            members.setdefault(head[i], []).append(node)
        for nodes in members.values():
            if len(nodes) > 1:
                group[nodes] = len(cores) + 1
                cores.append(_core(nodes, count, neighbours, place, head, pair))
    return BodyGraph(tuple(bridges), tuple(cores), tuple(floating))


def _search(
    root: int, neighbours: list[list[int]], group: NDArray[np.int64]
) -> tuple[list[int], list[int], list[int], list[int]]:
    """Depth first: nodes in order, and by place the parent, the size of what follows, the lowest place reached."""
    order, parent, low = [root], [-1], [0]
    place = {root: 0}
    group[root] = 0
    stack = [(0, iter(neighbours[root]))]
    while stack:
        i, rest = stack[-1]
        for node in rest:
            if node not in place:
                place[node] = len(order)
                group[node] = 0
                order.append(node)
                parent.append(i)
                low.append(place[node])
                stack.append((place[node], iter(neighbours[node])))
                break
            if place[node] != parent[i]:
                low[i] = min(low[i], place[node])
        else:
            stack.pop()
            if stack:
                low[parent[i]] = min(low[parent[i]], low[i])
    size = [1] * len(order)
    for i in range(len(order) - 1, 0, -1):
        size[parent[i]] += size[i]
    return order, parent, size, low


def _core(nodes, count, neighbours, place, head, pair) -> Core:  # type: ignore[no-untyped-def]
    """A core with its loops: those that a breadth-first tree closes, which are short ones."""
    first = count if count in nodes else nodes[0]
    top = head[place[nodes[0]]]

    def inside(node: int) -> bool:
        return head[place[node]] == top

    parent, depth, queue = {first: first}, {first: 0}, deque([first])
    closing: list[tuple[int, int]] = []
    pairs = []
    while queue:
        u = queue.popleft()
        for v in neighbours[u]:
            if not inside(v):
                continue
            if v not in parent:
                parent[v], depth[v] = u, depth[u] + 1
                queue.append(v)
                pairs.append(pair(u, v))
            elif v != parent[u] and (depth[v], v) > (depth[u], u):
                closing.append((u, v))
                pairs.append(pair(u, v))
    loops = []
    for u, v in closing:
        a, b, left, right = u, v, [], []
        while a != b:
            if depth[a] >= depth[b]:
                left.append(pair(parent[a], a))
                a = parent[a]
            else:
                right.append(pair(parent[b], b))
                b = parent[b]
        loops.append((*reversed(left), pair(u, v), *right))
    bodies = tuple(node for node in nodes if node != count)
    return Core(bodies, first == count, tuple(pairs), tuple(sorted(loops, key=len)))
