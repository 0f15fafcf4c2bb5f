"""Times of clipping a hull at the water plane, and of a floating position and a righting-arm curve on top of it.

    python benchmarks/hydrostatics.py

Medians of CPU time after compilation, one thread; vertices are transformed anew in every evaluation. Boxes and a
sphere, listing and trimming, half in the water.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "solver"))

from hull_shapes import box_grid, icosphere

from heavylift.numerics.jit import kernel
from heavylift.preprocess.hydrodynamics.hull_surface import check_hull
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface
from heavylift.solver.water.hulls.clipping import Clip, clip_surface
from heavylift.solver.water.hulls.hydrostatics import Pose, equilibrium, righting_arm_curve

GRIDS = ((1, 1, 1), (16, 8, 8), (32, 16, 16), (48, 32, 19), (64, 40, 24), (128, 80, 48))
SIZE = (97.5, 36.0, 6.0)


@kernel
def clip_often(points, triangles, rotation, height, placed, out, repeats):
    """Clip at heights that differ a little; returns a sum that needs all of them."""
    total = 0.0
    for k in range(repeats):
        clip_surface(points, triangles, rotation, height + 1e-6 * k, placed, out)
        total += out.volume
    return total


def median(function, repeats=25):
    """CPU time [s]."""
    function()
    times = []
    for _ in range(repeats):
        begin = time.thread_time()
        function()
        times.append(time.thread_time() - begin)
    return float(np.median(times))


def clipping(name, points, triangles, height):
    rotation = Pose(0.0, 0.1, 0.05).rotation.ravel()
    placed, out = np.zeros_like(points), Clip.one()
    repeats = max(3, 200_000 // len(triangles))
    t = median(lambda: clip_often(points, triangles, rotation, height, placed, out, repeats)) / repeats
    print(
        f"{name:8s}{len(triangles):11d}{int(out.crossing):10d}{1e6 * t:10.2f}{1e9 * t / len(triangles):14.2f}"
    )


def on_top(grid):
    points, triangles = box_grid(grid, SIZE)
    hull = check_hull(TriangleSurface(points, triangles, name="box"))
    mass = 0.75 * 1025.0 * hull.volume
    angles = np.radians(np.arange(0.0, 81.0, 2.0))
    position = median(lambda: equilibrium(hull, mass, (1.0, 0.5, 1.0)), 11)
    curve = median(lambda: righting_arm_curve(hull, mass, (1.0, 0.5, 1.0), angles), 5)
    print(f"{'':8s}{len(triangles):11d}{1e3 * position:22.2f}{1e3 * curve:26.1f}")


def main():
    """Print both tables."""
    print(f"{'':8s}{'triangles':>11s}{'crossing':>10s}{'us':>10s}{'ns/triangle':>14s}")
    for grid in GRIDS:
        clipping("box", *box_grid(grid, SIZE), -1.5)
    for level in (3, 4, 5, 6):
        clipping("sphere", *icosphere(level), 0.1)
    print(f"\n{'':8s}{'triangles':>11s}{'equilibrium [ms]':>22s}{'41 righting arms [ms]':>26s}")
    for grid in (GRIDS[0], GRIDS[2], GRIDS[3]):
        on_top(grid)


if __name__ == "__main__":
    main()
