"""Structure of a symmetric block-sparse factor for meshes: found once, before the first time step.

Every node has a block of rows. Blocks, their places and all that the factorisation does with them are listed
in tables, through which the kernels of `heavylift.numerics.block_factor` run. Columns with the same rows below
them stand together as *panels*, whose blocks are stored row by row, so that what a panel subtracts from a later
block is one long product: E. G. Ng and B. W. Peyton, SIAM J. Sci. Comput. 14 (1993).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.derived import derived
from heavylift.numerics.elimination import LEAF, FactorStructure, order_nodes
from heavylift.numerics.joined import joined
from heavylift.numerics.lanes import block_shape
from heavylift.numerics.records import Record, Records, records

__all__ = ["BlockPattern", "FactorColumn", "LowerBlock", "pack_blocks"]

WIDEST_PANEL = 8
"""Most columns of a panel: one of its rows and the scaled copy of another stay in the fastest cache."""

WITH_NEXT = -1
"""In place of the first update: the column is eliminated with the next one."""


class FactorColumn(Record):
    """A column of the factor.

    Attributes
    ----------
    node
        That is eliminated.
    first_lower, lower_count
        Of its blocks below the pivot.
    first_update
        Of those that its panel makes; `WITH_NEXT` in all columns of a panel but the last.
    pivot
        Place of its pivot.
    """

    node: int
    first_lower: int
    lower_count: int
    first_update: int
    pivot: int


class LowerBlock(Record):
    """A block below a pivot: its later node and its place."""

    node: int
    place: int


@dataclass(frozen=True, eq=False)
class BlockPattern:
    """Structure of a factor. Places are offsets from the start of a set of blocks.

    Entry (i of the later node, j of the earlier one) of a block stands at ``place + j * lanes + i``. Of two base
    nodes the one with the lower number counts as the earlier.

    Attributes
    ----------
    shape
        Block shape for `heavylift.numerics.lanes`.
    columns
        In the order of elimination.
    lower
        Blocks below the pivots, column by column.
    updates
        Places of the blocks that the pairs of lower blocks of a panel change, shape (nu,): for each lower block
        of its last column, those in the column of its node, from the pivot on.
    ranges
        First column of each group and one beyond its last, shape (groups, 2).
    size
        Numbers in one set of blocks, scratch included.
    scratch
        Place of the scratch.
    rank
        Of each node, its place in the order of elimination, base nodes last in their group; shape (n,).
    keys
        Earlier rank times the number of nodes plus later rank, of each block, in ascending order.
    key_places
        Place of each of these blocks.
    """

    shape: tuple[tuple[int, ...], tuple[int, ...]]
    columns: Records[FactorColumn]
    lower: Records[LowerBlock]
    updates: NDArray[np.int64]
    ranges: NDArray[np.int64]
    size: int
    scratch: int
    rank: NDArray[np.int64]
    keys: NDArray[np.int64]
    key_places: NDArray[np.int64]

    def places(
        self, a: NDArray[np.int64], b: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Places of the blocks of pairs of nodes, and where a is the earlier: the block is stored transposed.

        Raises
        ------
        KeyError
            The pattern has no block for a pair.
        """
        first, second = self.rank[a], self.rank[b]
        keys = np.minimum(first, second) * self.rank.size + np.maximum(first, second)
        index = np.minimum(np.searchsorted(self.keys, keys), self.keys.size - 1)
        missing = np.flatnonzero(self.keys[index] != keys)
        if missing.size:
            i = missing[0]
            raise KeyError(f"no block for nodes {np.ravel(a)[i]} and {np.ravel(b)[i]}")
        return self.key_places[index], first < second

    def place(self, a: int, b: int) -> tuple[int, bool]:
        """`places` of one pair."""
        places, swap = self.places(np.array([a]), np.array([b]))
        return int(places[0]), bool(swap[0])


