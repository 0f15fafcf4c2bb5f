"""The elastic catenary: force on the end of a line with seabed contact, friction, sections and clumps, from its place.

A line hangs in the vertical plane of its ends. `line_response` gives the span and height under a force ``(H, V)`` on
the upper end; both are derivatives of the complementary energy, which is convex without friction. `solve_line` turns
this round by Newton's method with the analytic Jacobian. It begins where the stiffness of the last solution leads,
and does not step past the minimum along its direction, so it converges from afar as well.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records
from heavylift.solver.water.lines.catenary_walk import SectionData, line_energy, line_response, vertical_hang

__all__ = [
    "FAILED",
    "RESTING",
    "SLACK",
    "SUSPENDED",
    "UNKNOWN",
    "LineData",
    "LineEnds",
    "LineState",
    "read_ends",
    "solve_line",
    "solve_lines",
]

Matrix2 = Annotated[NDArray[np.float64], (2, 2)]

UNKNOWN, SUSPENDED, RESTING, SLACK, FAILED = range(5)
"""Branches: not solved yet, hanging free, partly on the seabed, vertical with H = 0, no solution found."""


class LineData(Record):
    """A line.

    Attributes
    ----------
    first, count
        First of its sections, from the upper end down, and how many.
    tail
        First of them that may lie on the seabed, or the count.
    length
        Unstretched [m].
    weight
        With clumps [N].
    stretch
        ``sum(c L)`` [m/N].
    friction
        Coefficient of the seabed.
    """

    first: int
    count: int
    tail: int
    length: float
    weight: float
    stretch: float
    friction: float


class LineState(Record):
    """Solution of a line.

    Attributes
    ----------
    horizontal, vertical
        Force on its upper end: H, V [N].
    span, rise
        Place of that over the lower end: x, z [m].
    stiffness
        d(H, V)/d(x, z) [N/m].
    branch
        How it hangs.
    """

    horizontal: float
    vertical: float
    span: float
    rise: float
    stiffness: Matrix2
    branch: int


class LineEnds(Record):
    """Force at the lower end [N], length on the seabed [m], energy [J]."""

    anchor_horizontal: float
    anchor_vertical: float
    lying: float
    energy: float


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
def _guess(line: LineData, x: float, z: float) -> tuple[float, float]:
    """First guess of ``(H, V)``: the parabola of a uniform line, or the straight rubber of a taut one.

    Notes
    -----
    ``lambda = sqrt(3 ((L^2 - z^2)/x^2 - 1))``, ``H = w x / (2 lambda)``, ``V = (w/2)(z / tanh(lambda) + L)``
    (Jonkman, NREL/TP-500-41958, eq. 2-40), with lambda 0.2 of a line that is shorter than its span.
    """
    length, weight, stretch = line.length, line.weight, line.stretch
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
def solve_line(sections: Records[SectionData], line: LineData, x: float, z: float, state: LineState) -> None:
    """End force and tangent stiffness of a line from the place of its upper end.

    Parameters
    ----------
    sections
        Of all lines, from the upper end down.
    line
        The line.
    x, z
        Horizontal distance of the ends, and height of the upper one over the lower one [m]. Over a seabed the
        lower end lies on it.
    state
        Its solution; the last one is where Newton's method begins.
    """
    first, count, tail = line.first, line.count, line.tail
    length, friction = line.length, line.friction
    if not (math.isfinite(x) and math.isfinite(z)):
        state.branch = FAILED
        return
    on_seabed = tail < count
    lifts = tail == 0  # V is positive all along
    if on_seabed:
        z = max(z, SMALLEST_RISE * length)
        reach = 0.0
        for i in range(first, first + count):  # no weight below any point is larger than this
            reach += abs(sections[i].weight) * sections[i].length + abs(sections[i].clump)
        if x + z < length + reach * line.stretch:
            V, lying, z_v = vertical_hang(sections, first, count, tail, z, 0.0 if lifts else -reach, reach)
            if x <= lying:
                state.horizontal, state.vertical, state.span, state.rise = 0.0, V, x, z
                state.stiffness[0, 0] = state.stiffness[0, 1] = state.stiffness[1, 0] = 0.0
                state.stiffness[1, 1] = 1.0 / z_v
                state.branch = SLACK
                return
    x = max(x, SMALLEST_SPAN * length)
    H = V = 0.0
    warm = SUSPENDED <= state.branch <= RESTING
    if warm and x == state.span and z == state.rise:
        return  # so that looking twice changes nothing
    if warm:
        dx, dz = x - state.span, z - state.rise
        last = state.horizontal
        H = last + state.stiffness[0, 0] * dx + state.stiffness[0, 1] * dz
        V = state.vertical + state.stiffness[1, 0] * dx + state.stiffness[1, 1] * dz
        warm = 0.2 * last < H < 5.0 * last and (V > 0.0 or not lifts)
    if not warm:
        H, V = _guess(line, x, z)
    limit = CONVERGED_RESIDUAL * (length + x + abs(z))
    found = line_response(sections, first, count, tail, friction, H, V)
    for _ in range(MOST_STEPS):
        rx, rz = found.x - x, found.z - z
        a, b, c, d = found.x_h, found.x_v, found.z_h, found.z_v
        determinant = a * d - b * c
        step_h, step_v = (b * rz - d * rx) / determinant, (c * rx - a * rz) / determinant
        small = abs(step_h) <= CONVERGED_STEP * H and abs(step_v) <= CONVERGED_STEP * (H + abs(V))
        if small or abs(rx) + abs(rz) <= limit:
            if not determinant > 0.0:
                break
            state.horizontal, state.vertical = H + step_h, V + step_v
            state.span, state.rise = x, z
            state.stiffness[0, 0], state.stiffness[0, 1] = d / determinant, -b / determinant
            state.stiffness[1, 0], state.stiffness[1, 1] = -c / determinant, a / determinant
            state.branch = RESTING if found.lying > 0.0 else SUSPENDED
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
            if (found.x - x) * step_h + (found.z - z) * step_v <= -0.9 * slope:
                break
            part *= 0.5
        H, V = H + part * step_h, V + part * step_v
    _solve_by_bisection(sections, line, x, z, state)


@kernel(internal=True)
def _solve_by_bisection(
    sections: Records[SectionData], line: LineData, x: float, z: float, state: LineState
) -> None:
    """The last resort of `solve_line`: the height grows with V, and at a fixed height the span with H."""
    first, count, tail, friction = line.first, line.count, line.tail, line.friction
    length = line.length
    scale = 1.0
    for i in range(first, first + count):
        scale += abs(sections[i].weight) * sections[i].length + abs(sections[i].clump)
    if line.stretch > 0.0:
        scale += math.sqrt(x * x + z * z) / line.stretch
    low_h, high_h, V = 1e-16 * scale, 1e6 * scale, 0.0
    H = 1e-5 * scale
    found = line_response(sections, first, count, tail, friction, H, V)
    for _ in range(120):
        H = math.sqrt(low_h * high_h)
        low_v, high_v = (0.0 if tail == 0 else -1e6 * scale), 1e6 * scale
        for _ in range(120):
            V = 0.5 * (low_v + high_v)
            found = line_response(sections, first, count, tail, friction, H, V)
            if found.z < z:
                low_v = V
            else:
                high_v = V
        if found.x < x:
            low_h = H
        else:
            high_h = H
    good = abs(found.x - x) + abs(found.z - z) <= 1e-9 * length
    determinant = found.x_h * found.z_v - found.x_v * found.z_h
    state.horizontal, state.vertical, state.span, state.rise = H, V, x, z
    state.stiffness[0, 0], state.stiffness[0, 1] = found.z_v / determinant, -found.x_v / determinant
    state.stiffness[1, 0], state.stiffness[1, 1] = -found.z_h / determinant, found.x_h / determinant
    state.branch = FAILED
    if good and determinant > 0.0:
        state.branch = RESTING if found.lying > 0.0 else SUSPENDED


@entry
def solve_lines(
    sections: Records[SectionData],
    lines: Records[LineData],
    places: Floats2,
    state: Records[LineState],
    ends: Records[LineEnds],
) -> None:
    """Solve lines for the places of their upper ends.

    Parameters
    ----------
    sections, lines, state
        As in `solve_line`, of all.
    places
        Horizontal distance and height of the upper end of each line [m], shape (lines, 2).
    ends
        Written.
    """
    for row in range(lines.shape[0]):
        solve_line(sections, lines[row], places[row, 0], places[row, 1], state[row])
        read_ends(sections, lines[row], state[row], ends[row])


@kernel(internal=True)
def read_ends(sections: Records[SectionData], line: LineData, state: LineState, ends: LineEnds) -> None:
    """Lower end, length on the seabed and energy of a solved line."""
    first, count, tail, friction = line.first, line.count, line.tail, line.friction
    H, V, z = state.horizontal, state.vertical, state.rise
    if state.branch == FAILED:
        ends.anchor_horizontal = ends.anchor_vertical = ends.lying = ends.energy = math.nan
        return
    if state.branch == SLACK:
        _, lying, _ = vertical_hang(sections, first, count, tail, z, V, V)
        ends.anchor_horizontal, ends.anchor_vertical, ends.lying = 0.0, 0.0, lying
    else:
        found = line_response(sections, first, count, tail, friction, H, V)
        ends.anchor_horizontal, ends.anchor_vertical = found.anchor_horizontal, found.anchor_vertical
        ends.lying = found.lying
    ends.energy = line_energy(sections, first, count, tail, friction, H, V, z)
