"""Reference of the chain of n rigid rods: its n absolute angles.

Rod j points along (cos t_j, sin t_j), hangs at the end of rod j - 1 and has the same mass and length
as the others (1 kg, 1 m). The kinetic energy is 1/2 sum_jk A_jk cos(t_j - t_k) t_j' t_k' with

    A_jk = n - 1 - max(j, k) + 1/2  (j != k),   A_jj = n - 1 - j + 1/3,   j, k = 0 ... n - 1

(whole rods further out, plus the rod itself), and gravity loads rod j with the weight of
n - 1 - j + 1/2 rods at its end:

    sum_k A_jk (cos(t_j - t_k) t_k'' + sin(t_j - t_k) t_k'^2) = -g (n - 1/2 - j) cos(t_j)

Released at rest with all angles zero, integrated by DOP853.

    python make_reference.py        writes reference_N.csv beside itself and prints its checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import solve

GRAVITY = 9.81
DURATION = 2.0
TIMES = DURATION * np.arange(101) / 100
COUNTS = (10, 50, 200)

Array = NDArray[np.float64]


def carried(n: int) -> tuple[Array, Array]:
    """Inertia A [kg m^2], shape (n, n), and loads in rods, shape (n,)."""
    j = np.arange(n)
    load = n - 0.5 - j
    A = np.minimum(load[:, np.newaxis], load)
    A[j, j] = load - 0.5 + 1.0 / 3.0
    return A, load


def solution(n: int) -> Array:
    """Angles and their rates at the sample times, shape (101, 2 n)."""
    A, load = carried(n)

    def rate(_: float, y: Array) -> Array:
        angle, speed = y[:n], y[n:]
        e = np.exp(1j * angle)
        turn = np.outer(e, e.conj())  # cos + i sin of t_j - t_k
        torque = -GRAVITY * load * e.real - (A * turn.imag) @ speed**2
        return np.concatenate([speed, solve(A * turn.real, torque, assume_a="pos")])

    tolerance = {"rtol": 1e-12 if n > 100 else 3e-14, "atol": 1e-13}
    return solve_ivp(rate, (0.0, DURATION), np.zeros(2 * n), "DOP853", TIMES, **tolerance).y.T


def energy(y: Array) -> float:
    """Kinetic energy and energy of gravity [J]."""
    n = len(y) // 2
    A, load = carried(n)
    angle, speed = y[:n], y[n:]
    M = A * np.cos(angle[:, np.newaxis] - angle)
    return 0.5 * speed @ M @ speed + GRAVITY * load @ np.sin(angle)


def tip(y: Array) -> Array:
    """Time and place of the free end."""
    angle = y[:, : y.shape[1] // 2]
    return np.column_stack([TIMES, np.cos(angle).sum(1), np.sin(angle).sum(1), np.zeros(len(y))])


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the free end [m] by file name, shape (101, 4)."""
    return {f"reference_{n}.csv": tip(solution(n)) for n in COUNTS}


def main() -> None:
    """Write the tables and print the checks."""
    for n in COUNTS:
        y = solution(n)
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in tip(y).tolist())]
        Path(__file__).with_name(f"reference_{n}.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        sys.stdout.write(f"{n:3d} rods: energy off by {np.ptp([energy(row) for row in y]):.1e} J\n")


if __name__ == "__main__":
    main()
