"""Reference of the simple pendulum, in closed form by Jacobi's elliptic functions.

With the angle phi from the downward vertical and w = sqrt(g / l),

    phi'' = -w^2 sin(phi),   phi(0) = -pi/2,   phi'(0) = 0

has the solution  sin(phi / 2) = -k cd(w t, k^2)  with k = sin(pi / 4): L. D. Landau, E. M. Lifshitz,
"Mechanics", section 11; NIST Digital Library of Mathematical Functions, 22.19.

    python make_reference.py        writes reference.csv beside itself and prints the check by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj

GRAVITY = 9.81
LENGTH = 1.0
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]


def angles() -> Array:
    """Angle of the pendulum from the downward vertical at the sample times [rad]."""
    k = np.sin(np.pi / 4)
    _, cn, dn, _ = ellipj(np.sqrt(GRAVITY / LENGTH) * TIMES, k**2)
    return -2.0 * np.arcsin(k * cn / dn)


def angles_by_integration() -> Array:
    """The same from the differential equation."""

    def rate(_: float, y: Array) -> list[float]:
        return [y[1], -GRAVITY / LENGTH * np.sin(y[0])]

    start = [-0.5 * np.pi, 0.0]
    return solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=2.3e-14, atol=1e-14).y[0]


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the mass [m] by file name, shape (101, 4)."""
    phi = angles()
    place = [LENGTH * np.sin(phi), -LENGTH * np.cos(phi), np.zeros(101)]
    return {"reference.csv": np.column_stack([TIMES, *place])}


def main() -> None:
    """Write the table and print the check."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    difference = np.abs(angles() - angles_by_integration()).max()
    sys.stdout.write(f"closed form - DOP853: {difference:.1e} rad\n")


if __name__ == "__main__":
    main()
