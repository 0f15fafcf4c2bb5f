"""Wire ropes through any number of bodies, and spring ropes: one row each, tension never below zero.

"Integrated simulation ... (2018)", eqs. 181-185 and 219 for the path, 230 for the spring rope. A rope has one
tension T along its path of length s. With its unstretched length l(t), which a winch changes, it stores
``U = EA/(2 l) max(0, s - l)^2``. In a step, with ``s1 = s0 + h G v`` and the stiffness k from the mean of 1/l,
T is the discrete gradient of U (see `law_forces`), so that the energy is exact through slack and taut, and the
winch does the work ``-T dl + EA/2 mean(max(0, e)^2) d(1/l)``.

The stretch is carried with the row, ``s += h G v``, not taken from the geometry again, which would feed
vibrations the step does not resolve; it is the geometry as long as the rope is slack, and goes back to a
shorter one slowly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays, Floats1, Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.solver.interface import (
    Workspace,
    fill_rows,
    record_joints,
    relinearise,
    set_targets,
    update_rows,
)
from heavylift.solver.joints.law_forces import pull
from heavylift.solver.joints.law_rows import RETURN, fit_law, put_law, put_residual, row_rate
from heavylift.solver.joints.rope_path import path_length
from heavylift.solver.joints.row_writing import add_direction_row
from heavylift.solver.kinds import implement
from heavylift.solver.rows import RowArrays

__all__ = ["Ropes"]

BLOCK, ATTACHMENTS, FIRST, PLACES, WINCH, WINCH_ROWS, COLUMN = range(7)
MARKER, AXIS_MARKER, ATTACHMENT = range(3)
EA, STIFFNESS, DAMPING, START_LENGTH = range(4)
TIME, SPEED, HAULED = range(3)
FRESH, STRETCHED, REST, RATE, DRIFT, WINCH_WORK, LOSS, STATE_WIDTH = range(8)


class Ropes(Arrays):
    """All ropes of a scene.

    Attributes
    ----------
    table
        First block, attachments, first place, number of places, first row and rows of the winch, first record
        column; shape (n, 7).
    places
        Marker, marker of the axis or -1, attachment or -1 on the ground, of each place; shape (m, 3).
    values
        EA [N], stiffness [N/m] of a spring rope or 0, damping [N s/m], length at the start [m]; shape (n, 4).
    winches
        Time [s], speed [m/s] and length hauled in since t = 0 [m], rows of all winches; shape (w, 3).
    path
        Places as `path_length` takes them, shape (m, 7).
    gradient
        Derivatives of the length, shape (m, 6).
    state
        Of each rope: 1 until the first step, path length as carried [m], unstretched length [m], rate of the
        path in the last step [m/s], geometry less carried length [m], work of the winch and loss [J]; then the
        wraps of all places [rad]; flat.
    """

    table: Ints2
    places: Ints2
    values: Floats2
    winches: Floats2
    path: Floats2
    gradient: Floats2
    state: Floats1


@kernel(internal=True)
def winch_state(kind: Ropes, i: int, time: float) -> tuple[float, float]:
    """Length hauled in since t = 0 [m] and speed [m/s]; exact for speeds that are linear in between."""
    first, count = kind.table[i, WINCH], kind.table[i, WINCH_ROWS]
    if count == 0:
        return 0.0, 0.0
    low, high = first - 1, first + count
    while high - low > 1:
        middle = (low + high) // 2
        if kind.winches[middle, TIME] <= time:
            low = middle
        else:
            high = middle
    if low < first or high == first + count:  # held at its ends
        end = kind.winches[max(low, first)]
        return end[HAULED] + end[SPEED] * (time - end[TIME]), end[SPEED]
    a, b = kind.winches[low], kind.winches[high]
    t = time - a[TIME]
    slope = (b[SPEED] - a[SPEED]) / (b[TIME] - a[TIME])
    return a[HAULED] + t * (a[SPEED] + 0.5 * slope * t), a[SPEED] + slope * t


@kernel(internal=True)
def rest_length(kind: Ropes, i: int, time: float) -> float:
    """Unstretched length in play [m]; not a number once all of it is hauled in."""
    length = kind.values[i, START_LENGTH] - winch_state(kind, i, time)[0]
    return length if length > 0.0 or kind.values[i, STIFFNESS] > 0.0 else math.nan


@kernel(inline=True, internal=True)
def _stiffness(kind: Ropes, i: int, inverse_length: float) -> float:
    k = kind.values[i, STIFFNESS]
    return k if k > 0.0 else kind.values[i, EA] * inverse_length


@kernel(internal=True)
def _find_path(kind: Ropes, i: int, work: Workspace) -> float:
    """Length of the path from the markers [m]; its derivatives and wraps are kept."""
    first = kind.table[i, FIRST]
    last = first + kind.table[i, PLACES]
    for p in range(first, last):
        marker, axis = kind.places[p, MARKER], kind.places[p, AXIS_MARKER]
        for k in range(3):
            kind.path[p, k] = work.markers[marker].point[k]
            if axis >= 0:
                kind.path[p, 3 + k] = work.markers[axis].point[k]
    wraps = kind.table.shape[0] * STATE_WIDTH
    return path_length(
        kind.path[first:last], kind.gradient[first:last], kind.state[wraps + first : wraps + last]
    )


@kernel(internal=True)
def _compare(kind: Ropes, i: int, length: float) -> None:
    """Take the geometry while the rope is slack and before the first step; measure the drift."""
    at = i * STATE_WIDTH
    state = kind.state
    if state[at + FRESH] > 0.0:
        state[at + STRETCHED] = length
    elif state[at + STRETCHED] <= state[at + REST]:
        state[at + STRETCHED] = min(length, state[at + REST])  # a drift must not make tension
    state[at + DRIFT] = length - state[at + STRETCHED]


@implement(fill_rows, Ropes)
@kernel(internal=True)
def fill_rope_rows(kind: Ropes, with_residual: bool, work: Workspace, system: RowArrays) -> None:
    """``dl/dc . J + dl/dn . J_n`` of every place on the side of its body."""
    lanes = system.lanes
    for i in range(kind.table.shape[0]):
        length = _find_path(kind, i, work)
        block, count, first = kind.table[i, BLOCK], kind.table[i, ATTACHMENTS], kind.table[i, FIRST]
        for side in range(2 * block, 2 * block + count):
            panel = system.attachments[side].panel
            for k in range(system.attachments[side].width):
                system.panels[panel + k * lanes] = 0.0
        for p in range(first, first + kind.table[i, PLACES]):
            marker, axis, side = kind.places[p]
            if side < 0:
                continue
            g = kind.gradient[p]
            add_direction_row(system, side, 0, work, marker, (g[0], g[1], g[2]))
            if axis >= 0:
                add_direction_row(system, side, 0, work, axis, (g[3], g[4], g[5]))
        if with_residual:
            _compare(kind, i, length)
            put_residual(system, block, length - kind.state[i * STATE_WIDTH + REST])


@kernel(internal=True)
def _tension(
    kind: Ropes, i: int, u: float, time: float, h: float
) -> tuple[float, float, float, float, float, float]:
    """Elastic tension, tension, its derivative by the rate u; elongations before and after, length after."""
    at = i * STATE_WIDTH
    l0 = kind.state[at + REST]
    l1 = rest_length(kind, i, time + h)
    k = _stiffness(kind, i, 0.5 / l0 + 0.5 / l1)
    e0 = kind.state[at + STRETCHED] - l0
    e1 = e0 - (l1 - l0) + h * u  # in this order: the last term alone changes in the iteration
    elastic, tension, slope = pull(e0, e1, k, kind.values[i, DAMPING], h)
    return elastic, tension, h * slope, e0, e1, l1


@implement(set_targets, Ropes)
@kernel(internal=True)
def set_rope_targets(
    kind: Ropes, time: float, step: float, at_midpoint: bool, work: Workspace, system: RowArrays
) -> None:
    """First guess: the rate of the last step."""
    if not at_midpoint:
        return
    for i in range(kind.table.shape[0]):
        u = kind.state[i * STATE_WIDTH + RATE]
        _, tension, slope, _, _, _ = _tension(kind, i, u, time, step)
        put_law(system, kind.table[i, BLOCK], step, u, tension, slope)


@kernel(inline=True, internal=True)
def _rate(kind: Ropes, i: int, work: Workspace, system: RowArrays) -> float:
    """Rate of the path in the middle of the step [m/s]."""
    first = 2 * kind.table[i, BLOCK]
    return row_rate(system, first, first + kind.table[i, ATTACHMENTS], work.velocity)


@implement(relinearise, Ropes)
@kernel(internal=True)
def relinearise_ropes(kind: Ropes, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Fit the tensions to the rates found."""
    for i in range(kind.table.shape[0]):
        u = _rate(kind, i, work, system)
        _, tension, slope, _, _, _ = _tension(kind, i, u, time, step)
        fit_law(system, kind.table[i, BLOCK], step, u, tension, slope, work)


