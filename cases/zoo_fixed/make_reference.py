"""Reference of two rods fixed together at a right angle: one compound pendulum, and the load of the fixture.

Rod 1 goes from the hinge, axis y, square to it; rod 2 from its end parallel to the hinge axis. With the
angle p from the downward vertical,

    p'' = -w^2 sin(p),  w^2 = g sum_k m_k d_k / sum_k (J_k + m_k d_k^2):   sin(p / 2) = -k cd(w t, k^2), k = sin(pi / 4)

from rest at p = -pi/2 (Jacobi's elliptic functions). The fixture carries rod 2, whose centre c2 follows a
circle of radius d2 and lies at r from the fixture along y:

    F = m2 (c2'' + g e_z),   M = J2 p'' e + r x F,     e = -e_y: the sense of p

    python make_reference.py        writes the tables and prints the check by DOP853
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj

GRAVITY = 9.81
FIRST = {"mass": 2.0, "inertia": 2.0 / 12.0, "distance": 0.5}
SECOND = {"mass": 1.0, "inertia": 5e-4, "distance": 1.0}
HALF = np.array([0.0, 0.3, 0.0])
DURATION = 5.0
TIMES = DURATION * np.arange(101) / 100

Array = NDArray[np.float64]

MOMENT = sum(part["mass"] * part["distance"] for part in (FIRST, SECOND))
INERTIA = sum(part["inertia"] + part["mass"] * part["distance"] ** 2 for part in (FIRST, SECOND))
OMEGA = np.sqrt(GRAVITY * MOMENT / INERTIA)


def angle() -> Array:
    """Angle from the downward vertical at the sample times [rad]."""
    k = np.sin(np.pi / 4)
    _, cn, dn, _ = ellipj(OMEGA * TIMES, k**2)
    return -2.0 * np.arcsin(k * cn / dn)


def references() -> dict[str, Array]:
    """Tables of time [s] and place [m], force [N] and moment [N m], shape (101, 4)."""
    p = angle()
    still, s, c = np.zeros(101), np.sin(p), np.cos(p)
    d, m = SECOND["distance"], SECOND["mass"]
    speed2, turning = 2.0 * OMEGA**2 * c, -(OMEGA**2) * s  # p'^2 from the energy, p''
    outward, forward = np.column_stack([s, still, -c]), np.column_stack([c, still, s])
    acceleration = d * (turning[:, np.newaxis] * forward - speed2[:, np.newaxis] * outward)
    force = m * (acceleration + np.array([0.0, 0.0, GRAVITY]))
    moment = np.cross(HALF, force) + np.outer(SECOND["inertia"] * turning, [0.0, -1.0, 0.0])
    tip = d * outward + 2.0 * HALF
    return {
        "tip.csv": np.column_stack([TIMES, tip]),
        "force.csv": np.column_stack([TIMES, force]),
        "moment.csv": np.column_stack([TIMES, moment]),
    }


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")

    def rate(_: float, y: Array) -> list[float]:
        return [y[1], -(OMEGA**2) * np.sin(y[0])]

    start = [-0.5 * np.pi, 0.0]
    other = solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=3e-14, atol=1e-14).y[0]
    sys.stdout.write(f"closed form - DOP853: {np.abs(angle() - other).max():.1e} rad\n")


if __name__ == "__main__":
    main()
