"""Whether and when a vertex meets a face, or an edge meets an edge, during a motion: no contact is ever missed.

In the axes of one body, whose features stand still, the vertices of the other move linearly in time. Features can
only touch when they lie in a plane: at a root of a polynomial of degree one (vertex through a face), two (edges) or
three (face over a vertex). Three stages follow, each certified against rounding:

1. Bernstein coefficients of one sign: no root, no contact. This ends most tests.
2. Isolated roots: contact if the features are together at the root, none if they are apart by more than the
   root's interval lets them move.
3. Where signs cannot be certified (motion within a plane, parallel edges, contact at the start, grazing),
   conservative advancement.

Nothing is missed; what comes within `NEAR` of the lengths may count as contact. The pairs are those of "Integrated
simulation ... ships and offshore structures (2018)", section 2.6.1; its method is in `position_difference`.
"""

from __future__ import annotations

import math

from heavylift.contours.triangles.swept_advance import (
    APART,
    OPEN,
    TOUCHING,
    advance_edges,
    advance_vertex_face,
)
from heavylift.contours.triangles.swept_roots import NO_ROOT, ONE_ROOT, ROUNDING, next_root
from heavylift.contours.triangles.triangle_distance import point_triangle, segment_segment
from heavylift.numerics.jit import kernel

__all__ = ["NEAR", "swept_edges", "swept_face_vertex", "swept_vertex_face"]

NEAR = 1e-9
"""Features as near as this, over the largest of lengths, distance and motion, count as in contact where roots or
distances decide."""

COORDINATES = 1e-15
"""What positions are uncertain by, over the distance from the origin. A start as near as this counts as contact."""

MOST_ADVANCES = 8
"""Steps of conservative advancement before signs of the polynomial are tried again."""

MOST_TURNS = 16
"""Roots and advancements in one test; what is open after these is called a contact."""


@kernel(inline=True, internal=True)
def largest(x: float, y: float, z: float) -> float:
    """Largest magnitude."""
    return max(abs(x), abs(y), abs(z))


@kernel(internal=True)
def swept_vertex_face(
    x0x: float,
    x0y: float,
    x0z: float,
    x1x: float,
    x1y: float,
    x1z: float,
    ax: float,
    ay: float,
    az: float,
    bx: float,
    by: float,
    bz: float,
    cx: float,
    cy: float,
    cz: float,
) -> tuple[bool, float]:
    """Test a vertex that moves linearly against a face that stands still.

    Parameters
    ----------
    x0x, x0y, x0z, x1x, x1y, x1z
        Vertex at time 0 and at time 1 [m].
    ax, ay, az, bx, by, bz, cx, cy, cz
        Corners of the face [m].

    Returns
    -------
    hit
        Whether they touch.
    time
        Of the first contact, in [0, 1]; 0 if they touch at the start, 1 without contact.

    Notes
    -----
    If the ends of the path lie on different sides of the plane, three more volumes, of the path with each
    edge, tell whether it passes through the face: they have one sign if it does.
    """
    ux = x1x - x0x
    uy = x1y - x0y
    uz = x1z - x0z
    ex = bx - ax
    ey = by - ay
    ez = bz - az
    fx = cx - ax
    fy = cy - ay
    fz = cz - az
    wx = x0x - ax
    wy = x0y - ay
    wz = x0z - az
    vx = x1x - ax
    vy = x1y - ay
    vz = x1z - az
    s0 = wx * (ey * fz - ez * fy) + wy * (ez * fx - ex * fz) + wz * (ex * fy - ey * fx)
    s1 = vx * (ey * fz - ez * fy) + vy * (ez * fx - ex * fz) + vz * (ex * fy - ey * fx)
    far = COORDINATES * largest(x0x, x0y, x0z)
    own = far / ROUNDING
    error = ROUNDING * (
        (max(abs(wx), abs(vx)) + own) * (abs(ey * fz) + abs(ez * fy))
        + (max(abs(wy), abs(vy)) + own) * (abs(ez * fx) + abs(ex * fz))
        + (max(abs(wz), abs(vz)) + own) * (abs(ex * fy) + abs(ey * fx))
    )
    if (s0 > error and s1 > error) or (s0 < -error and s1 < -error):
        return False, 1.0
    ax -= x0x
    ay -= x0y
    az -= x0z
    bx -= x0x
    by -= x0y
    bz -= x0z
    cx -= x0x
    cy -= x0y
    cz -= x0z
    length = max(largest(ux, uy, uz), largest(ax, ay, az), largest(bx, by, bz), largest(cx, cy, cz))
    if abs(s0) > error and abs(s1) > error:
        bound = 6.0 * ROUNDING * length * length * largest(ux, uy, uz)
        ab = ux * (ay * bz - az * by) + uy * (az * bx - ax * bz) + uz * (ax * by - ay * bx)
        bc = ux * (by * cz - bz * cy) + uy * (bz * cx - bx * cz) + uz * (bx * cy - by * cx)
        ca = ux * (cy * az - cz * ay) + uy * (cz * ax - cx * az) + uz * (cx * ay - cy * ax)
        least = min(ab, bc, ca)
        most = max(ab, bc, ca)
        if least > bound or most < -bound:
            return True, s0 / (s0 - s1)
        if least < -bound and most > bound:
            return False, 1.0
    tolerance = NEAR * length + far
    outcome, time = advance_vertex_face(
        0.0, tolerance, MOST_TURNS * MOST_ADVANCES,
        ax, ay, az, bx, by, bz, cx, cy, cz,
        -ux, -uy, -uz, -ux, -uy, -uz, -ux, -uy, -uz,
    )  # fmt: skip
    return outcome != APART, time


