"""Reference of three links in a closed loop: the angle of the middle link, with the loop closed exactly.

Pins A = (0, 0) and D = (20 m, 0), links AB, BC, CD of length l = 10 m in the plane of x and z. With the
angle t of BC,

    C = B + l (cos t, sin t),   B = r / 2 + sqrt(l^2 - d^2 / 4) n,   r = D - l (cos t, sin t),   d = |r|,

with n square to r, on its right. The derivative B' follows from B . B' = 0, (C - D) . C' = 0. With the links
r_k, their centres c_k and moments of inertia J,

    mu t'' + 1/2 mu' t'^2 + V' = 0,   mu = sum_k m |c_k'|^2 + J |r_k'|^2 / l^2,   V = m g sum_k z(c_k),

where ' of mu and V is a complex step. Released at rest at t = -pi / 3, where AB is level; DOP853.

    python make_reference.py        writes reference_K.csv, the centre of link K, and prints the checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp

GRAVITY = 9.81
MASS, LENGTH, SECTION = 1000.0, 10.0, 0.5
INERTIA = MASS * (LENGTH**2 + SECTION**2) / 12.0
A, D = np.zeros(2), np.array([20.0, 0.0])
START = -np.pi / 3
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100
TINY = 1e-30

Array = NDArray[np.float64]
Points = list[NDArray[np.complex128]]


def pins(t: complex) -> tuple[Points, Points]:
    """The four pins and their derivatives by the angle t."""
    link = LENGTH * np.array([np.cos(t), np.sin(t)])
    turned = np.array([-link[1], link[0]])
    r = D - link
    B = 0.5 * r + np.sqrt(LENGTH**2 / (r @ r) - 0.25) * np.array([r[1], -r[0]])
    C = B + link
    dB = np.linalg.solve(np.array([B, C - D]), np.array([0.0, -(C - D) @ turned]))
    return [A, B, C, D], [0.0 * A, dB, dB + turned, 0.0 * D]


def inertia(t: complex) -> complex:
    """The generalised inertia mu."""
    total = 0.0
    _, rates = pins(t)
    for k in range(3):
        centre, turn = 0.5 * (rates[k + 1] + rates[k]), (rates[k + 1] - rates[k]) / LENGTH
        total += MASS * centre @ centre + INERTIA * turn @ turn
    return total


def potential(t: complex) -> complex:
    """Energy of gravity V."""
    return MASS * GRAVITY * sum(p[1] for p in pins(t)[0][1:3])


def rate(_: float, y: Array) -> list[float]:
    """Rate of the angle and its second derivative."""
    mu, V = inertia(y[0] + 1j * TINY), potential(y[0] + 1j * TINY)
    return [y[1], -(0.5 * mu.imag * y[1] ** 2 + V.imag) / (TINY * mu.real)]


def solution() -> Array:
    """Angle of the middle link and its rate at the sample times, shape (101, 2)."""
    return solve_ivp(rate, (0.0, DURATION), [START, 0.0], "DOP853", TIMES, rtol=3e-14, atol=1e-14).y.T


def half_period() -> float:
    """Time between two rests [s], from the energy: the integral of sqrt(mu / 2 / (V(start) - V)).

    The far rest is the mirror image of the start. At both the integrand is the inverse of a square root,
    which the variable u with t = start cos(u) takes away.
    """
    V = potential(START)

    def integrand(u: float) -> float:
        t = START * np.cos(u)
        return np.sqrt(0.5 * inertia(t) / (V - potential(t))) * abs(START) * np.sin(u)

    return quad(integrand, 0.0, np.pi, epsabs=1e-12, epsrel=1e-12)[0]


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the centre of a link [m] by file name, shape (101, 4)."""
    tables = {}
    corners = [pins(t)[0] for t in solution()[:, 0]]
    for k in range(3):
        centre = np.array([0.5 * (p[k] + p[k + 1]) for p in corners])
        tables[f"reference_{k + 1}.csv"] = np.column_stack([TIMES, centre[:, 0], np.zeros(101), centre[:, 1]])
    return tables


def main() -> None:
    """Write the tables and print the checks."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    energy = [0.5 * inertia(t) * w**2 + potential(t) for t, w in solution()]
    sys.stdout.write(f"energy off by {np.ptp(energy):.1e} J of {MASS * GRAVITY * LENGTH:.0f} J\n")
    half = half_period()
    y = solve_ivp(rate, (0.0, half), [START, 0.0], "DOP853", rtol=3e-14, atol=1e-14).y[:, -1]
    sys.stdout.write(f"half a period by quadrature of the energy: {half:.12f} s, the other rest is then\n")
    sys.stdout.write(f"missed by {abs(y[0] + START):.1e} rad and {abs(y[1]):.1e} rad/s\n")


if __name__ == "__main__":
    main()
