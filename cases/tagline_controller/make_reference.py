"""Reference of the tagline: a mass on an elastic rope in a plane, with the law of the controller at every instant.

With the length l of the rope, its unit vector e towards the hook and the speed l' of its length,

    m r'' = m g + N e + (gust + force) ex,   N = max(0, EA (l - L) / L + c l'),   force = -K x - D x'  within the limit

    python make_reference.py        writes reference.csv beside itself
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

HERE = Path(__file__).parent
MASS, GRAVITY = 100e3, 9.81
LENGTH, STIFFNESS, ROPE_DAMPING = 25.0, 80e6, 200e3
SPRING, DAMPING, LIMIT = 2e4, 6e4, 1e5
TIMES = 0.1 * np.arange(401)

Array = NDArray[np.float64]


def rates(time: float, state: Array) -> list[float]:
    """Velocities and accelerations of the module in x and z."""
    x, z, u, w = state
    length = float(np.hypot(x, z))
    stretching = (x * u + z * w) / length
    pull = max(0.0, STIFFNESS * (length - LENGTH) / LENGTH + ROPE_DAMPING * stretching)
    gust = float(np.interp(time, [0.0, 0.5, 2.5, 3.0], [0.0, 50e3, 50e3, 0.0]))
    force = float(np.clip(-SPRING * x - DAMPING * u, -LIMIT, LIMIT))
    return [u, w, (gust + force - pull * x / length) / MASS, -pull * z / length / MASS - GRAVITY]


def positions() -> Array:
    """Of the module [m] at the sample times, shape (times, 3); pieces end where the gust has corners."""
    state = np.array([0.0, -LENGTH * (1.0 + MASS * GRAVITY / STIFFNESS), 0.0, 0.0])
    found = [state[[0, 1]]]
    for begin, end in zip((0, 5, 25, 30), (5, 25, 30, 400), strict=True):
        piece = TIMES[begin : end + 1]
        done = solve_ivp(
            rates, (piece[0], piece[-1]), state, "DOP853", t_eval=piece, rtol=1e-12, atol=1e-12, max_step=0.02
        )
        found += list(done.y.T[1:, :2])
        state = done.y[:, -1]
    x, z = np.array(found).T
    return np.column_stack([x, np.zeros_like(x), z])


def references() -> dict[str, Array]:
    """Stored tables by their names: times and positions."""
    return {"reference.csv": np.column_stack([TIMES, positions()])}


def main() -> None:
    """Write the reference."""
    for name, table in references().items():
        with (HERE / name).open("w", newline="", encoding="utf-8") as stream:
            rows = csv.writer(stream, lineterminator="\n")
            rows.writerow(["time", "x", "y", "z"])
            rows.writerows([f"{row[0]:.1f}", *(f"{v:.9f}" for v in row[1:])] for row in table)


if __name__ == "__main__":
    main()
