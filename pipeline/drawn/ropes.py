"""Points along ropes: straight from tangent to tangent, and arcs about pulleys."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.pipeline.results.rope_lines import rope_tangents

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["rope_points"]


def rope_points(
    centres: Sequence[NDArray[np.float64]],
    radii: Sequence[float],
    axes: Sequence[NDArray[np.float64]],
    *,
    arc: int,
) -> list[NDArray[np.float64]]:
    """Points of a rope at each of its places.

    Parameters
    ----------
    centres, radii, axes
        Of the pulleys in the order of the rope, ends and eyes with radius zero: [m], shape (k, 3); [m]; unit vectors
        about which the rope turns, shape (k, 3).
    arc
        Points about a pulley.

    Returns
    -------
    list
        [m], shape (k, 1, 3) of an end or eye, (k, arc, 3) of a pulley.
    """
    with np.errstate(all="ignore"):
        arrive, leave = rope_tangents(centres, radii, axes)
    found = []
    for first, last, centre, radius, axis in zip(arrive, leave, centres, radii, axes, strict=True):
        points = first[:, np.newaxis]
        if radius > 0.0:
            u = (first - centre) / radius
            v = np.cross(axis, u)
            out = last - centre
            angle = np.arctan2(np.sum(out * v, axis=1), np.sum(out * u, axis=1)) % (2.0 * np.pi)
            turns = np.linspace(0.0, 1.0, arc) * angle[:, np.newaxis]
            points = centre[:, np.newaxis] + radius * (
                np.cos(turns)[..., np.newaxis] * u[:, np.newaxis]
                + np.sin(turns)[..., np.newaxis] * v[:, np.newaxis]
            )
        found.append(points)
    return found
