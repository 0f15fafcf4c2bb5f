"""Prismatic LPG tank and cargo hold with chocks, as they come out of a ship CAD system; writes tank.stl and hull.stl.

    python make_models.py

Both are soups: no triangle shares a corner with another, plates have no thickness, edges are open, stiffeners stand on
plates in T-junctions, and 15 % of the triangles are wound against the others. The tank has the size of that in
*Integrated simulation ... ships and offshore structures* (2018), section 2.6: 19,232 triangles on 57,696 corners.

Axes: x forward, y to port, z up; metres. Tank and hull have the same axes when the tank stands on the 40 chocks, their
tops at z = -8 m; 10 guides keep 3 mm at its sides.
"""

from __future__ import annotations

import sys
from itertools import pairwise, product
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent

TANK_LENGTH, HULL_LENGTH = 24.0, 32.0
TANK_TRIANGLES = 19232
REVERSED = 0.15  # of the triangles

# port half of the sections (y, z), from the middle of the bottom
TANK_SECTION = ((0.0, -8.0), (10.0, -8.0), (14.0, -4.0), (14.0, 2.0), (8.0, 8.0), (0.0, 8.0))
INNER_HULL = ((0.0, -8.9), (11.0, -8.9), (15.4, -4.5), (15.4, 9.0))
OUTER_HULL = ((14.0, -10.5), (16.4, -8.0), (16.4, 9.0))

SUPPORT_LEVEL = -8.0  # bottom of the tank, tops of the chocks
GUIDE_FACE = 14.003  # of the guides, 3 mm off the side of the tank
CHOCKS = tuple(product(np.linspace(-10.2, 10.2, 8), np.linspace(-8.3, 8.3, 5)))  # x, y
GUIDES = tuple(product(np.linspace(-9.1, 9.1, 5), (-1.0, 1.0)))  # x, side


class Strip:
    """Straight piece of a section: from a to b in the plane (y, z), with the number of stiffener spacings."""

    def __init__(self, a, b, spacing):
        self.a, self.b = np.array(a), np.array(b)
        run = self.b - self.a
        length = np.hypot(*run)
        self.spaces = max(1, round(length / spacing))
        self.along = run / length
        self.inward = np.array(
            [-self.along[1], self.along[0]]
        )  # of sections that run anticlockwise seen from aft

    def between(self):
        """Places of the stiffeners, none at the ends."""
        return [self.a + (self.b - self.a) * i / self.spaces for i in range(1, self.spaces)]


