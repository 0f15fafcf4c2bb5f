"""A double bottom of 12 x 10 x 2 m: plates with bulb flats and flat bars as beams beside them, 119.5 t.

Bottom 25 mm, tank top 22 mm, both with 60 kg/m2 of outfit; girders at y = -5, -3 ... 5 and floors at x = 0, 2 ... 12 m
of 18 mm; bulb flats HP 300 x 13 along x every 0.5 m between girders on both plates, inside; flat bars 150 x 12 upright
every 0.5 m on girders (towards +y) and floors (towards +x).
"""

from __future__ import annotations

import numpy as np

from heavylift.preprocess.finite_elements.model import Material
from heavylift.preprocess.structures.sections import BeamSection, bulb_as_angle
from heavylift.preprocess.structures.structure import Beams, Shells, Structure

STEEL = Material(2.06e11, 0.3, 7850.0)
SIZE = (12.0, 10.0, 2.0)
BAY, SPACING = 2.0, 0.5
THICKNESS = {"bottom": 0.025, "tank_top": 0.022, "girders": 0.018, "floors": 0.018}
OUTFIT = 60.0
BULB, BAR = (0.300, 0.013), (0.150, 0.012)


def bulb_flat():
    """Section of the bulb flat as an angle, without its product, and its centroid along and across the web [m]."""
    web, t, flange, tf = bulb_as_angle(*BULB)
    areas = np.array([web * t, flange * tf])
    along, across = np.array([web / 2, web + tf / 2]), np.array([0.0, (flange - t) / 2])
    z, y = areas @ along / areas.sum(), areas @ across / areas.sum()
    first = t * web**3 / 12 + flange * tf**3 / 12 + areas @ (along - z) ** 2
    second = web * t**3 / 12 + tf * flange**3 / 12 + areas @ (across - y) ** 2
    torsion = (web * t**3 + flange * tf**3) / 3
    return BeamSection(
        areas.sum(), first, second, torsion, shear_area_1=areas[0], shear_area_2=5 / 6 * areas[1]
    ), (z, y)


def flat_bar():
    """Section of the flat bar."""
    h, t = BAR
    shear = 5 / 6 * h * t
    torsion = h * t**3 / 3 * (1 - 0.63 * t / h)
    return BeamSection(h * t, t * h**3 / 12, h * t**3 / 12, torsion, shear_area_1=shear, shear_area_2=shear)


class Grid:
    """Nodes of a regular grid, made as they are used."""

    def __init__(self, n):
        self.h = SPACING / n
        self.counts = [round(length / self.h) for length in SIZE]
        self.number = np.full([count + 1 for count in self.counts], -1)
        self.used = 0

    def __call__(self, *places):
        """Numbers of nodes at grid places, arrays of equal shape."""
        index = np.broadcast_arrays(*places)
        flat = np.ravel_multi_index([part.ravel() for part in index], self.number.shape)
        table = self.number.ravel()
        new = np.unique(flat[table[flat] < 0])
        table[new] = self.used + np.arange(len(new))
        self.used += len(new)
        self.number = table.reshape(self.number.shape)
        return table[flat].reshape(index[0].shape)

    def nodes(self):
        """Positions [m]."""
        i, j, k = np.nonzero(self.number >= 0)
        found = np.empty((self.used, 3))
        found[self.number[i, j, k]] = np.column_stack([i, j, k]) * self.h - [0.0, SIZE[1] / 2, 0.0]
        return found


def double_bottom(n):
    """The structure with n elements in 0.5 m."""
    grid = Grid(n)
    nx, ny, nz = grid.counts
    bay = round(BAY / grid.h)

    def plate(a, b, place):
        """Quadrilaterals over two running directions; `place` puts (p, q) on the grid."""
        p, q = (part.ravel() for part in np.meshgrid(np.arange(a), np.arange(b), indexing="ij"))
        return np.stack([place(p + dp, q + dq) for dp, dq in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=1)

    def lines(count, places, put):
        """Beams of `count` elements at each of some places."""
        return np.concatenate(
            [
                np.stack([put(place, np.arange(count)), put(place, np.arange(1, count + 1))], axis=1)
                for place in places
            ]
        )

    quads = {
        "bottom": plate(ny, nx, lambda q, p: grid(p, q, 0)),  # normal down
        "tank_top": plate(nx, ny, lambda p, q: grid(p, q, nz)),
        "girders": np.concatenate(
            [plate(nx, nz, lambda p, q, j=j: grid(p, j, q)) for j in range(0, ny + 1, bay)]
        ),
        "floors": np.concatenate(
            [plate(ny, nz, lambda p, q, i=i: grid(i, p, q)) for i in range(0, nx + 1, bay)]
        ),
    }
    across = [j for j in range(n, ny, n) if j % bay]
    along = [i for i in range(n, nx, n) if i % bay]
    on_girders = [(i, j) for j in range(0, ny + 1, bay) for i in along]
    on_floors = [(i, j) for i in range(0, nx + 1, bay) for j in across]
    bars = {
        "bottom_bulbs": lines(nx, across, lambda j, p: grid(p, j, 0)),
        "top_bulbs": lines(nx, across, lambda j, p: grid(p, j, nz)),
        "girder_bars": lines(nz, on_girders, lambda ij, p: grid(ij[0], ij[1], p)),
        "floor_bars": lines(nz, on_floors, lambda ij, p: grid(ij[0], ij[1], p)),
    }
    bulb, (z, y) = bulb_flat()
    beside = (THICKNESS["girders"] + BAR[0]) / 2
    beams = {
        "bottom_bulbs": (bulb, (0, 0, 1), (0, y, THICKNESS["bottom"] / 2 + z)),
        "top_bulbs": (bulb, (0, 0, 1), (0, y, -THICKNESS["tank_top"] / 2 - z)),
        "girder_bars": (flat_bar(), (0, 1, 0), (0, beside, 0)),
        "floor_bars": (flat_bar(), (1, 0, 0), (beside, 0, 0)),
    }
    outfit = {"bottom": OUTFIT, "tank_top": OUTFIT}
    return Structure(
        grid.nodes(),
        shells=tuple(
            Shells(name, elements, STEEL, THICKNESS[name], nonstructural_mass=outfit.get(name, 0.0))
            for name, elements in quads.items()
        ),
        beams=tuple(
            Beams(
                name, bars[name], STEEL, section, *(np.array(v, dtype=float) for v in (web, offset, offset))
            )
            for name, (section, web, offset) in beams.items()
        ),
        name="double bottom",
    )
