"""The path of a rope over eyes and pulleys: its length and how that changes with every place it passes.

"Integrated simulation ... (2018)", eqs. 181-185 and 219: straight parts from tangent to tangent plus arcs,
here with the exact arcs and derivatives for pulleys that move and turn. With the unit vector ``e`` from the
centre of a pulley to the tangent point, square to its axis ``n``, and ``D`` from tangent to tangent::

    D . e1 = 0,   D . e2 = 0,       l = sum |D| + sum r (angle from e of arrival to e of departure about n)

so the tangents are exact in the plane of each pulley, wherever the rope comes from: it leaves the groove
at an angle to the plane if its neighbour is out of it. A rope wound the other way needs the opposite axis.

A taut rope leaves a pulley where its wrap vanishes: it then runs straight from the neighbour before to that behind,
without a force on the pulley, until the pulley comes back to it. Length and derivatives go over smoothly in the plane
of a pulley.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.records import Record, Records
from heavylift.numerics.records import Vector as VectorField
from heavylift.numerics.vectors import cross
from heavylift.solver.force_elements.rope_lanes import (
    ALONG,
    ARRIVING,
    AXIS,
    BY_AXIS,
    BY_NEXT_AXIS,
    CENTRE,
    LANES,
    LEAVING,
    LENGTH,
    NEARLY_PARALLEL,
    RADIUS,
    ROW,
    WRAP,
    begin_parts,
    begin_tilted_parts,
    end_parts,
    room,
    turn_parts,
)
from heavylift.solver.joints.row_writing import dot, near_angle

__all__ = ["START_WRAP", "PlaceGradient", "RopePlace", "find_parts", "path_length"]

START_WRAP = 0.75 * math.pi
"""Wrap near which that of the start is sought [rad]: from 1/8 of a turn less than none, of a pulley that the rope does
not touch, to 7/8 of a turn."""

NEWTON_STEPS, LAST_TURN = 12, 1e-10
"""Most of a part; sum of the two angles after which the error left is the square of it [rad]."""

MANY = 4
"""Straight parts of a rope from which on they are solved side by side, unless it passes pulleys by."""

SMALL_TURN = 1e-3
"""Angle [rad] below which three terms of a series have all digits."""

PARALLEL = 1e-14
"""Difference of two unit axes that is none."""

Vector = tuple[float, float, float]


class RopePlace(Record):
    """Centre [m], unit axis and radius [m] of a place that a rope passes; radius 0 of an eye."""

    centre: VectorField
    axis: VectorField
    radius: float


class PlaceGradient(Record):
    """Derivatives of the length by the centre and by the axis of a place."""

    centre: VectorField
    axis: VectorField


@kernel(inline=True, internal=True)
def _centre(place: RopePlace) -> Vector:
    return place.centre[0], place.centre[1], place.centre[2]


@kernel(inline=True, internal=True)
def _axis(place: RopePlace) -> Vector:
    return place.axis[0], place.axis[1], place.axis[2]


@kernel(inline=True, internal=True)
def _sum(a: Vector, s: float, b: Vector) -> Vector:
    """``a + s b``."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@kernel(internal=True)
def _tangent(place: RopePlace, q: Vector, sense: float) -> Vector:
    """Unit vector to the tangent point towards a point q; sense 1 where the rope leaves, -1 where it arrives."""
    n, r = _axis(place), place.radius
    d = _sum(q, -1.0, _centre(place))
    d = _sum(d, -dot(d, n), n)
    distance = math.sqrt(dot(d, d))
    u = (d[0] / distance, d[1] / distance, d[2] / distance)
    v = cross(n, u)
    c = r / distance
    s = sense * math.sqrt(1.0 - c * c)
    return c * u[0] - s * v[0], c * u[1] - s * v[1], c * u[2] - s * v[2]


@kernel(internal=True)
def _turned(e: Vector, t: Vector, angle: float) -> Vector:
    """The unit vector turned towards its tangent."""
    if abs(angle) < SMALL_TURN:
        x = angle * angle
        c, s = 1.0 - x * (0.5 - x / 24.0), angle * (1.0 - x * (1.0 - 0.05 * x) / 6.0)
    else:
        c, s = math.cos(angle), math.sin(angle)
    return c * e[0] + s * t[0], c * e[1] + s * t[1], c * e[2] + s * t[2]


