"""Tables of a case file that describe ropes."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from heavylift.pipeline.case.fields import (
    GROUND,
    Direction,
    LengthVector,
    Positive,
    Quantity,
    Section,
    SideName,
    UniqueName,
    reject,
    type_tag,
)
from heavylift.solver.scene.connections import ROPE_CHANNELS

__all__ = ["PathPointSection", "Rope", "SpringRopeSection", "WinchSection", "WireRopeSection"]


class PathPointSection(Section):
    """A place the rope passes: an end, an eye, or a pulley."""

    body: SideName
    """Body that carries it, or ``"ground"``."""
    point: LengthVector
    """The place, of a pulley its centre [m], in the coordinates of the geometry of the body; of the ground in the
    world."""
    radius: Annotated[float, Quantity("length", minimum=0.0, closed=True)] = 0.0
    """Of the pulley [m]; 0 for an end or an eye."""
    axis: Direction | None = None
    """Of the pulley, in the coordinates of the geometry of the body; of the ground in the world. The rope runs about
    the pulley in the sense of a turn about this axis."""

    @model_validator(mode="after")
    def _is_a_pulley(self) -> "PathPointSection":
        if self.radius > 0.0 and self.axis is None:
            reject("a pulley without 'axis'", "the direction about which the rope turns", key="axis")
        if self.radius == 0.0 and self.axis is not None:
            reject("'axis' without 'radius'", "'radius' and 'axis' of a pulley, or neither", key="axis")
        return self


class WinchSection(Section):
    """Speed of a winch, linear between the times, held before the first and after the last."""

    times: Annotated[tuple[Annotated[float, Quantity("time")], ...], Field(min_length=1)]
    """[s], increasing."""
    speeds: Annotated[tuple[Annotated[float, Quantity("velocity")], ...], Field(min_length=1)]
    """[m/s]; hauls in if positive."""

    @model_validator(mode="after")
    def _is_a_function(self) -> "WinchSection":
        if len(self.times) != len(self.speeds):
            reject(f"{len(self.times)} times and {len(self.speeds)} speeds", "one speed a time")
        if any(b <= a for a, b in pairwise(self.times)):
            reject(f"times {list(self.times)}", "increasing times")
        return self


def _not_all_ground(path: tuple[PathPointSection, ...]) -> tuple[PathPointSection, ...]:
    if all(stop.body == GROUND for stop in path):
        reject("all its points are on the ground", "a point on a body")
    return path


class WireRopeSection(Section):
    """A wire rope through any number of points, with one tension all along: it pulls and never pushes."""

    CHANNELS: ClassVar = ROPE_CHANNELS

    type: Literal["wire"] = "wire"
    name: UniqueName
    """Name; the first part of its channels."""
    path: Annotated[tuple[PathPointSection, ...], Field(min_length=2)]
    """Two and more places, from end to end."""
    axial_stiffness: Annotated[float, Positive("force")]
    """EA [N]: modulus times area."""
    length: Annotated[float, Positive("length")] | None = None
    """Unstretched length at the start [m]; as drawn if absent."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """Tension per rate of elongation [N s/m], while it is taut."""
    winch: WinchSection | None = None
    """How its length changes."""

    @field_validator("path")
    @classmethod
    def _goes_somewhere(cls, path: tuple[PathPointSection, ...]) -> tuple[PathPointSection, ...]:
        for place in (0, len(path) - 1):
            if path[place].radius > 0.0:
                reject("a pulley at an end", "ends without 'radius'", key=f"{place}.radius")
        return _not_all_ground(path)


class SpringRopeSection(Section):
    """A rope between two points that pulls like a spring and never pushes."""

    CHANNELS: ClassVar = ROPE_CHANNELS

    type: Literal["spring"]
    name: UniqueName
    """Name; the first part of its channels."""
    path: tuple[PathPointSection, PathPointSection]
    """Its two ends."""
    stiffness: Annotated[float, Positive("stiffness")]
    """[N/m]."""
    length: Annotated[float, Quantity("length", minimum=0.0, closed=True)] | None = None
    """Unloaded length [m]; as drawn if absent."""
    damping: Annotated[float, Quantity("damping", minimum=0.0, closed=True)] = 0.0
    """[N s/m], while it is taut."""

    @field_validator("path")
    @classmethod
    def _goes_straight(
        cls, path: tuple[PathPointSection, PathPointSection]
    ) -> tuple[PathPointSection, PathPointSection]:
        for place, stop in enumerate(path):
            if stop.radius > 0.0:
                reject("a pulley in a rope of type 'spring'", "type 'wire'", key=f"{place}.radius")
        _not_all_ground(path)
        return path


def _rope_type(value: Any) -> str:
    return type_tag(value, "wire")


Rope = Annotated[
    Annotated[WireRopeSection, Tag("type wire")] | Annotated[SpringRopeSection, Tag("type spring")],
    Discriminator(_rope_type),
]
