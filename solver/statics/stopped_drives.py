"""Drives that stand: what moves by a table of time keeps its place of time 0 while a search takes steps in frozen time.

A step of a search begins at time 0 and is as long as the search wants. What is driven would move in it by what its
table says of that length of time, another way with each length, and the scene would never be at rest.
"""

from __future__ import annotations

from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.jit import in_python
from heavylift.solver.drive import DRIVE_HEAD, DRIVEN, profile_value
from heavylift.solver.packed_profiles import profile_parts

__all__ = ["StoppedDrives"]

PROFILES = slice(DRIVE_HEAD - 4, DRIVE_HEAD)
"""Of a packed drive: where its profiles begin in it."""


class StoppedDrives:
    """Lets driven frames, joints, winches and paths stand at their places of time 0, as long as it is entered.

    Parameters
    ----------
    bodies, joints
        Kinds of a packed scene, before anything has moved.
    """

    def __init__(self, bodies: Any, joints: Any) -> None:
        self._tables: list[NDArray[Any]] = []
        self._still: list[NDArray[Any]] = []
        for kind in bodies:
            if "drive" not in (kind.table.dtype.names or ()):
                continue
            for entry in kind.table[kind.table["motion"] == DRIVEN]:
                drive = kind.constants[int(entry["drive"]) :]
                for start in drive[PROFILES]:
                    self._stop_profile(drive, int(start))
        for kind in joints:
            fields = kind._fields
            if "profiles" in fields:
                for start in kind.table["profile"]:
                    if start >= 0:
                        self._stop_profile(kind.profiles, int(start))
            for rows in (getattr(kind, name) for name in ("winches", "drums") if name in fields):
                for column in ("hauled", "speed", "jerk"):
                    self._put(rows[column], np.zeros(len(rows)))
            if "pieces" in fields:
                self._put(kind.pieces[:, 2:], np.zeros((len(kind.pieces), 2)))

    def _put(self, table: NDArray[Any], still: NDArray[Any]) -> None:
        if not np.array_equal(table, still):
            self._tables.append(table)
            self._still.append(still)

    def _stop_profile(self, data: NDArray[np.float64], start: int) -> None:
        """A packed profile keeps its value of time 0."""
        breaks, cubics, harmonics = profile_parts(data, start)
        if len(breaks):
            value = in_python(profile_value)(data, start, 0.0)[0]
            self._put(cubics, np.broadcast_to([0.0, 0.0, 0.0, value], cubics.shape))
            self._put(harmonics[:, 0], np.zeros(len(harmonics)))
        else:  # harmonics alone, which keep their phases
            self._put(harmonics[:, 1], np.zeros(len(harmonics)))

    def __enter__(self) -> None:
        self._moving = [table.copy() for table in self._tables]
        for table, still in zip(self._tables, self._still, strict=True):
            table[...] = still

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for table, moving in zip(self._tables, self._moving, strict=True):
            table[...] = moving