@kernel(internal=True)
def swept_face_vertex(
    xx: float,
    xy: float,
    xz: float,
    a0x: float,
    a0y: float,
    a0z: float,
    a1x: float,
    a1y: float,
    a1z: float,
    b0x: float,
    b0y: float,
    b0z: float,
    b1x: float,
    b1y: float,
    b1z: float,
    c0x: float,
    c0y: float,
    c0z: float,
    c1x: float,
    c1y: float,
    c1z: float,
) -> tuple[bool, float]:
    """Test a face whose corners move linearly against a vertex that stands still.

    Parameters
    ----------
    xx, xy, xz
        Vertex [m].
    a0x, a0y, a0z, a1x, a1y, a1z
        First corner at time 0 and at time 1 [m].
    b0x, b0y, b0z, b1x, b1y, b1z
        Second corner.
    c0x, c0y, c0z, c1x, c1y, c1z
        Third corner.

    Returns
    -------
    hit
        Whether they touch.
    time
        Of the first contact, in [0, 1]; 0 if they touch at the start, 1 without contact.
    """
    # two edges and the first corner seen from the vertex, at both times
    e0x = b0x - a0x
    e0y = b0y - a0y
    e0z = b0z - a0z
    e1x = b1x - a1x
    e1y = b1y - a1y
    e1z = b1z - a1z
    f0x = c0x - a0x
    f0y = c0y - a0y
    f0z = c0z - a0z
    f1x = c1x - a1x
    f1y = c1y - a1y
    f1z = c1z - a1z
    w0x = a0x - xx
    w0y = a0y - xy
    w0z = a0z - xz
    w1x = a1x - xx
    w1y = a1y - xy
    w1z = a1z - xz
    # normals: of the start, mixed, of the end
    n0x = e0y * f0z - e0z * f0y
    n0y = e0z * f0x - e0x * f0z
    n0z = e0x * f0y - e0y * f0x
    mx = e0y * f1z - e0z * f1y + (e1y * f0z - e1z * f0y)
    my = e0z * f1x - e0x * f1z + (e1z * f0x - e1x * f0z)
    mz = e0x * f1y - e0y * f1x + (e1x * f0y - e1y * f0x)
    n1x = e1y * f1z - e1z * f1y
    n1y = e1z * f1x - e1x * f1z
    n1z = e1x * f1y - e1y * f1x
    v0 = w0x * n0x + w0y * n0y + w0z * n0z
    v1 = (w1x * n0x + w1y * n0y + w1z * n0z + (w0x * mx + w0y * my + w0z * mz)) / 3.0
    v2 = (w0x * n1x + w0y * n1y + w0z * n1z + (w1x * mx + w1y * my + w1z * mz)) / 3.0
    v3 = w1x * n1x + w1y * n1y + w1z * n1z
    ex = max(abs(e0x), abs(e1x))
    ey = max(abs(e0y), abs(e1y))
    ez = max(abs(e0z), abs(e1z))
    fx = max(abs(f0x), abs(f1x))
    fy = max(abs(f0y), abs(f1y))
    fz = max(abs(f0z), abs(f1z))
    far = COORDINATES * largest(xx, xy, xz)
    own = far / ROUNDING
    wx = max(abs(w0x), abs(w1x)) + own
    wy = max(abs(w0y), abs(w1y)) + own
    wz = max(abs(w0z), abs(w1z)) + own
    error = ROUNDING * (wx * (ey * fz + ez * fy) + wy * (ez * fx + ex * fz) + wz * (ex * fy + ey * fx))
    least = min(v0, v1, v2, v3)
    most = max(v0, v1, v2, v3)
    if least > error or most < -error:
        return False, 1.0
    ax = a1x - a0x
    ay = a1y - a0y
    az = a1z - a0z
    bx = b1x - b0x
    by = b1y - b0y
    bz = b1z - b0z
    cx = c1x - c0x
    cy = c1y - c0y
    cz = c1z - c0z
    fastest = math.sqrt(
        max(ax * ax + ay * ay + az * az, bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz)
    )
    length = max(largest(ex, ey, ez), largest(fx, fy, fz), largest(w0x, w0y, w0z), fastest)
    tolerance = NEAR * length + far
    p0x = b0x - xx
    p0y = b0y - xy
    p0z = b0z - xz
    q0x = c0x - xx
    q0y = c0y - xy
    q0z = c0z - xz
    start = 0.0
    for _ in range(MOST_TURNS):
        outcome, low, high = next_root(v0, v1, v2, v3, error, start)
        if outcome == NO_ROOT:
            return False, 1.0
        start = low
        if outcome == ONE_ROOT:
            t = 0.5 * (low + high)
            distance, _, _ = point_triangle(
                0.0, 0.0, 0.0,
                w0x + t * ax, w0y + t * ay, w0z + t * az,
                p0x + t * bx, p0y + t * by, p0z + t * bz,
                q0x + t * cx, q0y + t * cy, q0z + t * cz,
            )  # fmt: skip
            if distance <= tolerance:
                return True, t
            if distance > tolerance + (high - low) * fastest:
                start = high
                if start >= 1.0:
                    return False, 1.0
                continue
        outcome, start = advance_vertex_face(
            start, tolerance, MOST_ADVANCES,
            w0x, w0y, w0z, p0x, p0y, p0z, q0x, q0y, q0z,
            ax, ay, az, bx, by, bz, cx, cy, cz,
        )  # fmt: skip
        if outcome != OPEN:
            return outcome == TOUCHING, start
    return True, start


