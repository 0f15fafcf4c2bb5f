"""A mooring line between two places, over its bottom: what is refused, and how it hangs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.moorings import check_sections
from heavylift.solver.water.lines.catenary import SLACK
from heavylift.solver.water.lines.catenary_line import (
    Catenary,
    LineProfile,
    check_all_sinks,
    line_profile,
    over_bottom,
    profile_over_bottom,
    solve_catenary,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.water.lines.mooring_lines import MooringLine

__all__ = [
    "LineBottom",
    "PlaneOfLine",
    "check_ends",
    "check_line",
    "hang_line",
    "is_anchored",
    "line_bottom",
    "longest_span",
    "plane_of_line",
]

START_STRAIN = 0.05
"""By which a line may be stretched at the start: more is most often a wrong length."""

ANCHOR_TOLERANCE = 0.01
"""Of the length: how far from the seabed an anchor may be given."""

FINER = 8
"""Times as many points of a profile over a bottom: it has none of its own where the line touches that."""


class LineBottom(NamedTuple):
    """The bottom below a line: its height at the origin of the world [m], its rise along x and along y."""

    height: float
    rise_x: float
    rise_y: float

    def below(self, place: NDArray[np.float64]) -> float:
        """Height of a place over it [m]."""
        return float(place[2] - self.height - self.rise_x * place[0] - self.rise_y * place[1])


def line_bottom(line: MooringLine, anchor: NDArray[np.float64]) -> LineBottom | None:
    """The bottom below a line with an anchor at this place at the start [m]; None if it has none."""
    if line.seabed is None:
        return None
    if line.seabed_slope is None:
        return LineBottom(line.seabed, 0.0, 0.0)
    rise_x, rise_y = line.seabed_slope.gradient()
    point = anchor if line.seabed_slope.point is None else line.seabed_slope.point
    return LineBottom(line.seabed - rise_x * float(point[0]) - rise_y * float(point[1]), rise_x, rise_y)


def is_anchored(line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]) -> bool:
    """Whether the anchor of a line is on the ground and on its bottom, within a hundredth of its length.

    With an open length it is the distance to the fairlead that counts.
    """
    bottom = line_bottom(line, anchor)
    if bottom is None or line.body_a != GROUND:
        return False
    length = sum(section.length for section in line.sections)
    if math.isnan(length):
        length = float(np.linalg.norm(np.asarray(fairlead) - np.asarray(anchor)))
    return abs(bottom.below(anchor)) <= ANCHOR_TOLERANCE * length


class PlaneOfLine(NamedTuple):
    """A line in the vertical plane of its ends, as `solve_catenary` has it."""

    x: float
    z: float
    slope: float
    clearance: float | None


def plane_of_line(
    line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]
) -> PlaneOfLine:
    """Where the ends of a line are to each other and to its bottom.

    Parameters
    ----------
    line
        The line; if its bottom slopes and its anchor moves, with the point at which the bottom has its height.
    anchor, fairlead
        Its ends, world [m], shape (3,).
    """
    r = np.asarray(fairlead) - np.asarray(anchor)
    x, z = math.hypot(r[0], r[1]), float(r[2])
    bottom = line_bottom(line, anchor)
    if bottom is None:
        return PlaneOfLine(x, z, 0.0, None)
    slope = (bottom.rise_x * r[0] + bottom.rise_y * r[1]) / x if x > 0.0 else 0.0
    clearance = None if is_anchored(line, anchor, fairlead) else bottom.below(anchor)
    return PlaneOfLine(x, z, float(slope), clearance)


def check_line(line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64]) -> None:
    """Refuse a line that cannot hang between its ends at the start.

    Parameters
    ----------
    line
        The line, with all lengths, and with the height of its bottom.
    anchor, fairlead
        Its ends, world [m], shape (3,).

    Raises
    ------
    InputError
        As of `pack_mooring_lines`.
    """
    check_sections(line.sections, line.clumps, friction=line.friction, source=line.name)
    for key in ("on_seabed", "fairlead_tension"):
        if getattr(line, key):
            raise InputError(
                f"{key} = {getattr(line, key)} of a line that is not laid out",
                source=line.name,
                key=key,
                expected="'seabed', and the lengths of all sections",
            )
    check_ends(line, anchor, fairlead)
    if not line.strain_limit > 0.0:
        raise InputError(
            f"strain_limit is {line.strain_limit:g}",
            source=line.name,
            key="strain_limit",
            expected="a positive strain, e.g. 0.1",
        )
    length = sum(section.length for section in line.sections)
    span = float(np.linalg.norm(np.asarray(fairlead) - np.asarray(anchor)))
    if not span < min(longest_span(line), length * (1.0 + START_STRAIN)):
        raise InputError(
            f"the line of {length:g} m is shorter than its span of {span:g} m",
            source=line.name,
            key="sections",
            expected=f"a length of {span:g} m or more, from the anchor to the fairlead; a stretch of"
            f" {min(START_STRAIN, line.strain_limit):.3g} at the start is accepted",
        )


def check_ends(
    line: MooringLine,
    anchor: NDArray[np.float64],
    fairlead: NDArray[np.float64],
    *,
    on_seabed: bool = False,
) -> None:
    """Refuse ends below the bottom, and what floats of a line whose two ends hang over one.

    Parameters
    ----------
    line, anchor, fairlead
        As in `check_line`; a length may be open.
    on_seabed
        Whether the anchor is given to be on the bottom.

    Raises
    ------
    InputError
        If an end or a section cannot be where it is.
    """
    bottom = line_bottom(line, anchor)
    if bottom is None:
        return
    anchored = is_anchored(line, anchor, fairlead)
    above = bottom.below(anchor)
    if above < 0.0 and not anchored:
        raise InputError(
            f"the anchor at height {anchor[2]:g} m is {-above:g} m below the seabed",
            source=line.name,
            key="points",
            expected="an anchor on the seabed or above it, or no seabed for this line",
        )
    if on_seabed and not anchored:
        raise InputError(
            f"the anchor is on {line.body_a!r}, {above:g} m above the bottom of the sea",
            source=line.name,
            key="points",
            expected="an anchor on the ground at the depth of [sea], or 'seabed' in place of 'on_seabed' for a line"
            " that hangs by both ends",
        )
    beyond = bottom.below(fairlead) - (above if anchored else 0.0)
    if beyond < 0.0:
        raise InputError(
            f"the fairlead starts at height {fairlead[2]:g} m, {-beyond:g} m below the seabed",
            source=line.name,
            key="points",
            expected="a fairlead above the seabed, or no seabed for this line",
        )
    if not anchored:
        check_all_sinks(line.sections, line.clumps, source=line.name)


def longest_span(line: MooringLine) -> float:
    """Distance of the ends that is too much for a line [m]."""
    length = sum(section.length for section in line.sections)
    stretches = any(math.isfinite(section.axial_stiffness) for section in line.sections)
    return length * (1.0 + line.strain_limit) if stretches else length


def hang_line(
    line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64], *, points: int = 40
) -> tuple[Catenary, LineProfile]:
    """Forces and shape of a line between two places.

    Parameters
    ----------
    line, anchor, fairlead
        As in `plane_of_line`.
    points
        On each section, at least.

    Notes
    -----
    A slack line has excess length; its part on the seabed is drawn straight, and shortened.
    """
    x, z, slope, clearance = plane_of_line(line, anchor, fairlead)
    seabed = line.seabed is not None
    found = solve_catenary(
        line.sections,
        x,
        z,
        seabed=seabed,
        friction=line.friction,
        clumps=line.clumps,
        slope=slope,
        clearance=clearance,
    )
    if over_bottom(slope, clearance):
        return found, profile_over_bottom(
            line.sections,
            x,
            z,
            slope=slope,
            clearance=clearance,
            friction=line.friction,
            clumps=line.clumps,
            points=FINER * points,
        )
    profile = line_profile(
        line.sections,
        found.horizontal,
        found.vertical,
        seabed=seabed,
        friction=line.friction,
        clumps=line.clumps,
        points=points,
    )
    if found.branch == SLACK and profile.x[-1] > 0.0:
        profile = LineProfile(profile.s, profile.x * (x / profile.x[-1]), profile.z, profile.tension)
    return found, profile