@implement(update_rows, Ropes)
@kernel(internal=True)
def update_ropes(kind: Ropes, time: float, step: float, work: Workspace, system: RowArrays) -> None:
    """Carry the stretch over the step; works of winch and damper."""
    for i in range(kind.table.shape[0]):
        at = i * STATE_WIDTH
        state = kind.state
        u = _rate(kind, i, work, system)
        elastic, tension, _, e0, e1, l1 = _tension(kind, i, u, time, step)
        l0 = state[at + REST]
        if l1 != l0:
            squares = max(0.0, e0) ** 2 + max(0.0, e1) ** 2
            state[at + WINCH_WORK] -= tension * (l1 - l0)
            if kind.values[i, STIFFNESS] == 0.0:
                state[at + WINCH_WORK] += 0.25 * kind.values[i, EA] * squares * (1.0 / l1 - 1.0 / l0)
        state[at + LOSS] += (tension - elastic) * (e1 - e0)
        state[at + STRETCHED] += step * u + RETURN * min(0.0, state[at + DRIFT])
        state[at + REST] = l1
        state[at + RATE] = u
        state[at + FRESH] = 0.0


@kernel(internal=True)
def _path_rate(kind: Ropes, i: int, work: Workspace) -> float:
    """Rate of the path from the rates of the markers [m/s]."""
    rate = 0.0
    first = kind.table[i, FIRST]
    for p in range(first, first + kind.table[i, PLACES]):
        marker, axis, _ = kind.places[p]
        for k in range(3):
            rate += kind.gradient[p, k] * work.markers[marker].velocity[k]
            if axis >= 0:
                rate += kind.gradient[p, 3 + k] * work.markers[axis].velocity[k]
    return rate


