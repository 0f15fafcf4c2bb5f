"""Tables of a case file that describe frames and shells: bodies of elements that deform at will."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from heavylift.pipeline.case.bodies import FlexibleBodySection, RigidBodySection, RigidInitialSection
from heavylift.pipeline.case.fields import Name, Positive, Quantity, Section, reject
from heavylift.pipeline.case.mesh_geometry import (
    FrameGeometry,
    FrameRegionSection,
    FrameSectionTable,
    RegionSection,
    ShellGeometry,
    ShellSectionTable,
    check_regions,
)
from heavylift.pipeline.case.mesh_loads import FrameLoad, MeshDampingSection, ShellLoad
from heavylift.pipeline.case.mesh_supports import FrameSupportSection, ShellSupportSection
from heavylift.solver.scene.meshes import FrameBody, ShellBody

__all__ = ["Body", "FrameBodySection", "MeshBodySection", "ShellBodySection"]


class MeshBodySection(Section):
    """What frames and shells have."""

    damping: MeshDampingSection = Field(default_factory=MeshDampingSection)
    """Damping; none if absent."""
    elasticity: Literal["auto", "carried", "energy-momentum", "explicit"] = "auto"
    """How stress enters the step: ``carried`` carries strains, one linear solve a step; ``energy-momentum`` iterates;
    ``auto`` is the first until carried strains drift too far; ``explicit`` has a largest stable step."""
    drift_tolerance: Annotated[float, Positive("number")] = 1e-3
    """Distance of carried strains from those of the shape at which ``auto`` changes over."""
    initial: RigidInitialSection = Field(default_factory=RigidInitialSection)
    """Initial state: place of the body, and its motion as a rigid body."""


class FrameBodySection(MeshBodySection):
    """A beam, cable or rod of cubic elements with large displacements and rotations; it has no torsion."""

    CHANNELS: ClassVar = FrameBody.CHANNELS

    type: Literal["frame"]
    geometry: FrameGeometry
    """Its line and its elements."""
    section: FrameSectionTable
    """Section of all elements that are in no region."""
    sections: dict[Name, FrameSectionTable] = Field(default_factory=dict)
    """Further sections by name, for `regions`."""
    regions: tuple[FrameRegionSection, ...] = ()
    """Elements with other sections or pre-stress."""
    model: Literal["green-lagrange", "exact"] = "green-lagrange"
    """``green-lagrange``: axial strain of Green-Lagrange, for straight elements; ``exact``: stretch and material
    curvature, also for curved elements and large strains."""
    axial_force: Annotated[float, Quantity("force")] | None = None
    """Tension in the given shape [N]: it is pre-stressed."""
    axial_strain: Annotated[float, Quantity("number")] | None = None
    """In place of `axial_force`, the strain in the given shape."""
    supports: tuple[FrameSupportSection, ...] = ()
    """What holds it to the ground."""
    loads: tuple[FrameLoad, ...] = ()
    """Loads on its elements, besides gravity and forces on points."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        check_regions(self.regions, self.sections)
        if self.axial_force is not None and self.axial_strain is not None:
            reject("both 'axial_force' and 'axial_strain'", "one of them", key="axial_strain")
        if self.model == "green-lagrange" and self.geometry.type == "arc":
            reject(
                "model 'green-lagrange' with geometry 'arc'",
                "model 'exact': the elements are curved",
                key="model",
            )
        return self


class ShellBodySection(MeshBodySection):
    """A plate, shell or membrane of bicubic elements with large displacements and rotations, flat when unloaded."""

    CHANNELS: ClassVar = ShellBody.CHANNELS

    type: Literal["shell"]
    geometry: ShellGeometry
    """Its outline and its elements."""
    section: ShellSectionTable
    """Section of all elements that are in no region."""
    sections: dict[Name, ShellSectionTable] = Field(default_factory=dict)
    """Further sections by name, for `regions`."""
    regions: tuple[RegionSection, ...] = ()
    """Elements with other sections."""
    gauss_points: Annotated[int, Field(ge=3, le=7, strict=True)] = 5
    """Points along each direction of an element where membrane strains are taken, 3 to 7."""
    supports: tuple[ShellSupportSection, ...] = ()
    """What holds it to the ground."""
    loads: tuple[ShellLoad, ...] = ()
    """Loads on its elements, besides gravity and forces on points."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        check_regions(self.regions, self.sections)
        return self


Body = Annotated[
    FlexibleBodySection | RigidBodySection | FrameBodySection | ShellBodySection,
    Field(discriminator="type"),
]
