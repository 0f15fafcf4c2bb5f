"""Reference of driven joints: what the drives have to do, in closed form.

An arm on a horizontal hinge, axis y, is driven by the angle q = A sin(2 pi f t), downwards if positive; a
load on a vertical slider by the travel s = S (3 (t/T)^2 - 2 (t/T)^3), the clamped cubic through two points.

    moment about the hinge  (J + m l^2) q'' - m g l cos(q),   force on the arm  m (c'' + g e_z)
    force on the load       M (s'' + g)
    work                    1/2 (J + m l^2) (q'^2 - q'(0)^2) - m g l sin(q) + 1/2 M s'^2 + M g s

    python make_reference.py        writes the tables and prints the work at the end, also by quadrature
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

GRAVITY = 9.81
ARM, INERTIA, LENGTH = 4.0, 0.2, 0.5
AMPLITUDE, OMEGA = 1.0, np.pi
LOAD, LIFT, RISE = 100.0, 1.0, 3.0
DURATION = 2.5
TIMES = DURATION * np.arange(101) / 100
ABOUT_HINGE = INERTIA + ARM * LENGTH**2

Array = NDArray[np.float64]


def turn(t: float | Array) -> tuple[Array, Array, Array]:
    """Angle of the arm and its two derivatives."""
    angle = AMPLITUDE * np.sin(OMEGA * t)
    return angle, AMPLITUDE * OMEGA * np.cos(OMEGA * t), -(OMEGA**2) * angle


def lift(t: float | Array) -> tuple[Array, Array, Array]:
    """Travel of the load and its two derivatives."""
    x = t / RISE
    return (
        LIFT * x**2 * (3.0 - 2.0 * x),
        6.0 * LIFT / RISE * x * (1.0 - x),
        6.0 * LIFT / RISE**2 * (1.0 - 2.0 * x),
    )


def hinge_moment(t: float | Array) -> Array:
    """Moment of the hinge about its axis [N m]."""
    q, _, ddq = turn(t)
    return ABOUT_HINGE * ddq - ARM * GRAVITY * LENGTH * np.cos(q)


def work(t: float | Array) -> Array:
    """Work of both drives since the start [J], from the energy."""
    (q, dq, _), (s, ds, _) = turn(t), lift(t)
    arm = 0.5 * ABOUT_HINGE * (dq**2 - turn(0.0)[1] ** 2) - ARM * GRAVITY * LENGTH * np.sin(q)
    return arm + 0.5 * LOAD * ds**2 + LOAD * GRAVITY * s


def references() -> dict[str, Array]:
    """Tables of time [s] and vectors, shape (101, 4), or of the work [J], shape (101, 2)."""
    q, dq, ddq = turn(TIMES)
    still, s, c = np.zeros(101), np.sin(q), np.cos(q)
    x, z = LENGTH * (-ddq * s - dq**2 * c), LENGTH * (-ddq * c + dq**2 * s)
    return {
        "arm_place.csv": np.column_stack([TIMES, LENGTH * c, still, -LENGTH * s]),
        "arm_force.csv": np.column_stack([TIMES, ARM * x, still, ARM * (z + GRAVITY)]),
        "arm_moment.csv": np.column_stack([TIMES, still, hinge_moment(TIMES), still]),
        "load_place.csv": np.column_stack([TIMES, still + 2.0, still, lift(TIMES)[0]]),
        "load_force.csv": np.column_stack([TIMES, still, still, LOAD * (lift(TIMES)[2] + GRAVITY)]),
        "work.csv": np.column_stack([TIMES, work(TIMES)]),
    }


def main() -> None:
    """Write the tables and print the check."""
    for name, table in references().items():
        header = "time,x,y,z" if table.shape[1] == 4 else "time,value"
        rows = [header, *(",".join(map(repr, row)) for row in table.tolist())]
        Path(__file__).with_name(name).write_text("\n".join(rows) + "\n", encoding="utf-8")

    def power(t: float) -> float:
        return hinge_moment(t) * turn(t)[1] + LOAD * (lift(t)[2] + GRAVITY) * lift(t)[1]

    other = quad(power, 0.0, DURATION, epsabs=1e-12, epsrel=1e-13)[0]
    end = float(work(DURATION))
    sys.stdout.write(f"work {end!r} J, less the integral of the power {abs(end - other):.1e} J\n")


if __name__ == "__main__":
    main()
