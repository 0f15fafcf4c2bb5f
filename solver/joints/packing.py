"""What joints need when a scene is packed: markers on bodies, a place among the rows, record columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.connections import GROUND
from heavylift.solver.interface import ROWS
from heavylift.solver.markers import BodyMarkers

__all__ = ["JointPlace", "MarkerBook"]


@dataclass(frozen=True)
class JointPlace:
    """Number of the block of a joint, and its first record column."""

    block: int
    column: int


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
    _bodies: dict[str, list[tuple[int, NDArray[np.float64], bool, int]]] = field(default_factory=dict)

    def point(self, body: str, point: NDArray[np.float64], level: int = ROWS) -> int:
        """Number of a new material point [m], in the frame of the body or in the world."""
        return self._add(body, point, False, level)

    def direction(self, body: str, direction: NDArray[np.float64], level: int = ROWS) -> int:
        """Number of a new unit direction, in the frame of the body or in the world."""
        return self._add(body, direction, True, level)

    def _add(self, body: str, given: NDArray[np.float64], direction: bool, level: int) -> int:
        number, entry = self.count, np.array(given, dtype=np.float64)
        if body == GROUND:
            self.fixed.append((number, entry))
        else:
            self._bodies.setdefault(body, []).append((number, entry, direction, level))
        self.count += 1
        return number

    def of(self, bodies: Sequence[str]) -> list[BodyMarkers]:
        """Markers of each of some bodies."""
        return [
            BodyMarkers(*map(tuple, zip(*self._bodies[name], strict=True)))  # type: ignore[arg-type]
            if name in self._bodies
            else BodyMarkers()
            for name in bodies
        ]
