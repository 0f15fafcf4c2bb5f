"""What pictures are made of: lines, surfaces and marks in a colour each; shapes that touch, arrows of forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.pictures.render import Lines, Patch, Points
from heavylift.solver.scene import contacts as c

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["ROUND", "Parts", "Seen", "chain", "force_arrow", "grid_triangles", "shape_parts"]

_TOUCH, _FORCE = "#c9a227", "#c62828"
ROUND = 24
"""Corners of a circle."""
_BARB = 0.25  # of an arrow, relative to its length


class Seen(NamedTuple):
    """What is drawn in one colour each: lines, surfaces, marked points."""

    lines: tuple[Lines, ...] = ()
    patches: tuple[Patch, ...] = ()
    marks: tuple[Points, ...] = ()
    around: tuple[Lines | Patch, ...] = ()

    @property
    def points(self) -> NDArray[np.float64]:
        """All points, shape (m, 3), for the camera; without what is around, as water and moorings."""
        parts = [part.points for group in self[:3] for part in group]
        return np.concatenate(parts) if parts else np.empty((0, 3))


class Parts(NamedTuple):
    """What is drawn: lines, surfaces, marked points."""

    lines: tuple[Lines, ...] = ()
    patches: tuple[Patch, ...] = ()
    marks: tuple[Points, ...] = ()

    def placed(self, origin: NDArray[np.float64], R: NDArray[np.float64]) -> Parts:
        """The same in world axes."""
        return Parts(
            tuple(
                Lines(origin + part.points @ R.T, part.ends, part.colour, part.width, part.opacity)
                for part in self.lines
            ),
            tuple(
                Patch(origin + part.points @ R.T, part.triangles, part.colour, part.opacity)
                for part in self.patches
            ),
            tuple(Points(origin + part.points @ R.T, part.colour, part.size) for part in self.marks),
        )


def chain(count: int, closed: bool) -> NDArray[np.int64]:
    """Segments from point to point."""
    order = np.arange(count)
    pairs = np.column_stack([order, np.roll(order, -1)])
    return pairs if closed else pairs[:-1]


def grid_triangles(shape: tuple[int, ...], closed: list[bool]) -> NDArray[np.int64]:
    """Two triangles a cell of a grid of points."""
    rows, columns = shape
    numbers = np.arange(rows * columns).reshape(rows, columns)
    numbers = np.concatenate([numbers, numbers[:1]]) if closed[0] else numbers
    numbers = np.concatenate([numbers, numbers[:, :1]], axis=1) if closed[1] else numbers
    a, b, d, e = numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]
    return np.concatenate([np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, e], -1).reshape(-1, 3)])


def shape_parts(shape: c.ContactShape) -> Parts:
    """What touches, about its point, in the axes of its body; roundings of boxes and rims are left out."""
    if isinstance(shape, c.PointShape):
        return Parts(marks=(Points(np.zeros((1, 3)), _TOUCH, 12.0),))
    if isinstance(shape, c.CircleShape):
        ring = _turned(_circle(shape.radius), shape.axis)
        return Parts((Lines(ring, chain(ROUND, closed=True), _TOUCH, 3.0),))
    if isinstance(shape, c.BoxShape):
        sizes = 0.5 * np.asarray(shape.size)
        corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        triangles = np.array([t for a, b, d, e in sides for t in ((a, b, d), (a, d, e))])
        return Parts(patches=(Patch((corners * sizes) @ shape.axes.T, triangles, _TOUCH),))
    if isinstance(shape, (c.SphereShape, c.EllipsoidShape)):
        ball, triangles = _revolved(np.linspace(0.0, np.pi, 1 + ROUND // 2), None)
        sizes = shape.half_axes if isinstance(shape, c.EllipsoidShape) else np.full(3, shape.radius)
        axes = shape.axes if isinstance(shape, c.EllipsoidShape) else np.eye(3)
        return Parts(patches=(Patch((ball * sizes) @ axes.T, triangles, _TOUCH),))
    if isinstance(shape, c.CapsuleShape):
        turns = np.linspace(0.0, np.pi, 2 + ROUND // 2)
        heights = 0.5 * shape.length * np.sign(np.cos(turns))
        bar, triangles = _revolved(turns, heights, shape.radius)
    else:
        radius, half = shape.radius, 0.5 * shape.length
        rim = np.array([[0.0, half], [radius, half], [radius, -half], [0.0, -half]])
        bar, triangles = _about_axis(rim)
    return Parts(patches=(Patch(_turned(bar, shape.axis), triangles, _TOUCH),))


def _revolved(
    turns: NDArray[np.float64], heights: NDArray[np.float64] | None, radius: float = 1.0
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Ball about the z axis, its points shifted by heights."""
    z = radius * np.cos(turns)
    z = z if heights is None else z + heights
    return _about_axis(np.column_stack([radius * np.sin(turns), z]))


def _about_axis(profile: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Surface of revolution about z of points (distance from the axis, height)."""
    circle = _circle(1.0)
    points = circle[None] * profile[:, :1, None]
    points[..., 2] += profile[:, 1:]
    return points.reshape(-1, 3), grid_triangles(points.shape[:2], [False, True])


def _circle(radius: float) -> NDArray[np.float64]:
    turns = 2.0 * np.pi * np.arange(ROUND) / ROUND
    return radius * np.column_stack([np.cos(turns), np.sin(turns), np.zeros(ROUND)])


def _turned(points: NDArray[np.float64], axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points with their z axis along another one."""
    z = axis / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x = x / np.linalg.norm(x)
    turned: NDArray[np.float64] = points @ np.array([x, np.cross(z, x), z])
    return turned


def force_arrow(start: NDArray[np.float64], arrow: NDArray[np.float64]) -> Lines:
    """An arrow from a point on, with a head of four lines."""
    length = float(np.linalg.norm(arrow))
    along = arrow / length
    x = np.cross(np.eye(3)[np.argmin(np.abs(along))], along)
    x = x / np.linalg.norm(x)
    tip, back = start + arrow, start + (1.0 - _BARB) * arrow
    sides = [x, np.cross(along, x), -x, -np.cross(along, x)]
    barbs = [back + 0.35 * _BARB * length * side for side in sides]
    points = np.array([start, tip, *barbs])
    ends = np.array([[0, 1], [1, 2], [1, 3], [1, 4], [1, 5]])
    return Lines(points, ends, _FORCE, 4.0)
