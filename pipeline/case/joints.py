"""Tables of a case file that describe joints: what all have, and where they are; the rest is in `solver.joints`."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from functools import cache
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, ValidationInfo, field_validator, model_validator

from heavylift.pipeline.case.described import Chosen, checked, make_section
from heavylift.pipeline.case.fields import (
    AnyOf,
    BodyPlace,
    CaseContext,
    Direction,
    LengthVector,
    NodeNumber,
    Positive,
    Quantity,
    Section,
    SideName,
    UniqueName,
    reject,
)
from heavylift.solver.scene import connections as c
from heavylift.solver.scene.connections import Between, Place
from heavylift.solver.scene.descriptions import is_parallel

__all__ = [
    "AngleLimitsSection",
    "EdgeJointSection",
    "Joint",
    "JointSection",
    "TravelLimitsSection",
    "joint_section",
]

EdgeName = Literal["x_min", "x_max", "y_min", "y_max"]
Sides = tuple[SideName, SideName]
Pair = tuple[BodyPlace, BodyPlace]
Axes = tuple[Direction, Direction]
_COMPLIANCE = Annotated[float, Quantity("compliance", minimum=0.0, closed=True)]
AnyCompliance = Annotated[
    float,
    AnyOf(
        Quantity("compliance", minimum=0.0, closed=True),
        Quantity("angular compliance", minimum=0.0, closed=True),
    ),
]
Angle = Annotated[float, Quantity("angle")]
Length = Annotated[float, Quantity("length")]


class AngleLimitsSection(Section):
    """Stops of an angle: a spring and a damper beyond each."""

    lower: Angle | None = None
    """Smallest angle [rad]; none if absent."""
    upper: Angle | None = None
    """Largest angle [rad]; none if absent."""
    stiffness: Annotated[float, Positive("angular stiffness")]
    """Of the stops [N m/rad]."""
    damping: Annotated[float, Quantity("angular damping", minimum=0.0, closed=True)] = 0.0
    """Of the stops [N m s/rad]."""

    @model_validator(mode="after")
    def _is_a_range(self) -> "AngleLimitsSection":
        _check_range(self.lower, self.upper, "rad")
        return self


class TravelLimitsSection(Section):
    """Stops of a travel: a spring and a damper beyond each."""

    lower: Length | None = None
    """Smallest travel [m]; none if absent."""
    upper: Length | None = None
    """Largest travel [m]; none if absent."""
    stiffness: Annotated[float, Positive("stiffness")]
    """Of the stops [N/m]."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Of the stops [N s/m]."""

    @model_validator(mode="after")
    def _is_a_range(self) -> "TravelLimitsSection":
        _check_range(self.lower, self.upper, "m")
        return self


def _check_range(lower: float | None, upper: float | None, unit: str) -> None:
    if lower is None and upper is None:
        reject("neither 'lower' nor 'upper'", "one of them, or both")
    if lower is not None and upper is not None and lower >= upper:
        reject(f"lower = {lower:g} {unit} is not below upper = {upper:g} {unit}", "lower < upper")


