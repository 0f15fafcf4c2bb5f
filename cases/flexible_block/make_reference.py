"""Loads of bogies and bending stress of a slab on springs in a sag: finite elements of a Timoshenko beam, NumPy alone.

python make_reference.py        writes the table and prints moment, stress and bending
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

LENGTH, WIDTH, HEIGHT = 25.2, 4.0, 1.95
YOUNG, POISSON, DENSITY, GRAVITY = 30e9, 0.2, 2400.0, 9.81
AREA, INERTIA = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0
SHEAR = YOUNG / (2.0 * (1.0 + POISSON)) * AREA * 5.0 / 6.0
ROWS = np.array([11.9 - 1.4 * i for i in range(18)])
SAG, SPRING = 0.05, 1.0 / (1.0 / 3e6 + 1.0 / 1e9)


def beam(elements_a_row: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Loads of a bogie by lines [N]; bending moment of the middle [N m], sinking of the middle and of an end [m]."""
    l = 1.4 / elements_a_row
    count = round(LENGTH / l)
    n = count + 1
    phi = 12.0 * YOUNG * INERTIA / (SHEAR * l * l)
    k = (
        YOUNG
        * INERTIA
        / (l**3 * (1.0 + phi))
        * np.array(
            [
                [12, 6 * l, -12, 6 * l],
                [6 * l, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l],
                [-12, -6 * l, 12, -6 * l],
                [6 * l, (2 - phi) * l * l, -6 * l, (4 + phi) * l * l],
            ]
        )
    )
    w = DENSITY * AREA * GRAVITY
    K, f = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    for e in range(count):
        at = slice(2 * e, 2 * e + 4)
        K[at, at] += k
        f[at] -= w * l * np.array([0.5, l / 12.0, 0.5, -l / 12.0])
    spring = 2.0 * SPRING
    nodes = np.round((ROWS + 0.5 * LENGTH) / l).astype(int)
    road = -SAG * (1.0 - (2.0 * ROWS / LENGTH) ** 2)
    for node, height in zip(nodes, road, strict=True):
        K[2 * node, 2 * node] += spring
        f[2 * node] += spring * height
    u = np.linalg.solve(K, f)
    loads = spring * (road - u[2 * nodes])
    right = ROWS > 0.0
    moment = loads[right] @ ROWS[right] - w * (0.5 * LENGTH) ** 2 / 2.0
    return 0.5 * loads, np.array([moment, u[2 * (n // 2)], u[0]])


def references() -> dict[str, np.ndarray]:
    """Loads of a bogie by lines [N]: place [m], in groups, under a stiff slab and under the beam on springs."""
    mean = DENSITY * AREA * LENGTH * GRAVITY / 36.0
    stiff = mean + SPRING * SAG * (2.0 / LENGTH) ** 2 * (ROWS**2 - np.mean(ROWS**2))
    return {"line_loads.csv": np.column_stack([ROWS, np.full(len(ROWS), mean), stiff, beam()[0]])}


if __name__ == "__main__":
    head = "# loads of a bogie at rest in the sag [N], places x [m]\nx,groups,stiff,beam\n"
    for name, table in references().items():
        with (Path(__file__).parent / name).open("w", encoding="utf-8") as file:
            file.write(head)
            np.savetxt(file, table, "%.12g", ",")
    _, (moment, middle, end) = beam()
    sys.stdout.write(f"moment {moment:.6g} N m, stress {moment / (WIDTH * HEIGHT**2 / 6.0):.6g} Pa, ")
    sys.stdout.write(f"bends by {1e3 * (middle - end):.4g} mm\n")
