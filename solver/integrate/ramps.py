"""Drives that change their speed within a step or two: the driven motion has another ramp than the given one.

A drive moves exactly as far in a step as its table says, so where it is stays right. How it starts and stops what it
moves does not: forces are those of the mean speed of the step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from heavylift.solver.drive import DRIVE_HEAD, DRIVEN
from heavylift.solver.packed_profiles import profile_parts

if TYPE_CHECKING:
    from heavylift.solver.layout import Layout

__all__ = ["short_ramps"]

FEW = 2.0
"""Steps in a ramp up to which it is reported."""

SHARE = 0.5
"""Of the largest speed of a drive, by which a ramp changes it; less is a kink, or a sample of a measured motion."""

JUMP = 0.01
"""Of the longer of the intervals beside it: a change within less is meant as a jump."""

Tables = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def short_ramps(layout: Layout, step: float, until: float) -> list[tuple[str, float]]:
    """Drives with ramps of few steps: name and steps in the shortest ramp, by these.

    Parameters
    ----------
    layout
        Packed scene.
    step
        Length of a step [s].
    until
        Time up to which drives are looked at [s].
    """
    found: dict[str, float] = {}
    for name, (times, before, after) in _drives(layout):
        lengths = np.diff(times)
        fastest = max(np.abs(before).max(initial=0.0), np.abs(after).max(initial=0.0))
        ramps = (np.abs(after - before) >= SHARE * fastest) & (times[:-1] < until) & (times[1:] > 0.0)
        beside = np.maximum(np.append(0.0, lengths[:-1]), np.append(lengths[1:], 0.0))
        ramps &= lengths > JUMP * beside
        ramps &= (lengths > 0.0) & (lengths <= FEW * step * (1.0 + 1e-9))
        if fastest > 0.0 and ramps.any():
            found[name] = min(float(lengths[ramps].min()) / step, found.get(name, math.inf))
    return sorted(found.items(), key=lambda item: item[1])


def _drives(layout: Layout) -> Iterator[tuple[str, Tables]]:
    """Name, times [s], and speeds at the beginning and the end of each interval, of all that moves by a table."""
    for kind in layout.bodies:
        if "drive" not in (kind.table.dtype.names or ()):
            continue
        for entry in kind.table[kind.table["motion"] == DRIVEN]:
            drive = kind.constants[int(entry["drive"]) :]
            for start in drive[DRIVE_HEAD - 4 : DRIVE_HEAD]:
                yield layout.body_names[int(entry["number"])], _of_profile(drive, int(start))
    for kind in layout.joints:
        fields = kind._fields
        if "profiles" in fields:
            for entry in kind.table:
                if entry["profile"] >= 0:
                    yield (
                        layout.block_names[int(entry["block"])],
                        _of_profile(kind.profiles, int(entry["profile"])),
                    )
        if "winches" in fields:
            for entry in kind.table:
                first, count = int(entry["winch"]), int(entry["winch_rows"])
                rows = kind.winches[first : first + count]
                times, speeds = np.array(rows["time"]), np.array(rows["speed"])
                yield layout.block_names[int(entry["block"])], (times, speeds[:-1], speeds[1:])
        if "pieces" in fields:
            for entry in kind.table:
                first, count = int(entry["first_piece"]), int(entry["pieces"])
                times, _, speeds, slopes = kind.pieces[first : first + count].T
                after = speeds[:-1] + np.diff(times) * slopes[:-1]
                yield layout.block_names[int(entry["block"])], (times, speeds[:-1], after)


def _of_profile(data: NDArray[np.float64], start: int) -> Tables:
    breaks, cubics, _ = profile_parts(data, start)
    t = np.diff(breaks)
    return breaks, cubics[:, 2], cubics[:, 2] + t * (2.0 * cubics[:, 1] + 3.0 * t * cubics[:, 0])