@kernel(internal=True)
def swept_edges(
    a0x: float,
    a0y: float,
    a0z: float,
    a1x: float,
    a1y: float,
    a1z: float,
    p0x: float,
    p0y: float,
    p0z: float,
    p1x: float,
    p1y: float,
    p1z: float,
    q0x: float,
    q0y: float,
    q0z: float,
    q1x: float,
    q1y: float,
    q1z: float,
) -> tuple[bool, float]:
    """Test an edge whose ends move linearly against an edge that stands still.

    Parameters
    ----------
    a0x, a0y, a0z, a1x, a1y, a1z
        Ends of the edge that stands still [m]; may be the same point.
    p0x, p0y, p0z, p1x, p1y, p1z
        First end of the other at time 0 and at time 1 [m].
    q0x, q0y, q0z, q1x, q1y, q1z
        Its second end; may be the same point as the first.

    Returns
    -------
    hit
        Whether they touch.
    time
        Of the first contact, in [0, 1]; 0 if they touch at the start, 1 without contact.
    """
    dx = a1x - a0x
    dy = a1y - a0y
    dz = a1z - a0z
    e0x = q0x - p0x
    e0y = q0y - p0y
    e0z = q0z - p0z
    e1x = q1x - p1x
    e1y = q1y - p1y
    e1z = q1z - p1z
    w0x = p0x - a0x
    w0y = p0y - a0y
    w0z = p0z - a0z
    w1x = p1x - a0x
    w1y = p1y - a0y
    w1z = p1z - a0z
    v0 = dx * (e0y * w0z - e0z * w0y) + dy * (e0z * w0x - e0x * w0z) + dz * (e0x * w0y - e0y * w0x)
    v2 = dx * (e1y * w1z - e1z * w1y) + dy * (e1z * w1x - e1x * w1z) + dz * (e1x * w1y - e1y * w1x)
    v1 = 0.5 * (
        dx * (e0y * w1z - e0z * w1y + (e1y * w0z - e1z * w0y))
        + dy * (e0z * w1x - e0x * w1z + (e1z * w0x - e1x * w0z))
        + dz * (e0x * w1y - e0y * w1x + (e1x * w0y - e1y * w0x))
    )
    ex = max(abs(e0x), abs(e1x))
    ey = max(abs(e0y), abs(e1y))
    ez = max(abs(e0z), abs(e1z))
    far = COORDINATES * largest(a0x, a0y, a0z)
    own = far / ROUNDING
    wx = max(abs(w0x), abs(w1x)) + own
    wy = max(abs(w0y), abs(w1y)) + own
    wz = max(abs(w0z), abs(w1z)) + own
    error = ROUNDING * (
        abs(dx) * (ey * wz + ez * wy) + abs(dy) * (ez * wx + ex * wz) + abs(dz) * (ex * wy + ey * wx)
    )
    if min(v0, v1, v2) > error or max(v0, v1, v2) < -error:
        return False, 1.0
    px = p1x - p0x
    py = p1y - p0y
    pz = p1z - p0z
    qx = q1x - q0x
    qy = q1y - q0y
    qz = q1z - q0z
    r0x = q0x - a0x
    r0y = q0y - a0y
    r0z = q0z - a0z
    fastest = math.sqrt(max(px * px + py * py + pz * pz, qx * qx + qy * qy + qz * qz))
    length = max(largest(dx, dy, dz), largest(ex, ey, ez), largest(w0x, w0y, w0z), fastest)
    tolerance = NEAR * length + far
    start = 0.0
    for _ in range(MOST_TURNS):
        # a quadratic is a cubic whose inner coefficients are these
        outcome, low, high = next_root(v0, (v0 + 2.0 * v1) / 3.0, (2.0 * v1 + v2) / 3.0, v2, error, start)
        if outcome == NO_ROOT:
            return False, 1.0
        start = low
        if outcome == ONE_ROOT:
            t = 0.5 * (low + high)
            distance, _, _ = segment_segment(
                0.0, 0.0, 0.0, dx, dy, dz,
                w0x + t * px, w0y + t * py, w0z + t * pz,
                r0x + t * qx, r0y + t * qy, r0z + t * qz,
            )  # fmt: skip
            if distance <= tolerance:
                return True, t
            if distance > tolerance + (high - low) * fastest:
                start = high
                if start >= 1.0:
                    return False, 1.0
                continue
        outcome, start = advance_edges(
            start, tolerance, MOST_ADVANCES,
            dx, dy, dz, w0x, w0y, w0z, r0x, r0y, r0z, px, py, pz, qx, qy, qz,
        )  # fmt: skip
        if outcome != OPEN:
            return outcome == TOUCHING, start
    return True, start