class JointSection(Section):
    """What all joints have."""

    name: UniqueName
    """Name; the first part of its channels."""
    between: Sides
    """Its two sides a and b: names of bodies, or ``"ground"`` for the world."""
    compliance: AnyCompliance = 0.0
    """Physical compliance of its rows [m/N], and [rad/(N m)] with the same number; 0 is rigid."""
    relaxation: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Time [s] in which a violation decays; a compliant joint is damped by it."""

    @field_validator("between")
    @classmethod
    def _joins_two(cls, value: tuple[str, str]) -> tuple[str, str]:
        checked(Between.check_sides, value)
        return value


class PlacedJointSection(JointSection):
    """What all joints have whose two points coincide in some way."""

    at: LengthVector | None = None
    """Where it is at the start [m], in the world, for both sides."""
    points: Pair | None = None
    """In place of `at`, one point a side [m] in the coordinates of the geometry of the body, or the name of an
    interface of it; of the ground in the world."""

    @model_validator(mode="after")
    def _has_a_place(self) -> "PlacedJointSection":
        if (self.at is None) == (self.points is None):
            reject(
                "both 'at' and 'points'" if self.points else "neither 'at' nor 'points'",
                "'at' (a point in the world), or 'points' (one a side, in coordinates of the bodies)",
            )
        return self


class AxisJointSection(PlacedJointSection):
    """What all joints with an axis have."""

    axis: Direction | None = None
    """World direction of its axis at the start, any length, for both sides: z of the joint frames."""
    axes: Axes | None = None
    """In place of `axis`, one direction a side in the coordinates of the geometry of the body; of the ground in the
    world."""
    reference: Direction | None = None
    """World direction of x of the joint frames at the start, where an angle is zero; chosen if absent."""

    @model_validator(mode="after")
    def _has_an_axis(self) -> "AxisJointSection":
        if (self.axis is None) == (self.axes is None):
            reject(
                "both 'axis' and 'axes'" if self.axes else "neither 'axis' nor 'axes'",
                "'axis' (a direction in the world), or 'axes' (one a side, in coordinates of the bodies)",
            )
        if self.axis is not None and self.reference is not None and is_parallel(self.axis, self.reference):
            reject(
                f"{_shown(self.reference)} is parallel to the axis",
                "a direction across the axis",
                key="reference",
            )
        return self


def _shown(vector: tuple[float, float, float]) -> str:
    return "[" + ", ".join(f"{entry:g}" for entry in vector) + "]"


class CrossJointSection(AxisJointSection):
    """What joints have with an axis on either side, perpendicular to each other."""

    second_axis: Direction | None = None
    """With `axis`, the axis of a: world direction of the axis of b at the start, any length."""

    @model_validator(mode="after")
    def _is_a_cross(self) -> "CrossJointSection":
        if self.axes is not None and self.second_axis is not None:
            reject("both 'axes' and 'second_axis'", "'axis' and 'second_axis', or 'axes'")
        if self.axis is not None and self.second_axis is None:
            reject("'axis' without 'second_axis'", "the axis of b, perpendicular to that of a")
        if (
            self.axis is not None
            and self.second_axis is not None
            and is_parallel(self.axis, self.second_axis)
        ):
            problem = f"{_shown(self.second_axis)} is parallel to axis = {_shown(self.axis)}"
            reject(problem, "a direction perpendicular to 'axis'", key="second_axis")
        return self


class ApartJointSection(JointSection):
    """What joints have whose two points lie apart."""

    points: Pair
    """One point a side [m] in the coordinates of the geometry of the body, or the name of an interface of it; of the
    ground in the world."""


NodeList = Annotated[tuple[NodeNumber, ...], Field(min_length=2)]


def _list_tag(value: Any) -> str:
    """Whether nodes are given as one list or as a list of lists."""
    nested = isinstance(value, (list, tuple)) and any(isinstance(entry, (list, tuple)) for entry in value)
    return "lists" if nested else "list"


class EdgeJointSection(JointSection):
    """What joints along edges of shells have."""

    edge: EdgeName | None = None
    """Edge of the shell, the first of its sides."""
    edges: tuple[EdgeName, EdgeName] | None = None
    """In place of `edge`, between two shells: an edge of each. They have the same nodes at the start."""
    nodes: Annotated[
        Annotated[NodeList, Tag("list")] | Annotated[tuple[NodeList, NodeList], Tag("lists")],
        Discriminator(_list_tag),
    ] = ()
    """In place of names: numbers of nodes along a line of the mesh, in order; between two shells two such lists."""

    @field_validator("between")
    @classmethod
    def _has_a_shell_first(cls, value: tuple[str, str], info: ValidationInfo) -> tuple[str, str]:
        context = CaseContext.of(info)
        if context is None:
            return value
        shells, meshes = context.names.shells, context.names.meshes
        if value[0] not in shells:
            turned = value[1] in shells
            reject(
                f"{value[0]!r} is no shell",
                f'["{value[1]}", "{value[0]}"]: the shell first' if turned else "a shell first",
            )
        if value[1] in meshes - shells:
            reject(f"{value[1]!r} is a frame", "a shell, and 'ground', a rigid or flexible body, or a shell")
        return value

    @model_validator(mode="after")
    def _has_its_edges(self, info: ValidationInfo) -> Self:
        given = [key for key in ("edge", "edges", "nodes") if getattr(self, key) not in (None, ())]
        if len(given) != 1:
            words = f"both {given[0]!r} and {given[1]!r}" if given else "no edge"
            reject(words, "one of edge, edges, nodes")
        context = CaseContext.of(info)
        if context is None:
            return self
        count = {"edge": 1, "edges": 2, "nodes": len(self.node_lists)}[given[0]]
        wanted = 2 if self.between[1] in context.names.shells else 1
        if count != wanted:
            first, other = self.between
            reject(
                f"edges of two shells, and {other!r} is none"
                if wanted == 1
                else f"an edge of {first!r}, and none of {other!r}",
                "'edge', or one list of nodes"
                if wanted == 1
                else "'edges', or two lists of nodes: one a shell",
                key=given[0],
            )
        return self

    @property
    def node_lists(self) -> tuple[tuple[int, ...], ...]:
        """Lists of nodes, one a shell; none where edges are named."""
        if not self.nodes:
            return ()
        return (self.nodes,) if isinstance(self.nodes[0], int) else self.nodes


_PLACES: dict[Place, type[JointSection]] = {
    Place.POINT: PlacedJointSection,
    Place.AXIS: AxisJointSection,
    Place.CROSS: CrossJointSection,
    Place.APART: ApartJointSection,
    Place.EDGE: EdgeJointSection,
}
"""What a joint says of where it is."""


def _limits_section(quantity: Quantity) -> Any:
    return AngleLimitsSection if quantity.kind == "angle" else TravelLimitsSection


@cache
def joint_section(described: type[c.Joint]) -> type[Section]:
    """Section of a type of joints."""
    base = _PLACES[described.PLACE]
    turning = described.ROTATIONAL
    changed = {"compliance": (_COMPLIANCE, 0.0)} if turning and not any(turning) else None
    return make_section(described, base, {c.Limits: _limits_section}, changed)


Joint = Annotated[Any, Chosen(c.JOINTS, joint_section)]
"""A joint of any type."""
