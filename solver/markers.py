"""Markers: which material points and directions of a body are followed, and by what number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.classes import dataclass
from heavylift.numerics.records import Record, Records, filled, records
from heavylift.solver.interface import FORCES, ROWS
from heavylift.solver.scene.bodies import GROUND

__all__ = ["BodyMarkers", "MarkerBook", "PackedMarker", "pack_markers"]


@dataclass(frozen=True, eq=False)
class BodyMarkers:
    """Markers of one body.

    Attributes
    ----------
    numbers
        Row of each marker in the workspace, or first record column of each sensor.
    vectors
        Material points [m] or unit directions, in the body frame.
    directions
        Whether the vector is a direction.
    levels
        What each serves: `ROWS` of joints only, `FORCES`, or `RECORD` only.
    places
        Material point [m] at which a direction is taken: bodies that deform at will have no other.
    slopes
        Vector of the nodes of a frame or shell that is meant, in place of a direction; 0 for none.
    turning
        Whether a direction turns with its place, or with the frame of the body, if it has one.
    """

    numbers: tuple[int, ...] = ()
    vectors: tuple[NDArray[np.float64], ...] = ()
    directions: tuple[bool, ...] = ()
    levels: tuple[int, ...] = ()
    places: tuple[NDArray[np.float64], ...] = ()
    slopes: tuple[int, ...] = ()
    turning: tuple[bool, ...] = ()


@dataclass
class MarkerBook:
    """Numbers the markers of a scene.

    Attributes
    ----------
    count
        Markers so far.
    fixed
        Those on the ground: number and vector; their Jacobians stay zero.
    """

    count: int = 0
    fixed: list[tuple[int, NDArray[np.float64]]] = field(default_factory=list)
    _bodies: dict[str, list[tuple[int, NDArray[np.float64], bool, int, NDArray[np.float64], int, bool]]] = (
        field(default_factory=dict)
    )

    def point(self, body: str, point: NDArray[np.float64], level: int = ROWS) -> int:
        """Number of a new material point [m], in the frame of the body or in the world."""
        return self._add(body, point, False, level, point)

    def direction(
        self,
        body: str,
        direction: NDArray[np.float64],
        level: int = ROWS,
        *,
        at: NDArray[np.float64],
        turning: bool = True,
    ) -> int:
        """Number of a new unit direction at a material point [m], in the frame of the body or in the world.

        Of vehicles, whose axes are those of the frame, it is not `turning` with the place.
        """
        return self._add(body, direction, True, level, at, turning=turning)

    def slope(self, body: str, vector: int, level: int = ROWS, *, at: NDArray[np.float64]) -> int:
        """Number of a new slope of a frame or shell at a material point [m]: vector 1, 2 ... of its nodes."""
        return self._add(body, np.zeros(3), True, level, at, vector)

    def _add(
        self,
        body: str,
        given: NDArray[np.float64],
        direction: bool,
        level: int,
        at: NDArray[np.float64],
        slope: int = 0,
        turning: bool = True,
    ) -> int:
        number, entry = self.count, np.array(given, dtype=np.float64)
        if body == GROUND:
            self.fixed.append((number, entry))
        else:
            place = np.array(at, dtype=np.float64)
            self._bodies.setdefault(body, []).append((number, entry, direction, level, place, slope, turning))
        self.count += 1
        return number

    def of(self, bodies: Sequence[str]) -> list[BodyMarkers]:
        """Markers of each of some bodies."""
        return [
            BodyMarkers(*map(tuple, zip(*self._bodies[name], strict=True)))
            if name in self._bodies
            else BodyMarkers()
            for name in bodies
        ]


class PackedMarker(Record):
    """A marker or sensor of a body, as its kernels need it.

    Attributes
    ----------
    number
        Row of the marker in the workspace, or first record column of the sensor.
    body
        Row of the body in its kind.
    data
        Place of its numbers in the constants of the kind.
    direction
        Whether it is a direction.
    turned
        Whether it is a direction that modes turn: behind it stands the rotation of its place.
    level
        What it serves, as in `BodyMarkers`.
    """

    number: int
    body: int
    data: int
    direction: bool
    turned: bool
    level: int


def pack_markers(
    markers: Sequence[BodyMarkers],
    point_data: Sequence[Callable[[NDArray[np.float64]], NDArray[np.float64]]],
    constants: list[NDArray[np.float64]],
    direction_data: Sequence[Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]] = (),
) -> Records[PackedMarker]:
    """Index the markers of the bodies of one kind and append their data to the constants of the kind.

    Parameters
    ----------
    markers
        One entry a body.
    point_data
        One function a body, from a body-frame point [m] to the numbers its kernels need for it.
    constants
        Blocks of the flat array; grows.
    direction_data
        One function a body, from a direction and the point [m] at which it is taken to its numbers: the direction
        alone, or more if the body turns it; directions alone if there are none.

    Returns
    -------
    Records
        In the order of their levels.
    """
    rows = []
    start = sum(map(len, constants))
    for row, (body, data_of) in enumerate(zip(markers, point_data, strict=True)):
        levels = body.levels or (FORCES,) * len(body.numbers)
        places = body.places or body.vectors
        turning = body.turning or body.directions
        for number, vector, direction, level, place, turns in zip(
            body.numbers, body.vectors, body.directions, levels, places, turning, strict=True
        ):
            block = np.asarray(vector, dtype=np.float64) if direction else data_of(vector)
            if direction and turns and direction_data:
                block = direction_data[row](vector, place)
            turned = direction and len(block) > 3
            rows.append(
                filled(
                    PackedMarker,
                    number=number,
                    body=row,
                    data=start,
                    direction=direction,
                    turned=turned,
                    level=level,
                )
            )
            constants.append(block)
            start += len(block)
    rows.sort(key=attrgetter("level"))
    return records(PackedMarker, rows)