class Soup:
    """Collects triangles, shape (n, 3, 3)."""

    def __init__(self):
        self.parts = []

    def __len__(self):
        return sum(len(part) for part in self.parts)

    def patch(self, a, b, c, d, cells=(1, 1)):
        """Straight-sided patch with the corners a, b, c, d in ring order, cells along ab and along bc, cut along ac."""
        s, t = np.meshgrid(np.linspace(0, 1, cells[0] + 1), np.linspace(0, 1, cells[1] + 1), indexing="ij")
        s, t = s[..., None], t[..., None]
        a, b, c, d = (np.asarray(p, dtype=float) for p in (a, b, c, d))
        grid = (1 - t) * ((1 - s) * a + s * b) + t * ((1 - s) * d + s * c)
        ring = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        for corners in ((0, 1, 2), (0, 2, 3)):
            self.parts.append(np.stack([ring[k] for k in corners], axis=2).reshape(-1, 3, 3))

    def extrude(self, p, q, ends, cells):
        """Plate along x over the line from p to q of a section, for all x between the ends."""
        self.patch((ends[0], *p), (ends[1], *p), (ends[1], *q), (ends[0], *q), cells)

    def tee(self, p, inward, ends, depth, flange, cells):
        """Longitudinal on the place p of a section: web and flange."""
        tip = p + depth * inward
        half = 0.5 * flange * np.array([-inward[1], inward[0]])
        self.extrude(p, tip, ends, (cells, 1))
        self.extrude(tip - half, tip + half, ends, (cells, 1))

    def ring(self, strip, x, depth, flange):
        """Piece of a ring frame on a strip of the section: web and flange."""
        foot = strip.a, strip.b
        top = [p + depth * strip.inward for p in foot]
        cells = (strip.spaces, 1)
        self.patch((x, *foot[0]), (x, *foot[1]), (x, *top[1]), (x, *top[0]), cells)
        fore, aft = x - 0.5 * flange, x + 0.5 * flange
        self.patch((fore, *top[0]), (fore, *top[1]), (aft, *top[1]), (aft, *top[0]), cells)

    def bracket(self, x, p, inward, leg):
        """One triangle in the corner of a longitudinal and a frame."""
        tip = p + abs(leg) * inward
        self.parts.append(np.array([[(x, *p), (x + leg, *p), (x, *tip)]]))

    def open_box(self, top, u, v, down):
        """Box of five faces: a top with the half sides u and v, four sides down from it and no bottom."""
        top, u, v, down = (np.asarray(value, dtype=float) for value in (top, u, v, down))

        def at(i, j):
            return top + i * u + j * v

        self.patch(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1))
        for p, q in (((-1, -1), (1, -1)), ((-1, 1), (1, 1)), ((-1, -1), (-1, 1)), ((1, -1), (1, 1))):
            self.patch(at(*p) + down, at(*q) + down, at(*q), at(*p))

    def triangles(self, seed):
        """All triangles in random order, a part of them turned, shape (n, 3, 3)."""
        chance = np.random.default_rng(seed)
        all_of_them = chance.permutation(np.concatenate(self.parts))
        turned = chance.permutation(len(all_of_them))[: round(REVERSED * len(all_of_them))]
        all_of_them[turned] = all_of_them[turned, ::-1]
        return all_of_them


def mirrored(section):
    """Closed or open section from its port half, anticlockwise seen from aft, each point once."""
    port = [np.array(p) for p in section]
    starboard = [p * (-1.0, 1.0) for p in port[::-1]]
    points = port + starboard
    return [points[0]] + [q for p, q in pairwise(points) if np.hypot(*(q - p)) > 1e-9]


def make_tank():
    """Corners of the triangles of the tank [m], shape (19232, 3, 3)."""
    soup, corners = Soup(), []
    ends = -0.5 * TANK_LENGTH, 0.5 * TANK_LENGTH
    frames = np.linspace(*ends, 9)[1:-1]
    for strip in (Strip(a, b, 0.8) for a, b in pairwise(mirrored(TANK_SECTION))):
        soup.extrude(strip.a, strip.b, ends, (24, strip.spaces))
        for p in strip.between():
            soup.tee(p, strip.inward, (ends[0] + 0.05, ends[1] - 0.05), depth=0.3, flange=0.12, cells=11)
            legs = [(x, leg) for x in frames for leg in (0.28, -0.28)] + [(ends[0], 0.28), (ends[1], -0.28)]
            corners.extend((x, p, strip.inward, leg) for x, leg in legs)
        for x in frames:
            soup.ring(strip, x, depth=0.7, flange=0.25)
    for x, into in ((ends[0], 1.0), (ends[1], -1.0)):
        _end_bulkhead(soup, x, 0.3 * into)
    soup.patch(
        (ends[0], 0, -8), (ends[1], 0, -8), (ends[1], 0, 8), (ends[0], 0, 8), (24, 10)
    )  # on the centre line
    # as many brackets as the published number of triangles leaves: one in each corner, then smaller ones over them
    for i in range(TANK_TRIANGLES - len(soup)):
        layer, place = divmod(i, len(corners))
        x, p, inward, leg = corners[place]
        soup.bracket(x, p, inward, leg * (1.0 - 0.15 * layer))
    return soup.triangles(seed=24)


