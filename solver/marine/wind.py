"""Forces of moving air and water on bodies: one kind for wind and current, which differ in numbers only.

Forces follow from the velocity of the fluid relative to the centre of pressure, and act there. They know bodies by
their markers alone: a point and, for the heading, a direction.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    record_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.marine.wind_spectrum import REFERENCE_HEIGHT

__all__ = [
    "AREA_X",
    "AREA_Y",
    "AREA_Z",
    "BOX",
    "COEFFICIENTS",
    "CURVE_WIDTH",
    "DENSITY",
    "EXTENT",
    "FIELD_COLUMNS",
    "FIELD_VALUES",
    "FLOW_WIDTH",
    "GUST",
    "GUST_EXPONENT",
    "LEVEL",
    "LOAD_COLUMNS",
    "LOAD_VALUES",
    "LOG",
    "POWER",
    "RAMP",
    "RECORD_STEP",
    "REFERENCE",
    "SAME_ALL_ROUND",
    "SHAPE",
    "SIDE",
    "SPEED",
    "TABLE",
    "VERTICAL",
    "FluidLoads",
]

LOG, POWER, TABLE = range(3)
"""Profiles: logarithmic, power law, linear between rows."""

PROFILE, PROFILE_FIRST, PROFILE_COUNT, TURN_FIRST, TURN_COUNT, RECORD_FIRST, RECORD_COUNT, SPEED_COLUMN = (
    range(8)
)
FIELD_COLUMNS = 8
"""Columns of `FluidLoads.fields`."""

DENSITY, LEVEL, SIDE, SPEED, SHAPE, GUST, GUST_EXPONENT, RAMP, RECORD_STEP, REFERENCE = range(10)
FIELD_VALUES = 10
"""Columns of `FluidLoads.field_values`."""

GROWTH, CHANGE, COSINE, SINE, ANGLE = range(5)
FLOW_WIDTH = 5
"""Columns of `FluidLoads.flow`."""

COEFFICIENTS, SAME_ALL_ROUND, BOX = range(3)
"""Sorts of loads: tables over the angle of attack; drag of one area; drag of the projection of a box."""

FLUID, SORT, PLACE, HEADING, CURVE_FIRST, CURVE_COUNT, FORCE_COLUMN, MOMENT_COLUMN = range(8)
LOAD_COLUMNS = 8
"""Columns of `FluidLoads.loads`."""

AREA_X, AREA_Y, AREA_Z, EXTENT, VERTICAL = range(5)
LOAD_VALUES = 5
"""Columns of `FluidLoads.load_values`."""

CURVE_WIDTH = 13
"""Angle, and four powers of three cubics, of a row of `FluidLoads.curves`."""

STEEPEST = 0.01
"""Square of the horizontal part of a heading below which the yaw moment fades out: 6 degrees off the vertical."""

LOWEST_GUST = 1.0
"""Height [m] below which gusts grow no further: their power would have no limit at the water."""

Flow = tuple[float, float, float, float]


class FluidLoads(Arrays):
    """All loads of wind and current of a scene.

    Attributes
    ----------
    fields
        Profile, its first row and rows, first row and rows of the direction, first value and values of the
        fluctuation, record column of the speed or -1 (the direction follows); shape (fields, 8).
    field_values
        Density [kg/m3], height of the still water [m], 1 for above it and -1 for below, mean speed at 10 m [m/s],
        C of the logarithm or exponent of the power law, relative gust at 10 m and exponent of its change with the
        height, time of the ramp [s], step of the fluctuation [s], height of the recorded speed over the still
        water [m]; shape (fields, 10).
    profiles
        Height above the still water [m] and speed [m/s], shape (rows, 2).
    turns
        Time [s] and where the fluid goes [rad], shape (rows, 2).
    records
        Fluctuations [m/s] at equal steps from time zero, of all fields.
    flow
        Of the present instant: factor of the ramp, fluctuation [m/s], cosine and sine of the direction, direction
        [rad]; shape (fields, 5). Written before it is read, in every call.
    loads
        Field, sort, point marker, heading marker or -1, first row and rows of its curves, record columns of force
        and moment or -1; shape (n, 8).
    load_values
        Areas times the coefficient [m2] along the heading, across it, from above; height of the piece [m]; 1 if
        vertical flow counts, else 0; shape (n, 5).
    curves
        Angle at which a piece of a curve begins [rad], then coefficients of the falling powers of the distance from
        it, of C_x A_x, C_y A_y [m2] and C_n A_y L [m3]; the last row only ends the last piece; shape (rows, 13).
    """

    fields: Ints2
    field_values: Floats2
    profiles: Floats2
    turns: Floats2
    records: Floats1
    flow: Floats2
    loads: Ints2
    load_values: Floats2
    curves: Floats2


@kernel(internal=True)
def _row_before(table: NDArray[np.float64], first: int, count: int, x: float) -> int:
    """Last row, of all but the last, that begins at or before x; the first if none does."""
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= x:
            low = middle
        else:
            high = middle
    return low


@kernel(internal=True)
def _linear(table: NDArray[np.float64], first: int, count: int, x: float) -> float:
    """Second column over the first, linear between the rows and held at the ends."""
    if count == 1:
        return table[first, 1]
    low = _row_before(table, first, count, x)
    part = min(max((x - table[low, 0]) / (table[low + 1, 0] - table[low, 0]), 0.0), 1.0)
    return table[low, 1] + part * (table[low + 1, 1] - table[low, 1])


@kernel(internal=True)
def _cubic(values: NDArray[np.float64], first: int, count: int, x: float) -> float:
    """Values at equal steps by cubics through four of them, x in steps; held at the ends."""
    x = min(max(x, 0.0), count - 1.0)
    i = min(int(x), count - 2)
    s = x - i
    p1, p2 = values[first + i], values[first + i + 1]
    p0 = values[first + i - 1] if i > 0 else 2.0 * p1 - p2
    p3 = values[first + i + 2] if i + 2 < count else 2.0 * p2 - p1
    # Catmull and Rom: slopes are central differences
    a = 0.5 * (3.0 * (p1 - p2) + p3 - p0)
    b = p0 - 2.5 * p1 + 2.0 * p2 - 0.5 * p3
    return ((a * s + b) * s + 0.5 * (p2 - p0)) * s + p1


@kernel(internal=True)
def _update_flow(kind: FluidLoads, time: float) -> None:
    """What is the same at all heights."""
    for f in range(kind.fields.shape[0]):
        ramp, growth = kind.field_values[f, RAMP], 1.0
        if time < ramp:
            growth = 0.5 * (1.0 - math.cos(math.pi * max(time, 0.0) / ramp))
        change, count = 0.0, kind.fields[f, RECORD_COUNT]
        if count > 0:
            x = time / kind.field_values[f, RECORD_STEP]
            change = _cubic(kind.records, kind.fields[f, RECORD_FIRST], count, x)
        angle = _linear(kind.turns, kind.fields[f, TURN_FIRST], kind.fields[f, TURN_COUNT], time)
        kind.flow[f, GROWTH] = growth
        kind.flow[f, CHANGE] = change
        kind.flow[f, COSINE] = math.cos(angle)
        kind.flow[f, SINE] = math.sin(angle)
        kind.flow[f, ANGLE] = angle


@kernel(internal=True)
def _speed(kind: FluidLoads, f: int, height: float) -> float:
    """Speed of a field [m/s] at a height above the still water [m] and the instant of `flow`."""
    values = kind.field_values
    mean, profile = values[f, SPEED], kind.fields[f, PROFILE]
    if profile == LOG:
        mean *= max(1.0 + values[f, SHAPE] * math.log(max(height, 1e-300) / REFERENCE_HEIGHT), 0.0)
    elif profile == POWER:
        mean *= (max(height, 0.0) / REFERENCE_HEIGHT) ** values[f, SHAPE]
    else:
        first, count = kind.fields[f, PROFILE_FIRST], kind.fields[f, PROFILE_COUNT]
        mean = _linear(kind.profiles, first, count, height)
    if values[f, GUST] != 0.0:
        relative = (max(height, LOWEST_GUST) / REFERENCE_HEIGHT) ** values[f, GUST_EXPONENT]
        mean *= 1.0 + values[f, GUST] * relative
    return kind.flow[f, GROWTH] * (mean + kind.flow[f, CHANGE])


@kernel(internal=True)
def _load(kind: FluidLoads, i: int, work: Workspace) -> Flow:
    """Force in world axes [N] and yaw moment [N m] of a load."""
    f, marker, heading = kind.loads[i, FLUID], kind.loads[i, PLACE], kind.loads[i, HEADING]
    side, extent = kind.field_values[f, SIDE], kind.load_values[i, EXTENT]
    away = side * (work.markers[marker].point[2] - kind.field_values[f, LEVEL])
    if kind.loads[i, SORT] == COEFFICIENTS:
        away = max(away, 0.0)  # tables are of the whole body: they act wherever their point is
    top = away + 0.5 * extent
    if top <= 0.0 and kind.loads[i, SORT] != COEFFICIENTS:
        return 0.0, 0.0, 0.0, 0.0
    bottom = max(away - 0.5 * extent, 0.0)
    share = (top - bottom) / extent if extent > 0.0 else 1.0
    speed = _speed(kind, f, side * 0.5 * (top + bottom))
    x = speed * kind.flow[f, COSINE] - work.markers[marker].velocity[0]
    y = speed * kind.flow[f, SINE] - work.markers[marker].velocity[1]
    z = -work.markers[marker].velocity[2] * kind.load_values[i, VERTICAL]
    c, s = 1.0, 0.0
    if heading >= 0:
        c, s = work.markers[heading].point[0], work.markers[heading].point[1]
        size = math.sqrt(c * c + s * s)
        c, s = (c / size, s / size) if size > 0.0 else (1.0, 0.0)
    ahead, across = c * x + s * y, c * y - s * x  # the relative flow along the heading and to port
    pressure = 0.5 * kind.field_values[f, DENSITY] * share
    if kind.loads[i, SORT] == COEFFICIENTS:
        pressure *= ahead * ahead + across * across
        fx, fy, moment = _coefficients(
            kind.curves, kind.loads[i, CURVE_FIRST], kind.loads[i, CURVE_COUNT], math.atan2(across, ahead)
        )
        return pressure * (c * fx - s * fy), pressure * (s * fx + c * fy), 0.0, pressure * moment
    size = math.sqrt(x * x + y * y + z * z)
    if kind.loads[i, SORT] == BOX:
        # projected area times the speed
        drag = kind.load_values[i, AREA_X] * abs(ahead) + kind.load_values[i, AREA_Y] * abs(across)
        drag += kind.load_values[i, AREA_Z] * abs(z)
    else:
        drag = kind.load_values[i, AREA_X] * size
    drag *= pressure
    return drag * x, drag * y, drag * z, 0.0


@kernel(internal=True)
def _coefficients(
    curves: NDArray[np.float64], first: int, count: int, angle: float
) -> tuple[float, float, float]:
    """C_x A_x, C_y A_y, C_n A_y L at an angle of attack, periodic."""
    start = curves[first, 0]
    angle = start + (angle - start) % (2.0 * math.pi)
    row = _row_before(curves, first, count, angle)
    t = angle - curves[row, 0]
    return (
        ((curves[row, 1] * t + curves[row, 2]) * t + curves[row, 3]) * t + curves[row, 4],
        ((curves[row, 5] * t + curves[row, 6]) * t + curves[row, 7]) * t + curves[row, 8],
        ((curves[row, 9] * t + curves[row, 10]) * t + curves[row, 11]) * t + curves[row, 12],
    )


@implement(add_forces, FluidLoads)
@kernel(internal=True)
def add_fluid_loads(kind: FluidLoads, time: float, work: Workspace) -> None:
    """Forces at the points; moments as forces on the headings.

    The heading is ``psi = atan2(d_y, d_x)`` of the direction d. A force ``M (-d_y, d_x, 0) / (d_x^2 + d_y^2)`` on d
    has the power ``M psi'``.
    """
    _update_flow(kind, time)
    for i in range(kind.loads.shape[0]):
        fx, fy, fz, moment = _load(kind, i, work)
        marker, heading = kind.loads[i, PLACE], kind.loads[i, HEADING]
        work.markers[marker].force[0] += fx
        work.markers[marker].force[1] += fy
        work.markers[marker].force[2] += fz
        if moment != 0.0:
            dx, dy = work.markers[heading].point[0], work.markers[heading].point[1]
            turn = moment / max(dx * dx + dy * dy, STEEPEST)
            work.markers[heading].force[0] -= turn * dy
            work.markers[heading].force[1] += turn * dx


@implement(record_forces, FluidLoads)
@kernel(internal=True)
def record_fluid_loads(kind: FluidLoads, time: float, work: Workspace, row: NDArray[np.float64]) -> None:
    """Speeds and directions of the fields, total force and moment of each name."""
    _update_flow(kind, time)
    for f in range(kind.fields.shape[0]):
        column = kind.fields[f, SPEED_COLUMN]
        if column >= 0:
            row[column] = _speed(kind, f, kind.field_values[f, REFERENCE])
            row[column + 1] = kind.flow[f, ANGLE]
    for i in range(kind.loads.shape[0]):  # several loads may share their columns
        force, moment = kind.loads[i, FORCE_COLUMN], kind.loads[i, MOMENT_COLUMN]
        if force >= 0:
            for k in range(3):
                row[force + k] = 0.0
        if moment >= 0:
            row[moment] = 0.0
    for i in range(kind.loads.shape[0]):
        force, moment = kind.loads[i, FORCE_COLUMN], kind.loads[i, MOMENT_COLUMN]
        fx, fy, fz, turn = _load(kind, i, work)
        if force >= 0:
            row[force] += fx
            row[force + 1] += fy
            row[force + 2] += fz
        if moment >= 0:
            row[moment] += turn
