"""Closed surface of the size of a simplified bunny, 148 points and 292 triangles; writes bunny.stl.

    python make_models.py

A ball of 0.2 m with waves and two ears: the radius is a function of the direction, so that the surface is closed,
but it is not convex. Directions are those of a Fibonacci lattice, joined by their convex hull. The counts are those of
the bunny in *Integrated simulation ... ships and offshore structures* (2018), section 2.6.4 (2).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

HERE = Path(__file__).resolve().parent
POINTS, SIZE = 148, 0.2  # -, m
EARS = ((0.35, 0.25, 0.9), (0.35, -0.25, 0.9))


def make_bunny():
    """Points [m], shape (148, 3), and triangles wound anticlockwise seen from outside, shape (292, 3)."""
    step = (np.arange(POINTS) + 0.5) / POINTS
    turn = np.pi * (1.0 + np.sqrt(5.0)) * (np.arange(POINTS) + 0.5)
    z = 1.0 - 2.0 * step
    r = np.sqrt(1.0 - z**2)
    sphere = np.column_stack([r * np.cos(turn), r * np.sin(turn), z])
    triangles = np.sort(ConvexHull(sphere).simplices, axis=1)
    triangles = triangles[np.lexsort(triangles.T[::-1])]  # the same on every machine
    a, b, c = (sphere[triangles[:, k]] for k in range(3))
    inside_out = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0.0
    triangles[inside_out] = triangles[inside_out][:, [0, 2, 1]]

    x, y, z = sphere.T
    radius = 1.0 + 0.12 * np.sin(3.0 * x + 1.0) * np.cos(4.0 * y) + 0.08 * np.sin(7.0 * z)
    for ear in EARS:
        tip = np.array(ear) / np.linalg.norm(ear)
        radius += 0.9 * np.exp((sphere @ tip - 1.0) / 0.03)
    return 0.5 * SIZE * radius[:, None] * sphere, triangles.astype(np.int64)


def write_stl(path, triangles):
    """Binary STL: 80 bytes of text, the number of triangles, and for each a normal, three corners and two bytes."""
    rows = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    rows["normal"] = normals / np.linalg.norm(normals, axis=1)[:, None]
    rows["corners"] = triangles
    head = path.stem.encode().ljust(80)
    path.write_bytes(head + np.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes())


def main():
    """Write the model beside this file."""
    points, triangles = make_bunny()
    write_stl(HERE / "bunny.stl", points[triangles])
    sys.stdout.write(f"bunny.stl: {len(triangles)} triangles on {len(points)} points\n")


if __name__ == "__main__":
    main()
