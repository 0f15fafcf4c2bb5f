"""Reference of a free asymmetric body: body rates by Jacobi's elliptic functions, attitude by one quadrature.

With I1 < I2 < I3, twice the kinetic energy 2E, the angular momentum M and M^2 > 2E I2, the rates about the
principal axes are (L. D. Landau, E. M. Lifshitz, "Mechanics", section 37), with w2 = 0 at the start,

    w1 = sqrt((2E I3 - M^2) / (I1 (I3 - I1))) cn(tau),   w2 = sqrt((2E I3 - M^2) / (I2 (I3 - I2))) sn(tau),
    w3 = sqrt((M^2 - 2E I1) / (I3 (I3 - I1))) dn(tau),   tau = t sqrt((I3 - I2) (M^2 - 2E I1) / (I1 I2 I3)),
    k^2 = (I2 - I1) (2E I3 - M^2) / ((I3 - I2) (M^2 - 2E I1)).

Euler angles about the constant direction of M: cos(theta) = I3 w3 / M, tan(psi) = I1 w1 / (I2 w2), and only

    phi' = M (I1 w1^2 + I2 w2^2) / (I1^2 w1^2 + I2^2 w2^2)

is integrated, by Gauss quadrature. The centre of mass rests.

    python make_reference.py        writes rates.csv, reference_x.csv, reference_z.csv and prints its checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj

DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100
INERTIA = np.array([1.0, 2.0, 2.5])
START = np.array([3.0, 0.0, 2.75])
CENTRE = np.array([0.1, 0.2, 0.3])
POINTS = {"x": np.array([1.1, 0.2, 0.3]), "z": np.array([0.1, 0.2, 1.3])}

Array = NDArray[np.float64]

I1, I2, I3 = INERTIA
TWICE_ENERGY = INERTIA @ START**2
MOMENTUM = np.linalg.norm(INERTIA * START)
OVER_1 = MOMENTUM**2 - TWICE_ENERGY * I1
UNDER_3 = TWICE_ENERGY * I3 - MOMENTUM**2


def rates(t: Array) -> Array:
    """Angular velocity in body axes [rad/s], shape (..., 3)."""
    tau = t * np.sqrt((I3 - I2) * OVER_1 / (I1 * I2 * I3))
    sn, cn, dn, _ = ellipj(tau, (I2 - I1) * UNDER_3 / ((I3 - I2) * OVER_1))
    return np.stack(
        [
            np.sqrt(UNDER_3 / (I1 * (I3 - I1))) * cn,
            np.sqrt(UNDER_3 / (I2 * (I3 - I2))) * sn,
            np.sqrt(OVER_1 / (I3 * (I3 - I1))) * dn,
        ],
        axis=-1,
    )


def precession() -> Array:
    """Angle phi about the angular momentum at the sample times, zero at the start [rad]."""
    node, weight = np.polynomial.legendre.leggauss(20)
    half = 0.5 * (TIMES[1] - TIMES[0])
    w1, w2, _ = np.moveaxis(rates(TIMES[:-1, np.newaxis] + half * (1.0 + node)), -1, 0)
    rate = MOMENTUM * (I1 * w1**2 + I2 * w2**2) / ((I1 * w1) ** 2 + (I2 * w2) ** 2)
    return np.concatenate([[0.0], np.cumsum(half * rate @ weight)])


def attitudes() -> Array:
    """Matrices from body to world axes at the sample times, the identity at the start, shape (101, 3, 3).

    In axes with z along the angular momentum, the body axes are Rz(phi) Rx(theta) Rz(psi).
    """
    along = rates(TIMES) * INERTIA / MOMENTUM  # direction of the momentum in body axes
    across = np.hypot(along[:, 0], along[:, 1])
    phi = precession()
    turned = np.empty((len(TIMES), 3, 3))
    for n, (x, y, z) in enumerate(along):
        s = across[n]
        line = np.array([y / s, -x / s, 0.0])  # line of nodes in body axes
        tilted = np.array([line, np.cross([x, y, z], line), [x, y, z]])  # rows: axes that only precess
        c, d = np.cos(phi[n]), np.sin(phi[n])
        turned[n] = np.array([[c, -d, 0.0], [d, c, 0.0], [0.0, 0.0, 1.0]]) @ tilted
    return turned[0].T @ turned


def integrated() -> tuple[Array, Array]:
    """Rates and attitudes from Euler's equations and R' = R [w] instead."""

    def rate(_: float, y: Array) -> Array:
        w, R = y[:3], y[3:].reshape(3, 3)
        return np.concatenate([np.cross(INERTIA * w, w) / INERTIA, np.cross(R, w).ravel()])

    start = np.concatenate([START, np.eye(3).ravel()])
    y = solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=1e-13, atol=1e-14).y.T
    return y[:, :3], y[:, 3:].reshape(-1, 3, 3)


def references() -> dict[str, Array]:
    """Tables of time [s] and rates [rad/s] or places [m] by file name, shape (101, 4)."""
    R = attitudes()
    tables = {"rates.csv": np.column_stack([TIMES, rates(TIMES)])}
    for name, point in POINTS.items():
        tables[f"reference_{name}.csv"] = np.column_stack([TIMES, CENTRE + R @ (point - CENTRE)])
    return tables


def main() -> None:
    """Write the tables and print the checks."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    w, R = integrated()
    sys.stdout.write(f"closed form - DOP853: rates {np.abs(rates(TIMES) - w).max():.1e} rad/s")
    sys.stdout.write(f", attitude {np.abs(attitudes() - R).max():.1e}\n")


if __name__ == "__main__":
    main()
