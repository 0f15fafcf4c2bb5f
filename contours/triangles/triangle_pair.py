"""Distance of two triangles, and the points where they are nearest.

They are nearest at a vertex and a face or at two edges, or an edge of one goes through the other and they have a point
in common. Lone points and segments are triangles without extent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from heavylift.contours.triangles.triangle_distance import point_triangle, segment_segment
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add_scaled, between, cross, dot, subtract

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["triangle_distance"]


@kernel(internal=True)  # eleven parameters: two triangles, each with its normal
def triangle_distance(
    a: Vector,
    b: Vector,
    c: Vector,
    n: Vector,
    p: Vector,
    q: Vector,
    r: Vector,
    m: Vector,
    best: float,
    rounding: float,
    out: NDArray[np.float64],
) -> float:
    """Distance [m] of two triangles if it is less than the best so far, else that.

    Heights over the plane of the other triangle leave out most vertices and edges.

    Parameters
    ----------
    a, b, c, n
        Corners [m] and unit normal of the first; a normal of zeros is right for any, and needed without extent.
    p, q, r, m
        Of the second, in the same axes.
    best
        Distance [m] below which the triangles matter.
    rounding
        Part of it [m] that is not worth the search.
    out
        Nearest points [m] of the first and of the second if they are nearer than `best`, else as before; shape (6,).
    """
    reach = best - rounding
    sp, sq, sr = dot(n, subtract(p, a)), dot(n, subtract(q, a)), dot(n, subtract(r, a))
    if min(sp, sq, sr) >= reach or max(sp, sq, sr) <= -reach:
        return best
    sa, sb, sc = dot(m, subtract(a, p)), dot(m, subtract(b, p)), dot(m, subtract(c, p))
    if min(sa, sb, sc) >= reach or max(sa, sb, sc) <= -reach:
        return best
    # all heights over a segment are zero, and it may go through a face
    if min(sp, sq, sr) <= 0.0 <= max(sp, sq, sr) and min(sa, sb, sc) <= 0.0 <= max(sa, sb, sc):
        for i in range(3):
            e0, e1 = (a, b) if i == 0 else ((b, c) if i == 1 else (c, a))
            s0, s1 = (sa, sb) if i == 0 else ((sb, sc) if i == 1 else (sc, sa))
            f0, f1 = (p, q) if i == 0 else ((q, r) if i == 1 else (r, p))
            t0, t1 = (sp, sq) if i == 0 else ((sq, sr) if i == 1 else (sr, sp))
            through, place = False, e0
            if s0 * s1 < 0.0:
                through = _line_goes_through(e0, e1, p, q, r)
                place = between(e0, e1, s0 / (s0 - s1))
            if not through and t0 * t1 < 0.0:
                through = _line_goes_through(f0, f1, a, b, c)
                place = between(f0, f1, t0 / (t0 - t1))
            if through:
                _keep(out, place, place)
                return 0.0
    for i in range(3):
        x, height = (p, sp) if i == 0 else ((q, sq) if i == 1 else (r, sr))
        if abs(height) < best:
            d, u, v = point_triangle(x, a, b, c)
            if d < best:
                best = d
                _keep(out, _point_of(a, b, c, u, v), x)
        x, height = (a, sa) if i == 0 else ((b, sb) if i == 1 else (c, sc))
        if abs(height) < best:
            d, u, v = point_triangle(x, p, q, r)
            if d < best:
                best = d
                _keep(out, x, _point_of(p, q, r, u, v))
    for i in range(3):
        e0, e1 = (a, b) if i == 0 else ((b, c) if i == 1 else (c, a))
        s0, s1 = (sa, sb) if i == 0 else ((sb, sc) if i == 1 else (sc, sa))
        if min(s0, s1) >= best or max(s0, s1) <= -best:
            continue
        for j in range(3):
            f0, f1 = (p, q) if j == 0 else ((q, r) if j == 1 else (r, p))
            t0, t1 = (sp, sq) if j == 0 else ((sq, sr) if j == 1 else (sr, sp))
            if min(t0, t1) >= best or max(t0, t1) <= -best:
                continue
            d, s, t = segment_segment(e0, e1, f0, f1)
            if d < best:
                best = d
                _keep(out, between(e0, e1, s), between(f0, f1, t))
    return best


@kernel(internal=True)
def _line_goes_through(e: Vector, f: Vector, a: Vector, b: Vector, c: Vector) -> bool:
    """Whether the line through two points goes through a triangle or its border."""
    along = subtract(f, e)
    a, b, c = subtract(a, e), subtract(b, e), subtract(c, e)
    x = dot(along, cross(a, b))
    y = dot(along, cross(b, c))
    z = dot(along, cross(c, a))
    return min(x, y, z) >= 0.0 or max(x, y, z) <= 0.0


@kernel(inline=True, internal=True)
def _point_of(a: Vector, b: Vector, c: Vector, u: float, v: float) -> Vector:
    """``a + u (b - a) + v (c - a)``."""
    return add_scaled(between(a, b, u), v, subtract(c, a))


@kernel(inline=True, internal=True)
def _keep(out: NDArray[np.float64], of_a: Vector, of_b: Vector) -> None:
    """Nearest points so far."""
    out[0], out[1], out[2] = of_a
    out[3], out[4], out[5] = of_b