@kernel(internal=True)
def _parallel_tangents(a: RopePlace, b: RopePlace, sense: float) -> tuple[Vector, Vector]:
    """Unit vectors to both ends of the straight part between pulleys whose axes are parallel, or nearly so.

    With parallel axes both are the same or, of pulleys that turn against each other (sense -1), opposite. Zero where
    the pulleys are too near for that: a search for rest may come through such places.
    """
    n, r1, r2 = _axis(a), a.radius, b.radius
    d = _sum(_centre(b), -1.0, _centre(a))
    d = _sum(d, -dot(d, n), n)
    square, gap = dot(d, d), r1 - sense * r2
    if square <= max(r1 * r1 + r2 * r2, gap * gap):
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    distance = math.sqrt(square)
    u = (d[0] / distance, d[1] / distance, d[2] / distance)
    v = cross(n, u)
    c = gap / distance
    s = math.sqrt(1.0 - c * c)
    e = c * u[0] - s * v[0], c * u[1] - s * v[1], c * u[2] - s * v[2]
    q = _sum(e, -dot(e, _axis(b)), _axis(b))
    size = sense / math.sqrt(dot(q, q))
    return e, (size * q[0], size * q[1], size * q[2])


@kernel(internal=True)
def _straight(a: RopePlace, b: RopePlace) -> tuple[Vector, Vector]:
    """Unit vectors to both ends of the straight part from a to b; zero at eyes."""
    e1 = e2 = (0.0, 0.0, 0.0)
    r1, r2, n1, n2 = a.radius, b.radius, _axis(a), _axis(b)
    along = dot(n1, n2)
    if r1 > 0.0 and r2 > 0.0 and abs(along) > NEARLY_PARALLEL:
        e1, e2 = _parallel_tangents(a, b, 1.0 if along > 0.0 else -1.0)
    if dot(e1, e1) == 0.0:
        if r1 > 0.0:
            e1 = _tangent(a, _centre(b), 1.0)
        if r2 > 0.0:
            e2 = _tangent(b, _sum(_centre(a), r1, e1), -1.0)
    if r1 == 0.0 or r2 == 0.0:
        return e1, e2
    for _ in range(NEWTON_STEPS):
        D = _sum(_sum(_sum(_centre(b), -1.0, _centre(a)), r2, e2), -r1, e1)
        t1, t2 = (
            cross(n1, e1),
            cross(n2, e2),
        )
        a11, a12, a21, a22 = dot(D, t1), r2 * dot(t2, e1), -r1 * dot(t1, e2), dot(D, t2)
        f1, f2 = dot(D, e1), dot(D, e2)
        determinant = a11 * a22 - a12 * a21
        turn1, turn2 = (a12 * f2 - a22 * f1) / determinant, (a21 * f1 - a11 * f2) / determinant
        e1, e2 = _turned(e1, t1, turn1), _turned(e2, t2, turn2)
        if abs(turn1) + abs(turn2) < LAST_TURN:
            break
    return e1, e2


@kernel(inline=True, internal=True)
def _add(gradient: NDArray[np.float64], s: float, v: Vector) -> None:
    for k in range(3):
        gradient[k] += s * v[k]