def pack_blocks(
    node_count: int,
    edges: NDArray[np.int64],
    rows: int,
    *,
    last: Sequence[Sequence[int]] = (),
    groups: NDArray[np.int64] | None = None,
    coordinates: NDArray[np.float64] | None = None,
) -> BlockPattern:
    """Order the nodes of independent bodies and lay out their blocks.

    Parameters
    ----------
    node_count
        Nodes are 0 ... node_count - 1.
    edges
        Pairs of coupled nodes, shape (m, 2); repetitions and pairs of a node with itself do not matter.
    rows
        Of each block.
    last
        Of each group its base nodes: blocks for all pairs of them exist, and they are not eliminated.
    groups
        Number of the body of each node, shape (node_count,). If None, connected components in the order of
        their lowest nodes.
    coordinates
        Positions of the nodes in any unit, shape (node_count, d); they help to find a good order.

    Raises
    ------
    ValueError
        A pair couples two groups, or a base node is not in its group.
    """
    pairs = np.asarray(edges, dtype=np.int64).reshape(-1, 2)
    pairs = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)
    group = _components(node_count, pairs, last) if groups is None else np.asarray(groups, dtype=np.int64)
    across = np.flatnonzero(group[pairs[:, 0]] != group[pairs[:, 1]])
    if across.size:
        raise ValueError(f"nodes {pairs[across[0]].tolist()} are coupled but belong to different groups")
    for g, held in enumerate(last):
        if any(group[node] != g for node in held):
            raise ValueError(f"base nodes {list(held)} do not all belong to group {g}")

    shape = block_shape(rows)
    layout = _Layout(node_count, rows * len(shape[1]))
    group_count = max(len(last), int(group.max(initial=-1)) + 1)
    local = np.empty(node_count, dtype=np.int64)  # number of each node within its group
    parts = _split(pairs, group[pairs[:, 0]], group_count)
    for g, nodes in enumerate(_split(np.arange(node_count), group, group_count)):
        local[nodes] = np.arange(nodes.size)
        base = np.unique(np.asarray(last[g] if g < len(last) else (), dtype=np.int64))
        inputs = (
            nodes.size,
            local[parts[g]],
            local[base],
            None if coordinates is None else coordinates[nodes],
        )
        worth = nodes.size > LEAF
        order, structure = (derived(_Ordered, _ordered, *inputs) if worth else _ordered(*inputs)).apart()
        layout.add(nodes[order], structure, nodes.size - base.size)
    return layout.finish(shape)


class _Ordered(NamedTuple):
    """Nodes in the order of elimination; rows below the diagonal of all columns, and where those of each begin."""

    order: NDArray[np.int64]
    below: NDArray[np.int64]
    starts: NDArray[np.int64]

    def apart(self) -> tuple[NDArray[np.int64], FactorStructure]:
        """The order, and the rows of each column."""
        each = np.split(self.below, self.starts[1:-1]) if self.order.size else []
        return self.order, each


def _ordered(
    count: int,
    edges: NDArray[np.int64],
    last: NDArray[np.int64],
    coordinates: NDArray[np.float64] | None,
) -> _Ordered:
    """As `order_nodes`, in arrays that can be kept: to dissect a mesh, SciPy has to be imported."""
    order, structure = order_nodes(count, edges, last=last.tolist(), coordinates=coordinates)
    starts = np.cumsum([0, *map(len, structure)], dtype=np.int64)
    return _Ordered(order, np.concatenate([np.zeros(0, dtype=np.int64), *structure]), starts)


def _split(rows: NDArray[np.int64], group: NDArray[np.int64], count: int) -> list[NDArray[np.int64]]:
    """Rows of each group."""
    order = np.argsort(group, kind="stable")
    return np.split(rows[order], np.searchsorted(group[order], np.arange(1, count)))


def _components(
    node_count: int, pairs: NDArray[np.int64], last: Sequence[Sequence[int]]
) -> NDArray[np.int64]:
    """Number of the connected component of each node; base nodes of a group are coupled."""
    cliques = [(nodes[0], node) for nodes in last for node in list(nodes)[1:]]
    all_pairs = np.concatenate([pairs, np.array(cliques, dtype=np.int64).reshape(-1, 2)])
    return joined(node_count, all_pairs)


