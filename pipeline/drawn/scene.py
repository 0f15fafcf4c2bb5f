"""The scene to draw as plain data: what there is, how it moves, what is known of it, without any kind of thing.

Points are given in the axes of a body with a recorded pose, of the world without one (number -1). Deformations are mode
shapes with amplitudes, or recorded places of all points. What is attached to something that deforms is fixed to one of
the points of its surface. Times of records stand on timelines, which may have fewer records where there is more data.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.numerics.classes import dataclass
from heavylift.numerics.rotation import rotation_matrix
from heavylift.pipeline.drawn.roles import ROLES
from heavylift.solver.scene.outlines import bar

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.solver.scene.drawn import Drawn

__all__ = [
    "HANGING",
    "POSES",
    "SHAPES",
    "TOUCHES",
    "Anchor",
    "Arrows",
    "Disc",
    "Dot",
    "DrawnScene",
    "Label",
    "Line",
    "Pose",
    "Surface",
    "WaterShape",
]

POSES, SHAPES, HANGING, TOUCHES = range(4)
"""Timelines: of poses, of recorded shapes and stresses, of mooring lines, of forces at contacts."""
_LAID_IN = 0.97  # of the radius of a sheave: a rope lies about it
_DOTS = {"joint": 2.4, "touch": 3.0}  # radius of a dot as a solid, relative to that of ropes


class Anchor(NamedTuple):
    """Surface, and which of its points: what is fixed to it moves as that point does."""

    surface: int
    point: int


@dataclass(eq=False)
class Pose:
    """Motion of the frame of a body: position [m], shape (k, 3), unit quaternion, shape (k, 4), centre of mass.

    What has left the scene is no number.
    """

    name: str
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    centre: NDArray[np.float64]

    @property
    def matrices(self) -> NDArray[np.float64]:
        """Rotations to world axes, shape (k, 3, 3)."""
        q = self.orientation / np.linalg.norm(self.orientation, axis=1, keepdims=True)
        w, x, y, z = q.T
        rows = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        return np.moveaxis(np.array(rows), -1, 0)

    def matrix(self, k: int) -> NDArray[np.float64]:
        """Rotation to world axes at one of the poses, shape (3, 3)."""
        return rotation_matrix(self.orientation[k])

    def world(self, local: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the body, shape (3,) or (k, 3), in the world, shape (k, 3)."""
        found: NDArray[np.float64] = self.position + np.einsum(
            "kij,kj->ki", self.matrices, np.broadcast_to(local, self.position.shape)
        )
        return found

    def local(self, world: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the world, shape (k, ..., 3), in axes of the body."""
        shape = (len(self.position),) + (1,) * (world.ndim - 2) + (3,)
        return np.einsum("kji,k...j->k...i", self.matrices, world - self.position.reshape(shape))


@dataclass(eq=False, kw_only=True)
class _Drawn:
    """What all have that is drawn: whose it is, and what."""

    name: str
    role: Drawn

    @property
    def group(self) -> str:
        """What it is shown and hidden with."""
        return ROLES[self.role].group


@dataclass(eq=False, kw_only=True)
class Surface(_Drawn):
    """Triangles in the axes of a body, or of the world if `body` is -1, rigid or with a shape that changes.

    Attributes
    ----------
    body
        Number of its pose.
    points, triangles, edges
        [m], shape (n, 3); corners, shape (m, 3); kinks, shape (e, 2), None if they are not drawn. Points behind those
        of the triangles carry what is attached.
    colour, opacity
        ``"#rrggbb"``.
    background
        Whether it is wide ground or seabed, at which no camera looks.
    coarse
        Corners of fewer triangles between the same points, for a machine that is slow, shape (m', 3).
    modes, amplitudes
        Displacements, shape (nf, n, 3), and how much of each at the poses, shape (k, nf).
    shapes
        Points at the shapes' records, shape (k2, n, 3).
    stress
        [Pa], of frames alone with sign, shape (k2, n).
    anchor
        What carries it.
    offset, size
        Displacement in axes of the body, shape (k, 3), and scale about the origin, shape (k,), at the poses.
    at
        Where it stands in axes of the body.
    """

    body: int
    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    colour: str
    opacity: float = 1.0
    background: bool = False
    edges: NDArray[np.int64] | None = None
    coarse: NDArray[np.int64] | None = None
    modes: NDArray[np.float64] | None = None
    amplitudes: NDArray[np.float64] | None = None
    shapes: NDArray[np.float64] | None = None
    stress: NDArray[np.float64] | None = None
    anchor: Anchor | None = None
    offset: NDArray[np.float64] | None = None
    size: NDArray[np.float64] | None = None
    at: NDArray[np.float64] | None = None


@dataclass(eq=False, kw_only=True)
class Line(_Drawn):
    """Points fixed to bodies, or moving in their axes, in a row; or joined by segments.

    Attributes
    ----------
    on
        Body of each point, -1 for the world, shape (p,).
    local
        In its axes [m], shape (p, 3), or (k, p, 3) on the timeline.
    surface, vertex
        Surface and point whose displacement is added, -1 for none, shape (p,).
    radius
        Of the tube [m]; 0 for thin segments.
    ends
        Points of the segments, shape (e, 2).
    timeline
        Of `local`.
    tension, loose
        Force [N] and whether it is not there, at the poses, shape (k,).
    coiled
        Whether it is a spring between its two points.
    colour
        If not that of its role.
    """

    on: NDArray[np.int64]
    local: NDArray[np.float64]
    surface: NDArray[np.int64] | None = None
    vertex: NDArray[np.int64] | None = None
    radius: float = 0.0
    ends: NDArray[np.int64] | None = None
    timeline: int = POSES
    tension: NDArray[np.float64] | None = None
    loose: NDArray[np.bool_] | None = None
    coiled: bool = False
    colour: str = ""

    def __post_init__(self) -> None:
        """Its colour."""
        self.colour = self.colour or ROLES[self.role].colour

    @property
    def segments(self) -> NDArray[np.int64]:
        """Ends of its segments, shape (e, 2)."""
        if self.ends is not None:
            return self.ends
        order = np.arange(len(self.on), dtype=np.int64)
        return np.column_stack([order[:-1], order[1:]])


@dataclass(eq=False, kw_only=True)
class Disc(_Drawn):
    """A wheel about a point of a body: radius and width [m], axis in its axes; displacement at the poses, (k, 3)."""

    body: int
    at: NDArray[np.float64]
    axis: NDArray[np.float64]
    radius: float
    width: float
    anchor: Anchor | None = None
    offset: NDArray[np.float64] | None = None


@dataclass(eq=False, kw_only=True)
class Dot(_Drawn):
    """A point of a body that is marked."""

    body: int
    at: NDArray[np.float64]
    anchor: Anchor | None = None


@dataclass(eq=False, kw_only=True)
class Arrows(_Drawn):
    """Forces at points of the world.

    Attributes
    ----------
    place, force
        [m] and [N], both of shape (k, c, 3), on the timeline `TOUCHES`.
    largest
        Of the whole run [N].
    collision
        Whether its contacts come and go.
    """

    place: NDArray[np.float64]
    force: NDArray[np.float64]
    largest: float
    collision: bool = False


class Label(NamedTuple):
    """Words at a point of a body."""

    name: str
    body: int
    point: NDArray[np.float64]
    text: str


@dataclass(eq=False)
class WaterShape:
    """A window on the water, with its undisturbed waves by components."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    level: float
    waves: dict[str, NDArray[np.float64]] | None

    def elevations(self, x: NDArray[np.float64], y: NDArray[np.float64], time: float) -> NDArray[np.float64]:
        """Elevation [m] on a grid of coordinates x, shape (n,), and y, shape (m,), [m]: shape (n, m).

        A component is the product of a function of x and one of y, so that a grid is a product of two matrices.
        """
        if self.waves is None:
            return np.zeros((len(x), len(y)))
        kx, ky, omega, amplitude, phase = (
            self.waves[key] for key in ("kx", "ky", "omega", "amplitude", "phase")
        )
        amplitudes = amplitude * np.exp(-1j * (omega * time + phase))
        along, across = np.exp(1j * np.outer(x, kx)), np.exp(1j * np.outer(ky, y))
        found: NDArray[np.float64] = ((along * amplitudes) @ across).real
        return found


@dataclass(eq=False)
class DrawnScene:
    """All that is drawn of a scene and how it moves.

    Attributes
    ----------
    times
        Four timelines [s], see `POSES`.
    records
        Of the run, that the poses are those of, shape (k,).
    up
        Axis of the world that points upwards, shape (3,).
    box
        Lowest and highest corner of where bodies get [m], shape (2, 3).
    view_box
        The same with ropes, springs and joints that are near.
    reached
        The box of each body at some records, shape (n, 2, 3).
    sizes
        Diagonals of bodies [m], by name.
    scale
        How many times as large as they are deformations are drawn at first.
    signed
        Whether stresses have a sign: of frames alone.
    touches
        Whether there are contacts.
    notes
        What was left out or drawn otherwise than it is.
    """

    times: list[NDArray[np.float64]]
    up: NDArray[np.float64]
    records: NDArray[np.int64] = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    poses: list[Pose] = field(default_factory=list)
    surfaces: list[Surface] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    discs: list[Disc] = field(default_factory=list)
    dots: list[Dot] = field(default_factory=list)
    arrows: list[Arrows] = field(default_factory=list)
    water: WaterShape | None = None
    box: NDArray[np.float64] = field(default_factory=lambda: np.array([[-1.0] * 3, [1.0] * 3]))
    view_box: NDArray[np.float64] = field(default_factory=lambda: np.array([[-1.0] * 3, [1.0] * 3]))
    reached: NDArray[np.float64] = field(default_factory=lambda: np.array([[[-1.0] * 3, [1.0] * 3]]))
    sizes: dict[str, float] = field(default_factory=dict)
    scale: float = 1.0
    signed: bool = False
    touches: bool = False
    labels: list[Label] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def size(self) -> float:
        """Diagonal of the box [m]."""
        return float(np.linalg.norm(self.box[1] - self.box[0])) or 1.0

    @property
    def view_size(self) -> float:
        """Diagonal of what is looked at [m]."""
        return float(np.linalg.norm(self.view_box[1] - self.view_box[0])) or 1.0

    @property
    def largest(self) -> float:
        """Diagonal of the largest body [m]; infinite if none has a size."""
        return max((size for size in self.sizes.values() if size > 0.0), default=np.inf)

    @property
    def radius(self) -> float:
        """Of tubes that stand for ropes, slender beside the scene and beside bodies that stand far apart [m]."""
        return min(2.0e-3 * self.size, 0.02 * self.largest)

    @property
    def slim(self) -> float:
        """Radius of springs and fenders [m]."""
        return min(0.015 * self.size, 0.05 * self.largest)

    @property
    def solids(self) -> list[Surface]:
        """All surfaces, and as surfaces wheels and dots."""
        found = list(self.surfaces)
        for disc in self.discs:
            shape = bar(disc.radius, disc.width, disc.axis)
            share = _LAID_IN if disc.role == "sheave" else 1.0
            found.append(
                self._solid(disc, disc.at + share * shape.points, shape.triangles, offset=disc.offset)
            )
        for dot in self.dots:
            if dot.role in _DOTS:
                points, triangles = _octahedron(_DOTS[dot.role] * self.radius)
                found.append(self._solid(dot, dot.at + points, triangles))
        return found

    @staticmethod
    def _solid(
        one: Disc | Dot,
        points: NDArray[np.float64],
        triangles: NDArray[np.int64],
        *,
        offset: NDArray[np.float64] | None = None,
    ) -> Surface:
        return Surface(
            name=one.name, role=one.role, body=one.body, points=points, triangles=triangles, offset=offset,
            colour=ROLES[one.role].colour, anchor=one.anchor,
        )  # fmt: skip


def _octahedron(radius: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    points = radius * np.array(
        [[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0], [0, 0, 1.0], [0, 0, -1.0]]
    )
    triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    return points, np.array(triangles)
