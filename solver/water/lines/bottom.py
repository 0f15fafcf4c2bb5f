"""The elastic catenary over an inclined bottom, and between two ends that both hang over one.

The bottom is straight in the vertical plane of the ends. Down from its upper end a line hangs to where its tangent is
that of the bottom, lies from there on, and either reaches its anchor or lifts off again and hangs to a lower end above
the bottom. A level bottom with the anchor on it needs none of this: `heavylift.solver.water.lines.catenary.solve_line`.

Notes
-----
With the angle b of the bottom, which rises towards the upper end, a line touches down where ``V = H tan(b)``, under the
tension ``H / cos(b)``. A lying piece of the weight dW changes the tension t along the bottom by

    dt = -(sin(b) + sign(t) mu cos(b)) dW        downwards along the line,

its weight along the slope and the friction, which opposes a pull at the upper end, as on a level bottom: a lower end
above the bottom has the horizontal tension that is left. Where t comes to zero the line rests if friction holds it,
``mu >= |tan(b)|``. If not, it slides downhill in a loop: t is negative where the line runs back.

Without friction span and height under a force are derivatives of a convex complementary energy here too: the tangent at
both ends of the lying part is that of the bottom, so that nothing changes to first order if they move.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from heavylift.numerics.arrays import Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Records
from heavylift.solver.water.lines.catenary import (
    CONVERGED_RESIDUAL,
    CONVERGED_STEP,
    FAILED,
    MOST_STEPS,
    RESTING,
    SLACK,
    SMALLEST_RISE,
    SMALLEST_SPAN,
    SUSPENDED,
    LineData,
    LineEnds,
    LineState,
    SectionData,
    first_guess,
    hung_piece,
    vertical_hang,
)

__all__ = [
    "BottomState",
    "read_ends_over_bottom",
    "solve_lines_over_bottom",
    "solve_over_bottom",
    "trace_over_bottom",
]

ANCHORED = -1.0
"""Clearance of a lower end that is held on the bottom."""
MOST_GRIP = 0.8
"""Of the friction under which a line whose both ends hang has more than one equilibrium."""
TINY_FORCE = 1e-15
"""Of the weight of a line: horizontal force in place of none."""


class BottomState(LineState):
    """Solution of a line over a bottom.

    Attributes
    ----------
    slope, clearance
        Of the bottom, and height of the lower end over it [m], negative if that is held on it.
    lower_horizontal, lower_vertical
        Force of the lower end on the line above it [N].
    lying
        Length on the bottom [m].
    lifted
        Weight [N] of what hangs from the lower end, negative if nothing of the line touches the bottom.
    """

    slope: float
    clearance: float
    lower_horizontal: float
    lower_vertical: float
    lying: float
    lifted: float


@kernel(internal=True)
def _grip(friction: float, sin: float, cos: float, anchored: bool) -> float:
    """Friction on the bottom, of the weight of what lies there.

    Of a line whose lower end hangs no more than leaves one equilibrium: if the tension fell by more than the weight
    that lies, a longer lower tail could reach less high than a shorter one. Friction may be less than its limit.
    """
    rub = friction * cos
    return rub if anchored else min(rub, MOST_GRIP * (1.0 - abs(sin)))


class _Lying(NamedTuple):
    """Way along the bottom [m], its derivative by the tension at the upper end [m/N], tension and its derivative."""

    way: float
    way_t: float
    tension: float
    tension_t: float


@kernel(internal=True)
def _lie(tension: float, length: float, weight: float, c: float, sin: float, rub: float) -> _Lying:
    """A piece on the bottom, from its upper end down; with a length of 0 a clump, whose weight counts [N]."""
    sign = 1.0 if tension >= 0.0 else -1.0
    t = abs(tension)
    fall = sign * sin + rub  # of t, a weight
    if fall * weight <= t:
        way = sign * length * (1.0 + c * (t - 0.5 * fall * weight))
        return _Lying(way, c * length, sign * (t - fall * weight), 1.0)
    share = t / (fall * weight)  # of the piece, to where the tension vanishes
    first, rest = share * length, (1.0 - share) * length
    way = sign * first * (1.0 + 0.5 * c * t)
    moves = length / (fall * weight)  # of that place [m/N]
    grow = sign * sin - rub
    if grow <= 0.0:
        return _Lying(way + rest, (1.0 + c * t - sign) * moves, 0.0, 0.0)
    far = grow * (1.0 - share) * weight
    way -= sign * rest * (1.0 + 0.5 * c * far)
    return _Lying(way, (2.0 + c * (t + far)) * moves, -sign * far, grow / fall)


class _Tail(NamedTuple):
    """What hangs from the lower end: from there to the bottom [m], with derivatives by the force at its upper end."""

    x: float
    z: float
    x_h: float
    x_v: float
    z_v: float
    length: float


@kernel(internal=True)
def _lower_tail(
    sections: Records[SectionData], first: int, count: int, H: float, low: float, weight: float
) -> _Tail:
    """The lowest part of a line with a given weight, under H and the vertical force at its lower end."""
    x = z = x_h = x_v = z_v = length = 0.0
    v, left = low, weight
    for j in range(count):
        i = first + count - 1 - j
        section = sections[i]
        if section.clump >= left:
            break
        left -= section.clump
        v += section.clump
        w = section.weight
        part = min(section.length, left / w)
        top = v + w * part
        piece = hung_piece(H, top, v, part, w, section.flexibility)
        x += piece.x
        z += piece.z
        x_h += piece.x_h
        x_v += piece.x_v
        z_v += piece.z_v
        length += part
        left -= w * part
        v = top
        if left <= 0.0:
            break
    return _Tail(x, z, x_h, x_v, z_v, length)


class _LiftOff(NamedTuple):
    """Weight [N] of the lower tail, tension along the bottom there with its derivative, and the tail."""

    weight: float
    tension: float
    tension_t: float
    H: float
    rate: float
    tail: _Tail
    height_w: float


@kernel(internal=True)
def _at_lift_off(
    sections: Records[SectionData],
    first: int,
    count: int,
    tension: float,
    whole: float,
    weight: float,
    slope: float,
    rub: float,
    tiny: float,
) -> _LiftOff:
    """The lower tail of a given weight, below a lying part of the rest of the whole weight under the touch-down."""
    cos = 1.0 / math.sqrt(1.0 + slope * slope)
    sin = slope * cos
    lies = _lie(tension, 0.0, whole - weight, 0.0, sin, rub)
    t = lies.tension
    rate = 0.0
    if t != 0.0 or abs(sin) > rub:
        rate = sin + (rub if t >= 0.0 else -rub)
    H = t * cos
    if abs(H) < tiny:
        H = tiny if t >= 0.0 else -tiny
    tail = _lower_tail(sections, first, count, H, t * sin - weight, weight)
    a_h, a_v = tail.x_v - slope * tail.x_h, tail.z_v - slope * tail.x_v
    if lies.tension_t == 0.0 and t == 0.0:
        return _LiftOff(weight, t, 0.0, H, 0.0, tail, a_v)
    return _LiftOff(weight, t, lies.tension_t, H, rate, tail, a_v - (a_h * cos + a_v * sin) * rate)


@kernel(internal=True)
def _lift_off(
    sections: Records[SectionData],
    line: LineData,
    tension: float,
    whole: float,
    slope: float,
    rub: float,
    clearance: float,
    guess: float,
    tiny: float,
) -> _LiftOff:
    """Where a line leaves the bottom, so that its lower end is at its height: Newton's method within bounds."""
    first, count = line.first, line.count
    low, high = 0.0, whole
    weight = guess
    if not low < weight < high:
        rise = line.weight / line.length * clearance
        weight = math.sqrt(rise * (rise + 2.0 * abs(tension)))
        if not low < weight < high:
            weight = 0.5 * whole
    last = False
    found = _at_lift_off(sections, first, count, tension, whole, weight, slope, rub, tiny)
    for _ in range(200):
        excess = slope * found.tail.x - found.tail.z - clearance
        if last or excess == 0.0:
            break
        if excess > 0.0:
            high = weight
        else:
            low = weight
        trial = weight - excess / found.height_w if found.height_w > 0.0 else low
        if low < trial < high:
            last = abs(trial - weight) <= 1e-9 * weight
        else:
            trial = 0.5 * (low + high)
            last = high - low <= 1e-15 * high
        weight = trial
        found = _at_lift_off(sections, first, count, tension, whole, weight, slope, rub, tiny)
    return found


