"""The elastic catenary: force on the end of a line with seabed contact, friction, sections and clumps, from its place.

A line hangs in the vertical plane of its ends. `line_response` gives the span and height under a force ``(H, V)`` on
the upper end, in one walk down the line; both are derivatives of the complementary energy, which is convex without
friction. `solve_line` turns this round by Newton's method with the analytic Jacobian. It begins where the stiffness of
the last solution leads, and does not step past the minimum along its direction, so it converges from afar as well.

Notes
-----
A section of unstretched length ``L``, weight ``w`` a length and flexibility ``c = 1 / EA``, whose ends pull with the
vertical forces ``V`` and ``V' = V - w L`` and the tensions ``T`` and ``T'``, spans

    x = (2 H / w) artanh(w L / (T + T')) + c H L,    z = L (V + V') / (T + T') + c L (V + V') / 2.

These are the textbook formulas (Irvine, *Cable Structures*, 1981, section 1.3) in a form that has no cancellation
when the line is nearly weightless or taut. Where a section would pull upwards on what lies below, it lies on the
seabed from there on, and friction takes up tension along the way (Jonkman, NREL/TP-500-41958, section 2.4).
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records

__all__ = [
    "CONVERGED_RESIDUAL",
    "CONVERGED_STEP",
    "FAILED",
    "MOST_STEPS",
    "RESTING",
    "SLACK",
    "SMALLEST_RISE",
    "SMALLEST_SPAN",
    "SUSPENDED",
    "UNKNOWN",
    "HungPiece",
    "LineData",
    "LineEnds",
    "LineResponse",
    "LineState",
    "SectionData",
    "first_guess",
    "hung_piece",
    "line_energy",
    "line_response",
    "read_ends",
    "solve_line",
    "solve_lines",
    "vertical_hang",
]


# ---- a walk down a line ----


class SectionData(Record):
    """Unstretched length [m], weight [N/m], 1 / EA [1/N], and weight of a clump at its lower end [N]."""

    length: float
    weight: float
    flexibility: float
    clump: float


class LineResponse(NamedTuple):
    """What spans a line under a force on its upper end.

    Attributes
    ----------
    x, z
        Span and height [m].
    x_h, x_v, z_h, z_v
        dx/dH, dx/dV, dz/dH, dz/dV [m/N].
    anchor_horizontal, anchor_vertical
        Force of the lower end on the line above it [N].
    lying
        Length that lies on the seabed [m].
    """

    x: float
    z: float
    x_h: float
    x_v: float
    z_h: float
    z_v: float
    anchor_horizontal: float
    anchor_vertical: float
    lying: float


SERIES_LIMIT = 0.05
"""Of the argument of artanh: five terms are then exact to rounding."""


class HungPiece(NamedTuple):
    """What a piece of a section spans that hangs free: x, z [m], dx/dH, dx/dV = dz/dH, dz/dV [m/N]."""

    x: float
    z: float
    x_h: float
    x_v: float
    z_v: float


@kernel(inline=True, internal=True)
def hung_piece(H: float, v: float, below: float, hung: float, w: float, c: float) -> HungPiece:
    """Span and height of a piece of a section, with derivatives by the force on its upper end.

    Parameters
    ----------
    H
        Horizontal force [N], not zero where the piece has a horizontal tangent.
    v, below
        Vertical force on its upper end, and at its lower one [N].
    hung
        Unstretched length [m], positive.
    w, c
        Weight [N/m], flexibility [1/N].
    """
    t, t_below = math.sqrt(H * H + v * v), math.sqrt(H * H + below * below)
    s, m = t + t_below, v + below
    weight = w * hung
    u = weight / s
    if abs(u) < SERIES_LIMIT:
        u2 = u * u
        ratio = 2.0 * hung / s * (1.0 + u2 * (1 / 3 + u2 * (1 / 5 + u2 * (1 / 7 + u2 / 9))))
    else:  # T - V as H^2 / (T + V): a slack line has both ends steep
        sum_a = t + abs(v)
        sum_b = t_below + abs(below)
        less_a, less_b = H * H / sum_a, H * H / sum_b
        upper = (sum_a if v > 0.0 else less_a) + (less_b if below > 0.0 else sum_b)
        lower = (less_a if v > 0.0 else sum_a) + (sum_b if below > 0.0 else less_b)
        ratio = math.log(upper / lower) / w
    product = t * t_below
    if v * below >= 0.0:
        rise_v = H * H * hung * s / ((H * H + product + v * below) * product)
    else:
        rise_v = (v / t - below / t_below) / w
    stretch = c * hung
    return HungPiece(
        H * (ratio + stretch),
        m * (hung / s + 0.5 * stretch),
        ratio - rise_v + stretch,
        -(H * hung * m / (s * product)),
        rise_v + stretch,
    )


@kernel(internal=True)
def line_response(
    sections: Records[SectionData],
    first: int,
    count: int,
    tail: int,
    friction: float,
    H: float,
    V: float,
) -> LineResponse:
    """Span and height of a line under the force ``(H, V)`` on its upper end, with derivatives.

    Parameters
    ----------
    sections
        Of all lines, from the upper end down.
    first, count
        Sections of this line.
    tail
        First of its sections that may lie on the seabed; `count` if there is none.
    friction
        Coefficient of the seabed along the line.
    H, V
        Force that pulls the upper end outwards and upwards [N]; H > 0.
    """
    x = z = x_h = x_v = z_v = lying = drag_v = 0.0
    along, along_v = H, 0.0  # tension along the seabed, and its derivative by V
    v = V
    for i in range(first, first + count):
        section = sections[i]
        length, w, c, clump = section.length, section.weight, section.flexibility, section.clump
        on_seabed = i - first >= tail
        hung = length
        below = v - w * length
        if on_seabed and below < 0.0:
            hung = max(v, 0.0) / w
            below = 0.0
        if hung > 0.0:
            piece = hung_piece(H, v, below, hung, w, c)
            x += piece.x
            z += piece.z
            x_h += piece.x_h
            x_v += piece.x_v
            z_v += piece.z_v
        if hung < length:
            rest = length - hung
            lying += rest
            x += rest
            drop = friction * w
            if drop * rest <= along:
                x += c * rest * (along - 0.5 * drop * rest)
                x_h += c * rest
                drag_v += c * rest * along_v
                if hung > 0.0:  # lifting more leaves less that rubs
                    drag_v += c * friction * rest
                    along_v = friction
                along -= drop * rest
            else:
                x += 0.5 * c * along * along / drop
                x_h += c * along / drop
                drag_v += c * along / drop * along_v
                if hung > 0.0:
                    drag_v += c * along / w
                along = along_v = 0.0
        v = below
        if clump != 0.0:
            v -= clump
            if on_seabed and v < 0.0:
                drop = -friction * v
                if below > 0.0:
                    along_v = friction
                if drop < along:
                    along -= drop
                else:
                    along = along_v = 0.0
                v = 0.0
    return LineResponse(x, z, x_h, x_v + drag_v, x_v, z_v, along, v, lying)


@kernel(internal=True)
def line_energy(
    sections: Records[SectionData],
    first: int,
    count: int,
    tail: int,
    friction: float,
    H: float,
    V: float,
    rise: float,
) -> float:
    """Energy of position, about its lower end, and of strain in a line [J].

    Parameters
    ----------
    sections, first, count, tail, friction, H, V
        As in `line_response`.
    rise
        Height of the upper end over the lower one [m].

    Notes
    -----
    ``U = H x + V z - W`` with the complementary energy ``W = int(T + T^2 / (2 EA)) ds``; of the part on the seabed
    the energy of strain. It is a potential of the end force if the seabed has no friction.
    """
    energy, along, v = V * rise, H, V
    for i in range(first, first + count):
        section = sections[i]
        length, w, c, clump = section.length, section.weight, section.flexibility, section.clump
        on_seabed = i - first >= tail
        hung = length
        below = v - w * length
        if on_seabed and below < 0.0:
            hung = max(v, 0.0) / w
            below = 0.0
        if hung > 0.0 and (H > 0.0 or v != below or v != 0.0):
            t, t_below = math.sqrt(H * H + v * v), math.sqrt(H * H + below * below)
            s, m = t + t_below, v + below
            # H x - int T ds, with H x - H (H / w) d(asinh) = c H^2 L and half of the latter in int T ds
            ratio = 0.0
            if H > 0.0:
                u = abs(w) * hung / s
                ratio = hung / s if u < 1e-9 else math.atanh(min(u, 1.0 - 1e-16)) / abs(w)
            energy += H * H * ratio - 0.25 * hung * (s + m * m / s)
            energy += c * hung * (H * H - 0.5 * (H * H + (v * v + v * below + below * below) / 3.0))
        if hung < length:
            rest = length - hung
            drop = friction * w
            if drop > 0.0:
                end = max(along - drop * rest, 0.0)
                energy += c * (along**3 - end**3) / (6.0 * drop)
                along = end
            else:
                energy += 0.5 * c * along * along * rest
        v = below
        if clump != 0.0:
            v -= clump
            if on_seabed and v < 0.0:
                along = max(along + friction * v, 0.0)
                v = 0.0
    return energy


@kernel(internal=True)
def vertical_hang(
    sections: Records[SectionData], first: int, count: int, tail: int, z: float, lowest: float, highest: float
) -> tuple[float, float, float]:
    """Force, length on the seabed and height derivative of a line that hangs straight down from a height.

    Parameters
    ----------
    sections, first, count, tail
        As in `line_response`.
    z
        Height of the upper end over the seabed [m].
    lowest, highest
        Bounds of the vertical force [N].

    Returns
    -------
    tuple
        V [N], length on the seabed [m], dz/dV [m/N].
    """
    V = lowest + 0.5 * (highest - lowest)
    lying = z_v = 0.0
    for _ in range(200):
        height, z_v, lying, v = 0.0, 0.0, 0.0, V
        for i in range(first, first + count):
            section = sections[i]
            length, w, c = section.length, section.weight, section.flexibility
            on_seabed = i - first >= tail
            hung = length
            below = v - w * length
            if on_seabed and below < 0.0:
                hung = max(v, 0.0) / w
                below = 0.0
            s = abs(v) + abs(below)
            if hung > 0.0 and s > 0.0:
                height += (v + below) * (hung / s + 0.5 * c * hung)
                z_v += c * hung
                if v * below < 0.0 or (on_seabed and hung < length):
                    z_v += (2.0 if v * below < 0.0 else 1.0) / abs(w)
            lying += length - hung
            v = below - section.clump
            if on_seabed and v < 0.0:
                v = 0.0
        if height > z:
            highest = V
        else:
            lowest = V
        trial = V - (height - z) / z_v if z_v > 0.0 else math.inf
        if abs(trial - V) <= 1e-14 * abs(V) or highest - lowest <= 1e-15 * (abs(highest) + abs(lowest)):
            break
        V = trial if lowest < trial < highest else 0.5 * (lowest + highest)
    return V, lying, z_v


# ---- lines ----


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
def first_guess(line: LineData, x: float, z: float) -> tuple[float, float]:
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
        H, V = first_guess(line, x, z)
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
