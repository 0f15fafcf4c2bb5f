"""Tables of a case file that describe contacts: what touches a contour, in which shape, by what law."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, ValidationInfo, WithJsonSchema, field_validator, model_validator

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Dimension, Kind, parse_quantity
from heavylift.pipeline.case.channel_kinds import CONTOUR_TYPES
from heavylift.pipeline.case.fields import (
    GROUND,
    CaseContext,
    Direction,
    LengthVector,
    Positive,
    Quantity,
    Section,
    UniqueName,
    quantity_schema,
    refuse_unknown,
    reject,
)
from heavylift.solver.scene import contacts as solver

__all__ = [
    "BilateralContactSection",
    "BoxShapeSection",
    "CapsuleShapeSection",
    "CircleShapeSection",
    "Contact",
    "CylinderShapeSection",
    "EllipsoidShapeSection",
    "HertzContactSection",
    "HuntCrossleyContactSection",
    "LinearContactSection",
    "PointShapeSection",
    "RigidContactSection",
    "Shape",
    "SphereShapeSection",
    "TurnSection",
    "contact_stiffness",
]

Length = Annotated[float, Positive("length")]


class TurnSection(Section):
    """A rotation from the axes of the body to those of a shape."""

    axis: Direction
    """Direction in the coordinates of the body, any length."""
    angle: Annotated[float, Quantity("angle")]
    """Angle of rotation [rad]."""


class PointShapeSection(Section):
    """The point itself."""

    type: Literal["point"]


class SphereShapeSection(Section):
    """A ball about the point."""

    type: Literal["sphere"]
    radius: Length
    """[m]."""


class CircleShapeSection(Section):
    """A thin ring, the rim of a disc or wheel, about the point."""

    type: Literal["circle"]
    radius: Length
    """[m]."""
    axis: Direction
    """Normal of its plane, in the coordinates of the body."""


class EllipsoidShapeSection(Section):
    """An ellipsoid about the point."""

    type: Literal["ellipsoid"]
    half_axes: tuple[Length, Length, Length]
    """[m]."""
    turned: TurnSection | None = None
    """How its axes are turned from those of the body; not at all if absent."""


class BoxShapeSection(Section):
    """A box about the point, with rounded edges."""

    type: Literal["box"]
    size: tuple[Length, Length, Length]
    """From face to face [m]."""
    rounding: Length
    """Radius of its edges and corners [m], below half of its smallest size."""
    turned: TurnSection | None = None
    """How its axes are turned from those of the body; not at all if absent."""

    @model_validator(mode="after")
    def _has_a_core(self) -> Self:
        _check_rounding(self.rounding, min(self.size), "smallest size")
        return self


class CapsuleShapeSection(Section):
    """A round bar with half balls as ends, about the point."""

    type: Literal["capsule"]
    radius: Length
    """[m]."""
    length: Length
    """Of its straight part: from centre to centre of its ends [m]."""
    axis: Direction
    """In the coordinates of the body."""


class CylinderShapeSection(Section):
    """A round bar with rounded rims, about the point."""

    type: Literal["cylinder"]
    radius: Length
    """[m]."""
    length: Length
    """From face to face [m]."""
    rounding: Length
    """Radius of its rims [m], below its radius and half of its length."""
    axis: Direction
    """In the coordinates of the body."""

    @model_validator(mode="after")
    def _has_a_core(self) -> Self:
        _check_rounding(self.rounding, min(2.0 * self.radius, self.length), "diameter or length")
        return self


def _check_rounding(rounding: float, size: float, what: str) -> None:
    if rounding >= 0.5 * size:
        reject(
            f"{rounding:g} m rounds all of the shape off",
            f"less than {0.5 * size:g} m, half of its {what}",
            key="rounding",
        )


Shape = Annotated[
    PointShapeSection
    | SphereShapeSection
    | CircleShapeSection
    | EllipsoidShapeSection
    | BoxShapeSection
    | CapsuleShapeSection
    | CylinderShapeSection,
    Field(discriminator="type"),
]

_LAWS_OF = {
    "restitution": ("rigid", "hunt-crossley"),
    "rest_speed": ("rigid",),
    "events": ("rigid",),
    "stiffness": ("linear", "hertz", "hunt-crossley"),
    "contact_modulus": ("hertz", "hunt-crossley"),
    "damping": ("linear",),
    "exponent": ("hunt-crossley",),
}
"""Keys of laws, and which laws have them."""

_LAWS = ("rigid", "bilateral", "linear", "hertz", "hunt-crossley")
_ON_SURFACES = frozenset({"circle", "ellipsoid", "box", "capsule", "cylinder"})
"""Shapes that touch surfaces only."""


class _ContactSection(Section):
    """What all contacts have."""

    CHANNELS: ClassVar = solver.Contact.CHANNELS

    name: UniqueName
    """Name; the first part of its channels."""
    law: str
    """Force or impulse across the contact."""
    between: tuple[str, str]
    """The body that touches, and the contour that it touches."""
    point: LengthVector | None = None
    """Point of the body that touches, or the middle of its shape [m], in the coordinates of the geometry; its origin
    if absent."""
    at: LengthVector | None = None
    """In place of `point`: where it is at the start [m], in the world."""
    shape: Shape = Field(default_factory=lambda: PointShapeSection(type="point"))
    """What touches; the point itself if absent."""
    friction: Annotated[float, Quantity("number", minimum=0.0, closed=True)] = 0.0
    """Coulomb's coefficient; 0 without."""
    footprint: Length | None = None
    """Radius [m] of a disc on the contour over which gap and force are spread with the weight (1 - r^2/R^2)^2."""

    @model_validator(mode="before")
    @classmethod
    def _has_the_keys_of_its_law(cls, value: Any) -> Any:
        law = value.get("law") if isinstance(value, dict) else None
        for key, laws in _LAWS_OF.items():
            if law in _LAWS and key in value and law not in laws:
                owners = " or ".join(repr(name) for name in laws)
                reject(f"{key!r} with law {law!r}", f"law {owners}, or no {key!r}", key=key)
        return value

    @field_validator("between")
    @classmethod
    def _is_a_body_and_a_contour(cls, value: tuple[str, str], info: ValidationInfo) -> tuple[str, str]:
        context = CaseContext.of(info)
        if context is None:
            return value
        bodies, contours = context.names.bodies, context.names.contours
        body, contour = value
        if body in contours and body not in bodies and (contour in bodies or contour == GROUND):
            reject(
                f"{body!r} is a contour and {contour!r} a body",
                f'["{contour}", "{body}"]: the body that touches first',
            )
        if body == GROUND:
            reject(
                "the ground touches nothing", "a body that touches; the ground may have the contour", key="0"
            )
        refuse_unknown("body", body, bodies, key="0")
        refuse_unknown("contour", contour, contours, key="1")
        if contours[contour][1] == body:
            reject(f"{contour!r} is a contour of {body!r}, which would touch itself", "two different bodies")
        return value

    @model_validator(mode="after")
    def _fits(self, info: ValidationInfo) -> Self:
        if self.point is not None and self.at is not None:
            reject("both 'point' and 'at'", "'point' (of the body), or 'at' (in the world)", key="at")
        law, shape = self.law, self.shape.type
        if law == "bilateral" and shape != "point":
            reject(
                f"{shape!r} with law 'bilateral'", "'point': it is on the contour itself", key="shape.type"
            )
        if self.footprint is not None and shape not in {"point", "sphere"}:
            reject(f"'footprint' with shape {shape!r}", "shape 'point' or 'sphere'", key="footprint")
        context = CaseContext.of(info)
        if context is None:
            return self
        kind, owner = context.names.contours[self.between[1]]
        if kind not in CONTOUR_TYPES:  # which is told of the contour
            return self
        if self.footprint is not None and (kind, context.names.body_types.get(owner)) != (
            "surface",
            "flexible",
        ):
            reject(
                f"a footprint on {self.between[1]!r}, a {kind} of {owner!r}",
                "a contour of type 'surface' of a flexible body",
                key="footprint",
            )
        if kind != "surface" and shape in _ON_SURFACES:
            reject(
                f"{shape!r} on {self.between[1]!r}, a {kind}",
                "'point' or 'sphere', or a contour of type 'surface'",
                key="shape.type",
            )
        if kind == "curve" and law != "bilateral" and shape == "point":
            reject(
                f"a point cannot meet {self.between[1]!r}, a curve without thickness",
                "shape 'sphere', law 'bilateral', or a contour of type 'cylinder' or 'band'",
                key="shape",
            )
        return self


