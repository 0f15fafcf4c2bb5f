"""Distance to rigid primitives: core shapes with a radius about them, packed into records for the kernels.

The distance of a point to a primitive is the signed distance phi to its core less the radius: point (ball), segment
(capsule), box (rounded box), solid cylinder (rounded rims), ellipsoid, and the thin ring. The signed distance to a
convex core is a convex function of the point, negative inside, so a surface that enters the core still has a deepest
point in it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.jit import kernel
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Matrix3, Record, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence


__all__ = [
    "BALL",
    "BOX",
    "CAPSULE",
    "CYLINDER",
    "ELLIPSOID",
    "RING",
    "Primitive",
    "core_distance",
    "shape_row",
]

BALL, CAPSULE, BOX, CYLINDER, ELLIPSOID, RING = range(6)
"""Kinds. Axis of capsule, cylinder and ring is the third of the shape."""


class Primitive(Record):
    """A core with a radius about it.

    Attributes
    ----------
    centre, axes
        Centre [m] and, as columns, axes of the shape, both in the axes of the contour and written by the caller as the
        body moves.
    sizes
        See `shape_row` [m].
    radius
        About the core [m].
    shift
        What keeps ``phi + shift`` positive until the surface reaches the middle of the core [m].
    """

    centre: Vector
    axes: Matrix3
    sizes: Vector
    radius: float
    shift: float


_SIZES = {BALL: 0, CAPSULE: 1, BOX: 3, CYLINDER: 2, ELLIPSOID: 3, RING: 1}

Core = tuple[float, float, float, float, float, float, float, float, float, float]


def shape_row(kind: int, sizes: Sequence[float] = (), radius: float = 0.0) -> Primitive:
    """Record of a primitive at the origin, its axes those of the contour.

    Parameters
    ----------
    kind
        One of BALL, CAPSULE, BOX, CYLINDER, ELLIPSOID, RING.
    sizes
        [m]: of a ball none; half length of a capsule; three half lengths of a box's core; radius and half length of a
        cylinder's core; three half axes of an ellipsoid; radius of a ring.
    radius
        About the core [m].

    Raises
    ------
    InputError
        For a wrong number of sizes, or one that is not a length.
    """
    if len(sizes) != _SIZES[kind]:
        raise InputError(
            f"{len(sizes)} sizes", source="shape", key="sizes", expected=f"{_SIZES[kind]} of kind {kind}"
        )
    positive = kind in (ELLIPSOID, RING)
    for value in (*sizes, radius):
        if not (math.isfinite(value) and value >= 0.0):
            raise InputError(f"{value} m", source="shape", key="sizes, radius", expected="lengths")
    if positive and min(sizes) <= 0.0:
        raise InputError(f"{min(sizes)} m", source="shape", key="sizes", expected="lengths above 0")
    row = Primitive.one()
    row.axes[:] = np.eye(3)
    row.sizes[: len(sizes)] = sizes
    row.radius = radius
    row.shift = min(sizes) if kind in (BOX, CYLINDER, ELLIPSOID) else 0.0
    return row


@kernel(internal=True)
def _segment(half: float, x: float, y: float, z: float) -> Core:
    """Segment of the third axis, or a point if `half` is 0; the Hessian of a squared distance has no singularity."""
    inside = half > 0.0 and -half < z < half
    dz = 0.0 if inside else z - math.copysign(half, z)
    return math.sqrt(x * x + y * y + dz * dz), x, y, dz, 1.0, 1.0, 0.0 if inside else 1.0, 0.0, 0.0, 0.0


@kernel(internal=True)
def _ring(radius: float, x: float, y: float, z: float) -> Core:
    """Circle about the third axis; on the axis, where all of it is equally far, its point in the first direction."""
    across = math.hypot(x, y)
    e1, e2 = (x / across, y / across) if across > 1e-14 * radius else (1.0, 0.0)
    turn = radius / max(across, 1e-14 * radius)
    dx = x - radius * e1
    dy = y - radius * e2
    value = math.sqrt(dx * dx + dy * dy + z * z)
    # H = I - (R / rho) t t^T with the tangent t = (-e2, e1)
    return value, dx, dy, z, 1.0 - turn * e2 * e2, 1.0 - turn * e1 * e1, 1.0, turn * e1 * e2, 0.0, 0.0


@kernel(internal=True)
def _box(a: float, b: float, c: float, shift: float, x: float, y: float, z: float) -> Core:
    """Box: nearest face, edge or corner outside, nearest face inside."""
    px, py, pz = abs(x) - a, abs(y) - b, abs(z) - c
    if px <= 0.0 and py <= 0.0 and pz <= 0.0:
        phi = max(px, py, pz)
        ex = 1.0 if px == phi else 0.0
        ey = 1.0 if py == phi and ex == 0.0 else 0.0
        ez = 1.0 - ex - ey
        value = phi + shift
        return (
            value,
            math.copysign(value * ex, x),
            math.copysign(value * ey, y),
            math.copysign(value * ez, z),
            ex,
            ey,
            ez,
            0.0,
            0.0,
            0.0,
        )
    ex, ey, ez = (1.0 if px > 0.0 else 0.0), (1.0 if py > 0.0 else 0.0), (1.0 if pz > 0.0 else 0.0)
    dx, dy, dz = math.copysign(px * ex, x), math.copysign(py * ey, y), math.copysign(pz * ez, z)
    phi = math.sqrt(dx * dx + dy * dy + dz * dz)
    m1, m2, m3 = dx / phi, dy / phi, dz / phi
    value = phi + shift
    # m m^T + (phi + shift) (D - m m^T) / phi, D the directions out of the box
    bend = value / max(phi, 1e-9 * shift)
    rest = 1.0 - bend
    return (
        value,
        value * m1,
        value * m2,
        value * m3,
        rest * m1 * m1 + bend * ex,
        rest * m2 * m2 + bend * ey,
        rest * m3 * m3 + bend * ez,
        rest * m1 * m2,
        rest * m1 * m3,
        rest * m2 * m3,
    )


@kernel(internal=True)
def _cylinder(radius: float, half: float, shift: float, x: float, y: float, z: float) -> Core:
    """Solid cylinder about the third axis: jacket, end face or rim outside, the nearest of jacket and faces inside."""
    across = math.hypot(x, y)
    e1, e2 = (x / across, y / across) if across > 0.0 else (1.0, 0.0)
    p = across - radius
    q = abs(z) - half
    side = math.copysign(1.0, z)
    mr, mz, bend = 0.0, 0.0, 0.0
    if p > 0.0 and q > 0.0:
        phi = math.sqrt(p * p + q * q)
        mr, mz = p / phi, q / phi
        bend = (phi + shift) / max(phi, 1e-9 * shift)
    elif p > q:
        phi = p
        mr = 1.0
    else:
        phi = q
        mz = 1.0
    value = phi + shift
    m1, m2, m3 = mr * e1, mr * e2, mz * side
    # turning about the axis bends the jacket, and within the axial plane the rim
    hoop = value * mr / max(across, 1e-9 * (radius + half) + 1e-300)
    k1, k2, k3 = mz * e1, mz * e2, -mr * side
    return (
        value,
        value * m1,
        value * m2,
        value * m3,
        m1 * m1 + bend * k1 * k1 + hoop * e2 * e2,
        m2 * m2 + bend * k2 * k2 + hoop * e1 * e1,
        m3 * m3 + bend * k3 * k3,
        m1 * m2 + bend * k1 * k2 - hoop * e1 * e2,
        m1 * m3 + bend * k1 * k3,
        m2 * m3 + bend * k2 * k3,
    )


@kernel(inline=True, internal=True)
def _away_from_plane(x: float, a: float) -> float:
    """A coordinate moved off a plane of symmetry, where the foot of an inner point is not unique."""
    least = 1e-14 * a
    return x if abs(x) > least else math.copysign(least, x)


@kernel(internal=True)
def _ellipsoid(a: float, b: float, c: float, shift: float, x: float, y: float, z: float) -> Core:
    """Ellipsoid: foot ``y_i = a_i^2 x_i / (t + a_i^2)`` at the largest root t of ``sum (a_i x_i / (t + a_i^2))^2 = 1``.

    Newton's method on ``1 / sqrt(sum) - 1`` rises to the root without overshooting (More and Sorensen, 1983, of the
    same equation in trust-region steps). With ``N = y / a^2``, ``phi = t |N|``; differentiating ``x = y + t N`` and
    ``N.dy = 0`` gives the Hessian.
    """
    x = _away_from_plane(x, a)
    y = _away_from_plane(y, b)
    z = _away_from_plane(z, c)
    a2, b2, c2 = a * a, b * b, c * c
    t = max(a * abs(x) - a2, b * abs(y) - b2, c * abs(z) - c2)
    for _ in range(60):
        k1, k2, k3 = 1.0 / (t + a2), 1.0 / (t + b2), 1.0 / (t + c2)
        s1, s2, s3 = a2 * x * x * k1 * k1, b2 * y * y * k2 * k2, c2 * z * z * k3 * k3
        total = s1 + s2 + s3
        change = total * (math.sqrt(total) - 1.0) / (s1 * k1 + s2 * k2 + s3 * k3)
        t += change
        if abs(change) <= 4e-16 * (abs(t) + a2 + b2 + c2):
            break
    k1, k2, k3 = 1.0 / (t + a2), 1.0 / (t + b2), 1.0 / (t + c2)
    n1, n2, n3 = x * k1, y * k2, z * k3
    size = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
    value = t * size + shift
    m1, m2, m3 = n1 / size, n2 / size, n3 / size
    # dt = w.dx / (w.N) with w = D^-1 N; dm = (I - m m^T) K (dx - N dt) / |N|, D^-1 = a^2 K
    w1, w2, w3 = a2 * k1 * n1, b2 * k2 * n2, c2 * k3 * n3
    wn = w1 * n1 + w2 * n2 + w3 * n3
    v1, v2, v3 = k1 * n1 / wn, k2 * n2 / wn, k3 * n3 / wn
    mv = m1 * v1 + m2 * v2 + m3 * v3
    r1, r2, r3 = m1 * k1 - mv * w1, m2 * k2 - mv * w2, m3 * k3 - mv * w3  # m^T (K - v w^T)
    scale = value / size
    return (
        value,
        value * m1,
        value * m2,
        value * m3,
        m1 * m1 + scale * (k1 - v1 * w1 - m1 * r1),
        m2 * m2 + scale * (k2 - v2 * w2 - m2 * r2),
        m3 * m3 + scale * (k3 - v3 * w3 - m3 * r3),
        m1 * m2 + 0.5 * scale * (-v1 * w2 - m1 * r2 - v2 * w1 - m2 * r1),
        m1 * m3 + 0.5 * scale * (-v1 * w3 - m1 * r3 - v3 * w1 - m3 * r1),
        m2 * m3 + 0.5 * scale * (-v2 * w3 - m2 * r3 - v3 * w2 - m3 * r2),
    )


@kernel(internal=True)
def core_distance(kind: int, shape: Primitive, x: float, y: float, z: float) -> Core:
    """Distance to a core and derivatives of ``f = (phi + shift)^2 / 2``, in the axes of the shape.

    Parameters
    ----------
    kind, shape
        Kind and record of the primitive.
    x, y, z
        The point from the centre [m], in the axes of the shape.

    Returns
    -------
    value, g1, g2, g3, h11, h22, h33, h12, h13, h23
        ``phi + shift`` [m], gradient [m] and second derivatives of f.
    """
    a, b, c, shift = shape.sizes[0], shape.sizes[1], shape.sizes[2], shape.shift
    if kind == BOX:
        return _box(a, b, c, shift, x, y, z)
    if kind == CYLINDER:
        return _cylinder(a, b, shift, x, y, z)
    if kind == ELLIPSOID:
        return _ellipsoid(a, b, c, shift, x, y, z)
    if kind == RING:
        return _ring(a, x, y, z)
    return _segment(a, x, y, z)
