"""Ranges of motion and largest tensions of the barge in the six waves of Table 3-12, for the table of README.md.

Frequency domain, first order: barge.nc, a box of uniform mass, four springs 5 m above the water. What the thesis does
not say is assumed (draft, depth of water, masses, heights of the springs): the numbers show a trend and judge nothing.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from heavylift.preprocess.hydrodynamics.netcdf_files import read_netcdf

LENGTH, BREADTH, DRAFT = 182.0, 70.0, 5.5
DENSITY, GRAVITY = 1025.0, 9.80665
HEIGHT = 1.0
STIFFNESS, PRETENSION, SPAN, ABOVE = 429.2e3, 98.1e3, 50.0, 5.0
"""Of a spring [N/m], [N], [m], and above the water [m]."""
FAIRLEADS = {"S": (0.0, -35.0), "N": (0.0, 35.0), "E": (91.0, 0.0), "W": (-91.0, 0.0)}
WAVES = {1: (8, 0), 2: (8, 30), 3: (8, 90), 4: (10, 0), 5: (10, 30), 6: (10, 90)}
"""Period [s] and heading [deg] by the number of the case."""


def motion(database, period, heading):
    """Complex amplitudes of surge to yaw about the water plane, shape (6,), in a wave of unit amplitude."""
    w, beta = 2.0 * math.pi / period, math.radians(heading)
    mass = DENSITY * LENGTH * BREADTH * DRAFT
    M = mass * np.diag([1.0, 1.0, 1.0, (0.35 * BREADTH) ** 2, (0.25 * LENGTH) ** 2, (0.25 * LENGTH) ** 2])
    buoyant = DENSITY * GRAVITY * LENGTH * BREADTH
    lever = mass * GRAVITY * 0.5 * DRAFT  # of the centre of mass, in the water plane, above that of buoyancy
    C = np.diag(
        [0.0, 0.0, buoyant, buoyant * BREADTH**2 / 12.0 - lever, buoyant * LENGTH**2 / 12.0 - lever, 0.0]
    )
    for x, y in FAIRLEADS.values():
        C += spring_stiffness(np.array([x, y, ABOVE]))
    A, B = (np.array([[np.interp(w, database.omega, X[:, i, j]) for j in range(6)] for i in range(6)])
            for X in (database.added_mass, database.damping))  # fmt: skip
    row = int(np.argmin(np.abs(database.headings - beta)))
    assert abs(database.headings[row] - beta) < 1e-9
    X = np.array([np.interp(w, database.omega, column) for column in database.excitation[:, row].T])
    return np.linalg.solve(C - w * w * (M + A) - 1j * w * B, X)


def spring_stiffness(point):
    """Stiffness of a spring about the water plane, shape (6, 6): along it k, across it the tension over its length."""
    along = np.array([point[0], point[1], 0.0])
    along /= np.linalg.norm(along)
    K = STIFFNESS * np.outer(along, along) + PRETENSION / SPAN * (np.eye(3) - np.outer(along, along))
    x, y, z = point
    to_point = np.hstack([np.eye(3), [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]])
    found = to_point.T @ K @ to_point
    # the tension pulls on a point that a turn about z moves sideways
    found[5, 5] += PRETENSION * float(np.hypot(x, y))
    return found


def main() -> None:
    """Print a row for each wave."""
    database = read_netcdf(Path(__file__).parent / "barge.nc")
    phase = np.exp(-1j * np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False))
    for number, (period, heading) in WAVES.items():
        q = 0.5 * HEIGHT * motion(database, period, heading)
        ranges = 2.0 * np.abs(q) * np.array([1.0, 1.0, 1.0, *[180.0 / math.pi] * 3])
        history = np.real(np.outer(phase, q))
        tensions = []
        for x, y in FAIRLEADS.values():
            fairlead = np.array([x, y, ABOVE])
            anchor = fairlead + SPAN * np.array([x, y, 0.0]) / math.hypot(x, y)
            place = fairlead + history[:, :3] + np.cross(history[:, 3:], fairlead)
            length = np.linalg.norm(anchor - place, axis=1)
            tensions.append(float(np.max(PRETENSION + STIFFNESS * (length - SPAN))) / 1e3)
        cells = [f"{value:.3f}" for value in ranges] + [f"{value:.1f}" for value in tensions]
        sys.stdout.write(f"| {number} | {' | '.join(cells)} |\n")


if __name__ == "__main__":
    main()
