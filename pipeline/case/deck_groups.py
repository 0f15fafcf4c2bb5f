"""Tables of a case file for the plates and stiffeners of a mesh file: what it lacks, or what is otherwise here."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated

from pydantic import model_validator

from heavylift.pipeline.case.fields import Direction, Positive, Quantity, Section, reject
from heavylift.pipeline.case.geometry import MaterialSection
from heavylift.pipeline.case.panels import ProfileSection

__all__ = ["PlateGroupSection", "StiffenerGroupSection"]


class PlateGroupSection(Section):
    """Plates of a set of elements of a mesh file; what is left out is as the file says."""

    thickness: Annotated[float, Positive("length")] | None = None
    """Thickness [m]."""
    offset: Annotated[float, Quantity("length")] | None = None
    """From the nodes to the mid-surface, along the normal [m]."""
    nonstructural_mass: Annotated[float, Quantity("mass per area", minimum=0.0, closed=True)] | None = None
    """Outfit, paint and weld metal [kg/m^2]."""
    material: MaterialSection | None = None
    """Material, where it is not that of the body."""


class StiffenerGroupSection(Section):
    """Beams of a set of elements of a mesh file; what is left out is as the file says."""

    section: ProfileSection | None = None
    """Shape and measures of the section."""
    web: Direction | None = None
    """Direction of the web, away from its foot; needed with a `section`."""
    flange: Direction | None = None
    """Direction in which the flange of an angle or the bulb points; any by default."""
    foot: Annotated[float, Quantity("length")] | None = None
    """From the nodes to the foot of the web, along the web [m], of a beam that is welded to a plate by its foot; by
    default the centroid is at the nodes."""
    material: MaterialSection | None = None
    """Material, where it is not that of the body."""

    @model_validator(mode="after")
    def _fits(self) -> "StiffenerGroupSection":
        if self.section is not None and self.web is None:
            reject("'section' without 'web'", "the direction of its web", key="web")
        for key in ("foot", "flange"):
            if getattr(self, key) is not None and self.section is None:
                reject(f"{key!r} without 'section'", "the section", key=key)
        return self
