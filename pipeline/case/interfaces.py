"""The table of a case file for an interface of a flexible body: where others are attached, by a force and a moment."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Literal, Self

from pydantic import model_validator

from heavylift.pipeline.case.fields import LengthVector, Name, Positive, Section, reject

__all__ = ["InterfaceSection"]


class InterfaceSection(Section):
    """A place where others are attached: its motion is that of a group of nodes."""

    at: LengthVector | None = None
    """Reference point [m], in coordinates of the geometry; by default the middle of the group, by its weights."""
    group: Name | None = None
    """Group of nodes."""
    radius: Annotated[float, Positive("length")] | None = None
    """In place of `group`: nodes of the surface within this distance of `at` [m]."""
    kind: Literal["average", "rigid"] = "average"
    """``average``: weighted mean motion of the group, which stays as soft as it is (RBE3), weights are tributary areas
    or lengths; ``rigid``: the group does not deform (RBE2)."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.group is not None and self.radius is not None:
            reject("'group' and 'radius'", "one of them", key="radius")
        if self.group is None and self.radius is None:
            reject("neither 'group' nor 'radius'", "the nodes that move and bear it", key="group")
        if self.at is None and self.group is None:
            reject("'radius' without 'at'", "the point that the nodes are around", key="at")
        return self
