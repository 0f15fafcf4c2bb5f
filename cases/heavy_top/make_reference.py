"""Reference of the heavy symmetric top: nutation in closed form, precession and spin by quadrature.

The top stands with its tip in the origin, tilted by theta0, and is let go with the spin w3 alone. With the
moments of inertia J about the tip across and I about the axis, a = I w3 / J, b = 2 m g l / J, u = cos(theta),
u0 = cos(theta0),

    u'^2 = (u0 - u) (b (1 - u^2) - a^2 (u0 - u)) = b (u0 - u) (u - u1) (u2 - u)
    u = u1 + (u0 - u1) cd(p t, k^2)^2,   p = sqrt(b (u2 - u1)) / 2,   k^2 = (u0 - u1) / (u2 - u1)
    phi' = a (u0 - u) / (1 - u^2),   psi' = w3 - u phi'

(H. Goldstein, "Classical Mechanics", chapter 5). phi and psi are integrated by Gauss quadrature.

    python make_reference.py        writes reference_centre.csv, reference_rim.csv and prints its check
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj

GRAVITY = 9.81
MASS, HEIGHT, RADIUS = 0.5, 0.1, 0.1
AXIAL = 0.5 * MASS * RADIUS**2
ACROSS = 0.25 * MASS * RADIUS**2 + MASS * HEIGHT**2
TILT, SPIN = np.pi / 3, 100.0
DURATION = 4.0
TIMES = DURATION * np.arange(101) / 100
POINTS = {"centre": np.array([0.0, 0.0, HEIGHT]), "rim": np.array([RADIUS, 0.0, HEIGHT])}

Array = NDArray[np.float64]

A = AXIAL * SPIN / ACROSS
B = 2.0 * MASS * GRAVITY * HEIGHT / ACROSS
U0 = np.cos(TILT)
U1, U2 = np.sort(np.roots([B, -(A**2), A**2 * U0 - B]))


def height(t: Array) -> Array:
    """Cosine of the tilt."""
    k2 = (U0 - U1) / (U2 - U1)
    _, cn, dn, _ = ellipj(0.5 * np.sqrt(B * (U2 - U1)) * t, k2)
    return U1 + (U0 - U1) * (cn / dn) ** 2


def angles() -> tuple[Array, Array, Array]:
    """Precession phi, tilt theta and spin psi at the sample times [rad]."""
    node, weight = np.polynomial.legendre.leggauss(30)
    half = 0.5 * (TIMES[1] - TIMES[0])
    u = height(TIMES[:-1, np.newaxis] + half * (1.0 + node))
    rate = A * (U0 - u) / (1.0 - u**2)
    phi, shift = (np.concatenate([[0.0], np.cumsum(half * f @ weight)]) for f in (rate, u * rate))
    return phi, np.arccos(height(TIMES)), SPIN * TIMES - shift


def attitudes() -> Array:
    """Matrices Rz(phi) Rx(theta) Rz(psi) from body to world axes, shape (101, 3, 3)."""
    (f, t, s), (F, T, S) = ([g(x) for x in angles()] for g in (np.cos, np.sin))
    rows = [
        [f * s - F * t * S, -f * S - F * t * s, F * T],
        [F * s + f * t * S, -F * S + f * t * s, -f * T],
        [T * S, T * s, t],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def integrated() -> Array:
    """Attitudes from Euler's equations about the tip and R' = R [w] instead."""
    inertia = np.array([ACROSS, ACROSS, AXIAL])
    lever = np.array([0.0, 0.0, MASS * HEIGHT])

    def rate(_: float, y: Array) -> Array:
        w, R = y[:3], y[3:].reshape(3, 3)
        torque = np.cross(lever, -GRAVITY * R[2])
        return np.concatenate([(torque + np.cross(inertia * w, w)) / inertia, np.cross(R, w).ravel()])

    c, s = np.cos(TILT), np.sin(TILT)
    start = np.concatenate([[0.0, 0.0, SPIN], [1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c]])
    y = solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=1e-13, atol=1e-14).y.T
    return y[:, 3:].reshape(-1, 3, 3)


def references() -> dict[str, Array]:
    """Tables of time [s] and place [m] by file name, shape (101, 4)."""
    R = attitudes()
    return {f"reference_{name}.csv": np.column_stack([TIMES, R @ point]) for name, point in POINTS.items()}


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    difference = np.abs(attitudes() - integrated()).max()
    sys.stdout.write(f"closed form - DOP853: attitude {difference:.1e}\n")
    lowest, turns = np.degrees(np.arccos(U1)), angles()[0][-1] / (2.0 * np.pi)
    sys.stdout.write(
        f"nutation from {np.degrees(TILT):.2f} to {lowest:.2f} degrees, {turns:.4f} turns about z\n"
    )


if __name__ == "__main__":
    main()
