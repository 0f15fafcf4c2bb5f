"""The tables of a block factor: every block once, every update where the factor needs it."""

from __future__ import annotations

import numpy as np
import pytest

from heavylift.numerics import block_pattern
from heavylift.numerics.block_pattern import (
    BlockPattern,
    pack_blocks,
)
from heavylift.numerics.derived import keeping

RNG = np.random.default_rng(8)
COUNT, ROWS = 70, 6
GROUPS = np.arange(COUNT) % 2
BASES = ([4, 60], [11])


def sample() -> tuple[np.ndarray, BlockPattern]:
    """Two random bodies, whose nodes are numbered in turn, with base nodes."""
    edges = RNG.integers(0, COUNT // 2, size=(150, 2)) * 2 + RNG.integers(0, 2, size=(150, 1))
    return edges, pack_blocks(COUNT, edges, ROWS, last=BASES, groups=GROUPS)


def test_blocks_do_not_overlap_and_fill_the_set():
    _, pattern = sample()
    block = ROWS * len(pattern.shape[1])
    used = np.concatenate([pattern.columns["pivot"], pattern.lower["place"]])
    base_base = [
        pattern.place(60, 4)[0],
        pattern.place(4, 4)[0],
        pattern.place(60, 60)[0],
        pattern.place(11, 11)[0],
    ]
    every = np.sort(np.concatenate([used, base_base]))
    np.testing.assert_array_equal(every, np.arange(every.size) * block)
    assert pattern.scratch == every.size * block < pattern.size


def test_all_couplings_have_a_block_and_both_orders_name_the_same():
    edges, pattern = sample()
    places, swap = pattern.places(edges[:, 0], edges[:, 1])
    back, swapped = pattern.places(edges[:, 1], edges[:, 0])
    np.testing.assert_array_equal(places, back)
    diagonal = edges[:, 0] == edges[:, 1]
    np.testing.assert_array_equal(swap[~diagonal], ~swapped[~diagonal])
    assert not swap[diagonal].any()
    place_in_order = {int(node): i for i, node in enumerate(pattern.columns["node"])}
    for (a, b), earlier in zip(edges.tolist(), swap.tolist(), strict=True):
        if a != b:  # base nodes have no column: they come last
            assert earlier == (place_in_order.get(a, COUNT + a) < place_in_order.get(b, COUNT + b))


def test_groups_have_columns_of_their_own_and_base_nodes_none():
    _, pattern = sample()
    assert pattern.ranges[0, 0] == 0
    assert pattern.ranges[-1, 1] == len(pattern.columns)
    for g, (first, last) in enumerate(pattern.ranges.tolist()):
        nodes = pattern.columns["node"][first:last]
        expected = np.setdiff1d(np.arange(g, COUNT, 2), BASES[g])
        np.testing.assert_array_equal(np.sort(nodes), expected)


def test_updates_are_the_blocks_of_pairs_of_lower_nodes():
    _, pattern = sample()
    ends = np.flatnonzero(pattern.columns["first_update"] >= 0)
    seen = 0
    for _, first, count, update, _ in pattern.columns[ends].tolist():
        assert update == seen
        nodes = pattern.lower["node"][first : first + count]
        for l in range(count):
            for k in range(l, count):
                place, earlier = pattern.place(nodes[k], nodes[l])
                assert pattern.updates[seen] == place
                assert not earlier
                seen += 1
    assert seen == pattern.updates.size


def test_panels_have_the_rows_of_their_last_column_and_stand_row_by_row():
    _, pattern = sample()
    block = ROWS * len(pattern.shape[1])
    column = wide = 0
    while column < len(pattern.columns):
        end = column
        while pattern.columns[end].first_update < 0:
            end += 1
        width = end + 1 - column
        wide += width > 1
        start, count = pattern.columns[column].pivot, pattern.columns[end].lower_count
        for m in range(width):
            first = pattern.columns[column + m].first_lower
            rows = pattern.lower[first : first + pattern.columns[column + m].lower_count]
            assert len(rows) == width - m - 1 + count
            for i, (_, place) in enumerate(rows.tolist(), start=m + 1):
                before = i * (i + 1) // 2 if i < width else width * (width + 1) // 2 + (i - width) * width
                assert place == start + (before + m) * block
        column = end + 1
    assert wide > 0


def test_components_are_the_groups_if_none_are_given():
    chains = np.array([[5, 3], [3, 1], [0, 2], [2, 4]])
    pattern = pack_blocks(7, chains, ROWS)
    assert [set(pattern.columns["node"][a:b].tolist()) for a, b in pattern.ranges] == [
        {0, 2, 4},
        {1, 3, 5},
        {6},
    ]
    assert len(pattern.lower) == 4


def test_missing_blocks_and_mixed_groups_are_refused():
    chain = np.array([[0, 1], [1, 2], [3, 4]])
    pattern = pack_blocks(5, chain, ROWS)
    with pytest.raises(KeyError, match="no block for nodes 0 and 4"):
        pattern.place(0, 4)
    with pytest.raises(ValueError, match=r"\[1, 2\] are coupled but belong to different groups"):
        pack_blocks(5, chain, ROWS, groups=np.array([0, 0, 1, 1, 1]))
    with pytest.raises(ValueError, match="do not all belong to group 1"):
        pack_blocks(5, chain, ROWS, last=([], [0]))


def test_an_order_that_is_kept_gives_the_same_tables(monkeypatch):
    kept: dict[str, bytes] = {}

    class Memory:
        versions = "1"
        read, write, refuse = kept.get, kept.__setitem__, kept.pop

    edges = RNG.integers(0, COUNT, size=(150, 2))
    alone = pack_blocks(COUNT, edges, ROWS, groups=np.zeros(COUNT, dtype=np.int64))
    with keeping(Memory()):
        first = pack_blocks(COUNT, edges, ROWS, groups=np.zeros(COUNT, dtype=np.int64))
        assert kept
        monkeypatch.setattr(block_pattern, "order_nodes", None)
        second = pack_blocks(COUNT, edges, ROWS, groups=np.zeros(COUNT, dtype=np.int64))
    for one in (first, second):
        for name in ("columns", "lower"):
            np.testing.assert_array_equal(getattr(one, name), getattr(alone, name))
