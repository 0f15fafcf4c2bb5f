"""Tables of a case file that say what holds frames and shells.

How an edge of a shell is held, by `fix`; edges need not be along axes, but the mesh lies in a plane across one:

===========  =====================================  ============================================
``pinned``   nodes do not move                      the edge is free between its nodes
``hinged``   and the slope along the edge is held   the edge stays where it is and turns freely
``clamped``  and what is normal to the plane of     nor does it turn; the part of the slope
             the slope across and of the twist      across the edge in the plane stays free
===========  =====================================  ============================================

With `sliding` only what is normal to the plane is held: the edge is free in its plane. A simply supported plate
is ``hinged`` and `sliding`. With `twist_free` a clamp does not hold the twist: it then holds at its nodes only.
"""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, StringConstraints, model_validator

from heavylift.pipeline.case.fields import LengthVector, Section, reject
from heavylift.pipeline.case.geometry import BoxGroup

__all__ = [
    "CORNERS",
    "EDGES",
    "EdgeName",
    "FrameFixedSection",
    "FrameSupportSection",
    "NodeNumber",
    "ShellFixedSection",
    "ShellSupportSection",
]

NodeNumber = Annotated[int, Field(ge=0, strict=True)]
Axes = Annotated[str, StringConstraints(pattern="^x?y?z?$", min_length=1)]

End = Literal["start", "end"]
EdgeName = Literal["x_min", "x_max", "y_min", "y_max"]
Edge = Literal["x_min", "x_max", "y_min", "y_max", "all"]
Corner = Literal["x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max", "all"]
EDGES = ("x_min", "x_max", "y_min", "y_max")
CORNERS = ("x_min y_min", "x_max y_min", "x_max y_max", "x_min y_max")


def _listed(value: Any) -> Any:
    """A single name as a list of one."""
    return [value] if isinstance(value, str) else value


class FrameFixedSection(Section):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""

    position: Axes | None = None
    """Of the position."""
    tangent: Axes | None = None
    """Of the tangent."""


class ShellFixedSection(Section):
    """Which axes of the body are held of each vector of a node, such as ``"xz"``."""

    position: Axes | None = None
    """Of the position."""
    slope_x: Axes | None = None
    """Of the slope along x of the mesh."""
    slope_y: Axes | None = None
    """Of the slope along y of the mesh."""
    twist: Axes | None = None
    """Of the derivative of the position by both."""


class _SupportSection(Section):
    """What the supports of frames and shells have: where, and what is held there."""

    nodes: tuple[NodeNumber, ...] = ()
    """Numbers of nodes, from 0; those of a shell count along y first, or along x if it has fewer elements."""
    point: LengthVector | None = None
    """In place of `nodes`: the node at a point, in the frame of the body [m]."""
    box: BoxGroup | None = None
    """In place of `nodes`: those in a box, in the frame of the body."""

    def check_place(self, names: tuple[str, ...]) -> str:
        """The one key that says where it is, of the keys that may."""
        given = [name for name in (*names, "nodes", "point", "box") if getattr(self, name) not in (None, ())]
        if len(given) != 1:
            words = f"both {given[0]!r} and {given[1]!r}" if given else "no place"
            reject(words, f"one of {', '.join((*names, 'nodes', 'point', 'box'))}")
        return given[0]

    def check_held(self, fix: str | None, fixed: Section | None) -> None:
        """One of `fix` and `fixed`, which holds something."""
        if (fix is None) == (fixed is None):
            reject(
                "both 'fix' and 'fixed'" if fix else "neither 'fix' nor 'fixed'",
                "'fix' (a kind of support), or 'fixed' (axes by vector)",
            )
        if fixed is not None and all(getattr(fixed, name) is None for name in type(fixed).model_fields):
            reject("holds nothing", "axes of some vectors", key="fixed")


class FrameSupportSection(_SupportSection):
    """Nodes of a frame that are held to the ground."""

    at: Annotated[
        tuple[End, ...], BeforeValidator(_listed, json_schema_input_type=End | list[End]), Field(min_length=1)
    ] = Field(default=())
    """In place of `nodes`: one end or a list of both."""
    fix: Literal["pinned", "clamped"] | None = None
    """``pinned`` holds the position, ``clamped`` the position and the tangent."""
    fixed: FrameFixedSection | None = None
    """In place of `fix`: axes by vector. ``{ position = "xyz", tangent = "yz" }`` clamps the direction of a frame along
    x and leaves its stretch free."""

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        self.check_place(("at",))
        self.check_held(self.fix, self.fixed)
        return self

    @property
    def held(self) -> dict[str, str]:
        """Axes that are held, by vector."""
        if self.fixed is not None:
            return {key: axes for key, axes in self.fixed.model_dump().items() if axes}
        return {"position": "xyz"} | ({"tangent": "xyz"} if self.fix == "clamped" else {})


class ShellSupportSection(_SupportSection):
    """Nodes of a shell that are held to the ground."""

    edge: Annotated[
        tuple[Edge, ...],
        BeforeValidator(_listed, json_schema_input_type=Edge | list[Edge]),
        Field(min_length=1),
    ] = Field(default=())
    """In place of `nodes`: an edge, a list of edges, or ``all`` of them."""
    corner: Annotated[
        tuple[Corner, ...],
        BeforeValidator(_listed, json_schema_input_type=Corner | list[Corner]),
        Field(min_length=1),
    ] = Field(default=())
    """In place of `nodes`: a corner, a list of corners, or ``all`` of them."""
    fix: Literal["pinned", "hinged", "clamped"] | None = None
    """``pinned``: the nodes do not move. ``hinged``: the whole edge does not. ``clamped``: nor does it turn. Away from
    edges ``clamped`` holds the position and both slopes."""
    sliding: bool = False
    """With `fix`: only what is normal to the plane of the mesh is held, the nodes are free in it."""
    twist_free: bool = False
    """With ``clamped`` on edges: the twist is not held, and the edge turns a little between its nodes."""
    fixed: ShellFixedSection | None = None
    """In place of `fix`: axes by vector."""

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        place = self.check_place(("edge", "corner"))
        self.check_held(self.fix, self.fixed)
        if self.fixed is not None and self.sliding:
            reject("'sliding' with 'fixed'", "'fix', or axes by vector alone", key="sliding")
        if self.fix == "hinged" and place != "edge":
            reject(f"'hinged' with {place!r}", "'edge': only an edge is a hinge", key="fix")
        if self.twist_free and (self.fix != "clamped" or place != "edge"):
            reject("'twist_free' without a clamped edge", "fix 'clamped' with 'edge'", key="twist_free")
        return self

    @property
    def held(self) -> dict[str, str]:
        """Axes that are held, by vector; empty where `fix` says it, for the mesh then decides."""
        if self.fixed is None:
            return {}
        return {key: axes for key, axes in self.fixed.model_dump().items() if axes}
