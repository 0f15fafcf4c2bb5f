"""Tables of a case file that describe the shape, the sections and the meshes of frames and shells."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import math
from collections import Counter
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from heavylift.pipeline.case.fields import (
    Direction,
    InFolder,
    LengthVector,
    Name,
    Positive,
    Quantity,
    Section,
    is_parallel,
    refuse_unknown,
    reject,
)
from heavylift.pipeline.case.geometry import BoxGroup

__all__ = [
    "ArcGeometry",
    "ElementNumber",
    "FrameGeometry",
    "FrameRegionSection",
    "FrameSectionTable",
    "GridGeometry",
    "LineGeometry",
    "MeshFiles",
    "QuadrilateralGeometry",
    "RectangleGeometry",
    "RegionSection",
    "ShellGeometry",
    "ShellSectionTable",
    "SplineGeometry",
    "check_regions",
    "counts_of",
]

Count = Annotated[int, Field(ge=1, strict=True)]
ElementNumber = Annotated[int, Field(ge=0, strict=True)]
Angle = Annotated[float, Quantity("angle")]


def _count_kind(value: object) -> str:
    return "two numbers" if isinstance(value, (list, tuple)) else "one number"


Counts = Annotated[
    Annotated[Count, Tag("one number")] | Annotated[tuple[Count, Count], Tag("two numbers")],
    Discriminator(_count_kind),
]
"""Elements along x and y of a mesh; one number is both."""


class LineGeometry(Section):
    """A straight line, cut into equal elements."""

    type: Literal["line"]
    start: LengthVector
    """First end, in the frame of the body [m]."""
    end: LengthVector
    """Second end [m]."""
    elements: Count
    """Number of elements."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        if self.start == self.end:
            reject(f"'start' and 'end' are both {list(self.start)} m", "two different points", key="end")
        return self


class ArcGeometry(Section):
    """An arc of a circle, cut into equal elements."""

    type: Literal["arc"]
    centre: LengthVector = (0.0, 0.0, 0.0)
    """Centre of the circle, in the frame of the body [m]."""
    radius: Annotated[float, Positive("length")]
    """[m]."""
    first: Angle = Field(default=0.0, alias="from")
    """Angle of the first end from `reference` on, about `normal` [rad]."""
    last: Angle = Field(alias="to")
    """Angle of the second end [rad]."""
    normal: Direction = (0.0, 0.0, 1.0)
    """Normal of its plane, any length."""
    reference: Direction = (1.0, 0.0, 0.0)
    """Direction from the centre where the angle is zero; its part in the plane counts."""
    elements: Count
    """Number of elements."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        if self.first == self.last:
            reject(f"'from' and 'to' are both {self.first:g} rad", "two different angles", key="to")
        if abs(self.last - self.first) > 2.0 * math.pi * (1.0 + 1e-12):
            reject(f"{self.last - self.first:g} rad from end to end", "a circle at most", key="to")
        if is_parallel(self.normal, self.reference):
            reject("is parallel to 'normal'", "a direction across it", key="reference")
        return self


class SplineGeometry(Section):
    """A smooth curve through points, cut into elements of equal length, or at the points."""

    type: Literal["spline"]
    points: tuple[LengthVector, ...] = ()
    """Points on the curve, in the frame of the body [m]; two and more."""
    file: Annotated[str, InFolder()] | None = None
    """In place of `points`, a file in the case folder: lines ``x,y,z`` [m]; ``#`` begins a comment."""
    elements: Count | None = None
    """Number of elements; the points are the nodes if absent."""

    @model_validator(mode="after")
    def _has_points(self) -> Self:
        _check_points(self.points, self.file)
        if self.file is None and len(self.points) < 2:
            reject(f"{len(self.points)} points", "two and more points", key="points")
        return self


FrameGeometry = Annotated[LineGeometry | ArcGeometry | SplineGeometry, Field(discriminator="type")]


class RectangleGeometry(Section):
    """A rectangle in the x-y plane of the body, its corner ``x_min y_min`` at the origin, cut into equal elements."""

    type: Literal["rectangle"]
    size: tuple[Annotated[float, Positive("length")], Annotated[float, Positive("length")]]
    """Along x and y [m]."""
    elements: Counts
    """Elements along x and y; one number is both."""


class QuadrilateralGeometry(Section):
    """A plane quadrilateral with straight edges, cut into as many parts on opposite edges."""

    type: Literal["quadrilateral"]
    corners: tuple[LengthVector, LengthVector, LengthVector, LengthVector]
    """Corners ``x_min y_min``, ``x_max y_min``, ``x_max y_max``, ``x_min y_max``, in the frame of the body [m]."""
    elements: Counts
    """Elements along x and y; one number is both."""


class GridGeometry(Section):
    """A plane mesh of quadrilaterals through given points."""

    type: Literal["grid"]
    points: tuple[LengthVector, ...] = ()
    """Nodes row after row, x running first, in the frame of the body [m]."""
    file: Annotated[str, InFolder()] | None = None
    """In place of `points`, a file in the case folder: lines ``x,y,z`` [m]; ``#`` begins a comment."""
    elements: Counts
    """Elements along x and y; one more point than this in each direction."""

    @model_validator(mode="after")
    def _has_points(self) -> Self:
        _check_points(self.points, self.file)
        nx, ny = counts_of(self.elements)
        if self.file is None and len(self.points) != (nx + 1) * (ny + 1):
            reject(
                f"{len(self.points)} points for {nx} x {ny} elements",
                f"{(nx + 1) * (ny + 1)}, one more than elements in each direction",
                key="points",
            )
        return self


