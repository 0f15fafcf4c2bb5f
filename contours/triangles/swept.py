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

**Roots** of a cubic in [0, 1] are certified against rounding, one after another from the left.
The cubic is held by its Bernstein coefficients: if all have one sign there is no root, if their signs change
once there is exactly one (Descartes' rule in the Bernstein basis). Each coefficient carries a bound of its
rounding error; a sign counts only beyond the bound, and where signs stay unknown the caller is told so.

**Advancement** to where a separating plane is reached tells when two moving features first touch.
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

NO_ROOT = 0
"""The cubic has no root from the start to 1."""

ONE_ROOT = 1
"""There is exactly one root in the interval, and none from the start to the interval."""

UNCERTAIN = 2
"""There is no root from the start to the beginning of the interval; nothing is known of what follows."""

ROUNDING = 4e-15
"""Bound of the error of a determinant of coordinate differences, and of a convex combination of such, over the sum
of the magnitudes of its terms: 12 roundings of 2^-53 at most in a determinant, 24 in a combination."""

NARROWEST = 2.0**-24
"""Intervals are not halved below this: what stays unknown there is a double root within rounding."""

NEWTON_STEPS = 40
"""Bound of the safeguarded Newton steps, each of which at least halves the interval every second time."""


@kernel(inline=True, internal=True)
def blossom(b0: float, b1: float, b2: float, b3: float, r: float, s: float, t: float) -> float:
    """Polar form of a cubic; with three equal arguments its value, by convex combinations in [0, 1]."""
    p0 = b0 + r * (b1 - b0)
    p1 = b1 + r * (b2 - b1)
    p2 = b2 + r * (b3 - b2)
    p0 += s * (p1 - p0)
    p1 += s * (p2 - p1)
    return p0 + t * (p1 - p0)


@kernel(internal=True)
def narrow_root(
    b0: float, b1: float, b2: float, b3: float, error: float, low: float, high: float, sign: float
) -> tuple[float, float]:
    """Shrink an interval around its only root as far as signs can be certified.

    Parameters
    ----------
    b0, b1, b2, b3
        Bernstein coefficients on [0, 1].
    error
        Bound of the rounding error of a coefficient and of a value.
    low, high
        Interval; the values at its ends are certified to have different signs.
    sign
        Of the value at ``low``.

    Returns
    -------
    low, high
        Interval around the root with the same property; the given one if it cannot be made small.
    """
    left = low
    right = high
    t = 0.5 * (left + right)
    slope = 0.0
    for _ in range(NEWTON_STEPS):
        p0 = b0 + t * (b1 - b0)
        p1 = b1 + t * (b2 - b1)
        p2 = b2 + t * (b3 - b2)
        p0 += t * (p1 - p0)
        p1 += t * (p2 - p1)
        slope = 3.0 * (p1 - p0)
        value = sign * (p0 + t * (p1 - p0))
        if value > 0.0:
            left = t
        else:
            right = t
        if abs(value) <= error:
            break
        new = t - sign * value / slope
        if not left < new < right:
            new = 0.5 * (left + right)
        done = abs(new - t) <= 1e-15
        t = new
        if done:
            break
    reach = 1e-14 + 3.0 * error / (abs(slope) + 1e-300)
    for _ in range(3):
        left = max(low, t - reach)
        right = min(high, t + reach)
        before = left <= low or sign * blossom(b0, b1, b2, b3, left, left, left) > error
        after = right >= high or sign * blossom(b0, b1, b2, b3, right, right, right) < -error
        if before and after:
            return left, right
        reach *= 8.0
    return low, high


@kernel(internal=True)
def next_root(
    b0: float, b1: float, b2: float, b3: float, error: float, start: float
) -> tuple[int, float, float]:
    """Find the first root of a cubic from a start in [0, 1].

    Parameters
    ----------
    b0, b1, b2, b3
        Bernstein coefficients on [0, 1].
    error
        Bound of the rounding error of a coefficient and of a value, zero or more.
    start
        Where to begin, in [0, 1].

    Returns
    -------
    outcome
        `NO_ROOT`, `ONE_ROOT` or `UNCERTAIN`.
    low, high
        The interval of the outcome.
    """
    low = start
    width = 1.0 - start
    c0 = b0
    c1 = b1
    c2 = b2
    c3 = b3
    whole = start == 0.0
    while True:
        high = min(1.0, low + width)
        if not whole:
            c0 = blossom(b0, b1, b2, b3, low, low, low)
            c1 = blossom(b0, b1, b2, b3, low, low, high)
            c2 = blossom(b0, b1, b2, b3, low, high, high)
            c3 = blossom(b0, b1, b2, b3, high, high, high)
        whole = False
        if not abs(c0) > error:
            return UNCERTAIN, low, 1.0
        sign = 1.0 if c0 > 0.0 else -1.0
        if sign * c1 > error and sign * c2 > error and sign * c3 > error:
            if high >= 1.0:
                return NO_ROOT, 1.0, 1.0
            low = high
            width = min(2.0 * width, 1.0 - low)
            continue
        if sign * c3 < -error and (sign * c1 > error or sign * c2 < -error):
            low, high = narrow_root(b0, b1, b2, b3, error, low, high, sign)
            return ONE_ROOT, low, high
        width *= 0.5
        if width < NARROWEST:
            return UNCERTAIN, low, 1.0


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
        distance, u, v = point_triangle((0.0, 0.0, 0.0), (a1, a2, a3), (b1, b2, b3), (c1, c2, c3))
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
        distance, s, r = segment_segment((0.0, 0.0, 0.0), (dx, dy, dz), (p1, p2, p3), (q1, q2, q3))
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
                (0.0, 0.0, 0.0),
                (w0x + t * ax, w0y + t * ay, w0z + t * az),
                (p0x + t * bx, p0y + t * by, p0z + t * bz),
                (q0x + t * cx, q0y + t * cy, q0z + t * cz),
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
                (0.0, 0.0, 0.0), (dx, dy, dz),
                (w0x + t * px, w0y + t * py, w0z + t * pz),
                (r0x + t * qx, r0y + t * qy, r0z + t * qz),
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