@kernel(internal=True)
def _add_straight(
    a: RopePlace,
    b: RopePlace,
    e1: Vector,
    e2: Vector,
    by_a: PlaceGradient,
    by_b: PlaceGradient,
) -> float:
    """Length of the straight part; its derivatives, and those of the arcs at its ends, into both gradients.

    Notes
    -----
    The tangents move by angles that follow from ``D . e = 0``. Out of the plane they count: the length of the
    part then changes by less than that of the arc. Their part is eliminated with the transposed equations.
    """
    r1, r2, n1, n2 = a.radius, b.radius, _axis(a), _axis(b)
    D = _sum(_sum(_sum(_centre(b), -1.0, _centre(a)), r2, e2), -r1, e1)
    length = math.sqrt(dot(D, D))
    m = (D[0] / length, D[1] / length, D[2] / length)
    t1 = cross(n1, e1)
    t2 = cross(n2, e2)
    a11 = dot(D, t1) if r1 > 0.0 else 1.0
    a22 = dot(D, t2) if r2 > 0.0 else 1.0
    a12, a21 = r2 * dot(t2, e1), -r1 * dot(t1, e2)
    w1, w2 = r1 * (1.0 - dot(m, t1)), -r2 * (1.0 - dot(m, t2))
    determinant = a11 * a22 - a12 * a21
    y1, y2 = (w1 * a22 - a21 * w2) / determinant, (a11 * w2 - a12 * w1) / determinant
    along = _sum(_sum(m, -y1, e1), -y2, e2)
    _add(by_a.centre, -1.0, along)
    _add(by_b.centre, 1.0, along)
    _add(by_a.axis, r1 * dot(m, n1) + y1 * dot(D, n1) - y2 * r1 * dot(n1, e2), e1)
    _add(by_b.axis, y2 * dot(D, n2) + y1 * r2 * dot(n2, e1) - r2 * dot(m, n2), e2)
    return length


@kernel(internal=True)
def _add_parallel(
    a: RopePlace, b: RopePlace, sense: float, by_a: PlaceGradient, by_b: PlaceGradient
) -> tuple[float, Vector, Vector]:
    """`_add_straight` and its unit vectors, of pulleys whose axes are parallel; a length below 0 if they are too near.

    Notes
    -----
    With ``D = p t + w n``, its parts along the tangent and along the axis, what is left of the rest is ``along = D/l -
    (1/p - 1/l)(r1 - sense r2) e1``, and by the axes ``r1 w/p e1`` and ``-r2 w/p e1``.
    """
    n, r1, r2 = _axis(a), a.radius, b.radius
    d = _sum(_centre(b), -1.0, _centre(a))
    w = dot(d, n)
    d = _sum(d, -w, n)
    square, gap = dot(d, d), r1 - sense * r2
    if not square > max(r1 * r1 + r2 * r2, gap * gap):
        return -1.0, d, d
    p = math.sqrt(square - gap * gap)
    length = math.sqrt(p * p + w * w)
    v = cross(n, d)
    c, s, inverse, within = gap / square, p / square, 1.0 / length, 1.0 / p
    e = c * d[0] - s * v[0], c * d[1] - s * v[1], c * d[2] - s * v[2]
    t = s * d[0] + c * v[0], s * d[1] + c * v[1], s * d[2] + c * v[2]
    turn = (within - inverse) * gap
    along = _sum(_sum((p * inverse * t[0], p * inverse * t[1], p * inverse * t[2]), w * inverse, n), -turn, e)
    _add(by_a.centre, -1.0, along)
    _add(by_b.centre, 1.0, along)
    _add(by_a.axis, r1 * w * within, e)
    _add(by_b.axis, -r2 * w * within, e)
    return length, e, (sense * e[0], sense * e[1], sense * e[2])


@kernel(internal=True)
def _add_part(
    a: RopePlace, b: RopePlace, by_a: PlaceGradient, by_b: PlaceGradient
) -> tuple[float, Vector, Vector]:
    """`_add_straight`, and unit vectors to both ends."""
    if a.radius > 0.0 and b.radius > 0.0:
        n1, n2 = _axis(a), _axis(b)
        sense = 1.0 if dot(n1, n2) > 0.0 else -1.0
        tilt = _sum(n2, -sense, n1)
        if dot(tilt, tilt) < PARALLEL * PARALLEL:
            length, e1, e2 = _add_parallel(a, b, sense, by_a, by_b)
            if length > 0.0:
                return length, e1, e2
    e1, e2 = _straight(a, b)
    return _add_straight(a, b, e1, e2, by_a, by_b), e1, e2


@kernel(internal=True)
def _turn_between(arrival: Vector, place: RopePlace, leaving: Vector, before: float) -> float:
    """Wrap of a place [rad] between the unit vectors to both tangent points, nearest to the one before."""
    return near_angle(math.atan2(dot(_axis(place), cross(arrival, leaving)), dot(arrival, leaving)), before)


