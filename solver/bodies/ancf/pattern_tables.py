"""Tables that tell the step of a mesh where things are in the blocks of its factor."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.block_pattern import BlockPattern
from heavylift.numerics.records import Records, records
from heavylift.solver.bodies.ancf.kind import (
    CLEAR_DIAGONAL,
    CLEAR_LANE,
    CLEAR_ROW,
    BaseBlock,
    FixedCoordinate,
    MeshPlaces,
)

__all__ = ["base_blocks", "block_ranges", "clears"]

ALL_PARTS = (CLEAR_ROW, CLEAR_LANE, CLEAR_DIAGONAL)


def clears(
    pattern: BlockPattern, free: NDArray[np.float64], edges: NDArray[np.int64], groups: NDArray[np.int64]
) -> tuple[Records[FixedCoordinate], NDArray[np.int64]]:
    """Which row or lane of which block is a fixed coordinate, in the order of bodies; their number by body."""
    fixed = free == 0.0
    rows: list[tuple[int, int, int, int]] = []
    on_node: dict[int, list[int]] = {}
    for a, b in edges:
        on_node.setdefault(int(a), []).append(int(b))
        on_node.setdefault(int(b), []).append(int(a))
    base = ~np.isin(np.arange(len(free)), pattern.columns["node"])
    for node in np.flatnonzero(fixed.any(axis=1) & ~base):
        coordinates = np.flatnonzero(fixed[node])
        own, _ = pattern.place(int(node), int(node))
        for other in on_node.get(int(node), []):
            place, earlier = pattern.place(int(node), other)
            part = CLEAR_ROW if earlier else CLEAR_LANE
            rows += [(int(groups[node]), place, part, int(c)) for c in coordinates]
        for c in coordinates:
            rows += [(int(groups[node]), own, part, int(c)) for part in ALL_PARTS]
    rows.sort(key=lambda row: (row[0], row[2] == CLEAR_DIAGONAL))
    counts = np.bincount([row[0] for row in rows], minlength=int(groups.max()) + 1)
    return records(FixedCoordinate, [row[1:] for row in rows]), counts


def base_blocks(pattern: BlockPattern, table: Records[MeshPlaces]) -> Records[BaseBlock]:
    """Body, later base node, earlier one (counted within the body) and place of the blocks of bases, by body."""
    rows = []
    for body, line in enumerate(table):
        first, count = int(line.first_node + line.node_count), int(line.base_node_count)
        rows += [
            (body, i, j, pattern.place(first + i, first + j)[0]) for i in range(count) for j in range(i + 1)
        ]
    return records(BaseBlock, rows)


def block_ranges(
    pattern: BlockPattern, groups: NDArray[np.int64], base_blocks: Records[BaseBlock], size: int
) -> NDArray[np.int64]:
    """First place and the one behind the last of the blocks of each body, shape (bodies, 2)."""
    of_column = groups[pattern.columns["node"]]
    counts = pattern.columns["lower_count"]
    places = np.concatenate([pattern.columns["pivot"], pattern.lower["place"], base_blocks["place"]])
    owners = np.concatenate([of_column, np.repeat(of_column, counts), base_blocks["body"]])
    ranges = np.array(
        [[places[owners == g].min(), places[owners == g].max() + size] for g in np.unique(groups)]
    )
    if np.any(ranges[1:, 0] < ranges[:-1, 1]):
        raise AssertionError("blocks of bodies overlap")
    return ranges.astype(np.int64)
