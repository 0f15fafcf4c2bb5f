"""One walk down a line: what it spans, how it is stretched and what it stores, under a given force on its upper end.

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
from typing import NamedTuple

from heavylift.numerics.jit import kernel
from heavylift.numerics.records import Record, Records

__all__ = ["LineResponse", "SectionData", "line_energy", "line_response", "vertical_hang"]


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
            x += H * (ratio + stretch)
            z += m * (hung / s + 0.5 * stretch)
            x_h += ratio - rise_v + stretch
            x_v -= H * hung * m / (s * product)
            z_v += rise_v + stretch
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
