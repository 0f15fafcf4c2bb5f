"""Decks as strips of their profile or triangles of their grid; wheels of transporters as circles that stand on them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.solver.transport.decks import Deck
    from heavylift.solver.transport.transporters import Transporter

__all__ = ["deck_strips", "wheel_axes", "wheel_centres"]


def deck_strips(
    decks: Sequence[Deck],
) -> list[tuple[str, NDArray[np.float64], NDArray[np.int64]]]:
    """Body, points in its frame [m] and triangles of each deck."""
    found = []
    for deck in decks:
        if deck.grid is not None:
            places, triangles = _grid_triangles(*deck.grid.table)
            found.append((deck.body, np.asarray(deck.origin) + places @ deck.axes(), triangles))
            continue
        stations, heights = deck.profile
        count = len(stations)
        places = np.concatenate(
            [np.column_stack([stations, np.full(count, side), heights]) for side in deck.borders[2:]]
        )
        i = np.arange(count - 1)
        triangles = np.concatenate(
            [np.column_stack([i, i + 1, i + count]), np.column_stack([i + 1, i + count + 1, i + count])]
        )
        found.append((deck.body, np.asarray(deck.origin) + places @ deck.axes(), triangles))
    return found


def _grid_triangles(
    x: NDArray[np.float64], y: NDArray[np.float64], heights: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and triangles of a grid: four a cell, about its middle."""
    n, m = heights.shape
    corners = np.column_stack([np.repeat(x, m), np.tile(y, n), heights.ravel()])
    i, k = (index.ravel() for index in np.indices((n - 1, m - 1)))
    around = np.array([i * m + k, (i + 1) * m + k, (i + 1) * m + k + 1, i * m + k + 1])
    middle = n * m + np.arange(len(i))
    triangles = [np.column_stack([around[a], around[(a + 1) % 4], middle]) for a in range(4)]
    return np.vstack([corners, corners[around].mean(axis=0)]), np.concatenate(triangles)


def wheel_axes(transporter: Transporter) -> NDArray[np.float64]:
    """Unit vectors along the axles and upwards in the axes of the body, shape (2, 3)."""
    along = np.asarray(transporter.direction, dtype=np.float64)
    up = np.array([0.0, 0.0, 1.0]) - along[2] * along / float(along @ along)
    up /= np.linalg.norm(up)
    axle = np.cross(up, along)
    return np.array([axle / np.linalg.norm(axle), up])


def wheel_centres(transporter: Transporter, strokes: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Centres of the wheels in the frame of the body [m], shape (n, 3), as far up as the road has pushed them."""
    places = np.vstack([group.bogies for group in transporter.groups])
    lifted = np.zeros(len(places)) if strokes is None else np.ravel(strokes)
    centres: NDArray[np.float64] = (
        places + (transporter.wheel_radius + lifted)[:, None] * wheel_axes(transporter)[1]
    )
    return centres
