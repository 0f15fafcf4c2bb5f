"""Hulls in the middle of a step: pose, hydrodynamic velocities at its start, markers, gathered forces."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import write_rotation_matrix
from heavylift.numerics.vectors import cross, rotate
from heavylift.solver.bodies.frames.motion import add_wrench, orientation_of
from heavylift.solver.bodies.rigid.step import fill_rigid_markers, predict_rigid_bodies, start_rigid_bodies
from heavylift.solver.interface import RECORD, ROWS, Workspace, fill_markers, predict, start
from heavylift.solver.kinds import implement
from heavylift.solver.water.hulls.kind import (
    Hulls,
)
from heavylift.solver.water.hulls.parts import add_waves

__all__ = ["advance_filter", "filtered", "gather_hull_forces", "hull_yaw", "put_transform", "to_hydrodynamic"]


@kernel(internal=True)
def put_transform(
    kind: Hulls, hull: int, heading: float, R: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """``u = T U`` at an orientation: velocities of the reference point in heading axes, from those of the body.

    With ``P = Rz(-heading) R`` and the reference point r, ``T = ((Rz(-heading), -P r~), (0, P))``; shape (6, 6).
    """
    c, s = math.cos(heading), math.sin(heading)
    r1 = kind.hulls[hull].reference[0]
    r2 = kind.hulls[hull].reference[1]
    r3 = kind.hulls[hull].reference[2]
    for i in range(3):
        if i == 0:
            a, b, e = c, s, 0.0
        elif i == 1:
            a, b, e = -s, c, 0.0
        else:
            a, b, e = 0.0, 0.0, 1.0
        p1 = a * R[0] + b * R[3] + e * R[6]
        p2 = a * R[1] + b * R[4] + e * R[7]
        p3 = a * R[2] + b * R[5] + e * R[8]
        out[i, 0], out[i, 1], out[i, 2] = a, b, e
        out[i, 3] = p3 * r2 - p2 * r3
        out[i, 4] = p1 * r3 - p3 * r1
        out[i, 5] = p2 * r1 - p1 * r2
        out[3 + i, 0] = out[3 + i, 1] = out[3 + i, 2] = 0.0
        out[3 + i, 3], out[3 + i, 4], out[3 + i, 5] = p1, p2, p3


@kernel(internal=True)
def to_hydrodynamic(
    transform: NDArray[np.float64], hull: int, U: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """``u = T U`` into the place of a hull in a vector of all."""
    for i in range(6):
        total = 0.0
        for k in range(6):
            total += transform[i, k] * U[k]
        out[6 * hull + i] = total


@kernel(inline=True, internal=True)
def hull_yaw(kind: Hulls, hull: int, R: NDArray[np.float64], near: float) -> float:
    """Heading of the x axis of a hull, the turn that is nearest to a given one [rad]."""
    x = (
        R[0] * kind.hulls[hull].axis_x[0]
        + R[1] * kind.hulls[hull].axis_x[1]
        + R[2] * kind.hulls[hull].axis_x[2]
    )
    y = (
        R[3] * kind.hulls[hull].axis_x[0]
        + R[4] * kind.hulls[hull].axis_x[1]
        + R[5] * kind.hulls[hull].axis_x[2]
    )
    yaw = math.atan2(y, x)
    return yaw + 2.0 * math.pi * math.floor((near - yaw) / (2.0 * math.pi) + 0.5)


@kernel(inline=True, internal=True)
def filtered(value: float, rate: float, target: float, frequency: float, time: float) -> tuple[float, float]:
    """Critically damped filter ``y'' + 2 c y' + c^2 y = c^2 target`` after a time with a target that stays."""
    e = value - target
    slope = rate + frequency * e
    decay = math.exp(-frequency * time)
    return target + (e + slope * time) * decay, (rate - frequency * slope * time) * decay


@kernel(internal=True)
def advance_filter(kind: Hulls, hull: int, time: float, keep: bool) -> None:
    """Place and heading that the waves see, a time after the start of the step; into the stage, or kept."""
    stage, state, cut = kind.stage[hull], kind.state[hull], kind.hulls[hull].cut_off
    seen = state.low_pass
    x0, x1 = filtered(seen[0], seen[1], stage.target[0], cut, time)
    y0, y1 = filtered(seen[2], seen[3], stage.target[1], cut, time)
    p0, p1 = filtered(seen[4], seen[5], stage.target[2], cut, time)
    if keep:
        seen[0], seen[1], seen[2], seen[3], seen[4], seen[5] = x0, x1, y0, y1, p0, p1
        state.yaw = stage.target[2]
    else:
        stage.place[0], stage.place[1], stage.heading = x0, y0, p0


@implement(start, Hulls)
@kernel(internal=True)
def start_hulls(kind: Hulls, time: float, work: Workspace) -> None:
    """Momenta; markers of the second and later hulls of a group see their own six of its velocities."""
    start_rigid_bodies(kind, time, work)
    for marker in range(kind.markers.shape[0]):
        number, body, direction = (
            kind.markers[marker].number,
            kind.markers[marker].body,
            kind.markers[marker].direction,
        )
        offset = kind.hulls[body].offset
        if offset > 0:
            for k in range(3):
                work.jacobian[number, k, k] = 0.0
                work.jacobian[number, k, offset + k] = 0.0 if direction else 1.0


