"""Reference of Andrews' squeezing mechanism: seven absolute angles and three loops, in complex numbers.

A point p of body k is ``p = p_k + c exp(i a_k)`` in the complex plane, with the absolute angle a_k of
the body and a complex constant c. Along a branch of the mechanism that adds up to

    p = p_0 + sum_k C_k exp(i a_k),   p' = sum_k C_k i exp(i a_k) w_k,   p'' = sum_k C_k exp(i a_k) (i w_k' - w_k^2),

so each point is one row C of seven complex numbers. Lagrange's equations with multipliers for the three
loops that meet in point E are integrated by DOP853. Data: "Test set for IVP solvers", W. Schiehlen (ed.),
"Multibody Systems Handbook", 1990.

    python make_reference.py        writes reference.csv beside itself and prints its checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

DURATION = 0.05
TIMES = DURATION * np.arange(101) / 100
CRANK = 0.007
MOTOR = 0.033
STIFFNESS, FREE_LENGTH = 4530.0, 0.07785

# fixed points: O is the origin
A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j

# bodies: crank OF, rod EF, triangle BDE, links EG, AG, EH, AH
MASS = np.array([0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498])
INERTIA = np.array([2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5])

# start of the test set for IVP solvers: beta, theta, gamma, phi, delta, omega, epsilon
START = (
    -0.0617138900142764496358948458001,
    0.0,
    0.455279819163070380255912382449,
    0.222668390165885884674473185609,
    0.487364979543842550225598953530,
    -0.222668390165885884674473185609,
    1.23054744454982119249735015568,
)
# its solution at 0.03 s, same order
AT_0_03 = (
    0.1581077119629904e2,
    -0.1575637105984298e2,
    0.4082224013073101e-1,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    0.1048080741042263e1,
)

Real = NDArray[np.float64]
Row = NDArray[np.complex128]


def row(**terms: complex) -> Row:
    """Coefficients of a point; the keys are b0 to b6."""
    found = np.zeros(7, dtype=complex)
    for name, value in terms.items():
        found[int(name[1:])] += value
    return found


# the same point E at the end of four branches
E_CRANK = row(b0=CRANK, b1=-0.028)
E_TRIANGLE = row(b2=-0.035j)
E_AG = row(b4=0.04, b3=-0.02j)
E_AH = row(b6=-0.04j, b5=0.02)
LOOPS = np.array([E_CRANK - E_TRIANGLE, E_CRANK - E_AG, E_CRANK - E_AH])
LOOP_ORIGINS = np.array([B, A, A])

CENTRES = np.array(
    [
        row(b0=0.00092),
        row(b0=CRANK, b1=-0.0115),
        row(b2=0.01043 - 0.01874j),
        row(b4=0.04, b3=-1j * (0.02 - 0.01421)),
        row(b4=0.02308 + 0.00916j),
        row(b6=-0.04j, b5=0.02 - 0.01421),
        row(b6=-0.00449 - 0.01228j),
    ]
)
SPRING_END = row(b2=0.02 - 0.018j)


def absolute(relative: tuple[float, ...]) -> Real:
    """Absolute angles of the seven bodies from the angles of the test set."""
    beta, theta, gamma, phi, delta, omega, epsilon = relative
    return np.array([beta, beta + theta, gamma, delta + phi, delta, epsilon + omega, epsilon])


def spring_force(a: Real) -> tuple[complex, float]:
    """Force of the spring on its moving end as a complex number [N], and its energy [J]."""
    arm = B + SPRING_END @ np.exp(1j * a) - C
    stretch = abs(arm) - FREE_LENGTH
    return -STIFFNESS * stretch * arm / abs(arm), 0.5 * STIFFNESS * stretch**2


def mass_matrix(direction: Row) -> Real:
    """Inertia in the seven angles, ``sum_k m_k Re(conj(J_k)^T J_k) + diag(I)`` with J_k = C_k i exp(i a)."""
    J = CENTRES * (1j * direction)
    return np.real(J.conj().T @ (MASS[:, np.newaxis] * J)) + np.diag(INERTIA)


def rate(_: float, y: Real) -> Real:
    """Velocities and accelerations of the angles."""
    a, w = y[:7], y[7:]
    direction = np.exp(1j * a)
    J = CENTRES * (1j * direction)
    M = mass_matrix(direction)
    centripetal = -CENTRES @ (direction * w**2)
    Q = -np.real(J.conj().T @ (MASS * centripetal))
    Q[0] += MOTOR
    Q += np.real((SPRING_END * 1j * direction).conj() * spring_force(a)[0])
    rows = LOOPS * (1j * direction)
    bias = LOOPS @ (direction * w**2)
    G = np.vstack([rows.real, rows.imag])
    saddle = np.block([[M, G.T], [G, np.zeros((6, 6))]])
    return np.concatenate([w, np.linalg.solve(saddle, np.concatenate([Q, bias.real, bias.imag]))[:7]])


def solution() -> Real:
    """Angles and their rates at the sample times, shape (101, 14)."""
    start = np.concatenate([absolute(START), np.zeros(7)])
    return solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=2.3e-14, atol=1e-14).y.T


def references() -> dict[str, Real]:
    """Tables of time [s] and place of the crank pin F [m] by file name, shape (101, 4)."""
    beta = solution()[:, 0]
    table = np.column_stack([TIMES, CRANK * np.cos(beta), CRANK * np.sin(beta), np.zeros(101)])
    return {"reference.csv": table}


def main() -> None:
    """Write the table and print the checks."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, line)) for line in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    y = solution()
    a, w = y[:, :7], y[:, 7:]
    closure = np.abs(np.exp(1j * a) @ LOOPS.T - LOOP_ORIGINS).max()
    kinetic = [0.5 * v @ mass_matrix(np.exp(1j * x)) @ v for x, v in zip(a, w, strict=True)]
    balance = kinetic + np.array([spring_force(x)[1] for x in a]) - MOTOR * a[:, 0]
    published = np.abs(a[60] - absolute(AT_0_03)).max()
    sys.stdout.write(f"loops open by {closure:.1e} m, energy balance off by {np.ptp(balance):.1e} J\n")
    sys.stdout.write(f"difference from the published angles at {TIMES[60]:g} s: {published:.1e} rad\n")


if __name__ == "__main__":
    main()
