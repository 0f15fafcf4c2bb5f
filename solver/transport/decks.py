"""Decks: pieces of a road, each fixed to a body, and how high the centre of a wheel is on them.

A wheel of radius R does not follow a profile h(x) but its upper envelope of circles, the *dilated* profile::

    z(x) = max_u  h(x + u) + sqrt(R^2 - u^2) - R ,    |u| <= R

Of a polygon that is the largest of ``h + R (sqrt(1 + m^2) - 1)`` on a piece of slope m that is touched between its
ends, at ``u = R m / sqrt(1 + m^2)``, and of circles about its corners; so edges, gaps and steps are exact. A radius of
0 is a point that follows the profile.

On a grid of heights h(x, y) a wheel follows the profile that its rolling plane, that through its place along its
heading, cuts from the surface: a polygon too, since the cells of a grid are plane triangles. Its corners are where the
cut crosses lines of the grid or diagonals of its cells. The breadth of a tyre is left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.classes import dataclass
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection, BodyPoint, NameOf, Quantity, Shape
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.descriptions import forward, no_rows, upwards, zero_point
from heavylift.solver.scene.drawn import Element, Solid
from heavylift.solver.scene.outlines import height_grid, profile_strip
from heavylift.solver.scene.transport import TRANSPORT, Bump, HeightGrid

__all__ = [
    "NO_ROAD",
    "STEEPEST",
    "Deck",
    "corner_table",
    "dilated_height",
    "grid_height",
    "grid_heights",
    "wheel_heights",
]

NO_ROAD = -1e300
"""Height where a wheel touches nothing of a deck."""

STEEPEST = 5.0
"""Slope of a dilated profile at most. Steeper ones, up to vertical walls, no drive climbs."""


@TRANSPORT.describe("decks")
@dataclass(frozen=True, eq=False, kw_only=True)
class Deck:
    """A piece of a road, of one profile or a grid of heights; of several a wheel is on the uppermost."""

    CHANNELS: ClassVar = ()
    MAY_BE_GROUND: ClassVar = True
    """Whether `body` may be the world."""

    name: str
    body: Annotated[str, NameOf("side")] = GROUND
    """Body that carries it, or ``"ground"``."""
    origin: Annotated[NDArray[np.float64], BodyPoint()] = field(default_factory=zero_point)
    """Where station, offset and height are zero [m], in the coordinates of the geometry of the body; of the ground in
    the world."""
    direction: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=forward)
    """Along which stations are counted, in the axes of the body."""
    normal: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=upwards)
    """Upwards, at a right angle to `direction`."""
    sides: Annotated[NDArray[np.float64] | None, Quantity("length"), Shape((2,))] = None
    """Right and left border [m], offsets to the left of the line of the origin; a `grid` has its own."""
    stations: Annotated[NDArray[np.float64], Quantity("length"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """Of the corners of the profile [m], not falling: two alike are a vertical step. There is no road before the first
    and behind the last."""
    heights: Annotated[NDArray[np.float64], Quantity("length"), Shape((None,))] = field(
        default_factory=no_rows
    )
    """[m], one a station; straight between them."""
    bump: Bump | None = None
    """In place of `stations` and `heights`."""
    grid: HeightGrid | None = None
    """In place of `stations`, `heights` and `sides`."""

    @staticmethod
    def check(spec: Any) -> None:
        """A profile and a width, or a grid."""
        kinds = [f"'{key}'" for key in ("stations", "bump", "grid") if _is_said(getattr(spec, key))]
        if len(kinds) != 1:
            problem = " and ".join(kinds) if kinds else "no 'stations' and no 'bump' or 'grid'"
            raise InputError(problem, key="stations", expected="a profile or a grid: one of them")
        if len(spec.stations) or len(spec.heights):
            if len(spec.stations) < 2 or len(spec.stations) != len(spec.heights):
                raise InputError(
                    f"{len(spec.stations)} stations and {len(spec.heights)} heights",
                    key="stations",
                    expected="two or more stations, one height each",
                )
            fall = next(
                (i for i in range(1, len(spec.stations)) if spec.stations[i] < spec.stations[i - 1]), 0
            )
            if fall:
                raise InputError(
                    f"{spec.stations[fall]:g} follows {spec.stations[fall - 1]:g}",
                    key=f"stations.{fall}",
                    expected="stations that do not fall",
                )
            if not spec.stations[-1] > spec.stations[0]:
                raise InputError(
                    "it has no length", key="stations", expected="stations apart from each other"
                )
        if (spec.grid is None) == (spec.sides is None):
            problem = "no 'sides'" if spec.grid is None else "'sides' of a deck with a 'grid'"
            raise InputError(problem, key="sides", expected="right border, left border; of a 'grid' none")
        if spec.grid is None and not spec.sides[1] > spec.sides[0]:
            raise InputError(
                f"from {spec.sides[0]:g} to {spec.sides[1]:g} m",
                key="sides",
                expected="right border, left border",
            )
        along, up = (np.asarray(v, dtype=np.float64) for v in (spec.direction, spec.normal))
        if abs(float(along @ up)) > 1e-9 * float(np.linalg.norm(along) * np.linalg.norm(up)):
            raise InputError(
                f"{along.tolist()} leans against the normal {up.tolist()}",
                key="direction",
                expected="a direction at a right angle to 'normal'",
            )

    @property
    def profile(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Stations and heights of its corners [m]; none of a grid."""
        if self.bump is not None:
            return self.bump.profile()
        return np.asarray(self.stations, dtype=np.float64), np.asarray(self.heights, dtype=np.float64)

    @property
    def borders(self) -> tuple[float, float, float, float]:
        """First and last station, right and left border [m]."""
        if self.grid is not None:
            x, y, _ = self.grid.table
            return float(x[0]), float(x[-1]), float(y[0]), float(y[-1])
        x, sides = self.profile[0], np.asarray(self.sides, dtype=np.float64)
        return float(x[0]), float(x[-1]), float(sides[0]), float(sides[1])

    def heights_at(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Heights at places within its borders [m], shape (n,)."""
        if self.grid is not None:
            return grid_heights(self.grid, 0.0, x, y)
        return np.interp(np.asarray(x, dtype=np.float64), *self.profile)

    def axes(self) -> NDArray[np.float64]:
        """Unit vectors along, to the left and upwards, as rows, in the axes of the body, shape (3, 3)."""
        x, z = (np.asarray(v, dtype=np.float64) / np.linalg.norm(v) for v in (self.direction, self.normal))
        return np.array([x, np.cross(z, x), z])

    def drawn(self) -> Iterable[Element]:
        """Its profile as a strip, or the triangles of its grid."""
        if self.grid is not None:
            outline = height_grid(*self.grid.table)
        else:
            outline = profile_strip(*self.profile, self.borders[2:])
        points = np.asarray(self.origin) + outline.points @ self.axes()
        yield Solid(name=self.name, role="deck", body=self.body, points=points, triangles=outline.triangles)

    def check_radius(self, radius: float) -> None:
        """Refuse a profile that a wheel would have to climb too steeply.

        Raises
        ------
        InputError
            If the dilated profile rises or falls by more than `STEEPEST` a length.
        """
        key = "stations" if self.bump is None else "bump"
        if self.grid is None:
            self._refuse_steep(np.column_stack(self.profile), radius, key, "station")
            return
        x, y, heights = self.grid.table
        for i, row in enumerate(heights):
            self._refuse_steep(np.column_stack([y, row]), radius, "grid", f"station {x[i]:g} m, offset")
        for i, column in enumerate(heights.T):
            self._refuse_steep(np.column_stack([x, column]), radius, "grid", f"offset {y[i]:g} m, station")

    def _refuse_steep(self, corners: NDArray[np.float64], radius: float, key: str, place: str) -> None:
        """Refuse a profile that is too steep."""
        steps = np.diff(corners, axis=0)
        for i in np.flatnonzero(np.abs(steps[:, 1]) > STEEPEST * steps[:, 0]):
            places = np.linspace(corners[i, 0] - radius, corners[i + 1, 0] + radius, 801)
            places = places[(places >= corners[0, 0]) & (places <= corners[-1, 0])]
            if radius == 0.0:
                steepest = np.inf
            else:
                z = wheel_heights(corners, 0, len(corners), radius, places)
                steepest = float(np.max(np.abs(np.diff(z)) / np.diff(places), initial=0.0))
            if steepest > STEEPEST:
                raise InputError(
                    f"a rise of {abs(steps[i, 1]):.4g} m within {steps[i, 0]:.4g} m at {place} {corners[i, 0]:g} m,"
                    f" too steep for a wheel of radius {radius:g} m",
                    source=self.name,
                    key=key,
                    expected=f"steps of at most {_highest_step(radius):.4g} m, or slopes of at most {STEEPEST:g}",
                )


def _is_said(value: Any) -> bool:
    """Whether a key of a profile is there: a table, or a list that is not empty."""
    return value is not None and (not hasattr(value, "__len__") or len(value) > 0)


def _highest_step(radius: float) -> float:
    """Step up which a wheel goes no steeper than `STEEPEST`: it begins at ``sqrt(2 R H - H^2) / (R - H)`` [m]."""
    return radius * (1.0 - 1.0 / math.hypot(1.0, STEEPEST))


@kernel(internal=True)
def _first_from(corners: NDArray[np.float64], first: int, count: int, x: float) -> int:
    """First corner at a station or behind it; `first + count` if there is none."""
    low, high = first - 1, first + count
    while high - low > 1:
        middle = (low + high) // 2
        if corners[middle, 0] < x:
            low = middle
        else:
            high = middle
    return high


@kernel(internal=True)
def dilated_height(corners: NDArray[np.float64], first: int, count: int, radius: float, x: float) -> float:
    """Height of a wheel on a profile.

    Parameters
    ----------
    corners
        Stations and heights of all profiles [m], shape (m, 2).
    first, count
        Corners of this one.
    radius
        Of the wheel [m].
    x
        Station of its axle [m].

    Returns
    -------
    float
        By how much the axle is above its place over level ground of height 0 [m]; `NO_ROAD` if it touches nothing.
    """
    last = first + count
    best = NO_ROAD
    corner = _first_from(corners, first, count, x - radius)
    for i in range(max(corner - 1, first), last):
        x0, h0 = corners[i, 0], corners[i, 1]
        if x0 > x + radius:
            break
        d = x0 - x
        if abs(d) <= radius:
            best = max(best, h0 + math.sqrt(radius * radius - d * d) - radius)
        if i + 1 < last and corners[i + 1, 0] > x0:
            if corners[i + 1, 1] == h0:
                if x0 <= x <= corners[i + 1, 0]:
                    best = max(best, h0)
                continue
            slope = (corners[i + 1, 1] - h0) / (corners[i + 1, 0] - x0)
            secant = math.sqrt(1.0 + slope * slope)
            at = x + radius * slope / secant
            if x0 <= at <= corners[i + 1, 0]:
                best = max(best, h0 + slope * (x - x0) + radius * (secant - 1.0))
    return best


@entry
def fill_wheel_heights(
    corners: Floats2, first: int, count: int, radius: float, places: Floats1, heights: Floats1
) -> None:
    """Heights of a wheel at some stations of a profile, as `dilated_height`."""
    for i in range(places.shape[0]):
        heights[i] = dilated_height(corners, first, count, radius, places[i])


def wheel_heights(
    corners: NDArray[np.float64], first: int, count: int, radius: float, places: ArrayLike
) -> NDArray[np.float64]:
    """Heights of a wheel at some stations of a profile [m], shape (n,), as `dilated_height`."""
    at = np.array(places, dtype=np.float64)
    heights = np.zeros(len(at))
    fill_wheel_heights(np.ascontiguousarray(corners, dtype=np.float64), first, count, radius, at, heights)
    return heights


@kernel(inline=True, internal=True)
def _within(low: float, high: float, x: float, c: float, begin: float, end: float) -> tuple[float, float]:
    """Part of a cut ``x + u c``, u from `begin` to `end`, that lies between two borders; begin > end if none does."""
    if c == 0.0:
        return (begin, end) if low <= x <= high else (math.inf, -math.inf)
    a, b = (low - x) / c, (high - x) / c
    return max(begin, min(a, b)), min(end, max(a, b))


@kernel(inline=True, internal=True)
def _cell_height(mean: float, by_p: float, by_q: float, twist: float, p: float, q: float) -> float:
    """Height in a cell whose corners are at p, q = -1 and 1."""
    smaller, larger = (p, q) if abs(q) >= abs(p) else (q, p)
    return mean + by_p * p + by_q * q + (twist if larger > 0.0 else -twist) * smaller


@kernel(inline=True, internal=True)
def _piece_height(u0: float, h0: float, u1: float, h1: float, radius: float) -> float:
    """Height of a wheel at u = 0 on a straight piece of a profile, without its first corner."""
    best = h1 + math.sqrt(max(radius * radius - u1 * u1, 0.0)) - radius
    if u1 > u0:
        slope = (h1 - h0) / (u1 - u0)
        secant = math.sqrt(1.0 + slope * slope)
        if u0 <= radius * slope / secant <= u1:
            best = max(best, h0 - slope * u0 + radius * (secant - 1.0))
    return best


@kernel(internal=True)
def grid_height(
    grids: NDArray[np.float64],
    first: int,
    count: int,
    across: int,
    radius: float,
    x: float,
    y: float,
    cx: float,
    cy: float,
) -> float:
    """Height of a wheel on a grid of heights, by its cut along the heading of the wheel.

    Parameters
    ----------
    grids
        Stations, offsets and heights of all grids [m], shape (m,): as `corner_table` has them.
    first, count, across
        Where this one begins, its stations and offsets.
    radius
        Of the wheel [m].
    x, y
        Station and offset of its axle [m].
    cx, cy
        Unit vector along its heading, forwards or backwards.

    Returns
    -------
    float
        As `dilated_height`.
    """
    lines, table = first + count, first + count + across
    begin, end = _within(grids[first], grids[lines - 1], x, cx, -radius, radius)
    begin, end = _within(grids[lines], grids[table - 1], y, cy, begin, end)
    if begin > end:
        return NO_ROAD
    i = k = 0
    for axis in range(2):
        # the cell in which the cut begins, or the one at the border from which it comes
        line, low, high, at, ahead = first, 0, count - 1, x + begin * cx, cx
        if axis == 1:
            line, high, at, ahead = lines, across - 1, y + begin * cy, cy
        while high - low > 1:
            middle = (low + high) // 2
            if grids[line + middle] < at or (grids[line + middle] == at and ahead >= 0.0):
                low = middle
            else:
                high = middle
        i, k = (low, k) if axis == 0 else (i, low)
    ahead_x, ahead_y = (1 if cx >= 0.0 else 0), (1 if cy >= 0.0 else 0)
    best, u, h = NO_ROAD, begin, 0.0
    while True:
        x0, y0 = grids[first + i], grids[lines + k]
        dx, dy = grids[first + i + 1] - x0, grids[lines + k + 1] - y0
        corner = table + i * across + k
        a, b = grids[corner], grids[corner + across]
        d, c = grids[corner + 1], grids[corner + across + 1]
        mean, twist = 0.25 * (a + b + c + d), 0.25 * (a - b + c - d)
        by_p, by_q = 0.25 * (b + c - a - d), 0.25 * (c + d - a - b)
        # p = p0 + u dp and q = q0 + u dq are -1 and 1 at the sides of the cell
        p0, q0, dp, dq = 2.0 * (x - x0) / dx - 1.0, 2.0 * (y - y0) / dy - 1.0, 2.0 * cx / dx, 2.0 * cy / dy
        to_x = (grids[first + i + ahead_x] - x) / cx if cx != 0.0 else math.inf
        to_y = (grids[lines + k + ahead_y] - y) / cy if cy != 0.0 else math.inf
        leave = max(min(to_x, to_y, end), u)
        if best == NO_ROAD:
            h = _cell_height(mean, by_p, by_q, twist, p0 + u * dp, q0 + u * dq)
            best = h + math.sqrt(max(radius * radius - u * u, 0.0)) - radius
        one, two = leave, leave
        if twist != 0.0:
            # where the cut crosses the diagonals
            if dp != dq:
                one = (q0 - p0) / (dp - dq)
                one = one if u < one < leave else leave
            if dp != -dq:
                two = -(q0 + p0) / (dp + dq)
                two = two if u < two < leave else leave
            one, two = min(one, two), max(one, two)
        for part in range(3):
            to = one if part == 0 else two if part == 1 else leave
            if to > u:
                after = _cell_height(mean, by_p, by_q, twist, p0 + to * dp, q0 + to * dq)
                best = max(best, _piece_height(u, h, to, after, radius))
                u, h = to, after
        if leave >= end:
            return best
        if to_x <= leave:
            i += 1 if ahead_x else -1
        if to_y <= leave:
            k += 1 if ahead_y else -1
        if i < 0 or i > count - 2 or k < 0 or k > across - 2:
            return best


@entry
def fill_grid_heights(
    grids: Floats1, count: int, across: int, radius: float, places: Floats2, heights: Floats1
) -> None:
    """Heights of a wheel at some stations and offsets of a grid along some headings, shape (n, 4), as `grid_height`."""
    for n in range(places.shape[0]):
        x, y, cx, cy = places[n, 0], places[n, 1], places[n, 2], places[n, 3]
        heights[n] = grid_height(grids, 0, count, across, radius, x, y, cx, cy)


def grid_heights(
    grid: HeightGrid, radius: float, x: ArrayLike, y: ArrayLike, heading: ArrayLike = 0.0
) -> NDArray[np.float64]:
    """Heights of a wheel at some stations and offsets of a grid along some headings [m, rad], shape (n,)."""
    x, y, heading = np.broadcast_arrays(*np.atleast_1d(x, y, heading))
    places = np.column_stack([x, y, np.cos(heading), np.sin(heading)]).astype(np.float64)
    heights = np.zeros(len(places))
    stations, offsets, _ = grid.table
    fill_grid_heights(grid.numbers, len(stations), len(offsets), radius, places, heights)
    return heights


def corner_table(
    decks: Sequence[Deck],
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[tuple[int, int, int]]]:
    """What kernels keep of the heights of decks.

    Returns
    -------
    corners
        Of all profiles, shape (m, 2).
    grids
        Stations, offsets and heights of all grids, one grid after the other, shape (n,).
    places
        By deck: where it begins in either, how many corners or stations it has, and how many offsets; 0 of a profile.
    """
    profiles, grids = [np.zeros((0, 2))], [np.zeros(0)]
    places, corner, number = [], 0, 0
    for deck in decks:
        if deck.grid is None:
            profiles.append(np.column_stack(deck.profile))
            places.append((corner, len(profiles[-1]), 0))
            corner += len(profiles[-1])
        else:
            x, y, _ = deck.grid.table
            grids.append(deck.grid.numbers)
            places.append((number, len(x), len(y)))
            number += len(grids[-1])
    return np.vstack(profiles), np.concatenate(grids), places
