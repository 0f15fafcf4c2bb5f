"""What things look like, in terms of their bodies and of channels: the answers of `drawn`.

A body, joint, force, rope, contact, hull or whatever else stands in a scene has a method ``drawn()`` that yields
elements of this module. Pictures, the page and exported files show elements, never kinds of things: whoever answers
with them is seen in all three.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = [
    "At",
    "Axes",
    "Drawn",
    "Element",
    "Filling",
    "Hanging",
    "Mark",
    "ModalShape",
    "NodalShape",
    "Offset",
    "Pad",
    "RopeLine",
    "Segments",
    "Skin",
    "Solid",
    "Spline",
    "Stop",
    "Strut",
    "Text",
    "Wheel",
]

Drawn = Literal[
    "axes",
    "body",
    "box",
    "centre",
    "contour",
    "deck",
    "fender",
    "ground",
    "hull",
    "joint",
    "mooring",
    "rod",
    "rope",
    "seabed",
    "sheave",
    "spring",
    "tank",
    "touch",
    "wheel",
]
"""Roles: what something is to who looks at it. Colour, width and group follow from it. A ``box`` stands for a body that
has nothing else, a ``hull`` for one without a surface of its own, ``centre`` is a centre of mass."""


class At(NamedTuple):
    """A point of a body, in its frame [m], shape (3,); of the ground in the world. It moves as the body deforms."""

    body: str
    point: NDArray[np.float64]


class Stop(NamedTuple):
    """A place of a rope: an end, an eye, or with a radius [m] a pulley and its axis in the frame of the body."""

    at: At
    radius: float
    axis: NDArray[np.float64]


class Offset(NamedTuple):
    """Displacement along a direction of the body, shape (3,), by a component of a recorded length [m]."""

    channel: str
    component: int
    direction: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Element:
    """What all elements have.

    Attributes
    ----------
    name
        Of the thing that is drawn; may be that of several elements.
    role
        What it is.
    """

    name: str
    role: Drawn


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid(Element):
    """Triangles that move with a body, or about a point of it.

    Attributes
    ----------
    body
        Its name, or `GROUND`.
    points, triangles
        [m], shape (n, 3), and corners, shape (m, 3).
    at
        Point of the body, shape (3,), about which `points` are; None for the frame of the body.
    edges
        Whether its kinks are drawn.
    """

    body: str
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    at: NDArray[np.float64] | None = None
    edges: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Filling(Element):
    """A ball of as much liquid as there is at a point.

    Attributes
    ----------
    at
        Its centre.
    times, masses
        Schedule [s], [kg], shape (k,), linear between.
    density
        [kg/m^3]; that of the sea if None.
    """

    at: At
    times: NDArray[np.float64]
    masses: NDArray[np.float64]
    density: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Segments(Element):
    """Straight segments between points of a body, about one of its points; `ends` are indices, shape (k, 2)."""

    at: At
    points: NDArray[np.float64]
    ends: NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Strut(Element):
    """A line from one body to another one, as a coil if it is a spring."""

    ends: tuple[At, At]
    coiled: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Mark(Element):
    """A dot."""

    at: At


@dataclass(frozen=True, eq=False, kw_only=True)
class Axes(Element):
    """Three axes, the columns of a matrix in the frame of the body, where a scene is explained before its run."""

    at: At
    axes: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Text(Element):
    """Words at a point, where a scene is explained before its run."""

    at: At
    text: str


@dataclass(frozen=True, eq=False, kw_only=True)
class RopeLine(Element):
    """A rope through places and about pulleys.

    Attributes
    ----------
    stops
        From end to end.
    tension, component
        Channel of its tension, and which of its components; the largest one if None.
    """

    stops: tuple[Stop, ...]
    tension: str
    component: int | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Wheel(Element):
    """A wheel or sheave about a point.

    Attributes
    ----------
    at, axis
        Centre, and axis in the frame of the body, shape (3,).
    radius, width
        [m].
    offset
        What lifts it.
    """

    at: At
    axis: NDArray[np.float64]
    radius: float
    width: float
    offset: Offset | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Pad(Element):
    """A pad with its face at a point, square to a normal in the frame of the body; as large as the scene needs."""

    at: At
    normal: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Hanging(Element):
    """A line in equilibrium between its ends.

    Attributes
    ----------
    ends
        From the anchor.
    line
        A `heavylift.solver.water.lines.mooring_lines.MooringLine`, from which its shape follows.
    tension
        Channel of its tension.
    """

    ends: tuple[At, At]
    line: Any
    tension: str


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalShape(Element):
    """A body whose finite elements deform by modes; its surface is that of its mesh.

    Attributes
    ----------
    nodes, shapes
        In the frame of the body [m], shape (n, 3), and mode shapes, shape (nf, n, 3).
    amplitudes
        Channel of the modal coordinates.
    start
        Modal coordinates where nothing is recorded, shape (nf,).
    """

    nodes: NDArray[np.float64]
    shapes: NDArray[np.float64]
    amplitudes: str
    start: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class NodalShape(Element):
    """A body that is where its recorded nodes are: a line through them, or triangles between them.

    What is attached to the body moves with the nearest node.

    Attributes
    ----------
    points
        Places of the nodes at the start, world [m], shape (n, 3).
    positions
        Channel of their places, x, y, z of one node after the other.
    triangles
        Shape (m, 3); None for a line.
    radius
        Of the line [m]; as that of ropes if 0.
    tension
        Channel of its tension, of which the largest component colours it; none if empty.
    """

    points: NDArray[np.float64]
    positions: str
    triangles: NDArray[np.int64] | None = None
    radius: float = 0.0
    tension: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Skin(Element):
    """A frame or shell of elements with shape functions, coloured by the stress in them."""

    body: Any


@dataclass(frozen=True, eq=False, kw_only=True)
class Spline(Element):
    """A contour of a body: a neutral curve or surface, with a radius or a width about it [m].

    `contour` is a `heavylift.solver.scene.contacts.Contour`.
    """

    contour: Any
