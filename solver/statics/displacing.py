"""Bodies displaced a little and put back, as differences of forces need it many times from one position."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.records import numbers_in
from heavylift.solver.bodies.frames.base import FrameBodies

__all__ = ["FrameMover", "FramePick", "KindMover", "mover_of"]

FramePick = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]
"""Rows of the frames that are shifted, and along which axis; of those that are turned, and about which one."""


class KindMover:
    """Displaces bodies of a kind as the kind does it.

    Parameters
    ----------
    kind
        The bodies.
    count
        Of all velocities.
    step
        Of a displacement [m].
    """

    def __init__(self, kind: Any, count: int, step: float) -> None:
        self._kind, self._count = kind, count
        before = [(array, array.copy()) for array in numbers_in(kind)]
        kind.move(np.full(count, step))
        self._changed = [array for array, content in before if array.tobytes() != content.tobytes()]
        for array, content in before:
            array[...] = content

    def pick(self, increment: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """What `move` needs of an increment of all velocities; None if it is of other kinds."""
        places, inertia = (
            np.zeros((1 + int(self._kind.table["number"].max(initial=-1)), 8)),
            np.zeros(self._count),
        )
        self._kind.survey(places, inertia, np.zeros(self._count))
        own = np.where(inertia > 0.0, increment, 0.0)
        return own if own.any() else None

    def begin(self) -> None:
        """Keep the present position."""
        self._here = [array.copy() for array in self._changed]

    def move(self, pick: NDArray[np.float64], sign: int) -> None:
        """Forwards (0) or backwards (1)."""
        self._kind.move(pick if sign == 0 else -pick)

    def put_back(self, pick: NDArray[np.float64]) -> None:
        """All of them."""
        del pick
        for array, content in zip(self._changed, self._here, strict=True):
            array[...] = content


class FrameMover:
    """The same of free frames, whose displaced positions and orientations are all found at once.

    Parameters
    ----------
    kind
        The bodies.
    shift, turn
        Displacements [m] and [rad].
    """

    def __init__(self, kind: Any, shift: float, turn: float) -> None:
        self._position, self._orientation = kind.frame["position"], kind.frame["orientation"]
        self._dofs = kind.table["dof"][:, None] + np.arange(6)
        self._shift, self._turn = shift, turn

    def pick(self, increment: NDArray[np.float64]) -> FramePick | None:
        """What `move` needs of an increment of all velocities; None if it is of other kinds."""
        row, k = np.nonzero(increment[self._dofs])
        if not row.size:
            return None
        moves = k < 3
        return row[moves], k[moves], row[~moves], k[~moves] - 3

    def begin(self) -> None:
        """Keep the present position, and find all others."""
        self._here = np.array(self._position), np.array(self._orientation)
        signs = np.array([1.0, -1.0])[:, None]
        self._moved = self._here[0] + self._shift * (signs[:, :, None] * np.eye(3))[:, :, None]
        w, x, y, z = self._here[1].T
        turned = np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])  # q times i, j, k
        half = 0.5 * self._turn * signs[:, :, None, None]
        self._turned = np.cos(half) * self._here[1] + np.sin(half) * np.moveaxis(turned, 1, 2)

    def move(self, pick: FramePick, sign: int) -> None:
        """Forwards (0) or backwards (1)."""
        shifted, along, turned, about = pick
        if shifted.size:
            self._position[shifted] = self._moved[sign, along, shifted]
        if turned.size:
            self._orientation[turned] = self._turned[sign, about, turned]

    def put_back(self, pick: FramePick) -> None:
        """Those that were displaced."""
        shifted, _, turned, _ = pick
        self._position[shifted], self._orientation[turned] = self._here[0][shifted], self._here[1][turned]


def mover_of(kind: Any, count: int, shift: float, turn: float) -> KindMover | FrameMover:
    """The faster one of frames alone.

    Parameters
    ----------
    kind
        The bodies.
    count
        Of all velocities.
    shift, turn
        Displacements [m] and [rad].
    """
    return (
        FrameMover(kind, shift, turn)
        if type(kind).move is FrameBodies.move
        else KindMover(kind, count, shift)
    )
