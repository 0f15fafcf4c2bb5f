"""Where lines and fenders are described, and the sections that lines are made of, in SI units."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Absent, Positive, Quantity, Shape
from heavylift.solver.scene.descriptions import Family

__all__ = ["MOORINGS", "LineSection", "SeabedSlope", "check_sections"]

MOORINGS: Family[Any] = Family("table", "heavylift.solver.water.lines", typed=False)
"""Lines and fenders, by the lists of a case file in which they stand."""

STEEPEST = math.pi / 3
"""Angle of a bottom at most: lines do not lie on a wall."""


@MOORINGS.part
@dataclass(frozen=True)
class LineSection:
    """A piece of a line with the same properties all along."""

    length: Annotated[float, Positive("length"), Absent(math.nan)]
    """Unstretched [m]; absent of one section if `fairlead_tension` is given."""
    weight: Annotated[float, Quantity("force per length")]
    """A length, in the fluid that it hangs in [N/m]: in water less its buoyancy; negative if it floats."""
    axial_stiffness: Annotated[float, Positive("force"), Absent(math.inf)]
    """EA [N]; without it the line does not stretch."""


@MOORINGS.part
@dataclass(frozen=True, eq=False)
class SeabedSlope:
    """A bottom that is an inclined plane. Of a line its slope in the vertical plane of the two ends counts."""

    angle: Annotated[float, Quantity("angle", minimum=0.0, maximum=STEEPEST, closed=True)]
    """Between the bottom and the horizontal."""
    downhill: Annotated[float, Quantity("angle")] = 0.0
    """Horizontal direction in which the bottom falls, from x towards y."""
    point: Annotated[NDArray[np.float64] | None, Quantity("length"), Shape((2,))] = None
    """x and y [m] in the world at which the bottom has its height; absent: those of the anchor at the start."""

    def gradient(self) -> tuple[float, float]:
        """Rise of the bottom a length along x and along y."""
        rise = -math.tan(self.angle)
        return rise * math.cos(self.downhill), rise * math.sin(self.downhill)


def check_sections(
    sections: tuple[LineSection, ...],
    clumps: tuple[float, ...] = (),
    *,
    friction: float = 0.0,
    source: str = "line",
) -> None:
    """Refuse sections that cannot be a line.

    Raises
    ------
    InputError
        If there is no section, a length or stiffness is not positive, a weight is not finite, all weights are zero
        in a line of several sections, the clumps are neither none nor one a joint, or the friction is negative.
    """
    if not sections:
        raise InputError("no sections", source=source, key="sections", expected="at least one")
    for number, section in enumerate(sections):
        for key, value, good, expected in (
            ("length", section.length, 0.0 < section.length < np.inf, "a positive length [m]"),
            ("weight", section.weight, bool(np.isfinite(section.weight)), "a finite weight a length [N/m]"),
            ("axial_stiffness", section.axial_stiffness, section.axial_stiffness > 0.0, "EA > 0 [N]"),
        ):
            if not good:
                raise InputError(
                    f"{key} is {value:g}", source=source, key=f"sections.{number}.{key}", expected=expected
                )
    if clumps and len(clumps) != len(sections) - 1:
        raise InputError(
            f"{len(clumps)} clumps at {len(sections) - 1} joints of sections",
            source=source,
            key="clumps",
            expected="one weight [N] a joint (0 for none), or no clumps",
        )
    if not np.all(np.isfinite(clumps)):
        raise InputError(f"clumps {list(clumps)}", source=source, key="clumps", expected="finite weights [N]")
    if not 0.0 <= friction < np.inf:
        raise InputError(
            f"friction is {friction:g}", source=source, key="friction", expected="a coefficient, 0 or more"
        )
    total = sum(abs(section.weight) for section in sections) + sum(map(abs, clumps))
    if total == 0.0:
        raise InputError(
            "the line has no weight",
            source=source,
            key="sections.0.weight",
            expected="a weight a length [N/m], or a spring rope in place of the line",
        )
