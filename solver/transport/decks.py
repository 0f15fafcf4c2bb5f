"""Decks: pieces of a road, each fixed to a body, and how high the centre of a wheel is on them.

A wheel of radius R does not follow a profile h(x) but its upper envelope of circles, the *dilated* profile::

    z(x) = max_u  h(x + u) + sqrt(R^2 - u^2) - R ,    |u| <= R

Of a polygon that is the largest of ``h + R (sqrt(1 + m^2) - 1)`` on a piece of slope m that is touched between its
ends, at ``u = R m / sqrt(1 + m^2)``, and of circles about its corners; so edges, gaps and steps are exact. A radius of
0 is a point that follows the profile.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from heavylift.numerics.arrays import Floats1, Floats2
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import entry
from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import BodyDirection, BodyPoint, NameOf, Quantity, Shape
from heavylift.solver.scene.connections import GROUND
from heavylift.solver.scene.descriptions import no_rows
from heavylift.solver.scene.transport import TRANSPORT, Bump

__all__ = ["NO_ROAD", "STEEPEST", "Deck", "corner_table", "dilated_height", "wheel_heights"]

NO_ROAD = -1e300
"""Height where a wheel touches nothing of a deck."""

STEEPEST = 5.0
"""Slope of a dilated profile at most. Steeper ones, up to vertical walls, no drive climbs."""


def _origin() -> NDArray[np.float64]:
    return np.zeros(3)


def _forward() -> NDArray[np.float64]:
    return np.array([1.0, 0.0, 0.0])


def _upwards() -> NDArray[np.float64]:
    return np.array([0.0, 0.0, 1.0])


@TRANSPORT.describe("decks")
@dataclass(frozen=True, eq=False, kw_only=True)
class Deck:
    """A piece of a road, with the same profile over its whole width; of several a wheel is on the uppermost."""

    CHANNELS: ClassVar = ()
    MAY_BE_GROUND: ClassVar = True
    """Whether `body` may be the world."""

    name: str
    body: Annotated[str, NameOf("side")] = GROUND
    """Body that carries it, or ``"ground"``."""
    origin: Annotated[NDArray[np.float64], BodyPoint()] = field(default_factory=_origin)
    """Where station, offset and height are zero [m], in the coordinates of the geometry of the body; of the ground in
    the world."""
    direction: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=_forward)
    """Along which stations are counted, in the axes of the body."""
    normal: Annotated[NDArray[np.float64], BodyDirection()] = field(default_factory=_upwards)
    """Upwards, at a right angle to `direction`."""
    sides: Annotated[NDArray[np.float64], Quantity("length"), Shape((2,))]
    """Right and left border [m], offsets to the left of the line of the origin."""
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

    @staticmethod
    def check(said: Any) -> None:
        """A profile and a width."""
        if (len(said.stations) > 0) == (said.bump is not None):
            problem = "both 'stations' and 'bump'" if said.bump is not None else "no 'stations' and no 'bump'"
            raise InputError(problem, key="stations", expected="a profile: one of them")
        if said.bump is None:
            if len(said.stations) < 2 or len(said.stations) != len(said.heights):
                raise InputError(
                    f"{len(said.stations)} stations and {len(said.heights)} heights",
                    key="stations",
                    expected="two or more stations, one height each",
                )
            fall = next(
                (i for i in range(1, len(said.stations)) if said.stations[i] < said.stations[i - 1]), 0
            )
            if fall:
                raise InputError(
                    f"{said.stations[fall]:g} follows {said.stations[fall - 1]:g}",
                    key=f"stations.{fall}",
                    expected="stations that do not fall",
                )
            if not said.stations[-1] > said.stations[0]:
                raise InputError(
                    "it has no length", key="stations", expected="stations apart from each other"
                )
        if not said.sides[1] > said.sides[0]:
            raise InputError(
                f"from {said.sides[0]:g} to {said.sides[1]:g} m",
                key="sides",
                expected="right border, left border",
            )
        along, up = (np.asarray(v, dtype=np.float64) for v in (said.direction, said.normal))
        if abs(float(along @ up)) > 1e-9 * float(np.linalg.norm(along) * np.linalg.norm(up)):
            raise InputError(
                f"{along.tolist()} leans against the normal {up.tolist()}",
                key="direction",
                expected="a direction at a right angle to 'normal'",
            )

    @property
    def profile(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Stations and heights of its corners [m]."""
        if self.bump is not None:
            return self.bump.profile()
        return np.asarray(self.stations, dtype=np.float64), np.asarray(self.heights, dtype=np.float64)

    def axes(self) -> NDArray[np.float64]:
        """Unit vectors along, to the left and upwards, as rows, in the axes of the body, shape (3, 3)."""
        x, z = (np.asarray(v, dtype=np.float64) / np.linalg.norm(v) for v in (self.direction, self.normal))
        return np.array([x, np.cross(z, x), z])

    def check_radius(self, radius: float) -> None:
        """Refuse a profile that a wheel would have to climb too steeply.

        Raises
        ------
        InputError
            If the dilated profile rises or falls by more than `STEEPEST` a length.
        """
        corners = np.column_stack(self.profile)
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
                    f"a rise of {abs(steps[i, 1]):.4g} m within {steps[i, 0]:.4g} m at station {corners[i, 0]:g} m,"
                    f" too steep for a wheel of radius {radius:g} m",
                    source=self.name,
                    key="stations" if self.bump is None else "bump",
                    expected=f"steps of at most {_highest_step(radius):.4g} m, or slopes of at most {STEEPEST:g}",
                )


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


@kernel
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


def corner_table(decks: Sequence[Deck]) -> tuple[NDArray[np.float64], list[int], list[int]]:
    """Corners of all profiles, shape (m, 2); the first and the number of those of each deck."""
    profiles = [np.column_stack(deck.profile) for deck in decks]
    counts = [len(profile) for profile in profiles]
    firsts = [sum(counts[:i]) for i in range(len(counts))]
    return np.vstack([np.zeros((0, 2)), *profiles]), firsts, counts
