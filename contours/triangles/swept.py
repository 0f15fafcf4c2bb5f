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
rounding error; a sign counts only beyond the bound, and where signs stay unknown the result says so.

**Advancement** to where a separating plane is reached tells when two moving features first touch.
At a time, the closest points give a plane between the features. Corners move linearly, so the time for which
the plane keeps separating them follows from one division a corner; no contact can occur before it
(conservative advancement, Mirtich 1996, with the bound along the separating axis instead of along the fastest
point). Where a turning edge would make such steps ever shorter, the plane turns with it. This holds whatever
the accuracy of the plane, needs no polynomial of coplanarity, and is not troubled by motion within a plane,
parallel edges or features without extent, where those polynomials vanish.
"""

from __future__ import annotations

import math

from heavylift.contours.triangles.triangle_distance import point_triangle, segment_segment
from heavylift.numerics.jit import kernel
from heavylift.numerics.vectors import Vector, add, add_scaled, cross, dot, scaled, subtract

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


ORIGIN = (0.0, 0.0, 0.0)
"""Where the feature that stands still, or its first end, is put."""


@kernel(inline=True, internal=True)
def divided(a: Vector, f: float) -> Vector:
    """``a / f``."""
    return a[0] / f, a[1] / f, a[2] / f


@kernel(inline=True, internal=True)
def time_to_plane(distance: float, rate: float, step: float) -> float:
    """The smaller of a step and the time in which a distance is used up by a rate of change."""
    return min(step, distance / -rate) if rate < 0.0 else step


@kernel(internal=True)
def time_to_turning_plane(
    clearance: float, rest: float, n: Vector, e: Vector, w: Vector, y: Vector, v: Vector
) -> float:
    """Time for which a point stays in front of a plane that turns with an edge.

    Parameters
    ----------
    clearance
        Least distance from the plane [m].
    rest
        Time that matters.
    n
        Unit normal now, perpendicular to the edge.
    e, w
        Direction of the edge and its rate of change.
    y, v
        Point from the other feature, and its rate.

    Notes
    -----
    With ``m = n x e / e^2`` the normal is ``(e + t w) x m``: now n, and perpendicular to the edge at all times. The
    distance, times the length of this normal, is quadratic in time.
    """
    m = divided(cross(n, e), dot(e, e))
    r = cross(w, m)
    longest = 1.0 + rest * math.sqrt(dot(r, r))
    c = dot(n, y) - clearance * longest
    b = dot(r, y) + n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
    a = dot(r, v)
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
    a0: Vector,
    b0: Vector,
    c0: Vector,
    av: Vector,
    bv: Vector,
    cv: Vector,
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
    a0, b0, c0
        Corners at time 0, from the vertex [m].
    av, bv, cv
        Their displacements up to time 1, relative to that of the vertex [m].

    Returns
    -------
    outcome
        `APART`, `TOUCHING` or `OPEN`.
    time
        Of the outcome; there is no contact between the start and it.
    """
    half = 0.5 * tolerance
    fastest2 = max(dot(av, av), dot(bv, bv), dot(cv, cv))
    slowness = CAUTION / math.sqrt(fastest2) if fastest2 > 0.0 else math.inf
    t = start
    for _ in range(steps):
        a, b, c = add_scaled(a0, t, av), add_scaled(b0, t, bv), add_scaled(c0, t, cv)
        distance, u, v = point_triangle(ORIGIN, a, b, c)
        if distance <= tolerance:
            return TOUCHING, t
        w = 1.0 - u - v
        if w < 1e-15:
            w = 0.0
        # from the vertex to the closest point, made exactly normal to the face or edge that this lies on
        n = add_scaled(add_scaled(scaled(w, a), u, b), v, c)
        e, f = subtract(b, a), subtract(c, a)
        on_edge = False
        g = e
        if u > 0.0 and v > 0.0 and w > 0.0:
            m = cross(e, f)
            n = scaled(1.0 if dot(m, n) > 0.0 else -1.0, m)
        else:
            if u == 0.0:
                g = f
            elif v > 0.0:
                g = subtract(f, e)
            g_g = dot(g, g)
            on_edge = g_g > 0.0 and not (u == 1.0 or v == 1.0 or w == 1.0)
            if on_edge:
                n = add_scaled(n, -(dot(n, g) / g_g), g)
        length = math.sqrt(dot(n, n))
        step = 0.0
        if length > 0.0:
            n = divided(n, length)
            a_n, b_n, c_n = dot(n, a) - half, dot(n, b) - half, dot(n, c) - half
            if min(a_n, b_n, c_n) >= 0.0:
                step = time_to_plane(a_n, dot(n, av), math.inf)
                step = time_to_plane(b_n, dot(n, bv), step)
                step = time_to_plane(c_n, dot(n, cv), step)
                if on_edge and t + step < 1.0:
                    rest = 1.0 - t
                    h = subtract(bv, av)
                    if u == 0.0:
                        h = subtract(cv, av)
                    elif v > 0.0:
                        h = subtract(cv, bv)
                    turn = min(
                        time_to_turning_plane(half, rest, n, g, h, a, av),
                        time_to_turning_plane(half, rest, n, g, h, b, bv),
                        time_to_turning_plane(half, rest, n, g, h, c, cv),
                    )
                    step = max(step, turn)
        t += max(step, (distance - half) * slowness)
        if t >= 1.0:
            return APART, 1.0
    return OPEN, t


