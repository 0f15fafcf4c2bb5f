"""Tables of a case file that describe mooring: lines that hang by their weight, and fenders."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from heavylift.pipeline.case.fields import (
    GROUND,
    LengthVector,
    Positive,
    Quantity,
    Section,
    SideName,
    UniqueName,
    reject,
)
from heavylift.solver.scene.moorings import MooringLine

__all__ = ["LineSectionSection", "MooringLineSection"]

_Force = Annotated[float, Quantity("force")]


class LineSectionSection(Section):
    """A piece of a line with the same properties all along."""

    length: Annotated[float, Positive("length")] | None = None
    """Unstretched [m]; absent of one section if `fairlead_tension` is given."""
    weight: Annotated[float, Quantity("force per length")]
    """A length, in the fluid that it hangs in [N/m]: in water less its buoyancy; negative if it floats."""
    axial_stiffness: Annotated[float, Positive("force")] | None = None
    """EA [N]; without it the line does not stretch."""


class MooringLineSection(Section):
    """A line between an anchor and a fairlead, in equilibrium at every instant."""

    CHANNELS: ClassVar = MooringLine.CHANNELS

    name: UniqueName
    """Name; the first part of its channels."""
    between: tuple[SideName, SideName]
    """Bodies, or ``"ground"``, of its anchor and of its fairlead."""
    points: tuple[LengthVector, LengthVector]
    """Anchor and fairlead in the coordinates of the geometries; of the ground in the world [m]."""
    sections: Annotated[tuple[LineSectionSection, ...], Field(min_length=1)]
    """From the anchor to the fairlead."""
    clumps: tuple[_Force, ...] = ()
    """Weight [N] of what hangs at each joint of two sections, from the anchor; negative for a buoy."""
    fairlead_tension: Annotated[float, Positive("force")] | None = None
    """Tension at the fairlead at the start [N], from which the length of the one section without it follows."""
    on_seabed: Annotated[bool, Field(strict=True)] = False
    """The anchor lies on the bottom of the sea, at the depth of [sea]."""
    seabed: Annotated[float, Quantity("length")] | None = None
    """In place of `on_seabed`: height of a flat bottom in the world [m]."""
    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coefficient of the bottom along the line."""
    strain_limit: Annotated[float, Quantity("number", minimum=0.0)] = 0.1
    """Mean strain at which a simulation stops."""

    @model_validator(mode="after")
    def _is_a_line(self) -> Self:
        if self.between[0] == self.between[1] != GROUND:
            reject(
                f"both ends are on {self.between[0]!r}", "two bodies, or a body and the ground", key="between"
            )
        open_ends = [i for i, section in enumerate(self.sections) if section.length is None]
        if self.fairlead_tension is None and open_ends:
            reject("is missing", "a length [m], or 'fairlead_tension'", key=f"sections.{open_ends[0]}.length")
        if self.fairlead_tension is not None and len(open_ends) != 1:
            reject(
                f"'fairlead_tension' and {len(open_ends)} sections without 'length'",
                "one section whose length follows from it",
                key="fairlead_tension",
            )
        if self.clumps and len(self.clumps) != len(self.sections) - 1:
            reject(
                f"{len(self.clumps)} clumps at {len(self.sections) - 1} joints of sections",
                "one weight [N] a joint, 0 for none",
                key="clumps",
            )
        if self.on_seabed and self.seabed is not None:
            reject("both 'on_seabed' and 'seabed'", "one of them", key="seabed")
        if self.friction and not self.on_seabed and self.seabed is None:
            reject("'friction' without a bottom", "'on_seabed' or 'seabed'", key="friction")
        return self
