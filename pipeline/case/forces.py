"""Tables of a case file that describe loads: on points, between points, along joints."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from functools import cache
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    Discriminator,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from heavylift.pipeline.case.channel_kinds import joint_coordinate
from heavylift.pipeline.case.described import Chosen, make_section
from heavylift.pipeline.case.fields import (
    TAG,
    BodyName,
    CaseContext,
    ForceVector,
    LengthVector,
    Quantity,
    Section,
    SideName,
    UniqueName,
    quantity_schema,
    refuse_unknown,
    reject,
    type_tag,
)
from heavylift.pipeline.case.joints import check_sides
from heavylift.solver.scene.connections import JOINTS, LOAD_CHANNELS, PAIR_FORCES, PairForce, Spring

__all__ = [
    "Force",
    "JointSpringSection",
    "MotorSection",
    "PointForceSection",
    "SpringForceSection",
]

Time = Annotated[float, Quantity("time")]
AlongJoint = Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]
"""A number whose unit depends on the joint: of an angle for a hinge, of a travel for a slider."""


class PointForceSection(Section):
    """A force on a material point, constant or from a table over time."""

    type: Literal["point"] = "point"
    name: UniqueName
    """Its name."""
    body: BodyName
    """Body that is loaded."""
    point: LengthVector
    """Loaded point in the coordinates of the geometry [m]; of a flexible body the nearest node, of a frame or shell any
    point of its mesh."""
    force: ForceVector | None = None
    """A constant force [N]."""
    times: tuple[Time, ...] = ()
    """Times of the table [s], increasing."""
    forces: tuple[ForceVector, ...] = ()
    """Forces of the table [N], linear in between, constant before and after."""
    frame: Literal["world", "body"] = "world"
    """Axes of the force: of the world, or of the body frame."""

    @model_validator(mode="after")
    def _is_a_function(self) -> "PointForceSection":
        if (self.force is None) == (not self.times and not self.forces):
            reject("not exactly one of 'force' and a table", "'force', or 'times' and 'forces'")
        _check_table("times", self.times, "forces", self.forces, shortest=1)
        return self


class SpringForceSection(Section):
    """A spring and damper between two points, along their line: it pulls and pushes."""

    CHANNELS: ClassVar = Spring.CHANNELS

    type: Literal["spring"]
    name: UniqueName
    """Name; the first part of its channels."""
    between: tuple[SideName, SideName]
    """Its two sides: names of bodies, or ``"ground"`` for the world."""
    points: tuple[LengthVector, LengthVector]
    """One point a side [m] in the coordinates of the geometry of the body; of the ground in the world."""
    length: Annotated[float, Quantity("length", minimum=0.0, closed=True)] | None = None
    """Unloaded length [m]; as drawn if absent."""
    stiffness: Annotated[float, Quantity("stiffness", minimum=0.0, closed=True)] | None = None
    """[N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m]."""
    elongations: tuple[Annotated[float, Quantity("length")], ...] = ()
    """In place of the stiffness, a table: elongations [m], increasing."""
    forces: tuple[Annotated[float, Quantity("force")], ...] = ()
    """Tensions of the table [N], linear in between and beyond its ends."""

    @field_validator("between")
    @classmethod
    def _joins_two(cls, value: tuple[str, str]) -> tuple[str, str]:
        check_sides(value)
        return value

    @model_validator(mode="after")
    def _has_a_law(self) -> "SpringForceSection":
        _check_law(self.stiffness, self.damping, "elongations", self.elongations, "forces", self.forces)
        return self


class PairForceSection(Section):
    """What all other forces between two points have."""

    name: UniqueName
    """Name; the first part of its channels."""
    between: tuple[SideName, SideName]
    """Its two sides a and b: names of bodies, or ``"ground"`` for the world."""
    points: tuple[LengthVector, LengthVector]
    """One point a side [m] in the coordinates of the geometry of the body; of the ground in the world."""

    @field_validator("between")
    @classmethod
    def _joins_two(cls, value: tuple[str, str]) -> tuple[str, str]:
        check_sides(value)
        return value


class _AlongJoint(Section):
    """What loads along a joint have."""

    CHANNELS: ClassVar = tuple(LOAD_CHANNELS.values())

    name: UniqueName
    """Name; the first part of its channels."""
    joint: str
    """A hinge, whose angle [rad] counts, or a slider, whose travel [m] counts."""

    @field_validator("joint")
    @classmethod
    def _turns_or_slides(cls, name: str, info: ValidationInfo) -> str:
        context = CaseContext.of(info)
        if context is None:
            return name
        joints = context.names.joints
        refuse_unknown("joint", name, joints)
        described = JOINTS.get(joints[name])
        if described is not None and not described.COORDINATE:
            both = {"angle", "travel"} <= {channel.name for channel in described.CHANNELS}
            has = "an angle and a travel" if both else "neither an angle nor a travel"
            reject(f"joint {name!r} of type {joints[name]!r} has {has}", "a hinge or a slider")
        return name


def _slides(info: ValidationInfo) -> bool:
    """Whether the joint of a validated section has a travel, not an angle."""
    context = CaseContext.of(info)
    joints = {} if context is None else context.names.joints
    return joint_coordinate(joints.get(info.data.get("joint", ""), "")) == "travel"


class JointSpringSection(_AlongJoint):
    """A spring and damper on the angle of a hinge or the travel of a slider."""

    type: Literal["joint_spring"]
    rest: AlongJoint = 0.0
    """Angle [rad] or travel [m] without load."""
    stiffness: AlongJoint | None = None
    """[N m/rad] or [N/m]."""
    damping: AlongJoint = 0.0
    """[N m s/rad] or [N s/m]."""
    deflections: tuple[AlongJoint, ...] = ()
    """In place of the stiffness, a table: angles [rad] or travels [m] less `rest`, increasing."""
    loads: tuple[AlongJoint, ...] = ()
    """Restoring torques [N m] or forces [N] of the table, linear in between and beyond its ends."""

    @field_validator("rest", "stiffness", "damping", "deflections", "loads", mode="before")
    @classmethod
    def _in_units_of_the_joint(cls, value: Any, info: ValidationInfo) -> Any:
        turning, sliding = {
            "rest": ("angle", "length"),
            "stiffness": ("angular stiffness", "stiffness"),
            "damping": ("angular damping", "damping"),
            "deflections": ("angle", "length"),
            "loads": ("moment or energy", "force"),
        }[str(info.field_name)]
        positive = info.field_name in {"stiffness", "damping"}
        kind = sliding if _slides(info) else turning
        return _parsed(value, Quantity(kind, minimum=0.0 if positive else None, closed=True), info)

    @model_validator(mode="after")
    def _has_a_law(self) -> "JointSpringSection":
        _check_law(self.stiffness, self.damping, "deflections", self.deflections, "loads", self.loads)
        return self


class MotorSection(_AlongJoint):
    """A torque or force of side a of a joint on its side b, constant or from a table over time."""

    type: Literal["motor"]
    load: AlongJoint | None = None
    """A constant torque [N m] or force [N]."""
    times: tuple[Time, ...] = ()
    """Times of the table [s], increasing."""
    loads: tuple[AlongJoint, ...] = ()
    """Torques or forces of the table, linear in between, constant before and after."""

    @field_validator("load", "loads", mode="before")
    @classmethod
    def _in_units_of_the_joint(cls, value: Any, info: ValidationInfo) -> Any:
        return _parsed(value, Quantity("force" if _slides(info) else "moment or energy"), info)

    @model_validator(mode="after")
    def _is_a_function(self) -> "MotorSection":
        if (self.load is None) == (not self.times and not self.loads):
            reject("not exactly one of 'load' and a table", "'load', or 'times' and 'loads'")
        _check_table("times", self.times, "loads", self.loads, shortest=1)
        return self


def _parsed(value: Any, quantity: Quantity, info: ValidationInfo) -> Any:
    """A value, or a list of values, in SI; zeros if the joint is not known, whose error is told already."""
    if value is None or "joint" not in info.data:
        return [] if isinstance(value, list) else 0.0
    return [quantity.parse(entry) for entry in value] if isinstance(value, list) else quantity.parse(value)


def _check_table(
    key: str, places: tuple[float, ...], values_key: str, values: tuple[Any, ...], *, shortest: int
) -> None:
    """A table has one value a place, and places that increase."""
    if len(places) != len(values):
        reject(
            f"{len(places)} {key} and {len(values)} {values_key}", f"one of {values_key} for each of {key}"
        )
    if any(b <= a for a, b in pairwise(places)):
        reject(f"{key} {list(places)}", f"increasing {key}")
    if 0 < len(places) < shortest:
        reject(f"a table of {len(places)} rows", f"{shortest} or more")


def _check_law(
    stiffness: float | None,
    damping: float,
    key: str,
    places: tuple[float, ...],
    values_key: str,
    values: tuple[float, ...],
) -> None:
    """A spring has a stiffness or a table, or is a mere damper."""
    if stiffness is not None and (places or values):
        reject("both 'stiffness' and a table", f"'stiffness', or {key!r} and {values_key!r}")
    if not stiffness and not damping and not (places or values):
        reject("neither a stiffness nor a damping", f"'stiffness', 'damping', or {key!r} and {values_key!r}")
    _check_table(key, places, values_key, values, shortest=2)


def _force_type(value: Any) -> str:
    tag = type_tag(value, "point")
    return tag if tag in _TAGS else _DESCRIBED


@cache
def pair_section(described: type[PairForce]) -> type[Section]:
    """Section of a sort of forces between two points."""
    return make_section(described, PairForceSection, {})


_DESCRIBED = f"{TAG}described"
_TYPES = ("point", "spring", "joint_spring", "motor")
_TAGS = {f"{TAG}{word}" for word in _TYPES}


Force = Annotated[
    Annotated[PointForceSection, Tag("type point")]
    | Annotated[SpringForceSection, Tag("type spring")]
    | Annotated[JointSpringSection, Tag("type joint_spring")]
    | Annotated[MotorSection, Tag("type motor")]
    | Annotated[Any, Chosen(PAIR_FORCES, pair_section, _TYPES), Tag(_DESCRIBED)],
    Discriminator(_force_type),
]
