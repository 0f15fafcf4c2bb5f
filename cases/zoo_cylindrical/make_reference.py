"""Reference of a body that slides along a skew rod and turns about it: two motions that do not see each other.

The rod has the direction a, the centre of mass the distance d from it. The velocity of the centre along the
rod is square to that of turning, so with the travel s and the angle p from the lowest position

    s'' = -g a_z,                     s = v t - 1/2 g a_z t^2
    p'' = -w^2 sin(p),                w^2 = m d g sqrt(1 - a_z^2) / (J + m d^2)
    sin(p / 2) = k cd(w t, k^2),      k = sin(p0 / 2), from rest at p0

(Jacobi's elliptic functions), J being the moment of inertia about the rod through the centre.

    python make_reference.py        writes the tables and prints the check by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj

GRAVITY = 9.81
MASS, INERTIA = 2.0, 0.06
DISTANCE = 0.3
ALONG = np.array([1.0, 2.0, 2.0]) / 3.0
TO_CENTRE = np.array([14.0, -2.0, -5.0]) / 15.0
LOWEST = np.array([2.0, 4.0, -5.0]) / np.sqrt(45.0)
SPEED = 6.0
# marked points in the axes (to the centre, square to it, along the rod) of the body
POINTS = {"centre": np.array([DISTANCE, 0.0, 0.0]), "corner": np.array([0.2, 0.4, 0.3])}
DURATION = 3.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]

OMEGA = np.sqrt(MASS * DISTANCE * GRAVITY * np.sqrt(1.0 - ALONG[2] ** 2) / (INERTIA + MASS * DISTANCE**2))
# signed angle of the centre from the lowest position at the start, about the rod
AT_START = np.arctan2(np.cross(LOWEST, TO_CENTRE) @ ALONG, LOWEST @ TO_CENTRE)


def angle() -> Array:
    """Angle from the lowest position at the sample times [rad]."""
    k = np.sin(0.5 * AT_START)
    _, cn, dn, _ = ellipj(OMEGA * TIMES, k**2)
    return 2.0 * np.arcsin(k * cn / dn)


def travel() -> Array:
    """Travel along the rod at the sample times [m]."""
    return SPEED * TIMES - 0.5 * GRAVITY * ALONG[2] * TIMES**2


def references() -> dict[str, Array]:
    """Tables of time [s] and places [m], shape (101, 4); of travel [m] and turn [rad], shape (101, 2)."""
    turn = angle() - AT_START
    side = np.cross(ALONG, TO_CENTRE)
    tables = {
        "travel.csv": np.column_stack([TIMES, travel()]),
        "turn.csv": np.column_stack([TIMES, turn]),
    }
    for name, (x, y, z) in POINTS.items():
        outward = np.outer(np.cos(turn), TO_CENTRE) + np.outer(np.sin(turn), side)
        sideways = np.outer(np.cos(turn), side) - np.outer(np.sin(turn), TO_CENTRE)
        place = x * outward + y * sideways + np.outer(travel() + z, ALONG)
        tables[f"{name}.csv"] = np.column_stack([TIMES, place])
    return tables


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    other = solve_ivp(
        lambda _, y: [y[1], -(OMEGA**2) * np.sin(y[0])],
        (0.0, DURATION),
        [AT_START, 0.0],
        "DOP853",
        TIMES,
        rtol=3e-14,
        atol=1e-14,
    ).y[0]
    sys.stdout.write(f"closed form - DOP853: {np.abs(angle() - other).max():.1e} rad\n")


if __name__ == "__main__":
    main()
