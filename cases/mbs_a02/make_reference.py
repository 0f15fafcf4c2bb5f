"""Reference of the chain of four-bars: one coordinate, in closed form by Jacobi's amplitude.

All n + 1 cranks keep the same angle phi from the upright position and the n couplers only translate.
With rods of 1 m and 1 kg that is

    J phi'' = P g sin(phi),   J = (n + 1) / 3 + n,   P = (n + 1) / 2 + n,   phi(0) = 0,   phi'(0) = 1 rad/s,

a pendulum that turns over. Its energy gives, with a = P g / J and v = phi / 2 - pi / 2,

    v' = 1/2 sqrt(1 + 4 a) sqrt(1 - m sin(v)^2),   m = 4 a / (1 + 4 a),   v(0) = -pi / 2,

so that v = am(1/2 sqrt(1 + 4 a) t - K(m), m): NIST Digital Library of Mathematical Functions, 22.16, 22.19.

    python make_reference.py        writes reference_N.csv beside itself and prints the checks by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipkm1

GRAVITY = 9.81
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100
COUNTS = (1, 2, 5, 10, 20, 40)

Array = NDArray[np.float64]


def load_over_inertia(n: int) -> float:
    """The ratio P g / J of a chain of n loops [1/s^2]."""
    return GRAVITY * (0.5 * (n + 1) + n) / ((n + 1) / 3.0 + n)


def angles(n: int) -> Array:
    """Angle of the cranks from the upright position at the sample times [rad]."""
    a = load_over_inertia(n)
    m = 4.0 * a / (1.0 + 4.0 * a)
    argument = 0.5 * np.sqrt(1.0 + 4.0 * a) * TIMES - ellipkm1(1.0 / (1.0 + 4.0 * a))
    return 2.0 * ellipj(argument, m)[3] + np.pi


def angles_by_integration(n: int) -> Array:
    """The same from the differential equation."""
    a = load_over_inertia(n)

    def rate(_: float, y: Array) -> list[float]:
        return [y[1], a * np.sin(y[0])]

    return solve_ivp(rate, (0.0, DURATION), [0.0, 1.0], "DOP853", TIMES, rtol=2.3e-14, atol=1e-14).y[0]


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the tip of the first crank [m] by file name, shape (101, 4)."""
    tables = {}
    for n in COUNTS:
        phi = angles(n)
        tables[f"reference_{n}.csv"] = np.column_stack([TIMES, np.sin(phi), np.cos(phi), np.zeros(101)])
    return tables


def main() -> None:
    """Write the tables and print the checks."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    for n in COUNTS:
        difference = np.abs(angles(n) - angles_by_integration(n)).max()
        sys.stdout.write(f"{n:2d} loops: closed form - DOP853: {difference:.1e} rad\n")


if __name__ == "__main__":
    main()
