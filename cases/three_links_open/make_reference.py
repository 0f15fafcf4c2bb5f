"""Reference of three links in a row: their absolute angles.

Link j points along (cos t_j, 0, sin t_j), j = 0, 1, 2. With mass m, length l and moment of inertia J about
the centre, and n_j = 5/2 - j links' weight at its end, Lagrange's equations are

    sum_k A_jk (cos(t_j - t_k) t_k'' + sin(t_j - t_k) t_k'^2) = -n_j m g l cos(t_j)
    A_jk = min(n_j, n_k) m l^2  (j != k),   A_jj = (n_j - 1/4) m l^2 + J

Released at rest with all angles zero, integrated by DOP853.

    python make_reference.py        writes reference_K.csv, the centre of link K, and prints the check
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
MASS, LENGTH, SECTION = 1000.0, 10.0, 0.5
INERTIA = MASS * (LENGTH**2 + SECTION**2) / 12.0
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100

LOAD = np.array([2.5, 1.5, 0.5])
A = MASS * LENGTH**2 * np.minimum(LOAD[:, np.newaxis], LOAD)
A[np.diag_indices(3)] += INERTIA - 0.25 * MASS * LENGTH**2

Array = NDArray[np.float64]


def rate(_: float, y: Array) -> Array:
    """Rates of the angles and their second derivatives."""
    angle, speed = y[:3], y[3:]
    between = angle[:, np.newaxis] - angle
    torque = -MASS * GRAVITY * LENGTH * LOAD * np.cos(angle) - (A * np.sin(between)) @ speed**2
    return np.concatenate([speed, np.linalg.solve(A * np.cos(between), torque)])


def solution() -> Array:
    """Angles and their rates at the sample times, shape (101, 6)."""
    return solve_ivp(rate, (0.0, DURATION), np.zeros(6), "DOP853", TIMES, rtol=3e-14, atol=1e-14).y.T


def energy(y: Array) -> float:
    """Kinetic energy and energy of gravity [J]."""
    angle, speed = y[:3], y[3:]
    M = A * np.cos(angle[:, np.newaxis] - angle)
    return 0.5 * speed @ M @ speed + MASS * GRAVITY * LENGTH * LOAD @ np.sin(angle)


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the centre of a link [m] by file name, shape (101, 4)."""
    angle = solution()[:, :3]
    step = LENGTH * np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=-1)
    centre = np.cumsum(step, axis=1) - 0.5 * step
    return {f"reference_{k + 1}.csv": np.column_stack([TIMES, centre[:, k]]) for k in range(3)}


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    drift = np.ptp([energy(y) for y in solution()])
    sys.stdout.write(f"energy off by {drift:.1e} J of {MASS * GRAVITY * LENGTH:.0f} J\n")
    looser = solve_ivp(rate, (0.0, DURATION), np.zeros(6), "DOP853", TIMES, rtol=3e-13, atol=1e-13).y.T
    sys.stdout.write(
        f"ten times the tolerance moves the angles by {np.abs(looser - solution())[:, :3].max():.1e} rad\n"
    )


if __name__ == "__main__":
    main()