@kernel(internal=True)
def _solve_group(
    places: Records[RopePlace], wraps: NDArray[np.float64], first: int, numbers: NDArray[np.float64]
) -> None:
    """Straight parts from some place on, as many as go side by side; behind the last place there are eyes."""
    last = places.shape[0] - 1
    for j in range(3):
        before = numbers[ARRIVING + j * ROW + LANES] if first > 0 else 0.0
        numbers[ARRIVING + j * ROW] = before
    for k in range(LANES + 1):
        p = min(first + k, last)
        for j in range(3):
            numbers[CENTRE + j * ROW + k] = places[p].centre[j]
            numbers[AXIS + j * ROW + k] = places[p].axis[j]
        numbers[CENTRE + k] += first + k - p  # apart from each other
        numbers[RADIUS + k] = places[p].radius
        numbers[WRAP + k] = wraps[p]
    if begin_parts(numbers)[0] > 0.0:
        begin_tilted_parts(numbers)
    for _ in range(NEWTON_STEPS):
        if turn_parts(numbers)[0] < LAST_TURN * LAST_TURN:
            break
    end_parts(numbers)


@kernel(inline=True, internal=True)
def _lane(numbers: NDArray[np.float64], quantity: int, k: int) -> Vector:
    return numbers[quantity + k], numbers[quantity + ROW + k], numbers[quantity + 2 * ROW + k]


@kernel(internal=True)
def _take_part(
    places: Records[RopePlace],
    wraps: NDArray[np.float64],
    i: int,
    j: int,
    numbers: NDArray[np.float64],
    side_by_side: bool,
    by_a: PlaceGradient,
    by_b: PlaceGradient,
) -> tuple[float, Vector, Vector]:
    """`_add_part` from place i to j; side by side with those behind it, all of which are solved at the first one."""
    if not side_by_side:
        return _add_part(places[i], places[j], by_a, by_b)
    k = i % LANES
    if k == 0:
        _solve_group(places, wraps, i, numbers)
    along = _lane(numbers, ALONG, k)
    _add(by_a.centre, -1.0, along)
    _add(by_b.centre, 1.0, along)
    _add(by_a.axis, 1.0, _lane(numbers, BY_AXIS, k))
    _add(by_b.axis, 1.0, _lane(numbers, BY_NEXT_AXIS, k))
    return numbers[LENGTH + k], _lane(numbers, LEAVING, k), _lane(numbers, ARRIVING + 1, k)


@kernel(inline=True, internal=True)
def _wrap(
    arrival: Vector,
    place: RopePlace,
    leaving: Vector,
    before: float,
    i: int,
    numbers: NDArray[np.float64],
    side_by_side: bool,
) -> float:
    """`_turn_between` at place i, which is found with the part behind it if that is side by side with others."""
    return numbers[WRAP + i % LANES] if side_by_side else _turn_between(arrival, place, leaving, before)


@kernel(internal=True)
def _next_place(places: Records[RopePlace], wraps: NDArray[np.float64], i: int, skips: bool) -> int:
    """The place to which the rope runs from place i, past pulleys with a negative wrap if they are skipped."""
    j = i + 1
    while skips and j < places.shape[0] - 1 and places[j].radius > 0.0 and wraps[j] < 0.0:
        j += 1
    return j


@kernel(internal=True)
def _run_over(
    places: Records[RopePlace], gradient: Records[PlaceGradient], wraps: NDArray[np.float64], skips: bool
) -> tuple[float, float]:
    """Length of the path [m] over all places, or those that the rope touches; smallest wrap of these [rad]."""
    count = places.shape[0]
    for i in range(count):
        for k in range(3):
            gradient[i].centre[k] = gradient[i].axis[k] = 0.0
    numbers, side_by_side = room(), count > MANY and not skips
    total, lowest = 0.0, math.inf
    arrival = (0.0, 0.0, 0.0)
    i = 0
    while i < count - 1:
        j = _next_place(places, wraps, i, skips)
        straight, e1, e2 = _take_part(places, wraps, i, j, numbers, side_by_side, gradient[i], gradient[j])
        total += straight
        r = places[i].radius
        if r > 0.0:
            wrap = _wrap(arrival, places[i], e1, wraps[i], i, numbers, side_by_side)
            total += r * wrap
            if math.isfinite(wrap):  # what has no path must not spoil the count of turns
                wraps[i] = wrap
            lowest = min(lowest, wraps[i])
        arrival = e2
        i = j
    return total, lowest


