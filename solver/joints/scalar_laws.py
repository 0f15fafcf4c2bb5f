"""Forces with corners on a distance, angle or travel: tabulated springs, stops, dry friction.

Each is one row with a law. Springs and stops take the discrete gradient of their energy over a carried
value ``q += h G v``, so no step gains energy from a corner. A friction row is either a
constant load against the motion, or sticks: then its rate is zero, in the middle of the step like a rigid
row, and at its end too, because the step would turn the last velocity round. It also sticks where the load
would reverse the motion within the step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
)
from heavylift.solver.joints.coordinate import (
    ANGLE,
    DISTANCE,
    coordinate_rate,
    coordinate_row,
    coordinate_value,
)
from heavylift.solver.joints.law_forces import mean_force, pull, spring_force
from heavylift.solver.joints.law_rows import (
    RETURN,
    fit_law,
    law_impulse,
    put_law,
    put_residual,
    put_stick,
    row_rate,
)
from heavylift.solver.joints.row_writing import near_angle
from heavylift.solver.kinds import implement
from heavylift.solver.rows import RowArrays

__all__ = ["FRICTION", "SPRING", "STATE_WIDTH", "STOP", "ScalarLaws"]

LAW, COORDINATE, BLOCK, A, B, C, COLUMN, FIRST, COUNT = range(9)
SPRING, STOP, FRICTION = range(3)
"""Laws. A spring has a rest value and a table, a stop lower and upper ends, friction its largest load."""

REST, DAMPING = 0, 2  # of a spring
LOWER, UPPER, STIFFNESS = 0, 1, 3  # of a stop
LARGEST = 0  # of friction

FRESH, VALUE, LOSS, RATE, DRIFT, BRANCH, LAST_RATE, LAST_FORCE, ROUNDS, STATE_WIDTH = range(10)

PLAIN_ROUNDS = 5
"""Rounds of the iteration after which a table is fitted by chords too: tangents alone can go to and fro."""


class ScalarLaws(Arrays):
    """All tabulated springs, stops and friction of a scene.

    Attributes
    ----------
    table
        Law, coordinate, block, three markers, first record column or -1, first row and rows of the table;
        shape (n, 9).
    values
        Parameters of the law, shape (n, 4): rest, 0, damping, 0; lower, upper, damping, stiffness; largest load.
    curves
        Rows (elongation, force) of all tables, shape (m, 2).
    state
        1 until the first step; carried value, energy lost [J], rate of the last step, distance of the carried value
        from the geometry, -1, 0 or 1 as friction slides or sticks, and scratch of the iteration; shape (n, 9).
    """

    table: Ints2
    values: Floats2
    curves: Floats2
    state: Floats2


@kernel(internal=True)
def _carry(kind: ScalarLaws, i: int, q: float) -> float:
    """Compare the carried value with the geometry; before the first step it is the geometry."""
    state = kind.state[i]
    if kind.table[i, COORDINATE] == ANGLE:
        q = near_angle(q, state[VALUE])
    if state[FRESH] > 0.0:
        state[VALUE] = q
    state[DRIFT] = q - state[VALUE]
    return q


@kernel(internal=True)
def _law(kind: ScalarLaws, i: int, u: float, h: float) -> tuple[float, float, float]:
    """Conservative force, force, and its derivative by the rate u, mean over a step; positive ones hold q back."""
    values = kind.values[i]
    q = kind.state[i, VALUE]
    c = values[DAMPING]
    if kind.table[i, LAW] == SPRING:
        first, count, rest = kind.table[i, FIRST], kind.table[i, COUNT], values[REST]
        elastic, slope = mean_force(kind.curves, first, count, 0.0, q - rest, q - rest + h * u)
        return elastic, elastic + c * u, h * slope + c
    k = values[STIFFNESS]
    high, above, slope = pull(q - values[UPPER], q - values[UPPER] + h * u, k, c, h)
    low, below, other = pull(values[LOWER] - q, values[LOWER] - q - h * u, k, c, h)
    return high - low, above - below, h * (slope + other)


@implement(fill_rows, ScalarLaws)
@kernel(internal=True)
def fill_scalar_rows(kind: ScalarLaws, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """Rows; drift of the carried values."""
    for i in range(kind.table.shape[0]):
        _, coordinate, block, a, b, c, _, _, _ = kind.table[i]
        q = coordinate_row(system, block, work, coordinate, a, b, c)
        if with_residual:
            put_residual(system, block, _carry(kind, i, q))


@kernel(inline=True, internal=True)
def _rate(kind: ScalarLaws, i: int, work: Workspace, system: RowArrays) -> float:
    """Rate of a row at the velocity of the stage."""
    first = 2 * kind.table[i, BLOCK]
    return row_rate(system, first, first + 2, work.velocity)


@kernel(internal=True)
def _put_friction(kind: ScalarLaws, i: int, h: float, system: RowArrays) -> None:
    """Row of the present branch."""
    block, branch = kind.table[i, BLOCK], kind.state[i, BRANCH]
    if branch == 0.0:
        put_stick(system, block)
    else:
        put_law(system, block, h, 0.0, branch * kind.values[i, LARGEST], 0.0)


@implement(set_targets, ScalarLaws)
@kernel(internal=True)
def set_scalar_targets(
    kind: ScalarLaws, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: rate and branch of the last step. At its end friction sticks as in the middle."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i, BLOCK], kind.state[i]
        if kind.table[i, LAW] != FRICTION:
            if at_midpoint:
                _, force, slope = _law(kind, i, state[RATE], step)
                put_law(system, block, step, state[RATE], force, slope)
                state[LAST_RATE], state[LAST_FORCE], state[ROUNDS] = state[RATE], force, 0.0
        elif at_midpoint:
            state[ROUNDS] = 0.0
            _put_friction(kind, i, step, system)
        elif state[FRESH] == 0.0 and state[BRANCH] * _rate(kind, i, work, system) <= 0.0:
            state[BRANCH] = 0.0
            put_stick(system, block)


@implement(relinearise, ScalarLaws)
@kernel(internal=True)
def relinearise_scalar_laws(
    kind: ScalarLaws, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Fit the laws to the rates found."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i, BLOCK], kind.state[i]
        u = _rate(kind, i, work, system)
        if kind.table[i, LAW] == FRICTION:
            P, limit = law_impulse(system, block), 0.5 * step * kind.values[i, LARGEST]
            branch = state[BRANCH]
            state[ROUNDS] += 1.0
            if state[ROUNDS] > PLAIN_ROUNDS and work.control.changed > 0:
                continue  # rows that change together can go in circles; the first of them alone cannot
            if branch == 0.0 and abs(P) > limit * (1.0 + 1e-10):
                state[BRANCH] = -1.0 if P > 0.0 else 1.0
            elif branch * u < 0.0:
                state[BRANCH] = 0.0
            if state[BRANCH] != branch:
                _put_friction(kind, i, step, system)
                work.control.changed += 1
                work.status.block = block
            continue
        _, force, slope = _law(kind, i, u, step)
        state[ROUNDS] += 1.0
        if state[ROUNDS] > PLAIN_ROUNDS and u != state[LAST_RATE]:
            slope = max(slope, (force - state[LAST_FORCE]) / (u - state[LAST_RATE]))
        state[LAST_RATE], state[LAST_FORCE] = u, force
        fit_law(system, block, step, u, force, slope, work)


@implement(update_rows, ScalarLaws)
@kernel(internal=True)
def update_scalar_laws(
    kind: ScalarLaws, time: float, step: float, work: Workspace, system: RowArrays
) -> None:
    """Carry the values over the step; energy lost."""
    for i in range(kind.table.shape[0]):
        block, state = kind.table[i, BLOCK], kind.state[i]
        u = _rate(kind, i, work, system)
        if kind.table[i, LAW] == FRICTION:
            state[LOSS] -= 2.0 * law_impulse(system, block) * u
        else:
            elastic, force, _ = _law(kind, i, u, step)
            state[LOSS] += step * (force - elastic) * u
        state[VALUE] += step * u
        if kind.table[i, LAW] != FRICTION and _law(kind, i, 0.0, step)[0] * state[DRIFT] <= 0.0:
            state[VALUE] += RETURN * state[DRIFT]
        state[RATE] = u
        state[FRESH] = 0.0


@implement(record_joints, ScalarLaws)
@kernel(internal=True)
def record_scalar_laws(
    kind: ScalarLaws, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Force of a tabulated spring, length of one between points; energies of all laws."""
    for i in range(kind.table.shape[0]):
        law, coordinate, _, a, b, c, column, first, count = kind.table[i]
        values, state = kind.values[i], kind.state[i]
        geometric = _carry(kind, i, coordinate_value(work, coordinate, a, b, c))
        q = state[VALUE]
        work.sums.dissipated += state[LOSS]
        if law == SPRING:
            e = q - values[REST]
            row[column] = spring_force(kind.curves, first, count, 0.0, e)
            if values[DAMPING] > 0.0:
                row[column] += values[DAMPING] * coordinate_rate(work, coordinate, a, b, c)
            if coordinate == DISTANCE:
                row[column + 1] = geometric
            work.sums.elastic += e * mean_force(kind.curves, first, count, 0.0, 0.0, e)[0]
        elif law == STOP:
            beyond = max(0.0, q - values[UPPER], values[LOWER] - q)
            work.sums.elastic += 0.5 * values[STIFFNESS] * beyond * beyond