@implement(record_joints, Ropes)
@kernel(internal=True)
def record_ropes(
    kind: Ropes, time: float, work: Workspace, system: RowArrays, row: NDArray[np.float64]
) -> None:
    """Tension, length of the path, unstretched length, drift, tension of each straight part."""
    for i in range(kind.table.shape[0]):
        at, column = i * STATE_WIDTH, kind.table[i, COLUMN]
        state = kind.state
        length = _find_path(kind, i, work)
        _compare(kind, i, length)
        e = state[at + STRETCHED] - state[at + REST]
        k = _stiffness(kind, i, 1.0 / state[at + REST])
        tension = 0.0
        if e > 0.0:
            tension = k * e
            work.sums.elastic += 0.5 * k * e * e
            if kind.values[i, DAMPING] > 0.0:
                stretching = _path_rate(kind, i, work) + winch_state(kind, i, time)[1]
                tension = max(0.0, tension + kind.values[i, DAMPING] * stretching)
        row[column] = tension
        row[column + 1] = length
        row[column + 2] = state[at + REST]
        row[column + 3] = state[at + DRIFT]
        for part in range(kind.table[i, PLACES] - 1):
            row[column + 4 + part] = tension
        work.sums.drive_work += state[at + WINCH_WORK]
        work.sums.dissipated += state[at + LOSS]
