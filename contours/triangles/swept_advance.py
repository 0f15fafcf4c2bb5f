"""When two moving features first touch, by advancing to where a separating plane is reached.

At a time, the closest points give a plane between the features. Corners move linearly, so the time for which
the plane goes on separating them follows from one division a corner; no contact can occur before it
(conservative advancement, Mirtich 1996, with the bound along the separating axis instead of along the fastest
point). Where a turning edge would make such steps ever shorter, the plane turns with it. This holds whatever
the accuracy of the plane, needs no polynomial of coplanarity, and is not troubled by motion within a plane,
parallel edges or features without extent, where those polynomials vanish.
"""

from __future__ import annotations

import math

from heavylift.contours.triangles.triangle_distance import point_triangle, segment_segment
from heavylift.numerics.jit import kernel

__all__ = ["APART", "OPEN", "TOUCHING", "advance_edges", "advance_vertex_face"]

APART = 0
"""They do not touch up to time 1."""

TOUCHING = 1
"""They touch at the time."""

OPEN = 2
"""They do not touch up to the time; the steps were too few to tell more."""

CAUTION = 1.0 - 1e-6
"""Factor on the bound by the fastest point, far above the rounding errors of distance and speed."""

PARALLEL = 1e-14
"""Squared sine of the angle between edges below which their vector product is no good direction."""


@kernel(inline=True, internal=True)
def time_to_plane(distance: float, rate: float, step: float) -> float:
    """The smaller of a step and the time in which a distance is used up by a rate of change."""
    return min(step, distance / -rate) if rate < 0.0 else step


@kernel(internal=True)
def time_to_turning_plane(
    clearance: float,
    rest: float,
    n1: float,
    n2: float,
    n3: float,
    e1: float,
    e2: float,
    e3: float,
    w1: float,
    w2: float,
    w3: float,
    y1: float,
    y2: float,
    y3: float,
    v1: float,
    v2: float,
    v3: float,
) -> float:
    """Time for which a point stays in front of a plane that turns with an edge.

    Parameters
    ----------
    clearance
        Least distance from the plane [m].
    rest
        Time that matters.
    n1, n2, n3
        Unit normal now, perpendicular to the edge.
    e1, e2, e3, w1, w2, w3
        Direction of the edge and its rate of change.
    y1, y2, y3, v1, v2, v3
        Point from the other feature, and its rate.

    Notes
    -----
    With ``m = n x e / e^2`` the normal is ``(e + t w) x m``: now n, and perpendicular to the edge at all times. The
    distance, times the length of this normal, is quadratic in time.
    """
    e_e = e1 * e1 + e2 * e2 + e3 * e3
    m1 = (n2 * e3 - n3 * e2) / e_e
    m2 = (n3 * e1 - n1 * e3) / e_e
    m3 = (n1 * e2 - n2 * e1) / e_e
    r1 = w2 * m3 - w3 * m2
    r2 = w3 * m1 - w1 * m3
    r3 = w1 * m2 - w2 * m1
    longest = 1.0 + rest * math.sqrt(r1 * r1 + r2 * r2 + r3 * r3)
    c = n1 * y1 + n2 * y2 + n3 * y3 - clearance * longest
    b = r1 * y1 + r2 * y2 + r3 * y3 + n1 * v1 + n2 * v2 + n3 * v3
    a = r1 * v1 + r2 * v2 + r3 * v3
    if not c > 0.0:
        return 0.0
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return math.inf
    below = math.sqrt(square) - b
    return 2.0 * c / below if below > 0.0 else math.inf


