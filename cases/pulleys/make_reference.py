"""Reference of two fixed and two moving pulleys on one rope: constant accelerations, in closed form.

The rope runs from the ground down to pulley 1, up over a fixed pulley, down to pulley 2, up over another and
down to the box; only lengths of vertical parts change, 2 z1 + 2 z2 + z3 = const. With one tension T,

    M a1 = 2 T - M g,   M a2 = 2 T - M g,   m a3 = T - m g,   2 a1 + 2 a2 + a3 = 0    (up is positive)
    T = 5 g / (8 / M + 1 / m),   a1 = a2 = 2 T / M - g,   a3 = T / m - g

"Integrated simulation ... (2018)", eqs. 219 to 222. An elastic rope does the same if it starts with
the elongation of this tension: the elongation is then constant as well.

    python make_reference.py        writes the tables and prints the unstretched length and the checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.81
PULLEY, BOX = 20.0, 11.0
AXIAL_STIFFNESS = 1e7
RADIUS = 0.25
DROP, BOX_DROP = 5.0, 3.0
DURATION = 2.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]

TENSION = 5.0 * GRAVITY / (8.0 / PULLEY + 1.0 / BOX)
PATH = 4.0 * DROP + BOX_DROP + 4.0 * np.pi * RADIUS
# name: start x, start z, acceleration
BODIES = {
    "pulley_1": (RADIUS, -DROP, 2.0 * TENSION / PULLEY - GRAVITY),
    "pulley_2": (5.0 * RADIUS, -DROP, 2.0 * TENSION / PULLEY - GRAVITY),
    "box": (8.0 * RADIUS, -BOX_DROP, TENSION / BOX - GRAVITY),
}


def references() -> dict[str, Array]:
    """Tables of time [s] and place [m] by file name, shape (101, 4); of the tension [N], shape (101, 2)."""
    still = np.zeros(101)
    tables = {"tension.csv": np.column_stack([TIMES, still + TENSION])}
    for name, (x, z, acceleration) in BODIES.items():
        height = z + 0.5 * acceleration * TIMES**2
        tables[f"{name}.csv"] = np.column_stack([TIMES, still + x, still, height])
    return tables


def main() -> None:
    """Write the tables and print the checks."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    unstretched = PATH / (1.0 + TENSION / AXIAL_STIFFNESS)
    accelerations = {name: float(values[2]) for name, values in BODIES.items()}
    sys.stdout.write(f"tension {float(TENSION)!r} N, accelerations {accelerations} m/s^2\n")
    sys.stdout.write(f"path {float(PATH)!r} m, unstretched length {float(unstretched)!r} m\n")
    gain = sum(m * (0.5 * (a * DURATION) ** 2 + GRAVITY * 0.5 * a * DURATION**2) for m, a in _loads())
    sys.stdout.write(f"energy gained after {DURATION:g} s: {gain:.1e} J\n")


def _loads() -> list[tuple[float, float]]:
    """Mass and acceleration of the three bodies."""
    return [(BOX if name == "box" else PULLEY, values[2]) for name, values in BODIES.items()]


if __name__ == "__main__":
    main()