@kernel(internal=True)
def advance_edges(
    start: float, tolerance: float, steps: int, d: Vector, p0: Vector, q0: Vector, pv: Vector, qv: Vector
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
    d
        End of the fixed edge [m]; the other end is the origin.
    p0, q0
        Ends of the moving edge at time 0 [m].
    pv, qv
        Their displacements up to time 1 [m].

    Returns
    -------
    outcome
        `APART`, `TOUCHING` or `OPEN`.
    time
        Of the outcome; there is no contact between the start and it.
    """
    half = 0.5 * tolerance
    fastest2 = max(dot(pv, pv), dot(qv, qv))
    slowness = CAUTION / math.sqrt(fastest2) if fastest2 > 0.0 else math.inf
    d_d = dot(d, d)
    t = start
    for _ in range(steps):
        p, q = add_scaled(p0, t, pv), add_scaled(q0, t, qv)
        distance, s, r = segment_segment(ORIGIN, d, p, q)
        if distance <= tolerance:
            return TOUCHING, t
        e = subtract(q, p)
        n = add_scaled(add_scaled(p, r, e), -s, d)
        # made exactly normal to the edges in whose interior the closest points lie
        e_e = dot(e, e)
        inner_d = 0.0 < s < 1.0
        inner_e = 0.0 < r < 1.0
        m = cross(d, e)
        if inner_d and inner_e and dot(m, m) > PARALLEL * d_d * e_e:
            n = scaled(1.0 if dot(m, n) > 0.0 else -1.0, m)
        elif inner_d and (not inner_e or d_d >= e_e):
            n = add_scaled(n, -(dot(n, d) / d_d), d)
        elif inner_e:
            n = add_scaled(n, -(dot(n, e) / e_e), e)
        length = math.sqrt(dot(n, n))
        step = 0.0
        if length > 0.0:
            n = divided(n, length)
            reach = half + max(0.0, dot(n, d))
            p_n, q_n = dot(n, p) - reach, dot(n, q) - reach
            if min(p_n, q_n) >= 0.0:
                step = time_to_plane(p_n, dot(n, pv), math.inf)
                step = time_to_plane(q_n, dot(n, qv), step)
                if inner_e and t + step < 1.0:
                    w = subtract(qv, pv)
                    rest = 1.0 - t
                    turn = min(
                        time_to_turning_plane(half, rest, n, e, w, p, pv),
                        time_to_turning_plane(half, rest, n, e, w, subtract(p, d), pv),
                        time_to_turning_plane(half, rest, n, e, w, q, qv),
                        time_to_turning_plane(half, rest, n, e, w, subtract(q, d), qv),
                    )
                    step = max(step, turn)
        t += max(step, (distance - half) * slowness)
        if t >= 1.0:
            return APART, 1.0
    return OPEN, t


@kernel(inline=True, internal=True)
def largest(a: Vector) -> float:
    """Largest magnitude."""
    return max(abs(a[0]), abs(a[1]), abs(a[2]))


@kernel(inline=True, internal=True)
def magnitudes(a: Vector, b: Vector, own: float) -> Vector:
    """The larger magnitude of each component, with what it is uncertain by itself."""
    return max(abs(a[0]), abs(b[0])) + own, max(abs(a[1]), abs(b[1])) + own, max(abs(a[2]), abs(b[2])) + own


@kernel(inline=True, internal=True)
def sum_of_terms(a: Vector, b: Vector, c: Vector) -> float:
    """Sum of the magnitudes of the terms of ``a . (b x c)``, from magnitudes."""
    return (
        a[0] * (b[1] * c[2] + b[2] * c[1])
        + a[1] * (b[2] * c[0] + b[0] * c[2])
        + a[2] * (b[0] * c[1] + b[1] * c[0])
    )


@kernel(internal=True)
def swept_vertex_face(x0: Vector, x1: Vector, a: Vector, b: Vector, c: Vector) -> tuple[bool, float]:
    """Test a vertex that moves linearly against a face that stands still.

    Parameters
    ----------
    x0, x1
        Vertex at time 0 and at time 1 [m].
    a, b, c
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
    u = subtract(x1, x0)
    e, f = subtract(b, a), subtract(c, a)
    w, v = subtract(x0, a), subtract(x1, a)
    n = cross(e, f)
    s0 = dot(w, n)
    s1 = dot(v, n)
    far = COORDINATES * largest(x0)
    error = ROUNDING * sum_of_terms(
        magnitudes(w, v, far / ROUNDING), magnitudes(e, e, 0.0), magnitudes(f, f, 0.0)
    )
    if (s0 > error and s1 > error) or (s0 < -error and s1 < -error):
        return False, 1.0
    p, q, r = subtract(a, x0), subtract(b, x0), subtract(c, x0)
    length = max(largest(u), largest(p), largest(q), largest(r))
    if abs(s0) > error and abs(s1) > error:
        bound = 6.0 * ROUNDING * length * length * largest(u)
        pq, qr, rp = dot(u, cross(p, q)), dot(u, cross(q, r)), dot(u, cross(r, p))
        least = min(pq, qr, rp)
        most = max(pq, qr, rp)
        if least > bound or most < -bound:
            return True, s0 / (s0 - s1)
        if least < -bound and most > bound:
            return False, 1.0
    tolerance = NEAR * length + far
    back = scaled(-1.0, u)
    outcome, time = advance_vertex_face(0.0, tolerance, MOST_TURNS * MOST_ADVANCES, p, q, r, back, back, back)
    return outcome != APART, time


@kernel(internal=True)
def swept_face_vertex(
    x: Vector, a0: Vector, a1: Vector, b0: Vector, b1: Vector, c0: Vector, c1: Vector
) -> tuple[bool, float]:
    """Test a face whose corners move linearly against a vertex that stands still.

    Parameters
    ----------
    x
        Vertex [m].
    a0, a1
        First corner at time 0 and at time 1 [m].
    b0, b1
        Second corner.
    c0, c1
        Third corner.

    Returns
    -------
    hit
        Whether they touch.
    time
        Of the first contact, in [0, 1]; 0 if they touch at the start, 1 without contact.
    """
    # two edges and the first corner seen from the vertex, at both times
    e0, e1 = subtract(b0, a0), subtract(b1, a1)
    f0, f1 = subtract(c0, a0), subtract(c1, a1)
    w0, w1 = subtract(a0, x), subtract(a1, x)
    # normals: of the start, mixed, of the end
    n0 = cross(e0, f0)
    m = add(cross(e0, f1), cross(e1, f0))
    n1 = cross(e1, f1)
    v0 = dot(w0, n0)
    v1 = (dot(w1, n0) + dot(w0, m)) / 3.0
    v2 = (dot(w0, n1) + dot(w1, m)) / 3.0
    v3 = dot(w1, n1)
    e, f = magnitudes(e0, e1, 0.0), magnitudes(f0, f1, 0.0)
    far = COORDINATES * largest(x)
    error = ROUNDING * sum_of_terms(magnitudes(w0, w1, far / ROUNDING), e, f)
    least = min(v0, v1, v2, v3)
    most = max(v0, v1, v2, v3)
    if least > error or most < -error:
        return False, 1.0
    a, b, c = subtract(a1, a0), subtract(b1, b0), subtract(c1, c0)
    fastest = math.sqrt(max(dot(a, a), dot(b, b), dot(c, c)))
    length = max(largest(e), largest(f), largest(w0), fastest)
    tolerance = NEAR * length + far
    p0, q0 = subtract(b0, x), subtract(c0, x)
    start = 0.0
    for _ in range(MOST_TURNS):
        outcome, low, high = next_root(v0, v1, v2, v3, error, start)
        if outcome == NO_ROOT:
            return False, 1.0
        start = low
        if outcome == ONE_ROOT:
            t = 0.5 * (low + high)
            distance, _, _ = point_triangle(
                ORIGIN, add_scaled(w0, t, a), add_scaled(p0, t, b), add_scaled(q0, t, c)
            )
            if distance <= tolerance:
                return True, t
            if distance > tolerance + (high - low) * fastest:
                start = high
                if start >= 1.0:
                    return False, 1.0
                continue
        outcome, start = advance_vertex_face(start, tolerance, MOST_ADVANCES, w0, p0, q0, a, b, c)
        if outcome != OPEN:
            return outcome == TOUCHING, start
    return True, start


@kernel(internal=True)
def swept_edges(a0: Vector, a1: Vector, p0: Vector, p1: Vector, q0: Vector, q1: Vector) -> tuple[bool, float]:
    """Test an edge whose ends move linearly against an edge that stands still.

    Parameters
    ----------
    a0, a1
        Ends of the edge that stands still [m]; may be the same point.
    p0, p1
        First end of the other at time 0 and at time 1 [m].
    q0, q1
        Its second end; may be the same point as the first.

    Returns
    -------
    hit
        Whether they touch.
    time
        Of the first contact, in [0, 1]; 0 if they touch at the start, 1 without contact.
    """
    d = subtract(a1, a0)
    e0, e1 = subtract(q0, p0), subtract(q1, p1)
    w0, w1 = subtract(p0, a0), subtract(p1, a0)
    v0 = dot(d, cross(e0, w0))
    v2 = dot(d, cross(e1, w1))
    v1 = 0.5 * dot(d, add(cross(e0, w1), cross(e1, w0)))
    e = magnitudes(e0, e1, 0.0)
    far = COORDINATES * largest(a0)
    error = ROUNDING * sum_of_terms(magnitudes(d, d, 0.0), e, magnitudes(w0, w1, far / ROUNDING))
    if min(v0, v1, v2) > error or max(v0, v1, v2) < -error:
        return False, 1.0
    p, q = subtract(p1, p0), subtract(q1, q0)
    r0 = subtract(q0, a0)
    fastest = math.sqrt(max(dot(p, p), dot(q, q)))
    length = max(largest(d), largest(e), largest(w0), fastest)
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
            distance, _, _ = segment_segment(ORIGIN, d, add_scaled(w0, t, p), add_scaled(r0, t, q))
            if distance <= tolerance:
                return True, t
            if distance > tolerance + (high - low) * fastest:
                start = high
                if start >= 1.0:
                    return False, 1.0
                continue
        outcome, start = advance_edges(start, tolerance, MOST_ADVANCES, d, w0, r0, p, q)
        if outcome != OPEN:
            return outcome == TOUCHING, start
    return True, start
