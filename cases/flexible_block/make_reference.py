"""Loads of bogies and bending stress of a beam on springs over the sag: finite elements of a Timoshenko beam, NumPy only."""

from __future__ import annotations

import numpy as np

LENGTH, WIDTH, HEIGHT = 25.2, 4.0, 1.95
YOUNG, POISSON, DENSITY, GRAVITY = 30e9, 0.2, 2400.0, 9.81
AREA, INERTIA = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0
SHEAR = YOUNG / (2.0 * (1.0 + POISSON)) * AREA * 5.0 / 6.0
ROWS = np.array([11.9 - 1.4 * i for i in range(18)])
SAG, TYRE, PIPE = 0.05, 3e6, 1e9


def beam(elements_a_row: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Loads of the rows (one bogie of two) [N] and bending moment at the middle [N m], by rows of the springs."""
    l = 1.4 / elements_a_row
    count = round(LENGTH / l)
    n = count + 1
    x = -0.5 * LENGTH + l * np.arange(n)
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
    spring = 2.0 / (1.0 / TYRE + 1.0 / PIPE)
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


if __name__ == "__main__":
    loads, (moment, middle, end) = beam()
    rigid = ROWS**2 - np.mean(ROWS**2)
    mean = DENSITY * AREA * LENGTH * GRAVITY / 36.0
    k = 1.0 / (1.0 / TYRE + 1.0 / PIPE)
    stiff = mean + k * SAG * (2.0 / LENGTH) ** 2 * rigid
    print(f"mean {mean:.1f} N; stiff block {stiff.min():.1f} ... {stiff.max():.1f} N")
    print(f"beam {loads.min():.1f} ... {loads.max():.1f} N, moment {moment:.6g} N m,", end=" ")
    print(f"stress {moment / (WIDTH * HEIGHT**2 / 6.0):.6g} Pa, bends by {1e3 * (middle - end):.4g} mm")