@kernel(internal=True)
def _find_touched(
    places: Records[RopePlace], gradient: Records[PlaceGradient], wraps: NDArray[np.float64]
) -> None:
    """Wraps that are negative exactly where the rope does not touch: of the straight line that passes by.

    Notes
    -----
    Pulleys with a negative wrap are passed over, and one that the line then cuts is taken up again, the deepest first.
    """
    count = places.shape[0]
    for _ in range(2 * count):
        if _run_over(places, gradient, wraps, True)[1] < 0.0:
            continue
        deepest, found, before = 0.0, -1, 0
        for p in range(1, count - 1):
            if places[p].radius == 0.0 or wraps[p] >= 0.0:
                before = p
                continue
            behind = _next_place(places, wraps, p, True)
            arrival = _straight(places[before], places[p])[1]
            leaving = _straight(places[p], places[behind])[0]
            wrap = _turn_between(arrival, places[p], leaving, wraps[p])
            if wrap < 0.0:
                wraps[p] = wrap
            elif wrap > deepest:
                deepest, found = wrap, p
        if found < 0:
            return
        wraps[found] = deepest


@entry
def path_length(places: Records[RopePlace], gradient: Records[PlaceGradient], wraps: Floats1) -> float:
    """Length of a path [m].

    Parameters
    ----------
    places
        In order; radius 0 at the ends.
    gradient
        Receives the derivatives of the length by each place.
    wraps
        Wrap of each pulley [rad], shape (n,): the value nearest to the one there is found and written, so
        that it stays continuous.

    Notes
    -----
    Not finite where a neighbour comes nearer to the axis than the radius. The wrap of a pulley that the rope does not
    touch is negative.
    """
    total, lowest = _run_over(places, gradient, wraps, False)
    if lowest < 0.0:
        _find_touched(places, gradient, wraps)
        total, _ = _run_over(places, gradient, wraps, True)
    return total


@kernel(internal=True)
def find_parts(
    places: Records[RopePlace],
    gradient: Records[PlaceGradient],
    leaving: Records[PlaceGradient],
    lengths: NDArray[np.float64],
    wraps: NDArray[np.float64],
) -> float:
    """Length of a path [m], as `path_length`, and what each of its parts has of it.

    Parameters
    ----------
    places, gradient, wraps
        As in `path_length`.
    leaving
        Receives what the part behind each place has of its derivatives; the part before it has the rest.
    lengths
        Receives the lengths of the parts [m], each with half of the arcs at its ends; shape (n,), the last one 0.

    Notes
    -----
    Parts end at directions about the axes of the pulleys that are fixed in space: so their derivatives are those of
    tensions at the tangent points, and no part turns a body about the axis of its pulley. At pulleys that the rope does
    not touch they end at points of the straight line, fixed in space, which divide it into equal parts. They are solved
    one by one: in one plane their derivatives by the axes are then exactly zero, and cost nothing behind it.
    """
    count, skips = places.shape[0], False
    while True:
        for i in range(count):
            lengths[i] = 0.0
            for k in range(3):
                gradient[i].centre[k] = gradient[i].axis[k] = 0.0
                leaving[i].centre[k] = leaving[i].axis[k] = 0.0
        total, lowest = 0.0, math.inf
        arrival = (0.0, 0.0, 0.0)
        i = 0
        while i < count - 1:
            j = _next_place(places, wraps, i, skips)
            straight, e1, e2 = _add_part(places[i], places[j], leaving[i], gradient[j])
            total += straight
            for part in range(i, j):
                lengths[part] += straight / (j - i)
            for k in range(3):
                gradient[i].centre[k] += leaving[i].centre[k]
                gradient[i].axis[k] += leaving[i].axis[k]
            r = places[i].radius
            if r > 0.0:
                wrap = _turn_between(arrival, places[i], e1, wraps[i])
                total += r * wrap
                lengths[i] += 0.5 * r * wrap
                lengths[i - 1] += 0.5 * r * wrap
                if math.isfinite(wrap):
                    wraps[i] = wrap
                lowest = min(lowest, wraps[i])
            arrival = e2
            i = j
        if skips or lowest >= 0.0:
            return total
        _find_touched(places, gradient, wraps)
        skips = True
