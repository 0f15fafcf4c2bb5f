"""Tables of a case file for panels: plates, stiffeners, openings and lugs of a flexible body."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from heavylift.pipeline.case.fields import (
    Direction,
    InFolder,
    LengthVector,
    Name,
    Positive,
    Quantity,
    Section,
    reject,
)
from heavylift.pipeline.case.geometry import Count, GroupField, MaterialSection

__all__ = [
    "LugSection",
    "OpeningSection",
    "PanelsGeometry",
    "PlateSection",
    "ProfileSection",
    "StiffenerSection",
]

Length = Annotated[float, Positive("length")]


def _one_or_more(value: Any) -> Any:
    """A single vector as a list of one."""
    single = isinstance(value, (list, tuple)) and value and not isinstance(value[0], (list, tuple))
    return [value] if single else value


def _one_or_more_numbers(value: Any) -> Any:
    """A single number as a list of one."""
    return value if isinstance(value, (list, tuple)) else [value]


Steps = Annotated[
    tuple[LengthVector, ...],
    BeforeValidator(_one_or_more, json_schema_input_type=LengthVector | list[LengthVector]),
]
Counts = Annotated[
    tuple[Count, ...], BeforeValidator(_one_or_more_numbers, json_schema_input_type=Count | list[Count])
]
_Place = Annotated[float, Quantity("length")]
Places = Annotated[
    tuple[_Place, ...], BeforeValidator(_one_or_more_numbers, json_schema_input_type=_Place | list[_Place])
]


class _Repeated(Section):
    """What stands several times, shifted by steps."""

    step: Steps = ()
    """Shift from one copy to the next [m], or a list of shifts that multiply each other."""
    count: Counts = ()
    """Copies of each step, the first included."""

    @model_validator(mode="after")
    def _counts_the_steps(self) -> Self:
        if len(self.step) != len(self.count):
            reject(f"{len(self.step)} steps and {len(self.count)} counts", "one count a step", key="count")
        return self


class OpeningSection(Section):
    """An opening in a plate: round, or oblong with round ends."""

    centre: LengthVector
    """Centre, in the plane of the plate [m]."""
    diameter: Length | None = None
    """Of a round opening [m]."""
    width: Length | None = None
    """Of an oblong opening, along its direction [m]."""
    height: Length | None = None
    """Of an oblong opening, across its direction [m]."""
    direction: Direction | None = None
    """Of the width of an oblong opening."""
    step: Steps = ()
    """Shift from one copy to the next [m], or a list of shifts that multiply each other."""
    count: Counts = ()
    """Copies of each step, the first included."""

    @model_validator(mode="after")
    def _is_round_or_oblong(self) -> Self:
        oblong = (self.width, self.height, self.direction)
        if (self.diameter is None) == (None in oblong):
            reject(
                "neither round nor oblong", "'diameter', or 'width', 'height' and 'direction'", key="diameter"
            )
        if self.diameter is not None and any(value is not None for value in oblong):
            reject(
                "both round and oblong", "'diameter', or 'width', 'height' and 'direction'", key="diameter"
            )
        if len(self.step) != len(self.count):
            reject(f"{len(self.step)} steps and {len(self.count)} counts", "one count a step", key="count")
        return self


class PlateSection(_Repeated):
    """Plane plates of one thickness: a polygon and its copies, or faces of the file of the geometry."""

    thickness: Length
    """Thickness [m]."""
    corners: tuple[LengthVector, ...] = ()
    """Corners of the polygon [m]; anticlockwise seen from the side that the normal points to."""
    faces: tuple[str, ...] = ()
    """Labels of faces of the file, or ``"face NUMBER"``."""
    across: Direction | None = None
    """Or its faces in planes across this direction, which is their normal."""
    at: Places = ()
    """Distances of these planes from the origin along the direction [m]; all of them by default."""
    offset: Annotated[float, Quantity("length")] = 0.0
    """From corners or faces to the mid-surface, along the normal [m]."""
    nonstructural_mass: Annotated[float, Quantity("mass per area", minimum=0.0, closed=True)] = 0.0
    """Outfit, paint and weld metal [kg/m^2]."""
    material: MaterialSection | None = None
    """Material, where it is not that of the body."""
    openings: tuple[OpeningSection, ...] = ()
    """Openings, each in one plate of the group."""

    @model_validator(mode="after")
    def _is_somewhere(self) -> Self:
        chosen = bool(self.faces) or self.across is not None
        if chosen == bool(self.corners):
            reject(
                "neither corners nor faces" if not chosen else "both corners and faces",
                "'corners', or 'faces' or 'across' with the file of the geometry",
                key="corners",
            )
        if self.corners and len(self.corners) < 3:
            reject(f"{len(self.corners)} corners", "three or more", key="corners")
        if self.at and self.across is None:
            reject("'at' without 'across'", "the direction of the normal of these planes", key="across")
        if chosen and self.step:
            reject("'step' of faces of a file", "'corners'", key="step")
        if chosen and self.openings:
            reject("openings in faces of a file", "openings in its faces, or 'corners'", key="openings")
        return self


class ProfileSection(Section):
    """Section of a stiffener or beam."""

    shape: Literal["flat", "bulb", "angle", "tee", "round", "tube", "box", "channel", "h"]
    """``flat`` bar, ``bulb`` flat, ``angle``, ``tee``; ``round`` bar, ``tube``, ``box``, ``channel``, ``h`` beam."""
    height: Length | None = None
    """Of the whole section along its web [m]."""
    thickness: Length | None = None
    """Of the web, or of the wall [m]."""
    width: Length | None = None
    """Of the flanges, or of the box [m]."""
    flange_thickness: Length | None = None
    """Of the flanges, or of the walls of a box across its web [m]."""
    diameter: Length | None = None
    """Outer diameter of a round bar or tube [m]."""

    def measures(self) -> dict[str, float]:
        """Measures of the shape [m]."""
        return {key: getattr(self, key) for key in _MEASURES[self.shape]}

    @model_validator(mode="after")
    def _has_its_measures(self) -> Self:
        needed = _MEASURES[self.shape]
        given = {key for key in type(self).model_fields if key != "shape" and getattr(self, key) is not None}
        if given != set(needed):
            wrong = sorted(given ^ set(needed))
            reject(
                f"{', '.join(wrong)} {'is' if len(wrong) == 1 else 'are'} missing or too many for shape {self.shape!r}",
                ", ".join(needed),
                key=wrong[0],
            )
        return self


_WEB = ("height", "thickness", "width", "flange_thickness")
_MEASURES = {
    "flat": ("height", "thickness"),
    "bulb": ("height", "thickness"),
    "angle": _WEB,
    "tee": _WEB,
    "channel": _WEB,
    "h": _WEB,
    "box": _WEB,
    "round": ("diameter",),
    "tube": ("diameter", "thickness"),
}


class StiffenerSection(_Repeated):
    """Beams along a line and its copies, welded to a plate by their web or standing alone."""

    line: Annotated[tuple[LengthVector, ...], Field(min_length=2, max_length=2)]
    """Both ends [m]."""
    section: ProfileSection
    """Shape and measures of the section."""
    plate: Name | None = None
    """Plate that the line lies in; none for a beam whose centroid is on the line."""
    web: Direction
    """Direction of the web, away from the plate."""
    flange: Direction | None = None
    """Direction in which the flange of an angle or the bulb points; any by default."""
    material: MaterialSection | None = None
    """Material, where it is not that of the body."""


class LugSection(Section):
    """A lug with a pin hole on a plate; its name is that of the interface at the centre of the hole."""

    foot: LengthVector
    """Middle of its foot, on a plate [m]."""
    along: Direction
    """Direction of the foot."""
    normal: Direction
    """Away from the plate."""
    thickness: Length
    """Thickness [m]."""
    length: Length
    """Of the foot [m]."""
    height: Length
    """Of the centre of the hole above the plate [m]."""
    radius: Length
    """Of the round end about the hole [m]."""
    hole: Length
    """Diameter of the pin hole [m]."""
    bracket: Length | None = None
    """Reach of brackets to both sides [m]; none by default."""
    material: MaterialSection | None = None
    """Material, where it is not that of the body."""

    @model_validator(mode="after")
    def _has_a_rim(self) -> Self:
        if self.hole >= 2.0 * self.radius:
            reject(f"{self.hole:g} m", f"less than twice the radius of {self.radius:g} m", key="hole")
        if self.radius >= self.height:
            reject(f"{self.radius:g} m", f"less than the height of {self.height:g} m", key="radius")
        return self


class PanelsGeometry(Section):
    """Plates with stiffeners, openings and lugs, meshed with shells and beams."""

    type: Literal["panels"]
    plates: Annotated[dict[Name, PlateSection], Field(min_length=1)]
    """Plates by name, which are the plate groups of the report."""
    stiffeners: dict[Name, StiffenerSection] = Field(default_factory=dict)
    """Stiffeners and beams by name."""
    lugs: dict[Name, LugSection] = Field(default_factory=dict)
    """Lugs by name."""
    file: Annotated[str, InFolder()] | None = None
    """STEP file of surfaces in the case folder, whose faces plates choose."""
    scale: Annotated[float, Quantity("number", minimum=0.0)] = 1.0
    """Factor of its lengths: 1000 for a file in metres whose header says millimetres."""
    groups: dict[Name, GroupField] = Field(default_factory=dict)
    """Groups of nodes, in addition to those of plates, stiffeners and lugs."""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        for name, plate in self.plates.items():
            if (self.file is None) != bool(plate.corners):
                reject(
                    "faces without a file" if self.file is None else "corners beside a file",
                    "'corners', or 'faces' or 'across' with 'file' in the geometry",
                    key=f"plates.{name}",
                )
        for name, one in self.stiffeners.items():
            if one.plate is not None and one.plate not in self.plates:
                reject(
                    f"plate {one.plate!r} is unknown",
                    "one of " + ", ".join(map(repr, self.plates)),
                    key=f"stiffeners.{name}.plate",
                )
        names = [*self.plates, *self.stiffeners, *self.lugs, *self.groups]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            reject(f"{twice[0]!r} is given twice", "one plate, stiffener, lug or group a name")
        return self
