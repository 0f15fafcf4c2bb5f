"""Reference of two fixed and two moving pulleys with an efficiency on one rope: accelerations, in closed form.

The box goes down and draws the rope over all pulleys towards it, so each part has eta times the tension of the next
one, ``T_k = T_5 eta^(5-k)``, as far as the rope slides. Up is positive:

    M a1 = T1 + T2 - M g,   M a2 = T3 + T4 - M g,   m a3 = T5 - m g,   2 a1 + 2 a2 + a3 = 0

Where that lets pulley 1 go down, it does not move at all: a1 = 0, T1 + T2 = M g, and the other equations stay.

    python make_reference.py        writes the table and prints the efficiency at which pulley 1 begins to stick
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.81
PULLEY, BOX = 20.0, 11.0
EFFICIENCIES = (1.0, 0.999, 0.998, 0.995, 0.99, 0.98, 0.96, 0.95, 0.94)
NAME = "accelerations.csv"
HEADER = "efficiency,sticks,acceleration_pulley_1,acceleration_pulley_2,acceleration_box,tension_at_box"

Array = NDArray[np.float64]


def motion(eta: float) -> tuple[float, ...]:
    """Whether pulley 1 sticks, accelerations [m/s^2], tension at the box [N]."""
    pair_1, pair_2 = eta**4 + eta**3, eta**2 + eta
    tension = 5.0 * GRAVITY / (2.0 * (pair_1 + pair_2) / PULLEY + 1.0 / BOX)
    first = pair_1 * tension / PULLEY - GRAVITY
    if first < 0.0:
        tension = 3.0 * GRAVITY / (2.0 * pair_2 / PULLEY + 1.0 / BOX)
        first = 0.0
    second, box = pair_2 * tension / PULLEY - GRAVITY, tension / BOX - GRAVITY
    return float(first == 0.0), first, second, box, tension


def references() -> dict[str, Array]:
    """The table, one row an efficiency."""
    return {NAME: np.array([(eta, *motion(eta)) for eta in EFFICIENCIES])}


def main() -> int:
    """Write the table."""
    text = (
        "# closed form, make_reference.py: efficiency, 1 if pulley 1 sticks, m/s^2 upwards, N\n"
        + HEADER
        + "\n"
    )
    for row in references()[NAME]:
        text += ",".join(f"{value:.12g}" for value in row) + "\n"
    (Path(__file__).parent / NAME).write_text(text, encoding="utf-8")
    low, high = 0.9, 1.0
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if motion(middle)[0] else (low, middle)
    sys.stdout.write(f"pulley 1 sticks below {low:.6f}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
