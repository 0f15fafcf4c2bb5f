"""Tables of a case file that hold a flexible body and load it at rest: supports, static load cases."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, StringConstraints, model_validator

from heavylift.pipeline.case.fields import (
    AccelerationVector,
    ForceVector,
    GroupName,
    LengthVector,
    MomentVector,
    Name,
    Quantity,
    Section,
    as_list,
    reject,
)

__all__ = ["BodySupportSection", "StaticCaseSection", "StaticLoadSection"]

Directions = Annotated[str, StringConstraints(pattern="^x?y?z?$", min_length=1)]
"""Some of the letters x, y, z in this order."""

_Stress = Annotated[float, Quantity("pressure")]


class _PlaceSection(Section):
    """Which nodes of a flexible body."""

    on: Annotated[
        tuple[GroupName, ...], BeforeValidator(as_list, json_schema_input_type=GroupName | list[GroupName])
    ] = ()
    """A group of nodes, or a list of groups; all nodes of the body if absent."""
    lower: LengthVector | None = Field(default=None, alias="from")
    """Corner of a box with the smallest coordinates [m]; nodes outside of the box are left out."""
    upper: LengthVector | None = Field(default=None, alias="to")
    """Corner of a box with the largest coordinates [m]."""

    @model_validator(mode="after")
    def _is_a_box(self) -> Self:
        if (self.lower is None) != (self.upper is None):
            given, absent = ("to", "from") if self.lower is None else ("from", "to")
            reject(f"{given!r} without {absent!r}", "both, or none", key=absent)
        if any(a > b for a, b in zip(self.lower or (), self.upper or (), strict=True)):
            reject(
                f"corner {list(self.upper or ())} m",
                f"no smaller than 'from' = {list(self.lower or ())} m in any direction",
                key="to",
            )
        return self

    @property
    def is_somewhere(self) -> bool:
        """Whether a group or a box is given."""
        return bool(self.on) or self.lower is not None


class BodySupportSection(_PlaceSection):
    """Nodes of a flexible body that do not move in its frame, in some directions or in all; or a plane of symmetry."""

    fixed: Directions | None = None
    """Directions that are held, in axes of the geometry: ``"xyz"`` clamps solids."""
    rotations: Directions | None = None
    """Axes about which nodes of plates and beams do not turn: ``"xyz"`` with `fixed` clamps these."""
    symmetry: Literal["x", "y", "z"] | None = None
    """In place of a group and `fixed`: half of a body that is symmetric to a plane across this axis; nodes in the plane
    do not leave it, and those of plates and beams turn about this axis only."""
    at: Annotated[float, Quantity("length")] = 0.0
    """Coordinate of the plane of symmetry [m]."""

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        given = [key for key in ("fixed", "rotations") if getattr(self, key) is not None]
        if bool(given) == (self.symmetry is not None):
            reject(
                f"both {given[0]!r} and 'symmetry'" if given else "neither 'fixed' nor 'symmetry'",
                "'fixed' or 'rotations' (of a group or box), or 'symmetry' (a plane)",
            )
        if self.symmetry is not None and self.is_somewhere:
            reject("'symmetry' with a group or box", "'symmetry' and 'at' alone", key="symmetry")
        if given and not self.is_somewhere:
            reject(f"{given[0]!r} without a place", "'on' (groups), or a box 'from', 'to'", key=given[0])
        if given and "at" in self.model_fields_set:
            reject("'at' without 'symmetry'", "'symmetry', or a group or box", key="at")
        return self


class StaticLoadSection(_PlaceSection):
    """A load on faces of a flexible body, or on all of it."""

    pressure: _Stress | None = None
    """Against the outward normal of the faces [Pa]; negative pulls."""
    traction: tuple[_Stress, _Stress, _Stress] | None = None
    """Force by area on the faces [Pa], axes of the geometry."""
    force: ForceVector | None = None
    """Resultant on the faces [N], spread evenly over their area; on nodes that make up no face in equal shares, of
    plates and beams by the length of the edges between them."""
    moment: MomentVector | None = None
    """Resultant on nodes of plates or beams [N m], in shares of the area or length between them."""
    acceleration: AccelerationVector | None = None
    """Force by mass on all of the body [m/s^2], as of gravity."""

    @model_validator(mode="after")
    def _is_one_load(self) -> Self:
        given = [
            key
            for key in ("pressure", "traction", "force", "moment", "acceleration")
            if getattr(self, key) is not None
        ]
        if len(given) != 1:
            reject(
                f"{' and '.join(map(repr, given))} together" if given else "no load",
                "one of 'pressure', 'traction', 'force', 'moment' and 'acceleration'",
            )
        if self.acceleration is not None and self.is_somewhere:
            reject(
                "'acceleration' with a place", "'acceleration' alone: it acts on all of the body", key="on"
            )
        if self.acceleration is None and not self.is_somewhere:
            reject(f"{given[0]!r} without a place", "'on' (groups), or a box 'from', 'to'", key=given[0])
        return self


class StaticCaseSection(Section):
    """Loads under which a flexible body is at rest: linear, small displacements, on its finite-element model."""

    name: Name
    """Name, for quantities and pictures."""
    loads: Annotated[tuple[StaticLoadSection, ...], Field(min_length=1)]
    """Loads that act together."""
    buckling: bool = False
    """Find the factor by which all of them may grow until the body buckles."""
