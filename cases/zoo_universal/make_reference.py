"""Reference of two shafts with a universal joint: one coordinate, and its first integral.

The shafts make the angle beta. With the pins of the cross square to each other, the angles of the shafts obey

    tan(phi2) = cos(beta) tan(phi1),   r = dphi2/dphi1 = cos(beta) / (1 - sin(beta)^2 sin(phi1)^2),

and a constant torque M on the first shaft, from rates phi1'(0) = w and phi2'(0) = w cos(beta), gives

    1/2 (I1 + I2 r^2) phi1'^2 - M phi1 = E.

DOP853 integrates this equation of first order, and as a check the equation of second order.

    python make_reference.py        writes the tables and prints the check
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

BETA = np.pi / 6
FIRST, SECOND = 0.05, 0.08
TORQUE = 0.5
SPEED = 10.0
RIM = 0.2
DURATION = 5.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]


def ratio(phi: float | Array) -> float | Array:
    """Ratio r of the rates of the shafts."""
    return np.cos(BETA) / (1.0 - (np.sin(BETA) * np.sin(phi)) ** 2)


ENERGY = 0.5 * SPEED**2 * (FIRST + SECOND * ratio(0.0) ** 2)


def rate(phi: Array) -> Array:
    """Rate of the first shaft [rad/s] from the first integral."""
    return np.sqrt(2.0 * (ENERGY + TORQUE * phi) / (FIRST + SECOND * ratio(phi) ** 2))


def angle() -> Array:
    """Angle of the first shaft at the sample times [rad]."""
    return solve_ivp(
        lambda _, phi: rate(phi), (0.0, DURATION), [0.0], "DOP853", TIMES, rtol=3e-14, atol=1e-14
    ).y[0]


def angle_from_second_order() -> Array:
    """The same from Lagrange's equation."""

    def motion(_: float, y: Array) -> list[float]:
        r = ratio(y[0])
        slope = 2.0 * r**2 * np.sin(BETA) ** 2 * np.sin(y[0]) * np.cos(y[0]) / np.cos(BETA)
        return [y[1], (TORQUE - SECOND * r * slope * y[1] ** 2) / (FIRST + SECOND * r**2)]

    return solve_ivp(motion, (0.0, DURATION), [0.0, SPEED], "DOP853", TIMES, rtol=3e-14, atol=1e-14).y[0]


def references() -> dict[str, Array]:
    """Tables of time [s] and places on the rims [m], shape (101, 4), and of the second rate, shape (101, 2)."""
    phi = angle()
    c, s = np.cos(BETA), np.sin(BETA)
    # second shaft: the point is at z of the shaft for a zero angle and turns towards x cross z = -y of the shaft
    second = np.arctan2(c * np.sin(phi), np.cos(phi))
    across, up = RIM * np.sin(second), RIM * np.cos(second)
    first = [np.full(101, -1.0), -RIM * np.sin(phi), RIM * np.cos(phi)]
    return {
        "rim_1.csv": np.column_stack([TIMES, *first]),
        "rim_2.csv": np.column_stack([TIMES, c + s * across, s - c * across, up]),
        "rate_2.csv": np.column_stack([TIMES, ratio(phi) * rate(phi)]),
    }


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    difference = np.abs(angle() - angle_from_second_order()).max()
    sys.stdout.write(
        f"first integral - equation of second order: {difference:.1e} rad of {angle()[-1]:.1f} rad\n"
    )


if __name__ == "__main__":
    main()
