"""Tables of a case file that describe surfaces of triangles: CAD files and simple shapes on bodies, for collision."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from pathlib import PurePath
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.channel_kinds import MESH_TYPES
from heavylift.pipeline.case.contacts import TurnSection
from heavylift.pipeline.case.described import Chosen, section_of
from heavylift.pipeline.case.fields import (
    CaseContext,
    InFolder,
    LengthVector,
    Positive,
    Quantity,
    Section,
    SideName,
    UniqueName,
    reject,
)
from heavylift.pipeline.shapes.shape import SHAPES, Exclusion

__all__ = ["SurfaceSection"]

Length = Annotated[float, Positive("length")]

_WITH_UNIT = frozenset({".step", ".stp", ".iges", ".igs"})
"""CAD files that carry their unit of length."""
_CAD = _WITH_UNIT | {".brep"}
"""Files whose faces are meshed."""

ExclusionSection: Any = section_of(Exclusion)

OWN_SURFACE = {**dict.fromkeys(MESH_TYPES, "facets"), "flexible": "exclude"}
"""Types of bodies that touch with their own surface, and the key that says more of it."""


class SurfaceSection(Section):
    """Triangles that move with a body: from a file, a simple shape, or of a body that deforms its own surface."""

    name: UniqueName
    """Name; collisions are between names of surfaces."""
    body: SideName
    """Body that it belongs to, or ``"ground"``."""
    file: Annotated[str, InFolder()] | None = None
    """STL, OBJ, PLY, STEP, IGES, BREP or mesh file in the case folder."""
    unit: Literal["m", "mm"] | None = None
    """Length unit of the coordinates in the file; m if absent. STEP and IGES carry their own."""
    size: Length | None = None
    """Of a CAD file: edge length of the triangles on its faces [m]; a twentieth of its extent if absent."""
    shape: Annotated[Any, Chosen(SHAPES)] | None = None
    """In place of `file`: a simple shape."""
    at: LengthVector = (0.0, 0.0, 0.0)
    """Where the origin of the file or shape is, in the coordinates of the geometry; of the ground in the world [m]."""
    turned: TurnSection | None = None
    """How it is turned about its origin from the axes of the body; not at all if absent."""
    radius: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Rounding [m]: everything at this distance from the triangles of a file or plane is its surface, as half the
    thickness of a plate; of a box or cylinder the radius of its edges, within its size."""
    exclude: tuple[ExclusionSection, ...] = ()
    """Boxes whose triangles take no part; of a flexible body in the coordinates of its geometry, undeformed."""
    facets: Annotated[int, Field(ge=1, le=32, strict=True)] | None = None
    """Of a frame or shell: facets along each side of an element; 2 if absent."""

    @model_validator(mode="after")
    def _has_one_source(self, info: ValidationInfo) -> Self:
        context = CaseContext.of(info)
        if context is None:  # the body may be a surface itself
            return self
        owner = context.names.body_types.get(self.body, "")
        if owner in OWN_SURFACE:
            self._is_its_own(owner)
            return self
        if (self.file is None) == (self.shape is None):
            problem = "neither 'file' nor 'shape'" if self.file is None else "both 'file' and 'shape'"
            reject(problem, "one of them")
        if self.facets is not None:
            reject(f"'facets' of {self.body!r}", "a frame or shell, or no 'facets'", key="facets")
        for key in ("unit", "size"):
            if self.file is None and getattr(self, key) is not None:
                reject(f"{key!r} with 'shape'", f"'file', or no {key!r}", key=key)
        suffix = PurePath(self.file or "").suffix.lower()
        if self.size is not None and suffix not in _CAD:
            reject(f"'size' with {self.file!r}", "a STEP, IGES or BREP file, or no 'size'", key="size")
        if self.unit is not None and suffix in _WITH_UNIT:
            reject(f"'unit' with {self.file!r}, which carries its own", "no 'unit'", key="unit")
        self._rounds_something()
        return self

    def _is_its_own(self, owner: str) -> None:
        """A body that deforms is its own surface: a frame or shell in facets, a flexible body that of its elements."""
        own = OWN_SURFACE[owner]
        for key in sorted(self.model_fields_set - {"name", "body", own}):
            reject(
                f"{key!r} of the {owner} {self.body!r}",
                f"no {key!r}: its own surface takes part, with {own!r} at most",
                key=key,
            )

    def _rounds_something(self) -> None:
        """Spheres and capsules are round themselves; boxes and cylinders have a core within their rounding."""
        shape = self.shape
        if shape is None or self.radius == 0.0:
            return
        if shape.DESCRIBED.ROUND:
            reject(f"'radius' with shape {shape.type!r}", "the radius of the shape alone", key="radius")
        size = shape.DESCRIBED.smallest(shape)
        if self.radius >= 0.5 * size:
            reject(
                f"{self.radius:g} m rounds all of the shape off",
                f"less than {0.5 * size:g} m, half of its smallest size",
                key="radius",
            )

    @field_validator("exclude")
    @classmethod
    def _excludes_triangles(cls, value: tuple[Any, ...], info: ValidationInfo) -> object:
        shape = info.data.get("shape")
        if value and shape is not None and shape.DESCRIBED.ROUND:
            reject(f"'exclude' with shape {shape.type!r}, which has no triangles", "no 'exclude'")
        return value
