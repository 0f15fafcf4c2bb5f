"""Periods of a box barge without added mass in heave, roll and pitch: closed forms, and its 6 x 6 matrices; NumPy."""

from __future__ import annotations

import sys

import numpy as np

LENGTH, BREADTH, DRAFT, KG = 97.5, 36.0, 4.5, 5.0  # m
DENSITY, GRAVITY = 1025.0, 9.80665
RADIUS_ROLL, RADIUS_PITCH = 0.35 * BREADTH, 0.25 * LENGTH


def closed_forms() -> tuple[float, float, float]:
    """2 pi sqrt(M / C) of heave, roll and pitch [s]: no water moves along, the centre of mass is the axis."""
    GM_T = DRAFT / 2.0 + BREADTH**2 / (12.0 * DRAFT) - KG
    GM_L = DRAFT / 2.0 + LENGTH**2 / (12.0 * DRAFT) - KG
    return (
        2.0 * np.pi * np.sqrt(DRAFT / GRAVITY),
        2.0 * np.pi * RADIUS_ROLL / np.sqrt(GRAVITY * GM_T),
        2.0 * np.pi * RADIUS_PITCH / np.sqrt(GRAVITY * GM_L),
    )


def from_matrices() -> np.ndarray:
    """The same from mass and stiffness about the middle of the water plane, where sway and roll are coupled."""
    mass, z = DENSITY * LENGTH * BREADTH * DRAFT, KG - DRAFT
    radii = np.array([RADIUS_ROLL, RADIUS_PITCH, RADIUS_PITCH])
    M = np.diag([mass, mass, mass, *(mass * (radii**2 + np.array([z * z, z * z, 0.0])))])
    M[0, 4] = M[4, 0] = mass * z
    M[1, 3] = M[3, 1] = -mass * z
    C = np.zeros((6, 6))
    C[2, 2] = DENSITY * GRAVITY * LENGTH * BREADTH
    tilt = -mass * GRAVITY * (DRAFT / 2.0 + z)
    C[3, 3] = DENSITY * GRAVITY * LENGTH * BREADTH**3 / 12.0 + tilt
    C[4, 4] = DENSITY * GRAVITY * BREADTH * LENGTH**3 / 12.0 + tilt
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(M, C)).real)[3:]
    return 2.0 * np.pi / np.sqrt(squares)


if __name__ == "__main__":
    for name, period in zip(("heave", "roll", "pitch"), closed_forms(), strict=True):
        sys.stdout.write(f"{name}: {period:.9f} s, {1.0 / period:.12f} Hz\n")
    difference = np.abs(np.sort(from_matrices()) / np.sort(closed_forms()) - 1.0).max()
    sys.stdout.write(f"from matrices: at most {difference:.1e} of them off\n")
