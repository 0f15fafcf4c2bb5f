"""Boxes on inclined planes at the threshold of friction, in closed form.

python make_reference.py        writes the tables and prints the accelerations

x'' = g (sin(theta) - mu cos(theta)) = g cos(theta) (tan(theta) - mu)     while it slides down
x   = 0                                                                  at rest, if tan(theta) <= mu
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
GRAVITY, FRICTION = 9.81, 0.5
EXCESS = 1e-6  # of the slope of the plane on which the box just slides
HALF, LANE = 0.5, 4.0  # m: half an edge of a box, distance of the planes along y
STOP_SLOPE, STOP_SPEED = 0.25, 2.0  # tan(theta), m/s
SLIDE_TIMES = 10.0 * np.arange(101) / 100
STOP_TIMES = np.arange(151) / 100


def acceleration(slope):
    """Acceleration down a plane [m/s^2] of a box that slides down, negative if it slows down."""
    # tan - mu is rounded to 1e-16, 1e-10 of the difference at the threshold
    return GRAVITY / np.hypot(1.0, slope) * (slope - FRICTION)


def stopping():
    """Time [s] and distance [m] until a box stops that starts downhill."""
    slowing = -acceleration(STOP_SLOPE)
    return STOP_SPEED / slowing, 0.5 * STOP_SPEED**2 / slowing


def places(times, distance, slope, lane):
    """Table of times and of the centre of a box that has gone a distance down its plane, shape (n, 4)."""
    theta = np.arctan(slope)
    down, up = np.array([np.cos(theta), 0.0, -np.sin(theta)]), np.array([np.sin(theta), 0.0, np.cos(theta)])
    path = HALF * up + np.broadcast_to(distance, times.shape)[:, None] * down
    path[:, 1] = LANE * lane
    return np.column_stack([times, path])


def references():
    """Time [s] and centre of the box [m] by file name; stop_start.csv: that of the start, when it has stopped."""
    slide = 0.5 * acceleration(FRICTION * (1.0 + EXCESS)) * SLIDE_TIMES**2
    t = np.minimum(STOP_TIMES, stopping()[0])
    stop = STOP_SPEED * t + 0.5 * acceleration(STOP_SLOPE) * t**2
    resting = SLIDE_TIMES[1:]
    return {
        "hold_3.csv": places(resting, 0.0, FRICTION * (1.0 - 1e-3), 0),
        "hold_6.csv": places(resting, 0.0, FRICTION * (1.0 - EXCESS), 1),
        "slide.csv": places(SLIDE_TIMES, slide, FRICTION * (1.0 + EXCESS), 2),
        "stop.csv": places(STOP_TIMES, stop, STOP_SLOPE, 3),
        "stop_start.csv": places(SLIDE_TIMES[10:], 0.0, STOP_SLOPE, 3),
    }


def main():
    """Write the tables and print the numbers of the README."""
    for name, table in references().items():
        rows = ["time,x,y,z", *(",".join(f"{value:.16g}" for value in row) for row in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    for factor in (1.0 - 1e-3, 1.0 - EXCESS, 1.0 + EXCESS):
        slope = FRICTION * factor
        a = max(acceleration(slope), 0.0)
        sys.stdout.write(
            f"tan(theta) = {slope:.9f}, theta = {np.arctan(slope):.12f} rad: acceleration {a:.9e} m/s^2\n"
        )
    t, x = stopping()
    sys.stdout.write(
        f"tan(theta) = {STOP_SLOPE}, theta = {np.arctan(STOP_SLOPE):.12f} rad: "
        f"stops after {t:.9f} s and {x:.9f} m\n"
    )


if __name__ == "__main__":
    main()