@kernel(internal=True)
def advance_vertex_face(
    start: float,
    tolerance: float,
    steps: int,
    ax: float,
    ay: float,
    az: float,
    bx: float,
    by: float,
    bz: float,
    cx: float,
    cy: float,
    cz: float,
    avx: float,
    avy: float,
    avz: float,
    bvx: float,
    bvy: float,
    bvz: float,
    cvx: float,
    cvy: float,
    cvz: float,
) -> tuple[int, float]:
    """Whether and when a triangle with moving corners comes to the origin.

    Parameters
    ----------
    start
        Time to begin at, in [0, 1].
    tolerance
        A distance up to this counts as contact [m]; above the rounding errors of the positions.
    steps
        How many to take at most.
    ax, ay, az, bx, by, bz, cx, cy, cz
        Corners at time 0, from the vertex [m].
    avx, avy, avz, bvx, bvy, bvz, cvx, cvy, cvz
        Their displacements up to time 1, relative to that of the vertex [m].

    Returns
    -------
    outcome
        `APART`, `TOUCHING` or `OPEN`.
    time
        Of the outcome; there is no contact between the start and it.
    """
    half = 0.5 * tolerance
    fastest2 = max(
        avx * avx + avy * avy + avz * avz,
        bvx * bvx + bvy * bvy + bvz * bvz,
        cvx * cvx + cvy * cvy + cvz * cvz,
    )
    slowness = CAUTION / math.sqrt(fastest2) if fastest2 > 0.0 else math.inf
    t = start
    for _ in range(steps):
        a1 = ax + t * avx
        a2 = ay + t * avy
        a3 = az + t * avz
        b1 = bx + t * bvx
        b2 = by + t * bvy
        b3 = bz + t * bvz
        c1 = cx + t * cvx
        c2 = cy + t * cvy
        c3 = cz + t * cvz
        distance, u, v = point_triangle(0.0, 0.0, 0.0, a1, a2, a3, b1, b2, b3, c1, c2, c3)
        if distance <= tolerance:
            return TOUCHING, t
        w = 1.0 - u - v
        if w < 1e-15:
            w = 0.0
        # from the vertex to the closest point, made exactly normal to the face or edge that this lies on
        n1 = w * a1 + u * b1 + v * c1
        n2 = w * a2 + u * b2 + v * c2
        n3 = w * a3 + u * b3 + v * c3
        e1 = b1 - a1
        e2 = b2 - a2
        e3 = b3 - a3
        f1 = c1 - a1
        f2 = c2 - a2
        f3 = c3 - a3
        on_edge = False
        g1 = e1
        g2 = e2
        g3 = e3
        if u > 0.0 and v > 0.0 and w > 0.0:
            m1 = e2 * f3 - e3 * f2
            m2 = e3 * f1 - e1 * f3
            m3 = e1 * f2 - e2 * f1
            side = 1.0 if m1 * n1 + m2 * n2 + m3 * n3 > 0.0 else -1.0
            n1 = side * m1
            n2 = side * m2
            n3 = side * m3
        else:
            if u == 0.0:
                g1 = f1
                g2 = f2
                g3 = f3
            elif v > 0.0:
                g1 = f1 - e1
                g2 = f2 - e2
                g3 = f3 - e3
            g_g = g1 * g1 + g2 * g2 + g3 * g3
            on_edge = g_g > 0.0 and not (u == 1.0 or v == 1.0 or w == 1.0)
            if on_edge:
                along = (n1 * g1 + n2 * g2 + n3 * g3) / g_g
                n1 -= along * g1
                n2 -= along * g2
                n3 -= along * g3
        length = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
        step = 0.0
        if length > 0.0:
            n1 /= length
            n2 /= length
            n3 /= length
            a_n = n1 * a1 + n2 * a2 + n3 * a3 - half
            b_n = n1 * b1 + n2 * b2 + n3 * b3 - half
            c_n = n1 * c1 + n2 * c2 + n3 * c3 - half
            if min(a_n, b_n, c_n) >= 0.0:
                step = time_to_plane(a_n, n1 * avx + n2 * avy + n3 * avz, math.inf)
                step = time_to_plane(b_n, n1 * bvx + n2 * bvy + n3 * bvz, step)
                step = time_to_plane(c_n, n1 * cvx + n2 * cvy + n3 * cvz, step)
                if on_edge and t + step < 1.0:
                    rest = 1.0 - t
                    h1 = bvx - avx
                    h2 = bvy - avy
                    h3 = bvz - avz
                    if u == 0.0:
                        h1 = cvx - avx
                        h2 = cvy - avy
                        h3 = cvz - avz
                    elif v > 0.0:
                        h1 = cvx - bvx
                        h2 = cvy - bvy
                        h3 = cvz - bvz
                    turn = min(
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, g1, g2, g3, h1, h2, h3, a1, a2, a3, avx, avy, avz
                        ),
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, g1, g2, g3, h1, h2, h3, b1, b2, b3, bvx, bvy, bvz
                        ),
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, g1, g2, g3, h1, h2, h3, c1, c2, c3, cvx, cvy, cvz
                        ),
                    )
                    step = max(step, turn)
        t += max(step, (distance - half) * slowness)
        if t >= 1.0:
            return APART, 1.0
    return OPEN, t


