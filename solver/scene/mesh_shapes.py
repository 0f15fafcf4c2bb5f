"""Meshes of frames and shells in simple shapes: arrays for `heavylift.solver.scene.meshes`."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.descriptions import Family

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "FRAME_SHAPES",
    "SHELL_SHAPES",
    "FrameMesh",
    "FrameShape",
    "ShellMesh",
    "ShellShape",
    "arc",
    "check_source",
    "grid",
    "line",
    "quadrilateral",
    "rectangle",
    "spline",
]

FRAME_SHAPES: Family[Any] = Family("geometry", "heavylift.solver.scene.frame_shapes")
"""Geometries of frames, by their types in a case file."""
SHELL_SHAPES: Family[Any] = Family("geometry", "heavylift.solver.scene.shell_shapes")
"""Those of shells."""


class FrameMesh(NamedTuple):
    """Nodes along a line, in order.

    Attributes
    ----------
    nodes
        Positions [m], shape (n + 1, 3).
    tangents
        Unit vectors, shape (n + 1, 3).
    elements
        First and second node, shape (n, 2).
    """

    nodes: NDArray[np.float64]
    tangents: NDArray[np.float64]
    elements: NDArray[np.int64]


class ShellMesh(NamedTuple):
    """A grid of nodes on a surface, numbered along the side of fewer elements first.

    Attributes
    ----------
    nodes
        Positions [m], shape (n, 3).
    slopes
        ``r_x``, ``r_y`` [1] and ``r_xy`` [1/m], shape (n, 3, 3).
    elements
        Nodes of each: origin, along x, opposite, along y; shape (e, 4). Numbered like the nodes.
    lengths
        Along x and y [m], shape (e, 2).
    edges
        Nodes of ``"x_min"``, ``"x_max"`` in order along y, of ``"y_min"``, ``"y_max"`` in order along x.
    corners
        Nodes at the origin, along x, opposite, along y; shape (4,).
    """

    nodes: NDArray[np.float64]
    slopes: NDArray[np.float64]
    elements: NDArray[np.int64]
    lengths: NDArray[np.float64]
    edges: dict[str, NDArray[np.int64]]
    corners: NDArray[np.int64]


class FrameShape(ABC):
    """Base of the description of a line that is cut into elements."""

    ORDER: ClassVar[float] = math.inf
    """Place in lists; those without one follow by the alphabet."""
    CURVED: ClassVar = False
    """Whether its elements are curved."""

    @staticmethod
    def count(spec: Any) -> int:
        """Elements, as far as they are known without a file."""
        return int(spec.elements or 1)

    @abstractmethod
    def mesh(self) -> FrameMesh:
        """Its mesh."""


class ShellShape(ABC):
    """Base of the description of an outline that is cut into elements, with a key ``elements``."""

    ORDER: ClassVar[float] = math.inf
    """Place in lists; those without one follow by the alphabet."""

    @staticmethod
    def counts(spec: Any) -> tuple[int, int]:
        """Elements along x and y: one number is both."""
        given = spec.elements
        return (given, given) if isinstance(given, int) else (given[0], given[1])

    @classmethod
    def count(cls, spec: Any) -> float:
        """Elements, a number that may be too large for memory."""
        nx, ny = cls.counts(spec)
        return float(nx) * float(ny)

    @abstractmethod
    def mesh(self) -> ShellMesh:
        """Its mesh."""


def check_source(spec: Any) -> None:
    """Refuse a geometry that has points and a file, or neither.

    Raises
    ------
    InputError
        If it is so.
    """
    if (len(spec.points) > 0) == (spec.file is not None):
        problem = "both 'points' and 'file'" if len(spec.points) else "neither 'points' nor 'file'"
        raise InputError(problem, expected="one of them")


def _points(name: str, values: ArrayLike, shape: tuple[int, ...] | None = None) -> NDArray[np.float64]:
    array = np.asarray(values, dtype=np.float64)
    if not np.all(np.isfinite(array)) or (shape is not None and array.shape != shape):
        raise InputError(
            f"{array.tolist()}", key=name, expected=f"finite numbers of shape {shape or '(n, 3)'}"
        )
    return array


def _count(name: str, value: int) -> int:
    if value != int(value) or value < 1:
        raise InputError(f"{value}", key=name, expected="a whole number, 1 or more")
    return int(value)


def rectangle(length_x: float, length_y: float, nx: int, ny: int) -> ShellMesh:
    """Elements of equal size on a rectangle in the plane z = 0, from the origin along x and y.

    Parameters
    ----------
    length_x, length_y
        Sides [m].
    nx, ny
        Elements along them.

    Raises
    ------
    InputError
        If a side is not positive or a number not a whole one.
    """
    for name, value in (("length_x", length_x), ("length_y", length_y)):
        if not 0.0 < value < np.inf:
            raise InputError(f"{value}", key=name, expected="a positive length")
    corners = [[0.0, 0.0, 0.0], [length_x, 0.0, 0.0], [length_x, length_y, 0.0], [0.0, length_y, 0.0]]
    return quadrilateral(np.array(corners), nx, ny)


def quadrilateral(corners: ArrayLike, nx: int, ny: int) -> ShellMesh:
    """Elements on a quadrilateral with straight sides, between lines that divide its sides equally.

    Parameters
    ----------
    corners
        Origin, along x, opposite, along y [m], shape (4, 3).
    nx, ny
        Elements along its sides.

    Raises
    ------
    InputError
        If corners coincide or a number is not a whole one.
    """
    at = _points("corners", corners, (4, 3))
    u = np.linspace(0.0, 1.0, _count("nx", nx) + 1)[:, np.newaxis, np.newaxis]
    v = np.linspace(0.0, 1.0, _count("ny", ny) + 1)[np.newaxis, :, np.newaxis]
    return grid((1 - u) * (1 - v) * at[0] + u * (1 - v) * at[1] + u * v * at[2] + (1 - u) * v * at[3])


def grid(points: ArrayLike) -> ShellMesh:
    """Elements between given points in rows and columns.

    Parameters
    ----------
    points
        Positions [m], shape (nx + 1, ny + 1, 3).

    Raises
    ------
    InputError
        If there are too few points, or neighbours along a line coincide.

    Notes
    -----
    A strip of elements has one length, the mean distance of its points, so that slopes are continuous across
    edges. Slopes are those of parabolas through neighbours along the grid lines: exact for quadrilaterals.
    """
    at = _points("points", points)
    if at.ndim != 3 or at.shape[2] != 3 or min(at.shape[:2]) < 2:
        raise InputError(
            f"shape {at.shape}", key="points", expected="(nx + 1, ny + 1, 3), nx and ny 1 or more"
        )
    strips = []
    for axis, name in enumerate("xy"):
        distances = np.linalg.norm(np.diff(at, axis=axis), axis=2)
        if not np.all(distances > 0.0):
            raise InputError(
                "two neighbours are at one place", key="points", expected=f"a distance along {name}"
            )
        strips.append(distances.mean(axis=1 - axis))
    a, b = strips
    along_x, along_y = _slopes(at, a, 0), _slopes(at, b, 1)
    twist = _slopes(along_x, b, 1)
    nx, ny = len(a), len(b)
    i, j = np.meshgrid(np.arange(nx + 1), np.arange(ny + 1), indexing="ij")
    number = i * (ny + 1) + j if ny <= nx else j * (nx + 1) + i
    order = np.argsort(number.ravel())
    slopes = np.stack([along_x, along_y, twist], axis=2).reshape(-1, 3, 3)
    corners = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    lengths = np.stack(np.broadcast_arrays(a[:, np.newaxis], b[np.newaxis, :]), axis=-1)
    if ny > nx:
        corners, lengths = corners.swapaxes(0, 1), lengths.swapaxes(0, 1)
    return ShellMesh(
        nodes=at.reshape(-1, 3)[order],
        slopes=slopes[order],
        elements=corners.reshape(-1, 4).astype(np.int64),
        lengths=lengths.reshape(-1, 2).copy(),
        edges={"x_min": number[0], "x_max": number[-1], "y_min": number[:, 0], "y_max": number[:, -1]},
        corners=np.array([number[0, 0], number[-1, 0], number[-1, -1], number[0, -1]]),
    )


def _slopes(values: NDArray[np.float64], lengths: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Derivatives along an axis of the parabolas through three neighbours at given distances."""
    places = np.concatenate([[0.0], np.cumsum(lengths)])
    return np.asarray(np.gradient(values, places, axis=axis, edge_order=2 if len(lengths) > 1 else 1))


