"""The step of hulls: one symmetric positive matrix a group, for the middle of the step and for its end."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import kernel
from heavylift.numerics.rotation import rotate_by_exponential, write_rotation_matrix
from heavylift.numerics.small import cholesky_factor, cholesky_solve, cross, rotate, rotate_back
from heavylift.solver.bodies.rigid import (
    ANGULAR_MOMENTUM,
    DOF,
    FORCE,
    INVERSE_PRINCIPAL,
    MASS,
    MID_POSITION,
    MID_ROTATION,
    POSITION,
    PRINCIPAL,
    VELOCITY,
)
from heavylift.solver.bodies.rigid_stage import orientation_of, stage_rotation
from heavylift.solver.bodies.rigid_step import advance_rigid_bodies, finish_rigid_bodies
from heavylift.solver.contact.generics import meet_again
from heavylift.solver.interface import (
    FIELD,
    Workspace,
    advance,
    correct,
    correct_rows,
    factor,
    finish,
    solve_again,
)
from heavylift.solver.kinds import implement
from heavylift.solver.marine.hull_parts import begin_memory, keep_memory
from heavylift.solver.marine.hull_restoring import restore
from heavylift.solver.marine.hull_stage import (
    advance_filter,
    gather_hull_forces,
    put_transform,
    tank_mass,
    to_hydrodynamic,
)
from heavylift.solver.marine.hulls import (
    CHANGE,
    COUNT,
    END_TRANSFORM,
    FINISH,
    FIRST,
    FIRST_TANK,
    FORESEEN,
    GROUP_DOF,
    HEADING,
    KNOWN,
    LAG,
    LAST_TANK,
    LEAD,
    LIFT,
    LOAD,
    LOST,
    MATRIX,
    MIDDLE,
    OFFSET,
    PREDICTED,
    QUADRATIC,
    RADIATED,
    ROTATION,
    SCRATCH,
    START,
    STATE_WIDTH,
    STIFFNESS,
    SUPPLIED,
    TANK_MASS,
    TANK_POINT,
    TANK_START,
    TANK_VELOCITY,
    TRANSFORM,
    WAVE,
    Hulls,
)

__all__ = ["assemble_mass", "put_end"]


@kernel(internal=True)
def assemble_mass(kind: Hulls, group: int, base: int, transform: int, at_end: bool, step: float) -> None:
    """Mass with that of the water, ``M + T^T (A_inf + h/2 (B + D)) T``, into a matrix of a group.

    At the end of a step the mass alone, with the rotation that stands there (in `stage`, see `put_transform`).
    """
    first, count = kind.groups[group, FIRST], kind.groups[group, COUNT]
    n = 6 * count
    matrix = kind.matrices
    half = 0.0 if at_end else 0.5 * step
    for i in range(n * n):
        matrix[base + i] = 0.0
    for p in range(count):
        for q in range(p + 1):
            left, right = first + p, first + q
            for i in range(6):
                for j in range(6):
                    # rows of H T, then T^T of them
                    total = 0.0
                    for k in range(6):
                        row = 6 * left + i
                        column = 6 * right + k
                        value = kind.added_mass[row, column] + half * (
                            kind.implicit[row, column] + kind.damping[row, column]
                        )
                        if p == q and i == k:
                            value += half * kind.hull[left, QUADRATIC + i] * abs(kind.vectors[START, row])
                        total += value * kind.stage[right, transform + 6 * k + j]
                    for k in range(6):
                        matrix[base + (6 * p + k) * n + 6 * q + j] += (
                            kind.stage[left, transform + 6 * i + k] * total
                        )
    for p in range(count):
        hull = first + p
        frame = kind.frame[hull]
        for k in range(3):
            matrix[base + (6 * p + k) * (n + 1)] += frame[MASS]
            matrix[base + (6 * p + 3 + k) * (n + 1)] += frame[PRINCIPAL + k]
        for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
            _add_tank_mass(kind, hull, tank, base + 6 * p * (n + 1), n, at_end)


@kernel(internal=True)
def _add_tank_mass(kind: Hulls, hull: int, tank: int, base: int, n: int, at_end: bool) -> None:
    """``m [1, -R r~]^T [1, -R r~]``, lower triangle."""
    m = kind.tanks[tank, TANK_MASS]
    r1 = kind.tanks[tank, TANK_POINT]
    r2 = kind.tanks[tank, TANK_POINT + 1]
    r3 = kind.tanks[tank, TANK_POINT + 2]
    R = (
        kind.stage[hull, ROTATION : ROTATION + 9]
        if at_end
        else kind.frame[hull, MID_ROTATION : MID_ROTATION + 9]
    )
    matrix = kind.matrices
    for k in range(3):
        matrix[base + k * (n + 1)] += m
        a, b, c = R[3 * k], R[3 * k + 1], R[3 * k + 2]
        matrix[base + 3 * n + k] += m * (c * r2 - b * r3)
        matrix[base + 4 * n + k] += m * (a * r3 - c * r1)
        matrix[base + 5 * n + k] += m * (b * r1 - a * r2)
    matrix[base + 3 * n + 3] += m * (r2 * r2 + r3 * r3)
    matrix[base + 4 * n + 4] += m * (r3 * r3 + r1 * r1)
    matrix[base + 5 * n + 5] += m * (r1 * r1 + r2 * r2)
    matrix[base + 4 * n + 3] -= m * r1 * r2
    matrix[base + 5 * n + 3] -= m * r1 * r3
    matrix[base + 5 * n + 4] -= m * r2 * r3


@kernel(internal=True)
def _add_stiffness(kind: Hulls, hull: int, base: int, n: int, step: float) -> None:
    """``h^2/4 K`` of the buoyancy, and ``h/2 K`` times the predicted displacement to the right-hand side."""
    stage = kind.stage[hull]
    R = kind.frame[hull, MID_ROTATION : MID_ROTATION + 9]
    zz, zx, zy = stage[STIFFNESS], stage[STIFFNESS + 1], stage[STIFFNESS + 2]
    xx, yy, xy = stage[STIFFNESS + 3], stage[STIFFNESS + 4], stage[STIFFNESS + 5]
    quarter = 0.25 * step * step
    d = stage[PREDICTED + 2]
    ahead = zz * d
    out = 6 * hull
    for i in range(3):
        spin = stage[PREDICTED + 3 + i]
        lift = zx * R[i] + zy * R[3 + i]
        ahead += lift * spin
        kind.vectors[LOAD, out + 3 + i] += 0.5 * step * lift * d
        kind.matrices[base + (3 + i) * n + 2] += quarter * lift
        for j in range(3):
            tilt = xx * R[i] * R[j] + yy * R[3 + i] * R[3 + j] + xy * (R[i] * R[3 + j] + R[3 + i] * R[j])
            kind.vectors[LOAD, out + 3 + i] += 0.5 * step * tilt * stage[PREDICTED + 3 + j]
            if j <= i:
                kind.matrices[base + (3 + i) * n + 3 + j] += quarter * tilt
    kind.matrices[base + 2 * n + 2] += quarter * zz
    kind.vectors[LOAD, out + 2] += 0.5 * step * ahead


@kernel(internal=True)
def _line_force(
    kind: Hulls, work: Workspace, end: int, d1: float, d2: float, d3: float, d4: float, d5: float, d6: float
) -> tuple[float, float, float, int, int]:
    """``K J d`` of one end of a line, its marker and the window of its hull."""
    hull, marker, line = kind.line_ends[end, 0], kind.line_ends[end, 1], kind.line_ends[end, 2]
    offset = kind.hulls[hull, OFFSET]
    J, K = work.jacobian[marker], kind.tangents[line]
    x = d1 + J[0, offset + 3] * d4 + J[0, offset + 4] * d5 + J[0, offset + 5] * d6
    y = d2 + J[1, offset + 3] * d4 + J[1, offset + 4] * d5 + J[1, offset + 5] * d6
    z = d3 + J[2, offset + 3] * d4 + J[2, offset + 4] * d5 + J[2, offset + 5] * d6
    return (
        K[0] * x + K[1] * y + K[2] * z,
        K[3] * x + K[4] * y + K[5] * z,
        K[6] * x + K[7] * y + K[8] * z,
        marker,
        offset,
    )


@kernel(internal=True)
def _add_line(kind: Hulls, work: Workspace, end: int, base: int, n: int, step: float) -> None:
    """``h^2/4 J^T K J`` of one end, and ``h/2 J^T K J`` times the predicted displacement."""
    hull = kind.line_ends[end, 0]
    quarter = 0.25 * step * step
    for column in range(7):
        if column < 6:
            f = _line_force(
                kind, work, end, 1.0 * (column == 0), 1.0 * (column == 1), 1.0 * (column == 2),
                1.0 * (column == 3), 1.0 * (column == 4), 1.0 * (column == 5),
            )  # fmt: skip
        else:
            d = kind.stage[hull, FORESEEN : FORESEEN + 6]
            f = _line_force(kind, work, end, d[0], d[1], d[2], d[3], d[4], d[5])
        J, offset = work.jacobian[f[3]], f[4]
        for i in range(6):
            value = J[0, offset + i] * f[0] + J[1, offset + i] * f[1] + J[2, offset + i] * f[2]
            if column == 6:
                kind.vectors[LOAD, 6 * hull + i] += 0.5 * step * value
            elif column <= i:
                kind.matrices[base + i * n + column] += quarter * value


@implement(factor, Hulls)
@kernel(internal=True)
def factor_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """Factor the step matrices, and find the velocities of the middle without joints."""
    gather_hull_forces(kind, work)
    for i in range(kind.vectors.shape[1]):
        kind.vectors[KNOWN, i] = 0.0
    begin_memory(kind.radiation, step, kind.implicit, kind.vectors)
    for group in range(kind.groups.shape[0]):
        first, base = kind.groups[group, FIRST], kind.groups[group, MATRIX]
        n = 6 * kind.groups[group, COUNT]
        _assemble(kind, group, base, step, work)
        for i in range(n * n):
            kind.matrices[base + 2 * n * n + i] = kind.matrices[base + i]
        a = kind.matrices[base : base + n * n]
        cholesky_factor(a, n)
        dof = kind.groups[group, GROUP_DOF]
        x = work.velocity[dof : dof + n]
        for i in range(n):
            x[i] = kind.vectors[LOAD, 6 * first + i]
        cholesky_solve(a, x, n)


@kernel(internal=True)
def _assemble(kind: Hulls, group: int, base: int, step: float, work: Workspace) -> None:
    """Matrix and right-hand side of a group at the pose of the stage."""
    first, count = kind.groups[group, FIRST], kind.groups[group, COUNT]
    n = 6 * count
    for p in range(count):
        _load_hull(kind, first + p, step, work)
    assemble_mass(kind, group, base, TRANSFORM, False, step)
    for p in range(count):
        restore(kind, first + p)
        for i in range(6):
            kind.vectors[LOAD, 6 * (first + p) + i] += 0.5 * step * kind.stage[first + p, LIFT + i]
        _add_stiffness(kind, first + p, base + 6 * p * (n + 1), n, step)
    for end in range(kind.line_ends.shape[0]):
        p = kind.line_ends[end, 0] - first
        if 0 <= p < count:
            _add_line(kind, work, end, base + 6 * p * (n + 1), n, step)


@implement(correct, Hulls)
@kernel(internal=True)
def correct_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """The equations at the middle that was found, in place of the predicted one: one Newton step with the same factor.

    Notes
    -----
    Without it the energy of a hull that rocks freely grows by 1e-4 in an hour of steps of 50 ms. Forces of joints
    stand as they are: what changes is the rest of the equations, ``(b - A U)`` at the new pose less that at the old.
    """
    for group in range(kind.groups.shape[0]):
        first, count = kind.groups[group, FIRST], kind.groups[group, COUNT]
        base, dof = kind.groups[group, MATRIX], kind.groups[group, GROUP_DOF]
        n = 6 * count
        change = kind.vectors[CHANGE, 6 * first : 6 * first + n]
        _subtract_product(kind, base + 2 * n * n, n, work.velocity, dof, change, 6 * first)
        for i in range(n):
            change[i] = -change[i]
        for p in range(count):
            _pose_at(kind, first + p, step, work.velocity, dof + 6 * p)
        _assemble(kind, group, base + n * n, step, work)
        x = kind.vectors[SCRATCH, 6 * first : 6 * first + n]
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
        total = kind.vectors[LOAD, at + i]
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
        stage[PREDICTED + k] = half * velocity[dof + k]
        stage[PREDICTED + 3 + k] = half * velocity[dof + 3 + k]
        frame[MID_POSITION + k] = frame[POSITION + k] + half * velocity[dof + k]
    q = rotate_by_exponential(
        orientation_of(kind, hull),
        half * velocity[dof + 3],
        half * velocity[dof + 4],
        half * velocity[dof + 5],
    )
    write_rotation_matrix(q, stage_rotation(kind, hull))
    put_transform(kind, hull, TRANSFORM, stage[HEADING], stage_rotation(kind, hull))


@implement(correct_rows, Hulls)
@kernel(internal=True)
def correct_rows_of_hulls(
    kind: Hulls, systems: Any, joints: Any, work: Workspace, time: float, step: float
) -> None:
    """`correct` has changed the velocities of these bodies."""
    solve_again(systems, joints, work, time, step)
    meet_again(systems, systems, joints, work, time, step)


@kernel(internal=True)
def _load_hull(kind: Hulls, hull: int, step: float, work: Workspace) -> None:
    """Momentum of body, ballast and water at the start, half impulses of forces of markers, waves and weight."""
    frame, vectors = kind.frame[hull], kind.vectors
    h, R, out = step, stage_rotation(kind, hull), 6 * hull
    L = rotate_back(R, frame[ANGULAR_MOMENTUM], frame[ANGULAR_MOMENTUM + 1], frame[ANGULAR_MOMENTUM + 2])
    for k in range(3):
        vectors[LOAD, out + k] = frame[MASS] * (frame[VELOCITY + k] + 0.5 * h * work.sums[FIELD + k])
        vectors[LOAD, out + 3 + k] = L[k]
    for k in range(6):
        vectors[LOAD, out + k] += 0.5 * h * frame[FORCE + k]
    for i in range(6):
        force = 0.5 * h * (vectors[WAVE, out + i] + vectors[KNOWN, out + i])
        for j in range(kind.added_mass.shape[1]):
            force += kind.added_mass[out + i, j] * vectors[LEAD, j]
        for k in range(6):
            vectors[LOAD, out + k] += kind.stage[hull, TRANSFORM + 6 * i + k] * force
    for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
        m = kind.tanks[tank, TANK_MASS]
        f1 = m * (kind.tanks[tank, TANK_START] + 0.5 * h * work.sums[FIELD])
        f2 = m * (kind.tanks[tank, TANK_START + 1] + 0.5 * h * work.sums[FIELD + 1])
        f3 = m * (kind.tanks[tank, TANK_START + 2] + 0.5 * h * work.sums[FIELD + 2])
        b1, b2, b3 = rotate_back(R, f1, f2, f3)
        r1, r2, r3 = (
            kind.tanks[tank, TANK_POINT],
            kind.tanks[tank, TANK_POINT + 1],
            kind.tanks[tank, TANK_POINT + 2],
        )
        vectors[LOAD, out] += f1
        vectors[LOAD, out + 1] += f2
        vectors[LOAD, out + 2] += f3
        vectors[LOAD, out + 3] += r2 * b3 - r3 * b2
        vectors[LOAD, out + 4] += r3 * b1 - r1 * b3
        vectors[LOAD, out + 5] += r1 * b2 - r2 * b1


@implement(advance, Hulls)
@kernel(internal=True)
def advance_hulls(kind: Hulls, time: float, step: float, work: Workspace) -> None:
    """Configuration and momenta to the end of the step; works of lines, waves and radiation in its middle."""
    h, vectors = step, kind.vectors
    for hull in range(kind.table.shape[0]):
        dof = kind.table[hull, DOF]
        to_hydrodynamic(kind, hull, TRANSFORM, MIDDLE, work.velocity[dof : dof + 6])
    for hull in range(kind.table.shape[0]):
        lost = supplied = 0.0
        for i in range(6 * hull, 6 * hull + 6):
            memory, drag = vectors[KNOWN, i], 0.0
            for j in range(vectors.shape[1]):
                memory -= kind.implicit[i, j] * vectors[MIDDLE, j]
                drag -= kind.damping[i, j] * vectors[MIDDLE, j]
            drag -= kind.hull[hull, QUADRATIC + i - 6 * hull] * abs(vectors[START, i]) * vectors[MIDDLE, i]
            vectors[RADIATED, i] = memory + drag
            lost -= (memory + drag) * vectors[MIDDLE, i]
            supplied += vectors[WAVE, i] * vectors[MIDDLE, i]
        kind.state[STATE_WIDTH * hull + LOST] += h * lost
        kind.state[STATE_WIDTH * hull + SUPPLIED] += h * supplied
    for end in range(kind.line_ends.shape[0]):
        _correct_line(kind, work, end, h)
    _fill_work(kind, time, h)
    for hull in range(kind.table.shape[0]):
        for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
            _lag_of_tank(kind, hull, tank, work.velocity, kind.table[hull, DOF], 2.0, step)
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
    put_end(kind, hull, kind.stage[hull, HEADING])
    R = kind.stage[hull, ROTATION : ROTATION + 9]
    L = rotate_back(R, frame[ANGULAR_MOMENTUM], frame[ANGULAR_MOMENTUM + 1], frame[ANGULAR_MOMENTUM + 2])
    end = kind.vectors[SCRATCH, 6 * hull : 6 * hull + 6]
    for k in range(3):
        end[k] = frame[VELOCITY + k]
        end[3 + k] = L[k] * frame[INVERSE_PRINCIPAL + k]
    to_hydrodynamic(kind, hull, END_TRANSFORM, FINISH, end)
    for i in range(6):
        at = 6 * hull + i
        kind.state[STATE_WIDTH * hull + LAG + i] = (
            2.0 * kind.vectors[MIDDLE, at] - kind.vectors[START, at] - kind.vectors[FINISH, at]
        ) / (step * step)
    for tank in range(kind.hulls[hull, FIRST_TANK], kind.hulls[hull, LAST_TANK]):
        _lag_of_tank(kind, hull, tank, end, 0, -1.0, step)


@kernel(internal=True)
def _lag_of_tank(
    kind: Hulls, hull: int, tank: int, velocity: NDArray[np.float64], dof: int, weight: float, step: float
) -> None:
    """The same of the water in a tank: set by the middle, less the start, and completed by the end."""
    middle = weight > 0.0
    R = stage_rotation(kind, hull) if middle else kind.stage[hull, ROTATION : ROTATION + 9]
    c = cross(
        velocity[dof + 3],
        velocity[dof + 4],
        velocity[dof + 5],
        kind.tanks[tank, TANK_POINT],
        kind.tanks[tank, TANK_POINT + 1],
        kind.tanks[tank, TANK_POINT + 2],
    )
    rate = rotate(R, c[0], c[1], c[2])
    at = STATE_WIDTH * kind.table.shape[0] + 3 * tank
    for k in range(3):
        value = weight * (velocity[dof + k] + rate[k])
        if middle:
            kind.state[at + k] = (value - kind.tanks[tank, TANK_VELOCITY + k]) / (step * step)
        else:
            kind.state[at + k] += value / (step * step)


@kernel(internal=True)
def _fill_work(kind: Hulls, time: float, step: float) -> None:
    """Energy that ballast brings with it, in the middle of the step: it comes with the velocity of its place."""
    for tank in range(kind.tank_table.shape[0]):
        gained = tank_mass(kind, tank, time + step) - tank_mass(kind, tank, time)
        if gained != 0.0:
            hull = kind.tank_table[tank, 0]
            v1, v2, v3 = (
                kind.tanks[tank, TANK_VELOCITY],
                kind.tanks[tank, TANK_VELOCITY + 1],
                kind.tanks[tank, TANK_VELOCITY + 2],
            )
            _, _, arm = rotate(
                stage_rotation(kind, hull),
                kind.tanks[tank, TANK_POINT],
                kind.tanks[tank, TANK_POINT + 1],
                kind.tanks[tank, TANK_POINT + 2],
            )
            height = kind.frame[hull, MID_POSITION + 2] + arm
            kind.state[STATE_WIDTH * hull + SUPPLIED] += gained * (
                0.5 * (v1 * v1 + v2 * v2 + v3 * v3) + kind.water[1] * height
            )


@kernel(internal=True)
def _correct_line(kind: Hulls, work: Workspace, end: int, step: float) -> None:
    """The force of a line at the middle that was found, not at the predicted one: for the work of the step."""
    hull = kind.line_ends[end, 0]
    dof = kind.table[hull, DOF]
    d, U = kind.stage[hull, FORESEEN : FORESEEN + 6], work.velocity[dof : dof + 6]
    half = 0.5 * step
    f = _line_force(
        kind, work, end,
        half * U[0] - d[0], half * U[1] - d[1], half * U[2] - d[2],
        half * U[3] - d[3], half * U[4] - d[4], half * U[5] - d[5],
    )  # fmt: skip
    J, offset = work.jacobian[f[3]], f[4]
    for i in range(6):
        kind.frame[hull, FORCE + i] -= (
            J[0, offset + i] * f[0] + J[1, offset + i] * f[1] + J[2, offset + i] * f[2]
        )


@implement(finish, Hulls)
@kernel(internal=True)
def finish_hulls(kind: Hulls, step: float, work: Workspace) -> None:
    """Spins; memory, filters and ballast to the end of the step."""
    finish_rigid_bodies(kind, step, work)
    for hull in range(kind.table.shape[0]):
        advance_filter(kind, hull, step, True)
        put_end(kind, hull, kind.stage[hull, HEADING])
        to_hydrodynamic(kind, hull, END_TRANSFORM, FINISH, kind.frame[hull, VELOCITY : VELOCITY + 6])
    keep_memory(kind.radiation, kind.vectors)


@kernel(internal=True)
def put_end(kind: Hulls, hull: int, heading: float) -> None:
    """Rotation and ``T`` of the carried state into the stage."""
    R = kind.stage[hull, ROTATION : ROTATION + 9]
    write_rotation_matrix(orientation_of(kind, hull), R)
    put_transform(kind, hull, END_TRANSFORM, heading, R)
