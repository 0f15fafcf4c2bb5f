"""Markers: which material points and directions of a body are followed, and by what number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.interface import FORCES

__all__ = ["BodyMarkers", "pack_markers"]


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
    """

    numbers: tuple[int, ...] = ()
    vectors: tuple[NDArray[np.float64], ...] = ()
    directions: tuple[bool, ...] = ()
    levels: tuple[int, ...] = ()
    places: tuple[NDArray[np.float64], ...] = ()
    slopes: tuple[int, ...] = ()


def pack_markers(
    markers: Sequence[BodyMarkers],
    point_data: Sequence[Callable[[NDArray[np.float64]], NDArray[np.float64]]],
    constants: list[NDArray[np.float64]],
) -> NDArray[np.int64]:
    """Index the markers of the bodies of one kind and append their data to the constants of the kind.

    Parameters
    ----------
    markers
        One entry a body.
    point_data
        One function a body, from a body-frame point [m] to the numbers its kernels need for it.
    constants
        Blocks of the flat array; grows.

    Returns
    -------
    ndarray
        Number, row of the body, start of the data, 1 for directions, level; shape (m, 5); in the order of their levels.
    """
    rows: list[tuple[int, int, int, int, int]] = []
    start = sum(map(len, constants))
    for row, (body, data_of) in enumerate(zip(markers, point_data, strict=True)):
        levels = body.levels or (FORCES,) * len(body.numbers)
        for number, vector, direction, level in zip(
            body.numbers, body.vectors, body.directions, levels, strict=True
        ):
            block = np.asarray(vector, dtype=np.float64) if direction else data_of(vector)
            rows.append((number, row, start, int(direction), level))
            constants.append(block)
            start += len(block)
    rows.sort(key=lambda row: row[4])
    return np.array(rows, dtype=np.int64).reshape(-1, 5)