ShellGeometry = Annotated[
    RectangleGeometry | QuadrilateralGeometry | GridGeometry, Field(discriminator="type")
]
MeshFiles = SplineGeometry | GridGeometry
"""Geometries that may name a file."""


def counts_of(elements: int | tuple[int, int]) -> tuple[int, int]:
    """Elements along x and y."""
    return (elements, elements) if isinstance(elements, int) else elements


def _check_points(points: tuple[Any, ...], file: str | None) -> None:
    if bool(points) == (file is not None):
        reject("both 'points' and 'file'" if points else "neither 'points' nor 'file'", "one of them")


class _MaterialTable(Section):
    """What every section is made of."""

    density: Annotated[float, Positive("density")]
    """[kg/m^3]."""
    young_modulus: Annotated[float, Positive("pressure")]
    """Young's modulus [Pa]."""


class FrameSectionTable(_MaterialTable):
    """Cross-section and material of a frame: round, a tube, square, or by its numbers."""

    diameter: Annotated[float, Positive("length")] | None = None
    """Outer diameter of a round section [m]."""
    wall: Annotated[float, Positive("length")] | None = None
    """With `diameter`, thickness of the wall of a tube [m]; solid if absent."""
    side: Annotated[float, Positive("length")] | None = None
    """Of a square section [m]; it bends the same about all axes."""
    area: Annotated[float, Positive("area")] | None = None
    """[m^2]."""
    second_moment: Annotated[float, Quantity("second moment of area", minimum=0.0, closed=True)] | None = None
    """With `area`: second moment of area, the same about all axes [m^4]; 0 for a cable."""
    outer_fibre: Annotated[float, Quantity("length", minimum=0.0, closed=True)] | None = None
    """With `area`: distance of the outermost fibre from the axis [m], for bending stresses; 0 if absent."""

    @model_validator(mode="after")
    def _is_one_shape(self) -> Self:
        given = [key for key in ("diameter", "side", "area") if getattr(self, key) is not None]
        shapes = "'diameter' (and 'wall'), 'side', or 'area' and 'second_moment'"
        if len(given) != 1:
            words = f"both {given[0]!r} and {given[1]!r}" if given else "no shape"
            reject(words, f"one of {shapes}")
        for key, owner in (("wall", "diameter"), ("second_moment", "area"), ("outer_fibre", "area")):
            if getattr(self, key) is not None and given != [owner]:
                reject(f"{key!r} with {given[0]!r}", f"{key!r} with {owner!r}", key=key)
        if given == ["area"] and self.second_moment is None:
            reject("'area' without 'second_moment'", "both, or 'diameter' or 'side'", key="second_moment")
        if self.diameter is not None and self.wall is not None and self.wall > 0.5 * self.diameter:
            reject(
                f"wall = {self.wall:g} m exceeds the radius", f"{0.5 * self.diameter:g} m at most", key="wall"
            )
        return self

    @property
    def numbers(self) -> tuple[float, float, float]:
        """Area [m2], second moment of area [m4], distance of the outermost fibre [m]."""
        if self.diameter is not None:
            outer = 0.5 * self.diameter
            inner = 0.0 if self.wall is None else outer - self.wall
            return math.pi * (outer**2 - inner**2), 0.25 * math.pi * (outer**4 - inner**4), outer
        if self.side is not None:
            return self.side**2, self.side**4 / 12.0, 0.5 * self.side
        assert self.area is not None
        assert self.second_moment is not None
        return self.area, self.second_moment, self.outer_fibre or 0.0


class ShellSectionTable(_MaterialTable):
    """Thickness and material of a shell."""

    thickness: Annotated[float, Positive("length")]
    """[m]."""
    poisson_ratio: Annotated[float, Quantity("number", minimum=-1.0, maximum=0.5)]
    """Poisson's ratio, between -1 and 0.5."""


class RegionSection(Section):
    """Elements with another section than the others; of several regions with an element the last one counts."""

    elements: tuple[ElementNumber, ...] = ()
    """Their numbers, from 0; those of a shell count along y first, or along x if it has fewer elements."""
    box: BoxGroup | None = None
    """In place of `elements`: those whose centres are in a box, in the frame of the body."""
    section: Name
    """Name of one of the `sections` of the body."""

    @model_validator(mode="after")
    def _has_elements(self) -> Self:
        if bool(self.elements) == (self.box is not None):
            words = "both 'elements' and 'box'" if self.elements else "neither 'elements' nor 'box'"
            reject(words, "one of them")
        return self

    @field_validator("elements")
    @classmethod
    def _are_different(cls, value: tuple[int, ...]) -> tuple[int, ...]:
        number, times = max(Counter(value).items(), key=lambda item: item[1], default=(0, 1))
        if times > 1:
            reject(f"element {number} occurs {times} times", "each element once")
        return value


class FrameRegionSection(RegionSection):
    """Elements of a frame with another section or another pre-stress than the others; the last region counts."""

    section: Name | None = None  # type: ignore[assignment]
    """Name of one of the `sections` of the body; as without the region if absent."""
    axial_strain: Annotated[float, Quantity("number")] | None = None
    """Strain in the given shape; as that of the body if absent."""

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.section is None and self.axial_strain is None:
            reject("neither 'section' nor 'axial_strain'", "one of them, or both")
        return self


def check_regions(regions: tuple[RegionSection, ...], sections: dict[str, Any]) -> None:
    """Regions name sections that the body has."""
    for index, region in enumerate(regions):
        if region.section is not None:
            refuse_unknown("section", region.section, sections, key=f"regions.{index}.section")
