"""Water in the tanks of hulls: how much by schedules and pumps, where it is, what it brings; level of the sea.

A tank of a box or a table has its centre, the second moments of its free surface and its depth by its mass, linear
between rows; without water and pressed up it has no free surface. A pump follows its command with a lag, exactly,
so the water in all tanks and the sea together is the same at any time. What comes into a tank has the velocity of
the hull. Its energy, with that of the free surface, and what the tide lifts, are work from outside.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import add, cross, dot, rotate, vector
from heavylift.solver.water.hulls.kind import Hulls, PumpRow

__all__ = [
    "add_ballast_work",
    "fill_tanks",
    "overfilled",
    "pump_at",
    "pumped_behind",
    "put_level",
    "put_tank_velocity",
    "tank_mass",
]

ROUNDING = 1e-9
"""Of a full tank, or of a ton, by which its water may seem too much or too little."""

TON = 1000.0

Contents = tuple[tuple[float, float, float], float, float, float]
"""Centre in principal axes [m]; density times second moments of the surface about x and y [kg m]; depth [m]."""


@kernel(internal=True)
def pump_at(kind: Hulls, pump: int, time: float) -> tuple[float, float, float]:
    """Flow [kg/s], commanded flow [kg/s], and mass that it has moved [kg], at a time."""
    data, rows = kind.pumps[pump], kind.pump_rows
    low, high = data.first, data.first + data.count
    while high - low > 1:
        middle = (low + high) // 2
        if rows[middle].time <= time:
            low = middle
        else:
            high = middle
    return pumped_behind(rows[low], data.lag, time)


@kernel(internal=True)
def pumped_behind(row: PumpRow, lag: float, time: float) -> tuple[float, float, float]:
    """Of one row, at a time behind it."""
    span = time - row.time
    left = row.flow - row.command
    decay, slowed = 0.0, 0.0
    if lag > 0.0:
        decay = math.exp(-span / lag)
        slowed = -lag * math.expm1(-span / lag)
    return row.command + left * decay, row.command, row.pumped + row.command * span + left * slowed


@kernel(internal=True)
def tank_mass(kind: Hulls, tank: int, time: float) -> float:
    """Of the schedule, linear between its rows and held at the ends, with what pumps have moved [kg]."""
    levels, first, count = kind.tank_levels, kind.tanks[tank].first, kind.tanks[tank].count
    low, high = first, first + count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if levels[middle].time <= time:
            low = middle
        else:
            high = middle
    span = levels[high].time - levels[low].time
    part = min(max((time - levels[low].time) / span, 0.0), 1.0) if span > 0.0 else 0.0
    mass = levels[low].mass + part * (levels[high].mass - levels[low].mass)
    for pump in range(kind.pumps.shape[0]):
        way = (kind.pumps[pump].target == tank) - (kind.pumps[pump].source == tank)
        if way != 0:
            _, _, moved = pump_at(kind, pump, time)
            mass += way * moved
    return mass


@kernel(internal=True)
def tank_contents(kind: Hulls, tank: int, mass: float) -> Contents:
    """Where some water in a tank is, and its surface."""
    data, rows = kind.tanks[tank], kind.tank_rows
    low, high = data.first_row, data.first_row + data.rows - 1
    while high - low > 1:
        middle = (low + high) // 2
        if rows[middle].mass <= mass:
            low = middle
        else:
            high = middle
    a, b = rows[low], rows[high]
    span = b.mass - a.mass
    part = (mass - a.mass) / span if span > 0.0 else 0.0
    free = 1.0 if 0.0 < mass < data.capacity else 0.0
    centre = (
        a.centre[0] + part * (b.centre[0] - a.centre[0]),
        a.centre[1] + part * (b.centre[1] - a.centre[1]),
        a.centre[2] + part * (b.centre[2] - a.centre[2]),
    )
    about_x = free * (a.surface[0] + part * (b.surface[0] - a.surface[0]))
    about_y = free * (a.surface[1] + part * (b.surface[1] - a.surface[1]))
    return centre, about_x, about_y, a.depth + part * (b.depth - a.depth)


@kernel(internal=True)
def fill_tanks(kind: Hulls, time: float) -> None:
    """Water in all tanks at a time."""
    for tank in range(kind.tanks.shape[0]):
        data = kind.tanks[tank]
        data.mass = tank_mass(kind, tank, time)
        centre, about_x, about_y, depth = tank_contents(kind, tank, data.mass)
        for k in range(3):
            data.point[k] = centre[k]
        data.free_surface[0], data.free_surface[1], data.depth = about_x, about_y, depth


@kernel(internal=True)
def overfilled(kind: Hulls, tank: int) -> bool:
    """Whether a tank has more water than it holds, or less than none."""
    mass, most = kind.tanks[tank].mass, kind.tanks[tank].capacity
    slack = ROUNDING * (TON if math.isinf(most) else most)
    return not -slack <= mass <= most + slack


@kernel(internal=True)
def tide_at(kind: Hulls, time: float) -> float:
    """Height of the still water, linear between rows and held at the ends [m]."""
    rows = kind.tide
    low, high = 0, rows.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if rows[middle].time <= time:
            low = middle
        else:
            high = middle
    span = rows[high].time - rows[low].time
    part = min(max((time - rows[low].time) / span, 0.0), 1.0)
    return rows[low].level + part * (rows[high].level - rows[low].level)


@kernel(internal=True)
def put_level(kind: Hulls, time: float) -> None:
    """Level of the sea at a time."""
    if kind.tide.shape[0] > 0:
        kind.water.level = tide_at(kind, time)


@kernel(internal=True)
def put_tank_velocity(kind: Hulls, hull: int, tank: int, R: NDArray[np.float64]) -> None:
    """Velocity of the water in a tank at the carried velocities."""
    frame = kind.frame[hull]
    rate = rotate(R, cross(frame.spin, kind.tanks[tank].point))
    for k in range(3):
        kind.tanks[tank].velocity[k] = frame.velocity[k] + rate[k]


@kernel(internal=True)
def add_ballast_work(kind: Hulls, time: float, step: float) -> None:
    """Energy that ballast brings with it, in the middle of the step: it comes with the velocity of its place.

    Notes
    -----
    What is in the tank rises with its level. So the energy is that of the water at the end less that at the start, both
    at the pose and the velocities of the middle.
    """
    for tank in range(kind.tanks.shape[0]):
        before, after = tank_mass(kind, tank, time), tank_mass(kind, tank, time + step)
        if before != after:
            gained = _energy(kind, tank, after) - _energy(kind, tank, before)
            kind.state[kind.tanks[tank].hull].supplied += gained
    if kind.tide.shape[0] > 0:
        rise = tide_at(kind, time + step) - tide_at(kind, time)
        for hull in range(kind.table.shape[0]):
            kind.state[hull].supplied += kind.stage[hull].lift[2] * rise


@kernel(internal=True)
def _energy(kind: Hulls, tank: int, mass: float) -> float:
    """Kinetic energy and potential of some water in a tank, with its free surface, in the middle of the step [J]."""
    hull = kind.tanks[tank].hull
    frame, data = kind.frame[hull], kind.hulls[hull]
    R = frame.mid_rotation
    centre, about_x, about_y, _ = tank_contents(kind, tank, mass)
    # the velocity of the tank is that of its present centre at the start
    moved = (
        centre[0] - kind.tanks[tank].point[0],
        centre[1] - kind.tanks[tank].point[1],
        centre[2] - kind.tanks[tank].point[2],
    )
    v = add(vector(kind.tanks[tank].velocity), rotate(R, cross(frame.mid_spin, moved)))
    _, _, arm = rotate(R, centre)
    _, _, a = rotate(R, data.axis_x)
    _, _, b = rotate(R, data.axis_y)
    height = frame.mid_position[2] + arm
    return mass * (0.5 * dot(v, v) + kind.water.gravity * height) - 0.5 * kind.water.gravity * (
        about_y * a * a + about_x * b * b
    )
