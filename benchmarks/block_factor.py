"""CPU time of the block-sparse factor of shell meshes and frames: factor, one solution, and what precedes them.

Run with ``python benchmarks/block_factor.py``. Times are medians on one thread, exponents those of the time in
the number of nodes since the mesh before; the rate counts the operations on rows in use, not on padding.
"""

from __future__ import annotations

import statistics
import time
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.block_factor import backward_blocks, factor_blocks, forward_blocks
from heavylift.numerics.block_pattern import BlockPattern, pack_blocks
from heavylift.numerics.jit import kernel

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

SHELL_MESHES = ((6, 4), (12, 8), (24, 16), (48, 32), (60, 40))
FRAME_NODES = (10, 100, 1000, 10000)
SHELL_ROWS, FRAME_ROWS = 12, 6
SECONDS = 0.5  # of one measurement


@kernel
def factor(shape, columns, updates, blocks, scratch):  # type: ignore[no-untyped-def]
    factor_blocks(shape, columns, updates, blocks, 0, 0, columns.shape[0], scratch)


@kernel
def solve(shape, columns, lower, blocks, x):  # type: ignore[no-untyped-def]
    forward_blocks(shape, columns, lower, blocks, 0, 0, columns.shape[0], x, 0)
    backward_blocks(shape, columns, lower, blocks, 0, 0, columns.shape[0], x, 0)


def shell_mesh(nx: int, ny: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Couplings and positions of the nodes of a rectangular mesh."""
    number = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    edges = [np.stack([a.ravel(), b.ravel()], axis=1) for i, a in enumerate(corners) for b in corners[:i]]
    return np.concatenate(edges), np.stack(np.divmod(number.ravel(), ny + 1), axis=1).astype(float)


def aligned(count: int) -> NDArray[np.float64]:
    """Array that starts on a cache line."""
    whole = np.zeros(count + 8)
    first = -(whole.ctypes.data // 8) % 8
    return whole[first : first + count]


def median(run: Callable[[], None], prepare: Callable[[], None]) -> float:
    """Time of a run [s]."""
    times: list[float] = []
    while len(times) < 7 or sum(times) < SECONDS:
        prepare()
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def measure(pattern: BlockPattern, edges: NDArray[np.int64]) -> tuple[float, float]:
    """Times of factor and solution of a random matrix that is diagonally dominant [s]."""
    rng = np.random.default_rng(1)
    rows, lanes = map(len, pattern.shape)
    blocks, x = aligned(pattern.size), aligned(pattern.rank.size * lanes)
    nodes = np.arange(pattern.rank.size)
    entry = np.arange(rows)[:, None] * lanes + np.arange(rows)
    blocks[pattern.places(*edges.T)[0][:, None, None] + entry] = rng.normal(size=(len(edges), rows, rows))
    blocks[pattern.places(nodes, nodes)[0][:, None, None] + entry] = 50.0 * rows * np.eye(rows)
    x.reshape(-1, lanes)[:, :rows] = rng.normal(size=(nodes.size, rows))
    start, right = blocks.copy(), x.copy()

    def fill() -> None:
        blocks[:] = start

    def fill_right() -> None:
        x[:] = right

    def run_factor() -> None:
        factor(pattern.shape, pattern.columns, pattern.updates, blocks, pattern.scratch)

    def run_solve() -> None:
        solve(pattern.shape, pattern.columns, pattern.lower, blocks, x)

    times = median(run_factor, fill), median(run_solve, fill_right)
    if not np.isfinite(x).all():
        raise ArithmeticError("the factor is not finite")
    return times


def print_compilation(rows: int) -> None:
    """Time of the first call, near zero where the machine code is in the cache."""
    pattern = pack_blocks(2, np.array([[0, 1]]), rows)
    blocks, x = np.ones(pattern.size), np.ones(2 * len(pattern.shape[1]))
    start = time.perf_counter()
    factor(pattern.shape, pattern.columns, pattern.updates, blocks, pattern.scratch)
    middle = time.perf_counter()
    solve(pattern.shape, pattern.columns, pattern.lower, blocks, x)
    end = time.perf_counter()
    print(f"first call, {rows} rows: factor {middle - start:.2f} s, solve {end - middle:.2f} s")


def print_meshes(
    title: str, rows: int, meshes: Mapping[str, tuple[NDArray[np.int64], NDArray[np.float64] | None]]
) -> None:
    print(f"{title:<12} nodes    order s   blocks   MB    factor ms  GFlop/s  exponent   solve ms")
    before: tuple[float, int] | None = None
    for name, (edges, points) in meshes.items():
        count = int(edges.max()) + 1
        start = time.perf_counter()
        pattern = pack_blocks(count, edges, rows, coordinates=points)
        order = time.perf_counter() - start
        seconds, solution = measure(pattern, edges)
        below = pattern.columns["lower_count"]
        work = float((below * (below + 1) // 2).sum()) * 2.0 * rows**3
        exponent = "" if before is None else f"{np.log(seconds / before[0]) / np.log(count / before[1]):.2f}"
        print(
            f"{name:<12}{count:6d} {order:10.3f} {pattern.keys.size:8d} {8e-6 * pattern.size:6.1f}"
            f" {1e3 * seconds:10.3f} {1e-9 * work / seconds:8.1f} {exponent:>9} {1e3 * solution:10.3f}",
            flush=True,
        )
        before = seconds, count


def main() -> None:
    for rows in (FRAME_ROWS, SHELL_ROWS):
        print_compilation(rows)
    print_meshes("shell", SHELL_ROWS, {f"{nx} x {ny}": shell_mesh(nx, ny) for nx, ny in SHELL_MESHES})
    chains = {
        f"chain {n}": (np.stack([np.arange(n - 1), np.arange(1, n)], axis=1), None) for n in FRAME_NODES
    }
    print_meshes("frame", FRAME_ROWS, chains)


if __name__ == "__main__":
    main()
