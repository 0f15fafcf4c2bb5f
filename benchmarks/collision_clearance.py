"""Time of the smallest distance between meshes, one thread.

    python benchmarks/collision_clearance.py

Medians of CPU time after compilation, in microseconds: without any bound, and with one that is 100, 10 and 1 mm above
the distance. Pairs as in the tests of collision detection; the tank at heights and turns above the hull and in it,
crossing it among them; two spheres about one centre, of which all triangles are nearly as near.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from heavylift.contours.triangles.clearance import WaitingNodes, clearance_stack_size, measure_clearance
from heavylift.contours.triangles.surface_layout import pose_of
from heavylift.contours.triangles.surface_pack import pack_surfaces
from heavylift.numerics.records import records
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface, clean

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "contours"))

from collision_scenes import NAMES, query, rotation, surface

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.contours.triangles.surface_pack import CollisionSurfaces

REPEATS = 21
ABOVE = (math.inf, 0.1, 0.01, 0.001)  # m, bounds above the distance
HEIGHTS = (0.5, 2.0, 5.0, 10.0)  # m
TILTS = (0.0, 1.0, 20.0, 45.0, 80.0)  # degrees
RINGS = 70


def report(name: str, surfaces: CollisionSurfaces, R: ArrayLike, p: ArrayLike) -> None:
    """Print one row."""
    pose = pose_of(R, p)
    stack, out = records(WaitingNodes, clearance_stack_size(surfaces)), np.zeros(6)
    distance = measure_clearance(surfaces, 0, 1, pose, math.inf, stack, out)
    row = []
    for above in ABOVE:
        times = []
        for _ in range(REPEATS):
            before = time.thread_time()
            measure_clearance(surfaces, 0, 1, pose, distance + above, stack, out)
            times.append(time.thread_time() - before)
        row.append(f"{1e6 * statistics.median(times):10.1f}")
    print(f"{name:26s} {distance:10.6f} {' '.join(row)}")


def sphere(radius: float) -> TriangleSurface:
    """Sphere of rings of triangles."""
    u, v = np.meshgrid(
        np.linspace(0.0, np.pi, RINGS), np.linspace(0.0, 2.0 * np.pi, 2 * RINGS + 1), indexing="ij"
    )
    corners = radius * np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=2)
    a, b, c, d = corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]
    soup = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3), np.stack([a, c, d], 2).reshape(-1, 3)])
    return clean(soup, np.arange(len(soup)).reshape(-1, 3))[0]


def start_of(motion: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rotation and position at the start of a motion."""
    return motion[:9], motion[9:12]


def main() -> None:
    """Print the table."""
    head = " ".join(f"{'none' if above == math.inf else f'{1e3 * above:.0f} mm':>10s}" for above in ABOVE)
    print(f"{'':26s} {'distance':>10s} {head}  [m, us]")
    for name in NAMES:
        a, b, motion = query(name)
        report(name, pack_surfaces([a, b]), *start_of(motion))
    surfaces = pack_surfaces([surface("hull"), surface("tank")])
    for tilt in TILTS:
        turn = rotation((0.3, 1.0, 0.2), math.radians(tilt))
        for height in HEIGHTS:
            report(f"tank at {height:.1f} m, {tilt:.0f} deg", surfaces, turn, [0.3, 0.1, height])
    surfaces = pack_surfaces([sphere(1.0), sphere(0.9)])
    report(f"spheres, {len(surfaces.triangles)} triangles", surfaces, rotation((1, 2, 3), 0.5), np.zeros(3))


if __name__ == "__main__":
    main()
