"""Shapes of the position difference method: path and face, prism of a swept face, rectangle of a swept edge.

"Integrated simulation ... ships and offshore structures (2018)", section 2.6.1 (1); plain floating point, as there.
"""

from __future__ import annotations

from heavylift.numerics.jit import kernel

__all__ = ["edge_through_rectangle", "inside_prism", "path_through_triangle"]

ROUNDING = 1e-24
"""Squared sine of the angle to the plane below which a prism has no volume: a face that does not move."""


@kernel(internal=True)
def path_through_triangle(
    px: float,
    py: float,
    pz: float,
    qx: float,
    qy: float,
    qz: float,
    ax: float,
    ay: float,
    az: float,
    bx: float,
    by: float,
    bz: float,
    cx: float,
    cy: float,
    cz: float,
) -> tuple[bool, float, float, float]:
    """Intersection of the segment from p to q with a triangle: whether, where along it, and weights of b and c."""
    ex = bx - ax
    ey = by - ay
    ez = bz - az
    fx = cx - ax
    fy = cy - ay
    fz = cz - az
    nx = ey * fz - ez * fy
    ny = ez * fx - ex * fz
    nz = ex * fy - ey * fx
    s0 = nx * (px - ax) + ny * (py - ay) + nz * (pz - az)
    s1 = nx * (qx - ax) + ny * (qy - ay) + nz * (qz - az)
    if s0 * s1 > 0.0 or s0 == s1:
        return False, 0.0, 0.0, 0.0
    t = s0 / (s0 - s1)
    wx = px + t * (qx - px) - ax
    wy = py + t * (qy - py) - ay
    wz = pz + t * (qz - pz) - az
    n2 = nx * nx + ny * ny + nz * nz
    u = ((wy * fz - wz * fy) * nx + (wz * fx - wx * fz) * ny + (wx * fy - wy * fx) * nz) / n2
    v = ((ey * wz - ez * wy) * nx + (ez * wx - ex * wz) * ny + (ex * wy - ey * wx) * nz) / n2
    return u >= 0.0 and v >= 0.0 and u + v <= 1.0, t, u, v


@kernel(internal=True)
def same_side(
    ox: float,
    oy: float,
    oz: float,
    ux: float,
    uy: float,
    uz: float,
    vx: float,
    vy: float,
    vz: float,
    xx: float,
    xy: float,
    xz: float,
    mx: float,
    my: float,
    mz: float,
) -> bool:
    """Whether x and m lie on the same side of the plane through o along u and v, m not within rounding of it."""
    nx = uy * vz - uz * vy
    ny = uz * vx - ux * vz
    nz = ux * vy - uy * vx
    wx = mx - ox
    wy = my - oy
    wz = mz - oz
    of_x = nx * (xx - ox) + ny * (xy - oy) + nz * (xz - oz)
    of_m = nx * wx + ny * wy + nz * wz
    flat = of_m * of_m <= ROUNDING * (nx * nx + ny * ny + nz * nz) * (wx * wx + wy * wy + wz * wz)
    return of_x * of_m > 0.0 and not flat


@kernel(internal=True)
def inside_strip(
    a0x: float,
    a0y: float,
    a0z: float,
    b0x: float,
    b0y: float,
    b0z: float,
    a1x: float,
    a1y: float,
    a1z: float,
    b1x: float,
    b1y: float,
    b1z: float,
    xx: float,
    xy: float,
    xz: float,
    mx: float,
    my: float,
    mz: float,
) -> bool:
    """Whether x and m lie on the same side of the strip that the edge a b sweeps.

    Its plane goes through the middle of the strip along its mean directions: exact for a translation.
    """
    return same_side(
        0.25 * (a0x + b0x + a1x + b1x), 0.25 * (a0y + b0y + a1y + b1y), 0.25 * (a0z + b0z + a1z + b1z),
        b0x - a0x + b1x - a1x, b0y - a0y + b1y - a1y, b0z - a0z + b1z - a1z,
        a1x - a0x + b1x - b0x, a1y - a0y + b1y - b0y, a1z - a0z + b1z - b0z,
        xx, xy, xz, mx, my, mz,
    )  # fmt: skip


@kernel(internal=True)
def inside_prism(
    xx: float,
    xy: float,
    xz: float,
    a0x: float,
    a0y: float,
    a0z: float,
    b0x: float,
    b0y: float,
    b0z: float,
    c0x: float,
    c0y: float,
    c0z: float,
    a1x: float,
    a1y: float,
    a1z: float,
    b1x: float,
    b1y: float,
    b1z: float,
    c1x: float,
    c1y: float,
    c1z: float,
) -> bool:
    """Whether a point lies inside the prism between a face at the start and at the end, by five planes."""
    mx = (a0x + b0x + c0x + a1x + b1x + c1x) / 6.0
    my = (a0y + b0y + c0y + a1y + b1y + c1y) / 6.0
    mz = (a0z + b0z + c0z + a1z + b1z + c1z) / 6.0
    return (
        same_side(
            a0x, a0y, a0z, b0x - a0x, b0y - a0y, b0z - a0z, c0x - a0x, c0y - a0y, c0z - a0z,
            xx, xy, xz, mx, my, mz,
        )
        and same_side(
            a1x, a1y, a1z, b1x - a1x, b1y - a1y, b1z - a1z, c1x - a1x, c1y - a1y, c1z - a1z,
            xx, xy, xz, mx, my, mz,
        )
        and inside_strip(
            a0x, a0y, a0z, b0x, b0y, b0z, a1x, a1y, a1z, b1x, b1y, b1z, xx, xy, xz, mx, my, mz
        )
        and inside_strip(
            b0x, b0y, b0z, c0x, c0y, c0z, b1x, b1y, b1z, c1x, c1y, c1z, xx, xy, xz, mx, my, mz
        )
        and inside_strip(
            c0x, c0y, c0z, a0x, a0y, a0z, c1x, c1y, c1z, a1x, a1y, a1z, xx, xy, xz, mx, my, mz
        )
    )  # fmt: skip


@kernel(internal=True)
def edge_through_rectangle(
    ax: float,
    ay: float,
    az: float,
    bx: float,
    by: float,
    bz: float,
    p0x: float,
    p0y: float,
    p0z: float,
    q0x: float,
    q0y: float,
    q0z: float,
    p1x: float,
    p1y: float,
    p1z: float,
    q1x: float,
    q1y: float,
    q1z: float,
) -> tuple[bool, float]:
    """Whether the edge a b meets the rectangle that the edge p q sweeps, as two triangles, and how far along."""
    hit, _, u, v = path_through_triangle(ax, ay, az, bx, by, bz, p0x, p0y, p0z, q0x, q0y, q0z, q1x, q1y, q1z)
    if hit:
        return True, v
    hit, _, u, v = path_through_triangle(ax, ay, az, bx, by, bz, p0x, p0y, p0z, p1x, p1y, p1z, q1x, q1y, q1z)
    return hit, u + v