@kernel(internal=True)
def advance_edges(
    start: float,
    tolerance: float,
    steps: int,
    dx: float,
    dy: float,
    dz: float,
    px: float,
    py: float,
    pz: float,
    qx: float,
    qy: float,
    qz: float,
    pvx: float,
    pvy: float,
    pvz: float,
    qvx: float,
    qvy: float,
    qvz: float,
) -> tuple[int, float]:
    """Whether and when an edge with moving ends comes to one that begins at the origin.

    Parameters
    ----------
    start
        Time to begin at, in [0, 1].
    tolerance
        A distance up to this counts as contact [m]; above the rounding errors of the positions.
    steps
        How many to take at most.
    dx, dy, dz
        End of the fixed edge [m]; the other end is the origin.
    px, py, pz, qx, qy, qz
        Ends of the moving edge at time 0 [m].
    pvx, pvy, pvz, qvx, qvy, qvz
        Their displacements up to time 1 [m].

    Returns
    -------
    outcome
        `APART`, `TOUCHING` or `OPEN`.
    time
        Of the outcome; there is no contact between the start and it.
    """
    half = 0.5 * tolerance
    fastest2 = max(pvx * pvx + pvy * pvy + pvz * pvz, qvx * qvx + qvy * qvy + qvz * qvz)
    slowness = CAUTION / math.sqrt(fastest2) if fastest2 > 0.0 else math.inf
    d_d = dx * dx + dy * dy + dz * dz
    t = start
    for _ in range(steps):
        p1 = px + t * pvx
        p2 = py + t * pvy
        p3 = pz + t * pvz
        q1 = qx + t * qvx
        q2 = qy + t * qvy
        q3 = qz + t * qvz
        distance, s, r = segment_segment(0.0, 0.0, 0.0, dx, dy, dz, p1, p2, p3, q1, q2, q3)
        if distance <= tolerance:
            return TOUCHING, t
        e1 = q1 - p1
        e2 = q2 - p2
        e3 = q3 - p3
        n1 = p1 + r * e1 - s * dx
        n2 = p2 + r * e2 - s * dy
        n3 = p3 + r * e3 - s * dz
        # made exactly normal to the edges in whose interior the closest points lie
        e_e = e1 * e1 + e2 * e2 + e3 * e3
        inner_d = 0.0 < s < 1.0
        inner_e = 0.0 < r < 1.0
        m1 = dy * e3 - dz * e2
        m2 = dz * e1 - dx * e3
        m3 = dx * e2 - dy * e1
        if inner_d and inner_e and m1 * m1 + m2 * m2 + m3 * m3 > PARALLEL * d_d * e_e:
            side = 1.0 if m1 * n1 + m2 * n2 + m3 * n3 > 0.0 else -1.0
            n1 = side * m1
            n2 = side * m2
            n3 = side * m3
        elif inner_d and (not inner_e or d_d >= e_e):
            along = (n1 * dx + n2 * dy + n3 * dz) / d_d
            n1 -= along * dx
            n2 -= along * dy
            n3 -= along * dz
        elif inner_e:
            along = (n1 * e1 + n2 * e2 + n3 * e3) / e_e
            n1 -= along * e1
            n2 -= along * e2
            n3 -= along * e3
        length = math.sqrt(n1 * n1 + n2 * n2 + n3 * n3)
        step = 0.0
        if length > 0.0:
            n1 /= length
            n2 /= length
            n3 /= length
            reach = half + max(0.0, n1 * dx + n2 * dy + n3 * dz)
            p_n = n1 * p1 + n2 * p2 + n3 * p3 - reach
            q_n = n1 * q1 + n2 * q2 + n3 * q3 - reach
            if min(p_n, q_n) >= 0.0:
                step = time_to_plane(p_n, n1 * pvx + n2 * pvy + n3 * pvz, math.inf)
                step = time_to_plane(q_n, n1 * qvx + n2 * qvy + n3 * qvz, step)
                if inner_e and t + step < 1.0:
                    w1 = qvx - pvx
                    w2 = qvy - pvy
                    w3 = qvz - pvz
                    rest = 1.0 - t
                    turn = min(
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, e1, e2, e3, w1, w2, w3, p1, p2, p3, pvx, pvy, pvz
                        ),
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, e1, e2, e3, w1, w2, w3, p1 - dx, p2 - dy, p3 - dz, pvx, pvy, pvz
                        ),
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, e1, e2, e3, w1, w2, w3, q1, q2, q3, qvx, qvy, qvz
                        ),
                        time_to_turning_plane(
                            half, rest, n1, n2, n3, e1, e2, e3, w1, w2, w3, q1 - dx, q2 - dy, q3 - dz, qvx, qvy, qvz
                        ),
                    )  # fmt: skip
                    step = max(step, turn)
        t += max(step, (distance - half) * slowness)
        if t >= 1.0:
            return APART, 1.0
    return OPEN, t
