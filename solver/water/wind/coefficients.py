"""Loads of wind and current by coefficients over the angle of attack, which become periodic cubic splines.

With V the horizontal velocity of the fluid at the centre of pressure, relative to that point, and
``q = rho |V|^2 / 2``: ``F_x = q C_x A_x``, ``F_y = q C_y A_y``, ``M_z = q C_n A_y L``; "Integrated simulation ... ships
and offshore structures" (2018), eqs. (225) and (228).
"""

from __future__ import annotations

import math
from dataclasses import field
from itertools import pairwise
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyPoint, Positive, Quantity, Shape, TableFile
from heavylift.solver.scene.descriptions import no_rows
from heavylift.solver.scene.outputs import Components, channel, outputs
from heavylift.solver.scene.wind_loads import FLUID_LOADS, FluidLoad, LoadOutputs

__all__ = ["SMALL_ANGLE", "CoefficientLoad", "CoefficientOutputs", "coefficient_curves"]

COLUMNS = ("angles", "cx", "cy", "cn")
HEADERS = (("angle", "cx", "cy", "cn"), ("angle_deg", "cx", "cy", "cn"))

FULL_TURN = 2.0 * math.pi

SMALL_ANGLE = 1e-6
"""[rad] that a table may miss its ends by."""

Array = NDArray[np.float64]


@outputs
class CoefficientOutputs(LoadOutputs):
    """What is recorded of all loads of a name of which one has coefficients."""

    yaw_moment: Components = channel(
        "moment or energy",
        "sum of the yaw moments of the pieces of this name about their centres of pressure",
        ("z",),
    )


@FLUID_LOADS.describe("coefficients")
@dataclass(frozen=True, eq=False, kw_only=True)
class CoefficientLoad(FluidLoad):
    """Horizontal force and yaw moment on a whole body, by coefficients over the direction of the relative flow."""

    CHANNELS: ClassVar = CoefficientOutputs.CHANNELS

    point: Annotated[Array, BodyPoint()]
    """Centre of pressure, in the coordinates of the geometry [m]."""
    file: Annotated[str | None, TableFile(HEADERS, COLUMNS)] = None
    """Comma-separated with the header ``angle,cx,cy,cn`` (rad) or ``angle_deg,cx,cy,cn``."""
    angles: Annotated[Array, Quantity("angle"), Shape((None,))] = field(default_factory=no_rows)
    """In place of `file`: directions of the flow past the body [rad], from its heading, anticlockwise: 0
    comes from astern, 180 degrees is a head wind."""
    cx: Annotated[Array, Quantity("number"), Shape((None,))] = field(default_factory=no_rows)
    """Coefficients of the force ahead, one an angle."""
    cy: Annotated[Array, Quantity("number"), Shape((None,))] = field(default_factory=no_rows)
    """Of the force to port."""
    cn: Annotated[Array, Quantity("number"), Shape((None,))] = field(default_factory=no_rows)
    """Of the yaw moment, anticlockwise; it refers to the side area and the length."""
    area_x: Annotated[float, Quantity("area", minimum=0.0, closed=True)]
    """Frontal area [m^2]."""
    area_y: Annotated[float, Quantity("area", minimum=0.0, closed=True)]
    """Side area [m^2]."""
    length: Annotated[float, Positive("length")]
    """That of the moment [m]."""
    symmetric: bool = False
    """The table covers 0 to 180 degrees, and the other side is its mirror image."""

    @staticmethod
    def check(spec: Any) -> None:
        """One table of coefficients."""
        inline = bool(spec.angles or spec.cx or spec.cy or spec.cn)
        if inline == (spec.file is not None):
            problem = "both 'file' and 'angles'" if inline else "neither 'file' nor 'angles'"
            raise InputError(problem, expected="a table of coefficients in one of them")
        if not inline:
            return
        counts = {len(spec.angles), len(spec.cx), len(spec.cy), len(spec.cn)}
        if len(counts) != 1 or any(b <= a for a, b in pairwise(spec.angles)):
            raise InputError(
                f"{len(spec.angles)} angles, {len(spec.cx)}, {len(spec.cy)} and {len(spec.cn)} coefficients",
                key="angles",
                expected="increasing angles, with one cx, cy and cn each",
            )
        if max(map(abs, spec.angles)) > FULL_TURN + 1e-9:
            raise InputError(
                f"{max(spec.angles, key=abs):.6g} rad, {math.degrees(max(spec.angles, key=abs)):.6g} deg",
                key="angles",
                expected='a full turn at most; degrees as "30 deg"',
            )


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
    columns = [np.asarray(column, dtype=np.float64) for column in (load.cx, load.cy, load.cn)]
    values = np.column_stack(columns) if len({len(column) for column in columns}) == 1 else np.zeros(0)
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
