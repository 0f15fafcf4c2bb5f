"""What a user says of mooring: lines of one or more sections, in SI units, and where they are described."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.descriptions import ChannelKind, Family

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MOORINGS", "LineSection", "MooringLine", "check_sections"]

MOORINGS: Family[Any] = Family("table", "heavylift.solver.water.lines", typed=False)
"""Lines and fenders, by the lists of a case file in which they stand."""


@dataclass(frozen=True)
class LineSection:
    """A piece of line with the same properties all along.

    Attributes
    ----------
    length
        Unstretched [m].
    weight
        In the fluid that it hangs in, a length [N/m]: in water less its buoyancy; negative if it floats.
    axial_stiffness
        ``EA`` [N]; infinite for a line that does not stretch.
    """

    length: float
    weight: float
    axial_stiffness: float


@dataclass(frozen=True, eq=False, kw_only=True)
class MooringLine:
    """A line that hangs by its own weight between an anchor and a fairlead, in equilibrium at every instant.

    Attributes
    ----------
    name
        Prefix of its channels.
    body_a, point_a
        Anchor: body (or `heavylift.solver.scene.connections.GROUND`) and point in its frame [m], shape (3,).
    body_b, point_b
        Fairlead.
    sections
        From the anchor to the fairlead.
    clumps
        Weight [N] of what hangs at each joint of two sections, from the anchor; negative for a buoy. None if empty.
    seabed
        Height of a flat seabed [m] in the world, on which the anchor lies; None for a line without one. It holds the
        line from the anchor up to the first buoy or floating section; a bight beyond that would hang through it.
    friction
        Coefficient of the seabed along the line.
    strain_limit
        Mean strain at which a simulation stops, and beyond which a line is refused at the start.
    """

    CHANNELS: ClassVar = (
        ChannelKind("tension", "force", "tension of the line at its fairlead"),
        ChannelKind("anchor_tension", "force", "tension of the line at its anchor"),
        ChannelKind("horizontal_tension", "force", "horizontal part of the tension at the fairlead"),
        ChannelKind("seabed_length", "length", "unstretched length of the line that lies on the bottom"),
    )
    """What it records, in the order of its columns."""

    name: str
    body_a: str
    point_a: NDArray[np.float64]
    body_b: str
    point_b: NDArray[np.float64]
    sections: tuple[LineSection, ...]
    clumps: tuple[float, ...] = ()
    seabed: float | None = None
    friction: float = 0.0
    strain_limit: float = 0.1


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
