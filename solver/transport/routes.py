"""Routes: how the legs of a path take the middle of a vehicle along, as a table of poses over the way.

In the plane a rigid vehicle has a velocity v of the point f that follows the path, and a yaw rate w. By way s, ::

    v = m (cos b, sin b) ,  w = k     so bogie i at p_i rolls along  (m cos b - k (y_i - f_y), m sin b + k (x_i - f_x))

in axes along the vehicle and to the left. Steering of all bogies, of the front or of the rear ones differs only in
where f is: the middle, the last or the first line, whose own bogies stay straight; so the instantaneous centre, at
``f + (0, 1/k)``, lies on the line across through it. Crab has k = 0, carousel m = 0. At a corner the curvature goes up
evenly to that of the arc within a transition (a clothoid), and down again.

The table has a row at each change of the curvature twice, once a side. Between rows poses are cubics whose ends have
the right rates, which is exact for straight ways and for yaw, and off by 3e-11 R on arcs of the radius R.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.outcome import InputError
from heavylift.solver.scene.speed_profiles import planned_moves, speed_pieces
from heavylift.solver.scene.transport import PathLeg

__all__ = ["COLUMNS", "Route", "make_route", "rolling", "steering_turns"]

COLUMNS = (
    "way",
    "x",
    "y",
    "yaw",
    "x_way",
    "y_way",
    "yaw_way",
    "slip",
    "slip_way",
    "speed",
    "f_x",
    "f_y",
    "leg",
)
"""Of a route: way [m], pose of the middle of the bogies [m, rad] and its derivatives by way, direction b of f in the
vehicle [rad] and its derivative, m, place of f in the vehicle [m], number of the leg."""

FINEST_TURN = 0.01
"""Between rows of a route [rad]."""

STRAIGHT = 1e-9
"""Turn at a corner that is none [rad]."""

SHARPEST_CORNER = math.radians(175.0)

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)

Curve = tuple[NDArray[np.float64], ...]
"""Way, x, y, direction and curvature at the rows of a curve."""


class Route(NamedTuple):
    """A path as tables.

    Attributes
    ----------
    nodes
        Columns as `COLUMNS`, shape (n, 13).
    pieces
        Time, way, speed and acceleration from which on each holds, shape (m, 4).
    legs
        Way at the end of each leg [m], its speed [m/s] and acceleration [m/s2], and the number of its first piece.
    """

    nodes: NDArray[np.float64]
    pieces: NDArray[np.float64]
    legs: NDArray[np.float64]


def _along(elements: Sequence[tuple[float, float, float]]) -> Curve:
    """A curve of elements (length, curvature at the begin and at the end), from the origin along x."""
    rows: list[tuple[float, float, float, float, float]] = []
    way = x = y = turn = 0.0
    for length, first, last in elements:
        count = max(1, math.ceil(length * max(abs(first), abs(last)) / FINEST_TURN))
        step, rise = length / count, (last - first) / length
        rows.append((way, x, y, turn, first))
        for i in range(count):
            k = first + rise * i * step
            s = 0.5 * step * (1.0 + _NODES)
            angles = turn + s * (k + 0.5 * rise * s)
            x += 0.5 * step * float(_WEIGHTS @ np.cos(angles))
            y += 0.5 * step * float(_WEIGHTS @ np.sin(angles))
            turn += step * (k + 0.5 * rise * step)
            way += step
            rows.append((way, x, y, turn, k + rise * step))
    return tuple(np.array(rows).T)


def _corner(turn: float, radius: float, transition: float) -> list[tuple[float, float, float]]:
    """Elements that turn by an angle: clothoid, arc, clothoid."""
    k = math.copysign(1.0 / radius, turn)
    arc = abs(turn) * radius - transition
    parts = [(transition, 0.0, k), (arc, k, k), (transition, k, 0.0)]
    return [part for part in parts if part[0] > 1e-12 * radius]


def _with_corners(leg: PathLeg, points: NDArray[np.float64]) -> Curve:
    """Straight pieces through points, with rounded corners."""
    pieces = np.diff(points, axis=0)
    lengths = np.hypot(*pieces.T)
    directions = np.arctan2(pieces[:, 1], pieces[:, 0])
    turns = (np.diff(directions) + np.pi) % (2.0 * np.pi) - np.pi
    taken = np.zeros(len(points))
    corners: list[list[tuple[float, float, float]]] = []
    for i, turn in enumerate(turns):
        if abs(turn) < STRAIGHT:
            corners.append([])
            continue
        where = f"the corner at point {i + 1}, of {math.degrees(turn):.6g} degrees,"
        if abs(turn) > SHARPEST_CORNER:
            raise InputError(
                f"{where} goes back", key="points", expected="corners of at most 175 degrees, or another leg"
            )
        if not leg.radius > 0.0:
            raise InputError(
                f"{where} has no radius", key="radius", expected="a 'radius' of the arcs at corners"
            )
        if leg.transition > abs(turn) * leg.radius:
            raise InputError(
                f"{where} is turned within {abs(turn) * leg.radius:.6g} m of an arc",
                key="transition",
                expected="at most that: the curvature goes up within one transition and down within another",
            )
        parts = _corner(turn, leg.radius, leg.transition)
        y = _along(parts)[2][-1]
        taken[i + 1] = y / math.sin(turn)
        corners.append(parts)
    left = lengths - taken[:-1] - taken[1:]
    if left.min() < -1e-9:
        i = int(np.argmin(left))
        raise InputError(
            f"corners take {taken[i] + taken[i + 1]:.6g} m of the {lengths[i]:.6g} m that lead to point {i + 1}",
            key="radius",
            expected="smaller radii or transitions, or points farther apart",
        )
    elements: list[tuple[float, float, float]] = []
    for i, length in enumerate(left):
        elements += [(float(length), 0.0, 0.0)] if length > 1e-9 else []
        elements += corners[i] if i < len(corners) else []
    return _along(elements)


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of vectors in the plane, shape (n, 2)."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], dtype=np.float64)


def _smooth(points: NDArray[np.float64], forwards: NDArray[np.float64]) -> Curve:
    """A curve with steady curvature through points, that begins in a direction."""
    from scipy.interpolate import CubicSpline

    chords = np.hypot(*np.diff(points, axis=0).T)
    at = np.concatenate([[0.0], np.cumsum(chords)])
    end = "not-a-knot" if len(points) > 2 else (2, np.zeros(2))
    spline = CubicSpline(at, points, bc_type=((1, forwards), end))
    rate, second = spline.derivative(1), spline.derivative(2)
    dense = np.unique(np.concatenate([np.linspace(a, b, 33) for a, b in pairwise(at)]))
    parameters = [0.0]
    for a, b in pairwise(dense):
        ends = np.array([a, b])
        bend = np.abs(_cross(rate(ends), second(ends))) / np.sum(rate(ends) ** 2, axis=1) * (b - a)
        count = max(1, math.ceil(float(bend.max()) / FINEST_TURN))
        parameters += list(np.linspace(a, b, count + 1)[1:])
    u = np.array(parameters)
    half = 0.5 * np.diff(u)
    samples = np.linalg.norm(rate(u[:-1, None] + half[:, None] * (1.0 + _NODES)), axis=2)
    way = np.concatenate([[0.0], np.cumsum(half * (samples @ _WEIGHTS))])
    velocity, bend = rate(u), second(u)
    turn = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))
    curvature = _cross(velocity, bend) / np.linalg.norm(velocity, axis=1) ** 3
    x, y = spline(u).T
    return way, x, y, turn, curvature


def _spin(turn: float, radius: float) -> Curve:
    """A turn on the spot, by the way of what is a radius away."""
    count = max(1, math.ceil(abs(turn) / FINEST_TURN))
    angles = np.linspace(0.0, turn, count + 1)
    nought = np.zeros(count + 1)
    return (
        np.abs(angles) * radius,
        nought,
        nought,
        angles,
        np.full(count + 1, math.copysign(1.0 / radius, turn)),
    )


def _refuse_centre_inside(
    way: NDArray[np.float64],
    curvature: NDArray[np.float64],
    f: NDArray[np.float64],
    bogies: NDArray[np.float64],
) -> None:
    """Refuse a curve about a centre between the wheels: some of them would have to turn round on the way to it."""
    right, left = bogies[:, 1].min() - f[1], bogies[:, 1].max() - f[1]
    sharp = np.flatnonzero(curvature)
    across = 1.0 / curvature[sharp]
    inside = (across >= right) & (across <= left)
    if inside.any():
        first = int(np.argmax(inside))
        raise InputError(
            f"at {way[sharp[first]]:.6g} m it turns about a point {abs(across[first]):.4g} m to the "
            f"{'left' if across[first] > 0.0 else 'right'}, between its own wheels",
            key="radius",
            expected=f"radii beyond {max(left, -right):.4g} m, where its wheels are; or steering 'carousel'",
        )


def _leg_rows(leg: PathLeg, bogies: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of a leg from way 0 on, of a vehicle whose middle stands at the origin along x."""
    carousel, crab = leg.steering == "carousel", leg.steering == "crab"
    f = np.zeros(2)
    if carousel:
        f = np.asarray(leg.centre, dtype=np.float64)
        reach = float(np.hypot(*(bogies - f).T).max())
        if not reach > 0.0:
            raise InputError("it turns about its only bogie", key="centre", expected="a centre beside it")
        way, x, y, turn, curvature = _spin(leg.turn, reach)
        yaw, yaw_way, slip, slip_way, speed = turn, curvature, 0.0 * turn, 0.0 * turn, 0.0
    else:
        f[0] = {"front": bogies[:, 0].min(), "rear": bogies[:, 0].max()}.get(leg.steering, 0.0)
        points = np.vstack([np.zeros((1, 2)), np.reshape(np.asarray(leg.points, dtype=np.float64), (-1, 2))])
        lengths = np.hypot(*np.diff(points, axis=0).T)
        if not lengths.min() > 0.0:
            raise InputError(
                f"point {int(np.argmin(lengths)) + 1} coincides with the point before",
                key="points",
                expected="points apart from each other; the first is not the begin, which is [0, 0]",
            )
        reverse = not crab and points[1, 0] < 0.0
        if not crab and abs(points[1, 1]) > 1e-9 * lengths[0] and leg.curve == "corners":
            raise InputError(
                f"the first piece leads {math.degrees(math.atan2(points[1, 1], points[1, 0])):.6g} degrees off where "
                "the vehicle points",
                key="points",
                expected="a first point [x, 0] straight ahead, or behind, of the vehicle; or steering 'crab'",
            )
        curve = (
            _smooth(points, np.array([-1.0 if reverse else 1.0, 0.0]) if not crab else points[1] / lengths[0])
            if leg.curve == "smooth"
            else _with_corners(leg, points)
        )
        way, x, y, turn, curvature = curve
        if leg.curve == "corners":  # the curve begins along its first piece
            first = math.atan2(points[1, 1], points[1, 0])
            x, y = math.cos(first) * x - math.sin(first) * y, math.sin(first) * x + math.cos(first) * y
            turn = turn + first
        speed = 1.0
        if crab:
            yaw, yaw_way, slip, slip_way = 0.0 * turn, 0.0 * turn, turn, curvature
        else:
            yaw, yaw_way = turn - (turn[0] if reverse else 0.0), curvature
            slip, slip_way = np.full(len(turn), math.pi if reverse else 0.0), 0.0 * turn
        if not crab:
            _refuse_centre_inside(way, yaw_way, f, bogies)
    rows = np.zeros((len(way), len(COLUMNS)))
    c, s = np.cos(yaw), np.sin(yaw)
    # the middle is -f from what follows the curve, which begins at f
    rows[:, 0], rows[:, 3], rows[:, 6] = way, yaw, yaw_way
    rows[:, 1] = f[0] + x - c * f[0] + s * f[1]
    rows[:, 2] = f[1] + y - s * f[0] - c * f[1]
    rows[:, 4] = speed * np.cos(yaw + slip) + yaw_way * (s * f[0] + c * f[1])
    rows[:, 5] = speed * np.sin(yaw + slip) - yaw_way * (c * f[0] - s * f[1])
    rows[:, 7], rows[:, 8], rows[:, 9] = slip, slip_way, speed
    rows[:, 10:12] = f
    return rows


