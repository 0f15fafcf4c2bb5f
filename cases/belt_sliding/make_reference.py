"""Closed form of the pad: slip, stick, slip; writes pad.csv and prints the times of the changes.

    python make_reference.py

A pad of mass m is pressed on a rigid plane by N, with Coulomb friction mu, and drawn by a spring k whose other end
moves at v0. At t = 0 the spring is unloaded and the pad moves at u0 > v0. With w = sqrt(k/m) and z = x - v0 t + mu N/k,
slip forward is z'' = -w^2 z.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

HERE = Path(__file__).resolve().parent
MASS, NORMAL, FRICTION, SPRING = 1.0, 9.81, 0.3, 1000.0
PULLER, PAD = 0.05, 0.15  # m/s
START, DURATION, OUTPUT = 0.09, 0.3, 1e-3  # m, s, s


def changes():
    """Times of stick and slip [s], place of the pad between them [m], amplitude [m] and phase of the first slip."""
    w, offset = np.sqrt(SPRING / MASS), FRICTION * NORMAL / SPRING
    ahead = (PAD - PULLER) / w
    amplitude, phase = np.hypot(offset, ahead), np.arctan2(ahead, offset)
    stick = (phase + np.arcsin(PULLER / (w * amplitude))) / w
    z = amplitude * np.cos(w * stick - phase)
    assert 0.0 <= SPRING * z <= 2.0 * FRICTION * NORMAL  # the spring does not draw it on at once
    return stick, stick + z / PULLER, z + PULLER * stick - offset, amplitude, phase


def position(t):
    """Way of the pad [m] at times before it would come to rest again, at slip + 2 pi / w."""
    w, offset = np.sqrt(SPRING / MASS), FRICTION * NORMAL / SPRING
    stick, slip, held, amplitude, phase = changes()
    first = amplitude * np.cos(w * t - phase) + PULLER * t - offset
    last = held + PULLER * (t - slip) - PULLER / w * np.sin(w * (t - slip))
    return np.where(t < stick, first, np.where(t < slip, held, last))


def integrated(times):
    """The same by an integrator, with tanh in place of the jump of friction."""

    def rates(t, y):
        force = SPRING * (PULLER * t - y[0]) - FRICTION * NORMAL * np.tanh(y[1] / 1e-6)
        return [y[1], force / MASS]

    run = solve_ivp(rates, (0.0, DURATION), [0.0, PAD], method="Radau", rtol=1e-9, atol=1e-12, t_eval=times)
    return run.y[0]


def references():
    """Table of time [s] and place of the pad [m] by file name, shape (301, 2)."""
    times = np.arange(round(DURATION / OUTPUT) + 1) * OUTPUT
    return {"pad.csv": np.column_stack([times, START + position(times)])}


def main():
    """Write the history of the pad every millisecond."""
    for name, table in references().items():
        rows = ["time,x", *(f"{t:.10g},{x:.12g}" for t, x in table)]
        (HERE / name).write_text("\n".join(rows) + "\n", encoding="utf-8")
    stick, slip, held, *_ = changes()
    end = np.array([DURATION])
    way, smooth = 1e3 * position(end)[0], 1e3 * integrated(end)[0]
    sys.stdout.write(f"sticks at {1e3 * stick:.4f} ms at {1e3 * held:.6f} mm, slips at {1e3 * slip:.4f} ms\n")
    sys.stdout.write(f"way at the end {way:.6f} mm, with regularised friction {smooth:.6f} mm\n")


if __name__ == "__main__":
    main()
