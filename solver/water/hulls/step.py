"""The step of hulls: their stage, one symmetric positive matrix a group for the middle of the step and for its end.

Joints see hulls through ``X = A^-1 G^T`` with the matrix of their group, whose inverse takes the place of its factor:
the rows of all joints are multiplied by it, and it is small.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.lanes import LANES_1, LANES_2, LANES_4, LANES_8, put_six_rows
from heavylift.numerics.outcome import Outcome
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.small import cholesky_factor, cholesky_invert
from heavylift.numerics.vectors import cross, rotate, rotate_back, vector
from heavylift.solver.bodies.frames.motion import add_wrench, check_frames, orientation_of
from heavylift.solver.bodies.rigid.step import (
    advance_rigid_bodies,
    fill_rigid_markers,
    finish_rigid_bodies,
    predict_rigid_bodies,
    start_rigid_bodies,
)
from heavylift.solver.interface import (
    RECORD,
    ROWS,
    Workspace,
    advance,
    apply_inverse,
    check,
    correct,
    factor,
    fill_markers,
    finish,
    predict,
    start,
)
from heavylift.solver.kinds import implement
from heavylift.solver.rows.structure import RowArrays
from heavylift.solver.water.hulls.kind import Hulls
from heavylift.solver.water.hulls.matrix import assemble, assemble_mass, moved_on
from heavylift.solver.water.hulls.parts import add_waves, begin_memory, keep_memory
from heavylift.solver.water.hulls.tanks import (
    add_ballast_work,
    fill_tanks,
    overfilled,
    put_level,
    put_tank_velocity,
)

__all__ = [
    "advance_filter",
    "filtered",
    "gather_hull_forces",
    "hull_yaw",
    "put_end",
    "put_transform",
    "to_hydrodynamic",
]


# ---- the stage: pose, hydrodynamic velocities at the start, markers, gathered forces ----


@kernel(internal=True)
def put_transform(
    kind: Hulls, hull: int, heading: float, R: NDArray[np.float64], out: NDArray[np.float64]
) -> None:
    """``u = T U`` at an orientation: velocities of the reference point in heading axes, from those of the body.

    With ``P = Rz(-heading) R`` and the reference point r, ``T = ((Rz(-heading), -P r~), (0, P))``; shape (6, 6).
    """
    c, s = math.cos(heading), math.sin(heading)
    r = vector(kind.hulls[hull].reference)
    for i in range(3):
        if i == 0:
            a, b, e = c, s, 0.0
        elif i == 1:
            a, b, e = -s, c, 0.0
        else:
            a, b, e = 0.0, 0.0, 1.0
        p = rotate_back(R, (a, b, e))
        turned = cross(r, p)
        out[i, 0], out[i, 1], out[i, 2] = a, b, e
        for k in range(3):
            out[i, 3 + k] = turned[k]
            out[3 + i, k] = 0.0
            out[3 + i, 3 + k] = p[k]


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
    put_level(kind, time + 0.5 * step)
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


# ---- the step ----


ROUNDING = 1e-10
"""Of a velocity, below which differences of velocities are rounding."""


@implement(factor, Hulls)
@kernel(internal=True)
def factor_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """Invert the step matrices, and find the velocities of the middle without joints."""
    gather_hull_forces(kind, work)
    for i in range(kind.vectors.known.shape[0]):
        kind.vectors.known[i] = 0.0
    begin_memory(kind.radiation, step, kind.implicit, kind.vectors)
    for group in range(kind.groups.shape[0]):
        first, base = kind.groups[group].first, kind.groups[group].matrix
        n = 6 * kind.groups[group].count
        assemble(kind, group, base, step, work, False)
        for i in range(n * n):
            kind.matrices[base + 2 * n * n + i] = kind.matrices[base + i]
        _invert(kind, base, n)
        dof = kind.groups[group].dof
        for i in range(n):
            work.velocity[dof + i] = 0.0
        _add_solution(kind, base, n, kind.vectors.load[6 * first : 6 * first + n], work.velocity, dof)


@kernel(internal=True)
def _invert(kind: Hulls, base: int, n: int) -> None:
    """Put the inverse of a matrix in its place."""
    matrix = kind.matrices[base : base + n * n]
    cholesky_factor(matrix, n)
    cholesky_invert(matrix, n)


@kernel(internal=True)
def _add_solution(
    kind: Hulls, base: int, n: int, b: NDArray[np.float64], velocity: NDArray[np.float64], dof: int
) -> None:
    """``U += A^-1 b`` with an inverse."""
    for i in range(n):
        total = 0.0
        for k in range(n):
            total += kind.matrices[base + i * n + k] * b[k]
        velocity[dof + i] += total


@implement(correct, Hulls)
@kernel(internal=True)
def correct_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """The equations at the middle that was found, in place of the predicted one: one Newton step with the same inverse.

    Notes
    -----
    Without it the energy of a hull that rocks freely grows by 1e-4 in an hour of steps of 50 ms. Forces of joints
    stand as they are: what changes is the rest of the equations, ``(b - A U)`` at the new pose less that at the old.
    """
    work.control.changed += 1
    for group in range(kind.groups.shape[0]):
        first, count = kind.groups[group].first, kind.groups[group].count
        base, dof = kind.groups[group].matrix, kind.groups[group].dof
        n = 6 * count
        change = kind.vectors.change[6 * first : 6 * first + n]
        _subtract_product(kind, base + 2 * n * n, n, work.velocity, dof, change, 6 * first)
        for i in range(n):
            change[i] = -change[i]
        for p in range(count):
            _pose_at(kind, first + p, step, work.velocity, dof + 6 * p)
            to_hydrodynamic(
                kind.stage[first + p].transform,
                first + p,
                work.velocity[dof + 6 * p : dof + 6 * p + 6],
                kind.vectors.speed,
            )
        assemble(kind, group, base + n * n, step, work, True)
        x = kind.vectors.scratch[6 * first : 6 * first + n]
        _subtract_product(kind, base + n * n, n, work.velocity, dof, x, 6 * first)
        for i in range(n):
            x[i] += change[i]
        _add_solution(kind, base, n, x, work.velocity, dof)


@kernel(internal=True)
def _subtract_product(
    kind: Hulls, base: int, n: int, velocity: NDArray[np.float64], dof: int, out: NDArray[np.float64], at: int
) -> None:
    """``out = b - A U`` with a matrix of which the lower triangle is there."""
    for i in range(n):
        total = kind.vectors.load[at + i]
        for j in range(n):
            k = base + (i * n + j if j <= i else j * n + i)
            total -= kind.matrices[k] * velocity[dof + j]
        out[i] = total


@kernel(internal=True)
def _pose_at(kind: Hulls, hull: int, step: float, velocity: NDArray[np.float64], dof: int) -> None:
    """The stage half a step along a velocity."""
    frame, stage = kind.frame[hull], kind.stage[hull]
    half = 0.5 * step
    for k in range(3):
        stage.predicted[k] = half * velocity[dof + k]
        stage.predicted[3 + k] = half * velocity[dof + 3 + k]
        frame.mid_position[k] = frame.position[k] + half * velocity[dof + k]
    q = rotate_by_exponential(
        orientation_of(frame),
        half * velocity[dof + 3],
        half * velocity[dof + 4],
        half * velocity[dof + 5],
    )
    write_rotation_matrix(q, kind.frame[hull].mid_rotation)
    put_transform(kind, hull, stage.heading, kind.frame[hull].mid_rotation, stage.transform)


@implement(advance, Hulls)
@kernel(internal=True)
def advance_hulls(kind: Hulls, time: float, step: float, work: Workspace) -> None:
    """Configuration and momenta to the end of the step; works of lines, waves and radiation in its middle."""
    h, vectors = step, kind.vectors
    for hull in range(kind.table.shape[0]):
        dof = kind.table[hull].dof
        to_hydrodynamic(kind.stage[hull].transform, hull, work.velocity[dof : dof + 6], vectors.middle)
    for hull in range(kind.table.shape[0]):
        lost = supplied = 0.0
        for i in range(6 * hull, 6 * hull + 6):
            memory, drag = vectors.known[i], 0.0
            for j in range(vectors.middle.shape[0]):
                memory -= kind.implicit[i, j] * vectors.middle[j]
                drag -= kind.damping[i, j] * vectors.middle[j]
            drag -= (
                kind.hulls[hull].quadratic_damping[i - 6 * hull] * abs(vectors.speed[i]) * vectors.middle[i]
            )
            vectors.radiated[i] = memory + drag
            lost -= (memory + drag) * vectors.middle[i]
            supplied += vectors.wave[i] * vectors.middle[i]
        kind.state[hull].lost += h * lost
        kind.state[hull].supplied += h * supplied
    for end in range(kind.line_ends.shape[0]):
        _correct_line(kind, work, end, h)
    add_ballast_work(kind, time, h)
    for hull in range(kind.table.shape[0]):
        for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
            _lag_of_tank(kind, hull, tank, work.velocity, kind.table[hull].dof, False, step)
    advance_rigid_bodies(kind, time, step, work)
    for hull in range(kind.table.shape[0]):
        _measure_lag(kind, hull, step)


@kernel(internal=True)
def _measure_lag(kind: Hulls, hull: int, step: float) -> None:
    """Carry ``(2 u_middle - u_start - u_end) / h^2``, before impulses of joints change the end.

    Notes
    -----
    The step gives the water the momentum ``A (2 u_middle - 2 u_start)``. As T turns with the hull, the sum of these is
    not that of ``A (u_end - u_start)`` but for terms of the order h^2 a step, which are smooth: half of the last is
    added to u_start in the next. Without it the step is of first order.
    """
    frame = kind.frame[hull]
    put_end(kind, hull, kind.stage[hull].heading)
    R = kind.stage[hull].rotation
    L = rotate_back(R, frame.angular_momentum)
    end = kind.vectors.scratch[6 * hull : 6 * hull + 6]
    for k in range(3):
        end[k] = frame.velocity[k]
        end[3 + k] = L[k] * frame.inverse_inertia[k]
    to_hydrodynamic(kind.stage[hull].end_transform, hull, end, kind.vectors.finish)
    moving = turning = 0.0
    for i in range(3):
        moving = max(moving, abs(kind.vectors.middle[6 * hull + i]))
        turning = max(turning, abs(kind.vectors.middle[6 * hull + 3 + i]))
    for i in range(6):
        at = 6 * hull + i
        lag = 2.0 * kind.vectors.middle[at] - kind.vectors.start[at] - kind.vectors.finish[at]
        if abs(lag) > ROUNDING * (moving if i < 3 else turning):  # in a very short step there is nothing else
            kind.state[hull].lag[i] = lag / (step * step)
    for tank in range(kind.hulls[hull].first_tank, kind.hulls[hull].last_tank):
        _lag_of_tank(kind, hull, tank, end, 0, True, step)


@kernel(internal=True)
def _lag_of_tank(
    kind: Hulls, hull: int, tank: int, velocity: NDArray[np.float64], dof: int, at_end: bool, step: float
) -> None:
    """The same of the water in a tank: what the middle has is kept in its scratch until the end."""
    R = kind.stage[hull].rotation if at_end else kind.frame[hull].mid_rotation
    c = cross((velocity[dof + 3], velocity[dof + 4], velocity[dof + 5]), kind.tanks[tank].point)
    rate = rotate(R, c)
    for k in range(3):
        v = velocity[dof + k] + rate[k]
        if not at_end:
            kind.tanks[tank].start_velocity[k] = v
            continue
        middle = kind.tanks[tank].start_velocity[k]
        lag = 2.0 * middle - kind.tanks[tank].velocity[k] - v
        if abs(lag) > ROUNDING * abs(middle):
            kind.tanks[tank].lag[k] = lag / (step * step)


@kernel(internal=True)
def _correct_line(kind: Hulls, work: Workspace, end: int, step: float) -> None:
    """The force of a line at the middle that was found, not at the predicted one: for the work of the step."""
    at = kind.line_ends[end]
    hull, marker, other = at.hull, at.marker, at.other
    x, y, z = moved_on(kind, work, end, step)
    if other >= 0:
        x2, y2, z2 = moved_on(kind, work, other, step)
        x, y, z = x - x2, y - y2, z - z2
    J, offset = work.jacobian[marker], kind.hulls[hull].offset
    for i in range(6):
        kind.frame[hull].wrench[i] -= J[0, offset + i] * x + J[1, offset + i] * y + J[2, offset + i] * z


@implement(finish, Hulls)
@kernel(internal=True)
def finish_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """Spins; memory, filters and ballast to the end of the step."""
    finish_rigid_bodies(kind, step, work)
    for hull in range(kind.table.shape[0]):
        advance_filter(kind, hull, step, True)
        put_end(kind, hull, kind.stage[hull].heading)
        kind.state[hull].tipped = max(kind.state[hull].tipped, 1.0 - _uprightness(kind, hull))
        to_hydrodynamic(
            kind.stage[hull].end_transform,
            hull,
            kind.frame[hull].twist,
            kind.vectors.finish,
        )
    # the theory has no force where the axes of an uneven added mass turn: what that changes is supplied
    turned = turned_energy(kind, kind.vectors.finish) - water_energy(kind, kind.vectors.finish)
    kind.state[0].supplied += kind.stage[0].turned + turned
    keep_memory(kind.radiation, kind.vectors)


@kernel(inline=True, internal=True)
def _uprightness(kind: Hulls, hull: int) -> float:
    """Cosine of the tilt at the end of the step: the vertical component of the axis of the body that points up."""
    up = cross(vector(kind.hulls[hull].axis_x), vector(kind.hulls[hull].axis_y))
    R = kind.stage[hull].rotation
    return R[6] * up[0] + R[7] * up[1] + R[8] * up[2]


@kernel(internal=True)
def put_end(kind: Hulls, hull: int, heading: float) -> None:
    """Rotation and ``T`` of the carried state into the stage."""
    stage = kind.stage[hull]
    write_rotation_matrix(orientation_of(kind.frame[hull]), stage.rotation)
    put_transform(kind, hull, heading, stage.rotation, stage.end_transform)


# ---- limits, and rows of joints ----


OUTSIDE_DATABASE = int(Outcome.OUTSIDE_DATABASE)
LIMIT_REACHED = int(Outcome.LIMIT_REACHED)


@implement(check, Hulls)
@kernel(internal=True)
def check_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """As rigid bodies; whether waves and water plane are still those of the database, and tanks hold their water."""
    check_frames(kind, step, work)
    for tank in range(kind.tanks.shape[0]):
        if overfilled(kind, tank):
            work.status.outcome = LIMIT_REACHED
            work.status.body = kind.table[kind.tanks[tank].hull].number
    for hull in range(kind.table.shape[0]):
        total = 0.0
        for i in range(6 * hull, 6 * hull + 6):
            total += kind.vectors.wave[i]
        least = kind.hulls[hull].least_volume
        clip = kind.stage[hull].clip
        left = least > 0.0 and (clip.volume < least or not clip.plane_area > 0.0)
        if left or math.isnan(total):
            work.status.outcome = OUTSIDE_DATABASE
            work.status.body = kind.table[hull].number


@implement(apply_inverse, Hulls)
@kernel(internal=True)
def apply_inverse_of_hulls(kind: Hulls, at_midpoint: bool, system: RowArrays) -> None:
    """Of the attachments on these bodies; at the end of the step by the mass alone, which is inverted here."""
    last = kind.table[kind.table.shape[0] - 1].dof
    if not at_midpoint:
        for hull in range(kind.table.shape[0]):
            put_end(kind, hull, kind.stage[hull].heading)
        for group in range(kind.groups.shape[0]):
            n = 6 * kind.groups[group].count
            base = kind.groups[group].matrix + n * n
            assemble_mass(kind, group, base, True, 0.0)
            _invert(kind, base, n)
    for i in range(system.attachments.shape[0]):
        dof = system.attachments[i].dof
        if dof < kind.table[0].dof or dof > last:
            continue
        for group in range(kind.groups.shape[0]):
            if kind.groups[group].dof == dof:
                n = 6 * kind.groups[group].count
                base = kind.groups[group].matrix + (0 if at_midpoint else n * n)
                _put_panel(kind, base, n, system, system.attachments[i].panel)


@kernel(internal=True)
def _put_panel(kind: Hulls, base: int, n: int, system: RowArrays, panel: int) -> None:
    """``X = A^-1 G^T``, all rows of a joint at once."""
    if system.lanes == 1:
        _put_rows(LANES_1, kind, base, n, system, panel)
    elif system.lanes == 2:
        _put_rows(LANES_2, kind, base, n, system, panel)
    elif system.lanes == 4:
        _put_rows(LANES_4, kind, base, n, system, panel)
    else:
        _put_rows(LANES_8, kind, base, n, system, panel)


@kernel(internal=True)
def _put_rows(shape: Any, kind: Hulls, base: int, n: int, system: RowArrays, panel: int) -> None:
    G, lanes = system.panels, len(shape[1])
    out = G.shape[0] // 2 + panel
    for i in range(0, n, 6):
        put_six_rows(shape, G, out + i * lanes, kind.matrices, base + i, G, panel, n)