def _chain(count: int) -> NDArray[np.int64]:
    return np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)


def line(start: ArrayLike, end: ArrayLike, n: int) -> FrameMesh:
    """Elements of equal length on a straight line.

    Parameters
    ----------
    start, end
        Its ends [m], shape (3,).
    n
        Elements.

    Raises
    ------
    InputError
        If the ends coincide.
    """
    first, last = _points("start", start, (3,)), _points("end", end, (3,))
    count, length = _count("n", n), float(np.linalg.norm(last - first))
    if length == 0.0:
        raise InputError(f"{last.tolist()}", key="end", expected="another place than the start")
    nodes = first + np.linspace(0.0, 1.0, count + 1)[:, np.newaxis] * (last - first)
    return FrameMesh(nodes, np.tile((last - first) / length, (count + 1, 1)), _chain(count))


def arc(
    centre: ArrayLike,
    radius: float,
    start_angle: float,
    end_angle: float,
    n: int,
    axes: ArrayLike = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
) -> FrameMesh:
    """Elements of equal length on an arc of a circle.

    Parameters
    ----------
    centre, radius
        [m].
    start_angle, end_angle
        From the first axis towards the second [rad]; the end may be less than the start.
    n
        Elements.
    axes
        Two directions of any length that span the plane; the second is made perpendicular to the first, shape (2, 3).

    Raises
    ------
    InputError
        If the radius is not positive, the angles are equal or the axes parallel.
    """
    middle, given, count = _points("centre", centre, (3,)), _points("axes", axes, (2, 3)), _count("n", n)
    if not 0.0 < radius < np.inf:
        raise InputError(f"{radius}", key="radius", expected="a positive length")
    if not np.isfinite(start_angle) or not np.isfinite(end_angle) or end_angle == start_angle:
        raise InputError(f"{end_angle}", key="end_angle", expected="another angle than the start [rad]")
    normal = np.cross(given[0], given[1])
    if not np.linalg.norm(normal) > 1e-9 * np.linalg.norm(given[0]) * np.linalg.norm(given[1]):
        raise InputError(f"{given.tolist()}", key="axes", expected="two directions that are not parallel")
    first = given[0] / np.linalg.norm(given[0])
    second = np.cross(normal, first)
    second /= np.linalg.norm(second)
    angles = np.linspace(start_angle, end_angle, count + 1)[:, np.newaxis]
    tangents = np.sign(end_angle - start_angle) * (np.cos(angles) * second - np.sin(angles) * first)
    nodes = middle + radius * (np.cos(angles) * first + np.sin(angles) * second)
    return FrameMesh(nodes, tangents, _chain(count))


