"""Tables of a case file that describe contours: curves and surfaces of bodies that something may touch.

The points of a contour come from one place: nodes of a flexible body (`nodes`, `face`, `line`, `circle`), given points
of a rigid body or the ground (`points`, `file`, `circle`, `spline`), or none for the shape of a frame or shell itself.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from heavylift.contours.splines.limits import LARGEST_DEGREE
from heavylift.pipeline.case.fields import (
    GROUND,
    CaseContext,
    Direction,
    InFolder,
    LengthVector,
    Name,
    Positive,
    Quantity,
    Section,
    SideName,
    reject,
)

__all__ = [
    "BandContourSection",
    "CircleSection",
    "Contour",
    "CurveContourSection",
    "CurveSplineSection",
    "CylinderContourSection",
    "FaceSection",
    "LineSection",
    "SurfaceContourSection",
    "SurfaceSplineSection",
]

SMALLEST_DEGREE = 3
"""A contour has a continuous curvature, or sliding bodies get an impulse at every knot."""

Parametrisation = Literal["chord", "centripetal", "uniform"]
Weight = Annotated[float, Positive("number")]
Number = Annotated[float, Quantity("number")]


def _smooth(value: Any) -> Any:
    """Refuse a degree that is no integer, or gives no continuous curvature."""
    if isinstance(value, bool) or not isinstance(value, int):
        reject(f"{value!r} is not an integer", f"an integer from {SMALLEST_DEGREE} to {LARGEST_DEGREE}")
    if value < SMALLEST_DEGREE:
        reject(
            f"degree {value} has no continuous curvature, and sliding bodies get an impulse at every knot",
            f"{SMALLEST_DEGREE} to {LARGEST_DEGREE}",
        )
    if value > LARGEST_DEGREE:
        reject(f"degree {value} is too large", f"{SMALLEST_DEGREE} to {LARGEST_DEGREE}")
    return value


def _twice(value: Any) -> Any:
    """One value as that of both directions."""
    return value if isinstance(value, (list, tuple)) else [value, value]


def _both_open(value: Any) -> Any:
    """``false`` as that of both directions; ``true`` does not say which."""
    if value is True:
        reject("true does not give the direction", "[true, false], [false, true] or [true, true]")
    return [False, False] if value is False else value


Degree = Annotated[int, Field(ge=SMALLEST_DEGREE, le=LARGEST_DEGREE), BeforeValidator(_smooth)]
Degrees = Annotated[
    tuple[Degree, Degree], BeforeValidator(_twice, json_schema_input_type=Degree | list[Degree])
]
Closed = Annotated[bool, Field(strict=True)]
BothClosed = Annotated[
    tuple[Closed, Closed], BeforeValidator(_both_open, json_schema_input_type=bool | list[bool])
]


class FaceSection(Section):
    """Nodes of a face of the mesh, which make a grid."""

    on: Name | None = None
    """Group of the geometry that holds the nodes of the face."""
    plane: Literal["x", "y", "z"] | None = None
    """In place of `on`: axis that the face is normal to."""
    at: Annotated[float, Quantity("length")] | None = None
    """With `plane`: coordinate of the face [m]."""
    lower: LengthVector | None = Field(default=None, alias="from")
    """Corner of a box with the smallest coordinates [m]; nodes outside of the box are left out."""
    upper: LengthVector | None = Field(default=None, alias="to")
    """Corner of a box with the largest coordinates [m]."""

    @model_validator(mode="after")
    def _is_one_face(self) -> Self:
        if (self.plane is None) != (self.at is None):
            given, absent = ("plane", "at") if self.at is None else ("at", "plane")
            reject(f"{given!r} without {absent!r}", "'plane' and 'at'", key=absent)
        if (self.on is None) == (self.plane is None):
            problem = "neither 'on' nor 'plane'" if self.on is None else "both 'on' and 'plane'"
            reject(problem, "'on' (a group of the geometry), or 'plane' and 'at'")
        if (self.lower is None) != (self.upper is None):
            given, absent = ("from", "to") if self.upper is None else ("to", "from")
            reject(f"{given!r} without {absent!r}", "both, or the whole face", key=absent)
        lower, upper = self.lower or (), self.upper or ()
        if any(a > b for a, b in zip(lower, upper, strict=True)):
            expected = f"no smaller than 'from' = {list(lower)} m in any direction"
            reject(f"corner {list(upper)} m", expected, key="to")
        return self


class LineSection(Section):
    """Nodes of the mesh on a straight line, in order."""

    start: LengthVector = Field(alias="from")
    """First end, in the coordinates of the geometry [m]."""
    end: LengthVector = Field(alias="to")
    """Second end [m]."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        if self.start == self.end:
            reject(f"'from' and 'to' are both {list(self.start)} m", "two different points", key="to")
        return self


