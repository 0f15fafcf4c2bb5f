"""Closest points of point and triangle, and of two segments: points are tuples, nothing is allocated.

Both are accurate to 1e-14 of the lengths for every input, with slivers, parallel and
zero-length segments among them. The usual formulas (Ericson, "Real-Time Collision Detection", 2005, sections
5.1.5 and 5.1.9) divide by differences of products of lengths, which lose all digits for slivers and nearly
parallel segments at angles below 1e-8. Here unconstrained minima come from vector products, which lose them
one order later, and what is returned is always the distance of two points that lie on the features.
"""

from __future__ import annotations

import math

from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, between, cross, dot, scaled, subtract

__all__ = ["point_of", "point_segment", "point_triangle", "segment_segment"]

THIN = 1e-4
"""Squared sine of the angle at the first corner below which every edge is looked at, and the inside with care."""


@kernel(inline=True, internal=True)
def point_of(a: Vector, b: Vector, c: Vector, u: float, v: float) -> Vector:
    """Point of a triangle by the weights that `point_triangle` returns: ``a + u (b - a) + v (c - a)``."""
    return add_scaled(between(a, b, u), v, subtract(c, a))


@kernel(inline=True, internal=True)
def point_segment(p: Vector, a: Vector, b: Vector) -> tuple[float, float]:
    """Squared distance of a point from a segment, and where the closest point lies.

    Parameters
    ----------
    p
        Point [m].
    a, b
        Ends of the segment [m]; may be the same point.

    Returns
    -------
    squared_distance
        [m^2].
    s
        The closest point is ``a + s (b - a)``, ``0 <= s <= 1``.
    """
    d = subtract(b, a)
    w = subtract(p, a)
    length2 = dot(d, d)
    s = 0.0
    if length2 > 0.0:
        s = min(1.0, max(0.0, dot(w, d) / length2))
    w = add_scaled(w, -s, d)
    return dot(w, w), s


@kernel(internal=True)
def inside_thin(u: float, v: float, w: Vector, e: Vector, f: Vector) -> tuple[float, float, float]:
    """Squared distance of a point w from the triangle with edges e and f, and its foot, which is roughly known.

    In a thin triangle the foot is exact across, but not along; along an edge the projection is. Infinite if that
    leaves the triangle: then the foot lies on an edge but for rounding.
    """
    g = subtract(f, e)
    e2, f2, g2 = dot(e, e), dot(f, f), dot(g, g)
    r = add_scaled(add_scaled(w, -u, e), -v, f)
    if e2 >= f2 and e2 >= g2:
        u += dot(r, e) / e2
    elif f2 >= g2:
        v += dot(r, f) / f2
    else:
        along = dot(r, g) / g2
        u -= along
        v += along
    if u < 0.0 or v < 0.0 or u + v > 1.0:
        return math.inf, 0.0, 0.0
    r = add_scaled(add_scaled(w, -u, e), -v, f)
    return dot(r, r), u, v


@kernel(internal=True)
def point_triangle(p: Vector, a: Vector, b: Vector, c: Vector) -> tuple[float, float, float]:
    """Distance of a point from a triangle, and where the closest point lies.

    Parameters
    ----------
    p
        Point [m].
    a, b, c
        Corners [m]; the triangle may be a segment or a point.

    Returns
    -------
    distance
        [m].
    u, v
        The closest point is ``a + u (b - a) + v (c - a)``; both are zero or more and their sum is at most one.

    Notes
    -----
    With ``n = (b - a) x (c - a)`` the foot of the perpendicular has the barycentric coordinates
    ``(p - a) x (c - a) . n / n^2`` and so on. If one is negative, the closest point lies on an edge whose
    coordinate is negative: towards the foot, every other edge lets the point move inwards. In thin triangles these
    signs are lost, and all edges are tried.
    """
    e, f, w = subtract(b, a), subtract(c, a), subtract(p, a)
    n = cross(e, f)
    n2 = dot(n, n)
    bu = dot(cross(w, f), n)
    bv = dot(cross(e, w), n)
    ba = n2 - bu - bv
    thin = not n2 > THIN * dot(e, e) * dot(f, f)
    if not thin and bu >= 0.0 and bv >= 0.0 and ba >= 0.0:
        u = bu / n2
        v = bv / n2
        w = subtract(w, add_scaled(scaled(u, e), v, f))
        return math.sqrt(dot(w, w)), u, v
    best = math.inf
    u = 0.0
    v = 0.0
    if thin or bv < 0.0:
        best, u = point_segment(p, a, b)
    if thin or bu < 0.0:
        squared, s = point_segment(p, a, c)
        if squared < best:
            best = squared
            u = 0.0
            v = s
    if thin or ba < 0.0:
        squared, s = point_segment(p, b, c)
        if squared < best:
            best = squared
            u = 1.0 - s
            v = s
    if thin and bu > 0.0 and bv > 0.0 and ba > 0.0:
        squared, iu, iv = inside_thin(bu / n2, bv / n2, w, e, f)
        if squared < best:
            best = squared
            u = iu
            v = iv
    return math.sqrt(best), u, v


@kernel(internal=True)
def segment_segment(p0: Vector, p1: Vector, q0: Vector, q1: Vector) -> tuple[float, float, float]:
    """Distance of two segments, and where the closest points lie.

    Parameters
    ----------
    p0, p1
        Ends of the first segment [m]; may be the same point.
    q0, q1
        Ends of the second.

    Returns
    -------
    distance
        [m].
    s, t
        The closest points are ``p0 + s (p1 - p0)`` and ``q0 + t (q1 - q0)``. Of parallel segments that lie
        side by side one of the closest pairs.

    Notes
    -----
    The closest point of the first line to the second, cut to the segment, then the closest point of the second
    segment to that, then of the first to that (Ericson, section 5.1.9). Only the start uses the vector product;
    where it is inexact, the distance varies little along the valley that the other two steps descend into.
    """
    d, e, r = subtract(p1, p0), subtract(q1, q0), subtract(q0, p0)
    d2 = dot(d, d)
    e2 = dot(e, e)
    n = cross(d, e)
    n2 = dot(n, n)
    s = 0.0
    if n2 > 0.0:
        s = dot(cross(r, e), n) / n2
        s = min(1.0, max(0.0, s))
    t = 0.0
    if e2 > 0.0:
        t = dot(subtract(scaled(s, d), r), e) / e2
        t = min(1.0, max(0.0, t))
    if d2 > 0.0:
        s = dot(add_scaled(r, t, e), d) / d2
        s = min(1.0, max(0.0, s))
    w = add_scaled(add_scaled(r, t, e), -s, d)
    return math.sqrt(dot(w, w)), s, t
