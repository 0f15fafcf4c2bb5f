"""Reference of a slider-crank: one coordinate, the angle of the crank.

Crank of length r at the angle a above x, rod of length L from its pin down to the piston on the x axis:

    sin(b) = r / L sin(a),   b' = r cos(a) / (L cos(b)) a',
    mu a'' + 1/2 mu' a'^2 + V' = 0,   mu = sum_k m_k |c_k'|^2 + J_k w_k^2 for a' = 1,   V = g sum_k m_k z_k,

where ' of mu and V is a complex step; integrated by DOP853.

    python make_reference.py        writes piston.csv and rod.csv and prints the start and the check
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
CRANK, ROD = 0.3, 1.0
MASSES = (1.0, 2.0, 1.5)
INERTIAS = (MASSES[0] * CRANK**2 / 12.0, MASSES[1] * ROD**2 / 12.0)
START = (np.pi / 6, 8.0)
DURATION = 5.0
TIMES = DURATION * np.arange(101) / 100
TINY = 1e-30

Array = NDArray[np.float64]


def parts(a: complex) -> tuple[Array, Array, complex]:
    """Centres of crank, rod and piston [m], shape (3, 2), their derivatives by a, and db/da."""
    pin, rate = CRANK * np.array([np.cos(a), np.sin(a)]), CRANK * np.array([-np.sin(a), np.cos(a)])
    sine = pin[1] / ROD
    cosine = np.sqrt(1.0 - sine**2)
    turn = pin[0] / (ROD * cosine)
    along, along_rate = ROD * np.array([cosine, -sine]), -ROD * turn * np.array([sine, cosine])
    centres = np.array([0.5 * pin, pin + 0.5 * along, pin + along])
    return centres, np.array([0.5 * rate, rate + 0.5 * along_rate, rate + along_rate]), turn


def inertia(a: complex) -> complex:
    """The generalised inertia mu [kg m^2]."""
    _, rates, turn = parts(a)
    moving = sum(m * rate @ rate for m, rate in zip(MASSES, rates, strict=True))
    return moving + INERTIAS[0] + INERTIAS[1] * turn**2


def potential(a: complex) -> complex:
    """Energy of gravity V [J]."""
    return GRAVITY * sum(m * c[1] for m, c in zip(MASSES, parts(a)[0], strict=True))


def solution() -> Array:
    """Angle of the crank and its rate at the sample times, shape (101, 2)."""

    def rate(_: float, y: Array) -> list[float]:
        mu, V = inertia(y[0] + 1j * TINY), potential(y[0] + 1j * TINY)
        return [y[1], -(0.5 * mu.imag / TINY * y[1] ** 2 + V.imag / TINY) / mu.real]

    return solve_ivp(rate, (0.0, DURATION), START, "DOP853", TIMES, rtol=3e-14, atol=1e-14).y.T


def references() -> dict[str, Array]:
    """Tables of time [s] and place [m] by file name, shape (101, 4)."""
    centres = np.array([parts(a)[0] for a in solution()[:, 0]])
    still = np.zeros(101)
    return {
        f"{name}.csv": np.column_stack([TIMES, centres[:, k, 0], still, centres[:, k, 1]])
        for name, k in (("rod", 1), ("piston", 2))
    }


def main() -> None:
    """Write the tables and print the start and the check."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    y = solution()
    energy = [0.5 * inertia(a) * w**2 + potential(a) for a, w in y]
    sys.stdout.write(f"energy off by {np.ptp(energy):.1e} J of {np.max(energy):.1f} J, ")
    sys.stdout.write(f"{(y[-1, 0] - y[0, 0]) / (2.0 * np.pi):.2f} turns\n")
    a, w = START
    pin = CRANK * np.array([np.cos(a), np.sin(a)])
    centres, rates, turn = parts(a)
    sys.stdout.write(
        f"start: pin {pin.tolist()} m, {(w * CRANK * np.array([-np.sin(a), np.cos(a)])).tolist()} m/s\n"
    )
    sys.stdout.write(f"rod {float(np.arcsin(pin[1] / ROD))!r} rad, {float(turn * w)!r} rad/s\n")
    sys.stdout.write(f"piston {centres[2].tolist()} m, {(w * rates[2]).tolist()} m/s\n")


if __name__ == "__main__":
    main()
