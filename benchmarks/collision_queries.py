"""Times of collision queries: which features of two surfaces touch, from nothing and on a valid pair list.

    python benchmarks/collision_queries.py

Medians of CPU time after compilation. *Fresh* searches the trees, *list* finds its pair list valid; *20 mm* is the
latter with all features within 20 mm too. The lowering takes a tank into a hull in 1,800 steps, detection only.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "contours"))

from collision_kernels import contacts_kernel, gaps_kernel
from collision_scenes import NAMES, query

from heavylift.contours.triangles.feature_gap import EDGE_EDGE, FeatureTouch
from heavylift.contours.triangles.feature_pairs import SWEPT
from heavylift.contours.triangles.feature_report import make_contact_list
from heavylift.contours.triangles.pair_list import make_pair_lists
from heavylift.contours.triangles.patches import extreme_points, group_patches, patch_scratch_size
from heavylift.contours.triangles.surface_pack import pack_surfaces

CAPACITY = 8192
STEPS = 1800


def median(function, repeats):
    times = []
    for _ in range(repeats):
        begin = time.thread_time()
        function()
        times.append(time.thread_time() - begin)
    return 1e3 * float(np.median(times))


def measure(name, out):
    a, b, motion = query(name)
    surfaces = pack_surfaces([a, b])
    lists = make_pair_lists(surfaces, [(0, 1)])

    def ask(reach=0.0):
        return contacts_kernel(surfaces, lists, 0, motion, reach, SWEPT, True, out)

    def forget():
        lists.table[0].count = -1
        ask()

    near = ask(0.02)
    count = ask()
    kinds = out.contacts["kind"][:count].copy()
    times = median(forget, 15), median(ask, 31), median(lambda: ask(0.02), 31)
    faces, edges = np.count_nonzero(kinds < EDGE_EDGE), np.count_nonzero(kinds == EDGE_EDGE)
    print(f"{name:18s} {faces:5d} {edges:5d} {near:6d}" + "".join(f"{t:10.3f}" for t in times))


def lower(out):
    """Tank into hull by 1 mm a step, swaying a little."""
    a, b, _ = query("tank_hull")
    surfaces = pack_surfaces([a, b])
    lists = make_pair_lists(surfaces, [(0, 1)])
    s = np.linspace(0.0, 1.0, STEPS + 1)
    poses = np.zeros((STEPS + 1, 12))
    poses[:, [0, 4, 8]] = 1.0
    poses[:, 9] = 0.02 * np.sin(20.0 * s)
    poses[:, 11] = 1.8 * (1.0 - s)
    motions = np.concatenate([poses[:-1], poses[1:]], axis=1)
    times = np.zeros(STEPS)
    found = 0
    for k, motion in enumerate(motions):
        begin = time.thread_time()
        found = contacts_kernel(surfaces, lists, 0, motion, 1e-3, SWEPT, True, out)
        times[k] = time.thread_time() - begin
    print(
        f"lowering: {times.sum():.2f} s in {STEPS} steps, mean {1e3 * times.mean():.3f}, median "
        f"{1e3 * np.median(times):.3f}, largest {1e3 * times.max():.2f} ms; {lists.table[0].traversals} "
        f"searches, {found} contacts in the end"
    )


def contacts(found):
    """Gaps and patches of the contacts of tank and hull."""
    a, b, motion = query("tank_hull")
    surfaces = pack_surfaces([a, b])
    lists = make_pair_lists(surfaces, [(0, 1)])
    n = contacts_kernel(surfaces, lists, 0, motion, 0.0, SWEPT, True, found)
    out = FeatureTouch.one()
    pose = motion[12:].copy()
    gaps_kernel(surfaces, found.contacts[:n], 0.0, pose, 1, out)
    gap = median(lambda: gaps_kernel(surfaces, found.contacts[:n], 0.0, pose, 100, out), 11)
    rng = np.random.default_rng(0)
    points, normals = rng.uniform(-10.0, 10.0, (n, 3)) * [1.0, 1.0, 0.0], np.tile([0.0, 0.0, 1.0], (n, 1))
    scratch = np.zeros(patch_scratch_size(n), dtype=np.int64)
    patch_of, active = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    chosen = np.zeros((n, 4), dtype=np.int64)

    def group():
        return group_patches(n, points, normals, 0.95, 2.0, scratch, patch_of)

    count = group()

    def span():
        extreme_points(n, points, normals, patch_of, count, active, scratch, chosen)

    span()
    print(
        f"{n} contacts: gap {1e6 * gap / (100 * n):.1f} ns each; {count} patches {1e3 * median(group, 51):.1f} us, "
        f"their extreme points {1e3 * median(span, 51):.1f} us"
    )


def main():
    found = make_contact_list(CAPACITY)
    print("contacts at reach 0 (faces, edges), at 20 mm; times in ms")
    print(
        f"{'':18s} {'faces':>5s} {'edges':>5s} {'20 mm':>6s}"
        + "".join(f"{t:>10s}" for t in ("fresh", "list", "20 mm"))
    )
    for name in NAMES:
        measure(name, found)
    contacts(found)
    lower(found)


if __name__ == "__main__":
    main()