def spline(points: ArrayLike, n: int | None = None) -> FrameMesh:
    """Elements on a smooth curve through points.

    Parameters
    ----------
    points
        In order [m], shape (m, 3), 2 or more.
    n
        Elements, of equal arc length; by default the points are the nodes.

    Raises
    ------
    InputError
        If there are too few points or neighbours coincide.

    Notes
    -----
    Cubic spline over the distance between points, of which the third derivative is continuous at the second and the
    last but one ("not a knot").
    """
    from scipy.interpolate import CubicSpline

    at = _points("points", points)
    if at.ndim != 2 or at.shape[1] != 3 or len(at) < 2:
        raise InputError(f"shape {at.shape}", key="points", expected="(m, 3), m 2 or more")
    chords = np.linalg.norm(np.diff(at, axis=0), axis=1)
    if not np.all(chords > 0.0):
        raise InputError("two neighbours are at one place", key="points", expected="a distance between them")
    knots = np.concatenate([[0.0], np.cumsum(chords)])
    curve = CubicSpline(knots, at)
    places = knots if n is None else _equal_lengths(curve, knots, _count("n", n))
    tangents = curve(places, 1)
    return FrameMesh(
        curve(places), tangents / np.linalg.norm(tangents, axis=1, keepdims=True), _chain(len(places) - 1)
    )


def _equal_lengths(curve: object, knots: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Parameters that divide a curve into parts of equal arc length."""
    points, weights = np.polynomial.legendre.leggauss(8)
    fine = np.unique(np.concatenate([np.linspace(a, b, 17) for a, b in pairwise(knots)]))

    def length(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
        half = 0.5 * (end - start)
        at = (start + half)[:, np.newaxis] + half[:, np.newaxis] * points
        return half * (np.linalg.norm(curve(at, 1), axis=-1) @ weights)  # type: ignore[operator]

    along = np.concatenate([[0.0], np.cumsum(length(fine[:-1], fine[1:]))])
    wanted = np.linspace(0.0, along[-1], count + 1)
    piece = np.clip(np.searchsorted(along, wanted, side="right") - 1, 0, len(fine) - 2)
    places = np.interp(wanted, along, fine)
    for _ in range(30):  # Newton's method within each piece
        rest = wanted - along[piece] - length(fine[piece], places)
        places = places + rest / np.linalg.norm(curve(places, 1), axis=-1)  # type: ignore[operator]
        if np.all(np.abs(rest) <= 1e-14 * along[-1]):
            break
    places[0], places[-1] = knots[0], knots[-1]
    return places