class _Layout:
    """Collects the tables of `BlockPattern` group by group."""

    def __init__(self, node_count: int, block: int) -> None:
        self.node_count, self.block = node_count, block
        self.rank = np.zeros(node_count, dtype=np.int64)
        self.nodes: list[NDArray[np.int64]] = []
        self.columns: list[
            tuple[int, int, int, int]
        ] = []  # rank, first lower, count, pivot; WITH_NEXT beside
        self.with_next: list[bool] = []
        self.lower: list[NDArray[np.int64]] = []  # rank and place
        self.base_keys: list[NDArray[np.int64]] = []
        self.base_places: list[NDArray[np.int64]] = []
        self.ranges: list[tuple[int, int]] = []
        self.lower_count = self.block_count = self.ranked = self.widest = 0

    def add(self, nodes: NDArray[np.int64], structure: FactorStructure, eliminated: int) -> None:
        """Lay out a group, whose nodes are given in their order; of these the first are eliminated."""
        start = self.ranked
        self.ranked += nodes.size
        self.rank[nodes] = np.arange(start, self.ranked)
        self.nodes.append(nodes)
        first = len(self.columns)
        column = 0
        while column < eliminated:
            width = self._panel_width(structure, column, eliminated)
            self._add_panel(start, column, width, structure)
            column += width
        self.ranges.append((first, len(self.columns)))
        early, late = np.triu_indices(nodes.size - eliminated)
        self.base_keys.append((start + eliminated + early) * self.node_count + start + eliminated + late)
        self.base_places.append((self.block_count + np.arange(early.size)) * self.block)
        self.block_count += early.size

    @staticmethod
    def _panel_width(structure: FactorStructure, column: int, eliminated: int) -> int:
        """Columns from here on that go into one panel."""
        end = column  # the last column with the same rows below
        while (
            end + 1 < eliminated
            and structure[end].size == structure[end + 1].size + 1
            and structure[end][0] == end + 1
        ):
            end += 1
        count = end + 1 - column
        panels = -(-count // WIDEST_PANEL)
        return -(-count // panels)

    def _add_panel(self, start: int, column: int, width: int, structure: FactorStructure) -> None:
        below = structure[column + width - 1]
        triangle = width * (width + 1) // 2
        for m in range(width):
            inner = np.arange(m + 1, width)
            rows = np.concatenate([column + inner, below])
            place = np.concatenate(
                [inner * (inner + 1) // 2 + m, triangle + np.arange(below.size) * width + m]
            )
            pivot = self.block_count + m * (m + 1) // 2 + m
            self.columns.append((start + column + m, self.lower_count, rows.size, pivot * self.block))
            self.with_next.append(m + 1 < width)
            self.lower.append(np.stack([start + rows, (self.block_count + place) * self.block], axis=1))
            self.lower_count += rows.size
        self.block_count += triangle + below.size * width
        self.widest = max(self.widest, width)

    def finish(self, shape: tuple[tuple[int, ...], tuple[int, ...]]) -> BlockPattern:
        """All tables, with nodes in place of ranks."""
        count = self.node_count
        table = np.array(self.columns, dtype=np.int64).reshape(-1, 4)
        lower = np.concatenate([np.zeros((0, 2), dtype=np.int64), *self.lower])
        early = np.repeat(table[:, 0], table[:, 2])
        keys = np.concatenate(
            [table[:, 0] * (count + 1), early * count + lower[:, 0], *self.base_keys]
        ).astype(np.int64)
        places = np.concatenate([table[:, 3], lower[:, 1], *self.base_places]).astype(np.int64)
        order = np.argsort(keys)
        keys, places = keys[order], places[order]

        first_update = np.full(len(table), WITH_NEXT, dtype=np.int64)
        wanted: list[NDArray[np.int64]] = []
        total = 0
        for column in np.flatnonzero(~np.array(self.with_next, dtype=bool)).tolist():
            first_update[column] = total
            _, first, size, _ = self.columns[column]
            rows = lower[first : first + size, 0]
            l, k = np.triu_indices(size)
            wanted.append(rows[l] * count + rows[k])
            total += l.size
        targets = np.concatenate([np.zeros(0, dtype=np.int64), *wanted])
        node_of = np.concatenate([np.zeros(0, dtype=np.int64), *self.nodes])
        scratch = self.block_count * self.block
        columns, below = records(FactorColumn, len(table)), records(LowerBlock, len(lower))
        columns["node"], columns["first_update"] = node_of[table[:, 0]], first_update
        columns["first_lower"], columns["lower_count"], columns["pivot"] = table[:, 1:].T
        below["node"], below["place"] = node_of[lower[:, 0]], lower[:, 1]
        return BlockPattern(
            shape=shape,
            columns=columns,
            lower=below,
            updates=places[np.searchsorted(keys, targets)].ravel(),
            ranges=np.array(self.ranges, dtype=np.int64).reshape(-1, 2),
            size=scratch + max(1, self.widest) * self.block,
            scratch=scratch,
            rank=self.rank,
            keys=keys,
            key_places=places,
        )