class CircleSection(Section):
    """A circle: points on it, or the nodes of a flexible body that lie on it."""

    centre: LengthVector = (0.0, 0.0, 0.0)
    """In the coordinates of the geometry; of the ground in the world [m]."""
    axis: Direction
    """Normal of its plane, any length."""
    radius: Annotated[float, Positive("length")]
    """[m]."""
    points: Annotated[int, Field(ge=8, le=10_000, strict=True)] | None = None
    """Of a rigid body or the ground: number of points of the curve; 48 if absent. Between them it deviates from
    the circle by about 4 / points^4 of the radius."""


class CurveSplineSection(Section):
    """A curve of another program, as B-spline or NURBS."""

    degree: Degree = 3
    """At least 3."""
    knots: Annotated[tuple[Number, ...], Field(min_length=2)]
    """Not decreasing, the first and the last degree + 1 of them equal; of a closed curve evenly continued, as many as
    control points + 2 degree + 1."""
    control: Annotated[tuple[LengthVector, ...], Field(min_length=2)]
    """Control points, in the coordinates of the geometry; of the ground in the world [m]."""
    weights: tuple[Weight, ...] = ()
    """Rational weights, one a control point; all 1 if absent."""


class SurfaceSplineSection(Section):
    """A surface of another program, as B-spline or NURBS."""

    degree: Degrees = (3, 3)
    """Of both directions, at least 3."""
    knots: tuple[
        Annotated[tuple[Number, ...], Field(min_length=2)], Annotated[tuple[Number, ...], Field(min_length=2)]
    ]
    """Of both directions, as those of a curve."""
    control: Annotated[tuple[tuple[LengthVector, ...], ...], Field(min_length=2)]
    """Rows of control points, along the second direction each [m]."""
    weights: tuple[tuple[Weight, ...], ...] = ()
    """Rational weights in the same rows; all 1 if absent."""


class _ContourSection(Section):
    """What all contours have."""

    type: str
    """What it is."""
    body: SideName
    """Body that it belongs to, or ``"ground"``."""
    nodes: Annotated[str, InFolder()] | None = None
    """Of a flexible body: a file in the case folder with a matrix of numbers of nodes, from 1: ``[1,2,3;4,5,6]``."""
    file: Annotated[str, InFolder()] | None = None
    """In place of `points`, a file in the case folder: lines ``x,y,z`` [m]; ``#`` begins a comment."""
    parametrisation: Parametrisation = "chord"
    """How parameters are given to the points: by their distances, the roots of these, or all alike."""

    def check_source(self, info: ValidationInfo, keys: dict[str, str]) -> None:
        """One source of points, which suits the body; `keys` maps those there are to ``"flexible"``, ``"rigid"``."""
        given = [key for key in keys if getattr(self, key) not in (None, ())]
        if len(given) > 1:
            reject(f"both {given[0]!r} and {given[1]!r}", f"one of {', '.join(keys)}")
        context = CaseContext.of(info)
        if context is None:
            return
        owner = context.names.body_types.get(self.body, "rigid" if self.body == GROUND else "")
        if owner == "rod":
            reject(
                f"a contour on the rod {self.body!r}",
                "a contour on a body of type 'frame': contacts push at an axis, which does not turn with them",
                key="body",
            )
        if owner in {"frame", "shell"}:
            self._check_own_shape(owner, given)
            return
        words = "the ground" if self.body == GROUND else f"the {owner} body {self.body!r}"
        allowed = [key for key, owners in keys.items() if owner in owners]
        if allowed and not given:
            reject(f"no points of {words}", f"one of {', '.join(allowed)}")
        if allowed and given[0] not in allowed:
            reject(f"{given[0]!r} of {words}", f"one of {', '.join(allowed)}", key=given[0])

    def _check_own_shape(self, owner: str, given: list[str]) -> None:
        """A frame or shell is its own contour: a curve or a surface."""
        words = f"the {owner} {self.body!r}"
        if (owner == "shell") != (self.type == "surface"):
            expected = "'surface'" if owner == "shell" else "'curve', 'cylinder' or 'band'"
            reject(f"type {self.type!r} of {words}", expected, key="type")
        for key in (*given, *sorted(self.model_fields_set & {"degree", "closed", "parametrisation"})):
            reject(f"{key!r} of {words}", f"no {key!r}: its own shape is the contour", key=key)

    def check_fit(self, spline: Any, keys: tuple[str, ...]) -> None:
        """What says how points are fitted has no meaning for a spline that is given."""
        for key in keys:
            if spline is not None and key in self.model_fields_set:
                reject(f"{key!r} with 'spline'", f"{key!r} of the spline, or none", key=key)


