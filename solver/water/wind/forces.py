"""Forces of moving air and water on bodies: one kind for wind and current, which differ in numbers only.

Forces follow from the velocity of the fluid relative to the centre of pressure, and act there. They know bodies by
their markers alone: a point and, for the heading, a direction.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records, Vector
from heavylift.solver.interface import (
    Workspace,
    add_forces,
    record_forces,
)
from heavylift.solver.kinds import implement
from heavylift.solver.recording import outputs_at
from heavylift.solver.scene.wind_loads import CurrentOutputs, LoadOutputs, WindOutputs
from heavylift.solver.water.wind.coefficients import CoefficientOutputs
from heavylift.solver.water.wind.spectrum import REFERENCE_HEIGHT

__all__ = [
    "BOX",
    "COEFFICIENTS",
    "LOG",
    "POWER",
    "SAME_ALL_ROUND",
    "TABLE",
    "CurvePiece",
    "FieldData",
    "FluidLoads",
    "LoadData",
    "PresentFlow",
    "TablePoint",
]

LOG, POWER, TABLE = range(3)
"""Profiles: logarithmic, power law, linear between rows."""

COEFFICIENTS, SAME_ALL_ROUND, BOX = range(3)
"""Sorts of loads: tables over the angle of attack; drag of one area; drag of the projection of a box."""

STEEPEST = 0.01
"""Square of the horizontal part of a heading below which the yaw moment fades out: 6 degrees off the vertical."""

LOWEST_GUST = 1.0
"""Height [m] below which gusts grow no further: their power would have no limit at the water."""

Flow = tuple[float, float, float, float]
Cubic = Annotated[NDArray[np.float64], (4,)]


class FieldData(Record):
    """A wind or current.

    Attributes
    ----------
    profile, profile_first, profile_count
        Sort of profile, its first row and rows.
    turn_first, turn_count
        First row and rows of the direction.
    record_first, record_count
        First value and values of the fluctuation.
    column
        First record column.
    density
        [kg/m3].
    level
        Height of the still water [m].
    side
        1 for above it and -1 for below.
    speed
        Mean at 10 m [m/s].
    shape
        C of the logarithm or exponent of the power law.
    gust, gust_exponent
        Relative gust at 10 m and exponent of its change with the height.
    ramp
        Time of the ramp [s].
    record_step
        Step of the fluctuation [s].
    recorded_height
        Height of the recorded speed over the still water [m].
    """

    profile: int
    profile_first: int
    profile_count: int
    turn_first: int
    turn_count: int
    record_first: int
    record_count: int
    column: int
    density: float
    level: float
    side: float
    speed: float
    shape: float
    gust: float
    gust_exponent: float
    ramp: float
    record_step: float
    recorded_height: float


class PresentFlow(Record):
    """A field at the present instant: factor of the ramp, fluctuation [m/s], direction [rad], its cosine and sine."""

    growth: float
    change: float
    angle: float
    cosine: float
    sine: float


class LoadData(Record):
    """A piece that a fluid pushes on.

    Attributes
    ----------
    field, sort
        Its field, and how the force follows from the flow.
    marker, heading
        Markers of its point and of its heading, or -1.
    curve_first, curve_count
        First row and rows of its curves.
    column
        First record column of all loads of its name.
    area
        Areas times the coefficient [m2] along the heading, across it, from above.
    extent
        Height of the piece [m].
    vertical
        Whether vertical flow counts.
    """

    field: int
    sort: int
    marker: int
    heading: int
    curve_first: int
    curve_count: int
    column: int
    area: Vector
    extent: float
    vertical: bool


class Knot(Record):
    """Where a row of a table stands, in increasing order: height [m], time [s] or angle [rad]."""

    at: float


class TablePoint(Knot):
    """Point of a function that is linear between points."""

    value: float


class CurvePiece(Knot):
    """Coefficients of the falling powers of the distance from its begin: C_x A_x, C_y A_y [m2], C_n A_y L [m3]."""

    x: Cubic
    y: Cubic
    turn: Cubic


wind_outputs, current_outputs = outputs_at(WindOutputs), outputs_at(CurrentOutputs)
load_outputs, coefficient_outputs = outputs_at(LoadOutputs), outputs_at(CoefficientOutputs)


class FluidLoads(Arrays):
    """All loads of wind and current of a scene.

    Attributes
    ----------
    fields
        Winds and currents.
    profiles
        Speed [m/s] over the height above the still water [m], of all fields.
    turns
        Where the fluid goes [rad] over the time [s], of all fields.
    records
        Fluctuations [m/s] at equal steps from time zero, of all fields.
    flow
        Fields at the present instant. Written before it is read, in every call.
    loads
        What the fluids push on.
    curves
        Coefficients over the angle of attack; the last row of a curve only ends its last piece.
    """

    fields: Records[FieldData]
    profiles: Records[TablePoint]
    turns: Records[TablePoint]
    records: Floats1
    flow: Records[PresentFlow]
    loads: Records[LoadData]
    curves: Records[CurvePiece]


@kernel(internal=True)
def _row_before(table: Records[Knot], first: int, count: int, x: float) -> int:
    """Last row, of all but the last, that begins at or before x; the first if none does."""
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle].at <= x:
            low = middle
        else:
            high = middle
    return low


@kernel(internal=True)
def _linear(table: Records[TablePoint], first: int, count: int, x: float) -> float:
    """Value of a table, linear between its points and held at the ends."""
    if count == 1:
        return table[first].value
    low = _row_before(table, first, count, x)
    begin, end = table[low], table[low + 1]
    part = min(max((x - begin.at) / (end.at - begin.at), 0.0), 1.0)
    return begin.value + part * (end.value - begin.value)


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
        field, flow = kind.fields[f], kind.flow[f]
        ramp, growth = field.ramp, 1.0
        if time < ramp:
            growth = 0.5 * (1.0 - math.cos(math.pi * max(time, 0.0) / ramp))
        change, count = 0.0, field.record_count
        if count > 0:
            x = time / field.record_step
            change = _cubic(kind.records, field.record_first, count, x)
        angle = _linear(kind.turns, field.turn_first, field.turn_count, time)
        flow.growth = growth
        flow.change = change
        flow.cosine = math.cos(angle)
        flow.sine = math.sin(angle)
        flow.angle = angle


@kernel(internal=True)
def _speed(kind: FluidLoads, f: int, height: float) -> float:
    """Speed of a field [m/s] at a height above the still water [m] and the instant of `flow`."""
    field, flow = kind.fields[f], kind.flow[f]
    mean, profile = field.speed, field.profile
    if profile == LOG:
        mean *= max(1.0 + field.shape * math.log(max(height, 1e-300) / REFERENCE_HEIGHT), 0.0)
    elif profile == POWER:
        mean *= (max(height, 0.0) / REFERENCE_HEIGHT) ** field.shape
    else:
        first, count = field.profile_first, field.profile_count
        mean = _linear(kind.profiles, first, count, height)
    if field.gust != 0.0:
        relative = (max(height, LOWEST_GUST) / REFERENCE_HEIGHT) ** field.gust_exponent
        mean *= 1.0 + field.gust * relative
    return flow.growth * (mean + flow.change)


@kernel(internal=True)
def _load(kind: FluidLoads, i: int, work: Workspace) -> Flow:
    """Force in world axes [N] and yaw moment [N m] of a load."""
    load = kind.loads[i]
    f, marker, heading = load.field, load.marker, load.heading
    field, flow = kind.fields[f], kind.flow[f]
    side, extent = field.side, load.extent
    away = side * (work.markers[marker].point[2] - field.level)
    if load.sort == COEFFICIENTS:
        away = max(away, 0.0)  # tables are of the whole body: they act wherever their point is
    top = away + 0.5 * extent
    if top <= 0.0 and load.sort != COEFFICIENTS:
        return 0.0, 0.0, 0.0, 0.0
    bottom = max(away - 0.5 * extent, 0.0)
    share = (top - bottom) / extent if extent > 0.0 else 1.0
    speed = _speed(kind, f, side * 0.5 * (top + bottom))
    x = speed * flow.cosine - work.markers[marker].velocity[0]
    y = speed * flow.sine - work.markers[marker].velocity[1]
    z = -work.markers[marker].velocity[2] * load.vertical
    c, s = 1.0, 0.0
    if heading >= 0:
        c, s = work.markers[heading].point[0], work.markers[heading].point[1]
        size = math.sqrt(c * c + s * s)
        c, s = (c / size, s / size) if size > 0.0 else (1.0, 0.0)
    ahead, across = c * x + s * y, c * y - s * x  # the relative flow along the heading and to port
    pressure = 0.5 * field.density * share
    if load.sort == COEFFICIENTS:
        pressure *= ahead * ahead + across * across
        fx, fy, moment = _coefficients(
            kind.curves, load.curve_first, load.curve_count, math.atan2(across, ahead)
        )
        return pressure * (c * fx - s * fy), pressure * (s * fx + c * fy), 0.0, pressure * moment
    size = math.sqrt(x * x + y * y + z * z)
    if load.sort == BOX:
        # projected area times the speed
        drag = load.area[0] * abs(ahead) + load.area[1] * abs(across)
        drag += load.area[2] * abs(z)
    else:
        drag = load.area[0] * size
    drag *= pressure
    return drag * x, drag * y, drag * z, 0.0


@kernel(internal=True)
def _coefficients(
    curves: Records[CurvePiece], first: int, count: int, angle: float
) -> tuple[float, float, float]:
    """C_x A_x, C_y A_y, C_n A_y L at an angle of attack, periodic."""
    start = curves[first].at
    angle = start + (angle - start) % (2.0 * math.pi)
    piece = curves[_row_before(curves, first, count, angle)]
    t, x, y, turn = angle - piece.at, piece.x, piece.y, piece.turn
    return (
        ((x[0] * t + x[1]) * t + x[2]) * t + x[3],
        ((y[0] * t + y[1]) * t + y[2]) * t + y[3],
        ((turn[0] * t + turn[1]) * t + turn[2]) * t + turn[3],
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
        marker, heading = kind.loads[i].marker, kind.loads[i].heading
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
        field = kind.fields[f]
        speed, angle = _speed(kind, f, field.recorded_height), kind.flow[f].angle
        if field.side > 0.0:
            wind = wind_outputs(row, field.column)
            wind.speed, wind.direction = speed, angle
        else:
            current = current_outputs(row, field.column)
            current.speed, current.direction = speed, angle
    for i in range(kind.loads.shape[0]):  # several loads may share their columns
        load = kind.loads[i]
        force = load_outputs(row, load.column).force
        for k in range(3):
            force[k] = 0.0
        if load.sort == COEFFICIENTS:
            coefficient_outputs(row, load.column).yaw_moment[0] = 0.0
    for i in range(kind.loads.shape[0]):
        load = kind.loads[i]
        force = load_outputs(row, load.column).force
        fx, fy, fz, turn = _load(kind, i, work)
        force[0] += fx
        force[1] += fy
        force[2] += fz
        if load.sort == COEFFICIENTS:
            coefficient_outputs(row, load.column).yaw_moment[0] += turn