def make_route(legs: Sequence[PathLeg], bogies: NDArray[np.float64], pose: NDArray[np.float64]) -> Route:
    """Tables of a path.

    Parameters
    ----------
    legs
        One after the other.
    bogies
        Places from their middle, along and to the left of the vehicle [m], shape (n, 2).
    pose
        Place of their middle in the plan and yaw at the start [m, rad], shape (3,).

    Raises
    ------
    InputError
        If a leg does not begin where the vehicle points, a corner has no room or no radius, with the key.
    """
    x, y, yaw = (float(value) for value in pose)
    way, time = 0.0, 0.0
    nodes: list[NDArray[np.float64]] = []
    pieces: list[NDArray[np.float64]] = []
    ends: list[tuple[float, float, float, float]] = []
    for number, leg in enumerate(legs):
        try:
            rows = _leg_rows(leg, bogies)
        except InputError as error:
            raise InputError(
                error.problem, key=f"legs.{number}.{error.key}", expected=error.expected
            ) from None
        length = float(rows[-1, 0])
        begin = time + leg.pause
        at, speeds = planned_moves([begin, begin], [0.0, length], leg.speed, leg.acceleration, None)
        moves = speed_pieces(at, speeds, leg.acceleration)[1:, :4]
        moves[:, 1] += way - moves[0, 1]
        moves[-1, 1] = way + length
        ends.append((way + length, leg.speed, leg.acceleration, sum(map(len, pieces))))
        pieces.append(moves)
        c, s = math.cos(yaw), math.sin(yaw)
        turned = rows.copy()
        for i in (1, 4):
            turned[:, i], turned[:, i + 1] = (
                c * rows[:, i] - s * rows[:, i + 1],
                s * rows[:, i] + c * rows[:, i + 1],
            )
        turned[:, :4] += way, x, y, yaw
        turned[:, 12] = number
        nodes.append(turned)
        way, x, y, yaw = (float(value) for value in turned[-1, :4])
        time = float(moves[-1, 0])
    return Route(np.vstack(nodes), np.vstack(pieces), np.array(ends, dtype=np.float64))


