"""The elastic catenary: force on the end of a line with seabed contact, friction, sections and clumps, from its place.

A line hangs in the vertical plane of its ends. `line_response` gives the span and height under a force ``(H, V)`` on
the upper end; both are derivatives of the complementary energy, which is convex without friction. `solve_line` turns
this round by Newton's method with the analytic Jacobian. It begins where the stiffness of the last solution leads,
and does not step past the minimum along its direction, so it converges from afar as well.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats2, Ints2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.solver.marine.catenary_walk import (
    ANCHOR_HORIZONTAL,
    ANCHOR_VERTICAL,
    CLUMP,
    LENGTH,
    LYING,
    WEIGHT,
    line_energy,
    line_response,
    vertical_hang,
)

__all__ = [
    "BRANCH",
    "FAILED",
    "FRICTION",
    "HORIZONTAL",
    "RESTING",
    "RISE",
    "SLACK",
    "SPAN",
    "STATE_WIDTH",
    "STIFFNESS",
    "STRETCH",
    "SUSPENDED",
    "TOTAL_LENGTH",
    "TOTAL_WEIGHT",
    "UNKNOWN",
    "VERTICAL",
    "read_ends",
    "solve_line",
    "solve_lines",
]

TOTAL_LENGTH, TOTAL_WEIGHT, STRETCH, FRICTION = range(4)
"""Numbers of a line: length [m], weight with clumps [N], ``sum(c L)`` [m/N], friction coefficient of the seabed."""

HORIZONTAL, VERTICAL, SPAN, RISE, STIFFNESS, BRANCH, STATE_WIDTH = 0, 1, 2, 3, 4, 8, 9
"""Places of the state: H, V [N], x, z [m], d(H, V)/d(x, z) row by row (4 numbers) [N/m], branch."""

UNKNOWN, SUSPENDED, RESTING, SLACK, FAILED = 0.0, 1.0, 2.0, 3.0, 4.0
"""Branches: not solved yet, hanging free, partly on the seabed, vertical with H = 0, no solution found."""

MOST_STEPS = 60
SMALLEST_SPAN = 1e-7
"""Of the length: ends nearer than that hang as from that span."""
SMALLEST_RISE = 1e-6
"""Of the length, above the seabed: at height 0 the vertical stiffness has no limit."""
CONVERGED_STEP = 1e-7
"""Relative; the error after such a step of Newton's method is its square."""
CONVERGED_RESIDUAL = 4e-16
"""Of the length: rounding."""


@kernel(internal=True)
def _guess(line: NDArray[np.float64], row: int, x: float, z: float) -> tuple[float, float]:
    """First guess of ``(H, V)``: the parabola of a uniform line, or the straight rubber of a taut one.

    Notes
    -----
    ``lambda = sqrt(3 ((L^2 - z^2)/x^2 - 1))``, ``H = w x / (2 lambda)``, ``V = (w/2)(z / tanh(lambda) + L)``
    (Jonkman, NREL/TP-500-41958, eq. 2-40), with lambda 0.2 of a line that is shorter than its span.
    """
    length, weight, stretch = line[row, TOTAL_LENGTH], line[row, TOTAL_WEIGHT], line[row, STRETCH]
    chord = math.sqrt(x * x + z * z)
    excess = 3.0 * ((length * length - z * z) / (x * x) - 1.0)
    sag = math.sqrt(excess) if excess > 0.04 else 0.2
    w = max(abs(weight) / length, 1e-12)
    H = 0.5 * w * x / sag
    V = 0.5 * (w * z / math.tanh(sag) + weight)
    if chord > length and stretch > 0.0:
        pull = (chord - length) / stretch
        if pull * x > H * chord:
            H = pull * x / chord
            V = pull * z / chord + 0.5 * weight
    return H, V


