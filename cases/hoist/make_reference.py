"""Reference of a load of 1000 t on a fall of two parts: two coordinates and an elastic rope.

The rope hangs from two points of the ground, 2 r apart, and runs about the sheave of radius r on the load, a
point (x, z) in its centre. Its path is two tangents and the wrap below,

    s = sum_i sqrt(d_i^2 - r^2) + r wrap,   ds/d(x, z) = sum_i n_i,

with the distances d_i of the two points and the unit vectors n_i from them along the tangents. With the
unstretched length l(t) that the winch shortens,

    m (x'', z'') = -T sum_i n_i - (0, m g),   T = max(0, EA (s - l) / l),   l' = -v(t).

v rises from 0 to 0.1 m/s within 1 s, stays, and falls again from 11 to 12 s. DOP853 integrates from corner to
corner. The winch works at the rate -l' (T + T^2 / (2 EA)), which closes the balance with the energy
EA (s - l)^2 / (2 l) of the rope.

    python make_reference.py        writes the tables and prints the start and the checks
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

GRAVITY = 9.81
MASS = 1e6
AXIAL_STIFFNESS = 1e9
LENGTH = 100.0
RADIUS = 0.5
SPEED = 0.1
CORNERS = [0.0, 1.0, 11.0, 12.0, 20.0]
OFFSET = 1.0
TIMES = 20.0 * np.arange(101) / 100
ANCHORS = np.array([[-RADIUS, 0.0], [RADIUS, 0.0]])

Array = NDArray[np.float64]


def path(place: Array) -> tuple[float, Array]:
    """Length of the path s [m] and its gradient."""
    arm = ANCHORS - place
    distance = np.hypot(arm[:, 0], arm[:, 1])
    tangent = np.sqrt(distance**2 - RADIUS**2)
    towards = np.arctan2(arm[:, 1], arm[:, 0])
    lean = np.arccos(RADIUS / distance)  # between the arm and the radius to the tangent point
    left, right = towards[0] + lean[0], towards[1] - lean[1]
    wrap = 2.0 * np.pi + right - left
    touch = place + RADIUS * np.array([[np.cos(a), np.sin(a)] for a in (left, right)])
    return tangent.sum() + RADIUS * wrap, ((touch - ANCHORS) / tangent[:, np.newaxis]).sum(axis=0)


def winch(t: float) -> float:
    """Speed of the winch [m/s]."""
    return SPEED * np.interp(t, CORNERS, [0.0, 1.0, 1.0, 0.0, 0.0])


def tension(s: float, length: float) -> float:
    """Tension of the rope [N]."""
    return max(0.0, AXIAL_STIFFNESS * (s - length) / length)


def start() -> Array:
    """At rest, aside, with the tension of the weight at rest."""
    wanted = LENGTH * (1.0 + 0.5 * MASS * GRAVITY / AXIAL_STIFFNESS)
    depth = brentq(lambda z: path(np.array([OFFSET, z]))[0] - wanted, -60.0, -40.0, xtol=1e-14, rtol=1e-15)
    return np.array([OFFSET, depth, 0.0, 0.0, LENGTH, 0.0])


def rate(t: float, y: Array) -> Array:
    """Rates of place, velocity, length of the rope, and the power of the winch."""
    s, gradient = path(y[:2])
    T = tension(s, y[4])
    v = winch(t)
    acceleration = -T * gradient / MASS - np.array([0.0, GRAVITY])
    return np.concatenate([y[2:4], acceleration, [-v, v * (T + 0.5 * T**2 / AXIAL_STIFFNESS)]])


def solution(method: str = "DOP853", rtol: float = 1e-13) -> Array:
    """Columns x, z, x', z', l, work of the winch at the sample times."""
    y, rows = start(), [start()]
    for t0, t1 in pairwise(CORNERS):
        times = TIMES[(t0 < TIMES) & (t1 >= TIMES)]
        found = solve_ivp(rate, (t0, t1), y, method, times, rtol=rtol, atol=1e-13)
        rows.extend(found.y.T)
        y = found.y[:, -1]
    return np.array(rows)


def balance(y: Array) -> float:
    """Kinetic energy, gravity and rope less the work of the winch [J]."""
    stretch = path(y[:2])[0] - y[4]
    rope = 0.5 * AXIAL_STIFFNESS * stretch**2 / y[4]
    return 0.5 * MASS * (y[2] ** 2 + y[3] ** 2) + MASS * GRAVITY * y[1] + rope - y[5]


def references() -> dict[str, Array]:
    """Tables of time [s] and place [m], shape (101, 4), and of the tension [N], shape (101, 2)."""
    y = solution()
    force = [tension(path(row[:2])[0], row[4]) for row in y]
    place = np.column_stack([TIMES, y[:, 0], np.zeros(101), y[:, 1]])
    return {"reference.csv": place, "tension.csv": np.column_stack([TIMES, force])}


def main() -> None:
    """Write the tables and print the checks."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    y, other = solution(), solution("Radau", 1e-11)
    sys.stdout.write(f"start at z = {float(start()[1])!r} m\n")
    sys.stdout.write(f"DOP853 - Radau IIA: {np.abs(y - other)[:, :2].max():.1e} m, ")
    sys.stdout.write(f"energy balance off by {np.ptp([balance(row) for row in y]):.1e} J\n")
    place, push = start()[:2], 1e-5
    slope = [(path(place + d)[0] - path(place - d)[0]) / (2.0 * push) for d in push * np.eye(2)]
    sys.stdout.write(
        f"gradient of the path - central difference: {np.abs(slope - path(place)[1]).max():.1e}\n"
    )


if __name__ == "__main__":
    main()
