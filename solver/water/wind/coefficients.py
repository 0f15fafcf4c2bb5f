"""Tables of wind and current coefficients over the angle of attack become periodic cubic splines."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.wind_loads import CoefficientLoad

__all__ = ["SMALL_ANGLE", "coefficient_curves"]

FULL_TURN = 2.0 * math.pi

SMALL_ANGLE = 1e-6
"""[rad] that a table may miss its ends by."""

Array = NDArray[np.float64]


def coefficient_curves(load: CoefficientLoad) -> Array:
    """Rows of `heavylift.solver.water.wind.forces.CurvePiece`, shape (n, 13): periodic cubic splines through the table.

    Raises
    ------
    InputError
        If angles do not increase, do not go round, look like degrees, or if the ends do not fit.
    """
    from scipy.interpolate import CubicSpline

    angles, values = _closed_table(load)
    sizes = np.array([load.area_x, load.area_y, load.area_y * load.length])
    spline = CubicSpline(angles, values * sizes, bc_type="periodic")
    rows = np.zeros((len(angles), 13))
    rows[:, 0] = angles
    for k in range(3):
        rows[:-1, 1 + 4 * k : 5 + 4 * k] = spline.c[:, :, k].T
    return rows


def _closed_table(load: CoefficientLoad) -> tuple[Array, Array]:
    """Angles over a full turn, and coefficients that are the same at both ends."""
    angles = np.asarray(load.angles, dtype=np.float64)
    values = np.asarray(load.coefficients, dtype=np.float64)
    if angles.ndim != 1 or values.shape != (len(angles), 3) or len(angles) < 3:
        raise InputError(
            f"{angles.size} angles and coefficients of shape {values.shape}",
            source=load.name,
            key="coefficients",
            expected="C_x, C_y and C_n for each of three or more angles",
        )
    if not (np.all(np.isfinite(values)) and np.all(np.isfinite(angles)) and np.all(np.diff(angles) > 0.0)):
        raise InputError(
            "a table", source=load.name, key="angles", expected="finite numbers, angles increasing"
        )
    span = float(angles[-1] - angles[0])
    if span > FULL_TURN + SMALL_ANGLE:
        raise InputError(
            f"angles from {angles[0]:g} to {angles[-1]:g} rad",
            source=load.name,
            key="angles",
            expected="at most a full turn, 6.283 rad: are these degrees?",
        )
    if load.symmetric:
        return _mirrored(load.name, angles, values)
    if span >= FULL_TURN - SMALL_ANGLE:
        if np.max(np.abs(values[-1] - values[0])) > 1e-9 * np.max(np.abs(values)):
            raise InputError(
                f"coefficients {values[0].tolist()} and {values[-1].tolist()} a full turn apart",
                source=load.name,
                key="coefficients",
                expected="the same numbers in the first and the last row",
            )
        values = np.vstack([values[:-1], values[:1]])
        return np.append(angles[:-1], angles[0] + FULL_TURN), values
    if FULL_TURN - span > 1.5 * float(np.max(np.diff(angles))):
        raise InputError(
            f"angles from {angles[0]:g} to {angles[-1]:g} rad",
            source=load.name,
            key="angles",
            expected="a full turn, or 0 to pi and symmetric = true",
        )
    return np.append(angles, angles[0] + FULL_TURN), np.vstack([values, values[:1]])


def _mirrored(name: str, angles: Array, values: Array) -> tuple[Array, Array]:
    """From 0 to pi to -pi to pi."""
    if abs(angles[0]) > SMALL_ANGLE or abs(angles[-1] - math.pi) > SMALL_ANGLE:
        raise InputError(
            f"angles from {angles[0]:g} to {angles[-1]:g} rad",
            source=name,
            key="angles",
            expected="0 to pi for a symmetric body",
        )
    ends = np.abs(values[[0, -1], 1:])
    if np.any(ends > 1e-9 * np.max(np.abs(values))):
        raise InputError(
            f"C_y or C_n of {ends.max():g} at 0 or pi",
            source=name,
            key="coefficients",
            expected="0 there, for a symmetric body in a flow along it",
        )
    values = values.copy()
    values[[0, -1], 1:] = 0.0
    mirror = values[:0:-1] * np.array([1.0, -1.0, -1.0])
    angles = np.concatenate([-angles[:0:-1], angles])
    angles[0], angles[-1] = -math.pi, math.pi
    return angles, np.vstack([mirror, values])
