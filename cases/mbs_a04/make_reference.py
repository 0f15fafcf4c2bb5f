"""Reference of Bricard's mechanism: one coordinate, because its loop closes in closed form.

Hinges 1, 3, 5 turn by the same angle a and hinges 2, 4, 6 by the same angle b, both zero at the start.
The loop of five rods and the ground closes if

    sin(a) + sin(b) + sin(a) sin(b) = 0,   b(a) = -arcsin(sin(a) / (1 + sin(a)))

(a threefold-symmetric Bricard linkage with right angles between its hinges). With the centres x_k(a), the
directions d_k(a) and the angular velocities w_k(a) a' of the rods, Lagrange's equation is

    mu a'' + 1/2 mu' a'^2 + V' = 0,   V = g sum_k m y_k,
    mu = sum_k m |x_k'|^2 + I_t (|w_k|^2 - (w_k . d_k)^2) + I_a (w_k . d_k)^2,

where ' of mu and V is a complex step. Released at rest at a = 0, integrated by DOP853.

    python make_reference.py        writes reference.csv here and in mbs_a04_thin, and prints its checks
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100
TINY = 1e-30

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], dtype=float)
AXES = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0]], dtype=float)
RODS = np.diff(POINTS, axis=0)

# transverse and axial inertia of a rod of 1 kg and 1 m [kg m^2]
SQUARE = ((1.0 + 0.1**2) / 12.0, 2.0 * 0.1**2 / 12.0)
THIN = (1.0 / 12.0, 1e-7 / 12.0)

Vector = NDArray[np.complex128]


class Rod(NamedTuple):
    """Beginning and direction of a rod [m], velocity of its centre and angular velocity for a' = 1."""

    start: Vector
    along: Vector
    velocity: Vector
    spin: Vector


def even_angle(a: complex) -> tuple[complex, complex]:
    """Angle b of hinges 2, 4, 6 and its derivative by a."""
    sine = -np.sin(a) / (1.0 + np.sin(a))
    return np.arcsin(sine), -np.cos(a) / ((1.0 + np.sin(a)) ** 2 * np.sqrt(1.0 - sine**2))


def turn(axis: NDArray[np.float64], angle: complex) -> Vector:
    """Matrix of a rotation about a unit axis, formula of Rodrigues."""
    K = np.cross(axis, np.eye(3)).T
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def rods(a: complex) -> list[Rod]:
    """The five rods one after the other, from the hinge at P0."""
    b, slope = even_angle(a)
    R, start = np.eye(3), POINTS[0]
    velocity, spin = np.zeros(3), np.zeros(3)
    found = []
    for k, rod in enumerate(RODS):
        angle, speed = (b, slope) if k % 2 else (a, 1.0)
        spin = spin + speed * (R @ AXES[k])
        R = R @ turn(AXES[k], angle)
        along = R @ rod
        found.append(Rod(start, along, velocity + np.cross(spin, 0.5 * along), spin))
        start, velocity = start + along, velocity + np.cross(spin, along)
    return found


def inertia(a: complex, rod_inertia: tuple[float, float]) -> complex:
    """The generalised inertia mu."""
    transverse, axial = rod_inertia
    total = 0.0
    for rod in rods(a):
        twist = (rod.spin @ rod.along) ** 2
        total += rod.velocity @ rod.velocity + transverse * (rod.spin @ rod.spin - twist) + axial * twist
    return total


def potential(a: complex) -> complex:
    """Energy of gravity V, along -y."""
    return GRAVITY * sum((rod.start + 0.5 * rod.along)[1] for rod in rods(a))


def solution(rod_inertia: tuple[float, float]) -> NDArray[np.float64]:
    """Angle a and its rate at the sample times, shape (101, 2)."""

    def rate(_: float, y: NDArray[np.float64]) -> list[float]:
        mu = inertia(y[0] + 1j * TINY, rod_inertia)
        slope = potential(y[0] + 1j * TINY).imag / TINY
        return [y[1], -(0.5 * mu.imag / TINY * y[1] ** 2 + slope) / mu.real]

    return solve_ivp(rate, (0.0, DURATION), [0.0, 0.0], "DOP853", TIMES, rtol=1e-13, atol=1e-13).y.T


def references() -> dict[str, NDArray[np.float64]]:
    """Tables of time [s] and place of P3 [m] by file name, shape (101, 4)."""
    files = {"reference.csv": SQUARE, "../mbs_a04_thin/reference.csv": THIN}
    return {name: table(solution(rod_inertia)) for name, rod_inertia in files.items()}


def table(y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Time and place of P3, the end of the third rod."""
    thirds = [rods(a)[2] for a in y[:, 0]]
    return np.column_stack([TIMES, [np.real(rod.start + rod.along) for rod in thirds]])


def closure_error() -> float:
    """How far the fifth rod misses P5 and the direction of the hinge there, over all angles."""
    worst = 0.0
    for a in np.linspace(0.0, np.pi, 50):
        last = rods(a)[4]
        end = last.start + last.along
        b = even_angle(a)[0]
        R = np.eye(3)
        for k, axis in enumerate(AXES[:5]):
            R = R @ turn(axis, b if k % 2 else a)
        worst = max(worst, np.abs(end - POINTS[5]).max(), np.abs(R @ AXES[5] - AXES[5]).max())
    return worst


def main() -> None:
    """Write the tables and print the checks."""
    for name, rows in references().items():
        lines = ["time,x,y,z", *(",".join(map(repr, row)) for row in rows.tolist())]
        (Path(__file__).parent / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write(f"loop open by {closure_error():.1e} m\n")
    for name, rod_inertia in {"square": SQUARE, "thin": THIN}.items():
        y = solution(rod_inertia)
        energy = [0.5 * inertia(a, rod_inertia) * w**2 + potential(a) for a, w in y]
        sys.stdout.write(f"{name} rods: energy off by {np.ptp(energy):.1e} J\n")
    bare = np.abs(table(solution((1.0 / 12.0, 0.0))) - table(solution(THIN))).max()
    sys.stdout.write(f"thin rods without any axial inertia would move P3 by {bare:.1e} m\n")


if __name__ == "__main__":
    main()
