"""Where the straight parts of a rope begin and end: tangents of its pulleys, at one time or at many at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["rope_tangents"]

UNTOUCHED = -0.25 * np.pi
"""Least wrap [rad] of a pulley that the rope does not touch: as at the start of a run."""

_REPETITIONS = 12  # of pulleys in a row, whose common tangents are found by repetition


def rope_tangents(
    centres: Sequence[NDArray[np.float64]], radii: Sequence[float], axes: Sequence[NDArray[np.float64]]
) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
    """Points where a rope arrives at each place of its path and where it leaves it.

    Parameters
    ----------
    centres, radii, axes
        Of the pulleys in the order of the rope, ends and eyes with radius zero: [m], shape (..., 3); [m]; unit vectors
        about which the rope turns, shape (..., 3).

    Returns
    -------
    tuple
        Points of arrival and of departure [m], each of shape (..., 3), one a place; alike at ends and eyes.

    Notes
    -----
    A tangent from a point at the distance L touches a circle of radius r at the angle ``arccos(r / L)`` from the
    point, ahead of it where the rope arrives and behind it where it leaves. Two pulleys in a row find their common
    tangent by repetition. What lies outside the plane of a pulley counts by its projection. A pulley that the rope does
    not touch has the nearest point of the straight line that passes it by.
    """
    arrive, leave = [np.array(c) for c in centres], [np.array(c) for c in centres]
    for _ in range(_REPETITIONS):
        for k, (centre, radius, axis) in enumerate(zip(centres, radii, axes, strict=True)):
            if radius > 0.0 and 0 < k < len(centres) - 1:
                arrive[k] = _tangent_point(centre, radius, axis, leave[k - 1], 1.0)
                leave[k] = _tangent_point(centre, radius, axis, arrive[k + 1], -1.0)
                past = _passes(arrive[k] - centre, leave[k] - centre, axis)
                if np.any(past):
                    nearest = _nearest(centre, leave[k - 1], arrive[k + 1])
                    arrive[k] = np.where(past, nearest, arrive[k])
                    leave[k] = np.where(past, nearest, leave[k])
    return arrive, leave


def _passes(
    arrival: NDArray[np.float64], departure: NDArray[np.float64], axis: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether a rope would leave a pulley before it arrives, by less than an eighth of a turn, shape (..., 1)."""
    turn = np.arctan2(
        np.sum(axis * np.cross(arrival, departure), axis=-1, keepdims=True),
        np.sum(arrival * departure, axis=-1, keepdims=True),
    )
    return (turn < 0.0) & (turn >= UNTOUCHED)


def _nearest(
    point: NDArray[np.float64], begin: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Point of a straight line that is nearest to another."""
    way = end - begin
    square = np.sum(way * way, axis=-1, keepdims=True)
    part = np.sum((point - begin) * way, axis=-1, keepdims=True) / np.maximum(
        square, np.finfo(np.float64).tiny
    )
    found: NDArray[np.float64] = begin + np.clip(part, 0.0, 1.0) * way
    return found


def _tangent_point(
    centre: NDArray[np.float64],
    radius: float,
    axis: NDArray[np.float64],
    point: NDArray[np.float64],
    side: float,
) -> NDArray[np.float64]:
    """Where the tangent from a point touches a circle; from a point within it the nearest one of the circle."""
    w = point - centre
    w = w - np.sum(w * axis, axis=-1, keepdims=True) * axis
    length = np.sqrt(np.sum(w * w, axis=-1, keepdims=True))
    toward = w / np.maximum(length, np.finfo(np.float64).tiny)
    cosine = np.minimum(radius / np.maximum(length, np.finfo(np.float64).tiny), 1.0)
    e = cosine * toward + side * np.sqrt(1.0 - cosine**2) * np.cross(axis, toward)
    touched: NDArray[np.float64] = centre + radius * e
    return touched
