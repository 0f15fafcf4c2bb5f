"""Reference of a pendulum whose pivot slides down a rail: the travel follows from the angle.

The rail goes down by delta; p is the angle of the pendulum from the direction square to the rail. Along the rail
only gravity acts, so the centre of mass falls along it as if it were free, and what is left is one equation:

    s + l sin(p) = s0 + l sin(p0) + 1/2 g sin(delta) t^2
    (J + m l^2 sin(p)^2) p'' + m l^2 sin(p) cos(p) p'^2 = -m g cos(delta) l sin(p)

Released at rest; integrated by DOP853, and as a check with both coordinates.

    python make_reference.py        writes the tables and prints the checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
MASS, INERTIA, LENGTH = 2.0, 0.15, 0.5
SLOPE = np.radians(20.0)
HANG = np.radians(80.0)  # of the pendulum from the vertical at the start, towards downhill
START = HANG + SLOPE
DURATION = 3.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]


def solution() -> Array:
    """Angle p and its rate at the sample times, shape (101, 2)."""
    m = MASS * LENGTH**2

    def rate(_: float, y: Array) -> list[float]:
        s, c = np.sin(y[0]), np.cos(y[0])
        pull = -MASS * GRAVITY * np.cos(SLOPE) * LENGTH * s
        return [y[1], (pull - m * s * c * y[1] ** 2) / (INERTIA + m * s**2)]

    return solve_ivp(rate, (0.0, DURATION), [START, 0.0], "DOP853", TIMES, rtol=3e-14, atol=1e-14).y.T


def travel(p: Array) -> Array:
    """Travel of the pivot along the rail [m]."""
    return LENGTH * (np.sin(START) - np.sin(p)) + 0.5 * GRAVITY * np.sin(SLOPE) * TIMES**2


def both_coordinates() -> Array:
    """Angle from the vertical and travel by Lagrange's equations of both, shape (101, 2)."""

    def rate(_: float, y: Array) -> Array:
        hang, _, dh, ds = y
        c, s = np.cos(hang + SLOPE), np.sin(hang + SLOPE)
        M = MASS * np.array([[INERTIA / MASS + LENGTH**2, LENGTH * c], [LENGTH * c, 1.0]])
        Q = MASS * np.array([-GRAVITY * LENGTH * np.sin(hang), GRAVITY * np.sin(SLOPE) + LENGTH * s * dh**2])
        return np.concatenate([[dh, ds], np.linalg.solve(M, Q)])

    start = [HANG, 0.0, 0.0, 0.0]
    return solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=3e-14, atol=1e-14).y[:2].T


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the centre of mass [m], shape (101, 4); of the travel [m], shape (101, 2)."""
    p = solution()[:, 0]
    s, hang = travel(p), p - SLOPE
    x = s * np.cos(SLOPE) + LENGTH * np.sin(hang)
    z = -s * np.sin(SLOPE) - LENGTH * np.cos(hang)
    return {
        "centre.csv": np.column_stack([TIMES, x, np.zeros(101), z]),
        "travel.csv": np.column_stack([TIMES, s]),
    }


def main() -> None:
    """Write the tables and print the checks."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    p, other = solution()[:, 0], both_coordinates()
    difference = max(np.abs(p - SLOPE - other[:, 0]).max(), np.abs(travel(p) - other[:, 1]).max())
    sys.stdout.write(f"one coordinate - two coordinates: {difference:.1e}\n")


if __name__ == "__main__":
    main()
