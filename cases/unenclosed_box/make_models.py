"""Open container of plates without thickness; writes container.stl.

    python make_models.py

Floor and four walls of 2 m x 2 m x 1 m, each a grid of its own: they share no corner, a part of the triangles is wound
against the others, and there is no lid. No inside or outside can be told from it. The origin is in the middle of the
floor.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
WIDTH, HEIGHT, CELLS = 2.0, 1.0, 6  # m, m, along each side
REVERSED = 0.4  # of the triangles


def plate(corner, u, v):
    """Triangles of a rectangle from a corner with the sides u and v, shape (72, 3, 3)."""
    s, t = (grid[..., None] for grid in np.meshgrid(*[np.linspace(0.0, 1.0, CELLS + 1)] * 2, indexing="ij"))
    points = np.array(corner) + s * np.array(u) + t * np.array(v)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.concatenate([np.stack(rows, axis=2).reshape(-1, 3, 3) for rows in ((a, b, c), (a, c, d))])


def make_container():
    """Corners of the triangles [m], shape (360, 3, 3)."""
    h = 0.5 * WIDTH
    along_x, along_y, up = (WIDTH, 0.0, 0.0), (0.0, WIDTH, 0.0), (0.0, 0.0, HEIGHT)
    triangles = np.concatenate(
        [
            plate((-h, -h, 0.0), along_x, along_y),
            plate((-h, -h, 0.0), along_x, up),
            plate((-h, h, 0.0), along_x, up),
            plate((-h, -h, 0.0), along_y, up),
            plate((h, -h, 0.0), along_y, up),
        ]
    )
    chance = np.random.default_rng(7)
    turned = chance.permutation(len(triangles))[: round(REVERSED * len(triangles))]
    triangles[turned] = triangles[turned, ::-1]
    return triangles


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
    triangles = make_container()
    write_stl(HERE / "container.stl", triangles)
    sys.stdout.write(f"container.stl: {len(triangles)} triangles\n")


if __name__ == "__main__":
    main()
