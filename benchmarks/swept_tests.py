"""Misses, false contacts and time of the swept tests and of the position difference method, one thread.

    python benchmarks/swept_tests.py

1e5 random pairs of each kind and regime of motion; truth by exact arithmetic. Free: the points of body 2 move
independently, body 1 stands still. Rigid: both bodies translate and turn. Common: the same with a common translation
of three element sizes. The position difference method with all printed cases, in the world and in the axes of body 1.
Times are medians of CPU time: all pairs, those in contact, those that the test of swept boxes leaves; and of a family
on a small lattice, most of which needs the fallback of the certified tests.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.triangles.position_difference import (
    EDGE_CASES,
    VERTEX_CASES,
    difference_pairs,
    to_axes,
)

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "contours"))

from random_motions import KINDS, REGIMES, Pairs, random_pairs, run_swept, swept

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

COUNT = 100_000
REPEATS = 7


def nanoseconds(run: Callable[[], object], count: int) -> float:
    """Median time of a run for each of its pairs."""
    run()
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        run()
        times.append(time.process_time() - begin)
    return 1e9 * statistics.median(times) / max(count, 1)


def swept_time(kind: str, rows: NDArray[np.float64]) -> float:
    """Nanoseconds a pair of the certified tests."""
    rows = np.ascontiguousarray(rows)
    hits = np.zeros(len(rows), dtype=np.bool_)
    times = np.zeros(len(rows))
    return nanoseconds(lambda: run_swept(KINDS.index(kind), rows, hits, times), len(rows))


def boxes_meet(pairs: Pairs) -> NDArray[np.bool_]:
    """Whether the swept boxes of the features of each pair overlap."""
    still = pairs.fixed
    moving = pairs.moving.reshape(len(still), -1, 3)
    overlap = (still.min(axis=1) <= moving.max(axis=1)) & (moving.min(axis=1) <= still.max(axis=1))
    return overlap.all(axis=1)


def lattice(kind: str) -> Pairs:
    """Pairs with coordinates from -2 to 2."""
    like = random_pairs(kind, "rigid", COUNT, seed=1)
    random = np.random.default_rng(2)
    fixed = random.integers(-2, 3, like.fixed.shape)
    return Pairs(kind, fixed, random.integers(-2, 3, like.moving.shape), like.rotations, like.origins)


def report(kind: str, regime: str) -> None:
    """Print one row."""
    pairs = random_pairs(kind, regime, COUNT, seed=1)
    truth, _ = pairs.truth()
    rows = pairs.rows()
    hits, _ = swept(kind, rows)
    edges = kind == "edges"
    cases = EDGE_CASES if edges else VERTEX_CASES
    world = pairs.world()
    out = np.zeros(COUNT, dtype=np.bool_)
    found = [hits]
    for points in (world, to_axes(world, pairs.rotations, pairs.origins)):
        difference_pairs(points, edges, cases, out)
        found.append(out.copy())
    cells = "   ".join(f"{(truth & ~one).sum():6d} {(one & ~truth).sum():6d}" for one in found)
    near = boxes_meet(pairs)
    spent = [swept_time(kind, rows[which]) for which in (np.ones_like(truth), truth, near)]
    spent.append(nanoseconds(lambda: difference_pairs(world, edges, cases, out), COUNT))
    numbers = " ".join(f"{one:6.0f}" for one in spent)
    print(f"{kind:12s} {regime:7s} {truth.sum():6d}   {cells}   {numbers}", flush=True)


def main() -> None:
    """Print the table."""
    print(
        "                                swept           difference      difference,     ns a pair: swept     diff."
    )
    print("                                tests           in the world    axes of body 1")
    print(
        "kind         regime    true   missed  false   missed  false   missed  false      all   hits  boxes    all"
    )
    for kind in KINDS:
        for regime in REGIMES:
            report(kind, regime)
    for kind in KINDS:
        pairs = lattice(kind)
        truth, _ = pairs.truth()
        rows = pairs.rows()
        hits, _ = swept(kind, rows)
        missed, false = (truth & ~hits).sum(), (hits & ~truth).sum()
        print(
            f"{kind:12s} lattice {truth.sum():6d}   {missed:6d} {false:6d}   {swept_time(kind, rows):.0f} ns a pair"
        )


if __name__ == "__main__":
    main()
