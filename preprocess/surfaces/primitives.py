"""Simple shapes as surfaces: plane, box, sphere, capsule, cylinder.

Round shapes are a point or a segment with a rounding (Ericson, *Real-Time Collision Detection*, 2005, section 4.5,
sphere-swept volumes), exact and without facets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.outcome import InputError
from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

__all__ = ["box_surface", "capsule_surface", "cylinder_surface", "plane_surface", "sphere_surface"]

# corners of a box are numbered by the bits of x, y, z; triangles anticlockwise seen from outside
_BOX = np.array(
    [
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
    ]
)  # fmt: skip


def plane_surface(
    size: float | Sequence[float], normal: Sequence[float] = (0.0, 0.0, 1.0), *, name: str = "plane"
) -> TriangleSurface:
    """Rectangle of two triangles about the origin.

    Both sides of it can be touched, as with every plate.

    Parameters
    ----------
    size
        Length of the sides [m], or two lengths; the first side runs along x if the normal allows it, else along y.
    normal
        Not necessarily of unit length; the triangles are wound anticlockwise about it.
    """
    a, b = _positive(size, 2, "size", name)
    n = _direction(normal, "normal", name)
    # x, or y where x is close to the normal
    start = np.eye(3)[0] if abs(n[0]) < 0.9 else np.eye(3)[1]
    along = start - n * (start @ n)
    along /= np.linalg.norm(along)
    across = np.cross(n, along)
    corners = [[-a, -b], [a, -b], [a, b], [-a, b]]
    points = np.array([0.5 * (u * along + v * across) for u, v in corners])
    return TriangleSurface(points, np.array([[0, 1, 2], [0, 2, 3]]), 0.0, name)


def box_surface(size: float | Sequence[float], radius: float = 0.0, *, name: str = "box") -> TriangleSurface:
    """Box about the origin with sides along the axes, 12 triangles.

    Parameters
    ----------
    size
        Outer lengths [m]: one for a cube, or three.
    radius
        Of its rounded edges and corners [m], less than half of the shortest side.
    """
    lengths = _positive(size, 3, "size", name)
    if not 0.0 <= radius < 0.5 * lengths.min():
        raise InputError(
            f"{radius!r}",
            source=name,
            key="radius",
            expected=f"a length in m from 0 to below half of the shortest side, {0.5 * lengths.min():.6g}",
        )
    bits = (np.arange(8)[:, None] >> np.arange(3)) & 1
    return TriangleSurface((bits - 0.5) * (lengths - 2.0 * radius), _BOX, radius, name)


def sphere_surface(radius: float, *, name: str = "sphere") -> TriangleSurface:
    """Sphere about the origin [m]: a lone point with a rounding."""
    (r,) = _positive(radius, 1, "radius", name)
    return TriangleSurface(np.zeros((1, 3)), np.zeros((1, 3), dtype=np.int64), r, name)


def capsule_surface(
    radius: float, length: float, axis: ArrayLike = (0.0, 0.0, 1.0), *, name: str = "capsule"
) -> TriangleSurface:
    """Cylinder with half spheres at its ends, about the origin: a lone segment with a rounding.

    Parameters
    ----------
    radius
        Of the cylinder and the half spheres [m].
    length
        Of the segment, from centre to centre of the half spheres [m]; over all it is 2 radius longer.
    axis
        Direction of the segment, not necessarily of unit length.
    """
    (r,) = _positive(radius, 1, "radius", name)
    (whole,) = _positive(length, 1, "length", name)
    end = 0.5 * whole * _direction(axis, "axis", name)
    return TriangleSurface(np.array([-end, end]), np.array([[0, 1, 1]]), r, name)


def cylinder_surface(
    radius: float,
    length: float,
    axis: ArrayLike = (0.0, 0.0, 1.0),
    *,
    sides: int = 64,
    rounding: float = 0.0,
    name: str = "cylinder",
) -> TriangleSurface:
    """Closed prism in a cylinder about the origin.

    Its corners lie on the circle, its sides inside by up to radius (1 - cos(pi / sides)), 0.12 % of the radius for
    64 sides; a rolling one runs on that polygon. What rolls is better a capsule.

    Parameters
    ----------
    radius, length
        Outer ones [m].
    axis
        Not necessarily of unit length.
    sides
        Number of sides, at least 3.
    rounding
        Radius of the rounded rims [m], less than `radius` and half of `length`. The error of the sides is then
        (radius - rounding)(1 - cos(pi / sides)).
    """
    (r,) = _positive(radius, 1, "radius", name)
    (whole,) = _positive(length, 1, "length", name)
    if isinstance(sides, bool) or not isinstance(sides, (int, np.integer)) or sides < 3:
        raise InputError(f"{sides!r}", source=name, key="sides", expected="a whole number, at least 3")
    if not 0.0 <= rounding < min(r, 0.5 * whole):
        raise InputError(
            f"{rounding!r}",
            source=name,
            key="rounding",
            expected=f"a length in m from 0 to below {min(r, 0.5 * whole):.6g} (radius, half length)",
        )
    n = _direction(axis, "axis", name)
    start = np.eye(3)[0] if abs(n[0]) < 0.9 else np.eye(3)[1]
    u = np.cross(n, np.cross(start, n))
    u /= np.linalg.norm(u)
    v = np.cross(n, u)
    angle = 2.0 * np.pi * np.arange(sides) / sides
    ring = (r - rounding) * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)
    end = (0.5 * whole - rounding) * n
    points = np.vstack([ring - end, ring + end])
    i = np.arange(sides)
    j = (i + 1) % sides
    wall = np.vstack([np.column_stack([i, j, j + sides]), np.column_stack([i, j + sides, i + sides])])
    cap = _polygon(sides)
    return TriangleSurface(points, np.vstack([wall, cap[:, ::-1], cap + sides]), rounding, name)


def _polygon(count: int) -> NDArray[np.int64]:
    """Triangles of a convex polygon in zigzag, which makes fewer slivers than a fan, shape (count - 2, 3)."""
    rows, low, high = [], 0, count - 1
    while high - low >= 2:
        rows.append((low, low + 1, high))
        low += 1
        if high - low >= 2:
            rows.append((low, high - 1, high))
            high -= 1
    return np.array(rows)


def _positive(value: float | Sequence[float], count: int, key: str, source: str) -> NDArray[np.float64]:
    numbers = np.asarray(value, dtype=np.float64)
    if numbers.shape not in {(), (count,)} or not (np.isfinite(numbers) & (numbers > 0.0)).all():
        what = "a positive length in m" if count == 1 else f"a positive length in m, or {count} of them"
        raise InputError(f"{value!r}", source=source, key=key, expected=what)
    return np.broadcast_to(numbers, (count,))


def _direction(value: ArrayLike, key: str, source: str) -> NDArray[np.float64]:
    vector = np.asarray(value, dtype=np.float64)
    length = float(np.linalg.norm(vector)) if vector.shape == (3,) else 0.0
    if not (np.isfinite(length) and length > 0.0):
        raise InputError(f"{value!r}", source=source, key=key, expected="three numbers that are not all zero")
    return vector / length
