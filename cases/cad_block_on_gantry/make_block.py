"""Writes block.stl here and in the other cases with this block: plates without thickness, as CAD gives them.

    python make_block.py

A block of 12 x 8 x 4 m: bottom, two sides, two bulkheads, a web across the middle, and a deck with an opening of
4 x 2 m and a coaming about it. Nothing is closed: the deck has a hole, the web meets bottom and sides in edges of three
plates, and every second plate is wound the other way.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
FOLDERS = ("cad_block_on_gantry", "cad_module_from_barge", "cad_module_on_transporters")
LENGTH, BREADTH, HEIGHT = 12.0, 8.0, 4.0
OPENING, COAMING = (4.0, 2.0), 0.5


def plates() -> list[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Corners of all plates [m], one after the other about each; the origin is below the middle of the bottom."""
    x, y, z = 0.5 * LENGTH, 0.5 * BREADTH, HEIGHT
    a, b = 0.5 * OPENING[0], 0.5 * OPENING[1]

    def level(x0, x1, y0, y1, at):
        return [(x0, y0, at), (x1, y0, at), (x1, y1, at), (x0, y1, at)]

    def wall(x0, y0, x1, y1, low, high):
        return [(x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high)]

    found = [level(-x, 0.0, -y, y, 0.0), level(0.0, x, -y, y, 0.0)]
    for side in (-y, y):
        found += [wall(-x, side, 0.0, side, 0.0, z), wall(0.0, side, x, side, 0.0, z)]
    found += [wall(end, -y, end, y, 0.0, z) for end in (-x, 0.0, x)]
    found += [level(-x, -a, -y, y, z), level(a, x, -y, y, z), level(-a, a, -y, -b, z), level(-a, a, b, y, z)]
    found += [wall(end, -b, end, b, z, z + COAMING) for end in (-a, a)]
    found += [wall(-a, side, a, side, z, z + COAMING) for side in (-b, b)]
    return [tuple(np.array(corner) for corner in plate) for plate in found]


def triangles() -> np.ndarray:
    """Shape (n, 3, 3) [m]."""
    found = []
    for number, (p, q, r, s) in enumerate(plates()):
        both = [(p, q, r), (p, r, s)]
        found += [one[::-1] if number % 2 else one for one in both]
    return np.array(found)


def stl(corners: np.ndarray) -> bytes:
    """Content of a binary STL file [mm], without normals."""
    rows = [
        struct.pack("<12fH", 0.0, 0.0, 0.0, *(1e3 * one).ravel().astype(np.float32), 0) for one in corners
    ]
    return b"block of plates".ljust(80) + struct.pack("<I", len(rows)) + b"".join(rows)


if __name__ == "__main__":
    for name in FOLDERS:
        (HERE.parent / name / "block.stl").write_bytes(stl(triangles()))
