"""Closed form of a solid ball that rolls in a rigid ring; writes ball.csv and prints period and forces.

    python make_reference.py

The centre moves on a circle of L = R - r. Rolling without slip, 7/5 L phi'' = -g sin phi, a pendulum with
w0^2 = 5 g / (7 L): sin(phi/2) = k sn(K - w0 t, k^2), k = sin(phi0/2).
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.special import ellipj, ellipk

HERE = Path(__file__).resolve().parent
GRAVITY, RING, BALL, START = 9.81, 0.5, 0.05, 0.3  # m/s^2, m, m, rad
DURATION, OUTPUT = 4.0, 10e-3  # s


ARM = RING - BALL  # of the centre, m
RATE = np.sqrt(5.0 * GRAVITY / (7.0 * ARM))  # of small swings, 1/s
MODULUS = np.sin(0.5 * START)


def references():
    """Table of time [s] and place x, y of the centre [m] by file name, shape (401, 3)."""
    times = np.arange(round(DURATION / OUTPUT) + 1) * OUTPUT
    square = MODULUS**2
    phi = 2.0 * np.arcsin(MODULUS * ellipj(ellipk(square) - RATE * times, square)[0])
    return {"ball.csv": np.column_stack([times, ARM * np.sin(phi), -ARM * np.cos(phi)])}


def main():
    """Write the place of the centre every 10 ms."""
    w0, quarter = RATE, ellipk(MODULUS**2)
    period = 4.0 * quarter / w0
    bottom, turn = (17.0 - 10.0 * np.cos(START)) / 7.0, np.cos(START)
    sys.stdout.write(
        f"period {period:.6f} s, frequency {1.0 / period:.7f} Hz, small swings {0.5 * w0 / np.pi:.7f} Hz\n"
    )
    sys.stdout.write(f"normal force over weight: {bottom:.6f} at the bottom, {turn:.6f} at the turn\n")
    sys.stdout.write(f"rolls from a friction of {2.0 / 7.0 * np.tan(START):.4f} on\n")
    for name, table in references().items():
        rows = ["time,x,y", *(f"{t:.10g},{x:.12g},{y:.12g}" for t, x, y in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
