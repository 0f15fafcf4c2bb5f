"""How much of space the closed parts of a surface enclose more than once, measured along lines.

Along a line that comes from outside, the winding number grows by one where the surface is entered and falls by one
where it is left. A surface that may be integrated over has 0 and 1 alone; where parts overlap, or lie in each other,
it is 2 or more, whatever edges, faces or corners they share. Parts that touch share no length of a line. Lines along
all three axes are taken: a layer that is too thin for lines along it is crossed by those across it.

Source: winding numbers of closed surfaces: Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using
generalized winding numbers", ACM Trans. Graph. 32 (2013).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from heavylift.preprocess.surfaces.triangle_surface import TriangleSurface

__all__ = ["TwiceInside", "twice_inside"]

LINES = 101
"""Along each side of the box around, for each direction."""

OFF_CENTRE = (0.4142135623730950, 0.6180339887498949)
"""Place of a line in its cell, so that lines meet no edges of surfaces that are drawn in round numbers."""

FEWEST = 3
"""Rows of lines that a part must meet both ways to be measured by them; of a layer along them chance decides how much
it seems to have."""

AT_ONCE = 4_000_000
"""Pairs of triangle and line that are looked at together."""


@dataclass(frozen=True, eq=False)
class TwiceInside:
    """Space that is enclosed more than once.

    Attributes
    ----------
    volume
        Counted as often as it is enclosed beyond the first time [m^3]; the largest of the three directions.
    place
        Its middle [m], shape (3,).
    """

    volume: float
    place: NDArray[np.float64]


def twice_inside(surface: TriangleSurface, *, below: float = np.inf) -> TwiceInside:
    """Measure what a closed surface encloses more than once.

    Parameters
    ----------
    surface
        Triangles wound anticlockwise seen from outside [m].
    below
        What is above this height is not counted [m].

    Notes
    -----
    Lines that do not come out of the surface again meet an edge, or a slit of it, and are left out. A part that is
    thinner than three hundredths of the whole in two directions is missed.
    """
    points = np.asarray(surface.points, dtype=np.float64)
    corners = points[surface.triangles]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    found = [_along(corners, axis, low, high, below) for axis in range(3)]
    return max(found, key=lambda one: one.volume)


def _along(
    corners: NDArray[np.float64],
    axis: int,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    below: float,
) -> TwiceInside:
    """By lines along one axis."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    size = np.maximum(high - low, np.finfo(np.float64).tiny) / LINES
    shift = np.array([low[u] + OFF_CENTRE[0] * size[u], low[v] + OFF_CENTRE[1] * size[v]])
    flat = (corners[:, :, [u, v]] - shift) / size[[u, v]]  # a line a whole number
    line, height, way = _crossings(flat, corners[:, :, axis])
    order = np.lexsort((height, line))
    line, height, way = line[order], height[order], way[order]
    if not len(line):
        return TwiceInside(0.0, np.zeros(3))
    first = np.flatnonzero(np.diff(line, prepend=-1))
    total = np.add.reduceat(way, first)
    count = np.diff(np.append(first, len(line)))
    winding = np.cumsum(way)
    winding -= np.repeat(winding[first] - way[first], count)
    covered = np.repeat(total == 0, count)[:-1] & (line[1:] == line[:-1])
    start, end = height[:-1], height[1:]
    if axis == 2:
        start, end = np.minimum(start, below), np.minimum(end, below)
    else:
        row = line[:-1] // LINES if u == 2 else line[:-1] % LINES
        covered &= shift[0 if u == 2 else 1] + row * size[2] < below
    length = np.where(covered, (end - start) * np.maximum(winding[:-1] - 1, 0), 0.0)
    whole = float(length.sum())
    seen = line[:-1][length > 0.0]
    if min(len(np.unique(seen // LINES)), len(np.unique(seen % LINES))) < FEWEST:
        return TwiceInside(0.0, np.zeros(3))
    middle = np.zeros(3)
    middle[axis] = float((length * 0.5 * (start + end)).sum()) / whole
    middle[u] = shift[0] + size[u] * float((length * (line[:-1] // LINES)).sum()) / whole
    middle[v] = shift[1] + size[v] * float((length * (line[:-1] % LINES)).sum()) / whole
    return TwiceInside(whole * float(size[u] * size[v]), middle)


def _crossings(
    flat: NDArray[np.float64], heights: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
    """Lines through whole numbers of a plane that meet triangles.

    Parameters
    ----------
    flat
        Corners in that plane, shape (nt, 3, 2).
    heights
        Of the corners along the lines, shape (nt, 3).

    Returns
    -------
    tuple
        Number of the line, height, and +1 where the surface is entered or -1 where it is left, one a crossing.
    """
    first = np.maximum(np.ceil(flat.min(axis=1)), 0).astype(np.int64)
    last = np.minimum(np.floor(flat.max(axis=1)), LINES - 1).astype(np.int64)
    counts = np.maximum(last - first + 1, 0)
    pairs = counts[:, 0] * counts[:, 1]
    lines, places, ways = [], [], []
    ends = np.cumsum(pairs)
    begin = 0
    while begin < len(pairs):
        done = int(ends[begin - 1]) if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, done + AT_ONCE, side="right")))
        own = np.arange(begin, end)
        of = np.repeat(own, pairs[own])
        rank = np.arange(len(of)) - np.repeat(np.cumsum(pairs[own]) - pairs[own], pairs[own])
        at = np.stack([first[of, 0] + rank // counts[of, 1], first[of, 1] + rank % counts[of, 1]], axis=1)
        areas = np.stack([_side(flat[of, i], flat[of, (i + 1) % 3], at) for i in range(3)], axis=1)
        inside = (areas > 0.0).all(axis=1) | (areas < 0.0).all(axis=1)
        of, at, areas = of[inside], at[inside], areas[inside]
        total = areas.sum(axis=1)
        # the area beside a side belongs to the corner across it
        weights = areas[:, [1, 2, 0]] / total[:, None]
        places.append((weights * heights[of]).sum(axis=1))
        ways.append(np.where(total > 0.0, -1, 1))  # a face that looks along the line is where it leaves
        lines.append(at[:, 0] * LINES + at[:, 1])
        begin = end
    return np.concatenate(lines), np.concatenate(places), np.concatenate(ways)


def _side(a: NDArray[np.float64], b: NDArray[np.float64], p: NDArray[np.int64]) -> NDArray[np.float64]:
    """Twice the area of a, b and p; of the same size to the last digit seen from both triangles beside a side."""
    turned = (a[:, 0] > b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] > b[:, 1]))
    s, e = np.where(turned[:, None], b, a), np.where(turned[:, None], a, b)
    area = (e[:, 0] - s[:, 0]) * (p[:, 1] - s[:, 1]) - (e[:, 1] - s[:, 1]) * (p[:, 0] - s[:, 0])
    return np.asarray(np.where(turned, -area, area))
