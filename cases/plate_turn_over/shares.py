"""Shares of the loaders at the edge from moments: what they carry at rest as recorded, and as positions say.

    heavylift simulate cases/plate_turn_over/steel.toml
    python shares.py steel thin                     after their runs

Of a run only positions are used: of nodes and rims, and where the beams of the loaders are and how they lean. Centre of
mass and lugs are those of the bicubic shape. Each line runs from its lug to its pulley, which slides on a guide of the
beam, and all of a loader pull alike along the guide. Forces along z and moments about y then give the tensions of the
edge and inside: with vertical lines, with lines as they lean, and with the rates of the momenta of plate and rims
besides, from differences of velocities.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from make_case import INSIDE, LINES, LOWER, MESHES, PLATES, RIMS, SHELL, UPPER

from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.results.histories import Results, load_results

HERE = Path(__file__).resolve().parent
GRAVITY = 9.81  # m/s^2
SIZE = np.array([30.0, 20.0])  # m
OUTLET = 1.5  # m, below the hinge of a beam
LENGTH = 10.5  # m, of lines as drawn, from the pulleys to lugs below them
STIFFNESS = 300e6  # N, of a line


class Shares(NamedTuple):
    """Of the edge: recorded; from moments with vertical lines, with leaning ones, and with momenta."""

    recorded: float
    vertical: float
    leaning: float
    moving: float


class Plate:
    """The recorded shape of the plate."""

    def __init__(self, results: Results, name: str, elements: tuple[int, int]) -> None:
        thickness, density, _ = PLATES[name]
        self.elements, self.lengths = np.array(elements), SIZE / elements
        self.area_mass = float(thickness.removesuffix(" mm")) * 1e-3 * float(density.removesuffix(" kg/m^3"))
        shape = (len(results.time), *(self.elements + 1), 3)
        columns = ("position", "slope_x", "slope_y", "twist", "velocity")
        r, rx, ry, rxy, self.velocity = (results[f"plate.{name}"].reshape(shape) for name in columns)
        self.vectors = np.array([[r, ry], [rx, rxy]])  # by derivatives along x and y

    def point(self, record: int, x: float, y: float) -> np.ndarray:
        """A point of the shape, by its place in the mesh [m]."""
        total = np.zeros(3)
        place = np.array([x, y]) / self.lengths
        first = np.minimum(place.astype(int), self.elements - 1)
        f, g = (_hermite(t, length) for t, length in zip(place - first, self.lengths, strict=True))
        for i, j, a, b in np.ndindex(2, 2, 2, 2):
            total += f[i, a] * g[j, b] * self.vectors[a, b, record, first[0] + i, first[1] + j]
        return total

    def centre(self, record: int) -> np.ndarray:
        """Centre of mass."""
        f, g = (_integrals(n, length) for n, length in zip(self.elements, self.lengths, strict=True))
        return np.einsum("ai,bj,abijk->k", f, g, self.vectors[:, :, record]) / SIZE.prod()

    def momenta(self, record: int) -> tuple[np.ndarray, np.ndarray]:
        """Linear and angular momentum about the origin, of masses at the nodes."""
        mass = np.outer(
            *(_integrals(n, length)[0] for n, length in zip(self.elements, self.lengths, strict=True))
        )
        part = self.area_mass * mass[..., None] * self.velocity[record]
        return part.sum(axis=(0, 1)), np.cross(self.vectors[0, 0, record], part).sum(axis=(0, 1))


def _hermite(t: float, length: float) -> np.ndarray:
    """Functions of value and slope at both ends, shape (ends, 2)."""
    ends = [
        [(1 - t) ** 2 * (1 + 2 * t), length * t * (1 - t) ** 2],
        [t * t * (3 - 2 * t), length * t * t * (t - 1)],
    ]
    return np.array(ends)


def _integrals(count: int, length: float) -> np.ndarray:
    """Of these functions along a line of elements, shape (2, nodes)."""
    value, slope = np.full(count + 1, length), np.zeros(count + 1)
    value[[0, -1]] *= 0.5
    slope[0], slope[-1] = length**2 / 12.0, -(length**2) / 12.0
    return np.array([value, slope])


def _lines(results: Results, plate: Plate, record: int, loader: int) -> tuple[np.ndarray, np.ndarray]:
    """Lugs and forces of the five lines of a loader, shapes (5, 3)."""
    beam = results[f"loader_{loader}_beam.position"][record]
    R = rotation_matrix(results[f"loader_{loader}_beam.orientation"][record])
    tension = 2.0 * results[f"loader_{loader}_rope.tension"][record]
    guide, lugs, forces = -R[:, 2], [], []
    for along, inside in zip(LINES, INSIDE, strict=True):
        outlet = beam + R @ [along, 0.0, -OUTLET]
        if loader == 3:
            lug, beside = plate.point(record, 15.0 - LOWER, 10.0 + inside), inside - along
        else:
            rims = rotation_matrix(results["rims.orientation"][record])
            side = -5.0 if loader == 1 else 5.0
            lug, beside = results["rims.position"][record] + rims @ [UPPER, side + along, 0.0], 0.0
        reach = lug - outlet
        depth, force = reach @ guide, tension
        square = reach @ reach - depth**2
        for _ in range(20):  # the line stretches, and pulls the more the more it leans
            length = np.hypot(LENGTH, beside) * (1.0 + force / STIFFNESS)
            cosine = np.sqrt(1.0 - square / length**2)
            force = tension / cosine
        pulley = outlet + (depth - length * cosine) * guide
        lugs.append(lug)
        forces.append(force * (pulley - lug) / np.linalg.norm(pulley - lug))
    return np.array(lugs), np.array(forces)


def shares(results: Results, name: str, elements: tuple[int, int], record: int) -> Shares:
    """At a record."""
    plate = Plate(results, name, elements)
    lines = [_lines(results, plate, record, loader) for loader in (1, 2, 3)]
    tensions = np.array([results[f"loader_{loader}_rope.tension"][record] for loader in (1, 2, 3)])
    masses = plate.area_mass * SIZE.prod(), 1e3 * RIMS
    centres = plate.centre(record), results["rims.position"][record]
    weight = GRAVITY * sum(masses)
    moment = sum(-m * GRAVITY * c[0] for m, c in zip(masses, centres, strict=True))
    rates = []
    for at in (record - 1, record + 1):
        P, H = plate.momenta(at)
        v = masses[1] * results["rims.velocity"][at]
        rates.append(np.concatenate([P + v, H + np.cross(results["rims.position"][at], v)]))
    rate = (rates[1] - rates[0]) / (results.time[record + 1] - results.time[record - 1])
    found = []
    for upright, moving in ((1.0, 0.0), (0.0, 0.0), (0.0, 1.0)):
        acts = np.zeros((2, 2))  # forces along z and moments -about y, of the edge and inside
        for (lugs, forces), side in zip(lines, (0, 0, 1), strict=True):
            pulls = forces * [1.0 - upright, 1.0, 1.0]
            acts[0, side] += pulls[:, 2].sum()
            acts[1, side] += (lugs[:, 0] * pulls[:, 2] - lugs[:, 2] * pulls[:, 0]).sum()
        wanted = np.array([weight + moving * rate[2], -moment - moving * rate[4]])
        edge, inside = np.linalg.solve(acts, wanted) * [tensions[:2].sum(), tensions[2]]
        found.append(float(edge / (edge + inside)))
    return Shares(float(tensions[:2].sum() / tensions.sum()), *found)


def main() -> None:
    """Print those of some runs at rest."""
    for word in sys.argv[1:]:
        name, _, mesh = word.partition("_")
        results = load_results(HERE / f"{word}.toml")
        elements = MESHES["_" + mesh if mesh else ""]
        for angle, time in zip(SHELL.angles, SHELL.moves()[2], strict=True):
            record = int(np.searchsorted(results.time, time - 1e-6))
            if angle < 90.0:
                row = "  ".join(f"{share:.4f}" for share in shares(results, name, elements, record))
                sys.stdout.write(f"{word} {angle:3.0f} deg: {row}\n")


if __name__ == "__main__":
    main()