class _Response(NamedTuple):
    """What spans a line under a force on its upper end, as `heavylift.solver.water.lines.catenary.LineResponse`."""

    x: float
    z: float
    x_h: float
    x_v: float
    z_h: float
    z_v: float
    lower_horizontal: float
    lower_vertical: float
    lying: float
    lifted: float


@kernel(internal=True)
def _respond(
    sections: Records[SectionData],
    line: LineData,
    H: float,
    V: float,
    slope: float,
    clearance: float,
    guess: float,
) -> _Response:
    """Span and height of a line under the force ``(H, V)`` on its upper end, with derivatives.

    Parameters
    ----------
    sections, line
        As in `solve_over_bottom`.
    H, V
        Force that pulls the upper end outwards and upwards [N]; H is not 0.
    slope
        Of the bottom.
    clearance
        Height of the lower end over it [m], or `ANCHORED`.
    guess
        Weight that hangs from the lower end [N], or a negative number.
    """
    first, count, tail = line.first, line.count, line.tail
    anchored = clearance < 0.0
    tiny = TINY_FORCE * abs(line.weight)
    cos = 1.0 / math.sqrt(1.0 + slope * slope)
    sin = slope * cos
    rub = _grip(line.friction, sin, cos, anchored)
    edge = slope * H  # the vertical force where the line touches down
    x = z = x_h = x_v = z_v = 0.0
    v = V
    begin, used, load = (
        count,
        0.0,
        0.0,
    )  # first section that lies, what of it hangs, weight that lies above it
    for k in range(count):
        section = sections[first + k]
        length, w, clump = section.length, section.weight, section.clump
        lands = k >= tail and (anchored or edge < V)
        hung, below = length, v - w * length
        if lands and below < edge:
            hung, below = max(v - edge, 0.0) / w, edge
        if hung > 0.0:
            piece = hung_piece(H, v, below, hung, w, section.flexibility)
            x += piece.x
            z += piece.z
            x_h += piece.x_h
            x_v += piece.x_v
            z_v += piece.z_v
        if hung < length:
            begin, used, load = k, hung, max(edge - v, 0.0)
            break
        v = below
        if clump != 0.0:
            if lands and v - clump < edge:
                begin, load = k + 1, clump - (v - edge)
                break
            v -= clump
    if begin == count:
        return _Response(x, z, x_h, x_v, x_v, z_v, H, v, 0.0, -1.0)
    touch = H / cos
    rate = sin + (rub if H > 0.0 else -rub)
    t_h, t_v = 1.0 / cos - rate * slope, rate  # of the tension at a point that lies
    z_h = x_v
    lying, left = 0.0, math.inf
    off = _LiftOff(0.0, 0.0, 0.0, 0.0, 0.0, _Tail(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0)
    if not anchored:
        whole = load - used * sections[first + begin].weight
        for k in range(begin, count):
            whole += sections[first + k].length * sections[first + k].weight + sections[first + k].clump
        free = _lower_tail(sections, first, count, H, edge - whole, whole)
        if slope * free.x - free.z <= clearance:  # hangs clear of the bottom
            return _Response(
                x + free.x,
                z + free.z,
                x_h + free.x_h,
                x_v + free.x_v,
                x_v + free.x_v,
                z_v + free.z_v,
                H,
                edge - whole,
                0.0,
                -1.0,
            )
        off = _lift_off(sections, line, touch, whole, slope, rub, clearance, guess, tiny)
        left = whole - off.weight
    lies = _lie(touch, 0.0, min(load, left), 0.0, sin, rub)
    left -= load
    t, share, way_t = lies.tension, lies.tension_t, 0.0
    for k in range(begin, count):
        if left <= 0.0:
            break
        section = sections[first + k]
        w, c, clump = section.weight, section.flexibility, section.clump
        part = min(section.length - used, left / w)
        used = 0.0
        lies = _lie(t, part, w * part, c, sin, rub)
        x += lies.way * cos
        z += lies.way * sin
        way_t += share * lies.way_t
        t, share = lies.tension, share * lies.tension_t
        lying += part
        left -= w * part
        if clump > 0.0 and left > 0.0:
            lies = _lie(t, 0.0, min(clump, left), 0.0, sin, rub)
            t, share = lies.tension, share * lies.tension_t
            left -= clump
    x_h += cos * way_t * t_h
    x_v += cos * way_t * t_v
    z_h += sin * way_t * t_h
    z_v += sin * way_t * t_v
    if anchored:
        return _Response(x, z, x_h, x_v, z_h, z_v, t * cos, t * sin, lying, 0.0)
    low = off.tail
    if off.tension_t != 0.0:
        # d(force) at the lift-off, a change of the tension there, with its height over the bottom kept
        a_h, a_v = low.x_v - slope * low.x_h, low.z_v - slope * low.x_v
        moves = -(a_h * cos + a_v * sin) / off.height_w
        dt = 1.0 - off.rate * moves
        by_t = off.tension_t * (low.x_h * cos * dt + low.x_v * (sin * dt + moves))
        x_h += by_t * t_h
        x_v += by_t * t_v
        z_h += slope * by_t * t_h
        z_v += slope * by_t * t_v
    return _Response(
        x + low.x,
        z + low.z,
        x_h,
        x_v,
        z_h,
        z_v,
        off.H,
        off.tension * sin - off.weight,
        lying,
        off.weight,
    )


@kernel(internal=True)
def solve_over_bottom(
    sections: Records[SectionData],
    line: LineData,
    x: float,
    z: float,
    slope: float,
    clearance: float,
    anchored: bool,
    state: BottomState,
) -> None:
    """End forces and tangent stiffness of a line over an inclined bottom, from the place of its upper end.

    Parameters
    ----------
    sections
        Of all lines, from the upper end down.
    line
        The line; if its lower end hangs, all of it sinks.
    x, z
        Horizontal distance of the ends, and height of the upper one over the lower one [m].
    slope
        Rise of the bottom a length towards the upper end.
    clearance
        Height of the lower end over the bottom [m]; of no meaning if it is anchored.
    anchored
        Whether the lower end is held on the bottom, which then goes through it.
    state
        Its solution; the last one is where Newton's method begins. An end below the bottom is taken as just above it.
    """
    if not (math.isfinite(x) and math.isfinite(z) and math.isfinite(slope) and math.isfinite(clearance)):
        state.branch = FAILED
        return
    length, weight = line.length, abs(line.weight)
    state.slope = slope
    clearance = ANCHORED if anchored else max(clearance, SMALLEST_RISE * length)
    above = max(clearance, 0.0)
    z = max(z, slope * x - above + SMALLEST_RISE * length)
    if _hang_down(sections, line, x, z, slope, clearance, state):
        return
    x = max(x, SMALLEST_SPAN * length)
    cos = 1.0 / math.sqrt(1.0 + slope * slope)
    slides = _grip(line.friction, slope * cos, cos, anchored) < abs(slope * cos)
    lifts = anchored and line.tail == 0  # V is more than at the touch-down all along
    H = V = 0.0
    guess = -1.0
    warm = SUSPENDED <= state.branch <= RESTING and (state.clearance < 0.0) == anchored
    if warm:
        dx, dz = x - state.span, z - state.rise
        last = state.horizontal
        H = last + state.stiffness[0, 0] * dx + state.stiffness[0, 1] * dz
        V = state.vertical + state.stiffness[1, 0] * dx + state.stiffness[1, 1] * dz
        guess = state.lifted
        warm = 0.2 * abs(last) < math.copysign(H, H * last) < 5.0 * abs(last) and (slope * H < V or not lifts)
    state.clearance = clearance
    if not warm:
        H, V = first_guess(line, x, z)
        if lifts:
            V = max(V, slope * H + 1e-3 * weight)
    limit = CONVERGED_RESIDUAL * (length + x + abs(z))
    found = _respond(sections, line, H, V, slope, clearance, guess)
    for _ in range(MOST_STEPS):
        guess = found.lifted
        rx, rz = found.x - x, found.z - z
        a, b, c, d = found.x_h, found.x_v, found.z_h, found.z_v
        determinant = a * d - b * c
        step_h, step_v = (b * rz - d * rx) / determinant, (c * rx - a * rz) / determinant
        size = abs(H)
        small = abs(step_h) <= CONVERGED_STEP * size and abs(step_v) <= CONVERGED_STEP * (size + abs(V))
        if small or abs(rx) + abs(rz) <= limit:
            if not determinant > 0.0:
                break
            _keep(sections, line, H + step_h, V + step_v, x, z, slope, clearance, guess, state)
            return
        gain = rx * step_h + rz * step_v
        part = 1.0
        if not slides and H + step_h < 0.1 * H:
            part = -0.9 * H / step_h
        over, step_over = V - slope * H, step_v - slope * step_h
        if (lifts or (found.lifted >= 0.0 and over > 0.0)) and over + part * step_over < 0.1 * over:
            part = -0.9 * over / step_over
        if not (gain < 0.0 and part > 0.0):
            break
        for _ in range(40):
            if H + part * step_h != 0.0:
                found = _respond(
                    sections, line, H + part * step_h, V + part * step_v, slope, clearance, guess
                )
                if (found.x - x) * step_h + (found.z - z) * step_v <= -0.9 * gain:
                    break
            part *= 0.5
        H, V = H + part * step_h, V + part * step_v
    _bisect(sections, line, x, z, slope, clearance, slides, state)


@kernel(internal=True)
def _hang_down(
    sections: Records[SectionData],
    line: LineData,
    x: float,
    z: float,
    slope: float,
    clearance: float,
    state: BottomState,
) -> bool:
    """Whether a line is so long that its ends hang straight down and friction holds the rest; then its solution."""
    first, count, tail = line.first, line.count, line.tail
    cos = 1.0 / math.sqrt(1.0 + slope * slope)
    rub = _grip(line.friction, slope * cos, cos, clearance < 0.0)
    if rub < abs(slope * cos) or tail == count:
        return False
    reach = 0.0
    for i in range(first, first + count):
        reach += abs(sections[i].weight) * sections[i].length + abs(sections[i].clump)
    above = max(clearance, 0.0)
    high = z - slope * x + above
    if x / cos + high + above >= line.length + reach * line.stretch:
        return False
    V, lying, z_v = vertical_hang(sections, first, count, tail, high, 0.0 if tail == 0 else -reach, reach)
    lifted = 0.0
    if clearance >= 0.0:
        if lying <= 0.0:
            return False
        whole = line.weight - V
        tiny = TINY_FORCE * abs(line.weight)
        free = _lower_tail(sections, first, count, tiny, -whole, whole)
        if slope * free.x - free.z <= clearance:
            return False
        off = _lift_off(sections, line, 0.0, whole, slope, rub, clearance, state.lifted, tiny)
        lying -= off.tail.length
        lifted = off.weight
    if x > lying * cos:
        return False
    state.horizontal, state.vertical, state.span, state.rise = 0.0, V, x, z
    state.stiffness[0, 0] = state.stiffness[0, 1] = 0.0
    state.stiffness[1, 0], state.stiffness[1, 1] = -slope / z_v, 1.0 / z_v
    state.branch, state.clearance = SLACK, clearance
    state.lower_horizontal, state.lower_vertical = 0.0, -lifted
    state.lying, state.lifted = lying, lifted
    return True


@kernel(internal=True)
def _keep(
    sections: Records[SectionData],
    line: LineData,
    H: float,
    V: float,
    x: float,
    z: float,
    slope: float,
    clearance: float,
    guess: float,
    state: BottomState,
) -> bool:
    """Write a solution; whether its stiffness is one."""
    found = _respond(sections, line, H, V, slope, clearance, guess)
    determinant = found.x_h * found.z_v - found.x_v * found.z_h
    state.horizontal, state.vertical, state.span, state.rise = H, V, x, z
    state.stiffness[0, 0], state.stiffness[0, 1] = found.z_v / determinant, -found.x_v / determinant
    state.stiffness[1, 0], state.stiffness[1, 1] = -found.z_h / determinant, found.x_h / determinant
    state.lower_horizontal, state.lower_vertical = found.lower_horizontal, found.lower_vertical
    state.lying, state.lifted = found.lying, found.lifted
    state.branch = RESTING if found.lifted >= 0.0 else SUSPENDED
    near = abs(found.x - x) + abs(found.z - z) <= 1e-9 * line.length
    return near and determinant > 0.0


@kernel(internal=True)
def _bisect(
    sections: Records[SectionData],
    line: LineData,
    x: float,
    z: float,
    slope: float,
    clearance: float,
    slides: bool,
    state: BottomState,
) -> None:
    """The last resort: the height grows with V, and at a fixed height the span with H, taken as ``sinh(p)``."""
    first, count = line.first, line.count
    scale = 1.0
    for i in range(first, first + count):
        scale += abs(sections[i].weight) * sections[i].length + abs(sections[i].clump)
    if line.stretch > 0.0:
        scale += math.sqrt(x * x + z * z) / line.stretch
    unit, most = 1e-12 * scale, 42.0  # to 1e6 of the scale
    lifts = clearance < 0.0 and line.tail == 0
    low_p, high_p = -most if slides else 0.0, most
    H = V = 0.0
    for _ in range(120):
        p = 0.5 * (low_p + high_p)
        H = unit * (math.sinh(p) if p != 0.0 else 1e-9)
        low_v, high_v = slope * H - (0.0 if lifts else 1e6 * scale), slope * H + 1e6 * scale
        found = _respond(sections, line, H, 0.5 * (low_v + high_v), slope, clearance, -1.0)
        for _ in range(120):
            V = 0.5 * (low_v + high_v)
            found = _respond(sections, line, H, V, slope, clearance, found.lifted)
            if found.z < z:
                low_v = V
            else:
                high_v = V
            if high_v - low_v <= 1e-16 * (abs(high_v) + abs(low_v)):
                break
        if found.x < x:
            low_p = p
        else:
            high_p = p
        if high_p - low_p <= 1e-16 * (abs(high_p) + abs(low_p)):
            break
    if not _keep(sections, line, H, V, x, z, slope, clearance, -1.0, state):
        state.branch = FAILED


@kernel(internal=True)
def trace_over_bottom(
    sections: Records[SectionData], line: LineData, state: BottomState, nodes: Floats2
) -> float:
    """Energy of position, about its lower end, and of strain in a solved line [J], and where its sections join.

    Parameters
    ----------
    sections, line, state
        As in `solve_over_bottom`.
    nodes
        Written if it has rows: x, z over the lower end [m], tension [N], from the upper end; shape (sections + 1, 3).
        The excess of a slack line is drawn straight, and shortened.
    """
    first, count, tail = line.first, line.count, line.tail
    slope, slack = state.slope, state.branch == SLACK
    cos = 1.0 / math.sqrt(1.0 + slope * slope)
    sin = slope * cos
    rub = _grip(line.friction, sin, cos, state.clearance < 0.0)
    lifted = state.lifted
    H, v, x, z = state.horizontal, state.vertical, state.span, state.rise
    if slack:
        H = TINY_FORCE * abs(line.weight)
    edge = slope * H
    shrink = x / (cos * state.lying) if slack and state.lying > 0.0 else 1.0
    remaining = line.weight  # of what is below
    phase = 0  # hangs from the upper end; lies; hangs from the lower one
    t = 0.0
    energy = 0.0
    for k in range(count):
        section = sections[first + k]
        length, w, c, clump = section.length, section.weight, section.flexibility, section.clump
        if nodes.shape[0] > 0:
            nodes[k, 0], nodes[k, 1] = x, z
            nodes[k, 2] = abs(t) if phase == 1 else math.sqrt(H * H + v * v)
        left = length
        while left > 0.0:
            part = left
            lands = phase == 0 and lifted >= 0.0 and k >= tail
            if lands:
                part = min(left, max(v - edge, 0.0) / w)
            elif phase == 1:
                part = min(left, max(remaining - lifted, 0.0) / w)
            if phase != 1 and part > 0.0:
                below = v - w * part
                if lands and part < left:
                    below = edge
                piece = hung_piece(H, v, below, part, w, c)
                s = math.sqrt(H * H + v * v) + math.sqrt(H * H + below * below)
                m = v + below
                energy += v * piece.z + 0.5 * (H * piece.x + c * H * H * part) - 0.25 * part * (s + m * m / s)
                energy -= 0.5 * c * part * (H * H + (v * v + v * below + below * below) / 3.0)
                x -= piece.x
                z -= piece.z
                energy += w * part * z
                v = below
            elif part > 0.0:
                # apart where the tension vanishes
                sign = 1.0 if t >= 0.0 else -1.0
                fall = (sign * sin + rub) * w
                if fall * part > abs(t):
                    if t != 0.0:
                        part = abs(t) / fall
                    else:
                        sign, fall = (-1.0, rub - sin) if sin > rub else (1.0, 0.0)
                        fall *= w
                t0 = abs(t)
                strain = c * (t0 - 0.5 * fall * part)
                drawn = shrink if t0 == 0.0 and fall == 0.0 else 1.0
                way = drawn * sign * part * (1.0 + strain)
                area = drawn * sign * part * part * (0.5 + c * (0.5 * t0 - fall * part / 6.0))
                energy += w * (part * z - sin * area)
                energy += 0.5 * c * part * (t0 * t0 - t0 * fall * part + fall * fall * part * part / 3.0)
                x -= way * cos
                z -= way * sin
                t = sign * (t0 - fall * part)
                if abs(t) <= 1e-15 * t0:
                    t = 0.0
            left -= part
            remaining -= w * part
            if left <= 1e-14 * length:
                left = 0.0
            if left > 0.0 and phase == 0:
                phase = 1
                t = 0.0 if slack else _lie(H / cos, 0.0, max(edge - v, 0.0), 0.0, sin, rub).tension
            elif left > 0.0 and phase == 1 and remaining - lifted <= 1e-14 * abs(line.weight):
                phase, H, v = 2, state.lower_horizontal, state.lower_vertical + remaining
                if slack or H == 0.0:
                    H = TINY_FORCE * abs(line.weight)
        energy += clump * z
        remaining -= clump
        if phase == 1:
            t = _lie(t, 0.0, min(clump, remaining + clump - lifted), 0.0, sin, rub).tension
            if clump > 0.0 and remaining < lifted:
                phase, H, v = 2, state.lower_horizontal, state.lower_vertical + remaining
                if slack or H == 0.0:
                    H = TINY_FORCE * abs(line.weight)
        elif phase == 0 and lifted >= 0.0 and k >= tail and v - clump < edge:
            phase = 1
            t = 0.0 if slack else _lie(H / cos, 0.0, clump - (v - edge), 0.0, sin, rub).tension
            if remaining < lifted:
                phase, H, v = 2, state.lower_horizontal, state.lower_vertical + remaining
        else:
            v -= clump
    if nodes.shape[0] > 0:
        nodes[count, 0], nodes[count, 1] = x, z
        nodes[count, 2] = abs(t) if phase == 1 else math.sqrt(H * H + v * v)
    return energy


@kernel(internal=True)
def read_ends_over_bottom(
    sections: Records[SectionData], line: LineData, state: BottomState, nodes: Floats2, ends: LineEnds
) -> None:
    """Lower end, length on the bottom and energy of a solved line; `nodes` as in `trace_over_bottom`."""
    if state.branch == FAILED:
        ends.anchor_horizontal = ends.anchor_vertical = ends.lying = ends.energy = math.nan
        return
    ends.anchor_horizontal, ends.anchor_vertical = state.lower_horizontal, state.lower_vertical
    ends.lying = state.lying
    ends.energy = trace_over_bottom(sections, line, state, nodes)


@entry
def solve_lines_over_bottom(
    sections: Records[SectionData],
    lines: Records[LineData],
    places: Floats2,
    state: Records[BottomState],
    ends: Records[LineEnds],
    nodes: Floats2,
) -> None:
    """Solve lines over a bottom for the places of their upper ends.

    Parameters
    ----------
    sections, lines, state
        As in `solve_over_bottom`, of all.
    places
        x, z, slope, and clearance of each line, negative if its lower end is anchored; shape (lines, 4).
    ends
        Written.
    nodes
        Written, of a single line, if it has rows: as in `trace_over_bottom`.
    """
    for row in range(lines.shape[0]):
        x, z, slope, clearance = places[row, 0], places[row, 1], places[row, 2], places[row, 3]
        solve_over_bottom(sections, lines[row], x, z, slope, clearance, clearance < 0.0, state[row])
        read_ends_over_bottom(sections, lines[row], state[row], nodes, ends[row])