@kernel(internal=True)
def solve_line(
    sections: NDArray[np.float64],
    table: NDArray[np.int64],
    line: NDArray[np.float64],
    row: int,
    x: float,
    z: float,
    state: NDArray[np.float64],
) -> None:
    """End force and tangent stiffness of a line from the place of its upper end.

    Parameters
    ----------
    sections
        Of all lines, from the upper end down, shape (n, 4).
    table
        First section, their count, first that may lie on the seabed or the count; shape (lines, 3).
    line
        Numbers of each line, shape (lines, 4).
    row
        The line.
    x, z
        Horizontal distance of the ends, and height of the upper one over the lower one [m]. Over a seabed the
        lower end lies on it.
    state
        Solution of each line, shape (lines, 9); the last one is where Newton's method begins.
    """
    first, count, tail = table[row, 0], table[row, 1], table[row, 2]
    length, friction = line[row, TOTAL_LENGTH], line[row, FRICTION]
    if not (math.isfinite(x) and math.isfinite(z)):
        state[row, BRANCH] = FAILED
        return
    on_seabed = tail < count
    lifts = tail == 0  # V is positive all along
    if on_seabed:
        z = max(z, SMALLEST_RISE * length)
        reach = 0.0
        for i in range(first, first + count):  # no weight below any point is larger than this
            reach += abs(sections[i, WEIGHT]) * sections[i, LENGTH] + abs(sections[i, CLUMP])
        if x + z < length + reach * line[row, STRETCH]:
            V, lying, z_v = vertical_hang(sections, first, count, tail, z, 0.0 if lifts else -reach, reach)
            if x <= lying:
                state[row, HORIZONTAL], state[row, VERTICAL], state[row, SPAN], state[row, RISE] = (
                    0.0,
                    V,
                    x,
                    z,
                )
                for k in range(3):
                    state[row, STIFFNESS + k] = 0.0
                state[row, STIFFNESS + 3] = 1.0 / z_v
                state[row, BRANCH] = SLACK
                return
    x = max(x, SMALLEST_SPAN * length)
    H = V = 0.0
    warm = state[row, BRANCH] == SUSPENDED or state[row, BRANCH] == RESTING
    if warm and x == state[row, SPAN] and z == state[row, RISE]:
        return  # so that looking twice changes nothing
    if warm:
        dx, dz = x - state[row, SPAN], z - state[row, RISE]
        last = state[row, HORIZONTAL]
        H = last + state[row, STIFFNESS] * dx + state[row, STIFFNESS + 1] * dz
        V = state[row, VERTICAL] + state[row, STIFFNESS + 2] * dx + state[row, STIFFNESS + 3] * dz
        warm = 0.2 * last < H < 5.0 * last and (V > 0.0 or not lifts)
    if not warm:
        H, V = _guess(line, row, x, z)
    limit = CONVERGED_RESIDUAL * (length + x + abs(z))
    found = line_response(sections, first, count, tail, friction, H, V)
    for _ in range(MOST_STEPS):
        rx, rz = found[0] - x, found[1] - z
        a, b, c, d = found[2], found[3], found[4], found[5]
        determinant = a * d - b * c
        step_h, step_v = (b * rz - d * rx) / determinant, (c * rx - a * rz) / determinant
        small = abs(step_h) <= CONVERGED_STEP * H and abs(step_v) <= CONVERGED_STEP * (H + abs(V))
        if small or abs(rx) + abs(rz) <= limit:
            if not determinant > 0.0:
                break
            state[row, HORIZONTAL], state[row, VERTICAL], state[row, SPAN], state[row, RISE] = (
                H + step_h,
                V + step_v,
                x,
                z,
            )
            state[row, STIFFNESS], state[row, STIFFNESS + 1] = d / determinant, -b / determinant
            state[row, STIFFNESS + 2], state[row, STIFFNESS + 3] = -c / determinant, a / determinant
            state[row, BRANCH] = RESTING if found[LYING] > 0.0 else SUSPENDED
            return
        slope = rx * step_h + rz * step_v
        part = 1.0
        if H + step_h < 0.1 * H:
            part = -0.9 * H / step_h
        if lifts and V + part * step_v < 0.1 * V:
            part = -0.9 * V / step_v
        if not (slope < 0.0 and part > 0.0):
            break
        for _ in range(40):
            found = line_response(
                sections, first, count, tail, friction, H + part * step_h, V + part * step_v
            )
            if (found[0] - x) * step_h + (found[1] - z) * step_v <= -0.9 * slope:
                break
            part *= 0.5
        H, V = H + part * step_h, V + part * step_v
    _solve_by_bisection(sections, table, line, row, x, z, state)


