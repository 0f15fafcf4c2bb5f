"""Tables that tell the step of a mesh where things are in the blocks of its factor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_pattern import LOWER_COUNT, NODE, PIVOT, BlockPattern
from heavylift.solver.bodies.ancf.kind import BASE_NODES, FIRST_NODE, NODES

__all__ = ["base_blocks", "block_ranges", "clears"]


def clears(
    pattern: BlockPattern, free: NDArray[np.float64], edges: NDArray[np.int64], groups: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Which row or lane of which block is a fixed coordinate, in the order of bodies; their number by body."""
    fixed = free == 0.0
    rows: list[tuple[int, int, int, int]] = []
    on_node: dict[int, list[int]] = {}
    for a, b in edges:
        on_node.setdefault(int(a), []).append(int(b))
        on_node.setdefault(int(b), []).append(int(a))
    base = ~np.isin(np.arange(len(free)), pattern.columns[:, NODE])
    for node in np.flatnonzero(fixed.any(axis=1) & ~base):
        coordinates = np.flatnonzero(fixed[node])
        own, _ = pattern.place(int(node), int(node))
        for other in on_node.get(int(node), []):
            place, earlier = pattern.place(int(node), other)
            rows += [(int(groups[node]), place, 0 if earlier else 1, int(c)) for c in coordinates]
        for c in coordinates:
            rows += [(int(groups[node]), own, kind, int(c)) for kind in (0, 1, 2)]
    rows.sort(key=lambda row: (row[0], row[2] == 2))
    counts = np.bincount([row[0] for row in rows], minlength=int(groups.max()) + 1)
    return np.array([row[1:] for row in rows], dtype=np.int64).reshape(-1, 3), counts


def base_blocks(pattern: BlockPattern, table: NDArray[np.int64]) -> NDArray[np.int64]:
    """Body, later base node, earlier one (counted within the body) and place of the blocks of bases, by body."""
    rows = []
    for body, line in enumerate(table):
        first, count = int(line[FIRST_NODE] + line[NODES]), int(line[BASE_NODES])
        rows += [
            (body, i, j, pattern.place(first + i, first + j)[0]) for i in range(count) for j in range(i + 1)
        ]
    return np.array(rows, dtype=np.int64).reshape(-1, 4)


def block_ranges(
    pattern: BlockPattern, groups: NDArray[np.int64], base_blocks: NDArray[np.int64], size: int
) -> NDArray[np.int64]:
    """First place and the one behind the last of the blocks of each body, shape (bodies, 2)."""
    of_column = groups[pattern.columns[:, NODE]]
    counts = pattern.columns[:, LOWER_COUNT]
    places = np.concatenate([pattern.columns[:, PIVOT], pattern.lower[:, 1], base_blocks[:, 3]])
    owners = np.concatenate([of_column, np.repeat(of_column, counts), base_blocks[:, 0]])
    ranges = np.array(
        [[places[owners == g].min(), places[owners == g].max() + size] for g in np.unique(groups)]
    )
    if np.any(ranges[1:, 0] < ranges[:-1, 1]):
        raise AssertionError("blocks of bodies overlap")
    return ranges.astype(np.int64)
