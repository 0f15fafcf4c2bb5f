"""Mooring lines where they hang, as polylines in space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.solver.water.lines.placed_line import hang_line, line_bottom

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.water.lines.catenary_line import Catenary, LineProfile
    from heavylift.solver.water.lines.mooring_lines import MooringLine
    from heavylift.solver.water.lines.placed_line import LineBottom

__all__ = ["HangingLine", "hanging_line"]


@dataclass(frozen=True, eq=False)
class HangingLine:
    """A line where it hangs.

    Attributes
    ----------
    line
        What it is.
    catenary
        Its forces.
    profile
        In its vertical plane, from the anchor.
    points
        The same in the world [m], shape (n, 3): a polyline.
    joints
        Points of the profile that are joints of sections, numbers.
    bottom
        What is below it, in the world.
    """

    line: MooringLine
    catenary: Catenary
    profile: LineProfile
    points: NDArray[np.float64]
    joints: NDArray[np.int64]
    bottom: LineBottom | None


def hanging_line(
    line: MooringLine, anchor: NDArray[np.float64], fairlead: NDArray[np.float64], *, points: int = 40
) -> HangingLine:
    """Shape of a line between two places.

    Parameters
    ----------
    line
        The line.
    anchor, fairlead
        Its ends, world [m], shape (3,).
    points
        On each section, at least.
    """
    anchor, fairlead = np.asarray(anchor, dtype=np.float64), np.asarray(fairlead, dtype=np.float64)
    r = fairlead - anchor
    span = float(np.hypot(r[0], r[1]))
    found, profile = hang_line(line, anchor, fairlead, points=points)
    e = np.array([r[0], r[1], 0.0]) / span if span > 0.0 else np.array([1.0, 0.0, 0.0])
    places = anchor + profile.x[:, None] * e + profile.z[:, None] * np.array([0.0, 0.0, 1.0])
    ends = np.cumsum([section.length for section in line.sections])[:-1]
    joints = np.array([int(np.argmin(np.abs(profile.s - at))) for at in ends], dtype=np.int64)
    return HangingLine(line, found, profile, places, joints, line_bottom(line, anchor))