@kernel(internal=True)
def _solve_by_bisection(
    sections: NDArray[np.float64],
    table: NDArray[np.int64],
    line: NDArray[np.float64],
    row: int,
    x: float,
    z: float,
    state: NDArray[np.float64],
) -> None:
    """The last resort of `solve_line`: the height grows with V, and at a fixed height the span with H."""
    first, count, tail, friction = table[row, 0], table[row, 1], table[row, 2], line[row, FRICTION]
    length = line[row, TOTAL_LENGTH]
    scale = 1.0
    for i in range(first, first + count):
        scale += abs(sections[i, WEIGHT]) * sections[i, LENGTH] + abs(sections[i, CLUMP])
    if line[row, STRETCH] > 0.0:
        scale += math.sqrt(x * x + z * z) / line[row, STRETCH]
    low_h, high_h, V = 1e-16 * scale, 1e6 * scale, 0.0
    H = 1e-5 * scale
    found = line_response(sections, first, count, tail, friction, H, V)
    for _ in range(120):
        H = math.sqrt(low_h * high_h)
        low_v, high_v = (0.0 if tail == 0 else -1e6 * scale), 1e6 * scale
        for _ in range(120):
            V = 0.5 * (low_v + high_v)
            found = line_response(sections, first, count, tail, friction, H, V)
            if found[1] < z:
                low_v = V
            else:
                high_v = V
        if found[0] < x:
            low_h = H
        else:
            high_h = H
    good = abs(found[0] - x) + abs(found[1] - z) <= 1e-9 * length
    determinant = found[2] * found[5] - found[3] * found[4]
    state[row, HORIZONTAL], state[row, VERTICAL], state[row, SPAN], state[row, RISE] = H, V, x, z
    state[row, STIFFNESS], state[row, STIFFNESS + 1] = found[5] / determinant, -found[3] / determinant
    state[row, STIFFNESS + 2], state[row, STIFFNESS + 3] = -found[4] / determinant, found[2] / determinant
    state[row, BRANCH] = FAILED
    if good and determinant > 0.0:
        state[row, BRANCH] = RESTING if found[LYING] > 0.0 else SUSPENDED


@entry
def solve_lines(
    sections: Floats2,
    table: Ints2,
    line: Floats2,
    places: Floats2,
    state: Floats2,
    ends: Floats2,
) -> None:
    """Solve lines for the places of their upper ends.

    Parameters
    ----------
    sections, table, line, state
        As in `solve_line`.
    places
        Horizontal distance and height of the upper end of each line [m], shape (lines, 2).
    ends
        Horizontal and vertical force at the lower end [N], length on the seabed [m], energy [J]; shape (lines, 4).
    """
    for row in range(table.shape[0]):
        solve_line(sections, table, line, row, places[row, 0], places[row, 1], state)
        read_ends(sections, table, line, row, state, ends)


@kernel(internal=True)
def read_ends(
    sections: NDArray[np.float64],
    table: NDArray[np.int64],
    line: NDArray[np.float64],
    row: int,
    state: NDArray[np.float64],
    ends: NDArray[np.float64],
) -> None:
    """Lower end, length on the seabed and energy of a solved line into its row of `ends`, shape (lines, 4)."""
    first, count, tail, friction = table[row, 0], table[row, 1], table[row, 2], line[row, FRICTION]
    H, V, z = state[row, HORIZONTAL], state[row, VERTICAL], state[row, RISE]
    if state[row, BRANCH] == FAILED:
        for k in range(4):
            ends[row, k] = math.nan
        return
    if state[row, BRANCH] == SLACK:
        _, lying, _ = vertical_hang(sections, first, count, tail, z, V, V)
        ends[row, 0], ends[row, 1], ends[row, 2] = 0.0, 0.0, lying
    else:
        found = line_response(sections, first, count, tail, friction, H, V)
        ends[row, 0], ends[row, 1], ends[row, 2] = (
            found[ANCHOR_HORIZONTAL],
            found[ANCHOR_VERTICAL],
            found[LYING],
        )
    ends[row, 3] = line_energy(sections, first, count, tail, friction, H, V, z)
