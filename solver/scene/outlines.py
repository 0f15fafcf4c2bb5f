"""Triangles and lines of simple shapes: boxes, balls, bars, rings, and of surfaces with lone points and segments."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = [
    "ROUND",
    "Outline",
    "ball",
    "bar",
    "box",
    "box_corners",
    "capsule",
    "chain",
    "grid_triangles",
    "height_grid",
    "inertia_box",
    "pad",
    "profile_strip",
    "ring",
    "surface_triangles",
]

ROUND = 24
"""Corners of a circle."""
_THIN = 0.02  # of the longest side: least other side of a box, which would not be seen otherwise


class Outline(NamedTuple):
    """What a shape looks like: points [m], shape (n, 3), triangles, shape (m, 3), and segments, shape (k, 2).

    A lone point has neither triangles nor segments.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64] = np.empty((0, 3), dtype=np.int64)
    ends: NDArray[np.int64] = np.empty((0, 2), dtype=np.int64)


def chain(count: int, closed: bool) -> NDArray[np.int64]:
    """Segments from point to point, shape (count, 2), or one less if the chain is open."""
    order = np.arange(count)
    pairs = np.column_stack([order, np.roll(order, -1)])
    return pairs if closed else pairs[:-1]


def grid_triangles(shape: tuple[int, ...], closed: list[bool]) -> NDArray[np.int64]:
    """Two triangles for each cell of a grid of points."""
    rows, columns = shape
    numbers = np.arange(rows * columns).reshape(rows, columns)
    numbers = np.concatenate([numbers, numbers[:1]]) if closed[0] else numbers
    numbers = np.concatenate([numbers, numbers[:, :1]], axis=1) if closed[1] else numbers
    a, b, d, e = numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]
    return np.concatenate([np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, e], -1).reshape(-1, 3)])


def box(size: ArrayLike, axes: ArrayLike) -> Outline:
    """Box with sides [m] along the columns of a matrix, about the origin."""
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, d, e in sides for t in ((a, b, d), (a, d, e))])
    return Outline((corners * (0.5 * np.asarray(size))) @ np.asarray(axes).T, triangles)


def ball(half_axes: ArrayLike, axes: ArrayLike | None = None) -> Outline:
    """Ellipsoid about the origin with half axes [m] along the columns of a matrix."""
    points, triangles = _revolved(np.linspace(0.0, np.pi, 1 + ROUND // 2), None)
    turned = np.eye(3) if axes is None else np.asarray(axes)
    return Outline((points * np.asarray(half_axes, dtype=np.float64)) @ turned.T, triangles)


def capsule(radius: float, length: float, axis: NDArray[np.float64]) -> Outline:
    """Round bar about the origin, with half balls beyond its length [m]."""
    turns = np.linspace(0.0, np.pi, 2 + ROUND // 2)
    points, triangles = _revolved(turns, 0.5 * length * np.sign(np.cos(turns)), radius)
    return Outline(_turned(points, axis), triangles)


def bar(radius: float, length: float, axis: NDArray[np.float64]) -> Outline:
    """Round bar with flat ends about the origin; rounded rims are left out."""
    half = 0.5 * length
    rim = np.array([[0.0, half], [radius, half], [radius, -half], [0.0, -half]])
    points, triangles = _about_axis(rim)
    return Outline(_turned(points, axis), triangles)


def ring(radius: float, axis: NDArray[np.float64]) -> Outline:
    """Circle about the origin with a normal."""
    return Outline(_turned(_circle(radius), axis), ends=chain(ROUND, closed=True))


def pad(tip: NDArray[np.float64], normal: NDArray[np.float64], radius: float) -> Outline:
    """A disc as thick as its radius whose face with a normal lies at a point."""
    n = normal / np.linalg.norm(normal)
    found = bar(radius, radius, n)
    return Outline(tip - 0.5 * radius * n + found.points, found.triangles)


def inertia_box(mass: float, inertia: ArrayLike, centre: ArrayLike) -> Outline:
    """Homogeneous box with a mass and principal moments of inertia, eight points.

    Parameters
    ----------
    mass
        [kg].
    inertia
        About the centre of mass [kg m^2], shape (3, 3).
    centre
        Centre of mass [m], shape (3,).

    Notes
    -----
    From ``J_1 = m (b^2 + c^2) / 12`` and its permutations, ``a^2 = 6 (J_2 + J_3 - J_1) / m``. A rod or a plate is
    drawn with a fiftieth of its length as its least side.
    """
    J, axes = np.linalg.eigh(np.asarray(inertia, dtype=np.float64))
    sides = np.sqrt(np.maximum(6.0 * (J.sum() - 2.0 * J) / mass, 0.0))
    found = box(np.maximum(sides, _THIN * sides.max()), np.eye(3))
    return Outline(np.asarray(centre, dtype=np.float64) + found.points @ axes.T, found.triangles)


def profile_strip(
    stations: NDArray[np.float64], heights: NDArray[np.float64], sides: tuple[float, float]
) -> Outline:
    """A strip as wide as its sides along a profile: along x, over y, heights along z."""
    count = len(stations)
    points = np.concatenate([np.column_stack([stations, np.full(count, side), heights]) for side in sides])
    i = np.arange(count - 1)
    return Outline(
        points,
        np.concatenate(
            [np.column_stack([i, i + 1, i + count]), np.column_stack([i + 1, i + count + 1, i + count])]
        ),
    )


def height_grid(x: NDArray[np.float64], y: NDArray[np.float64], heights: NDArray[np.float64]) -> Outline:
    """Heights over a grid, shape (n, m): four triangles for each cell, about its middle."""
    n, m = heights.shape
    corners = np.column_stack([np.repeat(x, m), np.tile(y, n), heights.ravel()])
    i, k = (index.ravel() for index in np.indices((n - 1, m - 1)))
    around = np.array([i * m + k, (i + 1) * m + k, (i + 1) * m + k + 1, i * m + k + 1])
    middle = n * m + np.arange(len(i))
    triangles = [np.column_stack([around[a], around[(a + 1) % 4], middle]) for a in range(4)]
    return Outline(np.vstack([corners, corners[around].mean(axis=0)]), np.concatenate(triangles))


def box_corners(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners of the box around points, shape (8, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([np.where([i & 4, i & 2, i & 1], high, low) for i in range(8)])


def surface_triangles(
    surface: TriangleSurface,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """What a surface looks like: lone points and segments as the balls and capsules that they are.

    Returns
    -------
    tuple
        Points, shape (n, 3), triangles, shape (m, 3), and the row of the surface that each is drawn for, shape (m,).
    """
    faces = surface.faces
    found, triangles, source = [surface.points], [surface.triangles[faces]], [np.flatnonzero(faces)]
    count = len(surface.points)
    for row in np.flatnonzero(~faces):
        a, c = surface.points[surface.triangles[row, 0]], surface.points[surface.triangles[row, 2]]
        length = float(np.linalg.norm(c - a))
        radius = surface.radius
        shape = ball(np.full(3, radius)) if length == 0.0 else capsule(radius, 0.5 * length, (c - a) / length)
        found.append(0.5 * (a + c) + shape.points)
        triangles.append(shape.triangles + count)
        source.append(np.full(len(shape.triangles), row))
        count += len(shape.points)
    return np.concatenate(found), np.concatenate(triangles), np.concatenate(source)


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