def rolling(nodes: NDArray[np.float64], bogies: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Velocities of bogies by way, along and to the left of the vehicle, each of shape (rows, bogies)."""
    slip, speed, turn = (nodes[:, i, None] for i in (7, 9, 6))
    x, y = bogies[:, 0] - nodes[:, 10, None], bogies[:, 1] - nodes[:, 11, None]
    return speed * np.cos(slip) - turn * y, speed * np.sin(slip) + turn * x


def steering_turns(route: Route, bogies: NDArray[np.float64], limit: float) -> NDArray[np.float64]:
    """Half turns that bring the steering angle of each bogie into its range on each leg: it then rolls the other way.

    Returns
    -------
    ndarray
        [rad], shape (legs, bogies).

    Raises
    ------
    InputError
        If an angle leaves its range whichever way the bogie rolls.
    """
    numbers = route.nodes[:, 12]
    turns = np.zeros((int(numbers[-1]) + 1, len(bogies)))
    for leg in range(len(turns)):
        rows = route.nodes[numbers == leg]
        along, across = rolling(rows, bogies)
        moves = np.hypot(along, across) > 1e-9
        for i in range(len(bogies)):
            ways = rows[moves[:, i], 0]
            if not len(ways):
                continue
            angles = np.unwrap(np.arctan2(across, along)[moves[:, i], i])
            middle = 0.5 * (angles.max() + angles.min())
            # as it is if that will do, else the half turns after which it steers least
            half = math.pi * np.array([0.0, -np.round(middle / math.pi)])
            fits = [h for h in half if np.abs(angles + h).max() <= limit + 1e-9]
            if not fits:
                turned = angles + half[1]
                worst = int(np.argmax(np.abs(turned)))
                raise InputError(
                    f"bogie {i + 1} would have to steer by {math.degrees(turned[worst]):.6g} degrees at "
                    f"{ways[worst] - rows[0, 0]:.6g} m of leg {leg + 1}",
                    key=f"legs.{leg}",
                    expected=f"a path that takes at most {math.degrees(limit):.6g} degrees: a larger radius, or "
                    "another way to steer",
                )
            turns[leg, i] = fits[0]
    return turns