class RigidContactSection(_ContactSection):
    """Without compliance: what touches does not enter, and impacts are at once."""

    law: Literal["rigid"]
    restitution: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 0.0
    """Velocity after an impact over that before it, 0 to 1."""
    rest_speed: Annotated[float, Quantity("velocity", minimum=0.0, closed=True)] = 0.0
    """Approach [m/s] below which an impact has no restitution."""
    events: Annotated[bool, Field(strict=True)] = True
    """Split the step where an impact happens; else impacts happen at ends of steps."""


class BilateralContactSection(_ContactSection):
    """Never leaves the contour: a bead on a curve, a slider in a surface."""

    law: Literal["bilateral"]


class LinearContactSection(_ContactSection):
    """A spring and a damper that never pull."""

    law: Literal["linear"]
    stiffness: Annotated[float, Positive("stiffness")]
    """[N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m]."""


class _PowerLawSection(_ContactSection):
    """What laws have whose force is a power of the depth."""

    contact_modulus: Annotated[float, Positive("pressure")] | None = None
    """In place of `stiffness`, of a sphere: E* [Pa] with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; the stiffness is
    4/3 E* sqrt(radius), of a ball on a flat surface."""

    def check_stiffness(self, stiffness: float | None, exponent: float) -> None:
        """One of `stiffness` and `contact_modulus`, which is for spheres."""
        if (stiffness is None) == (self.contact_modulus is None):
            problem = "no 'stiffness'" if stiffness is None else "both 'stiffness' and 'contact_modulus'"
            reject(problem, "'stiffness', or 'contact_modulus' of a sphere")
        if self.contact_modulus is not None and self.shape.type != "sphere":
            problem = f"'contact_modulus' with shape {self.shape.type!r}"
            reject(problem, "shape 'sphere', or 'stiffness'", key="contact_modulus")
        if self.contact_modulus is not None and exponent != 1.5:
            problem = f"'contact_modulus' with exponent {exponent:g}"
            reject(problem, "exponent 1.5, or 'stiffness'", key="contact_modulus")