@implement(predict, Hulls)
@kernel(internal=True)
def predict_hulls(kind: Hulls, time: float, step: float) -> None:
    """As rigid bodies; and hydrodynamic velocities at the start, in the heading axes of the middle; waves there."""
    predict_rigid_bodies(kind, time, step)
    fill_tanks(kind, time + 0.5 * step)
    for hull in range(kind.table.shape[0]):
        frame, stage = kind.frame[hull], kind.stage[hull]
        R = kind.frame[hull].mid_rotation
        x, y, _ = rotate(R, kind.hulls[hull].reference)
        stage.target[0], stage.target[1] = frame.mid_position[0] + x, frame.mid_position[1] + y
        stage.target[2] = hull_yaw(kind, hull, R, kind.state[hull].yaw)
        advance_filter(kind, hull, 0.5 * step, False)
        heading = stage.heading
        before = kind.stage[hull].rotation
        write_rotation_matrix(orientation_of(kind.frame[hull]), before)
        put_transform(kind, hull, heading, before, stage.transform)
        to_hydrodynamic(stage.transform, hull, kind.frame[hull].twist, kind.vectors.start)
        for k in range(6):
            lag = kind.state[hull].lag[k]
            kind.vectors.lead[6 * hull + k] = kind.vectors.start[6 * hull + k] + 0.5 * step * step * lag
            kind.vectors.speed[6 * hull + k] = kind.vectors.start[6 * hull + k]
        for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
            put_tank_velocity(kind, hull, tank, before)
            for k in range(3):
                lag = kind.tanks[tank].lag[k]
                kind.tanks[tank].start_velocity[k] = kind.tanks[tank].velocity[k] + 0.5 * step * step * lag
        put_transform(kind, hull, heading, R, stage.transform)
        a = frame.arc * step * step
        for k in range(3):
            stage.predicted[k] = frame.mid_position[k] - frame.position[k]
            stage.predicted[3 + k] = 0.5 * step * frame.spin[k] + a * frame.spin_rate[k]
            stage.foreseen[k], stage.foreseen[3 + k] = stage.predicted[k], stage.predicted[3 + k]
    # in the axes of this step the water has another energy than in those that its state was recorded in
    kind.stage[0].turned = water_energy(kind, kind.vectors.start) - turned_energy(kind, kind.vectors.start)
    find_waves(kind, time + 0.5 * step)


@kernel(internal=True)
def water_energy(kind: Hulls, u: NDArray[np.float64]) -> float:
    """``1/2 u^T A_inf u`` of velocities [J]."""
    total = 0.0
    for i in range(kind.added_mass.shape[0]):
        along = 0.0
        for j in range(kind.added_mass.shape[0]):
            along += kind.added_mass[i, j] * u[j]
        total += 0.5 * u[i] * along
    return total


@kernel(internal=True)
def turned_energy(kind: Hulls, u: NDArray[np.float64]) -> float:
    """The same in the axes of the low-passed headings that are carried, from those of the step."""
    for hull in range(kind.table.shape[0]):
        angle = kind.stage[hull].heading - kind.state[hull].low_pass[4]
        c, s = math.cos(angle), math.sin(angle)
        for k in range(0, 6, 3):
            at = 6 * hull + k
            x, y = u[at], u[at + 1]
            kind.vectors.scratch[at] = c * x - s * y
            kind.vectors.scratch[at + 1] = s * x + c * y
            kind.vectors.scratch[at + 2] = u[at + 2]
    return water_energy(kind, kind.vectors.scratch)


@kernel(internal=True)
def find_waves(kind: Hulls, time: float) -> None:
    """Forces of the waves at a time, at the places and headings of the stage."""
    for i in range(kind.vectors.wave.shape[0]):
        kind.vectors.wave[i] = 0.0
    add_waves(kind.excitation, time, kind.stage, kind.vectors)


@kernel(internal=True)
def put_tank_velocity(kind: Hulls, hull: int, tank: int, R: NDArray[np.float64]) -> None:
    """Velocity of the water in a tank at the carried velocities."""
    frame = kind.frame[hull]
    c = cross(frame.spin, kind.tanks[tank].point)  # fmt: skip
    rate = rotate(R, c)
    for k in range(3):
        kind.tanks[tank].velocity[k] = frame.velocity[k] + rate[k]


@kernel(internal=True)
def tank_mass(kind: Hulls, tank: int, time: float) -> float:
    """Of the schedule, linear between its rows and held at the ends [kg]."""
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
    return levels[low].mass + part * (levels[high].mass - levels[low].mass)


@kernel(internal=True)
def fill_tanks(kind: Hulls, time: float) -> None:
    """Masses at a time."""
    for tank in range(kind.tanks.shape[0]):
        kind.tanks[tank].mass = tank_mass(kind, tank, time)


@implement(fill_markers, Hulls)
@kernel(internal=True)
def fill_hull_markers(kind: Hulls, at_midpoint: bool, level: int, work: Workspace) -> None:
    """As rigid bodies; windows of the second and later hulls of a group are shifted."""
    fill_rigid_markers(kind, at_midpoint, level, work)
    for marker in range(kind.markers.shape[0]):
        if kind.markers[marker].level > level:
            break
        offset = kind.hulls[kind.markers[marker].body].offset
        if offset > 0:
            jacobian = work.jacobian[kind.markers[marker].number]
            for k in range(3):
                for j in range(3, 6):
                    jacobian[k, offset + j] = jacobian[k, j]
                    jacobian[k, j] = 0.0


@kernel(internal=True)
def gather_hull_forces(kind: Hulls, work: Workspace) -> None:
    """Resultants (world axes) and moments about the centres of mass (body axes) of all marker forces."""
    for hull in range(kind.table.shape[0]):
        for j in range(6):
            kind.frame[hull].wrench[j] = 0.0
    for marker in range(kind.markers.shape[0] - 1, -1, -1):
        if kind.markers[marker].level == RECORD:
            continue
        if kind.markers[marker].level == ROWS:
            break
        number, hull = kind.markers[marker].number, kind.markers[marker].body
        add_wrench(
            kind.frame[hull], work.jacobian[number], kind.hulls[hull].offset, work.markers[number].force
        )
