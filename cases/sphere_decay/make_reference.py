"""Solves the decay of the sphere anew from Hulme's damping and writes decay_hulme.csv; NumPy and SciPy.

    (M + A_inf) z'' + int_0^t K(t - s) z'(s) ds + C z = 0,    K(t) = 2/pi int_0^inf B cos(omega t) d omega

Damping: a spline through `hulme.csv`, beyond it as omega^-7. The integral over the frequency is a sum over 20,001 of
them, that over the past the trapezoidal rule, and the steps those of the average acceleration. Both are of second
order: steps of 10 and 5 ms are extrapolated to none.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

HERE = Path(__file__).parent
MASS, ADDED_MASS, STIFFNESS = 261800.0, 130876.8, 770389.1
RADIUS, DENSITY, GRAVITY = 5.0, 1000.0, 9.81
HIGHEST, COUNT = 40.0, 20001  # rad/s
DURATION = 40.0


def damping(omega: np.ndarray) -> np.ndarray:
    """Heave of half a sphere [kg/s]."""
    table = np.loadtxt(HERE / "hulme.csv", delimiter=",", skiprows=2)
    long_waves = 0.75 * np.pi
    curve = CubicSpline(
        np.append(0.0, table[:, 0]), np.append(0.0, table[:, 2]), bc_type=((1, long_waves), "not-a-knot")
    )
    ka = omega**2 * RADIUS / GRAVITY
    last = table[-1, 0]
    value = curve(np.minimum(ka, last)) * (last / np.maximum(ka, last)) ** 4
    return DENSITY * 2.0 / 3.0 * np.pi * RADIUS**3 * omega * value


def kernel(times: np.ndarray) -> np.ndarray:
    """Retardation at times [kg/s^2], by Simpson's rule."""
    omega = np.linspace(0.0, HIGHEST, COUNT)
    weights = np.full(COUNT, 2.0)
    weights[1::2] = 4.0
    weights[[0, -1]] = 1.0
    values = damping(omega) * weights * (omega[1] / 3.0)
    parts = [np.cos(np.outer(t, omega)) @ values for t in np.array_split(times, max(1, len(times) // 200))]
    return 2.0 / np.pi * np.concatenate(parts)


def decay(K: np.ndarray, step: float) -> np.ndarray:
    """Height at every step [m], from rest at 1 m."""
    count = len(K)
    z, v, a = np.ones(count), np.zeros(count), np.zeros(count)
    a[0] = -STIFFNESS / (MASS + ADDED_MASS)
    left = MASS + ADDED_MASS + 0.25 * step * step * (K[0] + STIFFNESS)
    for n in range(1, count):
        past = step * (K[n - 1 : 0 : -1] @ v[1:n] + 0.5 * K[n] * v[0])
        v_known = v[n - 1] + 0.5 * step * a[n - 1]
        z_known = z[n - 1] + step * v[n - 1] + 0.25 * step * step * a[n - 1]
        a[n] = -(past + 0.5 * step * K[0] * v_known + STIFFNESS * z_known) / left
        v[n] = v_known + 0.5 * step * a[n]
        z[n] = z_known + 0.25 * step * step * a[n]
    return z


def references() -> dict[str, np.ndarray]:
    """Height over time with Hulme's damping, extrapolated from steps of 5 and 10 ms to none."""
    fine = kernel(0.005 * np.arange(round(DURATION / 0.005) + 1))
    coarse, finer = decay(fine[::2], 0.01), decay(fine, 0.005)
    sys.stdout.write(f"steps of 5 and 10 ms differ by {np.abs(finer[::20] - coarse[::10]).max():.2e} m\n")
    z = (4.0 * finer[::20] - coarse[::10]) / 3.0
    return {"decay_hulme.csv": np.column_stack([0.1 * np.arange(len(z)), z])}


if __name__ == "__main__":
    table = references()["decay_hulme.csv"]
    published = np.loadtxt(HERE / "decay.csv", delimiter=",", skiprows=2)
    error = np.abs(table[: len(published), 1] - published[: len(table), 1]).max()
    sys.stdout.write(f"largest difference from decay.csv: {error:.2e} m\n")
    rows = "".join(f"{a:.1f},{b:.9f}\n" for a, b in table)
    head = (
        "# Decay of the sphere with Hulme's damping, steps extrapolated to none: make_reference.py\ntime,z\n"
    )
    (HERE / "decay_hulme.csv").write_text(head + rows, encoding="utf-8")