def _end_bulkhead(soup, x, depth):
    """Octagon of three trapezia with vertical stiffeners on its inner face."""
    for (lower, upper), rows in zip(pairwise(TANK_SECTION[1:5]), (4, 6, 6), strict=True):
        (ya, za), (yb, zb) = lower, upper
        soup.patch((x, -ya, za), (x, ya, za), (x, yb, zb), (x, -yb, zb), (28, rows))
    for y in np.linspace(-9.6, 9.6, 25):
        foot, head = -8.0, min(8.0, 16.0 - abs(y))
        tip = x + depth
        soup.patch((x, y, foot), (x, y, head), (tip, y, head), (tip, y, foot), (12, 1))
        left, right = y - 0.06, y + 0.06
        soup.patch((tip, left, foot), (tip, left, head), (tip, right, head), (tip, right, foot), (12, 1))


def make_hull():
    """Corners of the triangles of the hold [m], shape (20764, 3, 3)."""
    soup = Soup()
    ends = -0.5 * HULL_LENGTH, 0.5 * HULL_LENGTH
    starboard = [np.array(p) * (-1.0, 1.0) for p in INNER_HULL[::-1]]  # to the middle of the bottom
    for a, b in pairwise(starboard + [np.array(p) for p in INNER_HULL[1:]]):
        strip = Strip(a, b, 0.85)
        soup.extrude(a, b, ends, (24, strip.spaces))
        side = abs(strip.along[0]) < 0.1
        # inside on the sides, between the plates of the double bottom and of the hoppers
        inward = strip.inward if side else -strip.inward
        for p in strip.between():
            soup.tee(p, inward, ends, depth=0.35, flange=0.15, cells=14)
        if side:
            for x in np.arange(ends[0] + 0.5, ends[1], 1.0):
                soup.ring(strip, x, depth=0.5, flange=0.2)
    _outer_shell(soup, ends)
    for x in ends:  # transverse bulkheads
        soup.patch((x, -11, -8.9), (x, 11, -8.9), (x, 15.4, -4.5), (x, -15.4, -4.5), (24, 5))
        soup.patch((x, -15.4, -4.5), (x, 15.4, -4.5), (x, 15.4, 9), (x, -15.4, 9), (24, 14))
    for x, y in CHOCKS:
        soup.open_box((x, y, SUPPORT_LEVEL), (0.275, 0, 0), (0, 0.425, 0), (0, 0, -0.9))
    for x, side in GUIDES:
        soup.open_box((x, side * GUIDE_FACE, -1.0), (0.3, 0, 0), (0, 0, 0.4 * side), (0, 1.4 * side, 0))
    return soup.triangles(seed=32)


def _outer_shell(soup, ends):
    """Outer plates, and what stands in the double bottom."""
    port = [np.array(p) for p in OUTER_HULL]
    for a, b in pairwise([p * (-1.0, 1.0) for p in port[::-1]] + port):
        soup.extrude(a, b, ends, (24, Strip(a, b, 0.9).spaces))
    for y in np.linspace(-13.6, 13.6, 33):
        soup.tee(np.array([y, -10.5]), np.array([0.0, 1.0]), ends, depth=0.35, flange=0.15, cells=14)
    for x in np.arange(ends[0], ends[1] + 0.1, 2.8):  # floors
        soup.patch((x, -11, -10.5), (x, 11, -10.5), (x, 11, -8.9), (x, -11, -8.9), (26, 2))
    for y in np.linspace(-10, 10, 5):  # girders
        soup.extrude((y, -10.5), (y, -8.9), ends, (20, 2))


def write_stl(path, triangles):
    """Binary STL: 80 bytes of text, the number of triangles, and for each a normal, three corners and two bytes."""
    rows = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    rows["normal"] = normals / np.linalg.norm(normals, axis=1)[:, None]
    rows["corners"] = triangles
    head = path.stem.encode().ljust(80)
    path.write_bytes(head + np.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes())


def main():
    """Write both models beside this file."""
    for name, triangles in (("tank", make_tank()), ("hull", make_hull())):
        write_stl(HERE / f"{name}.stl", triangles)
        sys.stdout.write(f"{name}.stl: {len(triangles)} triangles\n")


if __name__ == "__main__":
    main()
