"""What pictures are made of: lines, surfaces and marks in a colour each; arrows of forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from heavylift.pipeline.drawn.roles import FORCE_COLOUR
from heavylift.pipeline.pictures.render import Lines, Patch, Points

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Seen", "force_arrow"]

_BARB = 0.25  # of an arrow, relative to its length


class Seen(NamedTuple):
    """What is drawn in one colour each: lines, surfaces, marked points."""

    lines: tuple[Lines, ...] = ()
    patches: tuple[Patch, ...] = ()
    marks: tuple[Points, ...] = ()
    around: tuple[Lines | Patch, ...] = ()

    @property
    def points(self) -> NDArray[np.float64]:
        """All points, shape (m, 3), for the camera; without what is around, as water and moorings."""
        parts = [part.points for group in self[:3] for part in group]
        return np.concatenate(parts) if parts else np.empty((0, 3))


def force_arrow(start: NDArray[np.float64], arrow: NDArray[np.float64]) -> Lines:
    """An arrow from a point on, with a head of four lines."""
    length = float(np.linalg.norm(arrow))
    along = arrow / length
    x = np.cross(np.eye(3)[np.argmin(np.abs(along))], along)
    x = x / np.linalg.norm(x)
    tip, back = start + arrow, start + (1.0 - _BARB) * arrow
    sides = [x, np.cross(along, x), -x, -np.cross(along, x)]
    barbs = [back + 0.35 * _BARB * length * side for side in sides]
    points = np.array([start, tip, *barbs])
    ends = np.array([[0, 1], [1, 2], [1, 3], [1, 4], [1, 5]])
    return Lines(points, ends, FORCE_COLOUR, 4.0)
