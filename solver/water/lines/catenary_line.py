"""Single catenaries in NumPy: end forces, the length for a given tension, the profile, and the classic formula."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Records, filled_rows, records
from heavylift.solver.scene.moorings import LineSection, check_sections
from heavylift.solver.water.lines.bottom import BottomState, solve_lines_over_bottom
from heavylift.solver.water.lines.catenary import (
    FAILED,
    LineData,
    LineEnds,
    LineState,
    SectionData,
    solve_lines,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = [
    "Catenary",
    "LineProfile",
    "check_all_sinks",
    "length_for_tension",
    "line_profile",
    "over_bottom",
    "pack_sections",
    "profile_over_bottom",
    "solve_catenary",
]


@dataclass(frozen=True, eq=False)
class Catenary:
    """A line in equilibrium.

    Attributes
    ----------
    horizontal, vertical
        Force that pulls its upper end outwards and upwards [N].
    anchor_horizontal, anchor_vertical
        Force with which its lower end is held against it: inwards and downwards [N].
    on_seabed
        Unstretched length on the seabed [m].
    stiffness
        ``d(H, V)/d(x, z)`` [N/m], shape (2, 2).
    energy
        Of position, about the lower end, and of strain [J].
    branch
        `SUSPENDED`, `RESTING` or `SLACK` of `heavylift.solver.water.lines.catenary`.
    """

    horizontal: float
    vertical: float
    anchor_horizontal: float
    anchor_vertical: float
    on_seabed: float
    stiffness: NDArray[np.float64]
    energy: float
    branch: int

    @property
    def tension(self) -> float:
        """At the upper end [N]."""
        return math.hypot(self.horizontal, self.vertical)

    @property
    def anchor_tension(self) -> float:
        """At the lower end [N]."""
        return math.hypot(self.anchor_horizontal, self.anchor_vertical)


@dataclass(frozen=True, eq=False)
class LineProfile:
    """Points along a line from its lower to its upper end, arrays of shape (n,).

    Attributes
    ----------
    s
        Unstretched length from the lower end [m].
    x, z
        Horizontal distance and height over the lower end [m].
    tension
        [N].
    """

    s: NDArray[np.float64]
    x: NDArray[np.float64]
    z: NDArray[np.float64]
    tension: NDArray[np.float64]


def pack_sections(
    sections: Sequence[LineSection], clumps: Sequence[float] = (), *, on_seabed: bool, friction: float = 0.0
) -> tuple[Records[SectionData], Records[LineData]]:
    """Numbers of a line for the kernels.

    Parameters
    ----------
    sections, clumps
        From the lower end.
    on_seabed
        Whether it may lie down.
    friction
        Of the seabed.

    Returns
    -------
    sections
        From the upper end.
    lines
        The line, one record. Its tail are the sections below the last one that floats, and the last buoy.
    """
    below = list(clumps) if clumps else [0.0] * (len(sections) - 1)
    downwards = sections[::-1]
    rows = filled_rows(
        SectionData,
        length=[section.length for section in downwards],
        weight=[section.weight for section in downwards],
        flexibility=[1.0 / section.axial_stiffness for section in downwards],
        clump=[0.0, *below][::-1],
    )
    lines = records(LineData, 1)
    line = lines[0]
    line.count = line.tail = len(rows)
    if on_seabed:
        while line.tail > 0 and rows[line.tail - 1].weight > 0.0 and rows[line.tail - 1].clump >= 0.0:
            line.tail -= 1
    length = rows["length"]
    line.length, line.stretch = length.sum(), length @ rows["flexibility"]
    line.weight, line.friction = length @ rows["weight"] + rows["clump"].sum(), friction
    return rows, lines


def solve_catenary(
    sections: Sequence[LineSection],
    x: float,
    z: float,
    *,
    seabed: bool = True,
    friction: float = 0.0,
    clumps: Sequence[float] = (),
    slope: float = 0.0,
    clearance: float | None = None,
) -> Catenary:
    """A line between two given points.

    Parameters
    ----------
    sections, clumps
        From the lower end; clumps [N] at the joints.
    x, z
        Horizontal distance of the ends, height of the upper one over the lower one [m]; z may be negative
        without a seabed, or with a slope or a clearance.
    seabed
        Whether there is a bottom below the line.
    friction
        Of the seabed.
    slope
        Rise of the seabed towards the upper end, a length.
    clearance
        Height of the lower end over the seabed [m]; None: it is held on it.

    Raises
    ------
    InputError
        If the sections are no line, the ends are not finite, a line whose lower end hangs over a seabed floats
        somewhere, or no equilibrium was found.
    """
    check_sections(tuple(sections), tuple(clumps), friction=friction)
    if not (0.0 <= x < np.inf and np.isfinite(z)):
        raise InputError(
            f"span {x:g} m and height {z:g} m", source="line", expected="finite, the span 0 or more"
        )
    rows, lines = pack_sections(sections, clumps, on_seabed=seabed, friction=friction)
    line = lines[0]
    chord, length = math.hypot(x, z), float(line.length)
    if line.stretch == 0.0 and chord >= length:
        raise InputError(
            f"an inextensible line of {length:g} m is shorter than its span of {chord:g} m",
            source="line",
            key="length",
            expected="a longer line, or a finite axial stiffness",
        )
    ends = records(LineEnds, 1)
    if seabed and over_bottom(slope, clearance):
        if clearance is not None:
            check_all_sinks(sections, clumps)
        states: Records[BottomState] | Records[LineState] = records(BottomState, 1)
        place = np.array([[x, z, slope, _clearance(clearance)]], dtype=float)
        solve_lines_over_bottom(rows, lines, place, states, ends, np.empty((0, 3)))
    else:
        states = records(LineState, 1)
        solve_lines(rows, lines, np.array([[x, z]], dtype=float), states, ends)
    state, end = states[0], ends[0]
    if state.branch == FAILED:
        raise InputError(
            f"no equilibrium of {length:g} m of line found for a span of {x:g} m and a height of {z:g} m",
            source="line",
            expected="lengths [m], weights [N/m] and stiffnesses [N] of a line",
        )
    return Catenary(
        float(state.horizontal),
        float(state.vertical),
        float(end.anchor_horizontal),
        float(end.anchor_vertical),
        float(end.lying),
        state.stiffness.copy(),
        float(end.energy),
        int(state.branch),
    )


def over_bottom(slope: float, clearance: float | None) -> bool:
    """Whether a line is one of `heavylift.solver.water.lines.bottom`: not anchored on a level seabed."""
    return slope != 0.0 or clearance is not None


def _clearance(clearance: float | None) -> float:
    """As kernels have it."""
    return -1.0 if clearance is None else max(float(clearance), 0.0)


def check_all_sinks(
    sections: Sequence[LineSection], clumps: Sequence[float], *, source: str = "line"
) -> None:
    """Refuse sections that float, and buoys, of a line whose two ends hang over a bottom: it could touch that twice.

    Raises
    ------
    InputError
        If one does.
    """
    for number, section in enumerate(sections):
        if not section.weight > 0.0:
            raise InputError(
                f"weight is {section.weight:g} of a line that hangs over a seabed by both ends",
                source=source,
                key=f"sections.{number}.weight",
                expected="a section that sinks [N/m], or no seabed for this line",
            )
    for number, clump in enumerate(clumps):
        if clump < 0.0:
            raise InputError(
                f"a buoy of {-clump:g} N on a line that hangs over a seabed by both ends",
                source=source,
                key=f"clumps.{number}",
                expected="clumps that sink, or no seabed for this line",
            )


def length_for_tension(
    tension: float,
    weight: float,
    axial_stiffness: float,
    x: float,
    z: float,
    *,
    seabed: bool = True,
    friction: float = 0.0,
    slope: float = 0.0,
    clearance: float | None = None,
) -> float:
    """Unstretched length [m] of a uniform line with a given tension at its upper end.

    Parameters
    ----------
    tension
        [N].
    weight, axial_stiffness
        As of a `LineSection`.
    x, z, seabed, friction, slope, clearance
        As in `solve_catenary`. Of two lengths that hang free with the same tension it is the shorter one.

    Raises
    ------
    InputError
        If every length has a larger tension.
    """
    from scipy.optimize import brentq, minimize_scalar

    def excess(length: float) -> float:
        line = (LineSection(length, weight, axial_stiffness),)
        found = solve_catenary(line, x, z, seabed=seabed, friction=friction, slope=slope, clearance=clearance)
        return found.tension - tension

    chord = math.hypot(x, z)
    shortest = chord * (1.0 + 1e-12)
    if math.isfinite(axial_stiffness):
        shortest = chord / (1.0 + 1.001 * tension / axial_stiffness) * (1.0 - 1e-9)
    longest = x + abs(z) * (1.0 + weight * abs(z) / axial_stiffness)
    if not seabed or over_bottom(slope, clearance):
        best = minimize_scalar(excess, bounds=(shortest, 3.0 * longest), method="bounded")
        longest = float(best.x)
    if not excess(longest) <= 0.0:
        raise InputError(
            f"a tension of {tension:g} N is less than the line has at any length over a span of {x:g} m and a"
            f" height of {z:g} m",
            source="line",
            key="tension",
            expected=f"more than {excess(longest) + tension:g} N",
        )
    return float(brentq(excess, shortest, longest, xtol=1e-12, rtol=1e-14))


def line_profile(
    sections: Sequence[LineSection],
    horizontal: float,
    vertical: float,
    *,
    seabed: bool = True,
    friction: float = 0.0,
    clumps: Sequence[float] = (),
    points: int = 40,
) -> LineProfile:
    """Shape and tension of a line under the force on its upper end, for pictures.

    Parameters
    ----------
    sections, seabed, friction, clumps
        As in `solve_catenary`.
    horizontal, vertical
        Force that pulls the upper end outwards and upwards [N].
    points
        On each section, at least; ends and the touch-down point are among them.
    """
    rows, lines = pack_sections(sections, clumps, on_seabed=seabed, friction=friction)
    tail = lines[0].tail
    s, dx, dz, tensions = [0.0], [0.0], [0.0], [math.hypot(horizontal, vertical)]
    v, along = vertical, horizontal

    def append(
        ds: float, x: NDArray[np.float64], z: NDArray[np.float64], tension: NDArray[np.float64]
    ) -> None:
        steps = np.linspace(0.0, ds, len(x))[1:]
        s.extend(s[-1] + steps)
        dx.extend(dx[-1] + x[1:])
        dz.extend(dz[-1] + z[1:])
        tensions.extend(tension[1:])

    for i, section in enumerate(rows):
        length, w, c, clump = section.length, section.weight, section.flexibility, section.clump
        hung = min(length, max(v, 0.0) / w) if i >= tail else length
        if hung > 0.0:
            part = np.linspace(0.0, hung, points)
            force = v - w * part
            T = np.hypot(horizontal, force)
            T_sum = T + T[0]
            with np.errstate(divide="ignore", invalid="ignore"):
                # artanh(w s / (T + T0)) / w goes to s / (T + T0) as w goes to zero
                u = np.clip(w * part / T_sum, -1.0 + 1e-16, 1.0 - 1e-16)
                ratio = np.where(np.abs(u) > 1e-8, 2.0 * np.arctanh(u) / (w or 1.0), 2.0 * part / T_sum)
                rise = part * (force + v) / T_sum
            x = np.nan_to_num(horizontal * ratio) + c * horizontal * part
            append(hung, -x, -np.nan_to_num(rise) - 0.5 * c * part * (force + v), T)
        if hung < length:
            part = np.linspace(0.0, length - hung, points)
            drop = friction * w
            T = np.maximum(along - drop * part, 0.0)
            pulled = np.minimum(part, along / drop) if drop > 0.0 else part
            stretch = c * pulled * (along - 0.5 * drop * pulled)
            append(length - hung, -(part + stretch), np.zeros(points), T)
            along = float(T[-1])
        v = v - w * hung - clump
        if i >= tail and v < 0.0:
            along, v = max(along + friction * v, 0.0), 0.0
    total = s[-1]
    x_all, z_all = np.array(dx), np.array(dz)
    return LineProfile(
        total - np.array(s)[::-1],
        (x_all - x_all[-1])[::-1],
        (z_all - z_all[-1])[::-1],
        np.array(tensions)[::-1],
    )


def profile_over_bottom(
    sections: Sequence[LineSection],
    x: float,
    z: float,
    *,
    slope: float = 0.0,
    clearance: float | None = None,
    friction: float = 0.0,
    clumps: Sequence[float] = (),
    points: int = 40,
) -> LineProfile:
    """Shape and tension of a line over a seabed that slopes, or that both ends hang over, for pictures.

    Parameters
    ----------
    sections, x, z, slope, clearance, friction, clumps
        As in `solve_catenary`.
    points
        On each section.
    """
    pieces = [
        replace(section, length=section.length / (points - 1))
        for section in sections
        for _ in range(points - 1)
    ]
    weights = np.zeros(len(pieces) - 1)
    if clumps:
        weights[points - 2 :: points - 1] = clumps
    rows, lines = pack_sections(pieces, weights.tolist(), on_seabed=True, friction=friction)
    nodes = np.empty((len(rows) + 1, 3))
    solve_lines_over_bottom(
        rows,
        lines,
        np.array([[x, z, slope, _clearance(clearance)]], dtype=float),
        records(BottomState, 1),
        records(LineEnds, 1),
        nodes,
    )
    s = np.concatenate([[0.0], np.cumsum([piece.length for piece in pieces])])
    return LineProfile(s, nodes[::-1, 0].copy(), nodes[::-1, 1].copy(), nodes[::-1, 2].copy())