class SurfaceContourSection(_ContourSection):
    """A surface: what touches it is on the side of its normal."""

    type: Literal["surface"]
    face: FaceSection | None = None
    """Of a flexible body: nodes of a face of its mesh."""
    points: Annotated[tuple[tuple[LengthVector, ...], ...], Field(min_length=2)] | None = None
    """Of a rigid body or the ground: rows of points, along the second direction each, in the coordinates of the
    geometry; of the ground in the world [m]."""
    columns: Annotated[int, Field(ge=2, strict=True)] | None = None
    """With `file`: number of points in a row."""
    spline: SurfaceSplineSection | None = None
    """Of a rigid body or the ground: a surface of another program."""
    degree: Degrees = (3, 3)
    """One number for both directions, or two; at least 3."""
    closed: BothClosed = (False, False)
    """Whether the last row follows upon the first one, and so for columns: of tubes and rings."""
    flip: bool = False
    """Turn the normal round: it is along (derivative by the first) x (by the second direction) and points out."""

    @model_validator(mode="after")
    def _has_points(self, info: ValidationInfo) -> Self:
        sources = {
            "nodes": "flexible",
            "face": "flexible",
            "points": "rigid",
            "file": "rigid",
            "spline": "rigid",
        }
        self.check_source(info, sources)
        self.check_fit(self.spline, ("degree", "parametrisation"))
        if (self.file is None) != (self.columns is None):
            given, absent = ("columns", "file") if self.file is None else ("file", "columns")
            reject(f"{given!r} without {absent!r}", "both: rows of so many points in a file", key=absent)
        if self.points is not None:
            _check_rows(self.points, "points")
        if self.spline is not None:
            _check_rows(self.spline.control, "spline.control")
            if self.spline.weights and [len(row) for row in self.spline.weights] != [
                len(row) for row in self.spline.control
            ]:
                reject(
                    "are not in the rows of the control points", "one a control point", key="spline.weights"
                )
        return self


def _check_rows(rows: tuple[tuple[Any, ...], ...], key: str) -> None:
    """Rows of a grid are of one length."""
    counts = sorted({len(row) for row in rows})
    if len(counts) > 1:
        reject(f"rows of {counts[0]} and of {counts[-1]} points", "rows of one length", key=key)


class _AlongCurveSection(_ContourSection):
    """What contours have that are, or lie along, a curve."""

    line: LineSection | None = None
    """Of a flexible body: nodes of its mesh on a line."""
    points: Annotated[tuple[LengthVector, ...], Field(min_length=2)] | None = None
    """Of a rigid body or the ground: points in order, in the coordinates of the geometry; of the ground in the world
    [m]."""
    circle: CircleSection | None = None
    """A circle."""
    spline: CurveSplineSection | None = None
    """Of a rigid body or the ground: a curve of another program."""
    degree: Degree = 3
    """At least 3."""
    closed: Closed = False
    """Whether the first point follows upon the last one; a circle is closed."""

    @model_validator(mode="after")
    def _has_points(self, info: ValidationInfo) -> Self:
        sources = {
            "nodes": "flexible",
            "line": "flexible",
            "points": "rigid",
            "file": "rigid",
            "circle": "flexible rigid",
            "spline": "rigid",
        }
        self.check_source(info, sources)
        self.check_fit(self.spline, ("degree", "parametrisation"))
        if self.circle is not None and "closed" in self.model_fields_set and not self.closed:
            reject("false with 'circle'", "no 'closed': a circle is", key="closed")
        context = CaseContext.of(info)
        owner = "" if context is None else context.names.body_types.get(self.body, "")
        if self.circle is not None and self.circle.points is not None and owner == "flexible":
            reject(
                "'points' of a circle through nodes",
                "no 'points': all nodes on it count",
                key="circle.points",
            )
        if self.spline is not None and len(self.spline.weights) not in {0, len(self.spline.control)}:
            reject(
                f"{len(self.spline.weights)} weights for {len(self.spline.control)} control points",
                "one a control point",
                key="spline.weights",
            )
        return self


class CurveContourSection(_AlongCurveSection):
    """A curve: beads slide along it, balls touch it."""

    type: Literal["curve"]
    normal: Direction | None = None
    """Direction across it at its start, in the coordinates of the body: the first of the two normals of a bead; chosen
    if absent."""


class CylinderContourSection(_AlongCurveSection):
    """The surface of a round bar, cable or pipe about a curve."""

    type: Literal["cylinder"]
    radius: Annotated[float, Positive("length")]
    """[m]."""


class BandContourSection(_AlongCurveSection):
    """The surface of a band along a curve, straight across it."""

    type: Literal["band"]
    width: Annotated[float, Positive("length")]
    """From edge to edge [m]; the curve is its middle."""
    across: Direction | None = None
    """Direction along the width, in the coordinates of the body, for all of the curve: the normal is across x tangent,
    of a circle about this axis inward."""
    normal: Direction | None = None
    """In place of `across`: outward normal at the start of the curve."""
    flip: bool = False
    """With `across`: turn the normal round."""

    @model_validator(mode="after")
    def _has_a_side(self) -> Self:
        if (self.across is None) == (self.normal is None):
            problem = "neither 'across' nor 'normal'" if self.normal is None else "both 'across' and 'normal'"
            reject(problem, "'across' (along the width), or 'normal' (at the start of the curve)")
        if self.flip and self.normal is not None:
            reject("'flip' with 'normal'", "the opposite 'normal'", key="flip")
        return self


Contour = Annotated[
    SurfaceContourSection | CurveContourSection | CylinderContourSection | BandContourSection,
    Field(discriminator="type"),
]
