"""Reference of the flyball governor: two coordinates, because the angular momentum of the shaft is conserved.

Coordinates are the angle b of the rods below the horizontal and the height s of the slider; both rods do the
same. About the axis everything has the moment of inertia Jz(b), and H = Jz(b) w is constant:

    J_r b'' = 1/4 Jz'(b) (H / Jz(b))^2 + (m_r / 2 + m_p) g L cos(b) - F dl/db       (each rod about its hinge)
    m_s s'' = -2 F dl/ds - m_s g
    F = k (l - l0) + c l',   l(b, s): from the slider to the middle of a rod

Stiff (k = 8e5 N/m, c = 4e4 N s/m), integrated by DOP853 and, as a check, by Radau IIA.

    python make_reference.py        writes reference.csv beside itself and prints its checks
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

GRAVITY = 9.81
DURATION = 10.0
TIMES = DURATION * np.arange(101) / 100

DENSITY, SECTION, HEIGHT, ARM = 3000.0, 0.01, 1.0, 1.0
ROD = DENSITY * SECTION**2 * ARM
SHAFT = DENSITY * SECTION**2 * HEIGHT
CUBE = 0.1
SLIDER = DENSITY * CUBE**3
BALL = 5.0
OFFSET = 0.05
STIFFNESS, DAMPING, FREE_LENGTH = 8e5, 4e4, 0.5
START_ANGLE, START_HEIGHT, START_SPEED = np.pi / 6, 0.5, 2.0 * np.pi

TRANSVERSE = ROD * (ARM**2 + SECTION**2) / 12.0
AXIAL = ROD * SECTION**2 / 6.0
ABOUT_HINGE = TRANSVERSE + ROD * (0.5 * ARM) ** 2 + BALL * ARM**2

Array = NDArray[np.float64]


def inertia_about_axis(b: float) -> tuple[float, float]:
    """Moment of inertia about the shaft Jz and its derivative by b [kg m^2]."""
    c, s = np.cos(b), np.sin(b)
    middle, end = OFFSET + 0.5 * ARM * c, OFFSET + ARM * c
    rod = ROD * middle**2 + BALL * end**2 + TRANSVERSE * c**2 + AXIAL * s**2
    slope = -ROD * middle * ARM * s - 2.0 * BALL * end * ARM * s - 2.0 * (TRANSVERSE - AXIAL) * c * s
    return SHAFT * SECTION**2 / 6.0 + SLIDER * CUBE**2 / 6.0 + 2.0 * rod, 2.0 * slope


def spring(y: Array) -> tuple[float, float, float, float]:
    """Length of a spring [m], its rate [m/s], and its derivatives by b and s."""
    b, s, db, ds = y
    across, up = 0.5 * ARM * np.cos(b), HEIGHT - 0.5 * ARM * np.sin(b) - s
    length = np.hypot(across, up)
    by_b = -0.5 * ARM * (across * np.sin(b) + up * np.cos(b)) / length
    by_s = -up / length
    return length, by_b * db + by_s * ds, by_b, by_s


MOMENTUM = START_SPEED * inertia_about_axis(START_ANGLE)[0]


def rate(_: float, y: Array) -> list[float]:
    """Velocities and accelerations of b and s, and the power of the dampers."""
    b, _, db, ds = y[:4]
    length, speed, by_b, by_s = spring(y[:4])
    force = STIFFNESS * (length - FREE_LENGTH) + DAMPING * speed
    about_axis, slope = inertia_about_axis(b)
    turning = 0.25 * slope * (MOMENTUM / about_axis) ** 2
    turning += (0.5 * ROD + BALL) * GRAVITY * ARM * np.cos(b) - force * by_b
    return [db, ds, turning / ABOUT_HINGE, -2.0 * force * by_s / SLIDER - GRAVITY, 2.0 * DAMPING * speed**2]


def solution() -> Array:
    """Columns b, s, b', s', energy lost in the dampers, at the sample times."""
    start = [START_ANGLE, START_HEIGHT, 0.0, 0.0, 0.0]
    return solve_ivp(rate, (0.0, DURATION), start, "DOP853", TIMES, rtol=1e-12, atol=1e-13).y.T


def solution_by_radau() -> Array:
    """Columns b, s, b', s' from the other method."""

    def motion(t: float, y: Array) -> list[float]:
        return rate(t, y)[:4]

    start = [START_ANGLE, START_HEIGHT, 0.0, 0.0]
    return solve_ivp(motion, (0.0, DURATION), start, "Radau", TIMES, rtol=1e-12, atol=1e-13).y.T


def balance(y: Array) -> float:
    """Kinetic energy, energy of springs and of gravity, and what the dampers took [J]."""
    b, s, db, ds, lost = y
    kinetic = 0.5 * MOMENTUM**2 / inertia_about_axis(b)[0] + ABOUT_HINGE * db**2 + 0.5 * SLIDER * ds**2
    height = SLIDER * s - (ROD + 2.0 * BALL) * ARM * np.sin(b)
    return kinetic + STIFFNESS * (spring(y[:4])[0] - FREE_LENGTH) ** 2 + GRAVITY * height + lost


def references() -> dict[str, Array]:
    """Tables of time [s] and place of the slider [m] by file name, shape (101, 4)."""
    height = solution()[:, 1]
    return {"reference.csv": np.column_stack([TIMES, np.zeros((101, 2)), height])}


def main() -> None:
    """Write the table and print the checks."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    explicit, implicit = solution(), solution_by_radau()
    sys.stdout.write(f"DOP853 - Radau IIA: {np.abs(explicit[:, :4] - implicit).max():.1e}\n")
    sys.stdout.write(f"energy balance off by {np.ptp([balance(y) for y in explicit]):.1e} J\n")


if __name__ == "__main__":
    main()
