"""The step of hulls: one symmetric positive matrix a group, for the middle of the step and for its end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.small import cholesky_factor, cholesky_solve
from heavylift.numerics.vectors import cross, rotate, rotate_back
from heavylift.solver.bodies.frames.motion import orientation_of
from heavylift.solver.bodies.rigid.step import advance_rigid_bodies, finish_rigid_bodies
from heavylift.solver.interface import (
    Workspace,
    advance,
    correct,
    factor,
    finish,
)
from heavylift.solver.kinds import implement
from heavylift.solver.water.hulls.kind import (
    Hulls,
)
from heavylift.solver.water.hulls.matrix import assemble, moved_on
from heavylift.solver.water.hulls.parts import begin_memory, keep_memory
from heavylift.solver.water.hulls.stage import (
    advance_filter,
    gather_hull_forces,
    put_transform,
    tank_mass,
    to_hydrodynamic,
    turned_energy,
    water_energy,
)

__all__ = ["put_end"]

ROUNDING = 1e-10
"""Of a velocity, below which differences of velocities are not told from rounding."""


@implement(factor, Hulls)
@kernel(internal=True)
def factor_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """Factor the step matrices, and find the velocities of the middle without joints."""
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
        a = kind.matrices[base : base + n * n]
        cholesky_factor(a, n)
        dof = kind.groups[group].dof
        x = work.velocity[dof : dof + n]
        for i in range(n):
            x[i] = kind.vectors.load[6 * first + i]
        cholesky_solve(a, x, n)


@implement(correct, Hulls)
@kernel(internal=True)
def correct_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """The equations at the middle that was found, in place of the predicted one: one Newton step with the same factor.

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
        cholesky_solve(kind.matrices[base : base + n * n], x, n)
        for i in range(n):
            work.velocity[dof + i] += x[i]


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
    _fill_work(kind, time, h)
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
def _fill_work(kind: Hulls, time: float, step: float) -> None:
    """Energy that ballast brings with it, in the middle of the step: it comes with the velocity of its place."""
    for tank in range(kind.tanks.shape[0]):
        before, after = tank_mass(kind, tank, time), tank_mass(kind, tank, time + step)
        gained = after - before
        if gained != 0.0:
            hull = kind.tanks[tank].hull
            if (before > 0.0) != (after > 0.0):
                kind.state[hull].supplied += _free_surface_energy(kind, hull, tank) * (
                    1.0 if after > 0.0 else -1.0
                )
            v1, v2, v3 = (
                kind.tanks[tank].velocity[0],
                kind.tanks[tank].velocity[1],
                kind.tanks[tank].velocity[2],
            )
            _, _, arm = rotate(kind.frame[hull].mid_rotation, kind.tanks[tank].point)
            height = kind.frame[hull].mid_position[2] + arm
            kind.state[hull].supplied += gained * (
                0.5 * (v1 * v1 + v2 * v2 + v3 * v3) + kind.water.gravity * height
            )


@kernel(internal=True)
def _free_surface_energy(kind: Hulls, hull: int, tank: int) -> float:
    """Potential that the free surface of a tank has in the middle of the step [J]."""
    R, data = kind.frame[hull].mid_rotation, kind.hulls[hull]
    _, _, a = rotate(R, data.axis_x)
    _, _, b = rotate(R, data.axis_y)
    about_x, about_y = kind.tanks[tank].free_surface[0], kind.tanks[tank].free_surface[1]
    return -0.5 * kind.water.gravity * (about_y * a * a + about_x * b * b)


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


@kernel(internal=True)
def put_end(kind: Hulls, hull: int, heading: float) -> None:
    """Rotation and ``T`` of the carried state into the stage."""
    stage = kind.stage[hull]
    write_rotation_matrix(orientation_of(kind.frame[hull]), stage.rotation)
    put_transform(kind, hull, heading, stage.rotation, stage.end_transform)