def contact_stiffness(value: Any, exponent: float) -> float:
    """SI number of the stiffness of a power law [N/m^exponent]; a rejected one ends the validation of the field."""
    unit = f"N/m^{exponent:g}"
    try:
        number = parse_quantity(
            value, Kind("stiffness of a contact", unit, Dimension(1.0 - exponent, 1.0, -2.0))
        )
    except InputError as error:
        reject(error.problem, error.expected)
    if number <= 0.0:
        reject(f"{value!r} is too small", f"a stiffness of a contact > 0 {unit}")
    return number


PowerStiffness = Annotated[
    float, WithJsonSchema(quantity_schema("number in N/m^exponent", exclusiveMinimum=0.0), mode="validation")
]


class HertzContactSection(_PowerLawSection):
    """Elastic and smooth bodies (Hertz): a force that grows with the depth to the power of 3/2."""

    law: Literal["hertz"]
    stiffness: PowerStiffness | None = None
    """[N/m^1.5]."""

    @field_validator("stiffness", mode="before")
    @classmethod
    def _in_its_unit(cls, value: Any) -> Any:
        return None if value is None else contact_stiffness(value, 1.5)

    @model_validator(mode="after")
    def _has_a_stiffness(self) -> Self:
        self.check_stiffness(self.stiffness, 1.5)
        return self


class HuntCrossleyContactSection(_PowerLawSection):
    """A force that grows with a power of the depth, and damping that gives a restitution (Hunt and Crossley)."""

    law: Literal["hunt-crossley"]
    exponent: Annotated[float, Quantity("number", minimum=1.0, maximum=3.0, closed=True)] = 1.5
    """1.5 of Hertz, 1 linear."""
    stiffness: PowerStiffness | None = None
    """[N/m^exponent]."""
    restitution: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 1.0
    """Velocity after an impact over that before it, above 0 up to 1."""

    @field_validator("stiffness", mode="before")
    @classmethod
    def _in_its_unit(cls, value: Any, info: ValidationInfo) -> Any:
        # an exponent that is wrong is told by itself
        if value is None or "exponent" not in info.data:
            return None if value is None else 1.0
        return contact_stiffness(value, info.data["exponent"])

    @field_validator("restitution")
    @classmethod
    def _bounces(cls, value: float) -> float:
        if value == 0.0:
            reject("0 needs infinite damping", "above 0, or law 'rigid'")
        return value

    @model_validator(mode="after")
    def _has_a_stiffness(self) -> Self:
        self.check_stiffness(self.stiffness, self.exponent)
        return self


Contact = Annotated[
    RigidContactSection
    | BilateralContactSection
    | LinearContactSection
    | HertzContactSection
    | HuntCrossleyContactSection,
    Field(discriminator="law"),
]
