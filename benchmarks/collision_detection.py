"""Time of collision detection between meshes, one thread.

    python benchmarks/collision_detection.py

Medians of CPU time after compilation. A *fresh* list is searched from the roots of both trees; a *kept* one is only
found to hold still. Every section is a function that prints its table; `main` calls them in turn.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.triangles.pair_list import make_pair_lists
from heavylift.contours.triangles.pair_search import refresh_pairs
from heavylift.contours.triangles.surface_layout import RelativeMotion
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.contours.triangles.surface_refit import refit_surface
from heavylift.contours.triangles.surface_tree import build_tree
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import record_at
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "contours"))

from collision_scenes import NAMES, query, rotation, surface

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

REPEATS = 21
REACH = 0.02  # m, of contacts that are looked for before they close
STEPS = 1800

motion_at = record_at(RelativeMotion)


@kernel
def refresh_often(surfaces, lists, motion, reach, times, fresh, share):
    count = 0
    for _ in range(times):
        if fresh:
            lists.table[0].count = -1
            lists.values[0].share = share
        count = refresh_pairs(surfaces, lists, 0, motion_at(motion, 0), reach)
    return count


@kernel
def refresh_along(surfaces, lists, motions, reach):
    total = 0
    for i in range(motions.shape[0]):
        total += refresh_pairs(surfaces, lists, 0, motion_at(motions[i], 0), reach)
    return total


@kernel
def refit(surfaces, number):
    return refit_surface(surfaces, number)


def median_time(work: Callable[[], object], count: int = 1) -> float:
    """Median CPU time of one of `count` items [us]; compiled before."""
    work()
    times = []
    for _ in range(REPEATS):
        before = time.thread_time()
        work()
        times.append(time.thread_time() - before)
    return 1e6 * statistics.median(times) / count


def sheet(count: int, height: float = 0.0) -> TriangleSurface:
    """A wavy plate of 2 count^2 triangles of 0.5 m."""
    u, v = np.meshgrid(np.arange(count + 1) * 0.5, np.arange(count + 1) * 0.5, indexing="ij")
    points = np.stack([u, v, height + 0.3 * np.sin(0.2 * u) * np.cos(0.3 * v)], axis=2).reshape(-1, 3)
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    rows = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3), np.stack([a, c, d], 2).reshape(-1, 3)])
    return TriangleSurface(points, rows)


def print_preparation() -> None:
    """Trees, all of packing, and refits."""
    print(f"\n{'preparation [ms]':20s} {'triangles':>10s} {'tree':>10s} {'all':>10s} {'refit':>10s}")
    for name in ("bunny", "tank", "hull"):
        one = surface(name)
        corners = one.points[one.triangles]
        lower, upper = corners.min(axis=1), corners.max(axis=1)
        tree = median_time(lambda lower=lower, upper=upper: build_tree(lower, upper))
        whole = median_time(lambda one=one: pack_surfaces([one]))
        packed = pack_surfaces([one])
        again = median_time(lambda packed=packed: refit(packed, 0))
        times = "".join(f" {1e-3 * t:10.3f}" for t in (tree, whole, again))
        print(f"{name:20s} {len(one.triangles):10d}{times}")


def print_queries() -> None:
    """Lists of pairs of triangles: for the interval alone, for more steps, and kept."""
    print(
        f"\n{'lists of pairs':20s} {'interval':>10s} {'pairs':>8s} {'fresh':>10s} {'pairs':>8s} {'kept':>10s}  [us]"
    )
    for name in NAMES:
        a, b, motion = query(name)
        surfaces = pack_surfaces([a, b])
        lists = make_pair_lists(surfaces, [(0, 1)])
        # bunnies are 0.2 m large: contacts at a hundredth of that
        reach = REACH if max(surfaces.reaches) > 1.0 else 0.1 * REACH
        row = []
        for share in (0.0, 1.0):
            args = (surfaces, lists, motion, reach, 20, True, share)
            count = refresh_often(*args)
            row.append(f"{median_time(lambda args=args: refresh_often(*args), 20):10.2f} {count:8d}")
        args = (surfaces, lists, motion, reach, 2000, False, 1.0)
        kept = median_time(lambda args=args: refresh_often(*args), 2000)
        print(f"{name:20s} {' '.join(row)} {kept:10.3f}")


def lowering() -> NDArray[np.float64]:
    """Motions of a tank that swings a little while it is lowered onto its supports in a hold, and rests."""
    t = np.linspace(0.0, 180.0, STEPS + 1)
    height = 6.0 * np.maximum(0.0, 1.0 - t / 150.0) + 0.002 * np.sin(2.0 * t)
    x, y = 0.05 * np.sin(0.5 * t), 0.05 * np.cos(0.37 * t)
    poses = np.zeros((STEPS + 1, 12))
    for i in range(STEPS + 1):
        roll = rotation((1, 0, 0), 0.003 * np.sin(0.4 * t[i]))
        yaw = rotation((0, 0, 1), 0.004 * np.sin(0.2 * t[i]))
        poses[i] = *(roll @ yaw).ravel(), x[i], y[i], height[i]
    return np.concatenate([poses[:-1], poses[1:]], axis=1)


def print_lowering() -> None:
    """A whole run of lists."""
    surfaces = pack_surfaces([surface("hull"), surface("tank")])
    motions = lowering()
    results = []

    def run() -> None:
        lists = make_pair_lists(surfaces, [(0, 1)])
        total = refresh_along(surfaces, lists, motions, REACH)
        results.append((lists.table[0].traversals, total / STEPS))

    whole = median_time(run)
    searches, pairs = results[-1]
    print(
        f"\ntank lowered into hull, {STEPS} steps: {1e-3 * whole:.1f} ms for all lists, {searches} "
        f"of them searched, {pairs:.0f} pairs on average"
    )


def print_sizes() -> None:
    """Cost against the number of triangles: a plate of a fixed size comes near ever larger ones."""
    print(f"\n{'plate 200 on':20s} {'all [ms]':>10s} {'fresh [us]':>10s} {'pairs':>8s} {'kept [us]':>10s}")
    small = sheet(10, 0.05)
    motion = np.zeros(24)
    motion[:9] = motion[12:21] = np.eye(3).ravel()
    motion[23] = -0.002
    for count in (22, 70, 224, 387):
        large = sheet(count)
        before = time.thread_time()
        surfaces = pack_surfaces([large, small])
        whole = 1e3 * (time.thread_time() - before)
        lists = make_pair_lists(surfaces, [(0, 1)])
        args = (surfaces, lists, motion, REACH, 20, True, 1.0)
        pairs = refresh_often(*args)
        fresh = median_time(lambda args=args: refresh_often(*args), 20)
        args = (surfaces, lists, motion, REACH, 2000, False, 1.0)
        kept = median_time(lambda args=args: refresh_often(*args), 2000)
        print(f"{len(large.triangles):20d} {whole:10.1f} {fresh:10.2f} {pairs:8d} {kept:10.3f}")


def main() -> None:
    """Print all tables."""
    print_preparation()
    print_queries()
    print_lowering()
    print_sizes()


if __name__ == "__main__":
    main()
