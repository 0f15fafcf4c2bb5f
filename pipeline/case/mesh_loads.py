"""Tables of a case file that describe loads spread over frames and shells, and their damping."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Tag, model_validator

from heavylift.pipeline.case.fields import Direction, Quantity, Section, reject, type_tag
from heavylift.pipeline.case.mesh_geometry import ElementNumber
from heavylift.pipeline.case.mesh_supports import NodeNumber

__all__ = [
    "FollowerForceSection",
    "FrameFollowerSection",
    "FrameLoad",
    "LineLoadSection",
    "MeshDampingSection",
    "PressureSection",
    "ShellLoad",
    "SurfaceLoadSection",
]

Time = Annotated[float, Quantity("time")]
Factor = Annotated[float, Quantity("number")]
LineLoad = Annotated[float, Quantity("force per length")]
SurfaceLoad = Annotated[float, Quantity("pressure")]
Force = Annotated[float, Quantity("force")]


class MeshDampingSection(Section):
    """Damping of a frame or shell."""

    viscous: Annotated[float, Quantity("rate", minimum=0.0, closed=True)] = 0.0
    """Force per mass and velocity [1/s]; it also slows the body as a whole."""
    stiffness: Annotated[float, Quantity("time", minimum=0.0, closed=True)] = 0.0
    """Stress per rate of stress [s]: damping is this times the stiffness."""


class _TimedSection(Section):
    """What all loads have: a factor over time."""

    times: tuple[Time, ...] = ()
    """Times of a table [s], increasing; constant without it."""
    factors: tuple[Factor, ...] = ()
    """What the load is multiplied by, linear in between, constant before and after."""

    @model_validator(mode="after")
    def _is_a_function(self) -> Self:
        if len(self.times) != len(self.factors):
            reject(f"{len(self.times)} times and {len(self.factors)} factors", "one factor a time")
        if any(b <= a for a, b in pairwise(self.times)):
            reject(f"times {list(self.times)}", "increasing times")
        return self


class _SpreadSection(_TimedSection):
    """What loads on elements have."""

    elements: tuple[ElementNumber, ...] = ()
    """Numbers of the elements, from 0; all if empty."""


class LineLoadSection(_SpreadSection):
    """A load along a frame that keeps its direction."""

    type: Literal["distributed"] = "distributed"
    force: tuple[LineLoad, LineLoad, LineLoad]
    """World axes, a metre of the unloaded length [N/m]."""


class _FollowerSection(Section):
    """What loads that turn with a frame have."""

    axis: Direction = (0.0, 0.0, 1.0)
    """World direction, any length; `normal` acts along ``axis x tangent``."""

    def check_load(self, normal: float, tangential: float) -> None:
        """Something must act."""
        if not (normal or tangential):
            reject("neither 'normal' nor 'tangential'", "one of them, or both")


class FrameFollowerSection(_SpreadSection, _FollowerSection):
    """A load along a frame that turns with it."""

    type: Literal["follower"]
    normal: LineLoad = 0.0
    """Along ``axis x tangent`` [N/m]."""
    tangential: LineLoad = 0.0
    """Along the tangent [N/m]."""

    @model_validator(mode="after")
    def _acts(self) -> Self:
        self.check_load(self.normal, self.tangential)
        return self


class FollowerForceSection(_TimedSection, _FollowerSection):
    """A force on one node of a frame that turns with it."""

    type: Literal["follower_force"]
    at: Literal["start", "end"] | None = None
    """The end it acts on."""
    node: NodeNumber | None = None
    """In place of `at`, the number of a node, from 0."""
    normal: Force = 0.0
    """Along ``axis x tangent`` [N]."""
    tangential: Force = 0.0
    """Along the tangent [N]."""

    @model_validator(mode="after")
    def _acts(self) -> Self:
        self.check_load(self.normal, self.tangential)
        if (self.at is None) == (self.node is None):
            reject("both 'at' and 'node'" if self.at else "neither 'at' nor 'node'", "one of them")
        return self


class SurfaceLoadSection(_SpreadSection):
    """A load on a shell that keeps its direction."""

    type: Literal["distributed"] = "distributed"
    force: tuple[SurfaceLoad, SurfaceLoad, SurfaceLoad]
    """World axes, a square metre of the unloaded area [N/m^2]."""


class PressureSection(_SpreadSection):
    """A pressure on a shell, along its normal as it turns."""

    type: Literal["pressure"]
    pressure: SurfaceLoad
    """[Pa]; along ``r_x x r_y``, which is z of a rectangle."""


def _load_type(value: Any) -> str:
    return type_tag(value, "distributed")


FrameLoad = Annotated[
    Annotated[LineLoadSection, Tag("type distributed")]
    | Annotated[FrameFollowerSection, Tag("type follower")]
    | Annotated[FollowerForceSection, Tag("type follower_force")],
    Discriminator(_load_type),
]
ShellLoad = Annotated[
    Annotated[SurfaceLoadSection, Tag("type distributed")] | Annotated[PressureSection, Tag("type pressure")],
    Discriminator(_load_type),
]
