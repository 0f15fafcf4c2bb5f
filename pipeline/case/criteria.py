"""Tables of a case file that judge an operation: criteria with a value, a limit and the clause it comes from.

What a criterion is computed by, and its closed forms, are in `heavylift.pipeline.checks.criteria`.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

import contextlib
import math
import re
from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from pydantic import (
    AfterValidator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import KINDS, parse_quantity
from heavylift.pipeline.case.checks import quantity_in_unit
from heavylift.pipeline.case.fields import (
    GROUND,
    BodyName,
    CaseContext,
    Direction,
    LengthVector,
    Name,
    Positive,
    Quantity,
    QuantityString,
    Section,
    SideName,
    quantity_schema,
    refuse_unknown,
    reject,
)
from heavylift.pipeline.case.quantity_names import (
    channel_members,
    parse_quantity_name,
    single_components,
)

_SAME = 1e-9
"""Distance of points that are one, relative to their size."""

__all__ = [
    "ClearanceCriterion",
    "CraneCriterion",
    "Criteria",
    "Criterion",
    "CurveSection",
    "DynamicsCriterion",
    "LimitCriterion",
    "LugCriterion",
    "PlaceSection",
    "Rating",
    "ReachSection",
    "ShackleCriterion",
    "SlackCriterion",
    "SlingAngleCriterion",
    "SlingCriterion",
    "TiltCriterion",
    "TransportCriterion",
    "check_criterion",
    "parts_to",
    "phase_names",
    "ropes_over_pulleys",
    "sensor_at",
    "straight_parts",
    "tensions_of",
]


class Rating(NamedTuple):
    """What something may carry, or weighs, as it was given."""

    value: float
    """[N], or [kg] of a mass."""
    is_mass: bool
    """Whether it is multiplied by the gravity of the case."""


class _Rated:
    """Annotation of a force, or of a mass whose weight is meant; validates to a `Rating`."""

    def parse(self, value: object) -> Rating:
        """A rating from a number in N, or a string with a unit of force or mass."""
        if isinstance(value, Rating):
            return value
        expected = "a force or a mass > 0, e.g. '850 kN' or '85 t'"
        kind = "force"
        if isinstance(value, str):
            with contextlib.suppress(InputError):
                parse_quantity(value, KINDS["mass"])
                kind = "mass"
            with contextlib.suppress(InputError):
                parse_quantity(value, KINDS["force"])
                kind = "force"
        try:
            number = parse_quantity(value, KINDS[kind])
        except InputError as error:
            reject(error.problem, expected)
        if number <= 0.0:
            reject(f"{value!r} is too small", expected)
        return Rating(number, kind == "mass")

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, _handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        words = "force: number in N, or a string with a unit of force or mass"
        return quantity_schema(words, exclusiveMinimum=0.0)


class _Moment:
    """Annotation of when something is at rest: a word or a time [s]."""

    WORDS = ("start", "end", "mean")

    def parse(self, value: object) -> str | float:
        """A word, or a time in SI."""
        if value in self.WORDS:
            return str(value)
        try:
            return Quantity("time", minimum=0.0, closed=True).parse(value)
        except InputError as error:
            reject(error.problem, "'start', 'end', 'mean', or a time within the run, e.g. '30 s'")

    def __get_pydantic_core_schema__(self, _source: object, _handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, _schema: CoreSchema, _handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [{"type": "number", "minimum": 0.0}, {"type": "string"}]}


class _OneChannel:
    """Annotation of a channel, or of a combination, that is one number of a kind: ``"sum(fall_*.tension)"``."""

    def __init__(self, kind: str, *, group: bool = False) -> None:
        self.kind, self.group = kind, group

    def check(self, name: str, info: ValidationInfo) -> str:
        """The name, if it is recorded, has one component and the wanted unit."""
        context = CaseContext.of(info)
        names = None if context is None else context.names
        try:
            quantity = parse_quantity_name(f"channel.{name}.end", names)
        except InputError as error:
            reject(
                error.problem.replace("quantity 'channel.", "channel '").replace(".end'", "'"), self._expected
            )
        wanted = KINDS[self.kind]
        if quantity.kind.dimension != wanted.dimension:
            reject(f"{name!r} is in {quantity.kind.unit}, no {self.kind}", self._expected)
        if names is None:
            return name
        if quantity.owner and quantity.owner not in names.names:
            reject(
                f"{name!r} names {quantity.owner!r}, which does not exist",
                f"one of: {', '.join(names.names)}",
            )
        if quantity.members and not self.group:
            count = len(quantity.members)
            reject(f"{name!r} is of {count} things", f"one number, e.g. 'sum({name})'")
        components = None if quantity.component else single_components(quantity.item, names)
        if not quantity.members and components is not None and len(components) > 1:
            reject(f"{name!r} has {len(components)} components", f"one of them: {', '.join(components)}")
        return name

    @property
    def _expected(self) -> str:
        unit = KINDS[self.kind].unit
        return f"a recorded channel in {unit}, OWNER.CHANNEL[.COMPONENT], or a combination of such channels"

    def __get_pydantic_core_schema__(self, _source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_after_validator_function(self.check, handler(str))


class _Owners:
    """Annotation of names, and patterns of names, of what has a channel; validates to all that they stand for."""

    def __init__(self, one: str, channel: str, lacks: str) -> None:
        self.one, self.channel, self.lacks = one, channel, lacks

    def check(self, given: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        """Each name once."""
        context = CaseContext.of(info)
        if context is None:
            return given
        found: list[str] = []
        for index, pattern in enumerate(given):
            try:
                members = channel_members(f"{pattern}.{self.channel}", context.names)
                for member in members:
                    parse_quantity_name(f"channel.{member}.max", context.names)
                    if member.partition(".")[0] not in context.names.names:
                        raise InputError(f"{pattern!r} does not exist", expected=f"a {self.one}")  # noqa: TRY301
            except InputError as error:
                problem = error.problem if "exist" in error.problem else f"{pattern!r} {self.lacks}"
                owners = [name for name, own in context.names.channels.items() if self.channel in own]
                reject(
                    problem if "no name fits" not in error.problem else f"no {self.one} fits {pattern!r}",
                    f"{self.one}s or patterns of {self.one}s: {', '.join(owners[:20]) or 'the case has none'}",
                    key=str(index),
                )
            found += [member.partition(".")[0] for member in members]
        return tuple(dict.fromkeys(found))

    def __get_pydantic_core_schema__(self, _source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_after_validator_function(self.check, handler(_source))


Ropes = Annotated[tuple[str, ...], Field(min_length=1), _Owners("rope", "tension", "has no tension")]
"""Names of ropes, and of what else has a tension, and patterns; validates to all that they stand for."""
Lugs = Annotated[tuple[str, ...], Field(min_length=1), _Owners("lug", "out_of_plane", "is no lug")]
"""Names of lugs and patterns; validates to all that they stand for."""
Rated = Annotated[Rating, _Rated()]
Moment = Annotated[str | float, _Moment()]
Factor = Annotated[float, Quantity("number", minimum=1.0, closed=True)]
Angle = Annotated[float, Quantity("angle", minimum=0.0, maximum=1.5707963267948966)]
Time = Annotated[float, Quantity("time", minimum=0.0, closed=True)]
Force = Annotated[str, _OneChannel("force")]


class _Criterion(Section):
    """What all criteria have."""

    name: Name
    """Unique in the case."""
    after: Time | None = None
    """Only from this time of the run on [s]; from its start if absent."""
    until: Time | None = None
    """Only up to this time [s]; to the end if absent."""
    phases: tuple[str, ...] = ()
    """Only in these phases of the operation, by name; in all if absent."""
    source: Annotated[str, Field(pattern=r"\S")] | None = None
    """Where the limit comes from; if absent the clause that the kind of criterion has, with its status."""

    @model_validator(mode="after")
    def _has_a_span(self) -> "_Criterion":
        if self.until is not None and self.until <= (self.after or 0.0):
            reject(f"{self.until:g} s is not later than 'after'", "a later time", key="until")
        return self


class _Loaded(_Criterion):
    """What criteria of forces have: which dynamics are inside."""

    dynamic_factor: Factor | None = None
    """Dynamic amplification factor on the force at rest, which `static_at` says; if absent the largest force of the run
    counts, in which the dynamics are, and no factor."""
    static_at: Moment | None = None
    """When the force is the one at rest: ``start``, ``end``, ``mean`` (over the time that counts), or a time [s]."""

    STATIC_ALONE: ClassVar[bool] = False
    """Whether the force at rest has a meaning beside that of the run."""

    @model_validator(mode="after")
    def _one_of_both(self) -> "_Loaded":
        if self.dynamic_factor is not None and self.static_at is None:
            reject(
                "is missing: 'dynamic_factor' multiplies the force at rest, never the largest one of the run",
                "'start', 'end', 'mean' or a time",
                key="static_at",
            )
        if self.dynamic_factor is None and self.static_at is not None and not self.STATIC_ALONE:
            reject(
                "'static_at' without 'dynamic_factor'",
                "both, or neither: the run has its dynamics",
                key="static_at",
            )
        return self


class _Rigged(_Loaded):
    """What criteria of slings, shackles and lugs have."""

    skew_factor: Factor = 1.0
    """Skew load factor on the force; 1 where the run has the real lengths, or three points carry."""
    yaw_factor: Factor = 1.0
    """Factor for yaw of lifts on two hooks, where the run does not have it."""


class PlaceSection(Section):
    """A point of a body, or of the ground."""

    body: SideName
    """A body, or ``"ground"``. Flexible bodies, frames and shells need a sensor at the point."""
    point: LengthVector
    """[m] in the coordinates of the geometry of the body; of the ground in the world."""


class ReachSection(Section):
    """Between which points the radius of a crane is."""

    centre: PlaceSection
    """On the axis from which the radius counts."""
    tip: PlaceSection
    """Where the falls begin: the head of the boom, or the trolley."""


class CurveSection(Section):
    """What a crane may carry at a radius: linear between its rows, nothing outside."""

    radius: Annotated[tuple[Annotated[float, Positive("length")], ...], Field(min_length=2)]
    """[m], increasing."""
    capacity: Annotated[tuple[Rated, ...], Field(min_length=2)]
    """Force or mass, one a radius."""

    @model_validator(mode="after")
    def _is_a_curve(self) -> "CurveSection":
        if len(self.radius) != len(self.capacity):
            reject(
                f"{len(self.radius)} radii and {len(self.capacity)} capacities",
                "one capacity for each radius",
                key="capacity",
            )
        for index, (a, b) in enumerate(zip(self.radius, self.radius[1:], strict=False)):
            if b <= a:
                reject(f"{b:g} m is not above {a:g} m", "increasing radii", key=f"radius.{index + 1}")
        if len({rating.is_mass for rating in self.capacity}) > 1:
            reject("masses beside forces", "capacities of one unit", key="capacity")
        return self


class CraneCriterion(_Loaded):
    """Load of a crane over its capacity at the radius; off-lead and side-lead of its falls.

    The capacity of a crane may include dynamics of its own: what is inside is the crane's document's to say.
    """

    type: Literal["crane"]
    load: Force
    """Channel of the load: ``"fall.tension"``, ``"sum(fall_*.tension)"``."""
    parts: Annotated[float, Positive("number")] = 1.0
    """Number of parts of a fall: what the channel is multiplied by."""
    additional: Annotated[Rating, _Rated()] | None = None
    """Rigging that hangs on the crane and is not in the run: force or mass."""
    curve: CurveSection
    """Capacity over radius."""
    radius: Annotated[float, Positive("length")] | None = None
    """Radius of a lift at one radius [m]; or `radius_channel`, or `reach`."""
    radius_channel: Annotated[str, _OneChannel("length")] | None = None
    """Channel of the radius."""
    reach: ReachSection | None = None
    """Points between which the radius is, horizontally; needed for off-lead and side-lead."""
    hook: PlaceSection | None = None
    """Lower end of the falls, for off-lead and side-lead: angles of the line from the tip, in and across the plane of
    the boom, in the axes of the body of the centre."""
    fall: str | None = None
    """Rope whose straight parts to the body of the hook are the falls, in place of the line from the tip: it leaves a
    sheave beside its centre, and that is no lead."""
    off_lead: Angle | None = None
    """Largest angle of the falls in the plane of the boom; 3 deg if absent."""
    side_lead: Angle | None = None
    """Largest angle of the falls across the plane of the boom; 3 deg if absent."""

    @model_validator(mode="after")
    def _has_one_radius(self) -> "CraneCriterion":
        keys = ("radius", "radius_channel", "reach")
        given = [key for key in keys if getattr(self, key) is not None]
        if len(given) != 1:
            what = f"both {given[0]!r} and {given[1]!r}" if given else "no radius"
            reject(what, "one of 'radius', 'radius_channel', 'reach'")
        low, high = self.curve.radius[0], self.curve.radius[-1]
        if self.radius is not None and not low <= self.radius <= high:
            reject(
                f"{self.radius:g} m is outside the crane curve",
                f"a radius from {low:g} m to {high:g} m",
                key="radius",
            )
        if self.hook is not None and self.reach is None:
            reject("'hook' without 'reach'", "'reach', which says where the falls begin", key="hook")
        for key in ("off_lead", "side_lead", "fall"):
            if getattr(self, key) is not None and self.hook is None:
                reject(f"{key!r} without 'hook'", "'reach' and 'hook', between which the falls are", key=key)
        return self


class SlingCriterion(_Rigged):
    """Force of slings and wire ropes times the safety factor over their breaking load; the worst one counts."""

    type: Literal["sling"]
    ropes: Ropes
    """Ropes, by names or patterns: ``["sling_*"]``. Of equalizers without masses of pulleys each line is judged."""
    breaking_load: Rated
    """Minimum breaking load of one rope: force or mass."""
    termination_factor: Factor
    """Factor for the splice or socket at its ends: 1 of a socket, 1.25 where 80 % of the breaking load are left."""
    bending_ratio: Annotated[float, Quantity("number", minimum=1.0)] | None = None
    """D/d of the smallest pin or sheave that it bends about; straight if absent."""
    load_factor: Factor = 1.3
    """gamma_f."""
    consequence_factor: Factor = 1.3
    """gamma_c."""
    wear_factor: Factor = 1.0
    """gamma_w: 1.0, 1.1 or 1.2."""
    material_factor: Factor = 1.5
    """gamma_m: 1.5, or 1.35 of a rope as new."""
    twist_factor: Factor = 1.0
    """gamma_tw."""


class SlingAngleCriterion(_Criterion):
    """Smallest angle of ropes to the horizontal while they carry."""

    type: Literal["sling_angle"]
    ropes: Ropes
    """Ropes, by names or patterns."""
    minimum: Angle = 0.5235987755982988
    """Smallest angle that passes; 30 deg by default."""
    warning: Angle = 0.7853981633974483
    """Angle below which there is a warning; 45 deg by default."""

    @model_validator(mode="after")
    def _warns_before(self) -> "SlingAngleCriterion":
        if self.warning < self.minimum:
            reject("is below 'minimum'", "the larger angle", key="warning")
        return self


class ShackleCriterion(_Rigged):
    """Force of shackles over the least of what their three ratings allow.

    The working load limit is one for forces at rest: with `static_at` alone it is multiplied by the amplification of
    the run, without it the largest force counts against the limit as it is.
    """

    type: Literal["shackle"]
    ropes: Ropes
    """Ropes at whose ends the shackles are, by names or patterns."""
    working_load_limit: Rated
    """WLL of one shackle: force or mass."""
    breaking_load: Rated | None = None
    """Minimum breaking load."""
    proof_load: Rated | None = None
    """Load of its proof test."""

    STATIC_ALONE: ClassVar = True


class LugCriterion(_Rigged):
    """Forces of ropes on lugs, in the plane of the eye and across it, and their angle to that plane."""

    type: Literal["lug"]
    lugs: Lugs
    """Lugs of ``[[lugs]]``, by names or patterns: ``["lug_*"]``."""
    in_plane: Rated | None = None
    """What a lug may carry in its plane; not judged if absent."""
    out_of_plane: Rated | None = None
    """What a lug may carry across its plane; not judged if absent."""
    lateral_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0, closed=True)] = 0.03
    """Least lateral force relative to the force of the rope, where that of the run is smaller; 0.05 afloat."""
    maximum_angle: Angle = 0.08726646259971647
    """Largest angle to the plane of the eye while the rope carries; 5 deg by default."""


class DynamicsCriterion(_Criterion):
    """Largest load of a hook relative to that at rest, beside the factor of the table for lifts in air."""

    type: Literal["dynamic_factor"]
    load: Force
    """Channel of the load, as for ``crane``."""
    parts: Annotated[float, Positive("number")] = 1.0
    """Number of parts of a fall."""
    operation: Literal["onshore", "inshore", "offshore"]
    """Column of the table."""
    static_load: Rated | None = None
    """Load at rest: force or mass; or `static_at`."""
    static_at: Moment | None = None
    """When the load is the one at rest: ``start``, ``end``, ``mean`` or a time [s]."""
    maximum: Factor | None = None
    """Limit in place of that of the table."""

    @model_validator(mode="after")
    def _knows_the_load_at_rest(self) -> "DynamicsCriterion":
        if (self.static_load is None) == (self.static_at is None):
            reject(
                "both 'static_load' and 'static_at'"
                if self.static_at is not None
                else "neither 'static_load' nor 'static_at'",
                "one of them: the load at rest",
            )
        return self


class ClearanceCriterion(_Criterion):
    """Smallest distance: a gap of surfaces, a relative motion, a difference of heights."""

    type: Literal["clearance"]
    distance: Annotated[str, _OneChannel("length", group=True)]
    """Channel, or pattern of channels: ``"landing.gap"``, ``"swing.distance"``, ``"hook.position.z"``."""
    place: Literal["to_boom", "under_load", "near_final_place", "on_barge", "sideways"] | None = None
    """What the distance is, by which the limit is chosen: 3, 3, 1.5, 5 and 3 m."""
    minimum: Annotated[float, Quantity("length")] | None = None
    """Smallest distance that passes [m], in place of that of `place`."""

    @model_validator(mode="after")
    def _has_a_limit(self) -> "ClearanceCriterion":
        if self.place is None and self.minimum is None:
            reject("neither 'place' nor 'minimum'", "one of them")
        return self


class TiltCriterion(_Criterion):
    """Angle of an axis of a body to the vertical."""

    type: Literal["tilt"]
    body: BodyName
    """Rigid or flexible body."""
    axis: Direction = (0.0, 0.0, 1.0)
    """Axis that is upright when the body is level, in the coordinates of its geometry."""
    maximum: Annotated[float, Quantity("angle", minimum=0.0, maximum=3.141592653589793)]
    """Largest angle."""


class SlackCriterion(_Criterion):
    """Smallest tension of ropes; with `static_at` also how much of the tension at rest the dynamics take away."""

    type: Literal["slack"]
    ropes: Ropes
    """Ropes, by names or patterns."""
    minimum: Annotated[float, Quantity("force", minimum=0.0, closed=True)] = 0.0
    """Tension that all must exceed [N]."""
    static_at: Moment | None = None
    """When the tension is the one at rest."""
    dynamic_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.9
    """Largest part of the tension at rest that the dynamics may take away."""


_Limit = Annotated[float, WithJsonSchema(quantity_schema(), mode="validation")]


class TransportCriterion(_Criterion):
    """A transporter: how far it is from tipping over, and what its bogies, drives and brakes have left."""

    type: Literal["transport"]
    transporter: Name
    """Transporter that is judged."""
    static_tipping: Annotated[float, Quantity("angle", minimum=0.0, maximum=1.5, closed=True)] = math.radians(
        7.0
    )
    """Least tilt of the road at which it tips over on rigid groups."""
    tipping: Annotated[float, Quantity("angle", minimum=0.0, maximum=1.5, closed=True)] = math.radians(2.0)
    """Least tilt of the road at which it tips over with what its groups give way."""
    group_share: Annotated[float, Quantity("number", minimum=0.0, maximum=0.5)] = 0.0
    """Share of the weight that every group must exceed in the run."""
    stroke_reserve: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """That strokes must keep from `stroke_limits` [m], if the transporter has them."""
    drive_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 0.8
    """Largest part of what drives can give, if the transporter has a drive with a table."""
    traction_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 1.0
    """Largest part of what friction of driven bogies allows, if it has a drive."""
    brake_share: Annotated[float, Quantity("number", minimum=0.0, maximum=1.0)] = 1.0
    """Largest part of what brakes hold at rest, if it has a drive with a `brake_force`."""


class LimitCriterion(_Criterion):
    """Any quantity of checks within limits."""

    type: Literal["limit"]
    quantity: QuantityString
    """As in checks, patterns included: ``"channel.barge.angular_velocity.x.rms"``; the worst of a group counts."""
    maximum: _Limit | None = None
    """Largest value that passes, in the unit of the quantity."""
    minimum: _Limit | None = None
    """Smallest value that passes, in place of `maximum`."""

    @field_validator("maximum", "minimum", mode="before")
    @classmethod
    def _has_the_unit(cls, value: Any, info: ValidationInfo) -> Any:
        return None if value is None else quantity_in_unit(info, value)

    @model_validator(mode="after")
    def _has_one_limit(self) -> "LimitCriterion":
        if (self.maximum is None) == (self.minimum is None):
            which = "both" if self.maximum is not None else "neither"
            other = "and" if self.maximum is not None else "nor"
            reject(f"{which} 'maximum' {other} 'minimum'", "one of them: a criterion each")
        over_time = self.quantity.partition(".")[0] in {"channel", "stress"}
        given = [key for key in ("after", "until", "phases") if getattr(self, key) not in {None, ()}]
        if given and not over_time:
            key = given[0]
            reject(
                f"{key!r} with {self.quantity!r}, which is not over time", "a channel or a stress", key=key
            )
        return self


Criterion = Annotated[
    CraneCriterion
    | SlingCriterion
    | SlingAngleCriterion
    | ShackleCriterion
    | LugCriterion
    | DynamicsCriterion
    | ClearanceCriterion
    | TiltCriterion
    | SlackCriterion
    | TransportCriterion
    | LimitCriterion,
    Field(discriminator="type"),
]


def _one_each(criteria: Sequence[Any]) -> Sequence[Any]:
    names = [criterion.name for criterion in criteria]
    for index, name in enumerate(names):
        if name in names[:index]:
            raise PydanticCustomError(
                "case",
                "{problem}",
                {
                    "problem": f"{name!r} is used before",
                    "expected": "one criterion a name",
                    "key": f"{index}.name",
                },
            )
    return criteria


Criteria = Annotated[tuple[Criterion, ...], AfterValidator(_one_each)]
"""All criteria of a case."""


def sensor_at(case: Any, body: str, point: Sequence[float]) -> str | None:
    """Name of the sensor at a point of a body; None if there is none."""
    return next(
        (
            sensor.name
            for sensor in case.sensors
            if sensor.body == body and math.dist(sensor.point, point) <= _SAME * (1.0 + math.hypot(*point))
        ),
        None,
    )


def check_criterion(case: Any, index: int) -> None:
    """What a criterion names must be in the case, and what it needs be recorded.

    Raises
    ------
    PydanticCustomError
        By `reject`, with the key.
    """
    criterion, key = case.criteria[index], f"criteria.{index}"
    if criterion.type != "limit" and case.simulate is None:
        reject("needs a [simulate] section", "a case that is simulated", key=key)
    _check_times(case, criterion, key)
    for number, phase in enumerate(criterion.phases):
        refuse_unknown("phase", phase, phase_names(case), key=f"{key}.phases.{number}")
    for name, rating in _ratings(criterion):
        if rating.is_mass and (case.gravity is None or not any(case.gravity.acceleration)):
            reject("a mass without gravity", "a force, or [gravity]", key=f"{key}.{name}")
    match criterion:
        case CraneCriterion():
            reach = criterion.reach
            places = {} if reach is None else {"reach.centre": reach.centre, "reach.tip": reach.tip}
            places |= {} if criterion.hook is None else {"hook": criterion.hook}
            for name, place in places.items():
                _check_place(case, place.body, place.point, f"{key}.{name}")
            if reach is not None:
                _check_axes(case, reach.centre.body, f"{key}.reach.centre.body")
            if criterion.fall is not None and criterion.hook is not None:
                refuse_unknown("rope", criterion.fall, [one.name for one in case.ropes], key=f"{key}.fall")
                _check_path(case, criterion.fall, f"{key}.fall")
                if not parts_to(case, criterion.fall, criterion.hook.body):
                    reject(
                        f"no part of {criterion.fall!r} leads to {criterion.hook.body!r}",
                        "a rope between the crane and the body of the hook",
                        key=f"{key}.fall",
                    )
        case SlingAngleCriterion():
            for number, name in enumerate(criterion.ropes):
                _check_path(case, name, f"{key}.ropes.{number}")
        case TiltCriterion():
            _check_axes(case, criterion.body, f"{key}.body")
        case TransportCriterion():
            names = [one.name for one in case.transporters]
            refuse_unknown("transporter", criterion.transporter, names, key=f"{key}.transporter")


def phase_names(case: Any) -> list[str]:
    """Names of the phases of the operation in their order, as the case file says them; empty if it has none."""
    scenario = case.document.get("scenario")
    phases = scenario.get("phases") if isinstance(scenario, dict) else None
    entries = phases if isinstance(phases, list) else []
    return [str(one.get("name", number)) for number, one in enumerate(entries, 1) if isinstance(one, dict)]


def straight_parts(rope: Any) -> list[tuple[int, int]]:
    """Places of a path, from 0 on, between which a rope has its straight parts; of lines of one force the lines."""
    last = len(rope.path) - 1
    return [(k, k + 1) for k in range(0, last, 2 if _has_lines(rope) else 1)]


def parts_to(case: Any, rope: str, body: str) -> list[tuple[int, int]]:
    """Straight parts of a rope that lead to a body from another one: their numbers, and 1 or -1 of those from it."""
    found = next(one for one in case.ropes if one.name == rope)
    ends = [(found.path[a].body == body, found.path[b].body == body) for a, b in straight_parts(found)]
    return [(k, 1 if last else -1) for k, (first, last) in enumerate(ends) if first != last]


def _has_lines(rope: Any) -> bool:
    """Whether a rope of a case is lines of one force, whose own tension is that of the rope over their pulleys."""
    return bool(rope.DESCRIBED.WORD == "equalized")


def tensions_of(case: Any, names: Sequence[str], *, least: bool = False) -> dict[str, str]:
    """What ropes carry, as it is judged: what it is, and its channel.

    A rope carries the tension of that part which has the largest one, ``{"sling": "sling.tension"}``. Of lines of one
    force each line is judged, ``{"loader_rope line 2": "loader_rope.segment_tension.2"}``: their own tension is that of
    the rope over their pulleys. Of the `least` that is carried, parts of ropes over places with an efficiency are
    judged each, and the rope over the pulleys beside its lines.
    """
    ropes = {rope.name: rope for rope in case.ropes}
    found: dict[str, str] = {}
    for name in names:
        rope, word = ropes.get(name), ""
        if rope is not None and _has_lines(rope):
            word = "line"
        elif rope is not None and least and any(stop.efficiency < 1.0 for stop in rope.path):
            word = "part"
        if not word or (least and word == "line"):
            found[name] = f"{name}.tension"
        if rope is not None and word:
            count = len(straight_parts(rope))
            found |= {f"{name} {word} {k}": f"{name}.segment_tension.{k}" for k in range(1, count + 1)}
    return found


def ropes_over_pulleys(case: Any, text: str) -> list[str]:
    """Ropes of lines of one force whose own tension a channel, or a combination of channels, takes."""
    owners = re.findall(r"([^\s(),.]+)\.tension(?:_max|_min)?(?![\w])", text)
    return [
        rope.name
        for rope in case.ropes
        if _has_lines(rope) and any(fnmatchcase(rope.name, one) for one in owners)
    ]


def _ratings(criterion: Any) -> list[tuple[str, Rating]]:
    found = [(name, getattr(criterion, name)) for name in type(criterion).model_fields]
    given = [(name, value) for name, value in found if isinstance(value, Rating)]
    if isinstance(criterion, CraneCriterion):
        given += [(f"curve.capacity.{i}", rating) for i, rating in enumerate(criterion.curve.capacity)]
    return given


def _check_times(case: Any, criterion: Any, key: str) -> None:
    if case.simulate is None:
        return
    duration = case.simulate.duration
    for name in ("after", "until", "static_at"):
        value = getattr(criterion, name, None)
        if isinstance(value, float) and value > duration:
            expected = f"a time within the run, up to {duration:.9g} s"
            reject(f"{value:g} s", expected, key=f"{key}.{name}")


def _check_place(case: Any, body: str, point: Sequence[float], key: str) -> None:
    """A place moves with a rigid body, or a sensor records where it is."""
    if body == GROUND or case.bodies[body].type == "rigid" or sensor_at(case, body, point):
        return
    at = ", ".join(f"{x:g}" for x in point)
    reject(f"where the point ({at}) of {body!r} is, is not recorded", "a sensor at this point", key=key)


def _check_axes(case: Any, body: str, key: str) -> None:
    if body != GROUND and case.bodies[body].type in {"frame", "shell"}:
        reject(f"{body!r} is a {case.bodies[body].type}, which has no axes", "a body with a frame", key=key)


def _check_path(case: Any, name: str, key: str) -> None:
    rope = next((one for one in case.ropes if one.name == name), None)
    if rope is None:
        reject(f"{name!r} has no path", "a rope of [[ropes]]", key=key)
    for number, stop in enumerate(rope.path):
        _check_place(case, stop.body, stop.point, key)
        if stop.radius > 0.0 or (_has_lines(rope) and number == 0):
            _check_axes(case, stop.body, key)
